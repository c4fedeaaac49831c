"""refine with smooth: rows that were added move, and all that was asked for still holds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from stopped import LONG_RUN, seconds_to_stop

import liftmesh
from liftmesh import RefineResult, constrained_delaunay, refine

L_SHAPE = [[0.0, 0.0], [6.0, 0.0], [6.0, 2.0], [2.0, 2.0], [2.0, 6.0], [0.0, 6.0]]
HOLE = [[0.5, 0.5], [1.0, 0.75], [0.75, 1.5]]
LAND = constrained_delaunay([], polygons=[[L_SHAPE, HOLE]], carve="holes")

Array = np.ndarray[Any, Any]


def as_set(result: RefineResult) -> set[Any]:
    """The triangles by the positions of their corners."""
    places = result.triangulation.points[result.triangulation.simplices]
    return {tuple(sorted(map(tuple, each))) for each in places.tolist()}


def moved(plain: RefineResult, result: RefineResult) -> Array:
    """Hold a smoothed result against the one that is not; return the rows that moved."""
    assert result.verify().canonical, str(result.verify())
    np.testing.assert_array_equal(result.steiner_edges, plain.steiner_edges)
    assert result.min_angle >= plain.min_angle * (1 - 1e-12)  # as its triangle is turned
    assert np.count_nonzero(result.causes != "input angle") <= np.count_nonzero(
        plain.causes != "input angle"
    )
    before, after = plain.triangulation.points, result.triangulation.points
    rows = np.flatnonzero((before != after).any(axis=1))
    assert set(rows) <= set(result.steiner[result.steiner_edges < 0])
    return rows


def test_angles_grow_on_average() -> None:
    asked: dict[str, Any] = {"max_area": 0.01}
    plain = refine(LAND, **asked)
    means = [plain.angles.min(axis=1).mean()]
    for rounds in (1, 3, 10):
        result = refine(LAND, **asked, smooth=rounds)
        assert len(moved(plain, result)) > 500
        means.append(result.angles.min(axis=1).mean())
    assert means == sorted(means)
    assert means[3] > means[0] + 2


def test_points_come_back_where_nothing_is_better() -> None:
    """In the last round every row is taken out, tried elsewhere and put back."""
    at_rest = refine(LAND, max_area=0.1, smooth=1000)
    assert moved(refine(LAND, max_area=0.1), at_rest).size
    assert as_set(refine(LAND, max_area=0.1, smooth=999)) == as_set(at_rest)


def longest(result: RefineResult) -> tuple[Array, Array]:
    """The longest side of each triangle, and its centroid."""
    places = result.triangulation.points[result.triangulation.simplices]
    sides = places - np.roll(places, 1, axis=1)
    return np.hypot(*sides.transpose(2, 0, 1)).max(axis=1), places.mean(axis=1)


def graded(places: Array) -> Array:
    return 0.05 + 0.1 * places[:, 0]


@pytest.mark.parametrize("size", [0.2, graded, graded(LAND.points)])
def test_sizes_are_kept(size: Any) -> None:
    plain = refine(LAND, size=size)
    result = refine(LAND, size=size, smooth=5)
    assert len(moved(plain, result)) > 100
    lengths, places = longest(result)
    wanted = size if isinstance(size, float) else graded(places)
    if callable(size) or isinstance(size, float):
        assert (lengths <= np.sqrt(2) * wanted * (1 + 1e-9)).all()
    assert result.angles.min(axis=1).mean() > plain.angles.min(axis=1).mean() + 1


def test_areas_are_kept_by_region() -> None:
    halves = constrained_delaunay([[0, 0], [4, 0], [5, 4], [0, 4]], [[0, 2]])
    asked: dict[str, Any] = {"max_area": [0.05, 0.5]}
    result = refine(halves, **asked, smooth=5)
    assert moved(refine(halves, **asked), result).size
    tri = result.triangulation
    a, b, c = tri.points[tri.simplices].transpose(1, 0, 2)
    areas = np.abs(np.linalg.det(np.stack([b - a, c - a], axis=1))) / 2
    is_first = (tri.points[tri.simplices].mean(axis=1) @ [-4, 5] < 0) == (
        halves.points[halves.simplices[0]].mean(axis=0) @ [-4, 5] < 0
    )
    assert areas[is_first].max() <= 0.05
    assert 0.05 < areas[~is_first].max() <= 0.5


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0, 20, 30]), st.booleans(), st.integers(1, 4))
def test_random_edges(seed: int, angle: float, is_conforming: bool, rounds: int) -> None:
    """The order of rows does not count, and those that conform are Delaunay."""
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 40, (15, 2)).astype(float) if seed % 2 else rng.random((15, 2))
    tri = constrained_delaunay(points, rng.integers(0, 15, (5, 2)), crossing="split")
    options: dict[str, Any] = {"min_angle": angle, "conforming": is_conforming}
    options["max_area"] = float(np.ptp(points, axis=0).prod()) / 100
    result = refine(tri, **options, smooth=rounds)
    moved(refine(tri, **options), result)
    rows = rng.permutation(tri.npoints)
    edges = np.argsort(rows)[tri.constraints]
    other = refine(constrained_delaunay(tri.points[rows], edges), **options, smooth=rounds)
    assert as_set(other) == as_set(result)
    if is_conforming:
        plain = liftmesh.delaunay(result.triangulation.points)
        all_of_them = plain.points[plain.simplices].tolist()
        assert as_set(result) <= {tuple(sorted(map(tuple, each))) for each in all_of_them}


@pytest.mark.parametrize("scale", [2.0**-1000, 2.0**-500, 2.0**500, 2.0**1020])
def test_coordinates_of_any_size(scale: float) -> None:
    small = (np.array(L_SHAPE) * scale).tolist()
    result = refine(small, size=scale / 2, smooth=3)
    plain = refine(L_SHAPE, size=0.5, smooth=3)
    np.testing.assert_array_equal(result.triangulation.points / scale, plain.triangulation.points)
    assert moved(refine(small, size=scale / 2), result).size


@pytest.mark.parametrize("n", [5, 20, 50])
def test_where_digits_run_out(n: int) -> None:
    sliver = np.array([[0, 0], [n, n - 1], [2 * n + 1, 2 * n - 2], [n, n - 2]])
    tri = liftmesh.delaunay(1 + 2.0**-52 * sliver)
    moved(refine(tri, max_points=1000), refine(tri, max_points=1000, smooth=3))


def test_a_cap() -> None:
    """Triangles that are too large keep their corners."""
    with pytest.warns(liftmesh.DataWarning, match="no more may be"):
        plain = refine(LAND, max_area=1e-3, max_points=300)
    with pytest.warns(liftmesh.DataWarning, match="no more may be"):
        result = refine(LAND, max_area=1e-3, max_points=300, smooth=3)
    assert result.capped
    moved(plain, result)


@pytest.mark.parametrize("most", [6, 8, 10, 12])
def test_a_row_comes_back_where_an_edge_ends_beside_it(most: int) -> None:
    """It was put back into a triangle behind that edge, and triangles were clockwise."""
    points = np.array(
        [
            [20860, 20860], [10826, 10826], [10826, 20974], [13989, 33824], [19680, 28899],
            [35124, 1268], [32079, 29194], [4156, 1871], [20876, 20860], [20860, 16384],
        ]
    )  # fmt: skip
    tri = constrained_delaunay(points, [[0, 2]])
    with pytest.warns(liftmesh.DataWarning, match="no more may be"):
        assert refine(tri, min_angle=25, max_points=most, smooth=1).verify().canonical


def test_moved_rows_have_the_heights_before() -> None:
    x, y = np.random.default_rng(4).random((2, 200))
    before = liftmesh.triangulate(np.stack([x, y, np.sin(5 * x) + y**2], axis=1))
    result = refine(before, max_area=1e-3, smooth=3)
    rows = moved(refine(before, max_area=1e-3), result)
    assert len(rows) > 100
    places = result.surface.vertices[rows]
    np.testing.assert_array_equal(places[:, :2], result.triangulation.points[rows])
    np.testing.assert_allclose(places[:, 2], before.sample(places[:, :2]), atol=1e-12)


def test_progress_and_what_is_refused() -> None:
    told: list[float] = []
    refine(LAND, max_area=1e-3, smooth=5, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0
    for wrong in (-1, 1001, 1.5, True, "3"):
        with pytest.raises(liftmesh.InputError, match=r"smooth is .*: give a whole number from 0"):
            refine(LAND, smooth=wrong)


@pytest.mark.slow
def test_ctrl_c() -> None:
    program = LONG_RUN.format(
        points="rng.random((1000, 2))",
        prepare="tri = liftmesh.delaunay(points)",
        call="liftmesh.refine(tri, max_area=1e-4, smooth=1000)",
    )
    assert seconds_to_stop(program, 0.3) < 0.5
