"""Numbers of any type as floats that the kernel reads: exactly, or not at all.

Float64 and float32 stay as they are. Integers, fractions, decimals and wider floats become float64
if it holds every one of them; else an error names the first that it does not.
"""

from __future__ import annotations

import decimal
import math
import numbers
from typing import Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats, Mask, Reals
from liftmesh.errors import InputError
from liftmesh.shapes import is_masked_array

POINTS = "points"

_EXACT_INTEGERS = 2**53
_LARGEST = float(np.finfo(np.float64).max)
_LONGEST_SHOWN = 256  # bits
_ROUNDING = decimal.Context(prec=9, Emax=decimal.MAX_EMAX, Emin=decimal.MIN_EMIN)


def unmasked(array: Array, name: str = POINTS) -> Array:
    """Return an ordinary array, with NaN in the place of masked entries."""
    if not is_masked_array(array):
        return np.asarray(array)
    if not np.ma.is_masked(array):
        return np.asarray(array.data)
    mask = np.ma.getmaskarray(array)
    filled = np.array(as_floats(array.filled(0), name), dtype=np.float64)
    filled[mask] = np.nan
    return filled


def is_readable(array: Array) -> bool:
    """Whether the kernel can read the rows in place: it counts strides in whole items."""
    flags = array.flags
    if not flags.aligned:
        return False
    return flags.c_contiguous or all(stride % array.itemsize == 0 for stride in array.strides)


def as_floats(array: Array, name: str = POINTS) -> Reals:
    """Convert numbers to native float64, or float32 if they are; what is native stays."""
    kind = array.dtype.kind
    if kind == "f":
        return _as_double(array, name)
    if kind in "iu":
        return _from_integers(array, name)
    if kind == "O":
        return _from_objects(array, name)
    raise InputError(
        f"{name} hold {array.dtype} values (row 0: {array[:1].tolist()}): give real numbers, "
        "preferably float64"
    )


def _as_double(array: Reals, name: str) -> Reals:
    if array.itemsize in (4, 8):
        native = array.dtype.isnative
        return array if native else array.astype(array.dtype.newbyteorder("="))
    with np.errstate(all="ignore"):  # what overflows or underflows is refused
        doubles = array.astype(np.float64)
        inexact = (doubles != array) & ~np.isnan(array)
    _refuse_inexact(array, inexact, name)
    return doubles


def _from_integers(array: NDArray[np.integer[Any]], name: str) -> Floats:
    doubles = array.astype(np.float64)
    if array.itemsize == 8 and array.size and _exceeds(array, _EXACT_INTEGERS):
        large = np.nonzero((array > _EXACT_INTEGERS) | (array < -_EXACT_INTEGERS))
        inexact = np.zeros(array.shape, dtype=bool)
        inexact[large] = [int(doubles[at]) != int(array[at]) for at in zip(*large, strict=True)]
        _refuse_inexact(array, inexact, name)
    return doubles


def _exceeds(array: NDArray[np.integer[Any]], bound: int) -> bool:
    return bool(array.max() > bound or array.min() < -bound)


def _from_objects(array: NDArray[np.object_], name: str) -> Floats:
    doubles = np.empty(array.shape, dtype=np.float64)
    for at, value in np.ndenumerate(array):
        doubles[at] = _exact_double(value, at, name)
    return doubles


def _exact_double(value: Any, at: tuple[int, ...], name: str) -> float:
    if not isinstance(value, numbers.Real | decimal.Decimal):
        raise InputError(
            f"row {at[0]} holds {value!r} in {_column(at, name)}, a {type(value).__name__}: "
            "give real numbers"
        )
    if isinstance(value, decimal.Decimal) and value.is_nan():
        return math.nan  # one that signals cannot be converted
    try:
        with np.errstate(all="ignore"):
            double = float(value)
    except OverflowError as error:
        raise _inexact(value, at, name) from error
    if double == value or math.isnan(double):
        return double
    raise _inexact(value, at, name)


def _refuse_inexact(array: Array, inexact: Mask, name: str) -> None:
    if inexact.any():
        at = tuple(np.argwhere(inexact)[0].tolist())
        raise _inexact(array[at], at, name)


def _inexact(value: Any, at: tuple[int, ...], name: str) -> InputError:
    where = f"row {at[0]} holds {_shown(value)} in {_column(at, name)}"
    if not -_LARGEST <= value <= _LARGEST:
        remedy = "scale the coordinates down first" if name == POINTS else "scale all down first"
        return InputError(f"{where}, which is beyond the largest float64, {_LARGEST!r}: {remedy}")
    offset = "subtract an offset from the coordinates first, or " if name == POINTS else ""
    return InputError(
        f"{where}, which float64 does not represent exactly: {offset}round them to float64 "
        "explicitly"
    )


def _column(at: tuple[int, ...], name: str) -> str:
    return f"column {at[1]}" if name == POINTS else name


def _shown(value: Any) -> str:
    """Return a number as it was given, or rounded if it has too many digits for a message."""
    if isinstance(value, numbers.Rational):
        over, under = int(value.numerator), int(value.denominator)
        if max(over.bit_length(), under.bit_length()) > _LONGEST_SHOWN:
            quotient = _ROUNDING.divide(decimal.Decimal(over), decimal.Decimal(under))
            return f"about {quotient.normalize(_ROUNDING)}"
    if isinstance(value, decimal.Decimal) and len(value.as_tuple().digits) > _LONGEST_SHOWN // 3:
        return f"about {value.normalize(_ROUNDING)}"
    return str(value)  # an f-string would round a longdouble to a double
