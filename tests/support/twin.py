"""The planar predicates a second time, in rational numbers: nothing of the program, no rounding.

Coordinates become `fractions.Fraction`, a whole array at a time, and each question is put in words
of geometry rather than in the program's formulas: a turn is the area of a triangle; a side is
whether the lift of d, at the height x^2 + y^2, lies below the plane through three others. The rule
for ties is no rule here. Every point is raised by a concrete number instead, a power of one small
`epsilon`, the larger the later it comes in the order by x, then y (`raised`), and the side of what
was raised is taken.
"""

from __future__ import annotations

from fractions import Fraction
from math import gcd

import numpy as np
from numpy.typing import NDArray

Rationals = NDArray[np.object_]
Signs = NDArray[np.int8]

ONE = Fraction(1)


def rational(values: NDArray[np.float64]) -> Rationals:
    """The very same numbers as fractions."""
    return np.vectorize(Fraction, otypes=[object])(values)


def sign(values: Rationals) -> Signs:
    return (values > 0).astype(np.int8) - (values < 0).astype(np.int8)


def area(a: Rationals, b: Rationals, c: Rationals) -> Rationals:
    """Twice the signed areas of triangles (..., 2): the sum over sides of what each cuts off."""
    return sum(p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0] for p, q in ((a, b), (b, c), (c, a)))


def turns(questions: Rationals) -> Signs:
    """Which way the first three points of each question (..., 3 or 4, 2) turn."""
    a, b, c = (questions[..., corner, :] for corner in range(3))
    return sign(area(a, b, c))


def heights(questions: Rationals) -> Rationals:
    """The lifts of all points."""
    return questions[..., 0] ** 2 + questions[..., 1] ** 2


def sides(questions: Rationals, z: Rationals | None = None) -> Signs:
    """Whether d is below (1), on (0) or above (-1) the plane of a, b, c, which turn left.

    `z` are the heights (..., 4) of the points (..., 4, 2), their lifts by default. Where a, b, c
    turn right the sign is the other one, as it is for a determinant.
    """
    z = heights(questions) if z is None else z
    a, b, c, d = (questions[..., corner, :] for corner in range(4))
    under = area(d, b, c) * z[..., 0] + area(a, d, c) * z[..., 1] + area(a, b, d) * z[..., 2]
    return sign(under - area(a, b, c) * z[..., 3])


def whole(question: Rationals) -> Rationals:
    """One question in units of its own lattice, seen from its last point: whole numbers."""
    seen = question - question[-1]
    seen *= max(value.denominator for value in seen.flat)
    return seen / (gcd(*(value.numerator for value in seen.flat)) or 1)


def small_enough(question: Rationals) -> Fraction:
    """An epsilon for `raised`, given the question in whole numbers.

    Twice an area is a whole number, and at most `most`. So the rises together change no
    determinant but zero, and of them a later one outweighs all earlier ones that count.
    """
    spread = max(abs(value) for value in question.flat)
    most = 8 * spread**2
    return ONE / (2 * most + 2)


def raised(question: Rationals, epsilon: Fraction) -> Rationals:
    """Heights of the four points: the k-th from the last in the order rises by epsilon^k."""
    positions = sorted({tuple(point) for point in question}, reverse=True)
    rise = {position: epsilon ** (k + 1) for k, position in enumerate(positions)}
    return heights(question) + np.array([rise[tuple(point)] for point in question], dtype=object)


def canonical_sides(questions: Rationals, share: Fraction = ONE) -> Signs:
    """Sides of the raised lifts of questions (k, 4, 2); `share` makes the rises smaller still."""
    rows = [whole(question) for question in questions]
    z = [raised(row, share * small_enough(row)) for row in rows]
    return sides(np.array(rows, dtype=object), np.array(z, dtype=object))
