"""Writing PLY: every value, in the types that readers understand, the same bytes every time."""

from __future__ import annotations

import io

import numpy as np
import pytest
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
from liftmesh import Cloud, FormatError, InputError


def header_of(data: bytes) -> list[str]:
    return data[: data.index(b"end_header\n")].decode("ascii").splitlines()


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_everything_comes_back(encoding: str) -> None:
    mesh = full_mesh()
    assert_same_mesh(loaded(saved(mesh, "ply", encoding=encoding), "ply"), mesh)


def test_the_bytes_of_a_small_mesh() -> None:
    mesh = Cloud(np.array([[1.0, 2.0, 3.0]]), faces=np.zeros((1, 3), dtype=np.int32))
    assert saved(mesh, "ply") == (
        b"ply\nformat binary_little_endian 1.0\ncomment liftmesh\nelement vertex 1\n"
        b"property double x\nproperty double y\nproperty double z\n"
        b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        + np.array([1.0, 2.0, 3.0], dtype="<f8").tobytes()
        + b"\x03"
        + bytes(12)
    )
    assert saved(mesh, "ply", encoding="ascii").endswith(b"end_header\n1.0 2.0 3.0\n3 0 0 0\n")


def test_same_mesh_same_bytes() -> None:
    assert saved(full_mesh(), "ply") == saved(full_mesh(), "ply")


def test_more_rows_than_a_block() -> None:
    points = np.random.default_rng(1).random((70_000, 3))
    faces = np.random.default_rng(2).integers(0, 70_000, (140_000, 3)).astype(np.int32)
    mesh = Cloud(points, faces=faces, attributes={"k": np.arange(70_000, dtype=np.int32)})
    for encoding in ("binary", "ascii"):
        assert_same_mesh(loaded(saved(mesh, "ply", encoding=encoding), "ply"), mesh)


@pytest.mark.parametrize(
    ("given", "written"),
    [
        (np.array([True, False]), np.array([1, 0], dtype=np.uint8)),
        (np.array([-128, 127], dtype=np.int8), np.array([-128, 127], dtype=np.int32)),
        (np.array([-5, 7], dtype=np.int16), np.array([-5, 7], dtype=np.int32)),
        (np.array([5, 7], dtype=np.uint32), np.array([5, 7], dtype=np.int32)),
        (np.array([5, 2**32 - 1], dtype=np.uint32), np.array([5.0, 2.0**32 - 1])),
        (np.array([5, -7]), np.array([5, -7], dtype=np.int32)),
        (np.array([5, 2**53]), np.array([5.0, 2.0**53])),
        (np.array([0.5, 65504], dtype=np.float16), np.array([0.5, 65504], dtype=np.float32)),
        (np.array([0.5, 0.25], dtype=">f8"), np.array([0.5, 0.25])),
        (np.array([0.5, 0.25], dtype=np.longdouble), np.array([0.5, 0.25])),
    ],
)
def test_attributes_get_the_smallest_portable_type(given: np.ndarray, written: np.ndarray) -> None:
    cloud = Cloud(AWKWARD[:2], attributes={"value": given})
    assert_same_bits(loaded(saved(cloud, "ply"), "ply").attributes["value"], written)


def test_attributes_of_several_columns_are_numbered() -> None:
    values = np.arange(10.0).reshape(5, 2)
    back = loaded(saved(Cloud(AWKWARD, attributes={"uv": values}), "ply"), "ply")
    assert list(back.attributes) == ["uv_0", "uv_1"]
    assert_same_bits(back.attributes["uv_1"], np.ascontiguousarray(values[:, 1]))


