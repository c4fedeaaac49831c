"""Tables in memory: read by the names of their columns, like the same table as text."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pandas as pd
import polars as pl
import pytest
import trimesh
from file_samples import assert_same_bits

import liftmesh
from liftmesh import Cloud, DataWarning, InputError, UnsupportedTypeError, as_cloud

VALUES: dict[str, list[Any]] = {
    "Northing": [10.25, 20, 30.5, 35],
    "Easting": [1.0, 2.5, 3, 1],
    "name": ["a", "b", "c", "d"],
    "Höhe [m]": [7.5, 8, 9, 10],
    "R": [0, 128, 255, 1],
    "G": [1, 2, 3, 4],
    "B": [9, 8, 7, 6],
    "class": [2, 2, 6, 1],
}


def structured(columns: dict[str, list[Any]]) -> np.ndarray:
    return np.rec.fromarrays([np.array(each) for each in columns.values()], names=[*columns])


def as_text(columns: dict[str, list[Any]]) -> Cloud:
    data = pd.DataFrame(columns).to_csv(index=False).encode()
    return liftmesh.read(io.BytesIO(data), format="csv")


MAKERS = {"pandas": pd.DataFrame, "polars": pl.DataFrame, "structured": structured}


def assert_same(cloud: Cloud, other: Cloud) -> None:
    assert_same_bits(cloud.points, other.points)
    assert (cloud.colors is None) == (other.colors is None)
    if cloud.colors is not None and other.colors is not None:
        assert_same_bits(cloud.colors, other.colors)
    assert cloud.attributes.keys() == other.attributes.keys()
    for name, values in cloud.attributes.items():
        assert np.array_equal(values, other.attributes[name], equal_nan=True)
    assert cloud.metadata["columns"] == other.metadata["columns"]


@pytest.mark.parametrize("kind", MAKERS)
def test_a_table_is_read_like_the_same_table_as_text(kind: str) -> None:
    cloud = as_cloud(MAKERS[kind](VALUES))
    assert_same(cloud, as_text(VALUES))
    assert cloud.points[0].tolist() == [1, 10.25, 7.5]
    assert cloud.colors is not None
    assert cloud.colors.dtype == np.uint8
    assert [each.split(" (")[0] for each in cloud.metadata["not_read"]] == ["column name"]


@pytest.mark.parametrize("kind", MAKERS)
def test_the_order_of_the_columns_does_not_matter(kind: str) -> None:
    table = {name: VALUES[name] for name in ("Höhe [m]", "Northing", "Easting")}
    surface = liftmesh.triangulate(MAKERS[kind](table))
    assert surface.vertices[0].tolist() == [1, 10.25, 7.5]
    assert dict(surface.report.columns) == {"x": "Easting", "y": "Northing", "z": "Höhe [m]"}
    assert "x is 'Easting'" in str(surface.report)


@pytest.mark.parametrize("kind", MAKERS)
def test_what_text_refuses_is_refused(kind: str) -> None:
    make = MAKERS[kind]
    unknown = {"x": [1.0, 2], "y": [3.0, 4], "GroundZ": [5.0, 6]}
    with pytest.raises(InputError, match="no column of 'x', 'y', 'GroundZ' is known as the height"):
        as_cloud(make(unknown))
    assert as_cloud(make(unknown), columns="z=GroundZ").points[0].tolist() == [1, 3, 5]
    assert liftmesh.triangulate(
        make(unknown | {"x": [1.0, 2, 3], "y": [3.0, 4, 6], "GroundZ": [1.0, 2, 3]}),
        columns={"z": "GroundZ"},
    ).vertices[0].tolist() == [1, 3, 1]
    assert as_cloud(make(unknown), flat=True).points[0].tolist() == [1, 3, 0]
    with pytest.raises(InputError, match=r"may count downwards .*columns='z=-Depth'"):
        as_cloud(make({"x": [1.0], "y": [2.0], "Depth": [3.0]}))
    with pytest.raises(InputError, match=r"z is -9999 in 1 of 3 rows.*nodata='-9999'"):
        as_cloud(make({"x": [1, 2, 3], "y": [1, 2, 4], "z": [5, 6, -9999]}))
    with pytest.raises(InputError, match="has no column x or y: read it with columns="):
        as_cloud(make({"a": [1.0], "b": [2.0]}))
    with pytest.raises(InputError, match="z is the column 'z', which holds no numbers"):
        as_cloud(make({"x": [1.0], "y": [2.0], "z": ["low"]}))
    with pytest.warns(DataWarning, match="degrees"):
        as_cloud(make({"lng": [1.0], "lat": [2.0], "alt": [2.0]}))


@pytest.mark.parametrize("kind", ["pandas", "polars"])
@pytest.mark.parametrize("heights", [["1.5", "low", "2"], ["312,4", "310,1", "315"]])
def test_a_height_as_text_is_not_ignored(kind: str, heights: list[str]) -> None:
    table = MAKERS[kind]({"x": [0, 4, 0], "y": [0, 0, 3], "GroundZ": heights})
    with pytest.raises(InputError, match="known as the height z, and 'GroundZ' holds numbers"):
        as_cloud(table)
    words = MAKERS[kind]({"x": [0, 4, 0], "y": [0, 0, 3], "name": ["a", "b", None]})
    assert as_cloud(words).points[:, 2].tolist() == [0, 0, 0]


def test_a_coordinate_as_text_is_shown() -> None:
    table = pd.DataFrame({"x": [0, 4], "y": [0, 3], "z": ["1.5", "low"]})
    with pytest.raises(InputError, match=r"'z', which holds no numbers \(row 1: 'low'\): convert"):
        as_cloud(table)
    table["z"] = ["312,4", "310,1"]
    with pytest.raises(InputError, match=r"\(row 0: '312,4'\): convert it to numbers, or name"):
        as_cloud(table)
    with pytest.raises(InputError, match=r"'z', which holds no numbers: convert"):
        as_cloud(table.assign(z=pd.to_datetime(["2020", "2021"])))


def test_ids_beside_missing_ones_are_told_if_doubles_round_them() -> None:
    table = pd.DataFrame({"x": [0, 4, 0], "y": [0, 0, 3], "z": [1, 2, 3]})
    rounded = ("column id: numbers from 2**53 on are rounded to doubles",)
    for kind in ("Int64", object):
        ids = pd.Series([2**53 + 1, None, 3], dtype=kind)
        told = as_cloud(table.assign(id=ids)).metadata["notes"]
        assert told == rounded
        assert "notes" not in as_cloud(table.assign(id=ids - 1)).metadata
    frame = pl.DataFrame({"x": [0, 4], "y": [0, 3], "z": [1, 2], "id": [2**53 + 1, None]})
    assert as_cloud(frame).metadata["notes"] == rounded
    with pytest.raises(InputError, match=r"row 1 holds 9007199254740993 in column 'z', which fl"):
        as_cloud(table.assign(z=[1, 2**53 + 1, 3]))


def test_readers_and_lists_of_arrays_get_a_sentence(tmp_path: Path) -> None:
    data = laspy.LasData(laspy.LasHeader(point_format=3, version="1.2"))
    data.write(tmp_path / "empty.las")
    with (
        laspy.open(tmp_path / "empty.las") as reader,
        pytest.raises(
            UnsupportedTypeError, match=r"LasReader is a table.*what its read\(\) returns"
        ),
    ):
        as_cloud(reader)
    rows = structured({"x": [1, 2, 3], "y": [3, 4, 5], "z": [5, 6, 7]})
    with pytest.raises(InputError, match="a list of 2 structured arrays is no table: give one of"):
        as_cloud([rows, rows])
    assert len(as_cloud(np.concatenate([rows, rows]))) == 6


def test_a_structured_array_of_two_dimensions_gets_a_sentence() -> None:
    rows = structured({"x": [1, 2, 3, 4], "y": [3, 4, 5, 6], "z": [5, 6, 7, 8]})
    with pytest.raises(InputError, match=r"of the shape \(2, 2\) is no list of rows: give its rav"):
        as_cloud(rows.reshape(2, 2))
    assert as_cloud(rows.reshape(2, 2).ravel()).points[3].tolist() == [4, 6, 8]


def test_nodata_becomes_nan() -> None:
    table = pd.DataFrame({"x": [1, 2, 3], "y": [1, 2, 4], "z": [5, 6, -9999], "w": [-9999, 1, 2]})
    cloud = as_cloud(table, nodata=-9999)
    assert np.isnan(cloud.points[2, 2])
    assert np.isnan(cloud.attributes["w"][0])
    assert as_cloud(table, nodata="none").points[2, 2] == -9999


def test_missing_values_of_pandas_and_polars_are_nan() -> None:
    columns = {"x": [1, 2, 3], "y": [1.5, None, 4], "z": [5, None, 7]}
    frames = [
        pd.DataFrame(columns),
        pd.DataFrame(columns).convert_dtypes(),
        pd.DataFrame(columns, dtype=object),
        pl.DataFrame(columns),
    ]
    for frame in frames:
        points = as_cloud(frame).points
        assert np.array_equal(points, [[1, 1.5, 5], [2, np.nan, np.nan], [3, 4, 7]], equal_nan=True)
    masked = np.ma.array(structured({"x": [1, 2], "y": [3, 4], "z": [5, 6]}))
    masked["z"][1] = np.ma.masked
    assert np.isnan(as_cloud(masked).points[1, 2])


def test_types_of_values_are_kept_and_dates_are_named() -> None:
    table = pd.DataFrame(
        {
            "x": [1.0],
            "y": [2.0],
            "z": [3.0],
            "big": np.array([2**60 + 1]),
            "small": np.array([7], dtype=np.uint8),
            "ok": [True],
            "when": pd.to_datetime(["2019-05-01"]),
        }
    )
    cloud = as_cloud(table)
    types = {name: values.dtype for name, values in cloud.attributes.items()}
    assert types == {"big": np.int64, "small": np.uint8, "ok": np.uint8}
    assert cloud.attributes["big"][0] == 2**60 + 1
    assert "column when (datetime64" in cloud.metadata["not_read"][0]


def test_coordinates_that_float64_cannot_hold_are_refused() -> None:
    with pytest.raises(InputError, match="float64 does not represent exactly"):
        as_cloud(pd.DataFrame({"x": [1.0], "y": [2.0], "z": [2**60 + 1]}))


def test_points_of_pdal() -> None:
    kinds = [("X", "<f8"), ("Y", "<f8"), ("Z", "<f8"), ("Intensity", "<u2"), ("Red", "<u2")]
    kinds += [("Green", "<u2"), ("Blue", "<u2"), ("NormalX", "<f8"), ("NormalY", "<f8")]
    view = np.zeros(3, dtype=[*kinds, ("NormalZ", "<f8"), ("HeightAboveGround", "<f8")])
    view["X"], view["Red"], view["NormalZ"] = [1, 2, 3], [0, 256, 65535], 1
    cloud = as_cloud(view)
    assert cloud.points[:, 0].tolist() == [1, 2, 3]
    assert cloud.colors is not None
    assert cloud.colors.dtype == np.uint16
    assert cloud.normals is not None
    assert cloud.normals[0].tolist() == [0, 0, 1]
    assert [*cloud.attributes] == ["Intensity", "HeightAboveGround"]


def test_points_of_laspy() -> None:
    las = laspy.create(point_format=3, file_version="1.2")
    las.header.scales, las.header.offsets = [0.01] * 3, [1000, 0, 0]
    las.add_extra_dim(laspy.ExtraBytesParams("height", "f4"))
    las.header.vlrs.append(laspy.vlrs.known.WktCoordinateSystemVlr('PROJCRS["ETRS89"]'))
    las.x, las.y, las.z = np.array([[1001.5, 1002, 1003], [4, 5.25, 6], [1.5, 2.5, 3.25]])
    las.red, las.classification = np.array([1, 2, 65535]), np.array([2, 2, 6])
    cloud = as_cloud(las)
    assert cloud.points.tolist() == [*map(list, zip(las.x, las.y, las.z, strict=True))]
    assert cloud.colors is not None
    assert cloud.colors[:, 0].tolist() == [1, 2, 65535]
    assert cloud.attributes["classification"].tolist() == [2, 2, 6]
    assert "height" in cloud.attributes
    assert cloud.crs == 'PROJCRS["ETRS89"]'
    assert_same_bits(as_cloud(las.points).points, cloud.points)


def test_arrays_of_more_columns_need_their_names() -> None:
    rows = np.array(
        [[1, 2, 3, 255, 0, 9], [4, 5, 6, 1, 2, 3], [7, 1, 9, 1, 2, 3], [1, 1, 1, 0, 0, 0]]
    )
    with pytest.raises(InputError, match=r"columns='x,y,z,red,green,blue'"):
        as_cloud(rows)
    for given in (rows, rows.tolist(), rows.astype(float)):
        cloud = as_cloud(given, columns="x,y,z,red,green,blue")
        assert cloud.points.tolist() == rows[:, :3].tolist()
        assert_same_bits(cloud.colors, rows[:, 3:].astype(np.uint8))
    swapped = liftmesh.triangulate(rows, columns=["y", "x", "z", None, "w", "v"])
    assert swapped.vertices[:, 0].tolist() == rows[:, 1].tolist()
    assert [*swapped.attributes] == ["w", "v"]


class Rows:
    """A table of an unknown library."""

    columns = ("x", "y", "z")

    def __getitem__(self, name: str) -> list[float]:
        return [0.0]

    def __len__(self) -> int:
        return 1

    def to_pandas(self) -> None:
        """Convert the table."""


@pytest.mark.parametrize(
    ("source", "how"),
    [
        (pl.DataFrame(VALUES).lazy(), r"give what its collect\(\) returns"),
        (Rows(), r"give what its to_pandas\(\) returns"),
    ],
)
def test_other_tables_are_refused_with_how_to_convert_them(source: object, how: str) -> None:
    with pytest.raises(UnsupportedTypeError, match=f"is a table, but not one that is read.*{how}"):
        as_cloud(source)


def test_dicts_of_columns_are_refused_with_how_to_join_them() -> None:
    with pytest.raises(InputError, match=r"np\.column_stack\(\[points\['x'\], points\['y'\]\]\)"):
        as_cloud({"x": [1.0], "y": [2.0]})


def test_options_of_tables_are_for_tables() -> None:
    with pytest.raises(InputError, match="columns= cannot be given: a liftmesh"):
        as_cloud(Cloud(np.zeros((3, 3))), columns="x,y,z")
    with pytest.raises(InputError, match="decimal= is for files: an object takes columns, flat"):
        as_cloud(np.zeros((3, 3)), decimal=",")
    with pytest.raises(InputError, match="of a table, not of the shape"):
        as_cloud(np.zeros(3), columns="x,y,z")


def test_a_scene_is_one_cloud() -> None:
    scene = trimesh.Scene([trimesh.PointCloud(np.eye(3)), trimesh.creation.box()])
    assert len(as_cloud(scene)) == 11


def test_no_library_of_tables_is_imported() -> None:
    code = (
        "import sys, liftmesh; liftmesh.as_cloud([[0, 0, 1]]);"
        "print({'pandas', 'polars', 'laspy'} & {*sys.modules})"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout == "set()\n"


@pytest.mark.parametrize("function", [liftmesh.delaunay, liftmesh.lift, liftmesh.lower_hull])
def test_arrays_of_records_are_points_for_every_function(function: Any) -> None:
    rows = np.random.default_rng(4).random((20, 3))
    records = np.empty(20, dtype=[("Z", "f8"), ("X", "f8"), ("Y", "f8")])  # as PDAL names them
    records["X"], records["Y"], records["Z"] = rows.T
    assert same(function(records)) == same(function(rows))


def same(result: Any) -> list[Any]:
    """Return the triangles or rows of a result."""
    for name in "simplices", "faces":
        result = getattr(result, name, result)
    return result.tolist()


def test_columns_that_are_no_numbers_are_named_in_what_is_written() -> None:
    frame = pd.DataFrame({"x": [0.0, 1, 0], "y": [0.0, 0, 1], "z": [1, 2, 3], "code": [*"abc"]})
    (lost,) = liftmesh.write(io.BytesIO(), frame, format="ply").dropped
    assert lost.startswith("column code (")
    assert liftmesh.triangulate(frame).save(io.BytesIO(), format="ply").dropped == (lost,)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_colours_of_floats_are_rounded_to_8_bits_only_where_they_are_these(dtype: type) -> None:
    eighths = np.array([0, 51, 254, 255]) / 255
    near = eighths + np.array([0, 4e-7, 0, 0])
    for shades in (eighths, near):
        column = shades.astype(dtype)
        table = {"x": [0.0, 1, 0, 1], "y": [0.0, 0, 1, 1], "z": [5.0, 6, 7, 8]}
        cloud = as_cloud(pd.DataFrame({**table, "r": column, "g": column, "b": column}))
        assert cloud.colors is not None
        if shades is eighths:
            assert cloud.colors[:, 0].tolist() == [0, 51, 254, 255]
        else:
            assert_same_bits(cloud.colors[:, 0], column)
