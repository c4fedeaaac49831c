"""read() and write(): which format, which source, and what goes wrong before any is asked."""

from __future__ import annotations

import io
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from file_samples import (
    AWKWARD,
    FACES,
    assert_same_bits,
    assert_same_mesh,
    full_mesh,
    loaded,
    saved,
)

import liftmesh
from liftmesh import Cloud, Format, FormatError, InputError, UnsupportedTypeError
from liftmesh.io import registry, streams
from liftmesh.io.registry import find_format, known_formats

KINDS = {
    "ply": (".ply",),
    "obj": (".obj",),
    "text": (".xyz", ".csv", ".txt", ".asc", ".tsv"),
    "npy": (".npy",),
    "npz": (".npz",),
    "off": (".off",),
    "stl": (".stl",),
    "glb": (".glb",),
    "gltf": (".gltf",),
    "pcd": (".pcd",),
    "pts": (".pts",),
    "xyzrgb": (".xyzrgb",),
    "xyzn": (".xyzn",),
    "node": (".node",),
    "ele": (".ele",),
}


def test_known_formats() -> None:
    assert {name: known_formats()[name].suffixes for name in KINDS} == KINDS
    for name in KINDS:
        assert known_formats()[name].description
        assert known_formats()[name].read is not None


@pytest.mark.parametrize("wanted", ["ply", ".ply", "PLY", ".Ply"])
def test_formats_by_name_or_suffix(wanted: str) -> None:
    assert find_format(wanted, "file").name == "ply"
    assert_same_mesh(loaded(saved(full_mesh(), wanted), wanted), full_mesh())


def test_the_suffix_tells_in_any_case(tmp_path: Path) -> None:
    for name in ("mesh.PLY", "mesh.v2.ply"):
        liftmesh.write(str(tmp_path / name), full_mesh())
        assert (tmp_path / name).read_bytes().startswith(b"ply\n")
        assert_same_mesh(liftmesh.read(str(tmp_path / name)), full_mesh())


def test_format_overrides_the_suffix(tmp_path: Path) -> None:
    target = tmp_path / "mesh.dat"
    liftmesh.write(target, full_mesh(), format="ply")
    cloud = liftmesh.read(target, format="ply")
    assert_same_mesh(cloud, full_mesh())
    assert cloud.metadata["source"] == str(target)
    assert cloud.metadata["format"] == "ply"


def test_an_open_file_tells_by_its_name(tmp_path: Path) -> None:
    with (tmp_path / "mesh.obj").open("wb") as stream:
        written = liftmesh.write(stream, full_mesh())
    assert (written.path, written.format) == (None, "obj")
    with (tmp_path / "mesh.obj").open("rb") as stream:
        assert liftmesh.read(stream).metadata["source"] == str(tmp_path / "mesh.obj")


@pytest.mark.parametrize("name", ["mesh.xyzzy", "mesh", "mesh."])
def test_unknown_suffixes_list_the_known(tmp_path: Path, name: str) -> None:
    for call in (
        lambda: liftmesh.read(tmp_path / name),
        lambda: liftmesh.write(tmp_path / name, full_mesh()),
        lambda: liftmesh.read(io.BytesIO(b"ply"), format=name),
    ):
        with pytest.raises(FormatError, match=r"known suffixes are \.2dm, \.3mf, .*\.csv.*\.ply"):
            call()
    assert not list(tmp_path.iterdir())


def test_streams_without_a_name_need_a_format() -> None:
    with pytest.raises(
        FormatError, match=r"<stream>: the name has no suffix: give the format with format="
    ):
        liftmesh.read(io.BytesIO(b"ply\n"))
    with pytest.raises(FormatError, match="give the format with format="):
        liftmesh.write(io.BytesIO(), full_mesh())


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"missing\.ply"):
        liftmesh.read(tmp_path / "missing.ply")
    (tmp_path / "folder.ply").mkdir()
    for options in ({}, {"format": "ply"}):
        with pytest.raises(FormatError, match=r"folder\.ply: this is a folder, not a file"):
            liftmesh.read(tmp_path / "folder.ply", **options)


