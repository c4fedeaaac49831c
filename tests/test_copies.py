"""Results and exceptions survive pickling and copying."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import liftmesh

CLOUD = np.random.default_rng(3).random((40, 3))
WAYS = pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))]
)


@WAYS
def test_results(again: Callable[[Any], Any]) -> None:
    surface = liftmesh.triangulate(CLOUD)
    surface.triangulation.find_simplex([0.5, 0.5])
    twin = again(surface)
    np.testing.assert_array_equal(twin.faces, surface.faces)
    assert dict(twin.report.seconds) == dict(surface.report.seconds)
    found = twin.triangulation.find_simplex([0.5, 0.5])
    assert found == surface.triangulation.find_simplex([0.5, 0.5])
    comparison = liftmesh.compare(surface)
    assert again(comparison).verdict == comparison.verdict
    cloud = liftmesh.Cloud(CLOUD, attributes={"class": np.arange(40)}, metadata={"epsg": 25832})
    assert again(cloud).metadata == cloud.metadata
    np.testing.assert_array_equal(again(cloud).attributes["class"], np.arange(40))


@WAYS
def test_exceptions(again: Callable[[Any], Any]) -> None:
    twin = again(liftmesh.NonFiniteError("row 3 is not finite", row=3))
    assert (str(twin), twin.row) == ("row 3 is not finite", 3)
    twin = again(liftmesh.DuplicateHeightError("rows 1 and 2", rows=(1, 2)))
    assert (str(twin), twin.rows) == ("rows 1 and 2", (1, 2))
    assert str(again(liftmesh.FormatError("a.ply: line 3"))) == "a.ply: line 3"


def test_what_point_location_rests_on_cannot_be_changed() -> None:
    tri = liftmesh.delaunay(CLOUD)
    for array in (tri.simplices, tri.neighbors, tri.duplicates, tri.skipped):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_point_location_ends_even_where_the_points_were_changed() -> None:
    points = np.random.default_rng(4).random((2000, 2))
    tri = liftmesh.delaunay(points)
    points[:] = points[::-1].copy()
    found = tri.find_simplex(np.random.default_rng(5).random((3000, 2)))
    assert found.min() >= -1
    assert found.max() < tri.nsimplex
