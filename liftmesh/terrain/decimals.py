"""Numbers as people write them: 0.6 is three times 0.2.

Of two doubles that are printed as 0.6 and 0.2, the quotient is less than 3. A step that someone
gives is meant as the decimal that it is printed as; multiples of it are counted in rationals, and
rounded once.
"""

from __future__ import annotations

import math
from fractions import Fraction

from numpy.typing import ArrayLike

from liftmesh.base.arrays import as_reals

_LONG = 10**15


def as_decimal(value: ArrayLike) -> Fraction:
    """Convert a number to the decimal that it is printed as."""
    try:
        found = float(as_reals(value))
    except (TypeError, OverflowError) as error:
        raise ValueError from error
    if not math.isfinite(found):
        raise ValueError
    return Fraction(repr(found))


def as_thousands(count: int) -> str:
    """Show a number, which may be of any size, in a message."""
    if count < _LONG:
        return f"{count:,}"
    digits = str(count)
    return f"{digits[0]}e+{len(digits) - 1}"
