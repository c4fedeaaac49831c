"""Marks of missing values among numbers, in tables and rasters that do not say which they have.

A value counts as one if programs use it as one (-9999, -32768, the ends of single precision), and
if it stands apart from all others: by more than an eighth of their range, or because there are
none. It is not left out by a guess, but refused with both readings.
"""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.options import refused
from liftmesh.errors import FormatError, Option

Missing: TypeAlias = float | str | None

_LOW, _HIGH = -999.0, 1e19  # all of the following are beyond
_SENTINELS = (
    *(-999.0, -999.9, -9999.0, -9999.9, -9999.99, -9999.999, -99999.0, -999999.0),
    *(-32767.0, -32768.0, -2147483648.0, 1e20, 1e30, 1e38, 1.70141e38),
    *(-3.4028234663852886e38, -3.40282346638529e38, -3.402823466e38, -3.4028235e38),
    *(-3.402823e38, -3.40282e38, 3.4028234663852886e38, 3.4028235e38, -1.7976931348623157e308),
)
_APART = 8  # parts of the range of the other values


class Outliers:
    """The known marks of missing values in a column, and the range of its other values."""

    def __init__(self, column: int) -> None:
        self.counts: dict[float, int] = {}
        self.rows = 0
        self._column = column
        self._low, self._high = np.inf, -np.inf

    def examine(self, table: Floats) -> None:
        """Examine further rows."""
        column = table[:, self._column]
        self.rows += len(column)
        low, high = column.min(initial=np.inf), column.max(initial=-np.inf)
        if not (low > _LOW and high < _HIGH):  # as most are, and no NaN among them
            self._count(column)
            column = column[np.isfinite(column) & ~np.isin(column, _SENTINELS)]
            low, high = column.min(initial=np.inf), column.max(initial=-np.inf)
        self._low, self._high = min(self._low, float(low)), max(self._high, float(high))

    def _count(self, column: Floats) -> None:
        values, counts = np.unique(column[np.isin(column, _SENTINELS)], return_counts=True)
        for value, count in zip(values.tolist(), counts.tolist(), strict=True):
            self.counts[value] = self.counts.get(value, 0) + count

    @property
    def has_others(self) -> bool:
        """Whether the column holds other values than marks."""
        return self._low <= self._high

    def check(self, what: str, rows: str) -> None:
        """Raise for a mark that stands apart from all other values, once all are examined."""
        if (value := self._found()) is None:
            return
        shown = f"{value:.0f}" if value == int(value) and abs(value) < 1e15 else repr(value)
        apart = "far from all others, " if self.has_others else ""
        raise FormatError(
            f"{what} is {shown} in {self.counts[value]:,} of {self.rows:,} {rows}, {apart}a value "
            f"or the mark of a missing one: read it with {Option('nodata', shown)} if it is "
            f"missing there, or with {Option('nodata', 'none')}"
        )

    def _found(self) -> float | None:
        """Return the mark that stands apart from all other values; None if there is none."""
        spread = (self._high - self._low) / _APART
        gaps = {each: max(self._low - each, each - self._high) for each in self.counts}
        return next((each for each, gap in gaps.items() if gap > spread), None)


def as_missing(value: Any) -> tuple[float | str, ...] | None:
    """Return what stands for missing values: as a number if it is one, in any notation."""
    if value is None or value == "none":
        return None if value is None else ()
    try:
        number = math.nan if isinstance(value, bool | bytes) else float(value)
    except (TypeError, ValueError):
        if isinstance(value, str) and value.strip():
            return (value.strip(),)
        number = math.nan
    if math.isnan(number):
        remedy = "give the number or the text that stands for a missing value, or 'none' if there"
        raise refused("nodata", value, f"{remedy} is none")
    return (number,)
