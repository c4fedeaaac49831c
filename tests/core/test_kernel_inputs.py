"""What cannot be triangulated: each a named error that tells the row, the value, a way out."""

from __future__ import annotations

import re
import tracemalloc
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import liftmesh

SQUARE = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]


def square_with(row: int, values: list[float]) -> np.ndarray:
    points = np.array(SQUARE)
    points[row] = values
    return points


def masked_square() -> np.ma.MaskedArray:
    points = np.ma.masked_array(SQUARE)
    points[2, 0] = np.ma.masked
    return points


DEGENERATE = {
    "no row": np.empty((0, 2)),
    "no row of three columns": np.empty((0, 3)),
    "one point": [[1.0, 2.0]],
    "two points": [[1.0, 2.0], [3.0, 4.0]],
    "three rows of two positions": [[1.0, 2.0], [3.0, 4.0], [1.0, 2.0]],
    "all equal": np.ones((1000, 2)),
    "zeros of both signs": [[0.0, -0.0], [-0.0, 0.0], [-0.0, -0.0]],
    "horizontal": np.column_stack((np.arange(100.0), np.zeros(100))),
    "vertical": np.column_stack((np.zeros(100), np.arange(100.0))),
    "diagonal": np.column_stack((np.arange(100), np.arange(100))),
    "oblique": np.arange(100.0)[:, None] * [3, -7] + [5, 11],
    "denormal diagonal": np.arange(100.0)[:, None] * [2.0**-1074, 2.0**-1074],
    "huge diagonal": np.linspace(-1, 1, 100)[:, None] * [1.7e308, 1.7e308],
    "a long line": np.column_stack((np.arange(100_000.0), np.arange(100_000.0))),
}
NON_FINITE = {
    "nan": (square_with(1, [np.nan, 0]), 1, "nan"),
    "nan in y": (square_with(3, [0, np.nan]), 3, "nan"),
    "inf": (square_with(2, [np.inf, 0]), 2, "inf"),
    "-inf": (square_with(0, [0, -np.inf]), 0, "-inf"),
    "float32 inf": (square_with(2, [np.inf, 0]).astype(np.float32), 2, "inf"),
    "only nan": (np.full((5, 2), np.nan), 0, "nan"),
    "masked": (masked_square(), 2, "nan"),
    "list": ([[0, 0], [1, 0], [0, float("nan")]], 2, "nan"),
}
SHAPES = {
    "no dimension": (5.0, r"\(\)"),
    "one dimension": ([1.0, 2.0, 3.0], r"\(3,\)"),
    "empty list": ([], r"\(0,\)"),
    "one column": (np.zeros((5, 1)), r"\(5, 1\)"),
    "no column": (np.zeros((5, 0)), r"\(5, 0\)"),
    "four columns": (np.zeros((5, 4)), r"\(5, 4\)"),
    "three dimensions": (np.zeros((2, 3, 2)), r"\(2, 3, 2\)"),
    "coordinates in rows": (np.zeros((2, 50)), r"\(2, 50\)"),
}
TYPES = {
    "strings": [["0", "0"], ["1", "0"], ["0", "1"]],
    "bytes": np.array([[b"0", b"0"], [b"1", b"0"], [b"0", b"1"]]),
    "complex": np.array(SQUARE, dtype=complex),
    "bool": np.array(SQUARE, dtype=bool),
    "list of bool": [[True, False], [False, True], [True, True]],
    "objects": np.array([[object(), 1], [2, 3], [4, 5]], dtype=object),
    "None": [[None, 1.0], [2.0, 3.0], [4.0, 5.0]],
    "ragged": [[0.0, 0.0], [1.0, 0.0, 5.0], [0.0]],
    "a number among rows": [[0.0, 0.0], 1.0, [1.0, 0.0]],
    "a list among numbers": [[0.0, [1.0]], [1.0, 0.0], [0.0, 1.0]],
    "dates": np.array([["2024-01-01", "2024-01-02"]] * 3, dtype="datetime64[D]"),
    "durations": np.zeros((3, 2), dtype="timedelta64[s]"),
    "records": np.zeros(3, dtype=[("x", "f8"), ("y", "f8")]),
    "a word": "points",
    "nothing": None,
    "a mapping": {"x": [1, 2, 3], "y": [4, 5, 6]},
    "an object": object(),
}
INEXACT = {
    "int64": (np.array([[0, 0], [1, 0], [0, 2**53 + 1]]), 2, str(2**53 + 1)),
    "negative int64": (np.array([[0, 0], [-(2**53) - 1, 0], [0, 1]]), 1, str(-(2**53) - 1)),
    "uint64": (np.array([[0, 0], [0, 1], [2**64 - 1, 0]], dtype=np.uint64), 2, str(2**64 - 1)),
    "int64's end": (np.array([[0, 0], [0, 1], [2**63 - 1, 0]]), 2, str(2**63 - 1)),
    "Python int": ([[0, 0], [0, 1], [2**80 + 1, 0]], 2, str(2**80 + 1)),
    "longdouble": (np.array(SQUARE, dtype=np.longdouble) / 3, 1, "0.333333"),
}


