"""Reader for points as text: XYZ, CSV, TSV, TXT and ASC, with or without a header.

`text_tables` parses the numbers; this module detects the layout of a file (delimiter and header)
and the meaning of its columns.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.cloud import Cloud
from liftmesh.color_depth import kept_depth
from liftmesh.errors import FormatError
from liftmesh.io.colors import ColorScale
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.format import Format
from liftmesh.io.limits import check_columns, most_columns
from liftmesh.io.lines import BLOCK, Lines, leading_comments
from liftmesh.io.text_tables import fields, is_number, number_table, quoted, values_at_most

# Column names in common use, in lower case.
_ALIASES = {
    "x": ("x", "easting", "east", "lon", "longitude", "x_coord", "xcoord", "coord_x"),
    "y": ("y", "northing", "north", "lat", "latitude", "y_coord", "ycoord", "coord_y"),
    "z": ("z", "elevation", "elev", "height", "altitude", "alt", "z_coord", "zcoord", "coord_z"),
    "red": ("red", "r"),
    "green": ("green", "g"),
    "blue": ("blue", "b"),
    "alpha": ("alpha", "a"),
    "nx": ("nx", "normal_x", "normalx"),
    "ny": ("ny", "normal_y", "normaly"),
    "nz": ("nz", "normal_z", "normalz"),
}
_MEANING = {alias: name for name, aliases in _ALIASES.items() for alias in aliases}

_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class Layout:
    """Delimiter, number of columns and their names in a text file.

    The delimiter is None for white space, the header None if there is none; ``in_first_line`` is
    False if the header is a comment before the first line.
    """

    delimiter: str | None
    width: int
    header: tuple[str, ...] | None
    in_first_line: bool


def sniff(first: str, remark: str, name: str, line: int, *, max_bytes: int | None = None) -> Layout:
    """Detect the layout from the first line that is not a comment, and the comment before it.

    Raises
    ------
    FormatError
        The line is neither a header with x and y nor a row of numbers, or has more values than the
        limit allows.
    """
    most = most_columns(max_bytes)
    if len(first) >= most:  # a shorter line has no more values
        found = values_at_most(first)
        check_columns(found, max_bytes, f"{name}: line {line}", f"a row of {found:,} values")
    delimiter = _delimiter(first)
    values = fields(first, delimiter)
    _check(values, name, line)
    if not any(is_number(value) for value in values):
        return Layout(delimiter, len(values), columns(values, name, line), in_first_line=True)
    marked = "" if len(remark) >= most and values_at_most(remark) > most else remark
    names = [value.lower() for value in fields(marked, _delimiter(marked))]
    meanings = [_MEANING.get(value) for value in names]
    is_header = len(names) == len(values) and {"x", "y"} <= set(meanings)
    header = columns(names, name, line) if is_header else None
    return Layout(delimiter, len(values), header, in_first_line=False)


def columns(names: list[str], name: str, line: int) -> tuple[str, ...]:
    """Replace the names of a header by standard ones; unknown names stay as they are.

    Raises
    ------
    FormatError
        x or y is missing, or a name occurs twice.
    """
    found = tuple(
        _MEANING.get(each.lower(), each or f"column_{k}") for k, each in enumerate(names, 1)
    )
    missing = [each for each in ("x", "y") if each not in found]
    if missing:
        raise FormatError(
            f"{name}: line {line}: the header {quoted(' '.join(names))} has no column "
            f"{' or '.join(missing)}: name two of its columns x and y"
        )
    twice = next((each for each, count in Counter(found).items() if count > 1), None)
    if twice is not None:
        raise FormatError(f"{name}: line {line}: two columns of the header mean {twice!r}")
    return found


def unnamed(width: int, name: str, line: int) -> tuple[str, ...]:
    """Name the columns of a file without a header: x, y, z, then column_4 and so on.

    Raises
    ------
    FormatError
        There is only one column.
    """
    if width < 2:
        raise FormatError(f"{name}: line {line}: only one value: a point needs x and y at least")
    return ("x", "y", "z", *(f"column_{k}" for k in range(4, width + 1)))[:width]


def _delimiter(text: str) -> str | None:
    if ";" in text:
        return ";"
    if "\t" in text and all(len(value.split()) == 1 for value in text.split("\t")):
        return "\t"
    words = text.split()
    if len(words) > 1 and all(_DECIMAL_COMMA.fullmatch(word) for word in words):
        return None
    return "," if "," in text else None


def _check(values: list[str], name: str, line: int) -> None:
    if values[0].lower() in ("ncols", "nrows"):
        raise FormatError(f"{name}: this is an Arc/Info ASCII grid, not a list of points")
    for value in values:
        if _DECIMAL_COMMA.fullmatch(value):
            raise FormatError(
                f"{name}: line {line}: {quoted(value)} has a decimal comma: "
                "save the file with decimal points"
            )


_COMMENTS = ("#", "//")
_UTF8_MARK = b"\xef\xbb\xbf"


def read_text(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read points from text, one per line.

    Values are separated by commas, semicolons, tabs or white space. Lines that begin with ``#`` or
    ``//`` are comments; the last one before the first row is the header if it names as many columns
    as the row has, x and y among them.

    Parameters
    ----------
    max_bytes : int, optional
        Limit of what the columns take besides their values, 2,000 bytes each; by default what
        10,000 of them take.

    Returns
    -------
    Cloud
        Columns x, y, z (also easting, northing, elevation and the like, in upper or lower case)
        become coordinates, and a missing z is 0; red, green, blue (r, g, b) become colours: uint8
        or uint16 if they are whole numbers, floats if none exceeds 1; nx, ny, nz become normals;
        all others float64 attributes of that name. Without a header the columns are x, y, z, and
        further ones attributes ``column_4`` and so on; of exactly six, the last three are colours
        if all are whole numbers from 0 to 255.

    Raises
    ------
    FormatError
        The file is invalid, or has more columns than the limit allows; the message gives the line.
    """
    table = _Table(stream, name, max_bytes)
    rows = np.concatenate([*table.blocks()])
    meaning = _Meaning(table)
    meaning.examine(rows)
    return meaning.cloud(rows)


