"""The values of a table as text: numbers, and what else may stand in a row.

Blocks of plain numbers go to `text_tables` as they are. Where a block holds anything else, its
lines are split, and each value is made a plain number: an empty one, and the caller's ``nodata``,
become NaN, a decimal comma a point. A column with other text holds no numbers: it is remembered
with its first text, and left out. Coordinates must be numbers, in every row.

A decimal comma is one where nothing else can be meant: commas do not separate the values, no other
number has a point, and some comma cannot separate thousands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError
from liftmesh.io.columns import POSITION
from liftmesh.io.limits import MOST_COLUMNS
from liftmesh.io.lines import Block
from liftmesh.io.table_doubts import named_points
from liftmesh.io.table_words import may_be_grouped, split, with_point
from liftmesh.io.text_tables import is_number, number_table, quoted, values_at_most

if TYPE_CHECKING:
    from liftmesh.io.table_columns import Columns
    from liftmesh.io.table_layout import Layout
    from liftmesh.io.table_options import TableOptions

_NAN = "nan"
_MISSING = ("na", "n/a", "null", "none", "-", "--", "*", "?", "#n/a", "nodata", "no data")


@dataclass(frozen=True, slots=True)
class Found:
    """A value and the number of its line."""

    value: str
    line: int


class TableValues:
    """The numbers of a table, block by block, and what was seen of its other values.

    ``text`` holds the columns that are no numbers, by position, with the first text of each, and
    ``mixed`` those of them that hold numbers too; ``filled`` tells which columns hold anything;
    ``commas`` is the first number with a decimal comma.

    Parameters
    ----------
    name : str
        The file's name for messages.
    layout : Layout
        What separates the values, and how many there are.
    columns : Columns
        What they are: coordinates must be numbers.
    options : TableOptions
        What the caller says.
    """

    def __init__(self, name: str, layout: Layout, columns: Columns, options: TableOptions) -> None:
        self.text: dict[int, Found] = {}
        self.mixed: set[int] = set()
        self.commas: Found | None = None
        self.filled = np.zeros(layout.width, dtype=np.bool_)
        self._name = name
        self._delimiter = layout.delimiter
        self._width = layout.width
        self._columns = columns
        self._required = {k for k, each in enumerate(columns.names) if each in POSITION}
        self._missing = options.missing or ()
        self._decimal = options.decimal
        self._point: Found | None = None
        self._ungrouped = False
        self._plain = options.decimal != ","

    def parse(self, block: Block) -> Floats:
        """Parse the lines of a block; columns of text are NaN."""
        table = self._numbers(block)
        for value in self._missing:
            if isinstance(value, float):
                table[table == value] = np.nan
        return table

    def check(self) -> None:
        """Raise if the commas in numbers can be read in two ways, once all rows are known."""
        if self.commas is not None and self._decimal is None and not self._ungrouped:
            value, line = self.commas.value, self.commas.line
            raise FormatError(
                f"{self._name}: line {line}: {quoted(value)} is {with_point(value)} with a decimal "
                f"comma, or {value.replace(',', '')} with one between thousands: read it with "
                "decimal=',', or save it without such commas"
            )

    def _numbers(self, block: Block) -> Floats:
        if self._plain and not any('"' in text for text in block.texts):
            try:
                table = number_table(
                    block, self._name, width=self._width, delimiter=self._delimiter
                )
            except FormatError:
                self._plain = False  # most likely the next blocks hold the same
            else:
                self.filled[:] = True
                self._notice_points(block)
                return table
        return self._split(block)

    def _notice_points(self, block: Block) -> None:
        """Remember a number with a point, in tables where others could have commas."""
        if self._delimiter != "," and self._point is None:
            found = (Found(text, line) for text, line in block if "." in text)
            self._point = next(found, None)

    def _split(self, block: Block) -> Floats:
        """Parse a block whose values may be anything."""
        rows = [self._row(text, line) for text, line in block]
        columns = [
            self._column(k, values, block) for k, values in enumerate(zip(*rows, strict=True))
        ]
        lines = [",".join(values) for values in zip(*columns, strict=True)]
        return number_table(
            Block(lines, block.numbers), self._name, width=self._width, delimiter=","
        )

    def _row(self, text: str, line: int) -> Sequence[str]:
        """Split a line, but one of far too many values: these take more than their text."""
        where = f"{self._name}: line {line}"
        values: Sequence[str] = ()
        if '"' not in text:
            values = [value.strip() for value in text.split(self._delimiter, self._width)]
        elif values_at_most(text) <= max(self._width, MOST_COLUMNS):
            values = split(text, self._delimiter, where)
        if len(values) != self._width:
            raise self._broken(text, values, where)
        return values

    def _broken(self, text: str, values: Sequence[str], where: str) -> FormatError:
        """Return the error for a row of another width, or of text in a table that had none."""
        if [*values] == [text] and text.isalpha():
            return FormatError(
                f"{where}: {quoted(text)} is a broken row, expected {self._width} values, or marks "
                f"the end of the table: read it with end={quoted(text)}"
            )
        odd = (k for k, value in enumerate(values[: self._width]) if value and not is_number(value))
        k = next(odd, None)
        if k is not None and not self.text:
            return FormatError(f"{where}, value {k + 1}: {quoted(values[k])} is not a number")
        marks = text.count(self._delimiter) + 1 if self._delimiter else values_at_most(text)
        found = len(values) if '"' in text and values else marks
        return FormatError(f"{where}: expected {self._width} values, found {found:,}")

    def _column(self, k: int, values: Sequence[str], block: Block) -> Sequence[str]:
        """Return plain numbers for the values of a column; NaN for all if it holds text."""
        if k in self.text:
            return [_NAN] * len(values)
        held = bool(self.filled[k])
        self.filled[k] = held or any(values)
        plain = [self._plain_number(value, at, block) for at, value in enumerate(values)]
        bad = next((at for at, value in enumerate(plain) if not value), None)
        if bad is None:
            return plain
        found = Found(values[bad], int(block.numbers[bad]))
        if k in self._required:
            raise self._not_a_number(k, found)
        self.text[k] = found
        if held or any(value not in ("", _NAN) for value in plain):
            self.mixed.add(k)
        return [_NAN] * len(values)

    def _plain_number(self, value: str, at: int, block: Block) -> str:
        """Return the text of a number, NaN for a missing one, "" for other text."""
        if not value or value in self._missing:
            return _NAN
        if "," in value:
            number = with_point(value)
            return self._with_comma(number, Found(value, int(block.numbers[at])))
        if not is_number(value):
            return ""
        if "." in value and self._decimal != ".":
            return self._with_point(value, int(block.numbers[at]))
        return value

    def _with_comma(self, number: str, found: Found) -> str:
        """Accept a number with a decimal comma, or raise if that is not the only way to read it."""
        if not number or self._decimal == ".":
            return ""
        if self._decimal is None and self._delimiter is None:
            raise FormatError(
                f"{self._name}: line {found.line}: {quoted(found.value)} is a number with a "
                "decimal comma, or two numbers: read it with decimal=',', or with delimiter=','"
            )
        if self._decimal is None and self._point is not None:
            raise self._mixed(found, self._point)
        self.commas = self.commas or found
        self._ungrouped = self._ungrouped or not may_be_grouped(found.value)
        return number

    def _with_point(self, value: str, line: int) -> str:
        """Accept a number with a decimal point, unless others have commas."""
        if self._decimal == ",":
            return ""
        if self._delimiter != ",":
            self._point = self._point or Found(value, line)
            if self.commas is not None:
                raise self._mixed(self.commas, self._point)
        return value

    def _mixed(self, comma: Found, point: Found) -> FormatError:
        return FormatError(
            f"{self._name}: line {comma.line} has a comma in the number {quoted(comma.value)}, and "
            f"line {point.line} a point, {quoted(point.value)}: one of them separates thousands, "
            "or a text was taken for a number: read it with decimal=',' or with decimal='.'"
        )

    def _not_a_number(self, k: int, found: Found) -> FormatError:
        hint = ""
        if found.value.lower() in _MISSING:
            hint = f": if it stands for a missing value, read it with nodata={found.value!r}"
        elif k == 0 and not self._columns.said and self._width > 2:
            hint = f": if it names the points, {named_points(self._width)}"
        return FormatError(
            f"{self._name}: line {found.line}, value {k + 1}: {quoted(found.value)} is not a "
            f"number{hint}"
        )
