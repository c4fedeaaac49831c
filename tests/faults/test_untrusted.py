"""Untrusted files: nothing in them is run or followed, and nothing is written elsewhere."""

from __future__ import annotations

import io
import json
import os
import pickle
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import failed, liftmesh, on_terminal
from file_samples import loaded, saved, small_mesh
from files.archives import zipped
from files.gltf import glb
from lies import gltf_tree, npy

import liftmesh as lm
from liftmesh import Cloud, FormatError
from liftmesh.cli import exit_codes
from liftmesh.io.formats.gltf import buffers as gltf_buffers, reader as gltf_reader
from liftmesh.io.options import limit_of
from liftmesh.io.streams import read_most

ROWS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()
POSITIONS = {"componentType": 5126, "count": 3, "type": "VEC3"}


class Payload:
    """Makes a folder when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = str(path)

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (self.path,)


@pytest.fixture
def payload(tmp_path: Path) -> bytes:
    pickled = pickle.dumps(np.array([Payload(tmp_path / "it ran")], dtype=object))
    pickle.loads(pickled)  # so it does, where it is let
    (tmp_path / "it ran").rmdir()
    return npy("|O", (1,), pickled)


@pytest.mark.parametrize("name", ["cloud.npy", "cloud.npz", "more.npz"])
def test_pickles_are_not_unpickled(name: str, payload: bytes, tmp_path: Path) -> None:
    members = {"cloud.npz": {"points.npy": payload}}
    members["more.npz"] = {"points.npy": npy("<f8", (4, 3)), "more.npy": payload}
    data = payload if name == "cloud.npy" else zipped(members[name])
    (tmp_path / name).write_bytes(data)
    with pytest.raises(FormatError, match="holds Python objects"):
        lm.read(tmp_path / name)
    assert [each.name for each in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("suffix", ["ply", "obj", "csv", "stl", "off", "glb", "gltf", "txt"])
def test_nor_where_another_format_is_expected(suffix: str, payload: bytes, tmp_path: Path) -> None:
    for data in (payload, payload[payload.index(b"\x80\x04") :]):
        with pytest.raises(FormatError):
            loaded(data, suffix)
    assert list(tmp_path.iterdir()) == []


def test_nor_in_the_matrix_of_a_plane(payload: bytes, tmp_path: Path) -> None:
    (tmp_path / "cloud.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n")
    for matrix, cause in (
        (payload, "Python objects"),
        (npy("<f8", (2**40, 4)), "should take"),
        (zipped({"a.npy": payload}), "not an NPY file"),
    ):
        (tmp_path / "frame.npy").write_bytes(matrix)
        words = ("triangulate", "cloud.xyz", "mesh.ply", "--plane", "frame.npy")
        failed(liftmesh(*words, cwd=tmp_path), exit_codes.USAGE, "frame.npy", cause)
    assert {each.name for each in tmp_path.iterdir()} == {"cloud.xyz", "frame.npy"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Make a folder with a buffer, and others outside of it that nothing may read."""
    inner = tmp_path / "mine"
    (inner / "parts").mkdir(parents=True)
    for path in (inner / "a b.bin", inner / "parts" / "rows.bin", tmp_path / "secret.bin"):
        path.write_bytes(ROWS)
    (inner / "link.bin").symlink_to(tmp_path / "secret.bin")
    os.mkfifo(inner / "pipe.bin")  # to open it would be to wait for ever
    return inner


def named(uri: object) -> bytes:
    return json.dumps(gltf_tree(buffers__0__uri=uri)).encode()


@pytest.mark.parametrize("uri", ["a b.bin", "a%20b.bin", "parts/rows.bin", "./parts/../a b.bin"])
def test_buffers_in_its_folder_are_read(uri: str, folder: Path) -> None:
    (folder / "model.gltf").write_bytes(named(uri))
    (folder / "model.glb").write_bytes(glb(gltf_tree(buffers__0__uri=uri)))
    for name in ("model.gltf", "model.glb"):
        assert len(lm.read(folder / name)) == 3
        with (folder / name).open("rb") as stream:
            assert len(lm.read(stream, format=name[6:])) == 3


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin", "%2e%2e/secret.bin", "parts/../../secret.bin", "link.bin", "pipe.bin",
        "parts", "/dev/zero", "http://localhost:1/rows.bin", "file:///dev/zero", "nowhere.bin",
        "secret.bin", "elsewhere/a b.bin", "\0", "", "x" * 5000,
    ],
)  # fmt: skip
def test_others_are_not(uri: str, folder: Path) -> None:
    (folder / "model.gltf").write_bytes(named(uri))
    (folder / "model.glb").write_bytes(glb(gltf_tree(buffers__0__uri=uri)))
    for name in ("model.gltf", "model.glb"):
        with pytest.raises(FormatError, match=r"its buffer|not a valid") as caught:
            lm.read(folder / name)
        assert len(str(caught.value)) < 1000


def test_names_of_one_file_are_one_file(folder: Path, monkeypatch: Any) -> None:
    count = 40
    (folder / "large.bin").write_bytes(ROWS + bytes(10**6))
    uris = ["./" * k + ("large.bin", "l%61rge.bin")[k % 2] for k in range(count)]
    tree = gltf_tree(
        buffers=[{"uri": uri, "byteLength": 36} for uri in uris],
        bufferViews=[{"buffer": k, "byteLength": 36} for k in range(count)],
        accessors=[{**POSITIONS, "bufferView": k} for k in range(count)],
        meshes=[{"primitives": [{"attributes": {"POSITION": k}} for k in range(count)]}],
    )
    (folder / "model.gltf").write_bytes(json.dumps(tree).encode())
    read = []
    monkeypatch.setattr(
        gltf_buffers, "read_most", lambda *given: read.append(given[1]) or read_most(*given)
    )
    assert len(lm.read(folder / "model.gltf")) == 3 * count
    assert read == [36]


