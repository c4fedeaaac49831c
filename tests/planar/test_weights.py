"""Weights and radii that cannot be used: an error that names the row, the value and the remedy."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import InputError, NonFiniteError

POINTS = np.random.default_rng(1).random((6, 2))
FINE = np.arange(6.0)


def with_value(at: int, value: Any) -> list[Any]:
    return [*FINE[:at].tolist(), value, *FINE[at + 1 :].tolist()]


KINDS = pytest.mark.parametrize(("kind", "one"), [("weights", "weight"), ("radii", "radius")])


@KINDS
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_what_is_not_finite_is_named_or_skipped(kind: str, one: str, value: float) -> None:
    given = with_value(4, value)
    said = f"row 4 has the {one} {value}: remove such rows, or skip them with nonfinite='skip'"
    with pytest.raises(NonFiniteError, match=re.escape(said)) as caught:
        liftmesh.regular(POINTS, **{kind: given})
    assert caught.value.row == 4
    found = liftmesh.regular(POINTS, **{kind: given}, nonfinite="skip")
    assert found.skipped.tolist() == [4]
    others = liftmesh.regular(np.delete(POINTS, 4, axis=0), **{kind: np.delete(FINE, 4)})
    assert found.nsimplex == others.nsimplex
    assert (found.points == POINTS).all()
    assert (found.find_simplex(POINTS[[0, 1, 2, 3, 5]]) >= 0).all()


@KINDS
def test_masked_values_are_not_finite(kind: str, one: str) -> None:
    given = np.ma.masked_equal(np.arange(6), 2)
    with pytest.raises(NonFiniteError, match=f"row 2 has the {one} nan"):
        liftmesh.regular(POINTS, **{kind: given})
    assert liftmesh.regular(POINTS, **{kind: given}, nonfinite="skip").skipped.tolist() == [2]


def test_the_coordinates_of_a_row_come_first() -> None:
    points = POINTS.copy()
    points[3, 1] = np.inf
    with pytest.raises(NonFiniteError, match="row 3 is not finite"):
        liftmesh.regular(points, weights=FINE)
    found = liftmesh.regular(points, weights=with_value(0, np.nan), nonfinite="skip")
    assert found.skipped.tolist() == [0, 3]


@pytest.mark.parametrize("nonfinite", ["error", "skip"])
def test_radii_are_not_negative(nonfinite: Any) -> None:
    said = "row 2 has the radius -0.5: radii are not negative; weights may be"
    with pytest.raises(InputError, match=said):
        liftmesh.regular(POINTS, radii=with_value(2, -0.5), nonfinite=nonfinite)
    with pytest.raises(InputError, match="row 5 has the radius -inf"):
        liftmesh.regular(POINTS, radii=with_value(5, -np.inf), nonfinite=nonfinite)
    zero = liftmesh.regular(POINTS, radii=[-0.0] * 6)
    np.testing.assert_array_equal(zero.simplices, liftmesh.regular(POINTS, radii=[0] * 6).simplices)
    assert liftmesh.regular(POINTS, weights=-FINE).nsimplex > 0


@KINDS
@pytest.mark.parametrize(
    ("given", "said"),
    [
        (FINE[:5], "hold 5 numbers for 6 rows: give one for each"),
        (np.zeros(7), "hold 7 numbers for 6 rows: give one for each"),
        ([], "hold 0 numbers for 6 rows"),
        (3.0, "are 3.0: give an array of one number for each of 6 rows"),
        (POINTS, "have the shape (6, 2): give an array of one number for each of 6 rows"),
        (FINE[None], "have the shape (1, 6): give an array"),
        ([1, [2], 3, 4, 5, 6], "cannot be converted to an array"),
        (with_value(0, 1j), "hold complex128 values (row 0: [1j]): give real numbers"),
        (["a"] * 6, "hold <U1 values"),
        (FINE > 2, "hold bool values"),
        (with_value(1, "b"), "hold <U32 values"),
        (np.array(with_value(1, None), dtype=object), "a NoneType: give real numbers"),
        (np.arange(2**62 + 1, 2**62 + 7), "4611686018427387905 in"),
        ([*FINE[:5], Fraction(1, 3)], "row 5 holds 1/3 in"),
        ([*FINE[:5], 10**400], "which is beyond the largest float64"),
    ],
)
def test_what_is_no_number_for_each_row_is_refused(
    kind: str, one: str, given: Any, said: str
) -> None:
    assert one
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        liftmesh.regular(POINTS, **{kind: given})
    assert kind in str(caught.value) or "row" in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_one_of_the_two_is_given() -> None:
    with pytest.raises(InputError, match="both weights and radii are given: give one of them"):
        liftmesh.regular(POINTS, weights=FINE, radii=FINE)
    with pytest.raises(InputError, match=r"neither weights nor radii .*, or use delaunay"):
        liftmesh.regular(POINTS)


def test_names_that_are_not_there_list_those_that_are() -> None:
    cloud = liftmesh.Cloud(np.c_[POINTS, FINE], attributes={"size": FINE, "class": FINE})
    said = "weights='w', and the points have no values of that name: there are 'size', 'class'"
    with pytest.raises(InputError, match=said):
        liftmesh.regular(cloud, weights="w")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="they have none; give points with such a column"):
        liftmesh.regular(POINTS, radii="size")
    pairs = liftmesh.Cloud(np.c_[POINTS, FINE], attributes={"pair": POINTS})
    with pytest.raises(InputError, match=r"weights have the shape \(6, 2\)"):
        liftmesh.regular(pairs, weights="pair")  # type: ignore[arg-type]


def test_points_on_a_line_have_no_triangle() -> None:
    line = np.c_[FINE, FINE]
    with pytest.raises(liftmesh.DegenerateInputError, match="lie on one line, from row 0 to row 5"):
        liftmesh.regular(line, weights=FINE)
    with pytest.raises(liftmesh.DegenerateInputError, match="hold 1 distinct planar point:"):
        liftmesh.regular(np.zeros((6, 2)), weights=FINE)
    with pytest.raises(liftmesh.UnsupportedTypeError, match="not 2 columns"):
        liftmesh.regular(FINE, FINE, weights=FINE)  # type: ignore[call-arg, misc]
