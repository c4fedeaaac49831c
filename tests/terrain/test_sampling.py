"""Heights and slopes of surfaces: exact places, canonical bits, and numbers within rounding."""

from __future__ import annotations

import numpy as np
import pytest
from clouds import FAMILIES
from hypothesis import given, settings, strategies as st
from matplotlib.tri import LinearTriInterpolator
from oracles.surfaces import exact_point
from scipy.interpolate import LinearNDInterpolator
from surfaces import LATTICE, SMALL, exactly, family_surface, with_heights

import liftmesh


@pytest.mark.parametrize("family", FAMILIES)
def test_heights_are_those_of_the_exact_faces(family: str) -> None:
    surface, queries = family_surface(family)
    oracle = exactly(surface)
    found = surface.sample(queries)
    span = np.ptp(surface.vertices[:, 2])
    for query, height in zip(queries.tolist(), found.tolist(), strict=True):
        expected = oracle.height(exact_point(query))
        if expected is None:
            assert np.isnan(height), query
        else:
            assert abs(height - float(expected)) <= 1e-10 * span, query


@pytest.mark.parametrize("family", FAMILIES)
def test_no_bit_depends_on_the_order_of_the_rows(family: str) -> None:
    surface, queries = family_surface(family)
    rng = np.random.default_rng(3)
    heights, gradients = surface.sample(queries), surface.gradient(queries)
    rows = surface.vertices[rng.permutation(len(surface.vertices))]
    turned = liftmesh.triangulate(rows, on_duplicate="lowest")
    order = rng.permutation(len(queries))
    np.testing.assert_array_equal(turned.sample(queries[order]), heights[order])
    np.testing.assert_array_equal(turned.gradient(queries[order]), gradients[order])


def test_no_bit_depends_on_the_threads_or_on_other_points() -> None:
    rng = np.random.default_rng(9)
    surface = liftmesh.triangulate(rng.random((20_000, 3)))
    queries = np.concatenate([rng.uniform(-0.1, 1.1, (60_000, 2)), surface.vertices[:, :2]])
    heights = surface.sample(queries, threads=1)
    np.testing.assert_array_equal(surface.sample(queries, threads=3), heights)
    np.testing.assert_array_equal(surface.sample(queries[::7]), heights[::7])
    gradients = surface.gradient(queries, threads=1)
    np.testing.assert_array_equal(surface.gradient(queries, threads=3), gradients)
    np.testing.assert_array_equal(np.isnan(gradients[:, 0]), np.isnan(heights))


def test_a_vertex_has_its_own_height() -> None:
    surface, _ = family_surface("utm-lattice", 400)
    used = np.unique(surface.faces)
    np.testing.assert_array_equal(
        surface.sample(surface.vertices[used, :2]), surface.vertices[used, 2]
    )


@settings(max_examples=60)
@given(LATTICE, st.lists(st.tuples(SMALL, SMALL), min_size=1, max_size=12))
def test_borders_belong_to_one_face(points, queries) -> None:
    try:
        surface = liftmesh.triangulate(points, on_duplicate="highest")
    except liftmesh.DegenerateInputError:
        return
    oracle = exactly(surface)
    found = surface.gradient(np.array(queries))
    for query, gradient in zip(queries, found.tolist(), strict=True):
        owner = oracle.owner(exact_point(query))
        if owner is None:
            assert np.isnan(gradient).all()
        else:
            expected = [float(each) for each in oracle.gradient_of(owner)]
            np.testing.assert_allclose(gradient, expected, rtol=1e-14, atol=1e-13)


def test_heights_agree_with_scipy_and_matplotlib() -> None:
    rng = np.random.default_rng(61)
    points = rng.random((3000, 3)) * (1000, 1000, 170)
    surface = liftmesh.triangulate(points)
    queries = rng.uniform(-20, 1020, (5000, 2))
    heights = surface.sample(queries)
    theirs = LinearNDInterpolator(surface.triangulation.to_scipy(), points[:, 2])(queries)
    np.testing.assert_allclose(heights, theirs, rtol=0, atol=1e-11)
    drawn = LinearTriInterpolator(surface.to_matplotlib(), points[:, 2])(*queries.T)
    np.testing.assert_allclose(heights, drawn.filled(np.nan), rtol=0, atol=1e-7)