def read_text_chunks(
    stream: BinaryIO, name: str, rows: int, *, max_bytes: int | None = None
) -> Iterator[Cloud]:
    """Read points from text in chunks, otherwise like `read_text`.

    The meaning of the columns depends on all rows, so the file is parsed twice.

    Parameters
    ----------
    max_bytes : int, optional
        As for `read_text`.

    Yields
    ------
    Cloud
        Consecutive rows.

    Raises
    ------
    FormatError
        As `read_text`.
    """
    begin = stream.tell()
    meaning = _Meaning.of(_Table(stream, name, max_bytes))
    stream.seek(begin)
    for part in _regrouped(_Table(stream, name, max_bytes).blocks(), rows):
        yield meaning.cloud(part)


class _Table:
    """The rows of a text file, parsed block by block."""

    def __init__(self, stream: BinaryIO, name: str, max_bytes: int | None) -> None:
        remark = _first_remark(stream, name)
        self._lines = Lines(stream, name, encoding="utf-8", comments=_COMMENTS)
        self._first = self._lines.take(1)
        if not len(self._first):
            raise FormatError(f"{name}: the file has no points: no line holds numbers")
        self.name = name
        self.line = int(self._first.numbers[0])
        self.layout = sniff(self._first.texts[0], remark, name, self.line, max_bytes=max_bytes)

    def blocks(self) -> Iterator[Floats]:
        """Parse the rows, including the first line unless it is the header."""
        block = self._lines.take(BLOCK) if self.layout.in_first_line else self._first
        if not len(block):
            raise FormatError(f"{self.name}: the file has a header but no points")
        while len(block):
            yield number_table(
                block, self.name, width=self.layout.width, delimiter=self.layout.delimiter
            )
            block = self._lines.take(BLOCK)


