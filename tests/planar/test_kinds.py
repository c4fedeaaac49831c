"""Kinds of triangulations, and the options that say by what points are lifted."""

from __future__ import annotations

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, InputError, NonFiniteError
from liftmesh.planar.anisotropic import as_metrics
from liftmesh.planar.kinds import (
    TriangulationKind,
    as_kind,
    as_metric,
    as_weights,
    named_values,
    options_of,
    weights_or_radii,
)


def test_a_metric_is_an_array_of_its_own() -> None:
    given = np.array([[2.0, 1.0], [1.0, 3.0]])
    matrix = as_metric(given)
    assert matrix.tolist() == given.tolist()
    assert not np.shares_memory(matrix, given)
    assert as_metrics([given], 1).tolist() == [given.tolist()]


@pytest.mark.parametrize(
    ("metric", "message"),
    [
        ([[1, 2], [2, 4]], r"metric is \[\[1.0, 2.0\], .*\], which is not positive definite: give"),
        ([[1, 2], [3, 4]], "is not symmetric: give"),
        ([[1, np.nan], [3, 4]], "is not finite: give"),
        ([1, 2], r"metric has the shape \(2,\), not \(2, 2\): give"),
        ([[1], [2, 3]], "metric cannot be read as numbers"),
    ],
)
def test_what_is_no_metric_is_refused(metric: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_metric(metric)  # type: ignore[arg-type]


def test_what_rounding_cannot_tell_is_decided_exactly() -> None:
    assert as_metric([[1, 1], [1, np.nextafter(1, 2)]]).tolist()[1][1] > 1
    with pytest.raises(InputError, match="not positive definite"):
        as_metric([[1, 1], [1, 1]])


def test_a_kind_knows_its_values() -> None:
    metric = TriangulationKind("metric", np.array([2.0, 1.0, 3.0]))
    assert (metric.metric, metric.has_values, metric.may_hide) == (((2, 1), (1, 3)), False, False)
    assert as_kind(3, None, None, None, furthest_site=True).name == "farthest"
    weights = as_kind(2, [1, np.nan], None, None, furthest_site=False)
    assert (weights.name, weights.has_values, weights.may_hide) == ("weights", True, True)
    with pytest.raises(NonFiniteError, match="row 1 has the weight nan: remove such rows, or skip"):
        weights.finite(skipping=False)


def test_the_side_of_a_lifted_row_is_exact() -> None:
    square = (0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)
    assert TriangulationKind().side((0, 1, 2, 3), square) == 0
    weights = TriangulationKind("weights", np.array([0.0, 0, 0, 9]))
    assert weights.side((0, 1, 2, 3), square) == 1


def test_several_kinds_at_once_are_refused() -> None:
    with pytest.raises(InputError, match="weights and furthest_site are given: give one of them"):
        as_kind(1, [1], None, None, furthest_site=True)
    with pytest.raises(InputError, match="both weights and radii are given"):
        weights_or_radii([1], [1])
    assert weights_or_radii(None, "size") == ("radii", "size")


def test_a_triangulation_says_by_what_it_was_made() -> None:
    points = [[0, 0], [1, 0], [0, 1]]
    assert options_of(liftmesh.delaunay(points)) == {}
    of_metric = options_of(liftmesh.delaunay(points, metric=[[2, 0], [0, 1]]))
    assert {name: value.tolist() for name, value in of_metric.items()} == {
        "metric": [[2.0, 0.0], [0.0, 1.0]]
    }


def test_there_is_one_weight_for_each_row() -> None:
    with pytest.raises(InputError, match="weights hold 3 numbers for 4 rows: give one for each"):
        as_weights("weights", [1, 2, 3], 4)
    with pytest.raises(InputError, match=r"row 1 has the radius -1\.0: radii are not negative"):
        as_weights("radii", [1, -1], 2).finite(skipping=True)
    finite = as_weights("weights", [1, np.inf], 2).finite(skipping=True)
    assert finite is not None
    assert finite.tolist() == [True, False]


def test_names_of_values_must_be_there() -> None:
    cloud = Cloud(np.zeros((1, 3)), attributes={"size": np.ones(1)})
    assert named_values(cloud, "radii", "size").tolist() == [1]
    with pytest.raises(InputError, match="radii='length', and the points have no values of"):
        named_values(cloud, "radii", "length")
