"""Points written as XYZ, CSV and TSV: what stands in the file, and what comes back."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from file_samples import AWKWARD, assert_same_bits, full_mesh

import liftmesh
from liftmesh import Cloud, FormatError, InputError
from liftmesh.base.colors import kept_depth
from liftmesh.io.registry import find_format

POINTS = np.array([[0.1, 2.0, -3.0], [1e300, -0.0, 5e-324]])
FACES = np.array([[0, 1, 2]], dtype=np.int32)


def written(cloud: Cloud, kind: str, **options: str) -> bytes:
    stream = io.BytesIO()
    liftmesh.write(stream, cloud, format=kind, **options)
    return stream.getvalue()


def again(cloud: Cloud, kind: str, **options: str) -> Cloud:
    data = written(cloud, kind, **options)
    return liftmesh.read(io.BytesIO(data), format=kind, nodata="none")


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ("xyz", b"0.1 2.0 -3.0\n1e+300 -0.0 5e-324\n"),
        ("txt", b"0.1 2.0 -3.0\n1e+300 -0.0 5e-324\n"),
        ("asc", b"0.1 2.0 -3.0\n1e+300 -0.0 5e-324\n"),
        ("csv", b"x,y,z\n0.1,2.0,-3.0\n1e+300,-0.0,5e-324\n"),
        (".CSV", b"x,y,z\n0.1,2.0,-3.0\n1e+300,-0.0,5e-324\n"),
        ("tsv", b"x\ty\tz\n0.1\t2.0\t-3.0\n1e+300\t-0.0\t5e-324\n"),
    ],
)
def test_the_suffix_says_what_stands_between_the_values(kind: str, text: bytes) -> None:
    assert written(Cloud(POINTS), kind) == text


def test_the_suffix_of_a_file_counts_as_a_format_does(tmp_path: Path) -> None:
    target = tmp_path / "points.Csv"
    result = liftmesh.write(target, Cloud(POINTS))
    assert target.read_bytes() == written(Cloud(POINTS), "csv")
    assert (result.format, result.bytes, result.dropped) == ("text", target.stat().st_size, ())


def test_the_delimiter_may_be_another() -> None:
    assert written(Cloud(POINTS[:1]), "csv", delimiter=";") == b"x;y;z\n0.1;2.0;-3.0\n"
    assert written(Cloud(POINTS[:1]), "csv", delimiter=" ") == b"0.1 2.0 -3.0\n"
    with pytest.raises(InputError, match=r"delimiter is '\|': known are ' ', ',', ';', '\\t'"):
        written(Cloud(POINTS), "csv", delimiter="|")


def test_columns_stand_in_order() -> None:
    cloud = Cloud(
        np.zeros((1, 3)),
        colors=np.array([[1, 2, 3, 4]], dtype=np.uint8),
        normals=np.array([[0, 0.5, 1]], dtype=np.float32),
        attributes={"class": np.array([7], dtype=np.uint8), "pair": np.array([[0.5, -1.0]])},
    )
    names = "x,y,z,nx,ny,nz,red,green,blue,alpha,class,pair_0,pair_1"
    assert written(cloud, "csv") == (
        f"{names}\n0.0,0.0,0.0,0.0,0.5,1.0,1,2,3,4,7,0.5,-1.0\n".encode()
    )
    assert written(cloud, "xyz").startswith(b"# x y z nx ny nz red")


@pytest.mark.parametrize("kind", ["xyz", "csv", "tsv"])
def test_every_value_comes_back(kind: str) -> None:
    rng = np.random.default_rng(3)
    cloud = Cloud(
        AWKWARD,
        normals=rng.normal(size=AWKWARD.shape).astype(np.float32),
        attributes={
            "single": rng.normal(size=len(AWKWARD)).astype(np.float32),
            "half": np.linspace(0, 1, len(AWKWARD)).astype(np.float16),
            "whole": rng.integers(-(2**53), 2**53, len(AWKWARD)),
            "flag": rng.random(len(AWKWARD)) < 0.5,
        },
    )
    back = again(cloud, kind)
    assert_same_bits(back.points, AWKWARD)
    assert np.array_equal(back.normals, cloud.normals)
    assert [*back.attributes] == [*cloud.attributes]
    for name, values in cloud.attributes.items():
        assert np.array_equal(back.attributes[name], values)


@pytest.mark.parametrize(
    "colors",
    [
        np.array([[0, 0, 1], [1, 1, 1]], dtype=np.uint8),  # as floats they would be black and white
        np.array([[0, 0, 0]], dtype=np.uint8),
        np.array([[0, 0, 255]], dtype=np.uint8),
        np.array([[0, 0, 1, 1]], dtype=np.uint8),
        np.array([[1, 2, 3]], dtype=np.uint16),
        np.array([[0, 0, 1]], dtype=np.uint16),
        np.array([[1, 2, 300]], dtype=np.uint16),
        np.array([[1, 2, 255]], dtype=np.uint16),
        np.array([[1, 2, 2**31]], dtype=np.uint32) * 17,
        np.array([[0.0, 1.0, 1.0]]),
        np.array([[0.1, 0.2, 0.3]], dtype=np.float32),
    ],
    ids=str,
)
@pytest.mark.parametrize("kind", ["xyz", "csv"])
def test_colours_come_back(kind: str, colors: np.ndarray) -> None:
    from liftmesh.base.colors import as_float

    points = np.zeros((len(colors), 3))
    for depth in (None, kept_depth(colors)):
        cloud = Cloud(points, colors=colors, color_depth=depth)
        back = again(cloud, kind).colors
        assert back is not None
        assert cloud.colors is not None
        assert np.array_equal(as_float(back), as_float(cloud.colors))


def test_colours_that_are_read_as_others_are_named() -> None:
    colors = np.array([[1, 2, 3]], dtype=np.uint32)
    cloud = Cloud(np.zeros((1, 3)), colors=colors, color_depth=32)
    written = liftmesh.write(io.BytesIO(), cloud, format="csv")
    assert written.dropped == ("colors beyond 8 bits",)


def test_faces_and_crs_are_named_as_dropped() -> None:
    mesh = Cloud(np.eye(3), faces=FACES, crs="EPSG:25832")
    for kind in ("xyz", "csv", "tsv"):
        assert liftmesh.write(io.BytesIO(), mesh, format=kind).dropped == ("faces", "crs")


def test_a_surface_is_written_point_by_point(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(full_mesh().points)
    assert surface.save(tmp_path / "points.csv").dropped == ("faces",)
    back = liftmesh.read(tmp_path / "points.csv", nodata="none")
    assert_same_bits(back.points, surface.vertices)


@pytest.mark.parametrize("kind", ["xyz", "csv", "tsv"])
def test_points_that_grow_like_ids_are_read_as_points(kind: str) -> None:
    rng = np.random.default_rng(4)
    cloud = Cloud(np.column_stack([np.arange(9.0), rng.random((9, 2))]))
    assert np.array_equal(again(cloud, kind).points, cloud.points)
    heights = Cloud(cloud.points[:, [1, 2, 0]])
    assert np.array_equal(again(heights, kind).points, heights.points)


def test_names_are_checked_before_there_are_faces() -> None:
    check = find_format("csv", "").check
    assert check is not None
    check(Cloud(np.eye(3), attributes={"a": np.zeros(3)}))
    for attributes in ({"x": np.zeros(3)}, {"a": np.array(["b"] * 3)}):
        with pytest.raises(FormatError, match="attribute '"):
            check(Cloud(np.eye(3), attributes=attributes))


def test_other_readers_take_the_table(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    cloud = Cloud(rng.normal(size=(50, 3)), attributes={"Größe": rng.normal(size=50)})
    rows = [*csv.reader(io.StringIO(written(cloud, "csv").decode()))]
    assert rows[0] == ["x", "y", "z", "Größe"]
    values = [[float(value) for value in row] for row in rows[1:]]
    assert np.array_equal(np.array(values)[:, :3], cloud.points)
    table = np.loadtxt(io.BytesIO(written(cloud, "tsv")), skiprows=1)
    assert np.array_equal(table[:, 3], cloud.attributes["Größe"])
    assert np.array_equal(np.loadtxt(io.BytesIO(written(cloud, "xyz", delimiter=";")), skiprows=1,
                                     delimiter=";"), table)  # fmt: skip


@pytest.mark.parametrize(
    ("names", "kind", "told"),
    [
        (["a,b"], "csv", "'a,b'"),
        (["a;b"], "csv", "'a;b'"),
        (["a\tb"], "tsv", r"'a\\tb'"),
        (["a b"], "xyz", "'a b'"),
        (["a,b"], "xyz", "'a,b'"),
        (["good", '"a"'], "csv", "'\"a\"'"),
        (["a\nb"], "csv", r"'a\\nb'"),
        (["a # b"], "csv", "'a # b'"),
        ([" a"], "csv", "' a'"),
        ([""], "csv", "''"),
        (["\ud800"], "csv", r"'\\ud800'"),
        (["good", "Elevation"], "csv", "'Elevation'"),
        (["Höhe"], "csv", "'Höhe'"),
        (["red", "green", "blue"], "csv", "'red'"),
    ],
)
def test_a_name_that_would_be_read_as_something_else_is_refused(
    names: list[str], kind: str, told: str
) -> None:
    cloud = Cloud(np.zeros((1, 3)), attributes={name: np.zeros(1) for name in names})
    with pytest.raises(FormatError, match=f"attribute {told} cannot name a column of text"):
        written(cloud, kind)


@pytest.mark.parametrize(
    ("attributes", "told"),
    [
        ({"x": np.zeros(1)}, "attribute 'x' has the name of a column of text: rename it"),
        ({"a": np.zeros((1, 2)), "a_1": np.zeros(1)}, "two attributes are named 'a_1'"),
        ({"a": np.array(["one"])}, "attribute 'a' of type <U3 .* it has no numbers"),
        ({"a": np.zeros((1, 0))}, r"attribute 'a' of type float64 and shape \(1, 0\)"),
        ({"a": np.array([np.longdouble(1) / 3])}, "type float128 cannot be written as text"),
    ],
)
def test_what_is_no_column_of_numbers_is_refused(
    attributes: dict[str, np.ndarray], told: str
) -> None:
    with pytest.raises(FormatError, match=told):
        written(Cloud(np.zeros((1, 3)), attributes=attributes), "csv")


def test_an_alpha_that_is_no_colour_is_not_joined_to_colours() -> None:
    cloud = Cloud(
        np.zeros((1, 3)), colors=np.zeros((1, 3), np.uint8), attributes={"alpha": np.zeros(1)}
    )
    with pytest.raises(FormatError, match="'alpha' cannot name a column"):
        written(cloud, "csv")


def test_whole_numbers_that_doubles_round_are_named() -> None:
    stream = io.BytesIO()
    attributes = {"id": np.array([2**53 + 1, 1]), "even": np.array([2**60, 3 << 52])}
    dropped = liftmesh.write(stream, Cloud(POINTS, attributes=attributes), format="csv").dropped
    assert dropped == ("whole numbers of id beyond 2**53",)
    assert b"9007199254740993" in stream.getvalue()
