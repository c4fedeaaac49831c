"""read_chunks(): the rows of read(), piece by piece, of every format."""

from __future__ import annotations

import io
import tracemalloc
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from file_samples import AWKWARD, FACES, full_mesh, saved
from hypothesis import given, strategies as st

import liftmesh
from liftmesh import Cloud, FormatError, InputError

DATA = Path(__file__).resolve().parents[2] / "data"

LISTS = b"""ply
format ascii 1.0
element vertex 3
property float x
property float y
property list uchar int ids
end_header
0 0 2 1 2
1 0 0
0 1 1 7
"""
LATE = b"""ply
format ascii 1.0
element material 2
property uchar red
element vertex 3
property double x
property double y
property double z
property uchar red
property uchar green
property uchar blue
end_header
1
2
0 0 5 1 2 3
1 0 6 4 5 6
0 1 7 7 8 9
"""
NAMED = b"x,y,z,red,green,blue,class\n0,0,5,0.5,0,1,2\n1,0,6,1,1,1,2\n0,1,7,0.25,0,0,9\n"
COLORS_IN_THE_END = b"0 0 5 1 0 1\n1 0 6 0 0 1\n0 1 7 0 255 0\n"
NO_COLORS_IN_THE_END = b"0 0 5 1 0 1\n1 0 6 0 0 1\n0 1 7 0 256 0\n"


def npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def npz(**arrays: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


FIELDS = np.array([(0, 1.5, 2), (3, 4, 5)], dtype=[("x", "i4"), ("y", "f8"), ("class", "u1")])
MESH = replace(full_mesh(), crs="EPSG:25832")
WITH_IDS = replace(full_mesh(), attributes={"ids": np.arange(10).reshape(5, 2)})
OBJ_MESH = replace(MESH, attributes={})

FILES = {
    "ply": ("ply", saved(MESH, "ply")),
    "ply text": ("ply", saved(MESH, "ply", encoding="ascii")),
    "ply exact colours": ("ply", saved(MESH, "ply", colors="exact")),
    "ply with lists": ("ply", LISTS),
    "ply with an element before": ("ply", LATE),
    "csv": ("csv", NAMED),
    "xyz of colours": ("xyz", COLORS_IN_THE_END),
    "xyz of no colours": ("xyz", NO_COLORS_IN_THE_END),
    "npy": ("npy", npy(AWKWARD)),
    "npy planar": ("npy", npy(AWKWARD[:, :2])),
    "npy by columns": ("npy", npy(np.asfortranarray(AWKWARD))),
    "npy of integers": ("npy", npy(np.arange(15).reshape(5, 3))),
    "npy of fields": ("npy", npy(FIELDS)),
    "npz": ("npz", saved(MESH, "npz")),
    "npz compressed": ("npz", saved(WITH_IDS, "npz", compressed=True)),
    "npz of one array": ("npz", npz(cloud=AWKWARD)),
    "npz of arrays that fit nowhere": (
        "npz",
        npz(points=AWKWARD, other=np.arange(3), crs=np.arange(5)),
    ),
    "obj": ("obj", saved(OBJ_MESH, "obj")),
    "off": ("off", saved(Cloud(AWKWARD, faces=FACES), "off")),
}


def assert_rows(chunk: Cloud, whole: Cloud, start: int) -> None:
    part = whole.select(slice(start, start + len(chunk)))
    assert chunk.faces is None
    assert (chunk.crs, chunk.attributes.keys()) == (whole.crs, whole.attributes.keys())
    pairs = [
        (chunk.points, part.points),
        (chunk.colors, part.colors),
        (chunk.normals, part.normals),
        *((values, part.attributes[name]) for name, values in chunk.attributes.items()),
    ]
    for ours, theirs in pairs:
        assert (ours is None) == (theirs is None)
        if ours is not None and theirs is not None:
            assert (ours.dtype, ours.shape) == (theirs.dtype, theirs.shape)
            assert ours.tobytes() == theirs.tobytes()


@pytest.mark.parametrize("rows", [1, 2, 3, 5, 1000])
@pytest.mark.parametrize("what", FILES)
def test_chunks_together_are_the_whole(what: str, rows: int) -> None:
    kind, data = FILES[what]
    whole = liftmesh.read(io.BytesIO(data), format=kind)
    start = 0
    for chunk in liftmesh.read_chunks(io.BytesIO(data), rows=rows, format=kind):
        assert 0 < len(chunk) <= rows
        assert chunk.metadata["format"] == whole.metadata["format"]
        assert_rows(chunk, whole, start)
        start += len(chunk)
    assert start == len(whole)


@given(
    st.lists(
        st.lists(st.sampled_from(["0", "1", "0.5", "255", "256", "-1"]), min_size=6, max_size=6)
    ),
    st.integers(1, 5),
)
def test_text_means_the_same_in_pieces(lines: list[tuple[str, ...]], rows: int) -> None:
    data = "\n".join(" ".join(line) for line in [["1", "2", "3", "4", "5", "6"], *lines]).encode()
    whole = liftmesh.read(io.BytesIO(data), format="xyz")
    start = 0
    for chunk in liftmesh.read_chunks(io.BytesIO(data), rows=rows, format="xyz"):
        assert_rows(chunk, whole, start)
        start += len(chunk)
    assert start == len(whole)


@pytest.mark.slow
def test_blocks_of_lines_become_chunks_too() -> None:
    rng = np.random.default_rng(7)
    data = "\n".join(f"{x} {y}" for x, y in rng.random((300_000, 2)).round(6)).encode()
    whole = liftmesh.read(io.BytesIO(data), format="xyz")
    chunks = [*liftmesh.read_chunks(io.BytesIO(data), rows=70_000, format="xyz")]
    assert max(map(len, chunks)) <= 70_000
    assert np.array_equal(np.concatenate([chunk.points for chunk in chunks]), whole.points)


def test_a_file_is_read_from_its_path_and_labelled() -> None:
    chunks = [*liftmesh.read_chunks(DATA / "jacksboro.ply", rows=50_000)]
    assert [len(chunk) for chunk in chunks] == [50_000, 50_000, 38_632]
    assert {chunk.metadata["source"] for chunk in chunks} == {str(DATA / "jacksboro.ply")}
    whole = liftmesh.read(DATA / "jacksboro.ply")
    assert np.array_equal(np.concatenate([chunk.points for chunk in chunks]), whole.points)


@pytest.mark.parametrize("kind", ["ply", "npy", "npz"])
def test_memory_is_bounded_by_the_chunk(kind: str, tmp_path: Path) -> None:
    points = np.random.default_rng(1).random((400_000, 3))
    path = tmp_path / f"cloud.{kind}"
    if kind == "npy":
        np.save(path, points)
    else:
        liftmesh.write(path, Cloud(points, attributes={"w": points[:, 0]}))
    tracemalloc.start()
    try:
        for _ in liftmesh.read_chunks(path, rows=10_000):
            pass
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < points.nbytes / 2


@pytest.mark.parametrize("rows", [0, -1, 1.5, True, None, "1"])
def test_rows_must_be_a_positive_whole_number(rows: object) -> None:
    with pytest.raises(InputError, match=r"rows is .*: give a whole number from 1"):
        liftmesh.read_chunks(DATA / "hill.csv", rows=rows)  # type: ignore[arg-type]


def test_an_unknown_format_is_refused_at_once() -> None:
    with pytest.raises(FormatError, match="no format has the suffix"):
        liftmesh.read_chunks("cloud.nope")


@pytest.mark.parametrize("what", ["ply", "ply text", "npy", "npz"])
def test_a_file_that_is_cut_short_ends_in_an_error(what: str) -> None:
    kind, data = FILES[what]
    for end in range(1, len(data) - 40, 7):
        with pytest.raises(FormatError, match="<stream>"):
            for _ in liftmesh.read_chunks(io.BytesIO(data[:end]), rows=2, format=kind):
                pass


def test_a_broken_line_is_named_in_text() -> None:
    with pytest.raises(FormatError, match="line 3, value 2: 'b' is not a number"):
        next(liftmesh.read_chunks(io.BytesIO(b"0 0\n1 1\n2 b\n"), rows=1, format="xyz"))


def test_the_file_is_closed_when_the_reader_stops_early(tmp_path: Path) -> None:
    path = tmp_path / "cloud.ply"
    liftmesh.write(path, full_mesh())
    chunks = liftmesh.read_chunks(path, rows=1)
    assert len(next(chunks)) == 1
    chunks.close()  # type: ignore[attr-defined]
    path.unlink()


def test_colours_of_an_npz_must_fit_the_points() -> None:
    data = npz(points=AWKWARD, colors=np.zeros((4, 3)))
    with pytest.raises(FormatError, match=r"colors have shape \(4, 3\) for 5 points"):
        next(liftmesh.read_chunks(io.BytesIO(data), rows=2, format="npz"))


@pytest.mark.parametrize(
    "array",
    [
        np.array(3.0),
        np.zeros((0, 7)),
        np.zeros(0),
        np.zeros((0, 3), dtype="U1"),
        np.zeros(0, dtype=[("a", "f8")]),
        np.zeros((), dtype=[("x", "f8"), ("y", "f8")]),
        np.zeros((4, 4)),
    ],
    ids=lambda array: f"{array.dtype}{array.shape}",
)
def test_arrays_that_are_no_points_are_refused_in_chunks_too(array: np.ndarray) -> None:
    for kind, data in (("npy", npy(array)), ("npz", npz(points=array)), ("npz", npz(only=array))):
        if kind == "npz" and array.dtype.names:
            continue  # structured points are read where they are alone
        with pytest.raises(FormatError):
            liftmesh.read(io.BytesIO(data), format=kind)
        with pytest.raises(FormatError):
            next(liftmesh.read_chunks(io.BytesIO(data), rows=2, format=kind))


def test_a_text_alone_is_no_cloud() -> None:
    with pytest.raises(FormatError):
        next(liftmesh.read_chunks(io.BytesIO(npz(crs=np.array("EPSG:1"))), format="npz"))


@pytest.mark.parametrize("kind", ["npy", "npz"])
def test_errors_tell_where_the_rows_are_counted_from(kind: str) -> None:
    points = np.arange(18).reshape(6, 3)
    points[5] = 2**53 + 1
    data = npy(points) if kind == "npy" else npz(points=points)
    chunks = liftmesh.read_chunks(io.BytesIO(data), rows=2, format=kind)
    assert [len(next(chunks)), len(next(chunks))] == [2, 2]
    with pytest.raises(FormatError, match=r"row 1 holds .*\(rows counted from row 4 of the file\)"):
        next(chunks)


def test_rows_may_be_a_whole_number_of_numpy() -> None:
    data = io.BytesIO(npy(AWKWARD))
    chunks = liftmesh.read_chunks(data, rows=np.int64(2), format="npy")  # type: ignore[arg-type]
    assert [len(chunk) for chunk in chunks] == [2, 2, 1]


@pytest.mark.parametrize("missing", [8, 1000])
def test_a_member_shorter_than_its_header_says_is_refused(missing: int) -> None:
    whole = npy(np.random.default_rng(3).random((200, 3)))
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("points.npy", whole[:-missing])
    with pytest.raises(FormatError, match=r"points\.npy: "):
        liftmesh.read(io.BytesIO(stream.getvalue()), format="npz")
    with pytest.raises(FormatError, match=r"points\.npy: .*(truncated|the member has)"):
        for _ in liftmesh.read_chunks(io.BytesIO(stream.getvalue()), rows=7, format="npz"):
            pass


def test_a_ply_file_without_vertices_has_no_chunks() -> None:
    data = b"ply\nformat ascii 1.0\nelement material 1\nproperty uchar red\nend_header\n7\n"
    with pytest.raises(FormatError, match="no vertex element"):
        next(liftmesh.read_chunks(io.BytesIO(data), format="ply"))


@pytest.mark.parametrize("comment", ["crs EPSG:25832", "crs 25832", "crs [", 'crs ""', "crs"])
def test_comments_that_only_look_like_a_coordinate_system_are_comments(comment: str) -> None:
    data = saved(Cloud(AWKWARD), "ply", comments=[comment])
    cloud = liftmesh.read(io.BytesIO(data), format="ply")
    assert cloud.crs is None
    assert comment in cloud.metadata["comments"]
