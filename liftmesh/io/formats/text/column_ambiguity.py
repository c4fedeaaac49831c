"""What only the values of a table suggest: an id before the coordinates, a value for missing ones.

Nothing of it is applied, because it may be wrong; nor is it ignored, because the points would be.
Such a table is refused with both readings and the option that chooses one.

Numbers of rows are whole and grow by one from row to row. Ids are whole and all different; in
another order than that of the rows they look like a coordinate that was rounded, so they count as
ids only where the two columns beside them hold fractions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError, Option
from liftmesh.io.columns import POSITION
from liftmesh.io.options import MOST_LISTED, Outliers, TableOptions, spelled

if TYPE_CHECKING:
    from liftmesh.io.formats.text.columns import Columns


_PIECE = 1 << 10  # rows
_LEAST_ROWS = 3  # fewer make no triangle, and no series
_MOST_SEEN = 1 << 14  # rows that are compared with each other


class ColumnAmbiguity:
    """Examines the rows of a table, block by block, for what they may be besides points."""

    def __init__(self, name: str, columns: Columns, options: TableOptions) -> None:
        self._name = name
        self._width = len(columns.names)
        unnamed = not columns.said and self._width >= len(POSITION)
        self._ids = Ids(among_more=self._width > len(POSITION)) if unnamed else None
        self._heights = RowNumbers() if unnamed and "z" in columns.names else None
        places = {part: columns.names.index(part) for part in POSITION if part in columns.names}
        self._outliers = {
            part: Outliers(k) for part, k in places.items() if options.missing is None
        }

    def examine(self, table: Floats) -> None:
        """Examine further rows."""
        if self._ids is not None:
            self._ids.examine(table[:, 0], table[:, 1:3])
        if self._heights is not None:
            self._heights.examine(table[:, 2], table[:, :2])
        for each in self._outliers.values():
            each.examine(table)

    def check(self) -> None:
        """Raise for what the rows suggest, once all are examined."""
        for part, each in self._outliers.items():
            each.check(f"{self._name}: {part}", "rows")
        if self._ids is not None and self._ids.suspect:
            raise FormatError(
                f"{self._name}: there is no header, and the first column holds {self._ids}, x or "
                f"an id: if an id, {named_points(self._width)}, if x, with "
                f"{Option('columns', _names(POSITION, self._width))}"
            )
        if self._heights is not None and self._heights.suspect:
            raise FormatError(
                f"{self._name}: there is no header, and the third column holds {self._heights}, z "
                "or an id: if an id, and there are no heights, read it with "
                f"{Option('columns', _names(('x', 'y', 'id'), self._width))}, if z, with "
                f"{Option('columns', _names(POSITION, self._width))}"
            )


def named_points(width: int) -> str:
    """Say how to read a table whose first column is an id."""
    usual, swapped = (_names(("id", *order), width) for order in ("xyz", "yxz"))
    return f"read it with {Option('columns', usual)} (or '{swapped}' if northing comes first)"


def _names(first: Sequence[str], width: int) -> str:
    """Return names of columns as an option: all, or the coordinates of a wide table."""
    if width > MOST_LISTED:
        return ",".join(f"{part}={k}" for k, part in enumerate(first, 1) if part in POSITION)
    rest = (f"column_{k}" for k in range(len(first) + 1, width + 1))
    return ",".join([*first[:width], *rest])


def check_count(first: str, second: str, where: str, header: Sequence[str] = ()) -> None:
    """Raise if the first line is a number by itself, as a count of rows is, before longer lines."""
    if first.isdecimal() and second and not second.isdecimal():
        line = where.rpartition(" ")[2]
        columns = spelled(header) or f"{Option('columns', ...)} with the names above it"
        names = f" and {columns}" if header else ""
        raise FormatError(
            f"{where} is the number {first[:20]} by itself, a count of rows or a broken row: if it "
            f"is no row, read it with {Option('skip_rows', int(line))}{names}"
        )


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
        self._among_more = among_more  # more than three columns: else ids leave no height
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
