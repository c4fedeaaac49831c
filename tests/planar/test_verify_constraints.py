"""`verify` with constraints: what is right passes, whole or carved, and what is wrong is named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from constrained_meshes import judged
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

import liftmesh
from liftmesh import Certificate, InputError, _kernel

KITE = np.array([[0.0, 0.0], [4.0, -1.0], [8.0, 0.0], [4.0, 1.0]])
ACROSS = [[0, 1, 2], [0, 2, 3]]
SQUARE = [(0, 0), (6, 0), (6, 6), (0, 6)]
HOLE = [(2, 2), (4, 2), (4, 4), (2, 4)]
RING = [[0, 1], [1, 2], [2, 3], [3, 0]]
CORNERS = st.tuples(st.integers(0, 4), st.integers(0, 4))


def kinds(certificate: Certificate) -> dict[str, int]:
    return {flaw.kind: flaw.count for flaw in certificate.flaws}


def solved(points: Any, edges: Any) -> tuple[NDArray[np.int32], NDArray[np.int32], list[int]]:
    """Triangles, their regions, and an edge that crosses another, if there is one."""
    rows, pairs = np.array(points, dtype=np.float64), np.array(edges, dtype=np.int32)
    outcome, marks, *_, crossings = _kernel.constrained(
        rows, pairs.reshape(-1, 2), False, 1, False, None
    )
    regions = _kernel.label_regions(outcome[4], marks)
    return outcome[3], regions, crossings[:1, 0].tolist()


def uncrossed(points: Any, edges: list[Any]) -> list[Any]:
    """Leave out edges until none cross."""
    while crossing := solved(points, edges)[2]:
        edges = edges[: crossing[0]] + edges[crossing[0] + 1 :]
    return edges


def assert_judged(points: list[Any], triangles: Any, edges: Any, carved: bool) -> None:
    triples = [tuple(map(int, triangle)) for triangle in triangles]
    pairs = [tuple(map(int, edge)) for edge in edges]
    valid, canonical = judged(points, triples, pairs, carved)
    found = liftmesh.verify(
        np.array(points, dtype=np.float64), triples, constraints=pairs, carved=carved
    )
    assert (found.valid, found.canonical) == (valid, canonical), (triples, str(found))
    assert found.n_constraints == len(pairs)
    if valid:
        positions = {points[row] for triple in triples for row in triple}
        outside = sum(point not in positions for point in points)
        assert found.n_outside == outside
        assert found.n_duplicates == len(points) - len(positions) - outside


@pytest.mark.slow
@settings(max_examples=120)
@given(st.data())
def test_it_says_what_trying_all_pairs_says(data: st.DataObject) -> None:
    points = data.draw(st.lists(CORNERS, min_size=3, max_size=9))
    row = st.integers(0, len(points) - 1)
    drawn = data.draw(st.lists(st.tuples(row, row), max_size=6))
    edges = uncrossed(points, drawn)
    triangles, regions, _ = solved(points, edges)
    left = data.draw(st.sets(st.sampled_from([*range(regions.max(initial=0) + 1)]), min_size=1))
    kept = triangles[np.isin(regions, [*left])].tolist()
    for carved in (False, True):
        assert_judged(points, kept, edges, carved)
        assert_judged(points, triangles, edges, carved)
        assert_judged(points, triangles, drawn, carved)
        assert_judged(points, kept, edges[1:], carved)
        assert_judged(points, kept[1:], edges, carved)
        assert_judged(points, [*kept, data.draw(st.tuples(row, row, row))], edges, carved)


@pytest.mark.slow
@settings(max_examples=120)
@given(st.data())
def test_overlaps_are_found_whatever_bounds_them(data: st.DataObject) -> None:
    points = data.draw(st.lists(CORNERS, min_size=4, max_size=9, unique=True))
    rows = st.lists(st.integers(0, len(points) - 1), min_size=3, max_size=6, unique=True)
    triangles: set[tuple[int, ...]] = set()
    for part in (data.draw(rows), data.draw(rows)):
        corners, _, _ = solved([points[row] for row in part], [])
        triangles |= {tuple(part[corner] for corner in triangle) for triangle in corners.tolist()}
    sides = [pair for a, b, c in triangles for pair in ((a, b), (b, c), (c, a))]
    border = [(a, b) for a, b in sides if (b, a) not in sides]
    assert_judged(points, sorted(triangles), border, carved=True)


@pytest.mark.parametrize("threads", [1, 3])
def test_large_ones_are_canonical_and_each_flip_is_found(threads: int) -> None:
    rng = np.random.default_rng(3)
    points = rng.random((40_000, 2))
    tri = liftmesh.delaunay(points)
    ends = rng.choice(tri.edges, 3000, replace=False)
    edges = np.concatenate([ends, tri.convex_hull[:, None] + [0, 0]])
    assert tri.verify().canonical
    options: dict[str, Any] = {"constraints": edges, "threads": threads}
    assert liftmesh.verify(points, tri.simplices, **options).canonical
    wrong = np.array([[5, 9], [3, 7]])
    found = liftmesh.verify(points, tri.simplices, **options | {"constraints": wrong})
    assert kinds(found) == {"missing_constraints": 2}


def test_an_edge_off_all_constraints_must_be_delaunay() -> None:
    assert kinds(liftmesh.verify(KITE, ACROSS)) == {"not_delaunay": 1, "not_canonical": 1}
    found = liftmesh.verify(KITE, ACROSS, constraints=[[2, 0]])
    assert found.canonical
    assert (found.member, found.n_constraints, found.n_outside) == ("constrained", 1, 0)
    assert str(found) == (
        "valid: these 2 triangles are the canonical constrained Delaunay triangulation of 4 rows; "
        "not Delaunay along constraints"
    )
    assert (found.planar, found.delaunay) == (True, False)
    along = liftmesh.verify(KITE, [[0, 1, 3], [1, 2, 3]], constraints=[[3, 1]])
    assert (bool(along), along.planar, along.delaunay) == (True, True, True)
    assert not liftmesh.verify(KITE, ACROSS, constraints=[[0, 1]])
    assert not liftmesh.verify(KITE, ACROSS, constraints=np.empty((0, 2), int))


def test_a_missing_constraint_is_named_with_the_row_where_edges_end() -> None:
    points = np.array([[0, 0], [2, 0], [4, 0], [6, 1], [6, -1], [8, 0], [0, 3], [0, -3]], float)
    tri = liftmesh.delaunay(points)
    found = liftmesh.verify(points, tri.simplices, constraints=[[0, 2], [1, 1], [5, 0]])
    (flaw,) = found.flaws
    assert (flaw.kind, flaw.text) == ("missing_constraints", "1 constraint is not a union of edges")
    (place,) = flaw.first
    assert place.rows == (5, 0, 2)
    assert place.text == (
        "constraint 2 between rows 5 (8.0, 0.0) and 0 (0.0, 0.0) is not a union of edges: none "
        "goes on along it at row 2 (4.0, 0.0)"
    )
    assert place.points == ((8.0, 0.0), (0.0, 0.0), (4.0, 0.0))


def test_constraints_that_cross_are_missing() -> None:
    found = liftmesh.verify(KITE, ACROSS, constraints=[[0, 2], [1, 3]])
    assert kinds(found) == {"missing_constraints": 1}
    assert found.flaws[0].first[0].rows == (1, 3, 1)


def carved_square() -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """A square with a hole, in which there is a row, and a row outside."""
    points = np.array([*SQUARE, *HOLE, (2.5, 3.5), (9, 9)], dtype=np.float64)
    edges = np.array([*RING, *(np.array(RING) + 4)], dtype=np.int32)
    tri = liftmesh.constrained_delaunay(points, polygons=[[edges[:4, 0], edges[4:, 0]]])
    inside = points[tri.simplices].mean(axis=1)
    is_left = (np.abs(inside - 3) > 1).any(axis=1) & (inside < 6).all(axis=1)
    beyond = (inside.sum(axis=1) > 12) & (inside.max(axis=1) > 6)
    return points, tri.simplices[is_left & ~beyond], edges


def test_carved_triangles_are_valid_only_where_that_is_allowed() -> None:
    points, triangles, edges = carved_square()
    found = liftmesh.verify(points, triangles, constraints=edges, carved=True)
    assert found.canonical, str(found)
    assert (found.n_outside, found.n_duplicates, found.n_hull_edges) == (2, 0, 8)
    assert found.euler_characteristic == 0
    assert "2 of them outside" in str(found)
    assert kinds(liftmesh.verify(points, triangles, constraints=edges)) == {
        "boundary_loops": 2,
        "missing_vertices": 2,
        "euler": 1,
    }
    whole = liftmesh.constrained_delaunay(points, edges)
    assert whole.verify().canonical
    assert not whole.verify().carved
    lined = liftmesh.triangulate(points, breaklines=points[:2])
    assert liftmesh.verify(lined, carved=True).carved, "the constraints are its own"
    with pytest.raises(liftmesh.InputError, match="carved=True is given without constraints"):
        liftmesh.verify(liftmesh.triangulate(points), carved=True)


def test_what_is_wrong_with_carved_triangles_is_named() -> None:
    points, triangles, edges = carved_square()

    def flaws(these: Any, constraints: Any, rows: Any = points) -> dict[str, int]:
        return kinds(liftmesh.verify(rows, these, constraints=constraints, carved=True))

    assert flaws(triangles[1:], edges)["open_boundaries"] > 0
    assert flaws(triangles, edges[2:]) == {"open_boundaries": 1}, "the other one is on the hull"
    assert flaws([*triangles, [4, 5, 6]], edges) == {"open_boundaries": 1}
    assert flaws([*triangles, [4, 5, 6]], [*edges, [4, 6]]) == {}
    assert flaws([*triangles, [4, 5, 8]], [*edges, [4, 8], [8, 5]]) == {}
    assert flaws([*triangles, [0, 1, 8]], [*edges, [1, 8], [8, 0]])["overlaps"] == 1
    assert flaws(triangles, [*edges, [0, 2]]) == {}, "two edges, and the hole between"
    assert flaws(triangles, [*edges, [0, 8]]) == {"missing_constraints": 1}
    assert flaws(triangles, [*edges, [4, 8], [9, 2]]) == {}
    inside = np.concatenate([points, [[1.0, 0.5], [6.0, 3.0]]])
    assert flaws(triangles, edges, inside) == {"missing_vertices": 2}
    text = str(liftmesh.verify(points, triangles, constraints=edges[2:], carved=True))
    assert "the edge between rows 1 (6.0, 0.0) and 2 (6.0, 6.0) has a triangle on one side" in text
    crossed = liftmesh.verify(points, ACROSS, constraints=RING, carved=True)
    assert kinds(crossed) == {"missing_vertices": 5, "not_canonical": 1}


def test_overlapping_parts_are_named_by_two_edges() -> None:
    points = np.array([*SQUARE, (3, 1), (9, 3), (3, 5)], dtype=np.float64)
    edges = [*RING, [4, 5], [5, 6], [6, 4]]
    found = liftmesh.verify(points, [*ACROSS, [4, 5, 6]], constraints=edges, carved=True)
    assert kinds(found)["overlaps"] == 1
    assert (found.n_outside, found.n_duplicates) == (None, None)
    assert found.flaws[0].first[0].triangles == (0, 2)
    assert "rows 4 (3.0, 1.0) and 5 (9.0, 3.0)" in found.flaws[0].first[0].text


def test_a_constraint_may_leave_triangles_and_come_back() -> None:
    points = np.array([*SQUARE, *HOLE, (0, 3), (2, 3), (3, 3), (4, 3), (6, 3)], dtype=np.float64)
    rings = [[0, 1], [1, 12], [12, 2], [2, 3], [3, 8], [8, 0]]
    rings += [[4, 5], [5, 11], [11, 6], [6, 7], [7, 9], [9, 4]]
    tri = liftmesh.constrained_delaunay(points, [*rings, [8, 12]])
    middle = np.abs(points[tri.simplices].mean(axis=1) - 3).max(axis=1)
    triangles = tri.simplices[middle > 1]
    for line in ([8, 12], [12, 8], [8, 10], [9, 11], [10, 10], [8, 11]):
        constraints = [*rings, [8, 9], [11, 12], line]
        found = liftmesh.verify(points, triangles, constraints=constraints, carved=True)
        assert found.canonical, str(found)
        assert found.n_outside == 1
    crossing = [*rings, [8, 12], [5, 7]]
    found = liftmesh.verify(points, triangles, constraints=crossing, carved=True)
    assert found.canonical, "they cross in a row"
    others = [(94, -278), (1611, 2510), (-2146, 2795), (2699, -2240), (353, 198)]
    rows = np.concatenate([points, others])  # rounding puts the crossing beside the last row
    crossing = [*rings, [8, 12], [13, 14], [15, 16]]
    assert liftmesh.verify(rows, triangles, constraints=crossing, carved=True).n_outside == 6
    found = liftmesh.verify(rows[:-1], triangles, constraints=crossing, carved=True)
    assert kinds(found) == {"missing_constraints": 1}
    found = liftmesh.verify(points[:10], [], constraints=[[4, 6], [5, 7]], carved=True)
    assert kinds(found) == {"no_triangles": 1, "missing_constraints": 1}


def test_a_star_of_constraints_and_overlaps_of_many_take_no_longer() -> None:
    count = 20_000
    line = np.stack([np.arange(count), np.zeros(count)], axis=1)
    points = np.concatenate([line, [[0.0, 9.0], [count, -9.0]]])
    triangles = liftmesh.delaunay(points).simplices
    fan = np.stack([np.arange(count), np.full(count, count)], axis=1)
    nested = np.stack([np.arange(count // 2), count - 1 - np.arange(count // 2)], axis=1)
    staggered = np.stack([np.arange(count // 2), count // 2 + np.arange(count // 2)], axis=1)
    found = liftmesh.verify(points, triangles, constraints=np.concatenate([nested, staggered]))
    assert found.canonical
    assert liftmesh.verify(points, triangles, constraints=fan).canonical
    random = np.random.default_rng(2)
    near = np.unique(random.integers(1, 400, (2000, 2)), axis=0)
    rays = np.concatenate([[[0, 0]], near, 2 * near, 4 * near]).astype(np.float64)
    far = 1 + 2 * len(near) + random.permutation(len(near))
    spokes = np.stack([far, np.zeros(len(near))], axis=1).astype(np.int32)
    made = liftmesh.constrained_delaunay(rays, spokes)
    assert liftmesh.verify(rays, made.simplices, constraints=spokes).canonical
    alone = np.array([[count, 0, count + 1]], dtype=np.int32)
    sides = [[count, 0], [0, count + 1], [count + 1, count]]
    edges = np.concatenate([nested, staggered, sides])
    found = liftmesh.verify(points, alone, constraints=edges, carved=True)
    assert not found


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"constraints": [[0, 4]]}, "constraint 0 refers to row 4; there are 4 rows"),
        ({"constraints": [[0, 2], [-1, 2]]}, "constraint 1 refers to row -1; there are 4 rows"),
        ({"constraints": [[0, 1, 2]]}, "constraints need the shape .k, 2. and 64-bit integers"),
        ({"constraints": [[0, 1], [2]]}, "constraint 1 is .2.: give the two rows"),
        ({"constraints": [[0.5, 1]]}, "not .1, 2. of float64"),
        ({"constraints": [[0, 2]], "weights": np.ones(4)}, "constraints and weights are given"),
        ({"constraints": [[0, 2]], "furthest_site": True}, "constraints and furthest_site are"),
        ({"constraints": [[0, 2]], "metric": [[2, 0], [0, 1]]}, "constraints and metric are"),
        ({"carved": True}, "carved=True is given without constraints"),
        ({"constraints": [[0, 2]], "carved": "yes"}, "carved"),
    ],
)
def test_bad_options_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        liftmesh.verify(KITE, ACROSS, **options)


def test_a_constraint_to_a_skipped_row_is_an_error() -> None:
    points = np.concatenate([KITE, [[np.nan, 1.0]]])
    assert liftmesh.verify(points, ACROSS, constraints=[[0, 2]], nonfinite="skip")
    with pytest.raises(InputError, match=r"constraint 1 ends at row 4 \(nan, 1.0\)"):
        liftmesh.verify(points, ACROSS, constraints=[[0, 2], [0, 4]], nonfinite="skip")


def test_constrained_triangulations_say_their_constraints() -> None:
    tri = liftmesh.constrained_delaunay(KITE, [[0, 2]])
    assert tri.verify().canonical
    assert liftmesh.verify(tri).n_constraints == 1
    points = [*SQUARE, *HOLE, (3, 3)]
    carved = liftmesh.constrained_delaunay(points, polygons=[[SQUARE, HOLE]], carve="holes")
    found = carved.verify()
    assert found.canonical
    assert (found.carved, found.n_outside, found.n_constraints) == (True, 1, 8)
    with pytest.raises(InputError, match="constraints"):
        liftmesh.natural_neighbors(carved, [[1, 1]])


def test_meshes_say_their_constraints() -> None:
    rows, edges = np.c_[KITE, np.zeros(4)], np.array([[0, 2]], np.int32)
    mesh = liftmesh.Cloud(rows, faces=np.array(ACROSS, np.int32), edges=edges)
    assert liftmesh.verify(mesh).n_constraints == 1
    assert not liftmesh.verify(KITE, ACROSS)


def test_surfaces_say_their_constraints() -> None:
    cloud = np.random.default_rng(0).random((200, 3)) * (10, 10, 1)
    border = [[2, 2], [8, 2], [8, 8], [2, 8]]
    hole = [[4, 6], [5, 6], [5, 7], [4, 7]]
    surface = liftmesh.triangulate(cloud, breaklines=[[[3, 3, 0], [7, 7, 0]]], boundary=border)
    assert surface.verify().n_outside == 0
    found = liftmesh.verify(surface)
    assert (found.canonical, found.carved) == (True, True)
    assert found.n_outside == sum((np.abs(cloud[:, :2] - 5) > 3).any(axis=1))
    whole = liftmesh.triangulate(cloud, breaklines=[hole])
    assert liftmesh.verify(whole).canonical
    assert not liftmesh.verify(whole).carved
    assert kinds(liftmesh.verify(whole.trim(max_edge=1.5))).keys() == {"open_boundaries"}


def test_the_json_form_identifies_constraints() -> None:
    said = liftmesh.verify(KITE, ACROSS, constraints=[[0, 2]]).as_dict()
    assert (said["format_version"], said["member"], said["carved"]) == (3, "constrained", False)
    assert said["counts"]["n_constraints"] == 1
    assert said["counts"]["n_outside"] == 0
    other = liftmesh.verify(KITE, ACROSS, constraints=[[2, 0]]).as_dict()
    assert said["constraints_sha256"] != other["constraints_sha256"]
    assert "n_outside" not in liftmesh.verify(KITE, ACROSS).as_dict()["counts"]
