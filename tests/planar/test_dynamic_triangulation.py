"""`DynamicTriangulation` after every change: the triangles are those of a fresh triangulation."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from oracles import planar as oracle
from strategies import clouds

import liftmesh
from liftmesh import DynamicTriangulation, InputError
from liftmesh._typing import Floats
from liftmesh.planar import dynamic_triangulation

Generator = np.random.Generator
Made = Callable[[Generator, int], Floats]


def as_triples(points: Floats, simplices: np.ndarray) -> set[tuple[complex, ...]]:
    """Return triangles as sets of positions; complex numbers sort by x, then y."""
    corners = points[simplices]
    return set(map(tuple, np.sort(corners[..., 0] + 1j * corners[..., 1], axis=1).tolist()))


def fresh(points: Floats) -> set[tuple[complex, ...]]:
    try:
        found = liftmesh.delaunay(points)
    except liftmesh.DegenerateInputError:
        return set()
    return as_triples(found.points, found.simplices)


def check(tri: DynamicTriangulation) -> None:
    present = tri.points[tri.vertices]
    assert len(present) == len(tri)
    assert as_triples(tri.points, tri.simplices) == fresh(present)
    assert (tri.vertices[:, None] == tri.simplices.ravel()).any(axis=1).all() or not len(
        tri.simplices
    )
    check_neighbors(tri)


def check_neighbors(tri: DynamicTriangulation) -> None:
    simplices, neighbors = tri.simplices, tri.neighbors
    for i, k in np.argwhere(neighbors >= 0).tolist():
        back = simplices[neighbors[i, k]]
        m = int(np.flatnonzero(neighbors[neighbors[i, k]] == i)[0])
        assert (back[m - 2], back[m - 1]) == (simplices[i, k - 1], simplices[i, k - 2])
    rim = [
        (simplices[i, k - 2], simplices[i, k - 1]) for i, k in np.argwhere(neighbors < 0).tolist()
    ]
    hull = tri.convex_hull
    assert {*rim} == {*zip(hull.tolist(), np.roll(hull, -1).tolist(), strict=True)}


def lattice(rng: Generator, n: int) -> Floats:
    return rng.integers(0, 6, (n, 2)).astype(float)


def circle(rng: Generator, n: int) -> Floats:
    ends = np.array([[5, 0], [4, 3], [3, 4], [0, 5]])
    turned = np.concatenate([ends * s for s in ((1, 1), (-1, 1), (1, -1), (-1, -1))])
    return np.concatenate([turned[rng.integers(0, 16, n)], [[0, 0]]]).astype(float)


def line_and_few(rng: Generator, n: int) -> Floats:
    found = np.c_[rng.integers(0, 40, n), rng.choice([0, 0, 0, 0, 0, 0, 0, 0, 1, -2], n)]
    return found.astype(float)


def wheel(rng: Generator, n: int) -> Floats:
    """Make a hub with very many neighbours, around it or on one side."""
    angle = rng.uniform(0, rng.choice([3.0, 6.28]), n)
    return np.concatenate([np.c_[np.cos(angle), np.sin(angle)], [[0, 0], [0, -3]]])


def all_scales(rng: Generator, n: int) -> Floats:
    return np.ldexp(rng.uniform(-1, 1, (n, 2)), rng.integers(-1070, 1000, (n, 2)))


def denormal(rng: Generator, n: int) -> Floats:
    return rng.integers(0, 9, (n, 2)) * 5e-324


FAMILIES = (lattice, circle, line_and_few, wheel, all_scales, denormal)


@pytest.mark.parametrize("made", FAMILIES)
def test_every_state_is_that_of_a_fresh_triangulation(made: Made) -> None:
    rng = np.random.default_rng(5)
    tri = DynamicTriangulation()
    for most in (7, 45):
        points = made(rng, most)
        for _ in range(70):
            vertices = tri.vertices
            if len(vertices) > rng.integers(0, most):
                tri.remove(rng.choice(vertices, min(len(vertices), int(rng.integers(1, 3))), False))
            else:
                asked = points[rng.integers(0, len(points), 2)]
                found = tri.insert(asked)
                np.testing.assert_array_equal(tri.points[found], asked)
            check(tri)
    for each in rng.permutation(tri.vertices).tolist():  # down to nothing
        tri.remove(each)
        check(tri)
    assert len(tri) == 0


@settings(max_examples=25, deadline=None)
@given(clouds(), st.randoms(use_true_random=False))
def test_what_was_there_before_does_not_count(points: Floats, random: object) -> None:
    points = np.asarray(points, float).reshape(-1, 2) + 0.0
    tri = DynamicTriangulation(points)
    gone = [v for v in tri.vertices.tolist() if random.random() < 0.5]  # type: ignore[attr-defined]
    for each in gone:
        tri.remove(each)
    rest = tri.points[tri.vertices]
    exact = {tuple(sorted(each)) for each in oracle.delaunay(oracle.exact(rest.tolist()))}
    assert len(exact) == len(tri.simplices)
    check(tri)


def test_batches_are_like_single_points() -> None:
    rng = np.random.default_rng(2)
    points = rng.random((3000, 2))
    tri = DynamicTriangulation(points[:100])
    for part in (points[100:110], points[110:1500], points[1400:1600], points[1600:]):
        found = tri.insert(part)
        np.testing.assert_array_equal(tri.points[found], part)
        check_set(tri)
    numbers = rng.permutation(tri.vertices)
    for gone in (numbers[:300], numbers[300:2500], numbers[2500:2600], numbers[2600:]):
        tri.remove(gone)
        check_set(tri)


def check_set(tri: DynamicTriangulation) -> None:
    present = tri.points[tri.vertices]
    assert as_triples(tri.points, tri.simplices) == fresh(present)


def test_single_points_go_where_others_have_been_and_where_none_was() -> None:
    rng = np.random.default_rng(17)
    crowd = rng.uniform(0, 1e-6, (1500, 2))
    tri = DynamicTriangulation(np.concatenate([rng.uniform(0, 1, (1500, 2)), crowd]))
    for places in (
        rng.uniform(0, 1, (60, 2)),
        rng.uniform(0, 1e-6, (60, 2)),
        [[9, -7], [1e300, 3]],
    ):
        numbers = np.concatenate([tri.insert([each]) for each in places])
        assert tri.find(places).tolist() == numbers.tolist()
        tri.remove(np.union1d(numbers[::2], tri.vertices[:100]))
    tri.insert(crowd[:50] + 0.5)
    check(tri)


def test_numbers_of_removed_points_are_given_again() -> None:
    tri = DynamicTriangulation([[0, 0], [1, 0], [0, 1], [-0.0, 0.0]])
    assert tri.vertices.tolist() == [0, 1, 2]
    tri.remove(1)
    assert tri.insert([[5, 5], [6, 9]]).tolist() == [1, 3]
    assert tri.find([[5, 5], [1, 0], [np.nan, 0]]).tolist() == [1, -1, -1]
    assert (tri.points[1] == 5).all()


def test_more_points_than_there_are_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dynamic_triangulation, "MOST_ROWS", 4)
    changing = DynamicTriangulation([[0, 0], [1, 0], [0, 1]])
    for more in ([[1, 1], [2, 2]], [[1, 1], [2, 2], [3, 4]]):
        with pytest.raises(InputError, match=f"{len(more)} more rows are too many: 4 is the limit"):
            changing.insert(more)
    assert changing.insert([[1, 1]]).tolist() == [3]


@pytest.mark.parametrize("number", [7, -1, 2**40, 1.5, "a"])
def test_numbers_that_are_not_there(number: object) -> None:
    tri = DynamicTriangulation([[0, 0], [1, 0], [0, 1]])
    with pytest.raises(liftmesh.InputError, match=r"number|vertices are"):
        tri.remove(number)  # type: ignore[arg-type]
    with pytest.raises(liftmesh.InputError, match="twice"):
        tri.remove([1, 1])
    with pytest.raises(liftmesh.NonFiniteError):
        tri.insert([[3, 3], [np.inf, 0]])
    assert len(tri) == 3


def test_copies_stand_alone() -> None:
    tri = DynamicTriangulation([[0, 0], [1, 0], [0, 1], [4, 4]])
    tri.remove(1)
    for twin in (copy.deepcopy(tri), pickle.loads(pickle.dumps(tri))):
        assert (len(twin), twin.vertices.tolist()) == (3, [0, 1, 2])
        twin.remove(0)
    assert len(tri.simplices) == 1
    assert repr(tri) == "<DynamicTriangulation of 3 points>"
    assert tri.to_triangulation().nsimplex == 1


def test_vertices_are_found_whichever_are_gone() -> None:
    rng = np.random.default_rng(5)
    points = rng.random((2000, 2))
    tri = DynamicTriangulation(points)
    for gone in (np.arange(1000), np.arange(1990, 2000), np.arange(1000, 1960)):
        tri.remove(gone)
        present = tri.vertices
        for each in present:  # one by one, without a hint
            assert tri.find(points[each][None]) == each
        assert (tri.find(points[gone]) < 0).all()
    assert tri.insert(points[:30]).tolist() == tri.find(points[:30]).tolist()
    check(tri)
