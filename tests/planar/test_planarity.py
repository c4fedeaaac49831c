"""Which triangles conflict first: beside rationals, in lattices where much is degenerate."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh.planar.planarity import Conflict, are_planar, first_conflict, turned

Corner = tuple[Fraction, Fraction]


def area(a: Corner, b: Corner, c: Corner) -> Fraction:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def clipped(ring: list[Corner], a: Corner, b: Corner) -> list[Corner]:
    """Clip a convex ring to what is on the left of a line (Sutherland and Hodgman, 1974)."""
    found = []
    for p, q in zip(ring, ring[1:] + ring[:1], strict=True):
        of_p, of_q = area(a, b, p), area(a, b, q)
        if of_p >= 0:
            found.append(p)
        if of_p * of_q < 0:
            t = of_p / (of_p - of_q)
            found.append((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])))
    return found


def is_overlap(one: list[Corner], other: list[Corner]) -> bool:
    ring = one
    for a, b in zip(other, other[1:] + other[:1], strict=True):
        ring = clipped(ring, a, b)
    return any(area(ring[0], p, q) != 0 for p, q in pairwise(ring))


def is_amid(one: list[Corner], other: list[Corner]) -> bool:
    """Whether a corner of one is inside a side of the other."""
    for a, b in zip(other, other[1:] + other[:1], strict=True):
        for p in one:
            along = [(p[k] - a[k]) * (b[k] - p[k]) for k in (0, 1)]
            if area(a, b, p) == 0 and min(along) >= 0 and p not in (a, b):
                return True
    return False


def expected(points: np.ndarray, triangles: np.ndarray) -> tuple[int, int] | None:
    """Compare all pairs; the earlier of each, and the first triangle with an earlier one."""
    rings = [[(Fraction(x), Fraction(y)) for x, y in points[rows].tolist()] for rows in triangles]
    pairs = [
        (later, earlier)
        for earlier, later in combinations(range(len(rings)), 2)
        if is_overlap(rings[earlier], rings[later])
        or is_amid(rings[earlier], rings[later])
        or is_amid(rings[later], rings[earlier])
    ]
    return min(pairs)[::-1] if pairs else None


CORNERS = st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=3, max_size=9)
ROWS = st.lists(st.integers(0, 8), min_size=3, max_size=24)


@settings(max_examples=300)
@given(CORNERS, ROWS, st.sampled_from([1.0, 0.1, 1e-300, 3e300]))
def test_lattices_beside_rationals(corners, rows, scale: float) -> None:
    points = np.array(corners, dtype=np.float64) * scale
    names = np.array(rows[: len(rows) // 3 * 3]).reshape(-1, 3) % len(points)
    triangles, is_flat = turned(points, names.astype(np.int32))
    triangles = triangles[~is_flat]
    found = first_conflict(points, triangles)
    assert (found and (found.earlier, found.later)) == expected(points, triangles)
    assert are_planar(points, triangles) == (found is None)


@given(st.integers(0, 10**6), st.integers(3, 12))
def test_triangulations_are_planar_and_one_more_face_is_not(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.random((count, 2))
    triangles = liftmesh.delaunay(points).simplices[:]
    kept = triangles[rng.random(len(triangles)) < 0.7]
    assert first_conflict(points, kept) is None
    more = np.vstack([kept, triangles[:1], triangles])
    conflict = first_conflict(points, more)
    is_kept = len(kept) > 0 and (kept == triangles[0]).all(axis=1).any()
    first = 0 if is_kept else len(kept)
    assert conflict == Conflict(first, len(kept) + (not is_kept))


@pytest.mark.parametrize("shift", [0.0, 2.0**30])
def test_what_touches_fits(shift: float) -> None:
    points = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [3, 3], [3, 2], [1, 0]]) + shift
    square = [[0, 1, 2], [0, 2, 3]]
    pinched = np.array([*square, [2, 6, 5]], dtype=np.int32)
    assert first_conflict(points, pinched) is None
    for face, row in (([0, 4, 3], 4), ([7, 1, 2], 7)):
        amid = np.array([[0, 1, 2], face], dtype=np.int32)
        found = first_conflict(points, amid)
        assert found is not None
        assert found.row == (row if face[0] == 0 else None)  # the other overlaps


def test_faces_far_apart_in_the_list() -> None:
    x, y = (each.ravel() for each in np.mgrid[:40, :40])
    points = np.column_stack([x, y]).astype(float)
    triangles = liftmesh.delaunay(points).simplices
    over = np.vstack([triangles, [[0, 1599, 39]]]).astype(np.int32)
    for threads in (1, 2):
        corners, _ = turned(points, over)
        found = first_conflict(points, corners, threads)
        assert found is not None
        assert found.later == len(triangles)
        assert found.earlier == expected_first(points, corners)


def expected_first(points: np.ndarray, triangles: np.ndarray) -> int:
    rings = [[(Fraction(x), Fraction(y)) for x, y in points[rows].tolist()] for rows in triangles]
    return next(number for number, ring in enumerate(rings) if is_overlap(ring, rings[-1]))


def test_verify_says_whether_triangles_that_are_not_delaunay_overlap() -> None:
    kite = np.array([[0, 0], [4, -1], [8, 0], [4, 1], [4, 9]], dtype=float)
    for faces in ([[0, 1, 2], [0, 2, 3]], [[0, 2, 1], [0, 2, 3]], [[2, 1, 0]]):
        found = liftmesh.verify(kite, faces)
        assert (found.valid, found.planar, found.delaunay) == (False, True, False)
        assert str(found).endswith("no two triangles overlap: as_surface takes them")
        assert found.as_dict()["planar"] is True
    for faces in ([[0, 1, 2], [0, 1, 3]], [[0, 1, 1]], [[0, 1, 7]], []):
        found = liftmesh.verify(kite, faces)
        assert (found.valid, found.planar, found.delaunay) == (False, False, False)
        assert "as_surface" not in str(found)
    apart = np.vstack([kite, kite[:1]])
    found = liftmesh.verify(apart, [[0, 1, 2], [5, 2, 3]])
    assert str(found).endswith("as_surface takes them if rows at one position have one height")
    whole = liftmesh.verify(kite, liftmesh.delaunay(kite).simplices)
    assert (whole.valid, whole.planar, whole.delaunay) == (True, True, True)
    heavy = liftmesh.verify(kite, [[0, 1, 2]], weights=[0, 0, 0, 0, 0])
    assert (heavy.planar, heavy.delaunay) == (None, None)
    assert "planar" not in heavy.as_dict()
