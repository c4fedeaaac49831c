"""Tables of numbers as text: lines are read in blocks, parsed and printed by the kernel.

*Lines.* A block of bytes ends with the last line end in it, whether the file ends its lines with
LF, CR LF or CR: so a block is small, and only a line longer than that makes it larger. Its lines
are found, stripped and numbered by the kernel; they become strings only where a reader looks at
their words.

*Reading.* Every number is rounded as Python's `float` rounds it. When the kernel refuses a block of
lines, they are examined one by one to report the line and the value. Of lines that differ in
length, as the faces of text files do, the words of a block are parsed into one list: so lines of
all lengths are as fast as a table, and a line of a million words takes no more memory than a
million lines.

*Writing.* Doubles are written as by Python's ``repr``, the shortest digits that round-trip. Single
precision gets nine significant digits: these round-trip even if a reader rounds to double first,
which the shortest digits do not guarantee.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask
from liftmesh.base.options import as_threads
from liftmesh.errors import FormatError, Option
from liftmesh.io.columns import Ragged
from liftmesh.io.options import MOST_COLUMNS
from liftmesh.io.streams import kept_place

if TYPE_CHECKING:
    from collections import Counter

_WORD = re.compile(r"\S+")

_VALUES = 1 << 18  # printed at a time
_MOST_KINDS = 1000


def number_table(
    block: Block, name: str, *, width: int | None = None, delimiter: str | None = None
) -> Floats:
    """Parse every line of a block as ``width`` numbers (by default as many as its first line)."""
    if not len(block):  # pragma: no cover - readers hand over lines
        return np.empty((0, width or 0))
    if block.long:
        _check_widths(block, name, width, delimiter)
    begin, end = block.places[0].tolist()
    mark = delimiter or ""
    columns = width or _kernel.count_values(block.plain[begin:end], mark)
    threads, _ = as_threads(None, len(block))
    table = _kernel.parse_table(block.plain, block.places, columns, mark, threads)
    if table is None:
        raise line_error(block, name, columns, delimiter)
    return table


def ragged_numbers(block: Block, name: str) -> Ragged:
    """Parse lines of numbers: int64 if all are whole numbers written as such, else float64."""
    threads, _ = as_threads(None, len(block))
    parsed = _kernel.parse_numbers(block.plain, block.places, threads)
    if parsed is None:
        raise line_error(block, name)
    return Ragged(*parsed)


def regrouped(tables: Iterable[Floats], rows: int) -> Iterator[Floats]:
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


def write_rows(
    stream: BinaryIO,
    columns: Sequence[Array],
    *,
    prefix: str = "",
    end: str = "\n",
    between: str | Sequence[str] = " ",
    shortest: bool = False,
    plus: int = 0,
) -> None:
    """Write one line per row: ``prefix``, then the values of all columns, then ``end``."""
    flat = [part for each in columns for part in ([each] if each.ndim == 1 else each.T)]
    marks = [between] * (len(flat) - 1) if isinstance(between, str) else between
    threads, _ = as_threads(None, len(flat) * len(flat[0]))
    printer = _kernel.Printer([prefix, *marks, end], shortest, threads)
    rows = max(_VALUES // len(flat), 1)
    texts: list[memoryview] = []
    for start in range(0, len(flat[0]), rows):
        printer.begin([_printable(each[start : start + rows], plus) for each in flat])
        _write(stream, texts)  # while other threads print the rows that follow
        texts = printer.finish()
    _write(stream, texts)


def _write(stream: BinaryIO, texts: Sequence[memoryview]) -> None:
    for text in texts:  # noqa: FURB122 - streams may only `write`
        stream.write(text)


def _printable(column: Array, plus: int) -> Array:
    """Convert a column, if necessary, to a type that the kernel prints."""
    kind, size = column.dtype.kind, column.dtype.itemsize
    if kind == "b":
        column = column.view(np.uint8)
    elif kind == "f":
        column = column.astype(np.float64 if size >= 8 else np.float32, copy=False)
    elif not column.dtype.isnative:
        column = column.astype(column.dtype.newbyteorder("="))
    if plus:
        column = column + np.int32(plus)  # indices of rows stay below the largest int32
    aligned = column.strides[0] % column.itemsize == 0
    return column if aligned else np.ascontiguousarray(column)


def exact_values(
    values: Array, dtype: np.dtype, name: str, what: str, line_of: Callable[[int], int]
) -> Array:
    """Convert parsed numbers to the type in the header; raise if a value is not of that type."""
    with np.errstate(invalid="ignore", over="ignore"):
        converted = values.astype(dtype)
    if dtype.kind in "iu":
        differ = converted != values
        if dtype.itemsize == 8 and values.dtype.kind == "f":
            differ |= np.abs(values) >= 2.0**53
        if differ.any():
            wrong = int(np.argmax(differ))
            raise FormatError(
                f"{name}: line {line_of(wrong)}: {what} is {values[wrong]!s}, which is not {dtype}"
            )
    return converted


def whole(values: Array, dtype: type[np.integer[Any]]) -> Array:
    """Convert whole numbers to a type of integers."""
    kept = np.iinfo(dtype)
    if values.dtype.kind == "f":  # in which the greatest may be one more
        fits = (values >= kept.min) & (values < kept.max + 1.0) & (values == np.rint(values))
    else:
        fits = (values >= kept.min) & (values <= kept.max)
    if not fits.all():
        raise ValueError(f"{values[np.argmin(fits)]} is not an index")
    return values.astype(dtype, copy=False)


def _check_widths(block: Block, name: str, width: int | None, delimiter: str | None) -> None:
    """Raise for a line of too many values before it is split: values take more than their text."""
    expected = f"{width}" if width else f"at most {MOST_COLUMNS:,}"
    most = width or MOST_COLUMNS
    for text, number in block:
        if len(text.split(delimiter, most)) > most:
            count = text.count(delimiter) + 1 if delimiter else _count_words(text)
            raise FormatError(f"{name}: line {number}: expected {expected} values, found {count:,}")


def line_error(
    block: Block, name: str, expected: int | None = None, delimiter: str | None = None
) -> FormatError:
    """Describe the first line that is not a row of numbers, of the expected width if any."""
    return next(_line_errors(block, name, expected, delimiter))


def _line_errors(
    block: Block, name: str, expected: int | None, delimiter: str | None
) -> Iterator[FormatError]:
    for text, number in block:
        position = 0
        for position, value in enumerate(_values(text, delimiter), start=1):
            if not is_number(value) or not value.strip().isascii():
                yield FormatError(
                    f"{name}: line {number}, value {position}: {quoted(value)} is not a number"
                )
        if expected is not None and position != expected:
            yield FormatError(
                f"{name}: line {number}: expected {expected} values, found {position}"
            )


def _values(text: str, delimiter: str | None) -> Iterable[str]:
    """The values of a line; those between white space one by one, as there may be many."""
    return fields(text, delimiter) if delimiter else words_of(text)


def words_of(text: str) -> Iterator[str]:
    """The words of a text, one by one: a line may have very many."""
    return map(re.Match.group, _WORD.finditer(text))


def fields(text: str, delimiter: str | None) -> list[str]:
    """Split a line into its values."""
    return [value.strip().strip('"') for value in text.split(delimiter)]


def is_number(text: str) -> bool:
    """Whether a string is a number as files write it (Python also allows 1_000)."""
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text


def values_at_most(text: str, delimiter: str | None = None) -> int:
    """Count the values of a line, whatever separates them, without splitting it."""
    marks = {",", ";", "\t", "|", delimiter or " "}
    return max(_count_words(text), *(text.count(mark) + 1 for mark in marks - {" "}))


def _count_words(text: str) -> int:
    return sum(1 for _ in words_of(text))


def is_count(text: str, digits: int = 18) -> bool:
    """Whether a text is a whole number from 0, of so many digits at most, as headers state them."""
    return text.isascii() and text.isdigit() and len(text) <= digits


def shortened(text: str, most: int = 40) -> str:
    """Shorten a piece of a file for a message: invalid files may have long lines."""
    return text if len(text) <= most else text[: most - 3] + "..."


def quoted(text: str) -> str:
    """Quote a piece of a file, shortened."""
    return repr(shortened(text))


def count_kind(counts: Counter[str], kind: str) -> None:
    """Count what is of a kind, under "..." if a file has too many of them."""
    known = kind in counts or len(counts) < _MOST_KINDS
    counts[kind if known else "..."] += 1


BLOCK = 1 << 17  # lines taken at a time, at most

_BYTES = 1 << 21
_LONG = 1 << 19  # bytes of a line
_COMMENTS = 1 << 10  # lines looked at together

# White space beyond ASCII, in the encodings that files are read in.
_WIDE_BLANKS = {
    "latin-1": re.compile(rb"[\x85\xa0]"),
    "utf-8": re.compile(
        rb"\xc2[\x85\xa0]|\xe1\x9a\x80|\xe2\x80[\x80-\x8a\xa8\xa9\xaf]|\xe2\x81\x9f|\xe3\x80\x80"
    ),
}

_BYTES_OF_A_LINE = 16  # about: decides how many threads look for lines

_BLANKS_BEHIND = re.compile(rb"\\[ \t\v\f]+(?=\n|\Z)")


@dataclass(frozen=True, slots=True)
class Block:
    """Stripped lines, and the number of each in the file, counted from 1."""

    data: bytes
    plain: bytes  # with ASCII blanks for other white space: numbers are parsed from it
    places: Integers  # (n, 2), where each line begins and ends in data
    numbers: Integers
    encoding: str
    long: bool = False  # whether a line is too long for its words to become strings

    @classmethod
    def empty(cls, encoding: str = "latin-1") -> Block:
        """Return a block without lines."""
        return cls(b"", b"", np.empty((0, 2), np.int64), np.empty(0, np.int64), encoding)

    @classmethod
    def of(cls, texts: Sequence[str], numbers: Integers) -> Block:
        """Make a block of lines that were changed; they must be stripped and not empty."""
        data = "\n".join(texts).encode()
        places, _, _ = _kernel.find_lines(data, (), True, 1)
        return cls(data, data, places, numbers, "utf-8")

    def __len__(self) -> int:
        return len(self.places)

    def __iter__(self) -> Iterator[tuple[str, int]]:
        return zip(self.texts, self.numbers.tolist(), strict=True)

    def __getitem__(self, rows: slice | Mask) -> Block:
        # Copies: a view of one line would keep the places of all others.
        return replace(self, places=self.places[rows].copy(), numbers=self.numbers[rows].copy())

    @property
    def texts(self) -> list[str]:
        """The lines as strings."""
        places = self.places.tolist()
        return [self.data[begin:end].decode(self.encoding) for begin, end in places]

    def behind(self, prefix: int | Integers) -> Block:
        """Leave out that many bytes at the beginning of each line."""
        places = self.places.copy()
        places[:, 0] += prefix
        return replace(self, places=places)

    def followed_by(self, other: Block) -> Block:
        """Join the lines of two blocks."""
        if not len(self):
            return other
        begin, end = int(self.places[0, 0]), int(self.places[-1, 1])
        shift = end - begin
        return Block(
            self.data[begin:end] + other.data,
            self.plain[begin:end] + other.plain,
            np.concatenate([self.places - begin, other.places + shift]),
            np.concatenate([self.numbers, other.numbers]),
            self.encoding,
            self.long or other.long,
        )


@dataclass(frozen=True, slots=True)
class Syntax:
    """What the lines of a format are."""

    comments: tuple[str, ...] = ()  # begin lines, and with # the text behind it, that do not count
    whole: bool = False  # whether only whole lines are comments
    continued: bool = False  # whether a backslash at its end joins a line to the next
    keep_tabs: bool = False  # at the ends of lines, where they may separate empty values


_PLAIN = Syntax()
HASH = Syntax(comments=("#",))


class Lines:
    """The non-empty lines of a stream, taken block by block."""

    def __init__(
        self,
        stream: BinaryIO,
        name: str,
        syntax: Syntax = _PLAIN,
        *,
        encoding: str = "latin-1",
        before: int = 0,
        sought: bytes = b"",
    ) -> None:
        self.number = before  # of the last line taken
        self.remarks = (0, 0)  # the first whole comment behind other lines, and how many
        self.found = False  # whether what was read holds `sought`, comments included
        self._sought = sought
        self._stream = stream
        self._name = name
        self._encoding = encoding
        self._syntax = syntax
        self._read = before
        self._held = Block.empty(encoding)
        self._taken = 0
        self._has_rows = False

    def take(self, count: int) -> Block:
        """Take at most ``count`` lines; fewer if that is faster, none at the end."""
        if not count or not self._fill():
            return self._held[:0]
        block = self._held
        if self._taken or count < len(block):
            block = block[self._taken : self._taken + count]
        self._taken += len(block)
        self.number = int(block.numbers[-1])
        return block

    def next(self) -> str:
        """Take one line; an empty string at the end."""
        if not self._fill():
            return ""
        self.number = int(self._held.numbers[self._taken])
        self._taken += 1
        return self._held[self._taken - 1 : self._taken].texts[0]

    def _fill(self) -> bool:
        """Hold lines that are not taken; False at the end."""
        while self._taken == len(self._held):
            self._held, self._taken = self._held[:0], 0  # not two blocks at a time
            data = self._chunk()
            if not data:
                return False
            self._held, self._taken = self._block(data), 0
        return True

    def _chunk(self) -> bytes:
        """Read whole lines, and those that continue the last of them."""
        parts: list[bytes] = []
        while data := self._stream.read(_BYTES):
            parts.append(data)
            # CR as the last byte may be half of a line end.
            end = max(data.rfind(b"\n"), data.rfind(b"\r", 0, len(data) - 1)) + 1
            if end and not (self._syntax.continued and _continues(data[:end])):
                self._stream.seek(end - len(data), os.SEEK_CUR)
                parts[-1] = data[:end]
                break
        return b"".join(parts)

    def _block(self, data: bytes) -> Block:
        if self._sought and not self.found:
            self.found = _holds(data, self._sought)
        if b"\r" in data:
            data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        last: Mask | None = None
        if self._syntax.continued and b"\\" in data:
            data = _BLANKS_BEHIND.sub(rb"\\", data.removesuffix(b"\n")).removesuffix(b"\\")
            last = _last_of_lines(data)
            data = data.replace(b"\\\n", b"  ")
        plain = data if data.isascii() else self._plain(data)
        threads, _ = as_threads(None, len(data) // _BYTES_OF_A_LINE)
        marks = () if self._syntax.whole else self._syntax.comments
        places, numbers, count = _kernel.find_lines(plain, marks, self._syntax.keep_tabs, threads)
        if last is not None:
            numbers, count = np.flatnonzero(last)[numbers], len(last)
        numbers += self._read + 1
        self._read += count
        if self._syntax.whole and any(
            _holds(data, mark.encode()) for mark in self._syntax.comments
        ):
            rows = ~_begin_with(data, places, self._syntax.comments)
            self._notice_remarks(rows, numbers)
            places, numbers = places[rows], numbers[rows]
        self._has_rows = self._has_rows or len(places) > 0
        long = bool((places[:, 1] - places[:, 0] > _LONG).any())
        return Block(data, plain, places, numbers, self._encoding, long)

    def _notice_remarks(self, rows: Mask, numbers: Integers) -> None:
        """Remember the comments behind the first line that is none."""
        behind = ~rows if self._has_rows else ~rows & np.logical_or.accumulate(rows)
        first, count = self.remarks
        remarks = numbers[behind]
        if len(remarks):
            self.remarks = (first or int(remarks[0]), count + len(remarks))

    def _plain(self, data: bytes) -> bytes:
        """Put blanks in place of white space that is not ASCII, byte by byte."""
        self._check_encoding(data)
        return _WIDE_BLANKS[self._encoding].sub(lambda match: b" " * len(match[0]), data)

    def _check_encoding(self, data: bytes) -> None:
        try:
            data.decode(self._encoding)
        except UnicodeDecodeError as error:
            begin = data.rfind(b"\n", 0, error.start) + 1
            line = self._read + 1 + data.count(b"\n", 0, error.start)
            raise FormatError(
                f"{self._name}: line {line}: byte {error.start - begin} of the line "
                f"(0x{data[error.start]:02x}) is not UTF-8: save the file as UTF-8 text, or if it "
                f"is a table, read it with {Option('encoding', 'cp1252')} (or cp1250 for Central "
                "Europe, cp932 for Japan)"
            ) from error


def _continues(data: bytes) -> bool:
    """Whether the next line continues the last of these; also if it begins before them."""
    body = data[:-1].removesuffix(b"\r")
    line = body[max(body.rfind(b"\n"), body.rfind(b"\r")) + 1 :].rstrip()
    return line.endswith(b"\\") or (not line and b"\n" not in body and b"\r" not in body)


def _holds(data: bytes, mark: bytes) -> bool:
    """Whether a mark is in the data: a search for one byte is ten times as fast as for two."""
    return mark[:1] in data and mark in data


def _begin_with(data: bytes, places: Integers, marks: tuple[str, ...]) -> Mask:
    """Whether each line begins with one of the marks."""
    octets = np.frombuffer(data, np.uint8)
    begins, lengths = places[:, 0], places[:, 1] - places[:, 0]
    is_marked = np.zeros(len(places), dtype=np.bool_)
    for mark in marks:
        at = begins[lengths >= len(mark)]
        same = [octets[at + k] == octet for k, octet in enumerate(mark.encode())]
        is_marked[lengths >= len(mark)] |= np.logical_and.reduce(same)
    return is_marked


def _last_of_lines(data: bytes) -> Mask:
    """Whether each line is the last of those that continuation joins."""
    octets = np.frombuffer(data, np.uint8)
    ends = octets == ord("\n")
    joined = np.zeros(len(octets), dtype=bool)
    joined[1:] = ends[1:] & (octets[:-1] == ord("\\"))
    last = np.ones(np.count_nonzero(ends) + 1, dtype=bool)
    last[:-1] = ~joined[ends]
    return last


def promised(lines: Lines, wanted: int, what: str, name: str) -> Iterator[Block]:
    """Take as many lines as a header promises; raise if there are fewer."""
    left = wanted
    while left:
        block = lines.take(min(left, BLOCK))
        if not len(block):
            raise FormatError(
                f"{name}: line {lines.number}: the header promises {wanted} {what}, but "
                f"{wanted - left} are there: the file is truncated, or its header is wrong"
            )
        yield block
        left -= len(block)


def check_end(lines: Lines, name: str) -> None:
    """Raise for lines beyond those that a header promises: they would be lost."""
    if len(lines.take(1)):
        raise FormatError(
            f"{name}: line {lines.number}: more rows follow than the header promises: "
            "correct its counts"
        )


def leading_comments(
    stream: BinaryIO, name: str, *, encoding: str = "latin-1", marks: tuple[str, ...] = ("#",)
) -> Generator[str, None, None]:
    """Yield the comments at the top of a file, and restore the position of the stream."""
    lines = Lines(stream, name, encoding=encoding)
    with kept_place(stream):
        while len(block := lines.take(_COMMENTS)):
            for line in block.texts:
                if not line.startswith(marks):
                    return
                yield line.lstrip("".join(marks) + " \t")
