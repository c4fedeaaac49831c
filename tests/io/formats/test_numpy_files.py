"""NumPy's own files: whole meshes, foreign arrays, and headers that lie."""

from __future__ import annotations

import errno
import io
import struct
import time
import warnings
import zipfile
from typing import Any

import numpy as np
import pytest
from failing_stream import Failing
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
from liftmesh import Cloud, FormatError
from liftmesh.io.formats.numpy_files import _Roles


def npy(array: Any, **options: Any) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def npz(**arrays: Any) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def raw_npy(header: str, body: bytes = b"") -> bytes:
    text = header.encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + body


@pytest.mark.parametrize("compressed", [False, True])
def test_everything_comes_back(compressed: bool) -> None:
    mesh = full_mesh()
    data = saved(mesh, "npz", compressed=compressed)
    assert_same_mesh(loaded(data, "npz"), mesh)
    assert data == saved(mesh, "npz", compressed=compressed)


def test_numpy_reads_it() -> None:
    with np.load(io.BytesIO(saved(full_mesh(), "npz"))) as arrays:
        assert_same_bits(arrays["points"], AWKWARD)
        assert_same_bits(arrays["faces"], FACES)


def test_attributes_of_every_type() -> None:
    values = {
        "long": np.array([2**63 - 1, -1, 0, 1, 2]),
        "flag": np.array([True, False, True, False, True]),
        "name": np.array(["a", "b", "c", "d", "e"]),
        "block": np.arange(30).reshape(5, 2, 3),
    }
    mesh = Cloud(AWKWARD, attributes=values)
    assert_same_mesh(loaded(saved(mesh, "npz"), "npz"), mesh)


@pytest.mark.parametrize(
    "array",
    [
        AWKWARD,
        AWKWARD.astype(">f8"),
        np.asfortranarray(AWKWARD),
        np.arange(6, dtype=np.int16).reshape(2, 3),
        np.arange(6, dtype=np.float32).reshape(2, 3) / 3,
        np.array([[2**53, -(2**53), 0]]),
        np.array([[np.nan, 1.0, 2.0]]),
        np.empty((0, 3)),
    ],
)
def test_one_array_of_points(array: np.ndarray) -> None:
    for cloud in (loaded(npy(array), "npy"), loaded(npz(anything=array), "npz")):
        assert_same_bits(cloud.points, array.astype("=f8"))


def test_two_columns_lie_at_zero() -> None:
    assert loaded(npy([[1, 2], [3, 4]]), "npy").points.tolist() == [[1, 2, 0], [3, 4, 0]]


def test_structured_arrays_are_columns() -> None:
    layout = [("x", "f4"), ("y", "f8"), ("z", "i2"), ("red", "u1"), ("green", "u1"), ("blue", "u1")]
    array = np.array([(0.5, 1.5, 2, 3, 4, 5, 6)], dtype=[*layout, ("class", "u1")])
    cloud = loaded(npy(array), "npy")
    assert cloud.points.tolist() == [[0.5, 1.5, 2.0]]
    assert_same_bits(cloud.colors, np.array([[3, 4, 5]], dtype=np.uint8))
    assert list(cloud.attributes) == ["class"]
    assert_same_bits(cloud.attributes["class"], np.array([6], dtype=np.uint8))


def test_foreign_names() -> None:
    data = npz(vertices=AWKWARD, triangles=FACES.astype(np.uint64), scale=2.0, other=np.zeros(3))
    cloud = loaded(data, "npz")
    assert_same_bits(cloud.faces, FACES)
    assert cloud.metadata["not_read"] == ("scale ()", "other (3,)")


