"""Surfaces as rasters: every centre has one owner and, bit for bit, the height of `sample`."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import rasterio
from clouds import FAMILIES
from hypothesis import given, settings, strategies as st
from oracles.surfaces import exact_point
from surfaces import LATTICE, covering, exactly, family_surface, meadow, raster, with_heights

import liftmesh
from liftmesh.raster.pixels import Layout
from liftmesh.terrain.rasters import scanner

STEPS = st.sampled_from([-1.0, -0.5, 0.0, 0.25, 0.5, 1.0, 2.0])
QUANTITIES = {"height": "sample", "slope": "slope", "aspect": "aspect"}


def owners(surface: liftmesh.Surface, layout: Layout, threads: int | None = None) -> np.ndarray:
    """The face that each pixel belongs to."""
    faces = np.empty((layout.rows, layout.columns), np.int32)
    scanner(surface, layout, threads)(faces[:, :, None], 0)
    return faces


def is_flat(layout: Layout) -> bool:
    a, b, _, d, e, _ = map(Fraction, layout.transform)
    return a * e == b * d


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("family", FAMILIES)
def test_values_are_those_at_the_centres(family: str, turned: bool) -> None:
    surface, _ = family_surface(family)
    with np.errstate(all="ignore"):
        layout = covering(surface, 23, 31, turned=turned)
    if not np.isfinite(layout.transform).all() or is_flat(layout):
        with pytest.raises(liftmesh.InputError):
            raster(surface, layout)
        return
    centres = raster(surface, layout).centers()
    for quantity, method in QUANTITIES.items():
        found = raster(surface, layout, quantity=quantity).values
        np.testing.assert_array_equal(found, getattr(surface, method)(centres))


@settings(max_examples=60)
@given(LATTICE, STEPS, STEPS, STEPS, STEPS)
def test_every_centre_has_one_owner(points, a, b, d, e) -> None:
    """Centres on a lattice of vertices: most of them are on edges and at vertices."""
    try:
        surface = liftmesh.triangulate(points, on_duplicate="highest")
    except liftmesh.DegenerateInputError:
        return
    if a * e == b * d:
        return
    layout = Layout((a, b, -1.0 - a / 2 - b / 2, d, e, 3.0 - d / 2 - e / 2), 9, 8)
    oracle = exactly(surface)
    centres = raster(surface, layout).centers().reshape(-1, 2)
    expected = [oracle.owner(exact_point(each)) for each in centres.tolist()]
    found = owners(surface, layout).ravel()
    assert found.tolist() == [-1 if each is None else each for each in expected]


@pytest.mark.parametrize("turned", [False, True])
def test_a_lattice_on_its_own_centres_is_counted_once(turned: bool) -> None:
    side = 40
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
    planar = grid @ ((1.0, 0.5), (-0.5, 1.0)) if turned else grid.astype(float)
    surface = liftmesh.triangulate(with_heights(planar))
    transform = (1, -0.5, -0.25, 0.5, 1, -0.75) if turned else (1, 0, -0.5, 0, 1, -0.5)
    layout = Layout(tuple(map(float, transform)), side, side)
    found = raster(surface, layout)
    np.testing.assert_array_equal(found.values.ravel(), surface.vertices[:, 2])
    counts = np.bincount(owners(surface, layout).ravel(), minlength=len(surface.faces))
    assert counts.sum() == side * side


@pytest.mark.parametrize("threads", [1, 2])
def test_faces_in_every_row_are_not_met_in_every_row(threads: int) -> None:
    """A fan over more rows than pixels are worth: the centres are located instead."""
    rng = np.random.default_rng(2)
    n = 3000
    rim = np.column_stack([np.full(n, 1000.0), np.sort(rng.random(n)) * 1e-3])
    surface = liftmesh.triangulate(with_heights(np.vstack([rim, [[0.0, 0.0]]])))
    layout = Layout((10.0, 0.0, 0.0, 0.0, -1e-6, 1e-3), 1000, 100)
    found = raster(surface, layout, threads=threads)
    assert np.isfinite(found.values).any()
    np.testing.assert_array_equal(found.values, surface.sample(found.centers()))
    single = raster(surface, layout, dtype="float32", threads=threads).values
    np.testing.assert_array_equal(single, found.values.astype(np.float32))
    owned = owners(surface, layout, threads=threads)
    np.testing.assert_array_equal(owned >= 0, np.isfinite(found.values))


def test_no_bit_depends_on_threads_or_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    surface = liftmesh.triangulate(np.random.default_rng(8).random((20_000, 3)))
    whole = surface.raster(0.004, threads=1)
    np.testing.assert_array_equal(surface.raster(0.004, threads=3).values, whole.values)
    slopes = surface.raster(0.004, quantity="slope", threads=1)
    monkeypatch.setattr("liftmesh.terrain.rasters._TOGETHER", 1000)
    again = surface.raster(0.004, quantity="slope", threads=2)
    np.testing.assert_array_equal(again.values, slopes.values)
    np.testing.assert_array_equal(again.values, surface.slope(whole.centers()))


def test_single_precision_rounds_once() -> None:
    surface = liftmesh.triangulate(np.random.default_rng(8).random((500, 3)))
    single = surface.raster(0.01, dtype=np.float32)
    assert single.values.dtype == np.float32
    np.testing.assert_array_equal(single.values, surface.raster(0.01).values.astype(np.float32))


def test_single_precision_holds_every_height() -> None:
    surface = liftmesh.triangulate([[0, 0, 0], [4, 0, -1e39], [0, 4, 0]])
    with pytest.raises(liftmesh.InputError, match=r"height -1e\+39 is beyond float32: give dtype="):
        surface.raster(1, dtype="float32")
    assert np.nanmin(surface.raster(1).values) < -8e38
    assert surface.raster(1, dtype="float32", quantity="slope").values[-1, 0] == 90


def test_heights_that_no_face_has_may_be_beyond_single_precision() -> None:
    whole = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 8], [40, 40, 1e39]])
    with pytest.raises(liftmesh.InputError, match=r"height 1e\+39 is beyond float32"):
        whole.raster(1, dtype="float32")
    found = whole.trim(max_edge=10).raster(1, dtype="float32")
    assert found.values.shape == (4, 4)
    assert np.nanmax(found.values) < 8


def test_single_precision_has_one_north() -> None:
    surface = liftmesh.triangulate([[0, 0, 0], [4, 0, 4e-9], [0, 4, -4]])
    assert surface.aspect([1, 1]) > 359
    assert surface.raster(1, dtype="float32", quantity="aspect").values[-1, 0] == 0


def test_large_offsets_leave_no_gap() -> None:
    """Sides of faces in coordinates of millions, with pixels of a thousandth."""
    rng = np.random.default_rng(1)
    planar = rng.random((60, 2)) * 0.2 + (4.5e5, 5.2e6)
    surface = liftmesh.triangulate(with_heights(planar))
    found = surface.raster(0.001)
    np.testing.assert_array_equal(found.values, surface.sample(found.centers()))
    corners = surface.triangulation.points[surface.triangulation.convex_hull]
    inside = np.prod(found.values.shape) * 0.5
    assert np.isfinite(found.values).sum() > inside
    assert len(corners) >= 3


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("shape", [(300, 40), (131, 1100), (40, 2100)])
def test_faces_of_many_rows_and_columns(shape: tuple[int, int], turned: bool) -> None:
    """The columns of a face are found for some of its rows at once, of few if rows are long."""
    surface = liftmesh.triangulate(np.random.default_rng(6).random((9, 3)))
    found = raster(surface, covering(surface, *shape, turned=turned), dtype="float32")
    heights = surface.sample(found.centers())
    assert np.isfinite(heights).mean() > 0.2
    np.testing.assert_array_equal(found.values, heights.astype(np.float32))


@pytest.mark.parametrize("size", [1e-300, 1e-170, 1e-160, 1e-140, 1e140, 1e155, 1e300])
@pytest.mark.parametrize("turned", [False, True])
def test_coordinates_of_any_size(size: float, turned: bool) -> None:
    points = np.random.default_rng(4).random((40, 3)) * (size, size, 1)
    surface = liftmesh.triangulate(points)
    found = raster(surface, covering(surface, 20, 20, turned=turned))
    assert np.isfinite(found.values).sum() > 80
    np.testing.assert_array_equal(found.values, surface.sample(found.centers()))


@pytest.mark.parametrize("flatness", [1e-6, 1e-10, 1e-14])
def test_pixels_that_are_nearly_flat(flatness: float) -> None:
    """The determinant of the transform cancels, and with it the way back to pixels."""
    surface = liftmesh.triangulate(np.random.default_rng(4).random((300, 3)) * (100, 100, 1))
    transform = (1.0, 1.0, 3.0, 1.0, 1.0 + flatness, 2.0)
    found = surface.raster(transform=transform, shape=(40, 40))
    np.testing.assert_array_equal(found.values, surface.sample(found.centers()))
    assert np.isfinite(found.values).sum() > 500


class TestLight:
    def slab(self, slope: float, azimuth: float) -> liftmesh.Surface:
        """A plane that descends towards an azimuth."""
        down = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
        planar = np.array([[0.0, 0.0], [9.0, 0.0], [0.0, 9.0], [9.0, 9.0]])
        return liftmesh.triangulate(np.column_stack([planar, -slope * planar @ down]))

    def test_a_face_towards_the_light_is_white_and_one_away_from_it_black(self) -> None:
        facing = self.slab(1.0, 315).raster(1, quantity="hillshade")
        np.testing.assert_allclose(facing.values, 255, rtol=1e-12)
        away = self.slab(2.0, 135).raster(1, quantity="hillshade")
        assert (away.values == 0).all()

    def test_light_from_above_shows_the_slope(self) -> None:
        found = self.slab(1.0, 20).raster(1, quantity="hillshade", light=(0, 90))
        np.testing.assert_allclose(found.values, 255 * np.cos(np.pi / 4), rtol=1e-12)

    def test_faces_as_steep_as_doubles_reach(self) -> None:
        gentle, steep = (
            self.slab(slope, 300).raster(1, quantity="hillshade") for slope in (1e9, 1e300)
        )
        np.testing.assert_allclose(steep.values, gentle.values, rtol=1e-6)
        assert steep.values.min() > 100

    @pytest.mark.parametrize("light", [(1,), (0, 91), (0, -1), ("north", 3), 5, (np.inf, 5)])
    def test_other_light_is_refused(self, light) -> None:
        with pytest.raises(liftmesh.InputError, match="light is"):
            self.slab(1.0, 0).raster(1, quantity="hillshade", light=light)


class TestLayout:
    @pytest.fixture
    def surface(self) -> liftmesh.Surface:
        return liftmesh.triangulate([[0.3, 0.2, 1], [4.2, 0.2, 2], [0.3, 2.6, 3], [4.2, 2.6, 4]])

    def test_edges_are_multiples_of_the_resolution(self, surface) -> None:
        found = surface.raster(0.5)
        assert found.transform == (0.5, 0.0, 0.0, 0.0, -0.5, 3.0)
        assert found.values.shape == (6, 9)
        assert found.centers()[0, 0].tolist() == [0.25, 2.75]
        assert np.isnan(found.values[0]).all()
        assert np.isfinite(found.values[1, 1:8]).all()

    def test_multiples_are_decimal(self) -> None:
        """0.6 / 0.2 is less than 3 in doubles."""
        planar = np.array([[0.6, 0.6], [1.4, 0.6], [0.6, 1.2], [1.4, 1.2]])
        surface = liftmesh.triangulate(with_heights(planar))
        found = surface.raster(0.2)
        assert found.transform == (0.2, 0.0, 0.6, 0.0, -0.2, 1.2)
        assert found.values.shape == (3, 4)
        assert np.isfinite(found.values).all()

    def test_what_is_left_out_needs_no_pixel(self, tmp_path) -> None:
        points = np.vstack([np.random.default_rng(3).random((300, 3)), [[50, 50, 0]]])
        surface = liftmesh.triangulate(points).trim(max_edge=2)
        found = surface.raster(0.1)
        assert found.values.shape == (10, 10)
        surface.save(tmp_path / "a.ply")
        read = liftmesh.as_surface(tmp_path / "a.ply").raster(0.1)
        np.testing.assert_array_equal(read.values, found.values)
        assert read.transform == found.transform

    def test_two_resolutions_and_bounds(self, surface) -> None:
        found = surface.raster((1, 0.5), bounds=(1, 1, 3, 2))
        assert found.transform == (1.0, 0.0, 1.0, 0.0, -0.5, 2.0)
        assert found.values.shape == (2, 2)

    def test_a_coarse_raster_has_a_pixel(self, surface) -> None:
        assert surface.raster(100).values.shape == (1, 1)

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            ({}, "give either resolution, or transform and shape"),
            ({"resolution": 0}, "resolution is 0: give a positive number"),
            ({"resolution": -1.0}, "give a positive number"),
            ({"resolution": np.nan}, "resolution is nan"),
            ({"resolution": "fine"}, "resolution is 'fine'"),
            ({"resolution": "3"}, "resolution is '3'"),
            ({"resolution": (b"3", 1)}, "resolution is"),
            ({"resolution": (1, 2, 3)}, "resolution is"),
            ({"resolution": 1, "transform": (1, 0, 0, 0, 1, 0)}, "either"),
            ({"transform": (1, 0, 0, 0, 1, 0)}, "either"),
            ({"shape": (1, 1)}, "either"),
            ({"transform": (1, 0, 0, 0, 1), "shape": (1, 1)}, "give 6"),
            ({"transform": (1, 1, 0, 1, 1, 0), "shape": (1, 1)}, "no area"),
            ({"transform": (1, 0, 0, 0, 1, 0), "shape": (0, 1)}, "are too many, or none"),
            ({"transform": (1, 0, 0, 0, 1, 0), "shape": (1.5, 1)}, "rows and columns"),
            ({"resolution": 1, "bounds": (0, 0, 0, 1)}, "xmin, ymin, xmax, ymax"),
            ({"resolution": 1, "bounds": 3}, "bounds is 3: give 4"),
            ({"resolution": 1e-12}, "too many"),
            ({"resolution": 1e-7}, "24,000,000 rows of 39,000,000 pixels are too many"),
            ({"resolution": 1e-320}, r"rows of 3e\+320 pixels are too many"),
            ({"resolution": 1.5e308, "bounds": (0, 0, 1, 1.6e308)}, "beyond the largest double"),
            ({"resolution": 1, "quantity": "steepness"}, "quantity is 'steepness'"),
            ({"resolution": 1, "dtype": "int16"}, "dtype is 'int16'"),
            ({"resolution": 1, "dtype": "heights"}, "dtype is 'heights'"),
        ],
    )
    def test_what_is_no_raster_is_refused(self, surface, options, said: str) -> None:
        with pytest.raises(liftmesh.InputError, match=said):
            surface.raster(**options)

    def test_the_coordinate_system_is_that_of_the_plane(self) -> None:
        points = np.random.default_rng(0).random((9, 3))
        assert liftmesh.triangulate(points, crs="EPSG:7415").raster(0.5).crs == "EPSG:7415"
        assert liftmesh.triangulate(points, crs="EPSG:7415", plane="xz").raster(0.5).crs is None


class TestFiles:
    @pytest.fixture
    def found(self) -> liftmesh.Raster:
        points = np.random.default_rng(0).random((400, 3)) * (600, 500, 10) + (1.8e5, 3.3e5, 0)
        return liftmesh.triangulate(points, crs="EPSG:28992").raster(2, dtype="float32")

    def test_what_is_no_switch_is_refused(self, found, tmp_path) -> None:
        with pytest.raises(liftmesh.InputError, match="cog is 'no': give True or False"):
            found.save(tmp_path / "dtm.tif", cog="no")
        assert not any(tmp_path.iterdir())

    @pytest.mark.parametrize("compress", [None, "deflate", "lzw", "zstd"])
    @pytest.mark.parametrize("cog", [False, True])
    def test_geotiff_keeps_everything(self, found, tmp_path, cog: bool, compress) -> None:
        path = tmp_path / "dtm.tif"
        written = found.save(path, cog=cog, compress=compress)
        assert written == liftmesh.WriteResult(path, "geotiff", path.stat().st_size, None)
        with rasterio.open(path) as file:
            assert tuple(file.bounds) == found.bounds
            np.testing.assert_array_equal(file.read(1), found.values)
            assert tuple(file.transform)[:6] == found.transform
            assert file.crs.to_epsg() == 28992
            assert np.isnan(file.nodata)
            assert file.profile.get("compress") == compress
            layout = file.tags(ns="IMAGE_STRUCTURE").get("LAYOUT")
            assert (layout == "COG") is cog
        assert [each.name for each in tmp_path.iterdir()] == ["dtm.tif"]

    def test_liftmesh_reads_it_back(self, found, tmp_path) -> None:
        cloud = liftmesh.read(found.save(tmp_path / "dtm.tif").path)
        known = np.isfinite(found.values)
        np.testing.assert_array_equal(cloud.points[:, :2], found.centers()[known])
        np.testing.assert_array_equal(cloud.points[:, 2], found.values[known])

    def test_errors_leave_nothing_behind(self, found, tmp_path) -> None:
        with pytest.raises(liftmesh.InputError, match="compress is 'jpeg'"):
            found.save(tmp_path / "dtm.tif", compress="jpeg")
        wrong = liftmesh.Raster(found.values, found.transform, "EPSG:1")
        with pytest.raises(liftmesh.InputError, match="EPSG:1' is unknown"):
            wrong.save(tmp_path / "dtm.tif")
        with pytest.raises(liftmesh.FormatError, match=r"dtm\.jpg: .* as GeoTIFF"):
            found.save(tmp_path / "dtm.jpg")
        with pytest.raises(liftmesh.InputError, match="pixels have no value, the first in row 0"):
            found.save(tmp_path / "dtm.png")
        with pytest.raises(FileNotFoundError, match="does not exist"):
            found.save(tmp_path / "nowhere" / "dtm.tif")
        assert list(tmp_path.iterdir()) == []

    def test_results_stay_as_they_are(self, found) -> None:
        with pytest.raises(ValueError, match="read-only"):
            found.values[0, 0] = 1


def test_the_layout_covers_the_surface() -> None:
    surface = liftmesh.triangulate(np.random.default_rng(5).normal(size=(50, 3)) * 7)
    raster = surface.raster(0.7)
    rows, columns = raster.values.shape
    a, _, c, _, e, f = raster.transform
    low, high = surface.triangulation.min_bound, surface.triangulation.max_bound
    assert c <= low[0] < c + a
    assert f + e < high[1] <= f
    assert c + a * columns >= high[0]
    assert f + e * rows <= low[1]


@pytest.mark.parametrize("method", ["nearest", "laplace", "sibson"])
def test_other_methods_are_those_of_sample(method: str, monkeypatch) -> None:
    monkeypatch.setattr("liftmesh.terrain.rasters._TOGETHER", 50)  # several blocks of rows
    surface = liftmesh.triangulate(np.random.default_rng(7).random((60, 3)))
    found = surface.raster(0.05, interpolation=method)
    np.testing.assert_array_equal(found.values, surface.sample(found.centers(), method))
    with pytest.raises(liftmesh.InputError, match="leave out interpolation"):
        surface.raster(0.05, interpolation=method, quantity="slope")


def test_a_transform_of_rasterio_is_taken() -> None:
    surface = liftmesh.triangulate([[0.0, 0, 1], [8, 0, 2], [0, 8, 3], [8, 8, 5]])
    affine = rasterio.Affine(1, 0, 0, 0, -1, 8)
    found = surface.raster(transform=affine, shape=(8, 8))
    expected = surface.raster(transform=(1, 0, 0, 0, -1, 8), shape=(8, 8))
    assert found.transform == expected.transform
    assert np.array_equal(found.values, expected.values)


def test_unknown_options_are_told_with_those_there_are() -> None:
    surface = liftmesh.triangulate(np.eye(3))
    with pytest.raises(TypeError, match="no option 'method': give some of bounds, transform"):
        surface.raster(1, method="linear")  # type: ignore[call-arg]


@pytest.mark.parametrize("limit", [None, 12])
def test_the_longest_edge_is_that_of_the_face_at_each_centre(limit: float | None) -> None:
    surface = liftmesh.triangulate(meadow())
    surface = surface if limit is None else surface.trim(max_edge=limit)
    found = surface.raster(1.25, quantity="longest-edge")
    face = surface.triangulation.find_simplex(found.centers())
    corners = surface.triangulation.points[surface.triangulation.simplices[face]]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=-2), axis=-1).max(axis=-1)
    sides[np.isnan(surface.sample(found.centers()))] = np.nan
    np.testing.assert_allclose(found.values, sides)
    assert np.isfinite(sides).any()
    assert found.quantity == "longest-edge"
