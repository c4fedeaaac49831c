"""Scales and offsets: how coordinates in double precision become the whole numbers of LAS.

A file of LAS holds a coordinate as ``number * scale + offset`` with a number of 32 bits. Those of
the file that was read come first: they give its numbers back. Else the scale is the coarsest power
of ten that loses no decimal of any coordinate, or, if none does, the finest that 32 bits allow.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Array, Floats

_MOST = 2**31 - 1
_ROWS = 1 << 18  # converted at a time
_SAMPLE = 512
_FINEST = -9  # decimals that are tried
_SMALLEST = 5e-324
_ULPS = 8  # by which a decimal and number * scale may differ


@dataclass(frozen=True, slots=True)
class ScaleOffset:
    """Scale and offset of a coordinate, and whether they give back every bit of it."""

    scale: float
    offset: float
    exact: bool = True
    near: bool = True

    def numbers(self, values: Floats) -> Array:
        """Convert coordinates to whole numbers."""
        with np.errstate(over="ignore", invalid="ignore", under="ignore", divide="ignore"):
            return np.rint((values - self.offset) / self.scale)

    def coordinates(self, numbers: Array) -> Floats:
        """Convert whole numbers to coordinates, as readers do."""
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            found: Floats = numbers * self.scale + self.offset
            return found


def steps_of(values: Floats, known: tuple[float, float] | None) -> ScaleOffset:
    """Choose scale and offset of a coordinate."""
    if known is not None and (found := _tried(values, ScaleOffset(*known))):
        return found
    if not len(values):
        return ScaleOffset(0.01, 0.0)
    low, high = float(values.min()), float(values.max())
    middle = low if low == high else low / 2 + high / 2
    for decimals in range(0, _FINEST - 1, -1):
        scale = float(f"1e{decimals}")
        offset = 0.0 if max(-low, high) <= scale * _MOST else float(np.rint(middle))
        if found := _tried(values, ScaleOffset(scale, offset)):
            return found
    half = 0.0 if low == high else max(high / 2 - low / 2, _SMALLEST)
    return _finest(values, middle, half)


def _tried(values: Floats, steps: ScaleOffset) -> ScaleOffset | None:
    """Return the steps if they lose no decimal, or nothing."""
    exact = True
    size = float(values.max() / 2 - values.min() / 2) if len(values) else 0.0
    for part in _parts(values):
        numbers = steps.numbers(part)
        if not (np.abs(numbers) <= _MOST).all():
            return None
        again = steps.coordinates(numbers)
        if (again.view(np.int64) == part.view(np.int64)).all():
            continue
        exact = False
        if not _near(again, part, steps, size):
            return None
    return ScaleOffset(steps.scale, steps.offset, exact)


def _near(again: Floats, values: Floats, steps: ScaleOffset, size: float) -> bool:
    """Whether two decimals are the same but for the rounding of binary numbers."""
    with np.errstate(over="ignore", invalid="ignore"):
        ulps = _ULPS * np.spacing(np.abs(values) + abs(steps.offset))
        allowed = np.minimum(ulps, min(abs(steps.scale) / 1000, size / 1e7))
        return bool((np.abs(again - values) <= allowed).all())


def _parts(values: Floats) -> Iterator[Floats]:
    """Yield a few values first, by which most scales are refused, then all in blocks."""
    yield np.ascontiguousarray(values[:: max(len(values) // _SAMPLE, 1)])
    for start in range(0, len(values), _ROWS):
        yield np.ascontiguousarray(values[start : start + _ROWS])


def _finest(values: Floats, middle: float, half: float) -> ScaleOffset:
    """Return the finest power of ten that reaches from the middle to both ends."""
    if half == 0.0:
        is_exact = _is_exact(values, ScaleOffset(0.01, middle))
        return ScaleOffset(0.01, middle, is_exact, is_exact)
    exponent = math.ceil(math.log10(half) - math.log10(_MOST))
    for power in (exponent, exponent + 1):  # the offset is rounded
        steps = ScaleOffset(max(float(f"1e{power}"), _SMALLEST), middle)
        if all((np.abs(steps.numbers(part)) <= _MOST).all() for part in _parts(values)):
            break
    exact = _is_exact(values, steps)
    return ScaleOffset(steps.scale, steps.offset, exact, exact)


def _is_exact(values: Floats, steps: ScaleOffset) -> bool:
    return all(
        (steps.coordinates(steps.numbers(part)).view(np.int64) == part.view(np.int64)).all()
        for part in _parts(values)
    )
