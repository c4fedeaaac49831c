"""What a surface that follows lines is asked, compared with what is computed otherwise."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import shapely

import liftmesh
from liftmesh import InputError

SIZE = 12
WALL = np.array([[1, 2, 9], [11, 10, 9], [11, 1, 5]], dtype=float)
LAKE = np.array([[3, 6], [6, 7], [5, 10], [2, 9]], dtype=float)


def points() -> np.ndarray:
    rng = np.random.default_rng(8)
    planar = rng.integers(0, 64 * SIZE, (150, 2)) / 64
    planar[:4] = [[0, 0], [SIZE, 0], [0, SIZE], [SIZE, SIZE]]
    return np.column_stack([planar, rng.integers(0, 64, len(planar)) / 16])


@pytest.fixture
def surface() -> liftmesh.Surface:
    """Hills with a wall and a lake."""
    return liftmesh.triangulate(points(), breaklines=WALL, holes=LAKE)


def expected(surface: liftmesh.Surface, places: np.ndarray) -> np.ndarray:
    """Heights by brute force: in the first face that contains each place."""
    corners = surface.vertices[surface.faces]
    heights = np.full(len(places), np.nan)
    for k, (x, y) in enumerate(places.tolist()):
        a, b, c = np.moveaxis(corners - [x, y, 0], 1, 0)
        weights = np.stack([np.cross(u[:, :2], v[:, :2]) for u, v in ((b, c), (c, a), (a, b))], 1)
        inside = np.flatnonzero((weights >= 0).all(axis=1))
        if len(inside):
            share = weights[inside[0]] / weights[inside[0]].sum()
            heights[k] = share @ corners[inside[0], :, 2]
    return heights


def area(surface: liftmesh.Surface) -> float:
    return float(SIZE**2 - shapely.Polygon(LAKE).area)


@pytest.mark.filterwarnings("ignore:Arrays of 2-dimensional vectors")
def test_heights_and_rasters(surface) -> None:
    places = np.random.default_rng(1).random((400, 2)) * SIZE
    assert not surface.triangulation.is_constrained.all()
    np.testing.assert_allclose(surface.sample(places), expected(surface, places), atol=1e-9)
    raster = surface.raster(0.5)
    x, y = np.meshgrid(np.arange(24) / 2 + 0.25, SIZE - np.arange(24) / 2 - 0.25)
    centers = np.stack([x, y], axis=-1)
    np.testing.assert_array_equal(raster.values, surface.sample(centers))
    slopes = surface.raster(0.5, quantity="slope").values
    np.testing.assert_array_equal(slopes, surface.slope(centers))


def test_the_nearest_vertex(surface) -> None:
    places = np.random.default_rng(2).random((500, 2)) * SIZE
    used = np.unique(surface.triangulation.simplices)
    far = np.hypot(*(places[:, None] - surface.vertices[used, :2]).T)
    nearest = surface.vertices[used[far.argmin(axis=0)], 2]
    found = surface.sample(places, "nearest")
    is_shown = ~np.isnan(surface.sample(places))
    np.testing.assert_array_equal(found[is_shown], nearest[is_shown])
    assert np.isnan(found[~is_shown]).all()
    assert 0 < is_shown.sum() < 500


def test_what_needs_a_delaunay_triangulation_is_refused(surface) -> None:
    for name in ("laplace", "sibson"):
        with pytest.raises(
            InputError, match="follows lines or has faces of its own: give interpolation 'lin"
        ):
            surface.sample([1, 1], name)
        with pytest.raises(InputError, match="follows lines"):
            surface.raster(1, interpolation=name)
    with pytest.raises(InputError, match="natural neighbours are those of a Delaunay"):
        liftmesh.natural_neighbors(surface.triangulation, [[1, 1]])
    with pytest.raises(InputError, match="breaklines is for surfaces in one call"):
        liftmesh.tile_surface(points(), "unused", breaklines=WALL)


def test_areas_and_volumes(surface) -> None:
    corners = surface.vertices[surface.faces]
    sides = corners[:, 1:] - corners[:, :1]
    doubled = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    found = surface.volume(-1)
    assert found.area == pytest.approx(area(surface))
    assert found.above == pytest.approx((doubled / 2 * (corners[..., 2].mean(axis=1) + 1)).sum())
    plain = liftmesh.triangulate(points())
    there, back = surface.cut_and_fill(plain), plain.cut_and_fill(surface)
    assert (there.cut, there.fill) == pytest.approx((back.fill, back.cut))
    assert there.fill - there.cut == pytest.approx(
        plain.volume(-1).above - found.above - plain.volume(-1, within=LAKE).above
    )
    within = surface.volume(-1, within=[[0, 0], [SIZE, 0], [SIZE, SIZE], [0, SIZE]])
    assert within.above == pytest.approx(found.above)


def test_lines_over_it_and_around_it(surface) -> None:
    line = np.array([[0.5, 0.5], [11.5, 11]])
    profile = surface.profile(line)
    np.testing.assert_allclose(
        surface.sample(profile.points[1:-1, :2]), profile.points[1:-1, 2], atol=1e-6
    )
    assert len(surface.profile([[1, 7.5], [8, 8.5]]).starts) == 3  # the lake is a gap
    contours = surface.contours([2.0, 7.0])
    assert len(contours.starts) > 2
    for level, lines in zip(
        contours.levels, np.split(contours.points, contours.starts[1:-1]), strict=True
    ):
        heights = surface.sample(lines[:, :2])
        np.testing.assert_allclose(heights[~np.isnan(heights)], level, atol=1e-6)
    rings = surface.boundary()
    assert len(rings) == 2
    areas = sorted(shapely.Polygon(surface.vertices[ring, :2]).area for ring in rings)
    assert areas == pytest.approx([shapely.Polygon(LAKE).area, SIZE**2])


def test_trimmed_closed_and_moved(surface) -> None:
    trimmed = surface.trim(max_edge=3)
    assert len(trimmed.faces) < len(surface.faces)
    assert (trimmed.mask >= surface.mask).all()
    mesh = surface.solid(-2.0).faces
    ends = np.sort(np.stack([mesh, np.roll(mesh, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    assert (np.unique(ends, axis=0, return_counts=True)[1] == 2).all()
    raised = surface.replace(vertices=surface.vertices * [1, 1, 2])
    assert raised.triangulation is surface.triangulation
    shifted = surface.replace(vertices=surface.vertices + np.array([64, -128, 1]))
    assert shifted.verify().canonical
    np.testing.assert_array_equal(shifted.faces, surface.faces)
    np.testing.assert_array_equal(
        shifted.triangulation.constraints, surface.triangulation.constraints
    )
    stretched = surface.replace(vertices=surface.vertices * np.array([1, 8, 1]))
    assert stretched.verify()
    assert {frozenset(each) for each in stretched.faces.tolist()} == {
        frozenset(each) for each in surface.faces.tolist()
    }
    with pytest.raises(InputError, match="overlap seen from above"):
        surface.replace(vertices=surface.vertices[::-1])
    copy = pickle.loads(pickle.dumps(surface))
    np.testing.assert_array_equal(copy.faces, surface.faces)
    np.testing.assert_array_equal(copy.triangulation.constraints, surface.triangulation.constraints)


@pytest.mark.parametrize("suffix", ["ply", "npz", "obj", "off"])
def test_a_file_gives_the_surface_again(surface, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"tin.{suffix}"
    surface.save(path)
    again = liftmesh.as_surface(path)
    named = {frozenset(face) for face in surface.faces.tolist()}
    assert {frozenset(face) for face in again.faces.tolist()} == named
    places = np.random.default_rng(1).random((200, 2)) * SIZE
    np.testing.assert_allclose(again.sample(places), surface.sample(places), atol=1e-9)
    damaged = again.faces.copy()
    damaged[0] = damaged[1]
    damaged[0, 0] = again.faces[-1, 0]
    cloud = liftmesh.Cloud(again.vertices, faces=damaged, attributes=again.attributes)
    with pytest.raises(InputError, match="overlap seen from above"):
        liftmesh.as_surface(cloud)


def test_lines_along_edges_change_nothing() -> None:
    plain = liftmesh.triangulate(points())
    edge = plain.triangulation.edges[7]
    surface = liftmesh.triangulate(points(), breaklines=points()[edge])
    again = liftmesh.as_surface(surface.to_cloud())
    kept = again.triangulation.constraints.tolist()
    assert (
        kept == surface.triangulation.constraints.tolist() == [[len(points()), len(points()) + 1]]
    )
    places = np.random.default_rng(1).random((50, 2)) * SIZE
    np.testing.assert_allclose(again.sample(places), plain.sample(places), atol=1e-12)
