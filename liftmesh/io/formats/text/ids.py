"""Columns of a table that may be ids, or count its rows, although no name says so.

Numbers of rows are whole and grow by one from row to row. Ids are whole and all different; in
another order than that of the rows they look like a coordinate that was rounded, so they count as
ids only where the two columns beside them hold fractions.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Floats

_PIECE = 1 << 10  # rows
_LEAST_ROWS = 3  # fewer make no triangle, and no series
_MOST_SEEN = 1 << 14  # rows that are compared with each other


class RowNumbers:
    """Whether a column numbers the rows, while two others hold fractions."""

    def __init__(self) -> None:
        self._by_one = self._grows = True
        self._first = self._last = np.nan
        self._rows = 0
        self._others_whole = np.ones(2, dtype=np.bool_)

    def __str__(self) -> str:
        how = "grow" if self._grows else "are all different,"
        return f"whole numbers that {how} from {self._first:.0f} to {self._last:.0f}"

    @property
    def suspect(self) -> bool:
        """Whether the rows examined suggest it."""
        return self._rows >= _LEAST_ROWS and self._by_one and self._beside_fractions

    @property
    def _beside_fractions(self) -> bool:
        return not self._others_whole.any()

    @property
    def _is_open(self) -> bool:
        """Whether further rows can make a difference."""
        return self._by_one

    def examine(self, column: Floats, others: Floats) -> None:
        """Examine further rows of a column and of two others, unless the first ones decided."""
        for start in range(0, len(column), _PIECE):
            if not self._is_open:
                return
            self._examine(column[start : start + _PIECE], others[start : start + _PIECE])

    def _examine(self, column: Floats, others: Floats) -> None:
        with np.errstate(invalid="ignore", over="ignore"):  # of what numbers no rows anyway
            steps = np.diff(column, prepend=self._last if self._rows else column[0] - 1)
        self._grows = self._grows and bool((steps > 0).all())
        self._by_one = self._by_one and bool((steps == 1).all() and column[0] == np.rint(column[0]))
        self._others_whole &= ((others == np.rint(others)) | np.isnan(others)).all(axis=0)
        self._first = self._first if self._rows else float(column[0])
        self._last = float(column[-1])
        self._rows += len(column)


class Ids(RowNumbers):
    """Whether the first column holds ids."""

    def __init__(self, *, among_more: bool) -> None:
        super().__init__()
        self._among_more = among_more
        self._seen: set[float] = set()
        self._differ = True

    @property
    def suspect(self) -> bool:
        """Whether the rows examined suggest it."""
        if not self._among_more:
            return super().suspect
        enough = self._by_one or self._beside_fractions
        return self._rows >= _LEAST_ROWS and self._differ and enough

    @property
    def _is_open(self) -> bool:
        return self._differ if self._among_more else self._by_one

    def _examine(self, column: Floats, others: Floats) -> None:
        super()._examine(column, others)
        self._differ = self._differ and bool((column == np.rint(column)).all())
        if self._among_more and len(self._seen) < _MOST_SEEN:
            expected = len(self._seen) + len(column)
            self._seen.update(column.tolist())
            self._differ = self._differ and len(self._seen) == expected
