"""Where three cells of disks meet: the centres of circles that touch three disks.

Relative to the smallest of the disks, p, the vertex v is at the distance R from p if, for both
others, x vx + y vy + r R = P / 2, with (x, y, r) what the disk has more, and P its power. Newton's
method solves these with vx^2 + vy^2 = R^2, from the rounded circle on.

Where a disk is nearly inside another, terms cancel. There v is computed from the minors of the two
equations (see `apollonius/polynomials.hpp`), in rationals and with a root of many digits.

The difference of two disks, and their power, also where one is nearly inside the other.

With x, y, r the differences of centres and radii, the power P = x^2 + y^2 - r^2 is positive unless
one disk contains the other. Where it nearly does, the terms cancel. So differences and products are
kept with what rounding takes off them (T. J. Dekker, "A floating-point technique for extending the
available precision", Numer. Math. 18, 1971), and P has twice the digits of a double but for what
cancels.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

import numpy as np

from liftmesh._typing import Floats, Rows

_STEPS = 3  # of Newton's method: from half of the digits, one would do
_OFF = 2.0**-44  # of the terms: what equations may be off
_CANCELLED = 2.0**-20  # of d R: powers that are less are too small for the equations
_DIGITS = 1024  # binary ones of a root


def vertices_of(disks: Floats, simplices: Rows, circles: Floats) -> Floats:
    """Compute where cells meet."""
    turn = disks[simplices, 2].argmin(axis=1)[:, None] + np.arange(3)
    p, q, r = np.take_along_axis(simplices, turn % 3, axis=1).T
    (first, power), (second, other) = (differences_of(disks, k, p) for k in (q, r))
    rows, half = np.stack([first, second], axis=1), np.stack([power, other], axis=1) / 2
    found = np.c_[circles[:, :2] - disks[p, :2], circles[:, 2]]
    found[:, 2] = np.hypot(found[:, 0], found[:, 1])
    with np.errstate(all="ignore"):
        error = _refine(found, rows, half)
        terms = np.abs(rows * found[:, None]).sum(axis=2)
        is_poor = ~((np.abs(error) <= _OFF * terms) & (half > _CANCELLED * terms)).all(axis=1)
    places: Floats = disks[p, :2] + found[:, :2]
    for k in np.flatnonzero(is_poor).tolist():
        places[k] = _exactly(*(disks[row].tolist() for row in (p[k], q[k], r[k])))
    return places


def _refine(found: Floats, rows: Floats, half: Floats) -> Floats:
    """Improve (vx, vy, R) in place, and return what the equations are off."""
    error = _residuals(found, rows, half)
    for _ in range(_STEPS):
        tried = found - _step(found, rows, error)
        tried[:, 2] = np.hypot(tried[:, 0], tried[:, 1])
        off = _residuals(tried, rows, half)
        is_better = np.abs(off).sum(axis=1) < np.abs(error).sum(axis=1)
        found[is_better], error[is_better] = tried[is_better], off[is_better]
    return error


def _residuals(found: Floats, rows: Floats, half: Floats) -> Floats:
    off: Floats = np.einsum("mij,mj->mi", rows, found) - half
    return off


def _step(found: Floats, rows: Floats, error: Floats) -> Floats:
    """Solve for a step that changes nothing of vx^2 + vy^2 - R^2."""
    first, second = rows[:, 0], rows[:, 1]
    cone = found * (1.0, 1.0, -1.0)
    determinant = (first * np.cross(second, cone)).sum(axis=1)[:, None]
    step: Floats = (
        error[:, :1] * np.cross(second, cone) + error[:, 1:] * np.cross(cone, first)
    ) / determinant
    return step


def _exactly(*disks: list[float]) -> tuple[float, float]:
    """Compute the vertex of three disks, counter-clockwise about it, and round it."""
    p, q, r = ([Fraction(value) for value in disk] for disk in disks)
    (x, y, more, power), (u, v, other, second) = _relative(p, q), _relative(p, r)
    xp, yp, rp = x * second - u * power, y * second - v * power, more * second - other * power
    xy, xr, yr = x * v - u * y, x * other - u * more, y * other - v * more
    root = _root(power * second * _relative(q, r)[3])
    twice = 2 * (xp * xr + yp * yr + xy * root)
    along = -xp * rp - yp * root, -yp * rp + xp * root
    return float(p[0] + along[0] / twice), float(p[1] + along[1] / twice)


def _relative(p: list[Fraction], q: list[Fraction]) -> tuple[Fraction, ...]:
    x, y, r = (b - a for a, b in zip(p, q, strict=True))
    return x, y, r, x * x + y * y - r * r


def _root(square: Fraction) -> Fraction:
    """Return the root, with so many digits."""
    product = square.numerator * square.denominator
    shift = max(0, 2 * _DIGITS - product.bit_length()) // 2
    return Fraction(isqrt(product << 2 * shift), square.denominator << shift)


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
