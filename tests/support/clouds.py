"""Point families that are hard on exactness: lattices of single ulps, the ends of the exponent
range, exactly cocircular integers, runs on a line, duplicates.

`FAMILIES` holds them together with the even distributions of ``scripts/distributions.py``. A
family takes a size and a random generator and returns an (n, 2) float64 array of about that size,
which may contain equal rows.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from distributions import DISTRIBUTIONS, SMALLEST_STEP, Distribution, Points, lattice
from numpy.random import Generator
from numpy.typing import NDArray

ULP = 2.0**-52


@cache
def on_radius_325() -> Points:
    """Find the sixty integer points at distance 325 from the origin."""
    x, y = np.indices((651, 651)) - 325
    return np.argwhere(x * x + y * y == 325 * 325) - 325.0


def integer_circle(n: int, rng: Generator) -> Points:
    """Integers at distance 325 from the origin, exactly: all sixty of them, or fewer."""
    return rng.permutation(on_radius_325())[:n]


def integer_circles(n: int, rng: Generator) -> Points:
    """Several exact circles around one centre, which is a point too."""
    rings = [integer_circle(n, rng) * scale for scale in (1, 2, 3)]
    return rng.permutation(np.vstack((*rings, [[0.0, 0.0]])))[:n]


def near_collinear(n: int, rng: Generator) -> Points:
    """Within four ulps of the line y = x."""
    x = rng.uniform(0.5, 1, n)
    return np.column_stack((x, x + rng.integers(-4, 5, n) * ULP))


def collinear_runs(n: int, rng: Generator) -> Points:
    """On three exact lines that cross in one point."""
    step = rng.permutation(3 * n)[:n].astype(np.float64)
    directions = np.array([[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    return step[:, None] * directions[rng.integers(0, 3, n)]


def short_line_and_apex(n: int, rng: Generator) -> Points:
    """All on one line but a single point."""
    line = np.column_stack((np.arange(n - 1.0), np.zeros(n - 1)))
    return rng.permutation(np.vstack((line, [[n / 3, 1.0]])))


def ulp_lattice(n: int, rng: Generator) -> Points:
    """Steps of one ulp around (1, 1)."""
    return 1 + lattice(n, rng) * ULP


def ulp_noise(n: int, rng: Generator) -> Points:
    """An ordinary lattice, each coordinate off by up to two ulps."""
    points = lattice(n, rng) + 1
    return points + rng.integers(-2, 3, points.shape) * np.spacing(points)


def denormal_lattice(n: int, rng: Generator) -> Points:
    """Whole multiples of the smallest double."""
    return lattice(n, rng) * SMALLEST_STEP


def smallest_steps(n: int, rng: Generator) -> Points:
    """Steps of 2^-1074 across the border between denormal and normal doubles."""
    return 2.0**-1022 + (lattice(n, rng) - 5) * SMALLEST_STEP


def huge(n: int, rng: Generator) -> Points:
    """Coordinates of about 1e300."""
    return rng.uniform(-1e300, 1e300, (n, 2))


def huge_lattice(n: int, rng: Generator) -> Points:
    """A lattice whose differences overflow: it spans all finite doubles."""
    points = lattice(n, rng)
    return (points / max(points.max(), 1.0) - 0.5) * 2.0 * np.finfo(np.float64).max


def tiny(n: int, rng: Generator) -> Points:
    """Coordinates of about 1e-300."""
    return rng.uniform(-1e-300, 1e-300, (n, 2))


def mixed_magnitudes(n: int, rng: Generator) -> Points:
    """Any finite double: sign, exponent and mantissa drawn apart."""
    mantissa = rng.uniform(0.5, 1, (n, 2)) * rng.choice([-1.0, 1.0], (n, 2))
    return np.ldexp(mantissa, rng.integers(-1074, 1025, (n, 2)))


def mixed_lattices(n: int, rng: Generator) -> Points:
    """Small integers, each row scaled by its own power of two: collinear across magnitudes."""
    points = rng.integers(-2, 3, (n, 2)).astype(np.float64)
    return np.ldexp(points, rng.choice([-1074, -500, 0, 500, 1020], (n, 1)))


def far_offset(n: int, rng: Generator) -> Points:
    """Uniform, moved by 1e15: what is left is a lattice of one eighth."""
    return rng.uniform(0, np.sqrt(n), (n, 2)) + np.array([1e15, -1e15])


def far_lattice(n: int, rng: Generator) -> Points:
    """A lattice of one eighth at 1e15."""
    return lattice(n, rng) / 8 + (1e15, 1e15)


def duplicates(n: int, rng: Generator) -> Points:
    """Few positions, many rows, and zeros of both signs."""
    points = rng.integers(-2, 3, (n, 2)).astype(np.float64)
    return np.where(points == 0, rng.choice([0.0, -0.0], (n, 2)), points)


def small_integers(n: int, rng: Generator) -> Points:
    """Integers of a narrow range: every kind of coincidence at once."""
    return rng.integers(0, max(2, int(n**0.6)), (n, 2)).astype(np.float64)


HARD: dict[str, Distribution] = {
    generate.__name__.replace("_", "-"): generate
    for generate in (
        integer_circle,
        integer_circles,
        near_collinear,
        collinear_runs,
        short_line_and_apex,
        ulp_lattice,
        ulp_noise,
        denormal_lattice,
        smallest_steps,
        huge,
        huge_lattice,
        tiny,
        mixed_magnitudes,
        mixed_lattices,
        far_offset,
        far_lattice,
        duplicates,
        small_integers,
    )
}
FAMILIES: dict[str, Distribution] = {**DISTRIBUTIONS, **HARD}


def nearly_cocircular(shape: tuple[int, ...], rng: Generator) -> NDArray[np.float64]:
    """Rounded points of a circle, far from the origin, some moved by an ulp."""
    angle = rng.uniform(0, 2 * np.pi, shape[:-1])
    center = rng.choice([0.0, 1.0, 1e3, 5.2e6, 1e15], (shape[0],) + (1,) * (len(shape) - 1))
    points = center + np.stack((np.cos(angle), np.sin(angle)), axis=-1) * 7.25
    return points + rng.integers(-1, 2, shape) * np.spacing(points)
