"""By what points are lifted, in floating point: `Heights`, and the option `apex`."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh import InputError, delaunay, lift, project
from liftmesh.planar.lifting import Heights, given_apex, resolve_apex


def test_the_vertex_of_the_paraboloid() -> None:
    assert given_apex((1, 2)) == (1.0, 2.0)
    assert given_apex("median") is None
    assert resolve_apex("origin", np.ones((1, 2))) == (0.0, 0.0)
    rows = np.array([[0.0, 5.0], [1.0, 7.0], [9.0, 6.0], [np.nan, 0.0]])
    assert resolve_apex("median", rows) == (1.0, 6.0)


def test_the_median_is_that_of_the_distinct_points_in_any_order() -> None:
    rows = np.array([[0.0, -0.0], [-0.0, 0.0], [4.0, 1.0], [4.0, 1.0], [4.0, 8.0], [np.inf, 9.0]])
    turned = rows[::-1].astype(np.float32)
    assert resolve_apex("median", rows) == resolve_apex("median", turned) == (4.0, 1.0)
    assert str(resolve_apex("median", rows[[1, 0]])) == "(0.0, 0.0)"
    assert resolve_apex("median", np.array([[1e308, 0.0], [1.7e308, 2.0]])) == (1.35e308, 1.0)
    assert lift(rows[:5]).tolist() == delaunay([*rows[:5]]).lifted().vertices.tolist()


def test_points_in_space() -> None:
    rows = np.array([[1.0, 2, 3], [4, 0, 6], [9, 9, 0], [9, 9, 0], [np.nan, 0, 0]])
    lifted = lift(rows, dimension=3)
    np.testing.assert_array_equal(lifted[:4, 3], ((rows[:4] - (4, 2, 3)) ** 2).sum(axis=1))
    np.testing.assert_array_equal(project(lifted), rows)
    assert lift(rows[:1], (1, 2, 2), dimension=3).tolist() == [[1, 2, 3, 1]]
    assert lift([[1e308, 0, 5e-324], [1.7e308, 2, 5e-324]], dimension=3)[0, 2] == 5e-324
    assert lift(np.empty((0, 3)), dimension=3).shape == (0, 4)
    assert lift(rows[:1], "origin").tolist() == [[1, 2, 5]]
    for options, message in (
        ({"apex": (1, 2)}, r"a finite point \(x, y, z\)"),
        ({"dimension": 4}, "give 2 or 3"),
    ):
        with pytest.raises(InputError, match=message):
            lift(rows, **{"dimension": 3, **options})
    with pytest.raises(InputError, match="two columns"):
        lift([[0, 0]], dimension=3)


@pytest.mark.parametrize(
    ("apex", "message"),
    [
        ("middle", "apex is 'middle': give 'median', 'origin' or a point"),
        ((1, "a"), r"apex is \(1, 'a'\): give 'median', 'origin' or a point"),
        ((1, np.inf), r"apex is \(1, inf\): give 'median', 'origin' or a finite point"),
    ],
)
def test_what_is_no_vertex_is_refused(apex: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        given_apex(apex)  # type: ignore[arg-type]


def test_metrics_and_weights_change_the_heights() -> None:
    metric = Heights(metric=np.array([[2.0, 1.0], [1.0, 3.0]]))
    assert metric.lifted(np.array([[1.0, 10.0]])).tolist() == [[1, 10, 322]]
    rows = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    weights = Heights(weights=np.array([1.0, 0.0, 5.0]))
    assert weights.lifted_rows(rows)[:, 2].tolist() == [-1, 16, 11]
    radii = Heights(radii=np.array([1.0, 0.0, 3.0]))
    assert radii.lifted_rows(rows)[:, 2].tolist() == [-1, 16, 7]
