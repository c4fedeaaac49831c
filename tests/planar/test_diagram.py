"""What is dual to a triangulation, as arrays."""

from __future__ import annotations

import numpy as np

import liftmesh
from liftmesh.planar.diagram import (
    LiftedTriangles,
    diagram_of,
    regions_of,
    ridges_by_rows,
    rows_without_area,
)
from liftmesh.planar.kinds import TriangulationKind

SQUARE = [[0, 0], [2, 0], [2, 2], [0, 2]]


def test_triangles_on_one_circle_share_a_vertex() -> None:
    tri = liftmesh.delaunay(SQUARE)
    diagram = diagram_of(tri.points, tri.simplices, tri.neighbors)
    assert diagram.vertices.tolist() == [[1, 1]]
    assert diagram.simplex_to_vertex.tolist() == [0, 0]
    regions = regions_of(4, tri.simplices, tri.neighbors, diagram.simplex_to_vertex)
    assert regions.ridge_ends.tolist() == [[-1, 0]] * 4
    assert np.diff(regions.starts).tolist() == [2] * 4


def test_ridges_have_the_keys_of_scipy() -> None:
    assert ridges_by_rows(np.array([[0, 2]]), [[-1, 5]]) == {(0, 2): [-1, 5]}


def test_a_row_on_a_facet_has_a_cell_without_area() -> None:
    points = [[0, 0], [4, 0], [0, 4], [4, 4], [2, 2]]
    tri = liftmesh.regular(points, weights=[0, 0, 0, 0, -8])
    assert tri.weights is not None
    triangles = tri.points, tri.simplices, tri.neighbors, tri.convex_hull
    lifted = LiftedTriangles(*triangles, TriangulationKind("weights", tri.weights))
    assert rows_without_area(lifted).tolist() == [4]
    as_heavy = lifted._replace(kind=TriangulationKind("weights", np.zeros(5)))
    assert rows_without_area(as_heavy).tolist() == []
