"""Refinement where float64 has too few digits."""

from __future__ import annotations

import warnings
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import constrained_delaunay, refine


def in_place(tri: liftmesh.Triangulation) -> set[Any]:
    """The triangles by the positions of their corners."""
    return {tuple(sorted(map(tuple, each))) for each in tri.points[tri.simplices].tolist()}


@pytest.mark.parametrize("n", [5, 20, 50])
def test_it_ends_where_digits_run_out(n: int) -> None:
    """Slivers of a few units in the last place."""
    sliver = np.array([[0, 0], [n, n - 1], [2 * n + 1, 2 * n - 2], [n, n - 2]])
    tri = liftmesh.delaunay(1 + 2.0**-52 * sliver)
    result = refine(tri, max_points=1000)
    assert result.verify().valid
    assert not result.capped


def test_clusters_are_left_to_their_digits() -> None:
    """Rows a few units in the last place apart; rounded rows between them would never do."""
    rng = np.random.default_rng(3)
    units = 2.0**-52 * rng.integers(-20, 20, (2, 8, 2))
    points = np.concatenate([[1.5, 1.5] + units[0], [1.25, 1.75] + units[1]])
    result = refine(liftmesh.delaunay(points), max_points=1000)
    assert (result.capped, result.verify().valid) == (False, True)
    left = result.below[result.causes == "precision"]
    assert len(left)
    places = result.triangulation.points[result.triangulation.simplices[left]]
    lengths = np.hypot(*(places - np.roll(places, 1, axis=1)).transpose(2, 0, 1))
    assert (lengths.min(axis=1) < 2.0**-45).all()


@pytest.mark.parametrize("is_conforming", [False, True])
def test_a_sliver_of_a_unit_in_the_last_place(is_conforming: bool) -> None:
    """The rows on both of its sides are matched, but for rounding."""
    sliver = [[0.0, 0.0], [0.1, 0.3], [0.7, np.nextafter(2.1, 3)], [-4.0, 2.0]]
    tri = constrained_delaunay(sliver, [[0, 1], [1, 2], [2, 0]])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", liftmesh.DataWarning)  # where it cannot conform
        result = refine(tri, min_angle=28, conforming=is_conforming, max_points=1000)
    assert not result.capped
    assert result.verify().valid


@pytest.mark.parametrize("width", [1e-4, 2.5e-6, 1e-7])
def test_needles_conform_at_map_coordinates(width: float) -> None:
    """No rows that match exactly, so that circles would be empty, are there in float64."""
    needle = np.array([[0.0, 0.0], [0.22, 0.06 + width], [1.83, 0.5]])
    needle += [450000, 5200000]
    result = refine([needle], min_angle=28, conforming=True, max_points=1000)
    assert not result.capped
    assert set(result.causes) == {"input angle"}
    made = result.triangulation
    assert in_place(made) <= in_place(liftmesh.delaunay(made.points))


@pytest.mark.parametrize("width", [16, 400])
def test_rows_few_ulps_apart(width: int) -> None:
    """Rows on an edge are rounded to beside it, where others are as near."""
    for seed in range(60):
        rng = np.random.default_rng(seed)
        points = np.unique(1 + 2.0**-52 * rng.integers(0, width, (24, 2)), axis=0)
        try:
            tri = constrained_delaunay(points, rng.integers(0, len(points), (3, 2)))
        except liftmesh.CrossingError:
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", liftmesh.DataWarning)  # of the cap
            result = refine(tri, min_angle=28, max_points=20)
        assert result.verify().valid, seed


@pytest.mark.parametrize("options", [{"size": 0.01}, {"max_area": 0.01}])
def test_what_stays_too_large_is_told(options: Any) -> None:
    square = np.array([[0.0, 0.0], [4, 0], [4, 4], [0, 4]])
    with pytest.warns(liftmesh.DataWarning, match=r"4 triangles stayed larger .*`too_large`"):
        result = refine(square + 1e15, **options)
    assert result.too_large.tolist() == [0, 1, 2, 3]
    assert (result.capped, result.verify().valid) == (False, True)