def test_files_that_the_scene_does_not_use_raise_no_limit(folder: Path, monkeypatch: Any) -> None:
    limits = []
    monkeypatch.setattr(
        gltf_reader, "limit_of", lambda *given: limits.append(given[1]) or limit_of(*given)
    )
    rows = {"uri": "parts/rows.bin", "byteLength": 36}
    others = [{"uri": "./" * k + "large.bin", "byteLength": 10**6} for k in range(9)]
    (folder / "large.bin").write_bytes(ROWS + bytes(10**6))
    for buffers, used in (
        ([rows, *others], 36),
        ([{**rows, "uri": "large.bin"}], 36),
        ([{"uri": "large.bin"}], 10**6 + 36),
        ([{**rows, "uri": "large.bin"}, *others], 10**6),
    ):
        data = json.dumps(gltf_tree(buffers=buffers)).encode()
        (folder / "model.gltf").write_bytes(data)
        assert len(lm.read(folder / "model.gltf")) == 3
        assert limits.pop() == 20 * (len(data) + used)


def test_names_too_long_for_a_file_are_not_looked_for(folder: Path) -> None:
    (folder / "model.gltf").write_bytes(named("parts/../" * 10**5 + "a b.bin"))
    with pytest.raises(FormatError, match="does not exist"):
        lm.read(folder / "model.gltf")


def test_nor_from_a_folder_that_a_stream_does_not_have(folder: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(folder)
    for data, kind in (
        (named("a b.bin"), "gltf"),
        (glb(gltf_tree(buffers__0__uri="a b.bin")), "glb"),
    ):
        with pytest.raises(FormatError, match="which is unknown for a stream"):
            loaded(data, kind)


def test_a_broken_file_does_not_turn_into_another_beside_it(tmp_path: Path) -> None:
    (tmp_path / "model.gltf").write_bytes(json.dumps(gltf_tree()).encode())
    (tmp_path / "broken.gltf").write_bytes(b'{"asset": ')
    with pytest.raises(FormatError, match=r"broken\.gltf: not a valid gltf file"):
        lm.read(tmp_path / "broken.gltf")


@pytest.mark.parametrize("image", ["pipe.bin", "../secret.bin", "http://localhost:1/a.png"])
def test_images_are_not_opened(image: str, folder: Path) -> None:
    tree = gltf_tree(
        images=[{"uri": image}],
        textures=[{"source": 0}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        meshes__0__primitives__0__material=0,
    )
    (folder / "model.gltf").write_bytes(json.dumps(tree).encode())
    assert len(lm.read(folder / "model.gltf")) == 3


def test_the_materials_of_obj_are_not_opened(folder: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(folder)
    text = "mtllib pipe.bin ../secret.bin\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    assert loaded(text.encode(), "obj").metadata["ignored"] == {"mtllib": 1, "usemtl": 1}


@pytest.mark.parametrize("member", ["../out", "/out", "a/../../out", "..\\out", "C:\\out"])
def test_members_with_paths_are_names_and_no_more(
    member: str, tmp_path: Path, monkeypatch: Any
) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    monkeypatch.chdir(inner)
    content = npy("<f8", (4,))
    (inner / "cloud.npz").write_bytes(
        zipped({"points.npy": npy("<f8", (4, 3)), f"{member}.npy": content})
    )
    cloud = lm.read("cloud.npz")
    assert len(cloud.attributes) == 1
    if ".." in member or member.startswith("/"):
        with pytest.raises(FormatError, match="rename"):
            lm.write("again.npz", cloud)
    assert {each.name for each in tmp_path.rglob("*")} == {"inner", "cloud.npz"}


@pytest.mark.parametrize("name", ["file", "allow_pickle", "kwds", "args", "a b", "x/y", "é"])
def test_every_other_name_comes_back(name: str) -> None:
    values = np.arange(4.0)
    back = loaded(saved(Cloud(small_mesh().points, attributes={name: values}), "npz"), "npz")
    assert back.attributes[name].tolist() == values.tolist()
    data = saved(Cloud(small_mesh().points, attributes={name: values}), "npz")
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert f"{name}.npy" in archive.namelist()


@pytest.mark.parametrize("name", ["mesh.ply/../../../etc", "mesh.../x", "mesh.a/b", "mesh.os"])
def test_suffixes_are_looked_up_and_never_imported(name: str, tmp_path: Path) -> None:
    with pytest.raises((FormatError, OSError)):
        lm.write(tmp_path / name, small_mesh())
    with pytest.raises((FormatError, OSError)):
        lm.read(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


COMMANDING = "\x1b]0;title\x07\x1b[31m"


@pytest.mark.slow
def test_no_name_in_a_file_commands_the_terminal(tmp_path: Path) -> None:
    cloud = Cloud(small_mesh().points, attributes={f"{COMMANDING}k": np.zeros(4)})
    lm.write(tmp_path / "cloud.npz", cloud)
    (tmp_path / "broken.csv").write_text(f"x,y\n1,2\n3,{COMMANDING}\n")
    for words in (("info", "cloud.npz"), ("info", "broken.csv"), ("info", f"{COMMANDING}.csv")):
        done = liftmesh(*words, cwd=tmp_path)
        assert "\\x1b]0;title" in done.stdout + done.stderr
        assert "\x1b" not in done.stdout + done.stderr
        shown, _ = on_terminal(*words, cwd=tmp_path)
        assert "\x1b]0" not in shown
        assert "\x07" not in shown
