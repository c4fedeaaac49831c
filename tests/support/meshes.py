"""Compare and check triangulations exactly.

Triangles are compared as a set of coordinate triples, the only thing on which two programs can
agree. `assert_delaunay` checks a triangulation against nothing but its points.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray
from oracles import planar as oracle
from oracles.constrained import judge

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

ARRAYS = ("simplices", "neighbors", "convex_hull", "duplicates", "skipped")


def bits(triangulation: Triangulation) -> list[bytes]:
    """All that a triangulation holds, to be compared bit for bit."""
    return [getattr(triangulation, name).tobytes() for name in ARRAYS]


def triangle_rows(points: ArrayLike, simplices: ArrayLike) -> NDArray[np.float64]:
    """Coordinates of all triangles as sorted rows of six, each from its smallest vertex on.

    Two triangulations are the same set exactly when these arrays are equal; orientation counts.
    """
    xy = np.asarray(points, dtype=np.float64)[:, :2] + 0.0
    distinct, rank = np.unique(xy, axis=0, return_inverse=True)
    triples = rank.reshape(-1)[np.asarray(simplices, dtype=np.int64)]
    first = np.argmin(triples, axis=1)[:, None]
    triples = np.take_along_axis(triples, (first + np.arange(3)) % 3, axis=1)
    triples = triples[np.lexsort(triples.T[::-1])]
    return distinct[triples].reshape(-1, 6)


def assert_same_triangles(
    actual: NDArray[np.float64], expected: NDArray[np.float64], about: str = ""
) -> None:
    """Compare two results of `triangle_rows`; the message shows the first differences."""
    if np.array_equal(actual, expected):
        return
    ours, theirs = Counter(map(tuple, actual.tolist())), Counter(map(tuple, expected.tolist()))
    extra, missing = sorted((ours - theirs).elements()), sorted((theirs - ours).elements())
    raise AssertionError(
        f"{about}: {len(actual)} triangles, {len(expected)} expected; {len(extra)} are wrong, "
        f"such as {extra[:2]}; {len(missing)} are missing, such as {missing[:2]}"
    )


def oracle_triangles(points: NDArray[np.float64]) -> set[oracle.Triangle]:
    """Find the canonical triangulation in the oracle's integers."""
    return oracle.delaunay(oracle.exact(points.tolist()))


def exact_triangles(points: NDArray[np.float64], simplices: NDArray[np.int32]) -> list:
    """Triangles in the oracle's integers, row by row."""
    corners = oracle.exact(points.tolist())
    return [tuple(corners[vertex] for vertex in row) for row in simplices.tolist()]


def assert_oracle_agrees(
    points: NDArray[np.float64],
    simplices: NDArray[np.int32],
    expected: set[oracle.Triangle] | None = None,
) -> None:
    """Compare with the oracle: every row counter-clockwise, the same set, no triangle twice."""
    triangles = exact_triangles(points, simplices)
    clockwise = [row for row, corners in enumerate(triangles) if oracle.cross(*corners) <= 0]
    assert not clockwise, f"rows that are not counter-clockwise: {clockwise[:5]}"
    found = Counter(oracle.counter_clockwise(*corners) for corners in triangles)
    wanted = Counter(oracle_triangles(points) if expected is None else expected)
    assert found == wanted, (
        f"{points.tolist()}: extra {list((found - wanted).elements())[:2]}, "
        f"missing {list((wanted - found).elements())[:2]} (in lattice units)"
    )


def assert_delaunay(points: NDArray[np.float64], simplices: NDArray[np.int32]) -> None:
    """Check exactly that the rows are the canonical triangulation of the points."""
    judge(exact_triangles(points, simplices), oracle.exact(points.tolist()), [])


def hard_queries(triangulation: Triangulation, rng: Generator) -> NDArray[np.float64]:
    """Vertices, middles of sides, their neighbours by one ulp, and points all around."""
    points = triangulation.points
    corners = points[triangulation.simplices]
    middles = (corners / 2 + np.roll(corners, 1, axis=1) / 2).reshape(-1, 2)
    inside = (corners / 4).sum(axis=1) + corners[:, 0] / 4
    low, high = points.min(axis=0), points.max(axis=0)
    with np.errstate(over="ignore"):
        around = low + (high / 2 - low / 2) * rng.uniform(-0.2, 2.2, (20, 2))
        exact = np.vstack((points, middles, inside, around))
        nearby = np.nextafter(exact, rng.choice([-np.inf, np.inf], exact.shape))
    queries = np.vstack((exact, nearby))
    return queries[np.isfinite(queries).all(axis=1)]