def test_areas_beyond_float64_are_compared() -> None:
    """Of coordinates whose products overflow."""
    square = np.array([[0.0, 0.0], [4, 0], [4, 4], [0, 4]])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        result = refine(square * 1e307, max_area=1e308, max_points=50)
    assert [each.category for each in told] == [liftmesh.DataWarning]
    count = result.triangulation.nsimplex
    assert (len(result.steiner), len(result.too_large)) == (50, count)
    assert len(refine(square * 1e-307, max_area=1e-308).too_large) == 0
    assert len(refine(square * 1e307, size=1e307).too_large) == 0


def test_what_cannot_conform_is_told() -> None:
    far, near = 2.0**1000, 2.0**-1074
    points = np.array(
        [[5, 5], [3, 5], [6, 3], [3, 2], [2, 3], [7, 5], [0, 3], [6, 0], [1, 5], [2, 0]]
    )
    edges = [[7, 3], [7, 0], [1, 9], [9, 4], [3, 9], [8, 0], [9, 7], [8, 6], [9, 1]]
    tri = constrained_delaunay(points * [far, near], edges, carve="holes")
    with pytest.warns(liftmesh.DataWarning, match=r"not those of `delaunay` across \d+ constraint"):
        refine(tri, min_angle=28, conforming=True, max_points=500)


@pytest.mark.parametrize(
    ("options", "large"),
    [({"size": 1e-160}, [0, 1]), ({"size": 1e-120}, [1]), ({"max_area": 1e-320}, [0])],
)
def test_what_is_very_small_beside_the_domain_is_measured(options: Any, large: list[int]) -> None:
    """Squares of such lengths are below all doubles."""
    tri = liftmesh.delaunay([[0, 0], [1e-150, 0], [0, 1e-150], [1e150, 1e150]])
    with pytest.warns(liftmesh.DataWarning, match="stayed larger than asked for"):
        result = liftmesh.refine(tri, min_angle=None, **options)
    assert (result.too_large.tolist(), result.capped) == (large, False)


def test_the_shortest_side_tells_causes_where_squares_are_lost() -> None:
    """Each triangle for which an input angle is blamed stands over two edges."""
    points = [[-1.7404329748619824e187, 0.0], [0.0, 2e-115], [0.0, 1e-104]]
    with pytest.warns(liftmesh.DataWarning, match="no more may be"):
        result = refine(points, min_angle=20, size=1e41, max_points=500)
    tri, free = result.triangulation, result.steiner[result.steiner_edges < 0].tolist()
    assert set(result.causes) == {"input angle", "cap"}
    for corners in tri.simplices[result.below[result.causes == "input angle"]].tolist():
        pairs = [(corners[k - 2], corners[k - 1]) for k in range(3)]
        shortest = min(pairs, key=lambda ends: distance2(*tri.points[list(ends)].tolist()))
        assert not set(shortest) & set(free)


def distance2(one: list[float], other: list[float]) -> Fraction:
    return sum(
        ((Fraction(a) - Fraction(b)) ** 2 for a, b in zip(one, other, strict=True)),
        start=Fraction(0),
    )


def test_rounded_rows_blame_no_right_angle() -> None:
    """Beside the corner of edges that are square to each other, of which one is rounded away."""
    points = [[1.8e-276, 0.0], [1.141798154164768e46, 0.0], [-2.7e129, -2.6e-82], [5.9e-98, 6.2e85]]
    tri = constrained_delaunay(points, [[2, 0], [1, 2], [3, 1]])
    with pytest.warns(liftmesh.DataWarning, match="no more may be"):
        result = refine(tri, min_angle=20, max_area=1e212, max_points=500)
    edges = np.full(result.triangulation.npoints, -1)
    edges[result.steiner] = result.steiner_edges
    blamed = result.triangulation.simplices[result.below[result.causes == "input angle"]]
    assert len(blamed)
    assert not [each for each in edges[blamed].tolist() if {1, 2} <= {*each}]
