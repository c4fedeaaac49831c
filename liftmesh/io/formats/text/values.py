"""The values of a table as text: numbers, and what else may stand in a row.

Blocks of plain numbers go to `text_tables` as they are. Where a block holds anything else, its
lines are split, and each value is made a plain number: an empty one, and the caller's ``nodata``,
become NaN, a decimal comma a point. A column with other text holds no numbers: it is remembered
with its first text, and left out. Coordinates must be numbers, in every row.

A decimal comma is one where nothing else can be meant: commas do not separate the values, no other
number has a point, and some comma cannot separate thousands.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError, Option
from liftmesh.io.columns import POSITION
from liftmesh.io.formats.text.column_ambiguity import named_points
from liftmesh.io.formats.text.layout import (
    Layout,
    may_be_grouped,
    split,
    with_point,
    without_remark,
)
from liftmesh.io.options import MOST_COLUMNS, TableOptions, spelled
from liftmesh.io.text_tables import Block, is_number, number_table, quoted, values_at_most

if TYPE_CHECKING:
    from liftmesh.io.formats.text.columns import Columns

_NAN = "nan"
_STRINGS = 1 << 17  # held at a time
_LONGEST_END = 40  # characters of a line that may end a table
_ODD_COMMA = re.compile(rb",(?![0-9])|,[0-9]+,")
_MISSING = (
    *("na", "n/a", "null", "\\n", "none", "nil", "-", "--", "*", "?", "nodata", "no data"),
    *("#n/a", "#value!", "#ref!", "#null!", "missing"),
)
_GROUPED = re.compile(r"[-+]?\d{1,3}(?:[ .,'\u2019\u00a0\u2009\u202f]\d{3})+(?:[.,]\d*)?")


@dataclass(frozen=True, slots=True)
class Found:
    """A value and the number of its line."""

    value: str
    line: int


class TableValues:
    """The numbers of a table, block by block, and what was seen of its other values."""

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
        self._plain = True
        self._first_line = 0

    def parse(self, block: Block) -> Floats:
        """Parse the lines of a block; columns of text are NaN."""
        self._first_line = self._first_line or int(block.numbers[0])
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
                f"{Option('decimal', ',')}, or save it without such commas"
            )

    def _numbers(self, block: Block) -> Floats:
        plain = self._with_points(block) if self._plain else None
        if plain is not None:
            try:
                table = number_table(
                    plain, self._name, width=self._width, delimiter=self._delimiter
                )
            except FormatError:
                self._plain = False  # most likely the next blocks hold the same
            else:
                self.filled[:] = True
                self._notice_marks(block)
                return table
        return self._split(block)

    def _with_points(self, block: Block) -> Block | None:
        """Return a block of numbers with points only; None if its values must be looked at."""
        text = _bytes_of(block)
        if b'"' in text:
            return None
        if self._delimiter == ",":
            return block
        pointed, commas = b"." in text, b"," in text
        if not commas:
            doubtful = self._decimal == "," or (self._decimal is None and self.commas is not None)
            return None if pointed and doubtful else block
        said = self._decimal or ("," if self._delimiter and self._point is None else None)
        if said != "," or pointed or _ODD_COMMA.search(text):
            return None
        return replace(
            block, data=block.data.replace(b",", b"."), plain=block.plain.replace(b",", b".")
        )

    def _notice_marks(self, block: Block) -> None:
        """Remember the first number with a point, or with a comma and one for decimals only."""
        if self._delimiter == "," or self._point is not None or self._ungrouped:
            return
        marks = _bytes_of(block)
        for text, line in block if b"." in marks or b"," in marks else ():
            if "." in text:
                self._point = Found(text, line)
            if self._ungrouped or self._point is not None:
                return
            for value in text.split(self._delimiter) if "," in text else ():
                if "," in value:
                    self.commas = self.commas or Found(value.strip(), line)
                    self._ungrouped = self._ungrouped or not may_be_grouped(value.strip())

    def _split(self, block: Block) -> Floats:
        """Parse a block whose values may be anything, some rows at a time."""
        step = max(_STRINGS // self._width, 1)
        begins = range(0, max(len(block), 1), step)
        return np.concatenate([self._split_rows(block[k : k + step]) for k in begins])

    def _split_rows(self, block: Block) -> Floats:
        rows = [self._row(text, line) for text, line in block]
        columns = [
            self._column(k, values, block) for k, values in enumerate(zip(*rows, strict=True))
        ]
        lines = [",".join(values) for values in zip(*columns, strict=True)]
        return number_table(
            Block.of(lines, block.numbers), self._name, width=self._width, delimiter=","
        )

    def _row(self, text: str, line: int) -> Sequence[str]:
        """Split a line, but one of far too many values: these take more than their text."""
        where = f"{self._name}: line {line}"
        text = without_remark(text)
        values: Sequence[str] = ()
        if '"' not in text:
            values = [value.strip() for value in text.split(self._delimiter, self._width)]
        elif values_at_most(text, self._delimiter) <= max(self._width, MOST_COLUMNS):
            values = split(text, self._delimiter, where)
        if len(values) != self._width:
            raise self._broken(text, values, where)
        return values

    def _broken(self, text: str, values: Sequence[str], where: str) -> FormatError:
        """Return the error for a row of another width, or of text in a table that had none."""
        is_word = len(values) == 1 and any(map(str.isalpha, text)) and not is_number(text)
        if is_word and text.isprintable() and len(text) <= _LONGEST_END:
            return FormatError(
                f"{where}: {quoted(text)} is a broken row, expected {self._width} values, or marks "
                f"the end of the table: read it with {Option('end', text)}"
            )
        odd = (k for k, value in enumerate(values[: self._width]) if value and not is_number(value))
        k = next(odd, None)
        if k is not None and not self.text:
            return FormatError(f"{where}, value {k + 1}: {quoted(values[k])} is not a number")
        marks = text.count(self._delimiter) + 1 if self._delimiter else values_at_most(text)
        count = len(values) if '"' in text and values else marks
        return FormatError(f"{where}: expected {self._width} values, found {count:,}")

    def _column(self, k: int, values: Sequence[str], block: Block) -> Sequence[str]:
        """Return plain numbers for the values of a column; NaN for all if it holds text."""
        if k in self.text:
            return [_NAN] * len(values)
        held = bool(self.filled[k])
        self.filled[k] = held or any(each and each not in self._missing for each in values)
        known = self._is_known
        plain = [
            value
            if value and "," not in value and known(value)
            else self._special(value, at, block)
            for at, value in enumerate(values)
        ]
        if "" not in plain:
            self._check_points(values, block)
            return plain
        word = Found(values[plain.index("")], int(block.numbers[plain.index("")]))
        if k in self._required:
            raise self._not_a_number(k, word)
        self.text[k] = word
        if held or any(value not in ("", _NAN) for value in plain):
            self.mixed.add(k)
        return [_NAN] * len(values)

    def _is_known(self, value: str) -> bool:
        """Whether a value is a number as it is."""
        return is_number(value) and (self._decimal != "," or "." not in value)

    def _special(self, value: str, at: int, block: Block) -> str:
        """Return NaN for a missing value, a number for one with a comma, "" for other text."""
        if not value or value in self._missing:
            return _NAN
        number = with_point(value)
        if not number or self._decimal == ".":
            return ""
        word = Found(value, int(block.numbers[at]))
        if self._decimal is None and self._delimiter is None:
            raise FormatError(
                f"{self._name}: line {word.line}: {quoted(value)} is a number with a decimal "
                f"comma, or two numbers: read it with {Option('decimal', ',')}, or with "
                f"{Option('delimiter', ',')}"
            )
        if self._decimal is None and self._point is not None:
            raise self._mixed(word, self._point)
        self.commas = self.commas or word
        self._ungrouped = self._ungrouped or not may_be_grouped(value)
        return number

    def _check_points(self, values: Sequence[str], block: Block) -> None:
        """Raise if some numbers have points, and others commas."""
        if self._decimal is not None or self._delimiter == "," or self._point is not None:
            return
        at = next((at for at, value in enumerate(values) if "." in value), None)
        if at is not None:
            self._point = Found(values[at], int(block.numbers[at]))
            if self.commas is not None:
                raise self._mixed(self.commas, self._point)

    def _mixed(self, comma: Found, point: Found) -> FormatError:
        return FormatError(
            f"{self._name}: line {comma.line} has a comma in the number {quoted(comma.value)}, and "
            f"line {point.line} a point, {quoted(point.value)}: one of them separates thousands, "
            f"or a text was taken for a number: read it with {Option('decimal', ',')} or with "
            f"{Option('decimal', '.')}"
        )

    def _not_a_number(self, k: int, word: Found) -> FormatError:
        hint = self._hint(k, word)
        return FormatError(
            f"{self._name}: line {word.line}, value {k + 1}: {quoted(word.value)} is not a "
            f"number{hint and ': '}{hint}"
        )

    def _hint(self, k: int, word: Found) -> str:
        """Say what a coordinate that is text may be, and how to read the table then."""
        if word.value.lower() in _MISSING:
            return f"if it stands for a missing value, read it with {Option('nodata', word.value)}"
        if _GROUPED.fullmatch(word.value):
            return "save it without the marks between thousands"
        names = spelled(self._columns.given)
        is_first = word.line == self._first_line
        if self._columns.said and names and is_first:
            skip = Option("skip_rows", word.line)
            return f"if the line holds units, read it with {skip} and {names}"
        if self._columns.said or self._width <= 2:
            return ""
        if k == 0:
            return f"if it names the points, {named_points(self._width)}"
        return (
            f"there is no header: name the columns, as with {Option('columns', 'id,-,x,y,z')}"
            * is_first
        )


def _bytes_of(block: Block) -> bytes:
    """Return the lines of a block, to look at once; as strings only if comments are among them."""
    if not len(block):
        return b""
    text = block.data[int(block.places[0, 0]) : int(block.places[-1, 1])]
    if b"#" in text or (b"/" in text and b"//" in text):  # a search for two bytes is slow
        return "\n".join(block.texts).encode()
    return text
