"""Clouds of GeoJSON, GeoPackage and shapefiles: points, columns, layers and surfaces."""

from __future__ import annotations

import gzip
import io
import json
import sys
import warnings
from pathlib import Path
from typing import Any

import geopandas
import numpy as np
import pyogrio
import pytest
import shapely
from children import output
from commands import failed, liftmesh as run
from files import shapes as by_hand
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import DataWarning, FormatError, InputError

ROWS = [[0.0, 0, 1], [10, 0, 5], [0, 10, 3], [10, 10, 9], [4, 6, 7.5]]
PATCHES = [[(0, 0, 1), (4, 0, 2), (0, 4, 3)], [(4, 0, 2), (4, 4, 5), (0, 4, 3)]]
SUFFIXES = ("geojson", "gpkg", "shp")


def saved(path: Path, shapes: Any, crs: Any = 25832, **columns: Any) -> Path:
    frame = geopandas.GeoDataFrame(columns, geometry=[*shapes], crs=crs)
    frame.to_file(path)
    return path


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_command_takes_them(tmp_path: Path, suffix: str) -> None:
    saved(tmp_path / f"a.{suffix}", map(shapely.Point, ROWS), intensity=[1, 2, 3, 4, 5])
    done = run("triangulate", f"a.{suffix}", "tin.ply", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = liftmesh.read(tmp_path / "tin.ply")
    assert found.points.tolist() == ROWS
    assert found.attributes["intensity"].tolist() == [1, 2, 3, 4, 5]
    assert found.crs == "EPSG:25832"
    told = json.loads(run("info", f"a.{suffix}", "--json", cwd=tmp_path).stdout)
    assert told["n_rows"] == 5
    lines = run("contour", f"a.{suffix}", "lines.gpkg", "--interval", "2", cwd=tmp_path)
    assert lines.returncode == 0, lines.stderr
    chunks = [*liftmesh.read_chunks(tmp_path / f"a.{suffix}", rows=2)]
    assert np.concatenate([each.points for each in chunks]).tolist() == ROWS
    with pytest.raises(FormatError, match="cannot be written"):
        liftmesh.write(tmp_path / f"b.{suffix}", found)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_several_points_of_one_feature(tmp_path: Path, suffix: str) -> None:
    several = [shapely.MultiPoint(ROWS[:2]), shapely.MultiPoint(ROWS[2:])]
    path = saved(tmp_path / f"a.{suffix}", [*several, None], id=[3, 4, 5], owner=["A", None, "Ä"])
    found = liftmesh.read(path)
    assert found.points.tolist() == ROWS
    assert found.attributes["id"].tolist() == [3, 3, 4, 4, 4]
    assert found.metadata["not_read"] == ("column owner (object)",)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_heights_may_be_a_column(tmp_path: Path, suffix: str) -> None:
    planar = [shapely.Point(row[:2]) for row in ROWS]
    heights = [row[2] for row in ROWS]
    path = saved(tmp_path / f"a.{suffix}", planar, elevation=heights)
    assert liftmesh.read(path).points.tolist() == ROWS
    path = saved(tmp_path / f"b.{suffix}", planar, h2=heights)
    with pytest.raises(FormatError, match=rf"b\.{suffix}: no column of 'x', 'y', 'h2' is known as"):
        liftmesh.read(path)
    assert liftmesh.read(path, columns="x=x,y=y,z=h2").points.tolist() == ROWS
    assert liftmesh.read(path, columns="x=x,y=y,z=-h2").points[4, 2] == -7.5
    assert not liftmesh.read(path, flat=True).points[:, 2].any()
    done = run("triangulate", path, tmp_path / "tin.ply", "--columns", "x=x,y=y,z=h2")
    assert done.returncode == 0, done.stderr
    path = saved(tmp_path / f"c.{suffix}", planar, h=[1, 2, -9999, 4, 5])
    marked = liftmesh.read(path, columns="x=x,y=y,z=h", nodata=-9999)
    assert np.isnan(marked.points[2, 2])
    with pytest.raises(InputError, match="flat"):
        liftmesh.read(path, flat=3)  # type: ignore[arg-type]


def test_the_system_is_that_of_the_file(tmp_path: Path) -> None:
    degrees = [[8.1, 49.2, 100], [8.2, 49.2, 120], [8.1, 49.3, 90]]
    features = [{"type": "Feature", "properties": None, "geometry": shapely.geometry.mapping(each)}
                for each in map(shapely.Point, degrees)]  # fmt: skip
    tree: dict[str, Any] = {"type": "FeatureCollection", "features": features}
    path = tmp_path / "a.geojson"
    path.write_text(json.dumps(tree))
    assert liftmesh.read(path).crs == "EPSG:4326"  # RFC 7946
    path.write_text(json.dumps({**tree, "crs": None}))
    assert liftmesh.read(path).crs is None
    system = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    path.write_text(json.dumps({"crs": system, **tree}))
    assert liftmesh.read(path).crs == "EPSG:25832"
    path.write_text(json.dumps({"type": "MultiPoint", "coordinates": [*ROWS[:3], [400, 0, 1]]}))
    assert liftmesh.read(path).crs is None  # no degrees
    system["properties"]["name"] = "nonsense"  # type: ignore[index]
    path.write_text(json.dumps({"crs": system, **tree}))
    with pytest.warns(DataWarning, match="its coordinate system is not known"):
        assert liftmesh.read(path).crs is None
    for suffix in ("gpkg", "shp"):
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", ".*'crs' was not provided", UserWarning)
            path = saved(tmp_path / f"b.{suffix}", map(shapely.Point, ROWS), None)
        assert liftmesh.read(path).crs is None


def test_one_layer_of_several(tmp_path: Path) -> None:
    frame = geopandas.GeoDataFrame(geometry=[*map(shapely.Point, ROWS)], crs=25832)
    path = tmp_path / "a.gpkg"
    frame.to_file(path, layer="first")
    assert len(liftmesh.read(path)) == 5
    frame[:3].to_file(path, layer="second Ü")
    with pytest.raises(FormatError, match=r"'first', 'second Ü': choose one with layer="):
        liftmesh.read(path)
    assert len(liftmesh.read(path, layer="second Ü")) == 3
    with pytest.raises(FormatError, match=r"but not 'third': choose one with layer="):
        liftmesh.read(path, layer="third")
    with pytest.raises(InputError, match="layer is 3"):
        liftmesh.read(path, layer=3)  # type: ignore[arg-type]
    done = run("triangulate", "a.gpkg", "tin.ply", cwd=tmp_path)
    failed(done, 3, "choose one with --layer")
    done = run("triangulate", "a.gpkg", "tin.ply", "--layer", "first", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def write_by_gdal(path: Path, shape: bytes) -> None:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*non-standard", RuntimeWarning)
        pyogrio.raw.write(
            path, np.array([shape], object), [np.array([7])], ["id"], crs="EPSG:25832",
            geometry_type="Unknown", driver="GPKG" if path.suffix == ".gpkg" else "ESRI Shapefile",
        )  # fmt: skip


@pytest.mark.parametrize("suffix", ["gpkg", "shp"])
@pytest.mark.parametrize("kind", [1015, 1016])
def test_surfaces_that_gdal_writes(tmp_path: Path, suffix: str, kind: int) -> None:
    path = tmp_path / f"a.{suffix}"
    write_by_gdal(path, by_hand.surface(PATCHES, kind))
    found = liftmesh.read(path)
    corners = [[[*map(float, corner)] for corner in each] for each in PATCHES]
    assert found.points[found.faces].tolist() == corners
    assert (len(found), found.crs) == (4, "EPSG:25832")
    assert found.metadata["not_read"] == ("column id",)
    surface = liftmesh.as_surface(found)
    assert surface.sample([[1, 1]])[0] == 1.75
    done = run("raster", path, tmp_path / "a.tif", "--resolution", "1")
    assert done.returncode == 0, done.stderr


def test_patches_of_any_size_and_points_beside_them() -> None:
    square = [(0, 0, 1), (4, 0, 1), (4, 4, 1), (0, 4, 1)]
    shapes = [by_hand.surface([square], 1015), by_hand.point(9, 9, 9), by_hand.point(0, 0, 1)]
    found = liftmesh.read(io.BytesIO(by_hand.geopackage(shapes)), format="gpkg")
    assert found.points[:2].tolist() == [[9, 9, 9], [0, 0, 1]]
    assert found.faces.tolist() == [[2, 3, 4], [2, 4, 5]]
    flat = by_hand.surface([square[:3]])[9:]  # a triangle by itself
    with pytest.raises(FormatError, match="patch 0 has 2 corners"):
        liftmesh.read(
            io.BytesIO(by_hand.geopackage([by_hand.surface([square[:2]])])), format="gpkg"
        )
    found = liftmesh.read(io.BytesIO(by_hand.geopackage([flat], srs=7)), format="gpkg")
    assert (len(found), found.crs) == (3, None)


def test_strips_fans_and_rings_of_a_multipatch() -> None:
    """Parts of kind 0 to 5, as Esri's white paper has them."""
    strip = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0), (2, 0, 0)]
    fan = [(5, 5, 0), (6, 5, 0), (6, 6, 0), (5, 6, 0)]
    ring = [(8, 8, 0), (9, 8, 0), (9, 9, 0), (8, 8, 0)]
    hole = [(8.4, 8.2, 0), (8.6, 8.4, 0), (8.6, 8.2, 0), (8.4, 8.2, 0)]
    parts = [(0, strip), (1, fan), (2, ring), (2, ring), (3, hole), (5, ring)]
    data = by_hand.shp(31, [by_hand.shp_patches(parts), None])
    found = liftmesh.read(io.BytesIO(data), format="shp")
    corners = found.points[found.faces][:, :, :2]
    assert corners[:3].tolist() == [
        [[0, 0], [0, 1], [1, 0]], [[1, 1], [1, 0], [0, 1]], [[1, 0], [1, 1], [2, 0]]
    ]  # fmt: skip
    assert corners[3:5].tolist() == [[[5, 5], [6, 5], [6, 6]], [[5, 5], [6, 6], [5, 6]]]
    assert (liftmesh.orient2d(*corners[:3].transpose(1, 0, 2)) == -1).all()
    assert len(corners) == 7
    assert found.metadata["not_read"] == ("1 holed polygon",)


