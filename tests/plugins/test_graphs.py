"""Graphs of near points in networkx and libpysal, beside libpysal's own."""

from __future__ import annotations

import warnings
from typing import Any

import geopandas
import networkx as nx
import numpy as np
import pandas as pd
import pytest
from libpysal.graph import Graph

import liftmesh
from liftmesh.plugins.libpysal import build_triangulation
from liftmesh.plugins.networkx import to_networkx

ROWS = np.random.default_rng(7).random((60, 2))
WELLS = geopandas.GeoSeries.from_xy(*ROWS.T, index=[f"well {i}" for i in range(60)])
METHODS = ("delaunay", "gabriel", "relative_neighborhood")


def theirs(*given: Any, **options: Any) -> Graph:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # without numba it is slow
        return Graph.build_triangulation(*given, **options)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "options", [{}, {"kernel": "gaussian", "bandwidth": 0.3}, {"kernel": "identity"}]
)
def test_what_libpysal_makes(method: Any, options: dict[str, Any]) -> None:
    ours = build_triangulation(WELLS, method, **options)
    expected = theirs(WELLS, method, **options)
    pd.testing.assert_series_equal(ours.adjacency, expected.adjacency)
    assert ours.unique_ids.equals(pd.Index(WELLS.index, name="focal"))


def test_without_a_kernel_weights_are_one() -> None:
    ours = build_triangulation(ROWS, kernel=None)
    expected = theirs(ROWS, kernel=None).adjacency
    pd.testing.assert_series_equal(ours.adjacency, expected, check_dtype=False)
    assert build_triangulation(WELLS.to_frame("geometry"), "minimum_spanning_tree").n_edges == 118


def test_ties_do_not_depend_on_qhull() -> None:
    """libpysal keeps a diagonal of each square, and no side of three equal ones."""
    grid = np.indices((4, 4)).reshape(2, -1).T
    assert build_triangulation(grid, "gabriel").n_edges == 48
    assert theirs(grid, "gabriel").n_edges == 66
    corners = [[0, 0], [3, 0], [0, 3], [3, 3]]
    assert build_triangulation(corners, "relative_neighborhood").n_edges == 8


def test_rows_at_one_position() -> None:
    rows = np.concatenate([ROWS, ROWS[[3, 3, 8]]])
    with pytest.raises(ValueError, match="3 rows at the position of another, first row 60 at that"):
        build_triangulation(rows)
    ours = build_triangulation(rows, coplanar="clique")
    expected = theirs(rows, coplanar="clique").adjacency.index
    assert not expected.difference(ours.adjacency.index).size
    assert {3, 60, 61} - {60} <= {*ours.neighbors[60]}
    assert {*ours.neighbors[60]} - {3, 61} == {*ours.neighbors[3]} - {60, 61}


def test_no_row_is_lost_far_from_zero() -> None:
    """Qhull drops rows there, whose neighbours other libraries then miss."""
    rows = np.add(np.floor(ROWS * 2**20), [2.0**40, 2.0**41])
    ours = build_triangulation(rows, "gabriel")
    assert ours.n == 60
    assert not len(ours.isolates)
    assert ours.neighbors == build_triangulation(rows - rows[0], "gabriel").neighbors


def test_refusals() -> None:
    for option, value in {"method": "voronoi", "coplanar": "jitter"}.items():
        with pytest.raises(liftmesh.InputError, match=f"{option} is '{value}': "):
            build_triangulation(ROWS, **{option: value})  # type: ignore[arg-type]


def test_a_graph_of_networkx() -> None:
    found = liftmesh.delaunay(np.concatenate([ROWS, ROWS[:2]]))
    graph = to_networkx(found, "gabriel")
    assert list(graph) == list(range(62))
    assert not graph[61]
    assert nx.number_connected_components(graph) == 3
    assert graph.nodes[5]["pos"] == tuple(ROWS[5])
    matrix = nx.to_scipy_sparse_array(graph)
    assert (matrix != found.graph("gabriel")).nnz == 0
