"""Sites of cells in clouds, tables and geometries, and weights by name."""

from __future__ import annotations

import geopandas
import numpy as np
import pandas as pd
import polars as pl
import pytest
import shapely

import liftmesh

RNG = np.random.default_rng(1809)
POINTS, SIZES = RNG.random((20, 2)), RNG.random(20)
BOX = (0, 0, 1, 1)
CELLS = liftmesh.power_diagram(POINTS, weights=SIZES, domain=BOX)
COLUMNS = {"x": POINTS[:, 0], "y": POINTS[:, 1], "size": SIZES}
GEOMETRIC = geopandas.GeoDataFrame(
    {"size": SIZES}, geometry=geopandas.points_from_xy(*POINTS.T), crs="EPSG:32633"
)
SOURCES = {
    "pandas": pd.DataFrame(COLUMNS),
    "polars": pl.DataFrame(COLUMNS),
    "records": pd.DataFrame(COLUMNS).to_records(index=False),
    "cloud": liftmesh.Cloud(np.c_[POINTS, np.ones(20)], attributes={"size": SIZES}),
    "geopandas": GEOMETRIC,
}


@pytest.mark.parametrize("name", SOURCES)
def test_sources_without_heights(name: str) -> None:
    source = SOURCES[name]
    found = liftmesh.power_diagram(source, weights="size", domain=BOX)
    np.testing.assert_array_equal(found.areas, CELLS.areas)
    by_radius = liftmesh.power_diagram(source, radii="size", domain=BOX)
    expected = liftmesh.power_diagram(POINTS, radii=SIZES, domain=BOX)
    np.testing.assert_array_equal(by_radius.areas, expected.areas)
    plain = liftmesh.voronoi(source, domain=BOX)
    np.testing.assert_array_equal(plain.points, POINTS)
    assert liftmesh.lloyd(source, domain=BOX, max_iter=1).points.shape == (20, 2)
    assert liftmesh.transport(source, np.ones(20), domain=BOX).converged
    with pytest.raises(liftmesh.InputError, match="have no values of that name: there are 'size'"):
        liftmesh.power_diagram(source, weights="mass", domain=BOX)


@pytest.mark.parametrize("name", SOURCES)
def test_natural_neighbors_of_them(name: str) -> None:
    source, queries = SOURCES[name], [[0.4, 0.5], [0.5, 0.6]]
    expected = liftmesh.natural_neighbors(POINTS, queries)
    np.testing.assert_array_equal(liftmesh.natural_neighbors(source, queries).data, expected.data)
    at_rows = liftmesh.natural_neighbors(POINTS, source)
    assert (at_rows.indices.tolist(), at_rows.data.tolist()) == ([*range(20)], [1.0] * 20)


def test_geometries_are_points_of_one_system() -> None:
    domain = geopandas.GeoSeries([shapely.box(*BOX)], crs="EPSG:32633")
    np.testing.assert_allclose(
        liftmesh.voronoi(GEOMETRIC, domain=domain).areas,
        liftmesh.voronoi(POINTS, domain=BOX).areas,
        atol=1e-15,
    )
    of_array = liftmesh.voronoi(GEOMETRIC.geometry.array, domain=domain)
    np.testing.assert_array_equal(of_array.points, POINTS)
    assert of_array.crs == "EPSG:32633"
    with pytest.raises(liftmesh.InputError, match="the points are in 'WGS 84 / UTM zone 33N'"):
        liftmesh.voronoi(GEOMETRIC, domain=domain.to_crs("EPSG:4326"))
    cloud = liftmesh.Cloud(np.c_[POINTS, np.ones(20)], crs="EPSG:4326")
    for call in (liftmesh.voronoi, liftmesh.lloyd):
        with pytest.raises(liftmesh.InputError, match="'WGS 84', and the domain in 'WGS 84 / UTM"):
            call(cloud, domain=domain)
    for found in (
        liftmesh.voronoi(GEOMETRIC),
        liftmesh.voronoi(POINTS, domain=domain),
        liftmesh.power_diagram(GEOMETRIC, weights="size"),
        liftmesh.lloyd(POINTS, domain=domain, max_iter=1).cells,
        liftmesh.lloyd(GEOMETRIC, domain=BOX, max_iter=1).cells,
        liftmesh.transport(GEOMETRIC, np.ones(20), domain=BOX).cells,
    ):
        assert found.to_geodataframe().crs == found.crs == "EPSG:32633"
        assert liftmesh.voronoi(POINTS, domain=found.domain).crs == "EPSG:32633"
        with pytest.raises(liftmesh.InputError, match="the cells in 'WGS 84 / UTM zone 33N'"):
            found.to_geodataframe(crs=4326)
        with pytest.raises(
            liftmesh.InputError,
            match="crs is 'nonsense', which is unknown: give WKT or EPSG:n, or what pyproj takes",
        ):
            found.to_geodataframe(crs="nonsense")
    with pytest.raises(liftmesh.InputError, match="row 1 is nothing: give points"):
        liftmesh.voronoi(geopandas.GeoSeries([shapely.Point(0, 0), None]))
    for shapes in ([shapely.Point(0, 0)], shapely.points(POINTS), shapely.MultiPoint(POINTS)):
        with pytest.raises(liftmesh.InputError, match=r"give shapely\.get_coordinates of"):
            liftmesh.voronoi(shapes)
    with pytest.raises(liftmesh.InputError, match=r"clipped to, cells\.domain"):
        liftmesh.voronoi(POINTS, domain=CELLS)
    with pytest.raises(liftmesh.InputError, match="row 1 is Polygon: give points"):
        liftmesh.voronoi(geopandas.GeoSeries([shapely.Point(0, 0), shapely.box(*BOX)]))
    with pytest.raises(liftmesh.InputError, match="'size', and the points have no values of that"):
        liftmesh.power_diagram(POINTS, weights="size")
