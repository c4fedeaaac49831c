"""The proposition about lifted disks, and what breaks where they overlap."""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations

import numpy as np

import liftmesh
from liftmesh.paper.geometry import mu
from liftmesh.paper.propositions import Circle, Disk, plane_of_circle, position_of_disk

DIRECTIONS = [
    (Fraction(2 * t, 1 + t * t), Fraction(1 - t * t, 1 + t * t))
    for t in (Fraction(k, 7) for k in range(-60, 61, 4))
]


def test_lifted_points_of_a_disk_are_where_the_lemma_says() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        cx, cy, r, x, y, radius = (Fraction(int(v), 4) for v in rng.integers(1, 20, 6))
        q = (Fraction(int(rng.integers(-9, 9))), Fraction(1, 3))
        plane, disk = plane_of_circle((cx, cy), r, q), Disk.of((x, y), radius)
        assert Circle.of(plane, q) == Circle((cx, cy), r**2)
        lifted = [
            mu((x + radius * s * u, y + radius * s * v), q)
            for u, v in DIRECTIONS
            for s in (Fraction(1), Fraction(1, 2), Fraction(0))
        ]
        heights = [z - plane.alpha * a - plane.beta * b - plane.gamma for a, b, z in lifted]
        expected = {"above": min(heights) > 0, "on": min(heights) >= 0, "below": True}
        assert expected[position_of_disk(plane, disk, q)]
        if min(heights) < 0:
            assert position_of_disk(plane, disk, q) == "below"


def test_a_disk_that_touches_the_circle_is_on_the_plane() -> None:
    plane = plane_of_circle((0, 0), 3)
    assert position_of_disk(plane, Disk.of((3, 4), 2)) == "on"
    assert position_of_disk(plane, Disk.of((3, 4), Fraction(2001, 1000))) == "below"
    assert position_of_disk(plane_of_circle((0, 0), 0), Disk.of((3, 4), 5)) == "on"
    inside_out = Disk.of((1, 0), 4)  # its boundary touches the circle, which lies in the disk
    assert position_of_disk(plane, inside_out) == "below"


def supported_in_three(disks: np.ndarray) -> set[tuple[int, ...]]:
    """Solve for the planes that touch three lifted disks, and keep those below all others.

    The circle about c of radius r touches |x|^2 - 2 c . x + |c|^2 = (r + radius)^2 for three disks,
    so differences are linear in c and r.
    """
    found = set()
    for triple in permutations(range(len(disks)), 3):
        if triple[0] != min(triple):
            continue
        three = disks[list(triple)]
        for circle in touching_circles(three):
            centre, r = circle[:2], circle[2]
            apart = np.hypot(*(disks[:, :2] - centre).T) - disks[:, 2] - r
            (ax, ay), (bx, by), (cx, cy) = (three[:, :2] - centre) / (r + three[:, 2:])
            is_left = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0
            if r > 0 and apart.min() > -1e-9 and is_left:
                found.add(triple)
    return found


def touching_circles(three: np.ndarray) -> list[np.ndarray]:
    """Intersect the line of all (c, r) that both differences allow with the first cone."""
    x, y, radius = three.T
    system = 2 * np.column_stack([x[1:] - x[0], y[1:] - y[0], radius[1:] - radius[0]])
    right = (x**2 + y**2 - radius**2)[1:] - (x**2 + y**2 - radius**2)[0]
    along = np.cross(*system)
    start = np.linalg.lstsq(system, right, rcond=None)[0]
    lorentz = np.array([1.0, 1.0, -1.0])
    offset = start - np.array([x[0], y[0], -radius[0]])
    roots = np.roots(
        [(lorentz * along**2).sum(), 2 * (lorentz * along * offset).sum(),
         (lorentz * offset**2).sum()]
    )  # fmt: skip
    circles = [start + root.real * along for root in roots if abs(root.imag) < 1e-12]
    return [circle for circle in circles if (circle[2] + radius > 0).all()]


def test_planes_that_support_disjoint_disks_in_three_are_the_finite_triangles() -> None:
    rng = np.random.default_rng(4)
    for _ in range(3):
        cells = np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0)), -1).reshape(-1, 2)
        disks = np.c_[cells + 0.2 * rng.random((9, 2)), 0.39 * rng.random(9)]
        graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
        assert (graph.circles[:, 2] > 0).all()
        triangles = set(map(tuple, graph.simplices.tolist()))
        assert supported_in_three(disks) == triangles


def test_where_disks_overlap_triangles_of_negative_radius_have_no_plane() -> None:
    rng = np.random.default_rng(5)
    lost = 0
    for _ in range(6):
        disks = np.c_[rng.random((9, 2)), 0.35 * rng.random(9)]
        graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
        has_plane = graph.circles[:, 2] > 0
        seen = set(map(tuple, graph.simplices[has_plane].tolist()))
        assert supported_in_three(disks) == seen
        lost += np.count_nonzero(~has_plane)
    assert lost > 5


def test_the_circle_in_an_overlap_is_below_points_of_its_own_disks() -> None:
    disks = [Disk.of((-1, 0), 2), Disk.of((1, 0), 2), Disk.of((0, 1), 2)]
    graph = liftmesh.apollonius([[-1, 0], [1, 0], [0, 1]], [2, 2, 2])
    ((x, y, radius),) = graph.circles.tolist()
    assert (x, y, radius) == (0, 0, -1)
    plane = plane_of_circle((0, 0), radius)
    assert [position_of_disk(plane, disk) for disk in disks] == ["below"] * 3