@pytest.mark.parametrize(
    ("attributes", "cause"),
    [
        ({"value": np.array([0, 2**53 + 1])}, r"2\*\*53"),
        ({"value": np.array([0, 2**64 - 1], dtype=np.uint64)}, r"2\*\*53"),
        ({"value": np.array([1, 2], dtype=np.longdouble) / 3}, "'value' of type"),
        ({"uv": np.zeros((2, 2)), "uv_1": np.zeros(2)}, "two attributes are named 'uv_1'"),
    ],
)
def test_what_ply_cannot_hold_is_refused(attributes: dict[str, np.ndarray], cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        saved(Cloud(AWKWARD[:2], attributes=attributes), "ply")


@pytest.mark.parametrize(
    "values",
    [
        np.array(["a", "b"]),
        np.array([1j, 0]),
        np.array([1, None], dtype=object),
        np.array([0, 1], dtype="M8[D]"),
    ],
    ids=["texts", "complex", "objects", "dates"],
)
def test_what_is_no_number_is_left_out_and_named(values: np.ndarray) -> None:
    cloud = Cloud(AWKWARD[:2], attributes={"value": values, "class": np.arange(2)})
    written = liftmesh.write(stream := io.BytesIO(), cloud, format="ply")
    assert written.dropped == ("value (not numbers)",)
    assert [*loaded(stream.getvalue(), "ply").attributes] == ["class"]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_float_colours_of_eight_bits_lose_nothing(dtype: type) -> None:
    levels = np.arange(256, dtype=np.uint8).repeat(3).reshape(-1, 3)
    cloud = Cloud(np.zeros((256, 3)), colors=(levels / 255).astype(dtype))
    assert_same_bits(loaded(saved(cloud, "ply"), "ply").colors, levels)


def test_colours_are_rounded_unless_asked_to_be_exact() -> None:
    wide = np.array([[0, 257, 65535], [128, 129, 40000]], dtype=np.uint16)
    cloud = Cloud(AWKWARD[:2], colors=wide)
    rounded = np.array([[0, 1, 255], [0, 1, 156]], dtype=np.uint8)
    assert_same_bits(loaded(saved(cloud, "ply"), "ply").colors, rounded)
    assert_same_bits(loaded(saved(cloud, "ply", colors="exact"), "ply").colors, wide)
    floats = Cloud(AWKWARD[:2], colors=np.array([[0.1, 0.2, 0.3, 1.0], [0, 1, 0.5, 0.25]]))
    assert_same_bits(loaded(saved(floats, "ply", colors="exact"), "ply").colors, floats.colors)


@pytest.mark.parametrize(
    ("colors", "cause"),
    [
        (np.array([[0.0, 0.0, 0.0], [0.0, 1.5, 0.0]]), r"row 1 has the colour \[0.0, 1.5, 0.0\]"),
        (np.array([[0.0, np.nan, 0.0], [0.0, 1.0, 0.0]]), "row 0"),
        (np.array([[0, 0, 0], [1, 65536, 3]]), "row 1 .* outside 0..255"),
    ],
)
def test_bad_colours_are_refused(colors: np.ndarray, cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        saved(Cloud(AWKWARD[:2], colors=colors), "ply")


def test_normals_keep_single_precision() -> None:
    normals = np.array([[0.1, 0.2, 0.3], [1, 0, 0]], dtype=np.float32)
    back = loaded(saved(Cloud(AWKWARD[:2], normals=normals), "ply"), "ply")
    assert_same_bits(back.normals, normals)


def test_comments_stand_in_the_header() -> None:
    data = saved(full_mesh(), "ply", comments=["Jacksboro, Texas", "EPSG:32614"])
    assert header_of(data)[2:5] == [
        "comment liftmesh",
        "comment Jacksboro, Texas",
        "comment EPSG:32614",
    ]
    assert "comment one line" in header_of(saved(full_mesh(), "ply", comments="one line"))


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"comments": ["two\nlines"]}, FormatError),
        ({"comments": ["é"]}, FormatError),
        ({"precision": 3}, FormatError),
        ({"encoding": "big"}, InputError),
        ({"colors": "float"}, InputError),
    ],
)
def test_bad_options_are_refused(options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error, match=next(iter(options))[:5]):
        saved(full_mesh(), "ply", **options)


def test_no_rows_and_no_faces() -> None:
    empty = Cloud(np.empty((0, 3)), faces=np.empty((0, 3), dtype=np.int32))
    for encoding in ("binary", "ascii"):
        assert_same_mesh(loaded(saved(empty, "ply", encoding=encoding), "ply"), empty)


def test_nan_coordinates_are_kept() -> None:
    cloud = Cloud(np.array([[np.nan, np.inf, -np.inf], [1.0, 2.0, 3.0]]))
    for encoding in ("binary", "ascii"):
        assert_same_mesh(loaded(saved(cloud, "ply", encoding=encoding), "ply"), cloud)


def test_strided_points_and_wide_faces() -> None:
    wide = np.zeros((5, 6))
    wide[:, ::2] = AWKWARD
    mesh = Cloud(wide[:, ::2], faces=FACES.astype(np.int64))
    assert_same_mesh(loaded(saved(mesh, "ply"), "ply"), Cloud(AWKWARD, faces=FACES))


@pytest.mark.parametrize("kind", [np.uint32, np.uint64])
def test_colours_of_wider_integers_are_not_written_exactly(kind: type) -> None:
    wide = Cloud(AWKWARD[:1], colors=np.array([[0, 200, 2**32 - 1]], dtype=kind))
    with pytest.raises(FormatError, match="cannot be written exactly as PLY: convert them to"):
        saved(wide, "ply", colors="exact")


def test_attributes_without_values_are_refused() -> None:
    with pytest.raises(FormatError, match=r"'a' has the shape \(1, 0\): it has no values"):
        saved(Cloud(AWKWARD[:1], attributes={"a": np.zeros((1, 0))}), "ply")


def test_no_header_line_is_written_that_cannot_be_read() -> None:
    for crs in ("x" * 20_000, "ß" * 5_000):
        assert loaded(saved(Cloud(AWKWARD, crs=crs), "ply"), "ply").crs == crs
    for crs in ("x" * 70_000, "ß" * 12_000):
        with pytest.raises(FormatError, match=r"has [\d,]+ characters: a line of a PLY header has"):
            saved(Cloud(AWKWARD, crs=crs), "ply")