@pytest.mark.parametrize(
    ("array", "cause"),
    [
        (np.zeros((4, 4)), r"shape \(4, 4\), not \(n, 2\) or \(n, 3\): save array\[:, :3\]"),
        (np.zeros(4), r"shape \(4,\)"),
        (np.zeros((4, 1)), r"shape \(4, 1\)"),
        (np.zeros((2, 2, 2)), r"shape \(2, 2, 2\)"),
        (np.array(1.0), r"shape \(\)"),
        (np.zeros((2, 2), dtype=complex), "complex128"),
        (np.array([["a", "b"]]), "points cannot be used"),
        (np.array([[0, 0], [1, 2**53 + 1]]), "row 1 holds 9007199254740993"),
        (np.zeros(3, dtype=[("x", "f8"), ("z", "f8")]), "fields x and y"),
        (np.zeros(3, dtype=[("x", "f8"), ("y", "U3")]), "fields x and y"),
    ],
)
def test_arrays_that_are_no_points(array: np.ndarray, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(npy(array), "npy")


def test_nothing_is_unpickled() -> None:
    objects = np.array([[{}, {}]], dtype=object)
    with pytest.raises(FormatError, match="Python objects"):
        loaded(npy(objects, allow_pickle=True), "npy")
    with pytest.raises(FormatError, match=r"points.npy: the array holds Python objects"):
        loaded(npz(points=objects), "npz")
    with pytest.raises(FormatError, match="'value' of type object"):
        saved(Cloud(AWKWARD[:1], attributes={"value": objects[:, 0]}), "npz")


@pytest.mark.parametrize(
    ("arrays", "cause"),
    [
        ({"a": AWKWARD, "b": AWKWARD}, "no array is named points: there are a, b"),
        ({}, "there are none"),
        ({"points": AWKWARD, "colors": np.zeros((4, 3))}, r"colors have shape \(4, 3\) for 5"),
        ({"points": AWKWARD, "colors": np.zeros((5, 2))}, r"colors have shape \(5, 2\)"),
        ({"points": AWKWARD, "colors": np.full((5, 3), "a")}, "colors of type <U1"),
        ({"points": AWKWARD, "normals": np.zeros(5)}, r"normals have shape \(5,\)"),
        ({"points": AWKWARD, "faces": FACES + 3}, "face 0 refers to vertex 5"),
        ({"points": AWKWARD, "faces": FACES - 1}, "face 0 refers to vertex -1"),
        ({"points": AWKWARD, "faces": np.zeros((2, 4), int)}, r"\(m, 3\) array of integers"),
        ({"points": AWKWARD, "faces": np.zeros((2, 3))}, "not float64"),
    ],
)
def test_wrong_archives(arrays: dict[str, np.ndarray], cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(npz(**arrays), "npz")


def test_reserved_names_are_refused() -> None:
    with pytest.raises(FormatError, match="'faces'"):
        saved(Cloud(AWKWARD, attributes={"faces": np.zeros(5)}), "npz")


@pytest.mark.parametrize(
    ("header", "cause"),
    [
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (1099511627776, 3)}", "should take"),
        (f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({10**30}, 3)}}", "should take"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (-1, 3)}", "shape"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (1.5, 3)}", "invalid"),
        ("{'descr': 'f99', 'fortran_order': False, 'shape': (1, 3)}", "invalid"),
        ("{'descr': '<f8'}", "invalid"),
        ("not python", "invalid"),
        ("(" * 5000, "invalid"),
        (
            "{'descr': [('x', '<f8'), ('y', '<f8')], 'fortran_order': False, 'shape': (0, %s)}"
            % (10**25),
            "header says shape",
        ),
    ],
)
def test_headers_that_lie(header: str, cause: str) -> None:
    data = raw_npy(header, bytes(24))
    with pytest.raises(FormatError, match=cause):
        loaded(data, "npy")
    with pytest.raises(FormatError, match=cause):
        next(liftmesh.read_chunks(io.BytesIO(data), format="npy"))
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("points.npy", data)
    with pytest.raises(FormatError, match=f"points.npy.*{cause}"):
        loaded(stream.getvalue(), "npz")


def test_archives_that_lie_about_their_size() -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("points.npy", npy(AWKWARD))
    size = struct.pack("<L", len(npy(AWKWARD)))
    data = stream.getvalue().replace(size, struct.pack("<L", 2**31))
    with pytest.raises(FormatError, match="bytes cannot decompress to 2147483648"):
        loaded(data, "npz")


def test_neither_archive_nor_array() -> None:
    with pytest.raises(FormatError, match="not a valid NPZ file"):
        loaded(b"PK\x03\x04 and then nothing", "npz")
    with pytest.raises(FormatError, match="not an NPY file"):
        loaded(b"1 2 3\n4 5 6\n", "npy")


