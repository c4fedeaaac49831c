"""Point sets on which tiles are tried: those of the benchmarks, and some that surveys bring.

Used by `scripts/bench.py tiles`, `scripts/fuzz_tiles.py` and the tests.
"""

from __future__ import annotations

import numpy as np
from distributions import DISTRIBUTIONS, UTM_ORIGIN, Distribution, Points
from numpy.random import Generator


def scan_lines(n: int, rng: Generator) -> Points:
    """Lines twenty times as far apart as the points on them, as a line scanner leaves them."""
    count = max(1, round((n / 20) ** 0.5))
    per_line = -(-n // count)
    along = np.arange(per_line) + rng.uniform(0, 0.5, (count, per_line))
    across = 20.0 * np.arange(count)[:, None] + rng.normal(0, 0.05, (count, per_line))
    return rng.permutation(np.stack((along, across), axis=2).reshape(-1, 2))[:n]


def strips_with_lakes(n: int, rng: Generator) -> Points:
    """Overlapping strips of an airborne survey in centimetres, without echoes from round lakes."""
    side = (n / 4) ** 0.5  # in metres, at some four points a square metre
    strips = max(2, round(side / 40))
    strip = rng.integers(0, strips, 2 * n)
    width = side / strips
    x = (strip + rng.uniform(-0.1, 1.1, 2 * n)) * width
    points = np.column_stack((x, rng.uniform(0, side, 2 * n)))
    lakes, radii = rng.uniform(0, side, (8, 2)), rng.uniform(0.02, 0.12, 8) * side
    for lake, radius in zip(lakes, radii, strict=True):
        points = points[np.hypot(*(points - lake).T) > radius]
    return np.round(points[:n] + UTM_ORIGIN, 2)


def mixed_magnitudes(n: int, rng: Generator) -> Points:
    """Coordinates from the least to the greatest doubles, of either sign."""
    signs = rng.choice([-1.0, 1.0], (n, 2))
    return signs * np.ldexp(rng.uniform(0.5, 1, (n, 2)), rng.integers(-1074, 1023, (n, 2)))


FAMILIES: dict[str, Distribution] = {
    **DISTRIBUTIONS,
    **{
        generate.__name__.replace("_", "-"): generate
        for generate in (scan_lines, strips_with_lakes, mixed_magnitudes)
    },
}
