"""The files that every build computes with: points of all kinds, and numbers as text.

They are made once, so that nothing depends on the mathematical functions of another machine.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from distributions import DISTRIBUTIONS, Points
from numpy.random import Generator
from small_sets import KINDS, small_set

SEED = 20


def write_files(folder: Path, rows: int, sets: int) -> list[Path]:
    """Write a file of each distribution and of each kind of small sets, and the numbers."""
    rng = np.random.default_rng(SEED)
    files = [
        written(folder / name, [generate(rows, rng)]) for name, generate in DISTRIBUTIONS.items()
    ]
    for name, kind in KINDS.items():
        small = [small_set(kind, rng) for _ in range(sets)]
        files.append(written(folder / f"small-sets-{name}", small))
    numbers = folder / "numbers.txt"
    numbers.write_text("\n".join(decimals(sets * 100, rng)) + "\n")
    return [*files, numbers]


def written(path: Path, sets: list[Points]) -> Path:
    """Write sets one after the other, each behind the number of its rows."""
    np.concatenate([[len(points), *points.ravel()] for points in sets]).tofile(path)
    return path


def decimals(count: int, rng: Generator) -> list[str]:
    """Decimals of 1 to 40 digits and all exponents, and values halfway between two doubles."""
    exponents = rng.integers(-345, 308, count)
    lengths = rng.integers(1, 41, count)
    digits = rng.integers(0, 10, (count, 40)).astype(str)
    drawn = [
        f"{'-' * (i % 2)}{''.join(digits[i, : lengths[i]])}e{exponents[i] - lengths[i] + 1}"
        for i in range(count)
    ]
    doubles = rng.integers(1, 0x7FE0_0000_0000_0000, count // 10).view(np.float64)
    with np.errstate(over="ignore"):
        pairs = zip(doubles.tolist(), np.nextafter(doubles, np.inf).tolist(), strict=True)
    return drawn + [halfway(low, high) for low, high in pairs if abs(low) > 1e-100]


def halfway(low: float, high: float) -> str:
    """Write the value in the middle of two doubles, with all of its digits."""
    (over, under), (over_high, under_high) = low.as_integer_ratio(), high.as_integer_ratio()
    scale = max(under, under_high)  # powers of two
    middle = over * (scale // under) + over_high * (scale // under_high)
    places = (2 * scale).bit_length() - 1
    return f"{middle * 5**places}e-{places}"
