"""`verify` decides by exact predicates wherever its rounded bounds cannot, at any scale."""

from __future__ import annotations

import numpy as np
import pytest

import liftmesh

RNG = np.random.default_rng(11)
FAR = np.array([[2.0**300, 0.0], [2.0**301, 0.0], [2.0**300, 2.0**301]])
SCALES = [(1.0, False), (1.0, True), (2.0**-537, True), (2.0**-700, True), (2.0**-1000, False)]
"""A factor, and whether rows far away leave no rounded bound of in-circle tests that holds."""


def counts(points: np.ndarray, triangles: np.ndarray) -> dict[str, int]:
    return {flaw.kind: flaw.count for flaw in liftmesh.verify(points, triangles).flaws}


def placed(corners: np.ndarray, scale: float, far: bool) -> np.ndarray:
    """Scale the corners of polygons, and put them behind one another, with far rows at the end."""
    rows = corners.reshape(-1, 2) * scale
    return np.vstack([rows, FAR]) if far else rows


def behind(polygons: int, corners: int, triangles: list[list[int]], far: bool) -> np.ndarray:
    """Number the triangles of each polygon, and that of the far rows."""
    first = corners * np.arange(polygons)[:, None, None]
    all_of_them = (first + np.array(triangles)).reshape(-1, 3)
    last = corners * polygons + np.array([[0, 1, 2]])
    return np.vstack([all_of_them, last] if far else [all_of_them]).astype(np.int32)


def on_circles(count: int) -> np.ndarray:
    angles = np.sort(RNG.random((count, 4)), axis=1) * 2 * np.pi
    unit = np.stack([np.cos(angles), np.sin(angles)], axis=2)
    return unit * RNG.random((count, 1, 1)) + RNG.random((count, 1, 2))


def on_lines(count: int) -> np.ndarray:
    along = RNG.standard_normal((count, 1, 2))
    return RNG.random((count, 1, 2)) + RNG.random((count, 3, 1)) * along


def amid_underflow(count: int) -> np.ndarray:
    """Triangles whose two products differ by less than the smallest double, scaled up by 2**537."""
    ratio = RNG.uniform(1.9, 2.0, count)
    tiny = np.full(count, 2.0**-54 * 0.999)
    corners = [(np.ones(count), 1.5 / ratio), (ratio, np.full(count, 1.5)), (tiny, 0 * tiny)]
    return np.stack([np.stack(each, axis=1) for each in corners], axis=1)


@pytest.mark.parametrize(("scale", "far"), SCALES)
@pytest.mark.parametrize("diagonal", [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]])
def test_edges_of_four_rows_nearly_on_a_circle(scale, far, diagonal) -> None:
    points = placed(on_circles(3000), scale, far)
    corners = points[:12_000].reshape(-1, 4, 2)
    a, b, c = (corners[:, k] for k in diagonal[0])
    beyond = corners[:, ({0, 1, 2, 3} - {*diagonal[0]}).pop()]
    wrong = int((liftmesh.incircle(a, b, c, beyond) > 0).sum())
    assert scale < 1e-200 or 900 < wrong < 2100
    assert counts(points, behind(3000, 4, diagonal, far)).get("not_delaunay", 0) == wrong


@pytest.mark.parametrize(("scale", "far"), SCALES)
@pytest.mark.parametrize("make", [on_lines, amid_underflow])
def test_triangles_that_are_nearly_flat(scale, far, make) -> None:
    # A large triangle beside them, so that not all may be clockwise.
    rows = np.vstack([make(4000).reshape(-1, 2), [[9, 9], [99, 9], [9, 99], [9, 99]]])
    points = placed(rows, scale, far)
    triangles = behind(4001, 3, [[0, 1, 2]], False)
    signs = liftmesh.orient2d(*(points[triangles[:, k]] for k in range(3)))
    assert signs[-1] == 1
    found = counts(points, triangles)
    assert (signs <= 0).any()
    assert found.get("clockwise", 0) == (signs < 0).sum()
    assert found.get("degenerate", 0) == (signs == 0).sum()


SIDES_OF_DIAGONAL = [[0, 1, 3], [1, 2, 3]]


def wrong_diagonals(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> tuple[int, int]:
    """How many diagonals b-d are not locally Delaunay, and how many of them are found."""
    points = np.stack([a, b, c, d], axis=1).reshape(-1, 2)
    wrong = int((liftmesh.incircle(a, b, d, c) > 0).sum())
    points = np.vstack([points, [[1e-200, 1e-200]]])  # too wide a range for any rounded bound
    found = counts(points, behind(len(a), 4, SIDES_OF_DIAGONAL, False))
    return wrong, found.get("not_delaunay", 0)


def test_a_cotangent_that_overflows_leaves_a_bound_that_is_no_number() -> None:
    random = RNG.random((4, 200))
    zero = np.zeros(200)
    b = np.stack([1 + random[0], zero], axis=1)
    d = np.stack([2 + random[1], 1e-20 * (1 + random[2])], axis=1)
    c = (b + d) / 2 - np.stack([zero, 1e-30 * (1 + random[3])], axis=1)
    wrong, found = wrong_diagonals(np.zeros((200, 2)), b * 1e160, c * 1e160, d * 1e160)
    assert wrong == found == 200


def test_cotangents_that_round_to_the_smallest_double_and_to_zero() -> None:
    """Nearly rectangles: of two opposite angles one is below 90 degrees by t / y, the other above
    by u / x, where t / y < u / x. The one rounds up, the other to 0."""
    count = 4000
    x, y = 2.0**400 * (1 + RNG.random((2, count)))
    inverse = 1 / (x * y)
    t, u = y * 2.0**-1000 * 2.0**-75, x * 2.0**-1000 * 2.0**-75
    for _ in range(4):
        t = np.where(t * x * inverse > 0, np.nextafter(t, 0), t)
        u = np.where(u * y * inverse > 0, u, np.nextafter(u, np.inf))
    for _ in range(8):
        t = np.where(t * x * inverse > 0, t, np.nextafter(t, np.inf))
        u = np.where(u * y * inverse > 0, np.nextafter(u, 0), u)
    a = np.stack([-0.51 * np.spacing(t), -y], axis=1)  # the differences round to t and to u
    c = np.stack([x, -0.49 * np.spacing(u)], axis=1)
    d = np.stack([np.nextafter(t, 0), u], axis=1)
    wrong, found = wrong_diagonals(a, np.stack([x, -y], axis=1), c, d)
    assert wrong == found
    assert wrong > 1000


def test_a_clockwise_triangle_whose_area_underflows() -> None:
    near = [(2.2227587494850775e-162, 1.669653631647303e-162), (1.232645091961744e-178, 0.0)]
    far = [(4.438635982426439e-162, 3.334138124227616e-162), (-3.33e9, 4.43e9), (3.3e-162, 3e-163)]
    points = np.array([near[0], far[0], near[1], *far[1:]])
    right, wrong = [(2, 0, 3), (0, 1, 3)], [(0, 1, 2), (2, 1, 3)]
    below = [(0, 2, 4), (1, 0, 4)]
    assert liftmesh.verify(points, [*right, *below])
    assert counts(points, np.array([*wrong, *below])) == {"clockwise": 1}


def test_missing_vertices_are_missed_whatever_their_number() -> None:
    points = RNG.random((200, 2))
    points[:4] = [[-1, -1], [2, -1], [2, 2], [-1, 2]]
    for missing in range(1, 100):
        kept = liftmesh.delaunay(points[: 200 - missing]).simplices
        assert counts(points, kept) == {"missing_vertices": missing}
