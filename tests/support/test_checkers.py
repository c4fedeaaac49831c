"""The checkers find what is wrong: the oracles, and the second opinion of tests and benchmark."""

from __future__ import annotations

import numpy as np
import pytest
from clouds import FAMILIES
from damage import POINTS, flipped, without_a_point
from meshes import assert_delaunay, assert_oracle_agrees, assert_same_triangles, triangle_rows
from oracles.second_opinion import find_neighbors, flaw

import liftmesh

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


DAMAGE = {
    "flipped edge": flipped,
    "reversed row": lambda rows: np.vstack((rows[:-1], rows[-1:, ::-1])),
    "dropped row": lambda rows: rows[1:],
    "doubled row": lambda rows: np.vstack((rows, rows[:1])),
    "wrong vertex": lambda rows: np.vstack((rows[1:], np.roll(rows[:1], 1) * [1, 1, 0])),
    "point left out": lambda rows: without_a_point(),
}


def test_a_right_result_passes_every_check() -> None:
    triangulation = liftmesh.delaunay(POINTS)
    simplices = triangulation.simplices
    assert_delaunay(POINTS, simplices)
    assert_oracle_agrees(POINTS, simplices)
    assert flaw(POINTS, simplices) == ""
    assert flaw(POINTS, simplices, triangulation.neighbors) == ""


@pytest.mark.parametrize("check", [assert_delaunay, assert_oracle_agrees])
@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_fails_the_check(damage: str, check) -> None:
    with pytest.raises(AssertionError):
        check(POINTS, DAMAGE[damage](liftmesh.delaunay(POINTS).simplices))


@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_named_by_the_second_opinion(damage: str) -> None:
    assert flaw(POINTS, DAMAGE[damage](liftmesh.delaunay(POINTS).simplices)) != ""


def test_the_second_opinion_finds_the_neighbors() -> None:
    triangulation = liftmesh.delaunay(POINTS)
    assert (find_neighbors(triangulation.simplices) == triangulation.neighbors).all()


@pytest.mark.parametrize("wrong", ["swapped", "missing", "out of range", "other shape"])
def test_wrong_neighbors_are_named_by_the_second_opinion(wrong: str) -> None:
    triangulation = liftmesh.delaunay(POINTS)
    neighbors = triangulation.neighbors.copy()
    inner = np.flatnonzero((neighbors >= 0).all(axis=1))[0]
    if wrong == "swapped":
        neighbors[inner] = np.roll(neighbors[inner], 1)
    elif wrong == "missing":
        neighbors[inner, 0] = -1
    elif wrong == "out of range":
        neighbors[inner, 0] = len(neighbors)
    else:
        neighbors = neighbors[1:]
    said = flaw(POINTS, triangulation.simplices, neighbors)
    assert "fit together" in said or "neighbours" in said


@pytest.mark.parametrize("rows", [[], [[0, 1, 40]], [[0, 1, -1]]])
def test_indices_out_of_range_are_named_by_the_second_opinion(rows: list[list[int]]) -> None:
    assert "no" in flaw(POINTS, np.array(rows, dtype=np.int32).reshape(-1, 3))


def test_damage_changes_the_set_of_triangles() -> None:
    simplices = liftmesh.delaunay(POINTS).simplices
    with pytest.raises(AssertionError, match="1 are missing"):
        assert_same_triangles(
            triangle_rows(POINTS, simplices[1:]), triangle_rows(POINTS, simplices)
        )


def test_the_other_diagonal_is_delaunay_but_not_canonical() -> None:
    other = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    assert flaw(SQUARE, other) == ""
    with pytest.raises(AssertionError, match="not Delaunay"):
        assert_delaunay(SQUARE, other)
    with pytest.raises(AssertionError, match="extra"):
        assert_oracle_agrees(SQUARE, other)


def test_a_boundary_that_turns_inward_is_named() -> None:
    rows = liftmesh.delaunay(POINTS)
    at_boundary = np.flatnonzero((rows.neighbors == -1).any(axis=1))
    names = {flaw(POINTS, np.delete(rows.simplices, row, axis=0)) for row in at_boundary}
    assert any("inward" in name for name in names), names


@pytest.mark.parametrize("family", ["lattice", "circle", "denormal", "huge-lattice"])
def test_the_second_opinion_accepts_hard_points(family: str) -> None:
    points = FAMILIES[family](2000, np.random.default_rng(1))
    assert flaw(points, liftmesh.delaunay(points).simplices) == ""
