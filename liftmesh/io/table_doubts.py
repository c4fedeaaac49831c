"""What only the values of a table suggest: an id before the coordinates, a value for missing ones.

Nothing of it is applied, because it may be wrong; nor is it ignored, because the points would be.
Such a table is refused with both readings and the option that chooses one.

A first column without a name counts as an id if it holds whole numbers that grow by one from row to
row, or that grow while the next two columns hold fractions. A coordinate counts as a missing value
if programs use it as one (-9999, -32768, the ends of single precision), and if it is further from
all others than these are from each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError
from liftmesh.io.columns import POSITION

if TYPE_CHECKING:
    from liftmesh.io.table_columns import Columns
    from liftmesh.io.table_options import TableOptions

_LOW, _HIGH = -999.0, 1e19  # all of the following are beyond
_SENTINELS = (
    *(-999.0, -999.9, -9999.0, -9999.9, -9999.99, -9999.999, -99999.0, -999999.0),
    *(-32767.0, -32768.0, -2147483648.0, 1e20, 1e30, 1e38, 1.70141e38),
    *(-3.4028234663852886e38, -3.40282346638529e38, -3.402823466e38, -3.4028235e38),
    *(-3.402823e38, -3.40282e38, 3.4028234663852886e38, 3.4028235e38, -1.7976931348623157e308),
)
_MOST_LISTED = 12  # columns
_PIECE = 1 << 10  # rows
_LEAST_ROWS = 3  # fewer make no triangle, and no series


def named_points(width: int) -> str:
    """Say how to read a table whose first column is an id.

    >>> named_points(4)
    "read it with columns='id,x,y,z' (or 'id,y,x,z' if northing comes first)"
    """
    usual, swapped = (_names(("id", *order), width) for order in ("xyz", "yxz"))
    return f"read it with columns='{usual}' (or '{swapped}' if northing comes first)"


def _names(first: Sequence[str], width: int) -> str:
    """Return names of columns as an option: of all columns, or of the coordinates of a wide table.

    >>> _names(["id", "x", "y", "z"], 5), _names(["id", "x", "y", "z"], 50)
    ('id,x,y,z,column_5', 'x=2,y=3,z=4')
    """
    if width > _MOST_LISTED:
        return ",".join(f"{part}={k}" for k, part in enumerate(first, 1) if part in POSITION)
    rest = (f"column_{k}" for k in range(len(first) + 1, width + 1))
    return ",".join([*first[:width], *rest])


def check_count(first: str, second: str, where: str) -> None:
    """Raise if the first line is a number by itself, as a count of rows is, before longer lines.

    >>> check_count("2", "0.5 1.5 7", "a.xyz: line 1")
    Traceback (most recent call last):
    ...
    liftmesh.errors.FormatError: a.xyz: line 1 is the number 2 by itself, a count of rows or a\
 broken row: if it is no row, read it with skip_rows=1
    """
    if first.isdecimal() and second and not second.isdecimal():
        line = where.rpartition(" ")[2]
        raise FormatError(
            f"{where} is the number {first[:20]} by itself, a count of rows or a broken row: if it "
            f"is no row, read it with skip_rows={line}"
        )


class Doubts:
    """Examines the rows of a table, block by block, for what they may be besides points.

    Parameters
    ----------
    name : str
        The table for messages.
    columns : Columns
        What its columns are.
    options : TableOptions
        What the caller says: there is no doubt about that.
    """

    def __init__(self, name: str, columns: Columns, options: TableOptions) -> None:
        self._name = name
        self._width = len(columns.names)
        self._ids = None if columns.said or self._width < 3 else _Ids(self._width)
        places = {part: columns.names.index(part) for part in POSITION if part in columns.names}
        self._outliers = {
            part: _Outliers(k) for part, k in places.items() if options.missing is None
        }

    def examine(self, table: Floats) -> None:
        """Examine further rows."""
        if self._ids is not None:
            self._ids.examine(table)
        for each in self._outliers.values():
            each.examine(table)

    def check(self) -> None:
        """Raise for what the rows suggest, once all are examined."""
        for part, each in self._outliers.items():
            if (value := each.found()) is not None:
                shown = f"{value:.0f}" if value == int(value) and abs(value) < 1e15 else repr(value)
                raise FormatError(
                    f"{self._name}: {part} is {shown} in {each.counts[value]:,} of {each.rows:,} "
                    "rows, far from all others, a value or the mark of a missing one: read it with "
                    f"nodata='{shown}' if it is missing there, or with nodata='none'"
                )
        if self._ids is not None and self._ids.suspect:
            raise FormatError(
                f"{self._name}: there is no header, and the first column holds whole numbers that "
                f"grow from {self._ids.first:.0f} to {self._ids.last:.0f}, x or an id: if an id, "
                f"{named_points(self._width)}, if x, with "
                f"columns='{_names(POSITION, self._width)}'"
            )


class _Ids:
    """Whether the first column grows as an id does."""

    def __init__(self, width: int) -> None:
        self.first = self.last = np.nan
        self._rows = 0
        self._has_more = width > len(POSITION)
        self._by_one = self._grows = True
        self._whole = np.ones(2, dtype=np.bool_)

    @property
    def suspect(self) -> bool:
        """Whether the rows examined suggest an id: of three columns, both signs are needed."""
        fractions = not self._whole.any()
        enough = self._by_one or fractions if self._has_more else self._by_one and fractions
        return self._rows >= _LEAST_ROWS and self._grows and enough

    def examine(self, table: Floats) -> None:
        """Examine further rows; the first ones that hold no ids end it."""
        for start in range(0, len(table), _PIECE):
            if not self._grows:
                return
            self._examine(table[start : start + _PIECE])

    def _examine(self, table: Floats) -> None:
        column = table[:, 0]
        with np.errstate(invalid="ignore", over="ignore"):  # of what is no id anyway
            steps = np.diff(column, prepend=self.last if self._rows else column[0] - 1)
            self._grows = bool(((column == np.rint(column)) & (steps > 0)).all())
        self._by_one = self._by_one and bool((steps == 1).all())
        self._whole &= (table[:, 1:3] == np.rint(table[:, 1:3])).all(axis=0)
        self.first = self.first if self._rows else float(column[0])
        self.last = float(column[-1])
        self._rows += len(table)


class _Outliers:
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

    def found(self) -> float | None:
        """Return the mark that is far from all other values; None if there is none."""
        if not self._low <= self._high:
            return None
        spread = self._high - self._low
        far = (max(self._low - each, each - self._high) > spread for each in self.counts)
        return next((each for each, is_far in zip(self.counts, far, strict=True) if is_far), None)
