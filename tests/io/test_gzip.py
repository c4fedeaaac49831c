"""Text compressed with gzip: read like the text, in bounded memory, and never written."""

from __future__ import annotations

import gzip
import io
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from commands import liftmesh as command
from file_samples import assert_same_mesh, saved, small_mesh

import liftmesh
from liftmesh import FormatError, InputError
from liftmesh.io.registry import FORMATS
from liftmesh.io.streams import decompressed

MESH = small_mesh()
TEXT = b"x,y,z\n0,0,5\n1,0,6\n0,1,7\n"


@pytest.mark.parametrize("kind", ["obj", "off", "stl", "ply"])
def test_meshes_are_read_like_their_text(kind: str, tmp_path: Path) -> None:
    options = [{}, {"encoding": "ascii"}] if kind == "ply" else [{}]
    for data in (saved(MESH, kind, **each) for each in options):
        plain, packed = tmp_path / f"a.{kind}", tmp_path / f"a.{kind}.gz"
        plain.write_bytes(data)
        packed.write_bytes(gzip.compress(data))
        assert_same_mesh(liftmesh.read(packed), liftmesh.read(plain))


def test_a_triangle_mesh_of_two_compressed_files(tmp_path: Path) -> None:
    (tmp_path / "a.1.node.gz").write_bytes(gzip.compress(b"3 2 0 0\n0 0 0\n1 1 0\n2 0 1\n"))
    (tmp_path / "a.1.ele.gz").write_bytes(gzip.compress(b"1 3 0\n0 0 1 2\n"))
    assert len(liftmesh.read(tmp_path / "a.1.ele.gz")) == 3


@pytest.mark.parametrize("wanted", ["csv", "csv.gz", ".CSV.GZ"])
def test_streams_and_formats(wanted: str) -> None:
    stream = io.BytesIO(gzip.compress(TEXT[:9]) + gzip.compress(TEXT[9:]) + bytes(100))
    assert liftmesh.read(stream, format=wanted).points[:, 2].tolist() == [5, 6, 7]


def test_options_of_tables_go_with_it(tmp_path: Path) -> None:
    path = tmp_path / "a.csv.gz"
    path.write_bytes(gzip.compress(b"id,East,North,Depth\n1,0,0,5\n2,1,0,6\n3,0,1,7\n"))
    whole = liftmesh.read(path, columns="x=East,y=North,z=-Depth")
    parts = liftmesh.read_chunks(path, rows=2, columns="x=East,y=North,z=-Depth")
    assert np.array_equal(np.concatenate([each.points for each in parts]), whole.points)
    assert whole.points[:, 2].tolist() == [-5, -6, -7]


def test_the_command_reads_it(tmp_path: Path) -> None:
    (tmp_path / "a.csv.gz").write_bytes(gzip.compress(TEXT))
    done = command("triangulate", "a.csv.gz", "mesh.ply", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_going_back_any_way() -> None:
    data = np.random.default_rng(1).integers(97, 123, 4_000_000, dtype=np.uint8).tobytes()
    text = decompressed(io.BytesIO(gzip.compress(data, 1)), "a", None)
    places = np.random.default_rng(2).integers(0, len(data), 12).tolist()
    for place in [*places, 0, len(data), 10]:
        text.seek(place)
        assert text.read(70_000) == data[place : place + 70_000]
    assert text.seek(0, 2) == len(data)


def test_chunks_take_memory_of_their_own_size_only() -> None:
    text = b"0.12345678 0.12345678 0.12345678\n" * 600_000
    data = gzip.compress(text)
    liftmesh.read(io.BytesIO(gzip.compress(text[:330])), format="xyz")  # what is imported once
    tracemalloc.start()
    rows = sum(map(len, liftmesh.read_chunks(io.BytesIO(data), rows=1000, format="xyz.gz")))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert rows == 600_000
    assert peak < len(text)


def test_what_it_expands_to_is_limited() -> None:
    data = gzip.compress(b"0 0 0\n" * 100_000)
    with pytest.raises(FormatError, match=r"more than the limit of 500,000 bytes: .*max_bytes="):
        liftmesh.read(io.BytesIO(data), format="xyz", max_bytes=500_000)
    assert len(liftmesh.read(io.BytesIO(data), format="xyz", max_bytes=600_000)) == 100_000
    with pytest.raises(InputError, match="max_bytes is 0"):
        liftmesh.read(io.BytesIO(data), format="obj", max_bytes=0)


BOMB = gzip.compress(bytes(1 << 20))


def test_the_default_limit_is_twenty_times_the_file() -> None:
    with pytest.raises(FormatError, match=r"more than the limit of 268,435,456"):
        liftmesh.read(io.BytesIO(BOMB * 300), format="xyz")


@pytest.mark.parametrize(
    ("damage", "cause"),
    [
        (lambda data: data[:-9], "the file is truncated"),
        (lambda data: data[:-8] + bytes(8), "incorrect data check"),
        (lambda data: data[:12] + b"\xff" * 9 + data[21:], "in(valid|correct)"),
        (lambda data: data + b"text", "incorrect header check"),
        (lambda data: data[:5], "the file is truncated"),
    ],
)
def test_damaged_files_are_refused(damage: object, cause: str) -> None:
    data = damage(gzip.compress(TEXT))  # type: ignore[operator]
    with pytest.raises(FormatError, match=f"<stream>: not a valid gzip file: .*{cause}"):
        liftmesh.read(io.BytesIO(data), format="csv")


def test_no_text_is_no_file() -> None:
    with pytest.raises(FormatError, match="the file is empty"):
        liftmesh.read(io.BytesIO(gzip.compress(b"")), format="csv")


@pytest.mark.parametrize("name", ["a.npz.gz", "a.glb.gz"])
def test_formats_that_are_not_read_so_say_it(name: str) -> None:
    with pytest.raises(FormatError, match="not read compressed with gzip: decompress it first"):
        liftmesh.read(name)
    with pytest.raises(FormatError, match="'gz'"):
        liftmesh.read("a.gz")


def test_nothing_is_written_compressed(tmp_path: Path) -> None:
    for options in ({}, {"format": "ply.gz"}):
        with pytest.raises(FormatError, match=r"gzip is read only: leave out \.gz"):
            liftmesh.write(tmp_path / "a.ply.gz", MESH, **options)  # type: ignore[arg-type]
    assert not [*tmp_path.iterdir()]
    said = command("triangulate", "data/hill.csv", tmp_path / "a.ply.gz")
    assert said.returncode == 3
    assert "a.ply.gz: gzip is read only: leave out .gz" in said.stderr


def test_every_format_of_text_may_be_compressed() -> None:
    assert {each.name for each in FORMATS if not each.gzip} == {
        *("npy", "npz", "glb", "gltf", "las", "e57", "raster", "geopackage", "shapefile"),
        *("3mf", "vtu", "xdmf", "msh", "su2", "ugrid"),  # are written alone
    }