@pytest.mark.parametrize("points", DEGENERATE.values(), ids=DEGENERATE.keys())
def test_too_little_for_a_triangle(points) -> None:
    with pytest.raises(liftmesh.DegenerateInputError, match=r"distinct|line"):
        liftmesh.delaunay(points)


@pytest.mark.parametrize(("points", "row", "value"), NON_FINITE.values(), ids=NON_FINITE.keys())
def test_non_finite_rows_are_named(points, row: int, value: str) -> None:
    with pytest.raises(liftmesh.NonFiniteError, match=rf"row {row}\b.*{value}") as caught:
        liftmesh.delaunay(points)
    assert caught.value.row == row
    assert "skip" in str(caught.value)


def test_skipping_all_rows_leaves_too_little() -> None:
    with pytest.raises(liftmesh.DegenerateInputError):
        liftmesh.delaunay(np.full((5, 2), np.nan), nonfinite="skip")


@pytest.mark.parametrize(("points", "shape"), SHAPES.values(), ids=SHAPES.keys())
def test_wrong_shapes_are_named(points, shape: str) -> None:
    with pytest.raises(liftmesh.InputError, match=shape):
        liftmesh.delaunay(points)


@pytest.mark.parametrize("points", TYPES.values(), ids=TYPES.keys())
def test_what_holds_no_real_numbers_is_refused(points) -> None:
    with pytest.raises(liftmesh.LiftmeshError) as caught:
        liftmesh.delaunay(points)
    assert isinstance(caught.value, (ValueError, TypeError))
    assert len(str(caught.value)) > 20


@pytest.mark.parametrize(("points", "row", "value"), INEXACT.values(), ids=INEXACT.keys())
def test_numbers_that_no_double_holds_are_named(points, row: int, value: str) -> None:
    with pytest.raises(liftmesh.InputError, match=rf"row {row}\b.*{value}"):
        liftmesh.delaunay(points)


def test_python_integers_beyond_every_double_are_refused() -> None:
    with pytest.raises(liftmesh.InputError, match="row 1"):
        liftmesh.delaunay([[0, 0], [10**400, 0], [0, 1]])


def test_python_integers_that_a_double_holds_are_welcome() -> None:
    assert liftmesh.delaunay([[0, 0], [2**80, 0], [0, 2**70]]).simplices.tolist() == [[0, 1, 2]]


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int64, np.int8])
@pytest.mark.parametrize("columns", [2, 3])
def test_too_many_rows_are_refused_before_any_copy(dtype: type, columns: int) -> None:
    points = np.broadcast_to(np.zeros((1, columns), dtype), (2**30, columns))
    tracemalloc.start()
    try:
        with pytest.raises(liftmesh.InputError, match="357,913,941"):
            liftmesh.delaunay(points)
        assert tracemalloc.get_traced_memory()[1] < 2**20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "options",
    [{"algorithm": "fastest"}, {"nonfinite": "ignore"}, {"order": "random"}],
    ids=lambda options: next(iter(options)),
)
def test_unknown_options_name_the_choices(options: dict[str, str]) -> None:
    with pytest.raises(liftmesh.InputError, match=next(iter(options.values()))):
        liftmesh.delaunay(SQUARE, **options)


def test_options_are_keywords_only() -> None:
    with pytest.raises(TypeError):
        liftmesh.delaunay(SQUARE, "auto")


@pytest.mark.parametrize("points", [*DEGENERATE.values(), *TYPES.values()])
def test_the_scipy_door_refuses_the_same(points) -> None:
    with pytest.raises(liftmesh.LiftmeshError):
        liftmesh.scipy.Delaunay(points)