@pytest.mark.parametrize("offset", [0.0, 5e6])
def test_a_plane_is_reproduced(offset: float) -> None:
    rng = np.random.default_rng(7)
    planar = rng.random((500, 2)) * 100 + offset
    plane = np.array([2.0, -3.0])
    surface = liftmesh.triangulate(np.column_stack([planar, (planar - offset) @ plane]))
    queries = rng.uniform(10, 90, (1000, 2)) + offset
    np.testing.assert_allclose(surface.sample(queries), (queries - offset) @ plane, atol=1e-7)
    level = surface.replace(vertices=np.column_stack([planar, np.full(500, 0.1)]))
    assert (level.sample(queries) == 0.1).all()


def test_thin_faces_keep_their_digits() -> None:
    """Where rounded determinants would leave a few digits, or none."""
    ulp = 2.0**-52
    points = [[1, 1, 0], [2, 2, 10], [1.5, 1.5 + 2 * ulp, 1000], [1.25, 1.25 - ulp, -1000]]
    surface = liftmesh.triangulate(points)
    oracle = exactly(surface)
    queries = np.array([[1.5, 1.5 + ulp], [1.3, 1.3], [1.75, 1.75 + ulp], [1.2, 1.2]])
    for query, height in zip(queries, surface.sample(queries), strict=True):
        expected = oracle.height(exact_point(query.tolist()))
        assert expected is None or abs(height - float(expected)) <= 1e-12 * 1000


@pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9, 1e-12])
def test_thin_faces_keep_the_digits_of_gradients(width: float) -> None:
    rng = np.random.default_rng(8)
    planar = rng.random((60, 2)) * (100, width)
    surface = liftmesh.triangulate(with_heights(planar @ [[0.6, 0.8], [-0.8, 0.6]]))
    oracle = exactly(surface)
    queries = surface.triangulation.points[surface.faces].mean(axis=1)
    for query, found in zip(queries.tolist(), surface.gradient(queries).tolist(), strict=True):
        owner = oracle.owner(exact_point(query))
        if owner is not None:
            expected = np.array([float(each) for each in oracle.gradient_of(owner)])
            assert np.hypot(*(found - expected)) <= 1e-11 * np.hypot(*expected)


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1e-170, 1e-160, 1e155, 1e200, 1e300])
@pytest.mark.parametrize("height", [1e-200, 1.0, 1e200])
def test_gradients_of_any_size(size: float, height: float) -> None:
    points = np.array([[0, 0, -1], [4, 0, 1], [0, 4, 2], [4, 4, -1]]) * (size, size, height)
    surface = liftmesh.triangulate(points)
    oracle = exactly(surface)
    queries = np.array([[1, 1], [2, 2], [3, 2], [1, 3], [4, 1], [0, 0], [3, 3]]) * size
    for query, found in zip(queries.tolist(), surface.gradient(queries).tolist(), strict=True):
        exact = oracle.gradient_of(oracle.owner(exact_point(query)))
        expected = [float(each) if abs(each) < 2**1023 else np.inf for each in exact]
        np.testing.assert_allclose(np.abs(found), np.abs(expected), rtol=1e-14, atol=5e-324)


@pytest.mark.parametrize("size", [1e-300, 5e-324, 1e300])
@pytest.mark.parametrize("height", [5e-324, 1.0, 1.7e308])
def test_coordinates_and_heights_of_any_size(size: float, height: float) -> None:
    points = np.array([[0, 0, -1], [4, 0, 1], [0, 4, 1], [4, 4, -1]]) * (size, size, height)
    surface = liftmesh.triangulate(points)
    oracle = exactly(surface)
    queries = np.array([[1, 1], [2, 2], [3, 2], [1, 3], [4, 1], [0, 0], [3, 3]]) * size
    for query, found in zip(queries.tolist(), surface.sample(queries).tolist(), strict=True):
        expected = float(oracle.height(exact_point(query)))
        assert abs(found - expected) <= max(1e-15 * abs(height), 5e-324)


