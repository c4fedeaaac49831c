"""Tables of numbers as text: lines are parsed in blocks, rows printed in blocks, by the kernel.

Reading: every number is rounded as Python's `float` rounds it. When the kernel refuses a block of
lines, they are examined one by one to report the line and the value. Of lines that differ in
length, as the faces of text files do, the words of a block are parsed into one list: so lines of
all lengths are as fast as a table, and a line of a million words takes no more memory than a
million lines.

Writing: doubles are written as by Python's ``repr``, the shortest digits that round-trip. Single
precision gets nine significant digits: these round-trip even if a reader rounds to double first,
which the shortest digits do not guarantee.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats
from liftmesh.base.options import as_threads
from liftmesh.errors import FormatError
from liftmesh.io.faces import Ragged
from liftmesh.io.limits import MOST_COLUMNS

if TYPE_CHECKING:
    from liftmesh.io.lines import Block


_WORD = re.compile(r"\S+")

_VALUES = 1 << 18  # printed at a time


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
    fits = (values >= kept.min) & (values <= kept.max)
    if values.dtype.kind == "f":
        fits &= values == np.rint(values)
    if not fits.all():
        raise ValueError(f"{values[np.argmin(fits)]} is not an index")
    return values.astype(dtype)


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
