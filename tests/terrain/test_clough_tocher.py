"""Interpolation "c1": cubics over the faces, with continuous first derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.interpolate import CloughTocher2DInterpolator

import liftmesh
from liftmesh import InputError


def surface_of(count: int = 400, seed: int = 1) -> liftmesh.Surface:
    return liftmesh.triangulate(np.random.default_rng(seed).random((count, 3)))


@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_values_are_those_of_scipy(offset: float) -> None:
    """Whose gradients are estimated by the same equations, in rounds until nothing changes."""
    surface = surface_of()
    points, heights = surface.vertices[:, :2] + offset, surface.vertices[:, 2]
    moved = liftmesh.triangulate(np.column_stack([points, heights]))
    queries = np.random.default_rng(2).uniform(-0.1, 1.1, (3000, 2)) + offset
    oracle = CloughTocher2DInterpolator(points - offset, heights, tol=1e-14, maxiter=2000)
    expected = oracle(queries - offset)
    np.testing.assert_allclose(moved.sample(queries, "c1"), expected, atol=1e-12 + 1e-14 * offset)


def test_given_gradients_are_taken_as_by_scipy() -> None:
    surface = surface_of()
    gradients = np.random.default_rng(3).normal(size=(400, 2))
    queries = np.random.default_rng(4).random((2000, 2))
    oracle = CloughTocher2DInterpolator(surface.vertices[:, :2], surface.vertices[:, 2])
    oracle.grad[...] = gradients[:, None]
    found = surface.sample(queries, "c1", gradients=gradients)
    np.testing.assert_allclose(found, oracle(queries), atol=1e-12)


def test_planes_and_quadratics_are_reproduced() -> None:
    surface = surface_of()
    x, y = surface.vertices[:, :2].T
    queries = np.random.default_rng(5).random((1000, 2))
    inside = ~np.isnan(surface.sample(queries))
    u, v = queries[inside].T
    plane = surface.sample(queries[inside], "c1", values=3 * x - 2 * y + 7)
    np.testing.assert_allclose(plane, 3 * u - 2 * v + 7, rtol=1e-13)
    assert set(surface.sample(queries[inside], "c1", values=np.full(400, 0.1))) == {0.1}
    values = x * x - 3 * x * y + 2 * y * y + x
    gradients = np.column_stack([2 * x - 3 * y + 1, 4 * y - 3 * x])
    found = surface.sample(queries[inside], "c1", values=values, gradients=gradients)
    np.testing.assert_allclose(found, u * u - 3 * u * v + 2 * v * v + u, atol=1e-13)


def test_slopes_are_continuous_across_edges_and_at_vertices() -> None:
    surface = surface_of(60, 8)
    corners = surface.vertices[surface.faces]
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 3)[..., :2]
    share = np.random.default_rng(9).uniform(0.1, 0.9, (len(ends), 1))
    places = ends[:, 0] * (1 - share) + ends[:, 1] * share
    across = (ends[:, 1] - ends[:, 0])[:, ::-1] * [1, -1]
    across /= np.linalg.norm(across, axis=1)[:, None]

    def jump(near: float) -> float:
        """The largest difference of slopes across an edge, at places so near to it."""
        there, here = (
            [surface.sample(places + near * s * across, "c1") for s in steps]
            for steps in ((0.9, 1.1), (-1.1, -0.9))
        )
        slopes = (there[1] - there[0] - (here[1] - here[0])) / (0.2 * near)
        assert np.isfinite(slopes).sum() > 300
        return float(np.nanmax(np.abs(slopes)))

    assert jump(1e-6) < jump(1e-5) / 9 < jump(1e-4) / 81 < 0.1
    gradients = np.random.default_rng(10).normal(size=(60, 2))
    used = np.unique(surface.faces)
    for axis, along in enumerate(np.eye(2)):
        step = 1e-7
        there, back = (
            surface.sample(surface.vertices[used, :2] + s * along, "c1", gradients=gradients)
            for s in (step, -step)
        )
        slopes = (there - back) / (2 * step)
        at = ~np.isnan(slopes)
        np.testing.assert_allclose(slopes[at], gradients[used][at, axis], atol=1e-3)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30)
def test_the_order_of_rows_changes_no_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.column_stack([np.round(rng.random((25, 2)) * 8), rng.random(25)])
    points = points[np.unique(points[:, :2], axis=0, return_index=True)[1]]
    queries = np.concatenate([rng.uniform(0, 8, (30, 2)), rng.integers(0, 17, (30, 2)) / 2])
    one = liftmesh.triangulate(points).sample(queries, "c1")
    other = liftmesh.triangulate(rng.permutation(points)).sample(queries, "c1")
    np.testing.assert_array_equal(one, other)


def test_values_of_any_shape_rasters_and_functions() -> None:
    surface = surface_of()
    queries = np.random.default_rng(6).random((5, 7, 2))
    values = np.random.default_rng(7).random((400, 2, 3))
    found = surface.sample(queries, "c1", values=values)
    assert found.shape == (5, 7, 2, 3)
    np.testing.assert_array_equal(
        found[..., 1, 2], surface.sample(queries, "c1", values=values[:, 1, 2])
    )
    gradients = np.random.default_rng(8).random((400, 2))
    called = surface.interpolator(interpolation="c1", gradients=gradients)
    np.testing.assert_array_equal(
        called(queries), surface.sample(queries, "c1", gradients=gradients)
    )
    raster = surface.raster(0.05, interpolation="c1", gradients=gradients)
    np.testing.assert_array_equal(raster.values, called(raster.centers()))
    raster = surface.raster(0.05, values=values[:, 0, 0], interpolation="c1")
    expected = surface.sample(raster.centers(), "c1", values=values[:, 0, 0])
    np.testing.assert_array_equal(raster.values, expected)


@pytest.mark.parametrize("exponent", [1020, -900])
def test_heights_of_any_scale_have_the_same_bits(exponent: int) -> None:
    surface, queries = surface_of(), np.random.default_rng(6).random((500, 2))
    heights = surface.vertices[:, 2]
    scaled = np.ldexp(heights, exponent)
    for gradients in (None, np.random.default_rng(8).random((400, 2)) - 0.5):
        found = surface.sample(queries, "c1", values=heights, gradients=gradients)
        steep = None if gradients is None else np.ldexp(gradients, exponent)
        other = surface.sample(queries, "c1", values=scaled, gradients=steep)
        np.testing.assert_array_equal(np.ldexp(found, exponent), other)


def test_lines_holes_and_places_beyond() -> None:
    points = np.random.default_rng(5).random((200, 3))
    lined = liftmesh.triangulate(points, breaklines=[[[0.1, 0.1, 0], [0.9, 0.8, 1]]])
    queries = np.random.default_rng(6).uniform(-0.2, 1.2, (500, 2))
    for surface in (lined, surface_of().trim(max_edge=0.2)):
        expected = np.isnan(surface.sample(queries))
        np.testing.assert_array_equal(np.isnan(surface.sample(queries, "c1")), expected)
        at = surface.vertices[np.unique(surface.faces)]
        np.testing.assert_array_equal(surface.sample(at[:, :2], "c1"), at[:, 2])
    surface = surface_of()
    ends = surface.vertices[surface.triangulation.convex_hull]
    middle = (ends[0] + ends[1])[:2] / 2
    outward = (ends[1] - ends[0])[[1, 0]] * [1, -1]
    near, far = (surface.sample(middle + s * outward, "c1", extrapolate="hull") for s in (1e-9, 1))
    inside = surface.sample(middle - 1e-9 * outward, "c1")
    np.testing.assert_allclose([near, far], inside, atol=1e-6)
    nearest = surface.sample([9, 9], "c1", extrapolate="nearest")
    assert nearest == surface.sample([9, 9], extrapolate="nearest")


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_every_magnitude(scale: float) -> None:
    surface = surface_of(30)
    factor = 2.0 ** np.log2(scale).round()
    queries = np.random.default_rng(2).random((50, 2))
    moved = liftmesh.triangulate(surface.vertices * [factor, factor, 1])
    expected = surface.sample(queries, "c1")
    np.testing.assert_allclose(moved.sample(queries * factor, "c1"), expected, rtol=1e-14)
    large = surface.sample(queries, "c1", values=surface.vertices[:, 2] * 1.5e308)
    np.testing.assert_array_equal(np.isfinite(large), np.isfinite(expected))


def test_slivers_have_finite_values() -> None:
    tiny = 2.0**-40
    points = [[0, 0, 1], [1, tiny, 2], [2, 0, 3], [1, -2, 0], [1, 2 * tiny, 5]]
    surface = liftmesh.triangulate(points)
    queries = [[x, y] for x in np.linspace(0.1, 1.9, 19) for y in (0, tiny / 2, -0.1)]
    found = surface.sample(queries, "c1")
    np.testing.assert_array_equal(np.isnan(found), np.isnan(surface.sample(queries)))


def test_what_is_refused() -> None:
    surface = surface_of(50)
    values = surface.vertices[:, 2].copy()
    values[7] = np.nan
    with pytest.raises(InputError, match="values of row 7 hold nan: interpolation='c1' needs"):
        surface.sample([0.5, 0.5], "c1", values=values)
    slopes = np.zeros((50, 2))
    slopes[3, 1] = np.inf
    with pytest.raises(InputError, match="gradients of row 3 hold inf"):
        surface.sample([0.5, 0.5], "c1", gradients=slopes)
    with pytest.raises(InputError, match=r"gradients have the shape \(50,\), not \(50, 2\): give"):
        surface.sample([0.5, 0.5], "c1", gradients=np.zeros(50))
    with pytest.raises(InputError, match=r"\(50, 2\), not \(50, 3, 2\)"):
        surface.sample([0.5, 0.5], "c1", values=np.zeros((50, 3)), gradients=np.zeros((50, 2)))
    with pytest.raises(InputError, match="gradients are 'steep'"):
        surface.sample([0.5, 0.5], "c1", gradients="steep")
    with pytest.raises(InputError, match="gradients are for interpolation='c1', not 'linear'"):
        surface.sample([0.5, 0.5], gradients=np.zeros((50, 2)))
    with pytest.raises(InputError, match="gradients are for interpolation='c1', not 'linear'"):
        surface.raster(0.1, quantity="slope", gradients=np.zeros((50, 2)))
    unused = liftmesh.triangulate([[0, 0, 0], [1, 0, 1], [0, 1, 2], [0, 0, np.nan]],
                                  on_duplicate="first", nonfinite="skip")  # fmt: skip
    assert np.isfinite(unused.sample([0.2, 0.2], "c1"))


def test_a_surface_in_tiles_has_none(tmp_path) -> None:
    tiled = liftmesh.tile_surface(np.random.default_rng(1).random((100, 3)), tmp_path / "tiles")
    with pytest.raises(InputError, match="'c1' needs all vertices at once"):
        tiled.raster(0.1, interpolation="c1")
