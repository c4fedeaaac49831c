"""Cells as GeoDataFrames and files: whose values they carry, and what is said of the others."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path
from typing import Any

import geopandas
import meshio
import numpy as np
import pandas as pd
import polars as pl
import pytest
import shapely
import trimesh

import liftmesh

RNG = np.random.default_rng(1806)
POINTS = RNG.random((30, 2)) * 10
LAKE = shapely.Point(5, 5).buffer(1.3)
COUNTRY = shapely.MultiPolygon(
    [
        shapely.Polygon([(0, 0), (9, 1), (10, 9), (4, 4), (1, 9)]) - LAKE,
        shapely.Point(5, 5).buffer(0.3),
    ]
)
CELLS = liftmesh.voronoi(POINTS, domain=COUNTRY)


def written(kind: str, columns: dict[str, Any], cells: liftmesh.Cells = CELLS) -> Any:
    stream = io.BytesIO()
    done = cells.save(stream, columns, format=kind, crs="EPSG:32633")
    assert (done.path, done.format, done.bytes) == (None, kind, len(stream.getvalue()))
    return done.dropped, io.BytesIO(stream.getvalue())


def test_no_column_of_the_caller_is_replaced() -> None:
    held = {"area": np.arange(30), "geometry": np.arange(30) + 0.5, "cell_geometry": [*"ab"] * 15}
    frame = CELLS.to_geodataframe(held)
    assert [*frame.columns] == [*held, "cell_area", "cell_cell_geometry"]
    assert frame["area"].tolist() == [*range(30)]
    np.testing.assert_array_equal(frame["cell_area"], CELLS.areas)
    np.testing.assert_allclose(frame.geometry.area, CELLS.areas)


def test_tables_give_their_index_and_system() -> None:
    rows = geopandas.points_from_xy(*POINTS.T)
    names = pd.Index([f"site {i}" for i in range(30)])
    schools = geopandas.GeoDataFrame(
        {"pupils": np.arange(30)}, index=names, geometry=rows, crs="EPSG:32633"
    )
    frame = CELLS.to_geodataframe(schools)
    assert (frame.crs, frame.index.equals(names)) == ("EPSG:32633", True)
    assert [*frame.columns] == ["pupils", "area", "geometry"]
    np.testing.assert_allclose(frame.geometry.area, CELLS.areas)
    assert CELLS.to_geodataframe(schools, crs="EPSG:32633").crs == "EPSG:32633"
    with pytest.raises(liftmesh.InputError, match="data are in 'WGS 84 / UTM zone 33N'"):
        CELLS.to_geodataframe(schools, crs="EPSG:4326")
    assert CELLS.to_geodataframe(pl.DataFrame({"v": range(30)}))["v"].tolist() == [*range(30)]
    shuffled = pd.Series(np.arange(30), index=RNG.permutation(30))
    assert CELLS.to_geodataframe({"v": shuffled})["v"].tolist() == [*range(30)]


WRONG = [
    ({"x": [1, 2]}, "column 'x' has 2 values for 30 rows"),
    ({"x": np.zeros((30, 2))}, r"column 'x' has the shape \(30, 2\)"),
    ({"x": "abc"}, "column 'x' is 'abc'"),
    (pd.DataFrame({"x": [1]}), "data has 1 value for 30 rows"),
    (5, "data is 5: give a mapping"),
]


@pytest.mark.parametrize(("data", "message"), WRONG)
def test_bad_columns_are_named(data: Any, message: str) -> None:
    with pytest.raises(liftmesh.InputError, match=message):
        CELLS.to_geodataframe(data)


def test_geojson_says_what_it_cannot_hold() -> None:
    columns = {
        "v": np.r_[1.5, np.nan, np.inf, np.zeros(27)],
        "pair": np.arange(60).reshape(30, 2),
        "is": np.arange(30) > 3,
        "name": np.array(['"ö"'] * 30),
        "wave": np.ones(30, dtype=complex),
    }
    dropped, stream = written("geojson", columns)
    assert dropped == ("wave (complex128)", "v (1 infinite)")
    data = json.load(stream, parse_constant=pytest.fail)
    assert data["crs"]["properties"]["name"] == "urn:ogc:def:crs:EPSG::32633"
    stream.seek(0)
    assert geopandas.read_file(stream).crs == "EPSG:32633"
    held = [each["properties"] for each in data["features"]]
    assert [each["v"] for each in held[:3]] == [1.5, None, None]
    assert (held[4]["pair_1"], held[4]["is"], held[4]["name"]) == (9, True, '"ö"')
    assert [each["area"] for each in held] == CELLS.areas.tolist()
    shapes = [
        each["geometry"] and shapely.geometry.shape(each["geometry"]) for each in data["features"]
    ]
    for row, shape in enumerate(shapes):
        assert shape == CELLS.to_shapely()[row] if shape else row in CELLS.empty


@pytest.mark.slow
def test_geojson_is_written_in_blocks() -> None:
    points = RNG.random((20_000, 2))
    many = liftmesh.voronoi(points)
    pieces: list[bytes] = []
    stream = type("Stream", (), {"write": lambda _, data: pieces.append(data)})()
    many.save(stream, format="geojson")
    assert len(pieces) == 5
    found = json.loads(b"".join(pieces))["features"]
    assert [each["properties"]["row"] for each in found] == [*range(20_000)]
    assert [each["properties"]["area"] for each in found] == many.areas.tolist()


def test_a_geopackage_tells_fewer_names_apart(tmp_path: Path) -> None:
    columns = {name: np.arange(30.0) for name in ("Area", "fid", "geom", "ROW")}
    dropped, stream = written("gpkg", columns)
    assert dropped == ()
    (tmp_path / "cells.gpkg").write_bytes(stream.getvalue())
    frame = geopandas.read_file(tmp_path / "cells.gpkg")
    assert [*frame.columns] == ["cell_row", *columns, "cell_area", "geometry"]
    assert frame["fid"].tolist() == [*range(30)]
    np.testing.assert_array_equal(frame["cell_area"], CELLS.areas)
    assert frame.geometry.isna().to_numpy().nonzero()[0].tolist() == CELLS.empty.tolist()
    with pytest.raises(liftmesh.FormatError, match="takes columns 'a' and 'A' for one"):
        written("gpkg", {"a": np.ones(30), "A": np.ones(30)})
    with pytest.raises(liftmesh.FormatError, match=r"'n' has the value 18446744073709551615"):
        written("gpkg", {"n": np.full(30, 2**64 - 1, dtype=np.uint64)})
    with pytest.raises(liftmesh.InputError, match="two columns are named 'a_1'"):
        written("gpkg", {"a_1": np.ones(30), "a": np.ones((30, 2))})


def test_faces_of_ply_carry_their_rows(tmp_path: Path) -> None:
    dropped, stream = written("ply", {"size": POINTS[:, 0], "name": np.array(["a"] * 30)})
    assert dropped == ("name (not numbers)", f"{len(CELLS.empty)} rows without an area")
    path = tmp_path / "cells.ply"
    path.write_bytes(stream.getvalue())
    assert trimesh.load(path, process=False).area == pytest.approx(COUNTRY.area)
    again = liftmesh.read(path)
    assert again.crs == "EPSG:32633"
    mesh = meshio.read(path)
    covered = np.zeros(30)
    held = mesh.cell_data
    for block, rows, sizes in zip(mesh.cells, held["row"], held["size"], strict=True):
        corners = mesh.points[block.data][..., :2]
        assert (sizes == POINTS[rows, 0]).all()
        polygons = shapely.polygons(corners)
        assert shapely.is_ccw(shapely.get_exterior_ring(polygons)).all()
        assert shapely.area(shapely.convex_hull(polygons)) == pytest.approx(shapely.area(polygons))
        covered += np.bincount(rows, shapely.area(polygons), 30)
    np.testing.assert_allclose(covered, CELLS.areas)
    areas = np.concatenate(held["area"])
    np.testing.assert_array_equal(areas, CELLS.areas[np.concatenate(held["row"])])


def test_large_faces_have_wide_counts() -> None:
    turn = np.arange(300) / 300 * 2 * np.pi
    ring = np.c_[np.cos(turn), np.sin(turn)]
    dropped, stream = written("ply", {}, liftmesh.voronoi([[0, 0]], domain=ring))
    assert dropped == ()
    lines = stream.getvalue().decode().splitlines()
    assert "property list int int vertex_indices" in lines
    assert re.match(r"300 \d+ ", lines[-1])


DOMAINS = {
    "another's": CELLS.domain,
    "features": geopandas.GeoSeries([*COUNTRY.geoms]),
    "table": geopandas.GeoDataFrame({"v": [1, 2]}, geometry=[*COUNTRY.geoms]),
    "feature": {"type": "Feature", "geometry": COUNTRY.__geo_interface__, "properties": {}},
    "collection": json.loads(geopandas.GeoSeries([*COUNTRY.geoms]).to_json()),
}


@pytest.mark.parametrize("name", DOMAINS)
def test_domains_of_other_kinds(name: str) -> None:
    found = liftmesh.voronoi(POINTS, domain=DOMAINS[name])
    np.testing.assert_allclose(found.areas, CELLS.areas, atol=1e-12)


def test_a_ring_is_a_polygon() -> None:
    cells = liftmesh.voronoi(POINTS, domain=shapely.LinearRing([(0, 0), (4, 0), (0, 4)]))
    assert cells.areas.sum() == pytest.approx(8)


BAD = [
    (geopandas.GeoSeries([COUNTRY, None]), "geometry 1 is nothing"),
    (geopandas.GeoSeries([shapely.Point(0, 0), COUNTRY]), "geometry 0 is Point"),
    (geopandas.GeoSeries([]), "there are none"),
    (
        geopandas.GeoSeries([COUNTRY, shapely.Polygon([(0, 0), (1, 1), (1, 0), (0, 1)])]),
        r"polygon 1 of the domain is not valid: Self-intersection\[0.5 0.5\]",
    ),
]


@pytest.mark.parametrize(("domain", "message"), BAD)
def test_bad_geometries_are_named(domain: Any, message: str) -> None:
    with pytest.raises(liftmesh.InputError, match=message):
        liftmesh.voronoi(POINTS, domain=domain)


def test_a_box_that_cannot_be_widened_is_said() -> None:
    with pytest.raises(liftmesh.InputError, match=r"cannot be widened by 1\.0 in float64"):
        liftmesh.voronoi([[1e17, 1e17]])


def test_messages_speak_of_diagrams() -> None:
    with pytest.raises(liftmesh.InputError, match=r"4 columns .* scipy.spatial.Voronoi for more"):
        liftmesh.scipy.Voronoi(np.zeros((5, 4)))
    with pytest.raises(liftmesh.InputError, match=r"'QJ' moves .* diagram .* `duplicates`"):
        liftmesh.scipy.Voronoi(POINTS, qhull_options="QJ")
    with pytest.raises(liftmesh.InputError, match="'Qu' is furthest_site=True here"):
        liftmesh.scipy.Voronoi(POINTS, qhull_options="Qu")


@pytest.mark.parametrize("kind", ["geojson", "gpkg", "ply", "svg"])
def test_a_file_is_that_of_a_stream(tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"cells.{kind}"
    done = CELLS.save(path, {"area": np.arange(30)}, crs="EPSG:32633")
    assert (done.path, done.format, done.bytes) == (path, kind, path.stat().st_size)
    assert done.renamed == (() if kind == "svg" else (("area", "cell_area"),))
    if kind != "gpkg":  # which holds the time
        _, stream = written(kind, {"area": np.arange(30)})
        assert path.read_bytes() == stream.read()
    assert [*tmp_path.iterdir()] == [path]


def test_an_error_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "cells.gpkg"
    CELLS.save(path)
    before = path.read_bytes()
    with pytest.raises(liftmesh.FormatError, match="columns 'a' and 'A' for one"):
        CELLS.save(path, {"a": np.arange(30), "A": np.arange(30)})
    with pytest.raises(liftmesh.FormatError, match="neither a path nor a binary stream"):
        CELLS.save(io.StringIO(), format="svg")  # type: ignore[arg-type]
    assert path.read_bytes() == before
    assert [*tmp_path.iterdir()] == [path]


def test_tables_and_cells_of_disks_are_saved(tmp_path: Path) -> None:
    table = pd.DataFrame({"name": ["a", "b"], "size": [1, 2]}, index=[7, 8])
    cells = liftmesh.apollonius_diagram([[0, 0], [4, 0]], [1, 0.5])
    cells.save(tmp_path / "out.geojson", table)
    found = geopandas.read_file(tmp_path / "out.geojson")
    assert found["name"].tolist() == ["a", "b"]
    np.testing.assert_array_equal(found["area"], cells.areas)
    assert len(cells) == 2
