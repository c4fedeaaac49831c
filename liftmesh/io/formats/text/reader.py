"""Reader for points as text: XYZ, CSV, TSV, TXT and ASC, with or without a header.

`layout` detects the layout, `columns` what the columns are, `values` parses the values, and
`column_ambiguity` looks for what only they suggest. Here it comes together: a table is read in
blocks, and made a cloud once all its rows are known.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import ColorScale, kept_depth
from liftmesh.errors import FormatError
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, PARTS, POSITION, taken_points, taken_together
from liftmesh.io.formats.text.column_ambiguity import ColumnAmbiguity, check_count
from liftmesh.io.formats.text.columns import Columns, understood, unnamed
from liftmesh.io.formats.text.layout import (
    Layout,
    as_utf8,
    before_remark,
    skip_lines,
    sniff,
    stated_separator,
)
from liftmesh.io.formats.text.values import TableValues
from liftmesh.io.metadata import NotedColumns, noted
from liftmesh.io.options import TableOptions
from liftmesh.io.text_tables import BLOCK, Block, Lines, Syntax, leading_comments, quoted, regrouped

_COMMENTS = ("#", "//")
_EXACT, _MOST_OF_IDS = 2.0**53, 2.0**64  # doubles hold every whole number up to the first
_PLAIN = TableOptions()


def read_text(
    stream: BinaryIO, name: str, *, max_bytes: int | None = None, options: TableOptions = _PLAIN
) -> Cloud:
    """Read points from text, one per line."""
    table = _Table(as_utf8(stream, name, options.encoding), name, max_bytes, options)
    rows = np.concatenate([*table.blocks()])
    meaning = _Meaning(table)
    meaning.examine(rows)
    meaning.finish()
    return meaning.cloud(rows)


def read_text_chunks(
    stream: BinaryIO,
    name: str,
    rows: int,
    *,
    max_bytes: int | None = None,
    options: TableOptions = _PLAIN,
) -> Iterator[Cloud]:
    """Read points from text in chunks, otherwise like `read_text`."""
    text = as_utf8(stream, name, options.encoding)
    begin = text.tell()
    meaning = _Meaning(_Table(text, name, max_bytes, options))
    meaning.examine_all()
    text.seek(begin)
    again = _Table(text, name, max_bytes, options)
    for part in regrouped(again.blocks(meaning.values), rows):
        yield meaning.cloud(part)


class _Table:
    """The rows of a text file, parsed block by block."""

    def __init__(
        self, stream: BinaryIO, name: str, max_bytes: int | None, options: TableOptions
    ) -> None:
        skip_lines(stream, options.skip_rows, name)
        self.name = name
        self.options = options
        self.notes: list[str] = []
        self._stream = stream
        self._begin = stream.tell()
        self._max_bytes = max_bytes
        self.layout = self._sniffed(options.delimiter)
        if self.layout.delimiter == "\t":  # where the ends of a line may be empty values
            self.layout = self._sniffed("\t", keep_tabs=True)
        elif self.layout.delimiter is None:
            self.layout = self._sniffed(" ")
        self.columns = self._named()
        self.values = TableValues(name, self.layout, self.columns, options)

    def blocks(self, values: TableValues | None = None) -> Iterator[Floats]:
        """Parse the rows, including the first line unless it is the header."""
        parse = (values or self.values).parse
        block = self._lines.take(BLOCK) if self.layout.in_first_line else self._first
        kept = self._until_end(block)
        if not len(kept):
            above = "a header but no points" if self.layout.in_first_line else "no points"
            raise FormatError(f"{self.name}: the file has {above}")
        while len(kept):
            yield parse(kept)
            block = self._lines.take(BLOCK) if len(kept) == len(block) else block[:0]
            kept = self._until_end(block)
        first, count = self._lines.remarks
        if count:
            self.notes.append(
                f"comments among the rows, not read: {count:,}, first in line {first}"
            )

    def _sniffed(self, delimiter: str | None, *, keep_tabs: bool = False) -> Layout:
        """Take the first line that is no comment, and detect the layout."""
        self._stream.seek(self._begin)
        remarks = leading_comments(self._stream, self.name, encoding="utf-8", marks=_COMMENTS)
        self._remark = next(iter(deque(remarks, maxlen=1)), "")
        syntax = Syntax(comments=_COMMENTS, whole=delimiter != " ", keep_tabs=keep_tabs)
        self._lines = Lines(
            self._stream, self.name, syntax, encoding="utf-8", before=self.options.skip_rows
        )
        self._first = self._lines.take(1)
        if len(self._first) and (stated := stated_separator(self._first.texts[0])):
            delimiter, self._first = delimiter or stated, self._lines.take(1)
        if not len(self._first):
            raise FormatError(f"{self.name}: the file has no points: no line holds numbers")
        if delimiter is None and before_remark(self._first.texts[0]):
            return self._sniffed(" ")
        said = replace(self.options, delimiter=delimiter)
        return self._sniffed_line(self._first.texts[0], said)

    def _sniffed_line(self, text: str, options: TableOptions) -> Layout:
        return sniff(text, self._remark, self._where(), options, max_bytes=self._max_bytes)

    def _named(self) -> Columns:
        header, width = self.layout.header, self.layout.width
        if header is not None:
            return understood(header, self.options, self._where())
        if width == 1:
            second = self._lines.take(1)
            if second.texts:
                following = self._sniffed_line(second.texts[0], self.options)
                above = () if following.in_first_line else following.header or ()
                check_count(self._first.texts[0], second.texts[0], self._where(), above)
        return unnamed(width, self.options, self._where())

    def _where(self) -> str:
        return f"{self.name}: line {int(self._first.numbers[0])}"

    def _until_end(self, block: Block) -> Block:
        """Cut off the line that the caller calls the end, and what follows."""
        end = self.options.end
        if end is None or end.encode() not in block.data:  # before all lines become strings
            return block
        texts = block.texts
        if end not in texts:
            return block
        at = texts.index(end)
        if len(block) > at + 1 or len(self._lines.take(1)):
            line = int(block.numbers[at])
            self.notes.append(f"line {line} ends the table: the lines that follow are not read")
        return block[:at]


class _Meaning:
    """What the columns become, and the type of colours, as determined from all rows."""

    def __init__(self, table: _Table) -> None:
        self.values = table.values
        self._table = table
        self._columns = table.columns
        width = table.layout.width
        self._maybe_colors = not self._columns.said and width == len(POSITION) + len(COLOR)
        self._maybe_colors &= not table.options.flat
        self._scale = ColorScale()
        others = [k for k, name in enumerate(self._columns.names) if name not in PARTS]
        self._others = np.array(others, dtype=np.intp)
        self._large = np.zeros(len(others), dtype=np.bool_)
        self._doubts = ColumnAmbiguity(table.name, self._columns, table.options)

    def examine_all(self) -> None:
        """Examine all rows of the file, one block in memory at a time."""
        for block in self._table.blocks():
            self.examine(block)
        self.finish()

    def examine(self, table: Floats) -> None:
        """Examine further rows."""
        self._doubts.examine(table)
        self._notice_large(table)
        if self._maybe_colors:
            rest = table[:, len(POSITION) :]
            whole = (rest >= 0) & (rest <= 255) & (rest == np.rint(rest))
            self._maybe_colors = bool(whole.all())
        if all(each in self._names() for each in COLOR):
            names = self._names()
            self._scale.examine(table[:, [names.index(each) for each in self._color_names()]])

    def _notice_large(self, table: Floats) -> None:
        """Remember the columns of numbers like the ids of a database, which doubles round."""
        if len(table) and len(self._others):
            largest = np.fmax.reduce(np.abs(table[:, self._others]))
            self._large |= (largest >= _EXACT) & (largest < _MOST_OF_IDS)

    def finish(self) -> None:
        """Raise for what can be read in two ways, once all rows are examined."""
        self.values.check()
        self._doubts.check()
        kept = [self._columns.names[k] for k in self._kept()]
        mixed = [self._columns.names[k] for k in sorted(self.values.mixed)]
        if not self._table.options.names_all:
            self._columns.check_height([*kept, *mixed], self._table.name)
        self._columns.warn()

    def cloud(self, table: Floats) -> Cloud:
        """Make a cloud of rows that were examined."""
        names = self._names()
        columns = {names[k]: table[:, k] for k in self._kept()}
        points = _points(table, columns)
        if self._columns.negated is not None:
            points[:, 2] = 0.0 - points[:, 2]  # 0 stays 0
        colors = self._colors(columns)
        return Cloud(
            points,
            colors=colors,
            color_depth=kept_depth(colors),
            normals=taken_together(columns, NORMAL),
            attributes={each: np.ascontiguousarray(values) for each, values in columns.items()},
            metadata=self._metadata(),
        )

    def _names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return (*POSITION, *COLOR) if self._maybe_colors else self._columns.names

    def _kept(self) -> list[int]:
        """The columns that become something: not text, nor empty unless coordinates."""
        left_out = {*self._columns.left_out, *self.values.text, *self._empty()}
        return [k for k in range(len(self._columns.names)) if k not in left_out]

    def _empty(self) -> list[int]:
        names = self._columns.names
        return [k for k in np.flatnonzero(~self.values.filled).tolist() if names[k] not in POSITION]

    def _metadata(self) -> dict[str, Any]:
        """What was found, and what of the table is not read."""
        given = self._columns.given
        unread = {k: f"column {given[k]}" for k in sorted(self._columns.left_out)}
        unread |= {k: f"column {given[k]} (empty)" for k in self._empty()}
        for k, text in self.values.text.items():
            unread[k] = f"column {given[k]} (text, line {text.line}: {quoted(text.value)})"
        mapping = NotedColumns(replace(self._columns, names=self._names()).mapping())
        notes = (*self._table.notes, *self._columns.notes, *self._remarks())
        return noted({}, columns=mapping, notes=notes, not_read=tuple(unread.values()))

    def _remarks(self) -> Iterator[str]:
        for k in sorted({*self._others[self._large].tolist()} & {*self._kept()}):
            yield f"column {self._columns.given[k]}: numbers from 2**53 on are rounded to doubles"
        if self._maybe_colors:
            yield "columns 4, 5 and 6 are read as red, green and blue"
        elif not self._columns.said and len(self._columns.names) > len(POSITION):
            flat = self._table.options.flat
            which = "1 and 2 are read as x and y" if flat else "1, 2 and 3 are read as x, y and z"
            yield f"there is no header: columns {which}"
        if self.values.commas is not None:
            yield f"commas are decimal, as in {quoted(self.values.commas.value)}"

    def _color_names(self) -> tuple[str, ...]:
        return (*COLOR, ALPHA) if ALPHA in self._names() else COLOR

    def _colors(self, columns: dict[str, Floats]) -> Array | None:
        """Remove and return the colours; columns that cannot be colours stay attributes."""
        rest = dict(columns)
        values = taken_together(rest, self._color_names())
        colors = None if values is None else self._scale.convert(values)
        if colors is not None:
            for each in self._color_names():
                del columns[each]
        return colors


def _points(table: Floats, columns: dict[str, Floats]) -> Floats:
    """Remove and return the coordinates: the table itself if it holds nothing else."""
    if tuple(columns) == POSITION and table.shape[1] == len(POSITION):
        columns.clear()
        return np.ascontiguousarray(table)
    return taken_points(columns, len(table))
