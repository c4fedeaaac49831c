"""The layout of a table as text: its encoding, what separates its values, and its header.

The first line that is no comment decides. It is a header if it holds no number, or if it names x
and y; otherwise a comment before it is, if that names as many columns as it has values.

Quotes follow the rules of Python's csv module: a value in quotes may hold the delimiter, and two
quotes stand for one. Between blanks there are no empty values.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from dataclasses import dataclass
from typing import BinaryIO

from liftmesh.errors import FormatError, Option
from liftmesh.io.formats.text.columns import known_header
from liftmesh.io.options import TableOptions, check_columns, most_columns
from liftmesh.io.text_tables import is_number, values_at_most

_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)  # the first line of a spreadsheet's file
_ENOUGH = 100  # words of a line
_UNIT_APART = re.compile(r"(?<!\s)\s+(?=[\[(][^\[\]()]*[\])])")  # X [m]

_UTF8_MARK = b"\xef\xbb\xbf"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_BYTES = 1 << 16
_LINE_END = re.compile(rb"\r\n?|\n")

_REMARK = re.compile(r"(?<!\s)\s+#(?:\s|$)")
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
_GROUPED = re.compile(r"[-+]?\d{1,3},\d{3}")  # 1,234 is also how thousands are grouped
_WORDS = re.compile(r'"((?:[^"]|""){0,131072})"(?!\S)|(\S+)')  # as long as csv's field may be


def as_utf8(stream: BinaryIO, name: str, encoding: str | None = None) -> BinaryIO:
    """Return a stream of UTF-8 without a mark: this one behind its mark, or another converted."""
    if encoding is not None:
        return _converted(stream, name, encoding)
    begin = stream.tell()
    mark = stream.read(3)
    if mark.startswith(_UTF16_MARKS):
        stream.seek(begin)
        return _converted(stream, name, "UTF-16")
    if b"\0" in mark[:2] and mark[:2].strip(b"\0"):
        raise FormatError(
            f"{name}: byte {begin}: the text is UTF-16 without its mark, or no text: save it as "
            "UTF-8"
        )
    stream.seek(begin + len(_UTF8_MARK) if mark == _UTF8_MARK else begin)
    return stream


def _converted(stream: BinaryIO, name: str, encoding: str) -> BinaryIO:
    """Convert text to UTF-8 in memory; of numbers in UTF-16 it takes half as much."""
    decoder = codecs.getincrementaldecoder(encoding)()
    held = io.BytesIO()
    done = False
    while not done:
        data = stream.read(_BYTES)
        done = not data
        try:
            text = decoder.decode(data, final=done)
            held.write((text if held.tell() else text.removeprefix("\ufeff")).encode())
        except UnicodeError as error:
            raise FormatError(
                f"{name}: byte {stream.tell()} or before: the text is damaged {encoding} "
                f"({error}): save it as UTF-8"
            ) from error
    held.seek(0)
    return held


def skip_lines(stream: BinaryIO, count: int, name: str) -> None:
    """Move behind a number of lines, whatever ends them."""
    left = count
    while left:
        begin = stream.tell()
        data = stream.read(_BYTES)
        if not data:
            raise FormatError(
                f"{name}: the file has {count - left:,} lines, and {Option('skip_rows', count)} "
                "skips more"
            )
        if data.endswith(b"\r") and stream.read(1) == b"\n":  # the other half of a line end
            data += b"\n"
        stream.seek(begin + len(data))
        for end in _LINE_END.finditer(data):
            left -= 1
            if not left:
                stream.seek(begin + end.end())
                return


@dataclass(frozen=True, slots=True)
class Layout:
    """Delimiter, number of columns and their names in a text file."""

    delimiter: str | None  # None: white space
    width: int
    header: tuple[str, ...] | None  # None if there is none
    in_first_line: bool  # else in a comment before it


def sniff(
    first: str, remark: str, where: str, options: TableOptions, *, max_bytes: int | None = None
) -> Layout:
    """Detect the layout from the first line that is not a comment, and the comment before it."""
    most = most_columns(max_bytes)
    if len(first) >= most:  # a shorter line has no more values
        count = values_at_most(first, options.delimiter)
        check_columns(count, max_bytes, where, f"a row of {count:,} values")
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


def stated_separator(line: str) -> str | None:
    """Return the delimiter that a line ``sep=;`` states; None for any other line."""
    match = _SEPARATOR.fullmatch(line.strip('"'))
    return match[1] if match else None


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
            f"{Option('format', 'raster')}"
        )


def split(text: str, delimiter: str | None, where: str) -> list[str]:
    """Split a line into its values, without their quotes and the blanks around them."""
    if '"' not in text:
        return [value.strip() for value in text.split(delimiter)]
    if delimiter is None:
        pairs = (match.groups(default="") for match in _WORDS.finditer(text))
        return [(quoted.replace('""', '"') or bare).strip() for quoted, bare in pairs]
    try:
        rows = [*csv.reader([text], delimiter=delimiter, skipinitialspace=True, strict=True)]
    except csv.Error as error:
        raise FormatError(
            f"{where}: its quotes are not closed, or text follows them ({error}): a value in "
            "quotes must stand on one line"
        ) from error
    return [value.strip() for value in rows[0]]


def without_remark(text: str) -> str:
    """Cut off a comment behind a row: a # with a blank on each side, outside quotes."""
    match = _REMARK.search(text) if "#" in text else None
    return text if match is None or text.count('"', 0, match.start()) % 2 else text[: match.start()]


def with_point(value: str) -> str:
    """Return a number with a decimal comma as one with a point; "" if it is none."""
    return value.replace(",", ".") if _COMMA.fullmatch(value) else ""


def may_be_grouped(value: str) -> bool:
    """Whether the comma of a number may separate thousands."""
    return _GROUPED.fullmatch(value) is not None
