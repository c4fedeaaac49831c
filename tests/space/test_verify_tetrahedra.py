"""Certificates of tetrahedra: every kind of flaw, and no other where nothing is wrong."""

from __future__ import annotations

import json

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import Delaunay

import liftmesh

Points = NDArray[np.float64]

CUBE = np.indices((2, 2, 2)).reshape(3, -1).T.astype(np.float64)
GRID = np.indices((4, 4, 4)).reshape(3, -1).T.astype(np.float64)
CELLS = liftmesh.tetrahedralize(GRID).simplices
CLOUD = np.random.default_rng(0).random((200, 3))
OF_CLOUD = liftmesh.tetrahedralize(CLOUD)


def kinds(points: Points, simplices: NDArray[np.int32], **options: str) -> set[str]:
    certificate = liftmesh.verify(points, simplices, **options)
    assert certificate.valid == ({flaw.kind for flaw in certificate.flaws} <= {"not_canonical"})
    for flaw in certificate.flaws:
        assert flaw.text
        assert len(flaw.first) == min(flaw.count, 16) or flaw.kind == "no_tetrahedra"
    json.loads(certificate.to_json())
    return {flaw.kind for flaw in certificate.flaws}


def turned(points: Points, simplices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Make all tetrahedra positive."""
    is_negative = liftmesh.orient3d(*np.moveaxis(points[simplices], 1, 0)) < 0
    simplices = simplices.copy()
    simplices[is_negative] = simplices[is_negative][:, [1, 0, 2, 3]]
    return simplices


def test_those_of_scipy_in_general_position() -> None:
    found = turned(CLOUD, Delaunay(CLOUD).simplices)
    certificate = liftmesh.verify(CLOUD, np.random.default_rng(1).permutation(found))
    assert certificate.canonical
    assert certificate.dimension == 3
    assert certificate.n_triangles == len(OF_CLOUD.simplices)
    assert certificate.n_edges == (4 * len(found) + certificate.n_hull_edges) // 2
    assert certificate.euler_characteristic is None
    assert "valid: these" in str(certificate)
    stated = certificate.as_dict()
    assert stated["format_version"] == 4
    assert stated["counts"]["n_tetrahedra"] == len(found)


def test_objects_with_simplices() -> None:
    assert liftmesh.verify(OF_CLOUD).canonical
    assert OF_CLOUD.verify() == liftmesh.verify(CLOUD, OF_CLOUD.simplices)
    assert not liftmesh.verify(Delaunay(CLOUD))  # half of them are negative


def test_rows_at_one_position_may_be_several_vertices() -> None:
    soup = CUBE[liftmesh.tetrahedralize(CUBE).simplices].reshape(-1, 3)
    certificate = liftmesh.verify(soup, np.arange(len(soup)).reshape(-1, 4))
    assert certificate.canonical
    assert (certificate.n_vertices, certificate.n_merged) == (8, len(soup) - 8)


def test_the_rule_for_ties() -> None:
    """A cube about its middle: five tetrahedra are valid too, and not canonical."""
    five = [[0, 3, 5, 6], [0, 1, 3, 5], [0, 2, 3, 6], [0, 4, 5, 6], [7, 3, 5, 6]]
    certificate = liftmesh.verify(CUBE, turned(CUBE, np.array(five, dtype=np.int32)))
    assert certificate.valid
    assert [flaw.kind for flaw in certificate.flaws] == ["not_canonical"]
    assert "not canonical" in str(certificate)
    assert certificate.flaws[0].first[0].sign == 0


class TestFlaws:
    def test_corners(self) -> None:
        for wrong in (-1, 64, 2**40):
            bad = CELLS.astype(np.int64)
            bad[3, 1] = wrong
            assert kinds(GRID, bad) == {"invalid_index"}
        points = np.vstack((GRID, [[np.nan, 0, 0]]))
        bad = CELLS.copy()
        bad[0, 0] = 64
        assert kinds(points, bad, nonfinite="skip") == {"non_finite"}
        with pytest.raises(liftmesh.NonFiniteError):
            liftmesh.verify(points, bad)

    def test_orientation(self) -> None:
        bad = CELLS.copy()
        bad[5] = bad[5, [1, 0, 2, 3]]
        assert "negative" in kinds(GRID, bad)
        bad[5] = [0, 1, 2, 3]
        assert "degenerate" in kinds(GRID, bad)
        bad[5] = bad[5, 0]
        assert "degenerate" in kinds(GRID, bad)

    def test_facets(self) -> None:
        assert "non_manifold_facets" in kinds(GRID, np.vstack((CELLS, CELLS[7:8])))

    def test_a_boundary_that_is_not_convex(self) -> None:
        at_hull = np.flatnonzero((OF_CLOUD.neighbors < 0).sum(axis=1) == 1)[0]
        bad = np.delete(OF_CLOUD.simplices, at_hull, axis=0)
        assert kinds(CLOUD, bad) == {"not_convex"}

    def test_a_hole_inside(self) -> None:
        inside = np.flatnonzero((OF_CLOUD.neighbors >= 0).all(axis=1))[0]
        assert "not_convex" in kinds(CLOUD, np.delete(OF_CLOUD.simplices, inside, axis=0))

    def test_an_open_boundary(self) -> None:
        two = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1.0]])
        pair = turned(two, np.array([[0, 1, 2, 3], [0, 1, 4, 5]], dtype=np.int32))
        assert "non_manifold_edges" in kinds(two, pair)

    def test_a_boundary_that_turns_twice(self) -> None:
        """Tetrahedra around an axis, along a pentagram."""
        turn = np.arange(5) * 4 * np.pi / 5
        ring = np.column_stack((np.zeros(5), np.cos(turn), np.sin(turn)))
        points = np.vstack(([[-1.0, 0, 0], [1.0, 0, 0]], ring))
        around = np.array([[0, 1, 2 + i, 2 + (i + 1) % 5] for i in range(5)], dtype=np.int32)
        assert "boundary_winding" in kinds(points, turned(points, around))

    def test_a_double_cover_that_turns_once_at_its_largest_vertex(self) -> None:
        """Two rings around an axis, which close after two turns; no sphere has a neighbour."""
        turn = np.arange(21) * 4 * np.pi / 21
        ring = np.column_stack((np.cos(turn), np.sin(turn), 0 * turn)) * 2.0**20
        points = np.vstack(([[0, 0, -(2**20)], [0, 0, 2**20], [0, 0, 0]], ring // 2, ring // 1))
        flat = []
        for a, d in zip(np.arange(3, 24), (np.arange(21) + 1) % 21 + 3, strict=True):
            b, c = a + 21, d + 21
            is_inside = liftmesh.incircle(*points[[a, b, c, d], :2]) > 0
            flat += [(2, a, d)] + ([(a, b, d), (b, c, d)] if is_inside else [(a, b, c), (a, c, d)])
        around = [(apex, *three) for three in flat for apex in (0, 1)]
        around = turned(points, np.array(around, dtype=np.int32))
        assert kinds(points, around) - {"not_canonical"} == {"not_convex"}

    def test_rows_without_a_vertex(self) -> None:
        assert kinds(np.vstack((CLOUD, CLOUD.mean(axis=0))), OF_CLOUD.simplices) == {
            "missing_vertices"
        }
        assert kinds(CUBE, np.empty((0, 4), dtype=np.int32)) == {
            "no_tetrahedra",
            "missing_vertices",
        }

    def test_a_sphere_with_a_neighbour_inside(self) -> None:
        """Of five points, three tetrahedra around an edge where two should be."""
        points = np.array([[0, 0, -1], [0, 0, 1], [3, 0, 0], [-2, 2.5, 0], [-2, -2.5, 0.0]])
        right = liftmesh.tetrahedralize(points).simplices
        around = [[0, 1, 2, 3], [0, 1, 3, 4], [0, 1, 4, 2]]
        across = [[0, 2, 3, 4], [1, 2, 3, 4]]
        other = across if len(right) == 3 else around
        found = liftmesh.verify(points, turned(points, np.array(other, dtype=np.int32)))
        assert [flaw.kind for flaw in found.flaws] == ["not_delaunay"]
        assert found.flaws[0].first[0].sign == 1
        assert "contains row" in str(found)

    def test_places_are_rows_of_the_caller(self) -> None:
        order = np.random.default_rng(3).permutation(len(CLOUD))
        points = np.vstack((CLOUD[order], [[2.0, 2, 2]]))
        simplices = np.argsort(order)[OF_CLOUD.simplices].astype(np.int32)
        (flaw,) = liftmesh.verify(points, simplices).flaws
        assert flaw.first[0].rows == (len(CLOUD),)
        assert flaw.first[0].points == ((2.0, 2.0, 2.0),)


class TestRefusals:
    @pytest.mark.parametrize(
        "options",
        [
            {"weights": np.ones(64)},
            {"metric": np.eye(2)},
            {"furthest_site": True},
            {"constraints": [[0, 1]]},
        ],
    )
    def test_members_of_the_plane(self, options) -> None:
        with pytest.raises(liftmesh.InputError, match="tetrahedra are verified"):
            liftmesh.verify(GRID, CELLS, **options)

    def test_shapes(self) -> None:
        with pytest.raises(liftmesh.InputError, match="points of two columns"):
            liftmesh.verify(GRID[:, :2], CELLS)
        with pytest.raises(liftmesh.InputError, match="need the shape"):
            liftmesh.verify(GRID, CELLS.astype(float))
