"""The layout of a table as text: what separates its values, and whether a header names them.

The first line that is no comment decides. It is a header if it holds no number, or if it names x
and y; otherwise a comment before it is, if that names as many columns as it has values.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from liftmesh.errors import FormatError
from liftmesh.io.formats.text.columns import known_header
from liftmesh.io.formats.text.options import TableOptions
from liftmesh.io.formats.text.words import split, with_point, without_remark
from liftmesh.io.limits import check_columns, most_columns
from liftmesh.io.text_tables import is_number, values_at_most

_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)  # the first line of a spreadsheet's file
_ENOUGH = 100  # words of a line
_UNIT_APART = re.compile(r"(?<!\s)\s+(?=[\[(][^\[\]()]*[\])])")  # X [m]


@dataclass(frozen=True, slots=True)
class Layout:
    """Delimiter, number of columns and their names in a text file."""

    delimiter: str | None
    width: int
    header: tuple[str, ...] | None
    in_first_line: bool


def stated_separator(line: str) -> str | None:
    """Return the delimiter that a line ``sep=;`` states; None for any other line."""
    found = _SEPARATOR.fullmatch(line.strip('"'))
    return found[1] if found else None


def sniff(
    first: str, remark: str, where: str, options: TableOptions, *, max_bytes: int | None = None
) -> Layout:
    """Detect the layout from the first line that is not a comment, and the comment before it."""
    most = most_columns(max_bytes)
    if len(first) >= most:  # a shorter line has no more values
        found = values_at_most(first, options.delimiter)
        check_columns(found, max_bytes, where, f"a row of {found:,} values")
    delimiter = _delimiter(first, options)
    first = without_remark(first)
    values = split(first, delimiter, where)
    _check_kind(values[0], where)
    if options.header and not _is_row(values):
        names = _names(first, delimiter, where)
        return Layout(delimiter, len(names), names, in_first_line=True)
    marked = options.header and (len(remark) < most or values_at_most(remark) <= most)
    names = _marked(remark) if marked and remark else ()
    header = names if len(names) == len(values) and known_header(names) else None
    return Layout(delimiter, len(values), header, in_first_line=False)


def before_remark(line: str) -> bool:
    """Whether a row or a header between blanks stands before a #, so that the rest is a comment."""
    words, mark, _ = line.partition("#")
    if not mark or _delimiter(words, TableOptions()) is not None:
        return False
    return _is_header_or_row(words.split(None, _ENOUGH))


def _is_header_or_row(values: list[str]) -> bool:
    return known_header(values) or any(map(is_number, values))


def _is_row(values: list[str]) -> bool:
    """Whether values are those of a point: there is a number, and they do not name x and y."""
    numbers = any(is_number(value) or with_point(value) for value in values)
    return numbers and not known_header(values)


def _names(text: str, delimiter: str | None, where: str) -> tuple[str, ...]:
    """Split a header; units behind a blank belong to the name before them."""
    if delimiter is None:
        text = _UNIT_APART.sub("", text)
    return tuple(split(text, delimiter, where))


def _marked(remark: str) -> tuple[str, ...]:
    """Split a comment like a header; one of other text, with quotes, is none."""
    try:
        return _names(remark, _delimiter(remark, TableOptions()), "")
    except FormatError:
        return ()


def _delimiter(text: str, options: TableOptions) -> str | None:
    if options.delimiter is not None:
        return None if options.delimiter == " " else options.delimiter
    bare = re.sub('"[^"]*"', "", text)
    if ";" in bare:
        return ";"
    if "\t" in bare and (options.decimal == "," or _separates(bare, "\t")):
        return "\t"
    if "|" in bare:
        return "|"
    words = bare.split()
    between_blanks = len(words) > 1 and all(is_number(each) or with_point(each) for each in words)
    stands_alone = options.decimal == "," and '"' not in text
    return "," if "," in bare and not between_blanks and not stands_alone else None


def _separates(text: str, mark: str) -> bool:
    """Whether a mark stands between all values, and not among the blanks between them."""
    pieces = [value.split() for value in text.split(mark)]
    return not any(len(words) > 1 and all(map(is_number, words)) for words in pieces)


def _check_kind(word: str, where: str) -> None:
    if word.lower() in ("ncols", "nrows"):
        name = where.rpartition(": ")[0]
        raise FormatError(
            f"{name}: this is an Arc/Info ASCII grid, not a list of points: read it with "
            "format='raster'"
        )
