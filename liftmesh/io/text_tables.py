"""Tables of numbers as text: lines are read and parsed in blocks, rows written in blocks.

Reading: ``numpy.loadtxt`` is fast, and rounds every number exactly as Python does. When it rejects
a block of lines, they are examined one by one to report the line and the value.

Writing: doubles are written by Python's ``repr``, the shortest digits that round-trip. Single
precision gets nine significant digits: these round-trip even if a reader rounds to double first,
which the shortest digits do not guarantee.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats, Integers, Mask
from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Iterator


BLOCK = 1 << 17

_BYTES = 1 << 22


@dataclass(frozen=True, slots=True)
class Block:
    """Stripped lines, and the number of each in the file, counted from 1."""

    texts: list[str]
    numbers: Integers

    def __len__(self) -> int:
        return len(self.texts)

    def __iter__(self) -> Iterator[tuple[str, int]]:
        return zip(self.texts, self.numbers.tolist(), strict=True)

    def __getitem__(self, rows: slice | Mask) -> Block:
        if isinstance(rows, slice):
            return Block(self.texts[rows], self.numbers[rows])
        return Block([self.texts[k] for k in np.flatnonzero(rows).tolist()], self.numbers[rows])


class Lines:
    """The non-empty lines of a stream, taken block by block.

    Empty lines are skipped but counted. With ``comments``, so are lines that begin with one of
    them, and a ``#`` and the text after it are removed. With ``continued``, a backslash at the end
    of a line joins it to the next. ``number`` is that of the last line taken.
    """

    def __init__(
        self,
        stream: BinaryIO,
        name: str,
        *,
        encoding: str = "latin-1",
        comments: tuple[str, ...] = (),
        continued: bool = False,
        before: int = 0,
    ) -> None:
        self.number = before
        self._stream = stream
        self._name = name
        self._encoding = encoding
        self._comments = comments
        self._continued = continued
        self._read = before
        self._held = Block([], np.empty(0, dtype=np.int64))
        self._taken = 0

    def take(self, count: int) -> Block:
        """Take at most ``count`` lines; fewer if that is faster, none at the end."""
        while self._taken == len(self._held) and count:
            data = self._chunk()
            if not data:
                break
            self._held = self._block(self._decoded(data))
            self._taken = 0
        block = self._held[self._taken : self._taken + count]
        self._taken += len(block)
        if len(block):
            self.number = int(block.numbers[-1])
        return block

    def next(self) -> str:
        """Take one line; an empty string at the end."""
        block = self.take(1)
        return block.texts[0] if len(block) else ""

    def _chunk(self) -> bytes:
        """Read whole lines."""
        parts = [self._stream.read(_BYTES), self._stream.readline()]
        while self._continued and (parts[-1] or parts[0]).rstrip(b"\r\n").endswith(b"\\"):
            more = self._stream.readline()
            if not more:
                break
            parts.append(more)
        return b"".join(parts)

    def _decoded(self, data: bytes) -> str:
        try:
            return data.decode(self._encoding)
        except UnicodeDecodeError as error:
            begin = data.rfind(b"\n", 0, error.start) + 1
            line = self._read + 1 + data.count(b"\n", 0, error.start)
            raise FormatError(
                f"{self._name}: line {line}: byte {error.start - begin} of the line "
                f"(0x{data[error.start]:02x}) is not UTF-8: save the file as UTF-8 text"
            ) from error

    def _block(self, text: str) -> Block:
        if "\r" in text:
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        lines = text.removesuffix("\n").split("\n")
        numbers = np.arange(self._read + 1, self._read + 1 + len(lines))
        self._read += len(lines)
        if self._continued and "\\\n" in text:
            lines = _joined(lines)
        texts = [line.strip() for line in lines]
        if any(mark in text for mark in self._comments):
            texts = [self._bare(line) for line in texts]
        block = Block(texts, numbers)
        return block if all(texts) else block[np.array(texts, dtype=object) != ""]

    def _bare(self, text: str) -> str:
        return "" if text.startswith(self._comments) else text.partition("#")[0].rstrip()


def _joined(lines: list[str]) -> list[str]:
    """Join continued lines: the last of them holds the text, the others become empty."""
    joined: list[str] = []
    held: list[str] = []
    for line in lines:
        bare = line.rstrip()
        if bare.endswith("\\"):
            held.append(bare[:-1])
            joined.append("")
        else:
            joined.append(" ".join([*held, line]))
            held.clear()
    return [*joined[:-1], " ".join(held) or joined[-1]]


def leading_comments(
    stream: BinaryIO, name: str, *, encoding: str = "latin-1", marks: tuple[str, ...] = ("#",)
) -> list[str]:
    """Read the comments at the top of a file, and restore the position of the stream."""
    begin = stream.tell()
    lines = Lines(stream, name, encoding=encoding)
    found: list[str] = []
    while (line := lines.next()).startswith(marks):
        found.append(line.lstrip("".join(marks) + " \t"))
    stream.seek(begin)
    return found


def number_table(
    block: Block, name: str, *, width: int | None = None, delimiter: str | None = None
) -> Floats:
    """Parse every line of a block as ``width`` numbers (by default as many as its first line).

    Raises
    ------
    FormatError
        A line has a different number of values, or a value is not a number.
    """
    if not block.texts:
        return np.empty((0, width or 0))
    texts = block.texts
    if delimiter and any('"' in text for text in texts):
        # At lines of nothing NumPy only warns; a delimiter has a value on either side.
        texts = [text.replace('"', "") or delimiter for text in texts]
    try:
        table = np.loadtxt(texts, delimiter=delimiter, comments=None, ndmin=2, dtype=float)
    except ValueError as error:
        _raise_for_line(block, name, width, delimiter)
        raise FormatError(f"{name}: line {block.numbers[0]} or later: {error}") from error
    if table.shape != (len(block), width or table.shape[1]):
        _raise_for_line(block, name, width, delimiter)
        raise FormatError(f"{name}: line {block.numbers[0]} or later: a line is invalid")
    return table


def exact_column(
    column: Floats, dtype: np.dtype, name: str, what: str, numbers: Integers
) -> NDArray[np.generic]:
    """Convert parsed numbers to the type in the header; raise if a value is not of that type."""
    with np.errstate(invalid="ignore", over="ignore"):
        converted = column.astype(dtype)
    if dtype.kind in "iu":
        wide = dtype.itemsize == 8
        wrong = np.flatnonzero((converted != column) | (wide & (np.abs(column) >= 2.0**53)))
        if len(wrong):
            row = int(wrong[0])
            raise FormatError(
                f"{name}: line {numbers[row]}: {what} is {column[row]!s}, which is not {dtype}"
            )
    return converted


def _raise_for_line(block: Block, name: str, width: int | None, delimiter: str | None) -> None:
    """Raise for the first line that is not a row of numbers of the expected width."""
    expected = width or len(fields(block.texts[0], delimiter))
    for text, number in block:
        values = fields(text, delimiter)
        for position, value in enumerate(values, start=1):
            if not is_number(value):
                raise FormatError(
                    f"{name}: line {number}, value {position}: {quoted(value)} is not a number"
                )
        if len(values) != expected:
            raise FormatError(
                f"{name}: line {number}: expected {expected} values, found {len(values)}"
            )


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


def shortened(text: str) -> str:
    """Shorten a piece of a file for a message: invalid files may have long lines."""
    return text if len(text) <= 40 else text[:37] + "..."


def quoted(text: str) -> str:
    """Quote a piece of a file, shortened."""
    return repr(shortened(text))


ROWS = 1 << 15


def write_rows(
    stream: BinaryIO, columns: Sequence[Array], *, prefix: str = "", template: str = ""
) -> None:
    """Write one line per row: ``prefix``, then the values of all columns, separated by spaces.

    Columns are (n,) or (n, k) arrays of float, integers, or ready-made strings (dtype object);
    ``template`` replaces the format of the whole line.
    """
    specifiers = " ".join(chain.from_iterable(map(_specifiers, columns)))
    template = template or f"{prefix}{specifiers}\n"
    for start in range(0, len(columns[0]), ROWS):
        flat = [part for each in columns for part in _flat(each[start : start + ROWS])]
        values = tuple(chain.from_iterable(zip(*flat, strict=True)))
        stream.write(((template * len(flat[0])) % values).encode("ascii"))


def _specifiers(column: Array) -> Iterable[str]:
    kind = column.dtype.kind
    single = kind == "f" and column.dtype.itemsize < 8
    specifier = "%.9g" if single else {"f": "%r", "O": "%s"}.get(kind, "%d")
    return [specifier] * (column.shape[1] if column.ndim == 2 else 1)


def _flat(block: Array) -> list[list[Any]]:
    return [block.tolist()] if block.ndim == 1 else [column.tolist() for column in block.T]
