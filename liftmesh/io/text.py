"""Points as text: XYZ, CSV, TSV, TXT and ASC, with or without a header.

``numpy.loadtxt`` parses the numbers; this module finds out what the columns mean.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.file_colors import recognized
from liftmesh.io.format import Format
from liftmesh.io.text_layout import Layout, sniff, unnamed
from liftmesh.io.text_tables import BLOCK, Block, Lines, number_table

_COMMENTS = ("#", "//")
_UTF8_MARK = b"\xef\xbb\xbf"


def read_text(stream: BinaryIO, name: str) -> Cloud:
    """Read points from text, one a line.

    Values stand between commas, semicolons, tabs or white space. Lines that begin with ``#`` or
    ``//`` are comments; the last one before the first row counts as a header if it names as many
    columns, x and y among them.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Columns x, y, z (also easting, northing, elevation and the like, in any case) become
        coordinates, and a missing z is 0; red, green, blue (r, g, b) colours: uint8 or uint16 if
        whole numbers, floats if none exceeds 1; nx, ny, nz normals; others float64 attributes by
        their name. Without a header the columns are x, y, z, and further ones attributes
        ``column_4`` and so on; of exactly six, the last three are colours if all are whole numbers
        from 0 to 255.

    Raises
    ------
    FormatError
        The file is broken; the message names the line.
    """
    remark = _first_remark(stream, name)
    lines = Lines(stream, name, encoding="utf-8", comments=_COMMENTS)
    first = lines.take(1)
    if not len(first):
        raise FormatError(f"{name}: no line holds numbers: the file has no points")
    layout = sniff(first.texts[0], remark, name, first.numbers[0])
    table = _table(first, lines, layout, name)
    names = layout.header or _unnamed(table, name, first.numbers[0])
    return _cloud(table, names)


def _first_remark(stream: BinaryIO, name: str) -> str:
    """Return the last comment before the first row, and leave the stream where the text begins."""
    begin = stream.tell()
    mark = stream.read(3)
    if mark[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise FormatError(f"{name}: byte {begin}: the text is UTF-16: save it as UTF-8")
    begin += 3 if mark == _UTF8_MARK else 0
    stream.seek(begin)
    remark = ""
    lines = Lines(stream, name, encoding="utf-8")
    while (line := lines.next()).startswith(_COMMENTS):
        remark = line.lstrip("#/ \t")
    stream.seek(begin)
    return remark


def _table(first: Block, lines: Lines, layout: Layout, name: str) -> Floats:
    """Parse the rows, the first line among them unless it is the header."""
    told = len(layout.header) if layout.header else None
    tables: list[Floats] = []
    if not layout.in_first_line:
        tables.append(number_table(first, name, width=told, delimiter=layout.delimiter))
    width = told or tables[0].shape[1]
    while len(block := lines.take(BLOCK)):
        tables.append(number_table(block, name, width=width, delimiter=layout.delimiter))
    if not tables:
        raise FormatError(f"{name}: the file has a header but no points")
    return np.concatenate(tables)


def _unnamed(table: Floats, name: str, line: int) -> tuple[str, ...]:
    names = unnamed(table.shape[1], name, line)
    rest = table[:, 3:]
    whole = np.all((rest >= 0) & (rest <= 255) & (rest == np.rint(rest)))
    return (*POSITION, *COLOR) if rest.shape[1] == 3 and whole else names


def _cloud(table: Floats, names: tuple[str, ...]) -> Cloud:
    columns = dict(zip(names, table.T, strict=True))
    points = np.zeros((len(table), 3))
    for position, each in enumerate(POSITION):
        if each in columns:
            points[:, position] = columns.pop(each)
    return Cloud(
        points,
        colors=_colors(columns),
        normals=_popped(columns, NORMAL),
        attributes={each: np.ascontiguousarray(values) for each, values in columns.items()},
    )


def _colors(columns: dict[str, Floats]) -> Array | None:
    """Take the colours out; columns of that name which cannot be colours stay attributes."""
    names = (*COLOR, ALPHA) if ALPHA in columns else COLOR
    rest = dict(columns)
    values = _popped(rest, names)
    colors = None if values is None else recognized(values)
    if colors is not None:
        for each in names:
            del columns[each]
    return colors


def _popped(columns: dict[str, Floats], names: tuple[str, ...]) -> Floats | None:
    if not all(each in columns for each in names):
        return None
    return np.stack([columns.pop(each) for each in names], axis=1)


FORMAT = Format(
    name="text",
    suffixes=(".xyz", ".csv", ".txt", ".asc", ".tsv"),
    read=read_text,
    write=None,
    description="points as text, one a line, with or without a header",
)
