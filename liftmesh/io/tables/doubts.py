"""What only the values of a table suggest: an id before the coordinates, a value for missing ones.

Nothing of it is applied, because it may be wrong; nor is it ignored, because the points would be.
Such a table is refused with both readings and the option that chooses one.

What counts as an id, `ids` says. A coordinate counts as a missing value if programs use it as
one (-9999, -32768, the ends of single precision), and if it stands apart from all others: by more
than an eighth of their range, or because there are none.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError
from liftmesh.io.columns import POSITION
from liftmesh.io.tables.ids import Ids, RowNumbers
from liftmesh.io.tables.options import MOST_LISTED, spelled

if TYPE_CHECKING:
    from liftmesh.io.tables.columns import Columns
    from liftmesh.io.tables.options import TableOptions

_LOW, _HIGH = -999.0, 1e19  # all of the following are beyond
_SENTINELS = (
    *(-999.0, -999.9, -9999.0, -9999.9, -9999.99, -9999.999, -99999.0, -999999.0),
    *(-32767.0, -32768.0, -2147483648.0, 1e20, 1e30, 1e38, 1.70141e38),
    *(-3.4028234663852886e38, -3.40282346638529e38, -3.402823466e38, -3.4028235e38),
    *(-3.402823e38, -3.40282e38, 3.4028234663852886e38, 3.4028235e38, -1.7976931348623157e308),
)
_APART = 8  # parts of the range of the other values


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
    if width > MOST_LISTED:
        return ",".join(f"{part}={k}" for k, part in enumerate(first, 1) if part in POSITION)
    rest = (f"column_{k}" for k in range(len(first) + 1, width + 1))
    return ",".join([*first[:width], *rest])


def check_count(first: str, second: str, where: str, header: Sequence[str] = ()) -> None:
    """Raise if the first line is a number by itself, as a count of rows is, before longer lines.

    A header before it would be skipped as well: the message names its columns.

    >>> check_count("2", "0.5 1.5 7", "a.xyz: line 1")
    Traceback (most recent call last):
    ...
    liftmesh.errors.FormatError: a.xyz: line 1 is the number 2 by itself, a count of rows or a\
 broken row: if it is no row, read it with skip_rows=1
    """
    if first.isdecimal() and second and not second.isdecimal():
        line = where.rpartition(" ")[2]
        names = f" and {spelled(header) or 'columns= with the names above it'}" if header else ""
        raise FormatError(
            f"{where} is the number {first[:20]} by itself, a count of rows or a broken row: if it "
            f"is no row, read it with skip_rows={line}{names}"
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
        unnamed = not columns.said and self._width >= len(POSITION)
        self._ids = Ids(among_more=self._width > len(POSITION)) if unnamed else None
        self._heights = RowNumbers() if unnamed and "z" in columns.names else None
        places = {part: columns.names.index(part) for part in POSITION if part in columns.names}
        self._outliers = {
            part: _Outliers(k) for part, k in places.items() if options.missing is None
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
            if (value := each.found()) is not None:
                shown = f"{value:.0f}" if value == int(value) and abs(value) < 1e15 else repr(value)
                apart = "far from all others, " if each.has_others else ""
                raise FormatError(
                    f"{self._name}: {part} is {shown} in {each.counts[value]:,} of {each.rows:,} "
                    f"rows, {apart}a value or the mark of a missing one: read it with "
                    f"nodata='{shown}' if it is missing there, or with nodata='none'"
                )
        if self._ids is not None and self._ids.suspect:
            raise FormatError(
                f"{self._name}: there is no header, and the first column holds {self._ids}, x or "
                f"an id: if an id, {named_points(self._width)}, if x, with "
                f"columns='{_names(POSITION, self._width)}'"
            )
        if self._heights is not None and self._heights.suspect:
            raise FormatError(
                f"{self._name}: there is no header, and the third column holds {self._heights}, z "
                "or an id: if an id, and there are no heights, read it with "
                f"columns='{_names(('x', 'y', 'id'), self._width)}', if z, with "
                f"columns='{_names(POSITION, self._width)}'"
            )


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

    @property
    def has_others(self) -> bool:
        """Whether the column holds other values than marks."""
        return self._low <= self._high

    def found(self) -> float | None:
        """Return the mark that stands apart from all other values; None if there is none."""
        spread = (self._high - self._low) / _APART
        gaps = {each: max(self._low - each, each - self._high) for each in self.counts}
        return next((each for each, gap in gaps.items() if gap > spread), None)
