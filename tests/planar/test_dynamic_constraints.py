"""Constraints of `DynamicTriangulation`: after every change all is as in a fresh triangulation."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import DynamicTriangulation, _kernel
from liftmesh._typing import Floats, Rows

Step = tuple[str, int, int]
Pieces = dict[tuple[int, int], list[int]]


def fresh(points: Floats, edges: Rows) -> tuple[str, Rows, Pieces, Rows]:
    """Return status, triangles, the edges that each piece belongs to, and crossings."""
    outcome, _, *pieces, _, _, crossings = _kernel.constrained(
        np.ascontiguousarray(points), edges.reshape(-1, 2), False, 1, False, None
    )
    return outcome[0], outcome[3], as_pieces(*pieces), crossings


def as_pieces(pieces: Rows, indptr: Rows, members: Rows) -> Pieces:
    parts = np.split(members, indptr[1:-1]) if len(pieces) else []
    return {tuple(p): m.tolist() for p, m in zip(pieces.tolist(), parts, strict=True)}


def as_rows(tri: DynamicTriangulation, numbers: Rows) -> Rows:
    return np.searchsorted(tri.vertices, numbers).astype(np.int32)


def as_sets(triangles: Rows) -> set[tuple[int, ...]]:
    return {tuple(each) for each in np.sort(triangles, axis=1).tolist()}


def check(tri: DynamicTriangulation) -> None:
    edges = as_rows(tri, tri.input_edges)
    status, triangles, pieces, crossings = fresh(tri.points[tri.vertices], edges)
    assert len(crossings) == 0
    if status != "ok":
        assert len(tri.simplices) == 0
        return
    assert as_sets(as_rows(tri, tri.simplices)) == as_sets(triangles)
    assert as_pieces(as_rows(tri, tri.constraints), *tri.constraint_inputs) == pieces
    sides = np.stack([np.roll(tri.simplices, -k, axis=1) for k in (1, 2)], axis=2)
    marked = {tuple(each) for each in np.sort(sides[tri.is_constrained], axis=1).tolist()}
    assert marked == {tuple(each) for each in tri.constraints.tolist()}
    i, k = np.nonzero(tri.neighbors >= 0)
    beyond = tri.neighbors[i, k]
    m = (tri.neighbors[beyond] == i[:, None]).argmax(axis=1)
    assert (tri.is_constrained[i, k] == tri.is_constrained[beyond, m]).all()


def crossed(tri: DynamicTriangulation, a: int, b: int) -> list[list[int]]:
    """Return the constraints that an edge crosses, as a fresh triangulation finds them."""
    edges = np.concatenate([tri.input_edges, np.array([[a, b]], np.int32)])
    *_, crossings = fresh(tri.points[tri.vertices], as_rows(tri, edges))
    return tri.input_edges[crossings[:, 0]].tolist()


def named(edges: list[list[int]]) -> str:
    return ", ".join(f"from {a} to {b}" for a, b in edges[:20])


def insert_constraint(tri: DynamicTriangulation, a: int, b: int) -> None:
    others = crossed(tri, a, b)
    if not others:
        return tri.insert_constraint(a, b)
    before = tri.simplices.tolist(), tri.constraints.tolist()
    with pytest.raises(liftmesh.CrossingError, match="or remove those") as caught:
        tri.insert_constraint(a, b)
    assert sorted(map(sorted, caught.value.rows.reshape(-1, 2, 2).tolist())) == sorted(
        sorted([[min(a, b), max(a, b)], each]) for each in others
    )
    assert set(caught.value.crossings.max(axis=1).tolist()) == {len(tri.input_edges)}
    assert (tri.simplices.tolist(), tri.constraints.tolist()) == before
    return None


def remove(tri: DynamicTriangulation, vertex: int) -> None:
    """Remove a point, unless constraints end there or would cross."""
    ends = [each for each in tri.input_edges.tolist() if vertex in each]
    rest = tri.vertices[tri.vertices != vertex]
    edges = np.searchsorted(rest, tri.input_edges).astype(np.int32)
    if ends:
        with pytest.raises(liftmesh.InputError) as caught:
            tri.remove(vertex)
        assert f" {len(ends)} constraint" in str(caught.value)
        assert f"({named(ends)}" in str(caught.value)
    elif len(fresh(tri.points[rest], edges)[3]):
        with pytest.raises(liftmesh.InputError, match="would cross"):
            tri.remove(vertex)
    else:
        tri.remove(vertex)


def take(tri: DynamicTriangulation, step: Step, points: Floats) -> None:
    """Take one step of a script."""
    what, i, j = step
    vertices = tri.vertices
    if what == "point" or len(vertices) < 3:
        tri.insert(points[[(7 * i + j) % len(points)]])
    elif what == "remove":
        remove(tri, int(vertices[i % len(vertices)]))
    elif what == "release" and len(tri.input_edges):
        a, b = tri.input_edges[i % len(tri.input_edges)].tolist()
        tri.remove_constraint(*((a, b) if j % 2 else (b, a)))
    else:
        a, b = vertices[i % len(vertices)], vertices[j % len(vertices)]
        if a != b:
            insert_constraint(tri, int(a), int(b))


WORDS = ("point", "point", "edge", "edge", "remove", "release")
steps = st.tuples(st.sampled_from(WORDS), st.integers(0, 60), st.integers(0, 60))


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.integers(2, 6), st.integers(2, 6), st.lists(steps, min_size=5, max_size=50))
def test_every_step_on_a_lattice(width: int, height: int, script: list[Step]) -> None:
    points = np.argwhere(np.ones((width, height))).astype(float)
    tri = DynamicTriangulation(points[:: height + 1])
    for step in script:
        take(tri, step, points)
        check(tri)


def circle(rng: np.random.Generator) -> Floats:
    ends = np.array([[5, 0], [4, 3], [3, 4], [0, 5]])
    turned = np.concatenate([ends * s for s in ((1, 1), (-1, 1), (1, -1), (-1, -1))])
    return np.concatenate([turned, [[0, 0]], rng.integers(-5, 6, (8, 2))]).astype(float)


def line_and_few(rng: np.random.Generator) -> Floats:
    return np.c_[rng.integers(0, 30, 40), rng.choice([0] * 8 + [1, -2], 40)].astype(float)


def wheel(rng: np.random.Generator) -> Floats:
    angle = rng.uniform(0, 6.28, 60)
    along = np.c_[np.linspace(-2, 2, 9), np.zeros(9)]
    return np.concatenate([np.c_[np.cos(angle), np.sin(angle)], along])


def all_scales(rng: np.random.Generator) -> Floats:
    found: Floats = np.ldexp(rng.uniform(-1, 1, (40, 2)), rng.integers(-1070, 1000, (40, 2)))
    return found


def denormal(rng: np.random.Generator) -> Floats:
    return rng.integers(0, 7, (40, 2)) * 5e-324


@pytest.mark.slow
@pytest.mark.parametrize("made", [circle, line_and_few, wheel, all_scales, denormal])
def test_every_step(made: Callable[[np.random.Generator], Floats]) -> None:
    rng = np.random.default_rng(3)
    points = made(rng)
    tri = DynamicTriangulation(points[::2])
    for _ in range(100):
        i, j = rng.integers(0, 1000, 2).tolist()
        take(tri, (str(rng.choice(WORDS)), i, j), points)
        check(tri)
    for each in tri.input_edges.tolist():
        tri.remove_constraint(*each)
        check(tri)
    tri.remove(tri.vertices)
    assert len(tri) == len(tri.constraints) == 0


def test_batches_keep_constraints() -> None:
    rng = np.random.default_rng(2)
    points = np.unique(rng.integers(0, 60, (1500, 2)), axis=0).astype(float)
    tri = DynamicTriangulation(points[::10])
    for a, b in rng.permutation(tri.vertices)[:100].reshape(-1, 2).tolist():
        insert_constraint(tri, a, b)
    assert len(tri.input_edges) > 10
    ends = tri.input_edges.copy()
    for part in (points[:20], points[20:1000], points[1000:1060]):  # some are made anew
        tri.insert(part)
        check(tri)
    on = np.unique(tri.constraints)
    free = np.setdiff1d(tri.vertices, on)
    for gone in (free[:20], free[20:-30], free[-30:]):
        tri.remove(gone)
        check(tri)
    np.testing.assert_array_equal(tri.input_edges, ends)


def test_batches_on_a_line_keep_constraints() -> None:
    line = np.c_[np.arange(200.0), np.zeros(200)]
    tri = DynamicTriangulation(line[[0, 199]])
    tri.insert_constraint(1, 0)
    tri.insert(line[::2])
    assert len(tri.constraints) == 100
    tri.insert([[7.0, 3.0]])
    check(tri)
    assert len(tri.constraints) == 100
    tri.insert(line)
    check(tri)
    tri.remove(tri.find([[7.0, 3.0]]))
    tri.remove(tri.find(line[1:-1]))
    assert tri.constraints.tolist() == [[0, 1]]


@pytest.mark.parametrize("bulge", [1.0, 0.01, -1.0])
def test_a_constraint_with_many_points_beside_it(bulge: float) -> None:
    rng = np.random.default_rng(4)
    t = np.sort(rng.uniform(0.001, 0.999, 400))
    height = bulge * t * (1 - t) + (0.3 if bulge < 0 else 0.0)
    points = np.c_[t, np.where(rng.random(400) < 0.5, 1, -1) * height]
    tri = DynamicTriangulation(np.concatenate([[[0, 0], [1, 0]], points]))
    before = as_sets(tri.simplices)
    tri.insert_constraint(0, 1)
    check(tri)
    assert len(as_sets(tri.simplices) - before) > 100
    tri.remove_constraint(0, 1)
    assert as_sets(tri.simplices) == before


def test_a_hub_on_a_constraint() -> None:
    angle = np.linspace(0.05, 2 * np.pi - 0.05, 90)
    ring = np.c_[np.cos(angle), np.sin(angle)]
    tri = DynamicTriangulation(np.concatenate([[[-3, 0], [3, 0], [0, 0]], ring]))
    tri.insert_constraint(0, 1)
    assert len(tri.constraints) == 2
    tri.remove(2)
    check(tri)
    assert tri.constraints.tolist() == [[0, 1]]


def test_errors_name_constraints() -> None:
    tri = DynamicTriangulation([[0, 0], [2, -1], [4, 0], [2, 1], [2, 0], [1, 0]])
    tri.insert_constraint(2, 0)
    tri.insert_constraint(3, 1)
    assert tri.constraints.tolist() == [[0, 5], [1, 4], [2, 4], [3, 4], [4, 5]]
    with pytest.raises(liftmesh.InputError, match=r"point 3 .* 1 constraint \(from 1 to 3\)"):
        tri.remove([5, 3])
    with pytest.raises(liftmesh.InputError, match=r"point 4, .*\(from 0 to 2, from 1 to 3\)"):
        tri.remove(4)
    with pytest.raises(liftmesh.InputError, match="no constraint goes from 0 to 5"):
        tri.remove_constraint(0, 5)
    with pytest.raises(liftmesh.InputError, match="both ends of a constraint are point 2"):
        tri.insert_constraint(2, 2)
    with pytest.raises(liftmesh.InputError, match="no point has the number 9"):
        tri.insert_constraint(2, 9)
    with pytest.raises(liftmesh.InputError, match="b is -1: give a whole number from 0"):
        tri.insert_constraint(2, -1)
    with pytest.raises(liftmesh.InputError, match=r"a is 2\.0"):
        tri.remove_constraint(2.0, 0)  # type: ignore[arg-type]
    assert len(tri) == 6
    tri.remove_constraint(1, 3)
    tri.remove([4, 5])
    assert tri.constraints.tolist() == [[0, 2]]


def test_all_edges_that_cross_are_named_to_begin_with() -> None:
    points = [[0, 0, 7], [3, 3, 7], [0, 3, 7], [3, 0, 7], [1, 3, 7], [2, 0, 7]]
    with pytest.raises(liftmesh.CrossingError, match=r"^3 pairs .* or leave out some") as caught:
        DynamicTriangulation(points, [[0, 1], [2, 3], [2, 2], [5, 4]])
    with pytest.raises(liftmesh.CrossingError) as other:
        liftmesh.constrained_delaunay(points, [[0, 1], [2, 3], [2, 2], [5, 4]])
    assert caught.value.crossings.tolist() == other.value.crossings.tolist()


def test_copies_have_the_same_constraints() -> None:
    tri = DynamicTriangulation([[9, 9], [0, 0], [2, -1], [4, 0], [2, 1]])
    tri.remove(0)
    tri.insert_constraint(1, 3)
    twin = copy.copy(tri)
    assert twin.input_edges.tolist() == [[0, 2]]
    check(twin)
    twin.remove_constraint(0, 2)
    assert tri.input_edges.tolist() == [[1, 3]]