def test_slope_and_aspect_are_those_of_the_face() -> None:
    surface = liftmesh.triangulate([[0, 0, 0], [10, 0, 0], [0, 10, 10], [10, 10, 10]])
    assert surface.slope([3, 4]) == pytest.approx(45)
    assert surface.aspect([3, 4]) == 180  # down to the south
    level = liftmesh.triangulate([[0, 0, 1], [1, 0, 1], [0, 1, 1]])
    assert level.slope([0.2, 0.2]) == 0
    assert np.isnan(level.aspect([0.2, 0.2]))
    assert np.isnan([surface.slope([30, 4]), surface.aspect([30, 4])]).all()


@pytest.mark.parametrize("angle", range(0, 360, 45))
def test_aspect_counts_clockwise_from_north(angle: int) -> None:
    down = np.array([np.sin(np.radians(angle)), np.cos(np.radians(angle))])
    planar = np.array([[-1.0, -1.0], [1.0, -1.0], [0.0, 1.5]])
    surface = liftmesh.triangulate(np.column_stack([planar, -planar @ down]))
    found = surface.aspect([0.0, 0.0])
    assert 0 <= found < 360
    assert min(abs(found - angle), 360 - abs(found - angle)) < 1e-9


class TestForms:
    @pytest.fixture
    def square(self) -> liftmesh.Surface:
        return liftmesh.triangulate([[0, 0, 1], [2, 0, 2], [0, 2, 3], [2, 2, 4]])

    @pytest.mark.parametrize("shape", [(), (0,), (5,), (3, 4), (2, 0, 3)])
    def test_results_have_the_shape_of_the_points(self, square, shape) -> None:
        queries = np.random.default_rng(0).uniform(-1, 3, (*shape, 2))
        assert np.shape(square.sample(queries)) == shape
        assert square.gradient(queries).shape == (*shape, 2)
        assert np.shape(square.slope(queries)) == np.shape(square.aspect(queries)) == shape

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_what_is_not_finite_has_no_height(self, square, value: float) -> None:
        assert np.isnan(square.sample([[value, 1], [1, value]])).all()
        assert np.isnan(square.gradient([value, 1])).all()

    def test_heights_are_measured_from_the_plane(self) -> None:
        rng = np.random.default_rng(4)
        points = rng.random((50, 3))
        surface = liftmesh.triangulate(points, plane="xz")
        np.testing.assert_array_equal(surface.sample(points[:, [0, 2]]), -points[:, 1])

    @pytest.mark.parametrize("points", [5.0, [1.0], [[1.0, 2.0, 3.0]], np.zeros((3, 0))])
    def test_points_of_another_dimension_are_refused(self, square, points) -> None:
        for call in (square.sample, square.gradient, square.slope, square.aspect):
            with pytest.raises(liftmesh.InputError, match="shape"):
                call(points)

    def test_options_are_checked(self, square) -> None:
        with pytest.raises(
            liftmesh.InputError, match="interpolation is 'cubic': give one of 'linear'"
        ):
            square.sample([1, 1], interpolation="cubic")
        with pytest.raises(liftmesh.InputError, match="threads is 0"):
            square.sample([1, 1], threads=0)

    def test_a_copy_has_its_own_heights(self, square) -> None:
        raised = square.replace(vertices=square.vertices * (1, 1, 10))
        assert raised.sample([1, 1]) == 10 * square.sample([1, 1])

    def test_hidden_rows_and_duplicates_count_as_the_report_says(self) -> None:
        points = [[0, 0, 1], [4, 0, 1], [0, 4, 1], [4, 4, 1], [1, 1, 50], [1, 1, 7]]
        assert liftmesh.triangulate(points, on_duplicate="lowest").sample([1, 1]) == 7
        weights = [0, 0, 0, 0, -99, -99]
        assert liftmesh.triangulate(points, weights=weights).sample([1, 1]) == 1
