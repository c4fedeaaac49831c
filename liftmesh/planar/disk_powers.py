"""The difference of two disks, and their power, also where one is nearly inside the other.

With x, y, r the differences of centres and radii, the power P = x^2 + y^2 - r^2 is positive unless
one disk contains the other. Where it nearly does, the terms cancel. So differences and products are
kept with what rounding takes off them (T. J. Dekker, "A floating-point technique for extending the
available precision", Numer. Math. 18, 1971), and P has twice the digits of a double but for what
cancels.
"""

from __future__ import annotations

from liftmesh._typing import Floats, Rows

_SPLIT = 2.0**27 + 1


def differences_of(disks: Floats, of: Rows, than: Rows) -> tuple[Floats, Floats]:
    """Subtract disks from others, and compute the powers of the pairs."""
    a, b = disks[of], disks[than]
    difference = a - b
    rounded = difference - a
    rest = (a - (difference - rounded)) - (b + rounded)
    square = difference * difference
    high = difference * _SPLIT
    high -= high - difference
    low = difference - high
    lost = ((high * high - square) + 2 * high * low) + low * low + 2 * difference * rest
    x, y, r = square.T
    total = x + y
    other = total - x
    lost_of_sum = (x - (total - other)) + (y - other)
    power = total - r
    other = power - total
    lost_of_power = (total - (power - other)) - (r + other)
    least = lost_of_sum + lost_of_power + (lost[:, 0] + lost[:, 1] - lost[:, 2])
    return difference, power + least
