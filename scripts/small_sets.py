"""Small random point sets of the kinds that find faults: few points, and everything at its limits.

Each kind takes a size and a random generator and returns an (n, 2) float64 array. `small_set` draws
one of them, and replaces up to 99 of a hundred rows by duplicates of others.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from distributions import Points, hexagonal, polar, two_columns, uniform
from numpy.random import Generator

Kind = Callable[[int, Generator], Points]

LEAST_EXPONENT, MOST_EXPONENT = -320.0, 308.0  # of ten
SHARES_OF_DUPLICATES = (0.0, 0.0, 0.3, 0.6, 0.9, 0.97, 0.99)
CIRCLE_STEPS = 5 * 13 * 17 * 29  # the radius of a circle with many points of whole coordinates


def small_integers(n: int, rng: Generator) -> Points:
    """On a small square of integers: most circles hold more than three points."""
    return rng.integers(-4, 5, (n, 2)) * 1.0


def on_one_circle(n: int, rng: Generator) -> Points:
    """Exactly on a circle, whole coordinates, on any scale and perhaps moved."""
    on_circle = _circle_points()
    points = on_circle[rng.integers(0, len(on_circle), n)] + rng.integers(0, 2) * CIRCLE_STEPS
    return points * 2.0 ** rng.integers(-1000, 950)


def near_one_circle(n: int, rng: Generator) -> Points:
    """On a circle up to rounding."""
    return polar(rng.uniform(0.5, 2), rng.uniform(0, 2 * np.pi, n)) + rng.integers(-1, 2, 2)


def every_exponent(n: int, rng: Generator) -> Points:
    """Each coordinate of any magnitude that a double has."""
    exponents = rng.uniform(LEAST_EXPONENT, MOST_EXPONENT, (n, 2))
    return rng.choice((-1.0, 1.0), (n, 2)) * 10.0**exponents


def one_exponent(n: int, rng: Generator) -> Points:
    """All coordinates of one magnitude, each axis its own, from denormals to the largest."""
    return (rng.random((n, 2)) - 0.5) * 10.0 ** rng.uniform(LEAST_EXPONENT, MOST_EXPONENT, 2)


def powers_of_two(n: int, rng: Generator) -> Points:
    """Powers of two and zeros."""
    signs = rng.integers(-1, 2, (n, 2))
    return signs * 2.0 ** rng.integers(-1074, 1024, (n, 2))


def near_a_line(n: int, rng: Generator) -> Points:
    """On a line, up to the last bit of y."""
    x = rng.uniform(-1, 1, n)
    y = x * rng.uniform(0.1, 1)
    return np.column_stack((x, y + rng.integers(-1, 2, n) * np.spacing(y)))


def huge_and_denormal(n: int, rng: Generator) -> Points:
    """A hexagonal lattice with huge x and denormal y."""
    side = int(np.ceil(np.sqrt(n)))
    points = hexagonal(side * side, rng)[:n]
    return np.round(points * 2) * (1e300, 5e-324)


def clustered(n: int, rng: Generator) -> Points:
    """A few tiny clusters far apart."""
    centers = rng.integers(-3, 4, (1 + n // 20, 2))
    return centers[rng.integers(0, len(centers), n)] + rng.random((n, 2)) * 1e-12


def single_precision(n: int, rng: Generator) -> Points:
    """Uniform, rounded to float32."""
    return rng.random((n, 2)).astype(np.float32).astype(np.float64)


KINDS: dict[str, Kind] = {
    kind.__name__.replace("_", "-"): kind
    for kind in (
        uniform,
        small_integers,
        on_one_circle,
        near_one_circle,
        every_exponent,
        one_exponent,
        powers_of_two,
        near_a_line,
        huge_and_denormal,
        clustered,
        two_columns,
        single_precision,
    )
}


def small_set(kind: Kind, rng: Generator, *, least: int = 3, most: int = 100) -> Points:
    """Draw a set of `least` to `most` rows, some of which may be duplicates."""
    n = int(rng.integers(least, most + 1))
    share = rng.choice(SHARES_OF_DUPLICATES)
    distinct = max(1, round(n * (1 - share)))
    points = kind(distinct, rng)
    rows = np.concatenate((np.arange(len(points)), rng.integers(0, len(points), n - len(points))))
    points = points[rng.permutation(rows)]
    negative = (points == 0) & (rng.random(points.shape) < 0.5)
    return np.where(negative, -0.0, points)


def _circle_points() -> Points:
    """All points of whole coordinates on the circle, from its sums of two squares."""
    x = np.arange(-CIRCLE_STEPS, CIRCLE_STEPS + 1)
    square = CIRCLE_STEPS**2 - x**2
    y = np.rint(np.sqrt(square)).astype(np.int64)
    x, y = x[y * y == square], y[y * y == square]
    return np.unique(np.concatenate([np.column_stack((x, side * y)) for side in (1, -1)]), axis=0)
