"""By what points are lifted, in floating point: `Heights`, and the option `q`."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh import InputError
from liftmesh.planar.lifting import Heights, given_vertex, resolve_q


def test_the_vertex_of_the_paraboloid() -> None:
    assert given_vertex((1, 2)) == (1.0, 2.0)
    assert given_vertex("median") is None
    assert resolve_q("origin", np.ones((1, 2))) == (0.0, 0.0)
    rows = np.array([[0.0, 5.0], [1.0, 7.0], [9.0, 6.0], [np.nan, 0.0]])
    assert resolve_q("median", rows) == (1.0, 6.0)


@pytest.mark.parametrize(
    ("q", "message"),
    [
        ("middle", "q is 'middle': give 'origin', 'median' or a point"),
        ((1, "a"), r"q is \(1, 'a'\): give 'origin', 'median' or a point"),
        ((1, np.inf), r"q is \(1, inf\): give 'origin', 'median' or a finite point"),
    ],
)
def test_what_is_no_vertex_is_refused(q: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        given_vertex(q)  # type: ignore[arg-type]


def test_metrics_and_weights_change_the_heights() -> None:
    metric = Heights(metric=np.array([[2.0, 1.0], [1.0, 3.0]]))
    assert metric.lifted(np.array([[1.0, 10.0]])).tolist() == [[1, 10, 322]]
    rows = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]])
    weights = Heights(weights=np.array([1.0, 0.0, 5.0]))
    assert weights.lifted_rows(rows)[:, 2].tolist() == [-1, 16, 11]
    radii = Heights(radii=np.array([1.0, 0.0, 3.0]))
    assert radii.lifted_rows(rows)[:, 2].tolist() == [-1, 16, 7]