def _regrouped(tables: Iterable[Floats], rows: int) -> Iterator[Floats]:
    """Regroup tables into tables of ``rows`` rows each; the last may have fewer."""
    held: list[Floats] = []
    count = 0
    for table in tables:
        rest = table
        while len(rest):
            held.append(rest[: rows - count])
            count += len(held[-1])
            rest = rest[len(held[-1]) :]
            if count == rows:
                yield np.concatenate(held)
                held, count = [], 0
    if held:
        yield np.concatenate(held)


class _Meaning:
    """Names of the columns, and the type of colours, as determined from all rows."""

    def __init__(self, table: _Table) -> None:
        self._header = table.layout.header
        width = table.layout.width
        self._names = self._header or unnamed(width, table.name, table.line)
        self._maybe_colors = not self._header and width == len(POSITION) + len(COLOR)
        self._scale = ColorScale()

    @classmethod
    def of(cls, table: _Table) -> _Meaning:
        """Examine all rows of a file, one block in memory at a time."""
        blocks = table.blocks()
        first = next(blocks)  # what is wrong with it is told first
        meaning = cls(table)
        for block in chain([first], blocks):
            meaning.examine(block)
        return meaning

    def examine(self, table: Floats) -> None:
        """Examine further rows."""
        if self._maybe_colors:
            rest = table[:, len(POSITION) :]
            whole = (rest >= 0) & (rest <= 255) & (rest == np.rint(rest))
            self._maybe_colors = bool(whole.all())
        if all(each in self.names for each in COLOR):
            self._scale.examine(table[:, [self.names.index(each) for each in self._color_names()]])

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns."""
        return (*POSITION, *COLOR) if self._maybe_colors else self._names

    def cloud(self, table: Floats) -> Cloud:
        """Make a cloud of rows that were examined."""
        columns = dict(zip(self.names, table.T, strict=True))
        points = np.zeros((len(table), 3))
        for position, each in enumerate(POSITION):
            if each in columns:
                points[:, position] = columns.pop(each)
        colors = self._colors(columns)
        return Cloud(
            points,
            colors=colors,
            color_depth=kept_depth(colors),
            normals=_popped(columns, NORMAL),
            attributes={each: np.ascontiguousarray(values) for each, values in columns.items()},
        )

    def _color_names(self) -> tuple[str, ...]:
        return (*COLOR, ALPHA) if ALPHA in self.names else COLOR

    def _colors(self, columns: dict[str, Floats]) -> Array | None:
        """Remove and return the colours; columns that cannot be colours stay attributes."""
        rest = dict(columns)
        values = _popped(rest, self._color_names())
        colors = None if values is None else self._scale.convert(values)
        if colors is not None:
            for each in self._color_names():
                del columns[each]
        return colors


def _first_remark(stream: BinaryIO, name: str) -> str:
    """Return the last comment before the first row; leave the stream at the start of the text."""
    begin = stream.tell()
    mark = stream.read(3)
    if mark[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise FormatError(f"{name}: byte {begin}: the text is UTF-16: save it as UTF-8")
    stream.seek(begin + 3 if mark == _UTF8_MARK else begin)
    last = ""
    for comment in leading_comments(stream, name, encoding="utf-8", marks=_COMMENTS):
        last = comment
    return last


def _popped(columns: dict[str, Floats], names: tuple[str, ...]) -> Floats | None:
    if not all(each in columns for each in names):
        return None
    return np.stack([columns.pop(each) for each in names], axis=1)


FORMAT = Format(
    name="text",
    suffixes=(".xyz", ".csv", ".txt", ".asc", ".tsv"),
    read=read_text,
    write=None,
    description="points as text, one per line, with or without a header",
    read_chunks=read_text_chunks,
    expands=True,
    gzip=True,
)
