"""Voronoi diagrams in space: exact topology, vertices rounded once, SciPy's form."""

from __future__ import annotations

import copy
import pickle
from fractions import Fraction

import numpy as np
import pytest
from scipy import spatial

import liftmesh

RNG = np.random.default_rng(41)
CLOUD = RNG.random((60, 3))
GRID = np.indices((4, 4, 4)).reshape(3, -1).T * 0.1


def exact_center(corners: np.ndarray) -> list[Fraction]:
    """Solve for the point at equal distance of four, by Cramer's rule in fractions."""
    a, *others = [[Fraction(x) for x in corner] for corner in corners.tolist()]
    rows = [[2 * (x - y) for x, y in zip(p, a, strict=True)] for p in others]
    right = [sum(x * x for x in p) - sum(x * x for x in a) for p in others]

    def det(m):
        (a, b, c), (d, e, f), (g, h, i) = m
        return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)

    whole = det(rows)
    replaced = [
        [[right[i] if j == k else rows[i][j] for j in range(3)] for i in range(3)] for k in range(3)
    ]
    return [det(m) / whole for m in replaced]


def test_it_is_scipys_in_general_position() -> None:
    ours, theirs = liftmesh.scipy.Voronoi(CLOUD), spatial.Voronoi(CLOUD)
    for kind in (liftmesh.scipy.Voronoi, liftmesh.scipy.SpaceVoronoi, spatial.Voronoi):
        assert isinstance(ours, kind)
    assert len(ours.vertices) == len(theirs.vertices)
    distance, place = spatial.KDTree(theirs.vertices).query(ours.vertices)
    assert distance.max() < 1e-9
    name = {-1: -1, **dict(enumerate(place.tolist()))}
    for row in range(60):
        found = {name[v] for v in ours.regions[ours.point_region[row]]}
        assert found == {*theirs.regions[theirs.point_region[row]]}
    expected = {tuple(sorted(rows)): {*corners} for rows, corners in theirs.ridge_dict.items()}
    found = {rows: {name[v] for v in corners} for rows, corners in ours.ridge_dict.items()}
    assert {rows: found[rows] for rows in expected} == expected
    # SciPy leaves out wedges between two rays from one vertex.
    assert all(len(found[rows]) == 2 and -1 in found[rows] for rows in {*found} - {*expected})
    assert {*found} == {tuple(edge) for edge in edges_of(ours.simplices)}


def edges_of(simplices: np.ndarray) -> list[list[int]]:
    pairs = [(i, j) for j in range(4) for i in range(j)]
    ends = np.concatenate([np.sort(simplices[:, pair], axis=1) for pair in pairs])
    return np.unique(ends, axis=0).tolist()


def test_corners_are_in_order_around_ridges() -> None:
    diagram = liftmesh.scipy.Voronoi(CLOUD)
    for (one, other), corners in diagram.ridge_dict.items():
        assert (corners[0] == -1) == (-1 in corners)
        if -1 in corners:
            continue
        places = diagram.vertices[corners] - diagram.vertices[corners].mean(axis=0)
        turns = np.cross(places, np.roll(places, -1, axis=0)) @ (CLOUD[other] - CLOUD[one])
        assert (turns > 0).all()


@pytest.mark.parametrize("scale", [1.0, 2.0**-900, 1e290])
def test_vertices_are_rounded_once(scale: float) -> None:
    points = CLOUD[:12] * scale
    diagram = liftmesh.scipy.Voronoi(points)
    for cell, vertex in zip(diagram.simplices, diagram.simplex_to_vertex, strict=True):
        expected = [float(x) for x in exact_center(points[cell])]
        assert diagram.vertices[vertex].tolist() == expected


def test_every_region_of_a_lattice_is_a_cube() -> None:
    diagram = liftmesh.scipy.Voronoi(np.vstack([GRID, GRID[:2]]))
    assert len(diagram.vertices) == 27
    assert len(diagram.ridge_points) == 3 * 4 * 4 * 3  # none between sites that touch at an edge
    inner = ((GRID > 0.05) & (GRID < 0.25)).all(axis=1)
    counts = [len(diagram.regions[region]) for region in diagram.point_region[:64][inner]]
    assert counts == [8] * 8
    assert diagram.point_region[64:].tolist() == diagram.point_region[:2].tolist()
    assert diagram.regions[0] == []  # of Qz
    assert [] not in liftmesh.scipy.Voronoi(GRID, qhull_options="Qbb").regions


def test_beyond_the_greatest_double() -> None:
    points = np.array([[0, 0, 0], [1e300, 0, 0], [0, 1e300, 0], [1e299, 1e299, 1e-300]])
    diagram = liftmesh.scipy.Voronoi(points)
    assert diagram.overflowed == 1
    assert diagram.vertices[0].tolist() == [5e299, 5e299, -np.inf]


def test_writes_copies_and_growth() -> None:
    whole = liftmesh.scipy.Voronoi(CLOUD, qhull_options="Qc")
    diagram = liftmesh.scipy.Voronoi(CLOUD[:30], incremental=True)
    first = diagram.regions
    diagram.add_points(CLOUD[30:])
    assert diagram.regions == whole.regions != first
    assert diagram.ridge_dict == whole.ridge_dict
    diagram.vertices += 1
    for clone in (copy.copy(diagram), pickle.loads(pickle.dumps(diagram))):
        assert clone.regions == whole.regions
        assert clone.ridge_vertices == whole.ridge_vertices


def test_refusals() -> None:
    with pytest.raises(spatial.QhullError, match="lie on one plane"):
        liftmesh.scipy.Voronoi(GRID * (1, 1, 0))
    with pytest.raises(liftmesh.InputError, match="furthest_site=True is for planar points"):
        liftmesh.scipy.Voronoi(CLOUD, furthest_site=True)
    with pytest.raises(liftmesh.InputError, match=r"4 columns .* which nothing proves"):
        liftmesh.scipy.Voronoi(np.zeros((9, 4)))
    with pytest.raises(liftmesh.NonFiniteError, match="row 3"):
        liftmesh.scipy.Voronoi(np.where(np.arange(30).reshape(10, 3) == 9, np.inf, GRID[:10]))