def with_header(header: bytes, version: int) -> bytes:
    """Make an NPY file of a header alone."""
    length = struct.pack("<H" if version == 1 else "<I", len(header))
    return b"\x93NUMPY" + bytes([version, 0]) + length + header


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("header", [b"-" * 9000 + b"1", b"(" * 5000, b"[" * 300 + b"]" * 300])
def test_a_header_that_is_nested_too_deeply_is_invalid(header: bytes, version: int) -> None:
    data = with_header(header, version)
    with pytest.raises(FormatError, match="<stream>: not an NPY file, or its header is invalid"):
        loaded(data, "npy")
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("points.npy", data)
    with pytest.raises(FormatError, match=r"points\.npy: not an NPY file, or its header is inv"):
        loaded(stream.getvalue(), "npz")


@pytest.mark.parametrize("version", [1, 2])
def test_a_header_has_ten_thousand_bytes_at_most(version: int) -> None:
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3)}"
    rows = np.array([[1.0, 2.0, 3.0]])
    longest = with_header(header.ljust(10_000), version) + rows.tobytes()
    assert loaded(longest, "npy").points.tolist() == rows.tolist()
    data = with_header(header.ljust(10_001), version) + rows.tobytes()
    with pytest.raises(
        FormatError, match="header takes 10,001 bytes, more than 10,000: save"
    ) as told:
        loaded(data, "npy")
    assert "pickle" not in str(told.value)
    lie = with_header(b"", version)[: -1 - version] + b"\xff" * (2 * version)
    with pytest.raises(FormatError, match="more than 10,000"):
        loaded(lie, "npy")


def test_a_structured_array_may_fill_the_longest_header() -> None:
    fields = [("x", "<f8"), ("y", "<f8"), *((f"f{k}", "u1") for k in range(580))]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # np.save says that np.load has a limit, too
        data = npy(np.zeros(3, dtype=fields))
    assert 9900 <= struct.unpack_from("<H", data, 8)[0] <= 10_000
    cloud = loaded(data, "npy")
    assert (len(cloud), len(cloud.attributes)) == (3, 580)


@pytest.mark.parametrize("start", [0, 8, 10, 200])
@pytest.mark.parametrize("error", [MemoryError(), OSError(errno.EIO, "Input/output error")])
def test_errors_of_the_stream_are_no_errors_of_the_file(start: int, error: BaseException) -> None:
    data = npy(np.zeros((100, 3)))
    with pytest.raises(type(error)) as told:
        liftmesh.read(Failing(data, range(start, len(data)), error), format="npy")
    assert told.value is error


def test_npy_is_not_written() -> None:
    with pytest.raises(FormatError, match=r"npy files cannot be written .*: write PLY, OBJ or NPZ"):
        saved(full_mesh(), "npy")


def test_named_values_may_be_called_crs_where_there_is_no_coordinate_system() -> None:
    cloud = Cloud(AWKWARD, attributes={"crs": np.arange(5)})
    back = loaded(saved(cloud, "npz"), "npz")
    assert back.attributes["crs"].tolist() == [0, 1, 2, 3, 4]
    assert back.crs is None
    with pytest.raises(FormatError, match="attribute 'crs' of type int64: rename or convert it"):
        saved(Cloud(AWKWARD, attributes={"crs": np.arange(5)}, crs="EPSG:25832"), "npz")


def test_many_arrays_are_not_compared_with_each_other() -> None:
    each = np.zeros(4)
    arrays = {f"a{k}": each for k in range(60_000)} | {"points": np.zeros((4, 3))}
    begin = time.thread_time()
    assert len(_Roles(arrays, "cloud.npz").row_arrays) == 60_001
    assert time.thread_time() - begin < 3


def test_half_a_character_is_no_name_of_an_archive() -> None:
    cloud = Cloud(AWKWARD, attributes={"\ud800": np.zeros(len(AWKWARD))})
    with pytest.raises(FormatError, match=r"attribute '\\ud800' of type float64: rename"):
        saved(cloud, "npz")


def test_edges_are_pairs_of_rows_or_passed_over() -> None:
    points = np.eye(3)
    stream = io.BytesIO()
    np.savez(stream, points=points, edges=np.ones((3, 2)))
    assert loaded(stream.getvalue(), "npz").metadata["not_read"] == ("edges (3, 2)",)
    cloud = Cloud(points, edges=np.array([[0, 2], [1, 0]], np.int32))
    again = loaded(saved(cloud, "npz"), "npz")
    assert again.edges is not None
    assert again.edges.tolist() == [[0, 2], [1, 0]]
    with pytest.raises(FormatError, match="attribute 'edges'"):
        saved(Cloud(points, attributes={"edges": points}), "npz")