def test_the_scipy_door_does_not_drop_a_third_column() -> None:
    assert liftmesh.scipy.Delaunay(np.random.default_rng(0).random((10, 3))).ndim == 3


def test_masked_rows_beyond_the_limit_are_refused_before_a_copy() -> None:
    rows = np.ma.masked_invalid(np.broadcast_to(0.0, (2**30, 2))[:1])
    huge = np.ma.MaskedArray(np.broadcast_to(0.0, (2**30, 2)), mask=np.ma.nomask)
    with pytest.raises(liftmesh.DegenerateInputError):
        liftmesh.delaunay(rows)
    with pytest.raises(liftmesh.InputError, match="1,073,741,824 rows"):
        liftmesh.delaunay(huge)


@pytest.mark.parametrize("half", [Fraction(1, 2), Decimal("0.5"), np.float32(0.5)])
def test_real_numbers_of_any_kind_that_a_double_holds(half: object) -> None:
    points = np.array([[0, 0], [half, 0], [0, half]], dtype=object)
    assert liftmesh.delaunay(points).points.tolist() == [[0, 0], [0.5, 0], [0, 0.5]]


def test_a_fraction_that_no_double_holds() -> None:
    points = np.array([[0, 0], [Fraction(1, 3), 0], [0, 1]], dtype=object)
    with pytest.raises(
        liftmesh.InputError, match="row 1 holds 1/3 in column 0, which float64 does not"
    ):
        liftmesh.delaunay(points)


LONG = np.longdouble


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("value", "kind", "shown"),
    [
        (LONG("1e4000"), LONG, "1e+4000"),
        (LONG("-1e4000"), LONG, "-1e+4000"),
        (LONG("1e4000"), object, "1e+4000"),
        (Decimal("1e4000"), object, "1E+4000"),
        (Fraction(10**4000, 7), object, "about 1.42857143E+3999"),
        (10**400, object, "about 1E+400"),
        (-(10**5000), object, "about -1E+5000"),
    ],
    ids=range(7),  # by default the value, which has too many digits
)
def test_a_number_beyond_float64_is_named_as_it_was_given(
    value: object, kind: type, shown: str
) -> None:
    beyond = re.escape(f"row 1 holds {shown} in column 1, which is beyond the largest float64")
    points = np.array([[0, 0], [1, value], [0, 1]], dtype=kind)
    with np.errstate(all="raise"), pytest.raises(liftmesh.InputError, match=beyond):
        liftmesh.delaunay(points)
    with pytest.raises(liftmesh.InputError, match=beyond):
        liftmesh.delaunay([[0, 0], [1, value], [0, 1]])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [LONG(1) / 3, LONG("1e-4000"), Decimal("1e-4000")])
def test_a_number_that_rounding_would_change_is_named_as_it_was_given(value: object) -> None:
    points = np.array([[0, 0], [value, 0], [0, 1]], dtype=type(value))
    named = re.escape(f"row 1 holds {value!s} in column 0, which float64 does not represent")
    with np.errstate(all="raise"), pytest.raises(liftmesh.InputError, match=named):
        liftmesh.delaunay(points)


def test_an_infinite_longdouble_and_a_signalling_nan_are_not_finite() -> None:
    for value in (LONG("inf"), Decimal("sNaN"), Decimal("-inf")):
        with pytest.raises(liftmesh.NonFiniteError, match="row 1 is not finite"):
            liftmesh.delaunay([[0, 0], [value, 0], [0, 1]])


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [LONG("1e4000"), 10**400])
def test_options_beyond_float64_are_refused(value: object) -> None:
    with pytest.raises(liftmesh.InputError, match="apex is "):
        liftmesh.lift(SQUARE, apex=(value, 0))
    with pytest.raises(liftmesh.InputError, match="plane "):
        liftmesh.triangulate(np.eye(3), plane=(0, 0, value))


def test_a_decimal_of_many_digits_makes_a_short_message() -> None:
    with pytest.raises(liftmesh.InputError) as caught:
        liftmesh.delaunay([[Decimal("1" * 100_000), 0], [0, 1], [1, 1]])
    assert "row 0 holds about 1.11111111E+99999 in column 0" in str(caught.value)
    assert len(str(caught.value)) < 300