@given(
    st.lists(
        st.tuples(
            *[st.floats(allow_nan=False, allow_infinity=False)] * 3,
            st.integers(-(2**63), 2**63 - 1),
        ),
        min_size=1,
        max_size=9,
    )
)
@settings(max_examples=30)
def test_every_bit_is_kept(rows: list[tuple[float, float, float, int]]) -> None:
    places, ids = [row[:3] for row in rows], [row[3] for row in rows]
    features = [
        {
            "type": "Feature",
            "properties": {"id": k},
            "geometry": {"type": "Point", "coordinates": p},
        }
        for p, k in zip(places, ids, strict=True)
    ]
    text = json.dumps({"type": "FeatureCollection", "features": features}).encode()
    package = by_hand.geopackage([by_hand.point(*each) for each in places], {"id": ids})
    for data, kind in ((text, "geojson"), (package, "gpkg"), (by_hand.shp_points(places), "shp")):
        found = liftmesh.read(io.BytesIO(data), format=kind, nodata="none")
        assert found.points.tobytes() == np.array(places).tobytes()
        assert kind == "shp" or found.attributes["id"].tolist() == ids


def test_streams_and_compressed_files(tmp_path: Path) -> None:
    text = json.dumps({"type": "MultiPoint", "coordinates": ROWS}).encode()
    (tmp_path / "a.geojson.gz").write_bytes(gzip.compress(text))
    assert liftmesh.read(tmp_path / "a.geojson.gz").points.tolist() == ROWS
    assert len(liftmesh.read(io.BytesIO(b"\xef\xbb\xbf" + text), format="geojson")) == 5
    data = bytearray(by_hand.geopackage([by_hand.point(*each) for each in ROWS]))
    data[18:20] = b"\2\2"  # as of a file that had a journal of its own
    assert liftmesh.read(io.BytesIO(data), format="gpkg").points.tolist() == ROWS
    (tmp_path / "a.gpkg").write_bytes(data)
    (tmp_path / "a.gpkg-wal").write_bytes(b"changes")
    with pytest.raises(FormatError, match=r"changes wait in a\.gpkg-wal"):
        liftmesh.read(tmp_path / "a.gpkg")
    assert sorted(each.name for each in tmp_path.iterdir()) == [
        "a.geojson.gz", "a.gpkg", "a.gpkg-wal",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("data", "kind", "said"),
    [
        (b"{", "geojson", "not GeoJSON"),
        (b"[1, 2]", "geojson", "there is no Point"),
        (b'{"type": "Point", "coordinates": [1, "a"]}', "geojson", "point 0 is"),
        (b'{"type": "Point", "coordinates": [1, 2, null]}', "geojson", "point 0 is"),
        (b'{"type": "TIN", "coordinates": [3]}', "geojson", "no GeoJSON"),
        (b'{"type": "TIN", "coordinates": [[[[1, 2], [1, 2]]]]}', "geojson", "patch 0 has"),
        (b"[" * 100_000, "geojson", "not GeoJSON"),
        (b"\xff", "geojson", "not GeoJSON"),
        (b"x,y,z\n1,2,3\n", "gpkg", "no GeoPackage"),
        (b"SQLite format 3\0" + bytes(84), "gpkg", "no GeoPackage"),
        (b"x,y,z\n", "shp", "no shapefile"),
        (by_hand.shp(31, [b"abc"]), "shp", "no shapefile"),
        (by_hand.shp(11, [None]), "shp", "there is no Point"),
        (by_hand.shp(9, [bytes(40)]), "shp", "shapes of type 9 are unknown"),
        (
            by_hand.shp(31, [bytes(32) + b"\1\0\0\0" * 4 + bytes(40)]),
            "shp",
            "do not begin one after",
        ),
        (by_hand.shp(31, [by_hand.shp_patches([(2, ROWS[:2])])]), "shp", "patch 0 has 2 corners"),
        (by_hand.geopackage([by_hand.point(np.inf, 1, 2)]), "gpkg", "point 0 is"),
        (by_hand.geopackage([by_hand.point(1, 2, 3)], layers=()), "gpkg", "no layer of features"),
    ],
    ids=range(18),
)
def test_what_is_none_is_one_error(data: bytes, kind: str, said: str) -> None:
    with pytest.raises(FormatError, match=said) as caught:
        liftmesh.read(io.BytesIO(data), format=kind)
    assert "\n" not in str(caught.value)


def test_json_that_describes_far_more_than_its_text(tmp_path: Path) -> None:
    path = tmp_path / "a.geojson"
    path.write_text('{"type": "MultiPoint", "coordinates": [' + "[1,2]," * 400_000 + "[1,2]]}")
    with pytest.raises(FormatError, match=r"expands to .* raise it with max_bytes="):
        liftmesh.read(path)
    assert len(liftmesh.read(path, max_bytes=1 << 30)) == 400_001


def test_no_library_of_maps_is_loaded(tmp_path: Path) -> None:
    (tmp_path / "a.geojson").write_text(json.dumps({"type": "MultiPoint", "coordinates": ROWS}))
    (tmp_path / "a.gpkg").write_bytes(by_hand.geopackage([by_hand.point(*each) for each in ROWS]))
    (tmp_path / "a.shp").write_bytes(by_hand.shp_points(ROWS))
    program = (
        "import sys, liftmesh\n"
        "for each in ('geojson', 'gpkg', 'shp'):\n"
        f"    liftmesh.read(f'{tmp_path}/a.{{each}}')\n"
        "print(sorted({'geopandas', 'pyogrio', 'shapely', 'pandas'} & {*sys.modules}))"
    )
    assert output(program).strip() == "[]"
    assert sys.version_info