@pytest.mark.parametrize("kind", KINDS)
def test_empty_files(tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"empty{KINDS[kind][0]}"
    path.touch()
    with pytest.raises(FormatError, match=r"empty\.\w+: the file is empty \(0 bytes\)"):
        liftmesh.read(path)


def test_streams_of_text_are_refused() -> None:
    with pytest.raises(FormatError, match="StringIO is neither a path nor a binary stream"):
        liftmesh.read(io.StringIO("1 2 3"), format="xyz")  # type: ignore[arg-type]
    with pytest.raises(FormatError, match="StringIO is neither"):
        liftmesh.write(io.StringIO(), full_mesh(), format="obj")  # type: ignore[arg-type]
    with pytest.raises(FormatError, match="int is neither"):
        liftmesh.read(3, format="obj")  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
def test_unknown_options_are_refused(tmp_path: Path, kind: str) -> None:
    with pytest.raises(FormatError, match=r"precision|cannot be written"):
        liftmesh.write(tmp_path / "mesh", full_mesh(), format=kind, precision=3)
    assert not list(tmp_path.iterdir())


def test_everything_with_vertices_and_faces_can_be_written() -> None:
    parts = SimpleNamespace(vertices=AWKWARD.tolist(), faces=FACES.tolist())
    assert_same_mesh(loaded(saved(parts, "ply"), "ply"), Cloud(AWKWARD, faces=FACES))
    parts = SimpleNamespace(vertices=AWKWARD, faces=None, attributes={"k": np.arange(5.0)})
    assert_same_bits(loaded(saved(parts, "ply"), "ply").attributes["k"], np.arange(5.0))
    mesh = trimesh.Trimesh(AWKWARD, FACES, process=False)
    assert_same_mesh(loaded(saved(mesh, "obj"), "obj"), Cloud(AWKWARD, faces=FACES))
    assert_same_bits(loaded(saved(AWKWARD, "obj"), "obj").points, AWKWARD)


@pytest.mark.parametrize("thing", [None, 3, SimpleNamespace(vertices=AWKWARD)])
def test_what_cannot_be_written(tmp_path: Path, thing: object) -> None:
    with pytest.raises(UnsupportedTypeError, match="is not a point cloud: give an array"):
        liftmesh.write(tmp_path / "mesh.ply", thing)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", ["mesh.ply", Path("mesh.ply")])
def test_a_path_is_to_be_read_first(tmp_path: Path, path: object) -> None:
    with pytest.raises(UnsupportedTypeError, match=r"is a path, not a cloud: liftmesh\.read it"):
        liftmesh.write(tmp_path / "other.ply", path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", ["ply", "obj", "npz", "off", "stl", "glb", "gltf"])
@pytest.mark.parametrize("wrong", [-1, 5, 2**31 - 1])
def test_faces_that_refer_to_no_vertex_are_not_written(kind: str, wrong: int) -> None:
    faces = FACES.copy()
    faces[1, 2] = wrong
    with pytest.raises(FormatError, match=f"face 1 refers to vertex {wrong} "):
        saved(Cloud(AWKWARD, faces=faces), kind)


def test_arrays_that_are_no_points_are_not_written() -> None:
    with pytest.raises(InputError):
        saved(np.zeros((3, 5)), "ply")
    with pytest.raises(FormatError, match=r"\(m, 3\) array of integers"):
        saved(Cloud(AWKWARD, faces=np.zeros((2, 4), dtype=np.int32)), "ply")


def test_how_much_of_a_file_is_written(tmp_path, monkeypatch):
    sizes = []

    def write(stream, cloud):
        sizes.append(streams.written())
        stream.write(bytes(5000))
        stream.flush()
        sizes.append(streams.written())

    odd = Format("odd", (".odd",), None, write, "zeros")
    monkeypatch.setattr(registry, "FORMATS", (*registry.FORMATS, odd))
    liftmesh.write(tmp_path / "a.odd", np.eye(3))
    assert sizes == [(0, None), (5000, None)]
    assert streams.written() is None
