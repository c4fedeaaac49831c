"""Tables of numbers as text: lines are parsed in blocks, rows written in blocks.

Reading: ``numpy.loadtxt`` is fast, and rounds every number exactly as Python does. When it rejects
a block of lines, they are examined one by one to report the line and the value.

Writing: doubles are written by Python's ``repr``, the shortest digits that round-trip. Single
precision gets nine significant digits: these round-trip even if a reader rounds to double first,
which the shortest digits do not guarantee.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError
from liftmesh.io.limits import MOST_COLUMNS

if TYPE_CHECKING:
    from liftmesh.io.lines import Block
_WORD = re.compile(r"\S+")


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
    if block.long:
        _check_widths(block, name, width, delimiter)
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


def _check_widths(block: Block, name: str, width: int | None, delimiter: str | None) -> None:
    """Raise for a line of too many values before it is split: values take more than their text."""
    expected = f"{width}" if width else f"at most {MOST_COLUMNS:,}"
    most = width or MOST_COLUMNS
    for text, number in block:
        if len(text.split(delimiter, most)) > most:
            found = text.count(delimiter) + 1 if delimiter else _count_words(text)
            raise FormatError(f"{name}: line {number}: expected {expected} values, found {found:,}")


def values_at_most(text: str) -> int:
    """Count the values of a line, whatever separates them, without splitting it."""
    return max(_count_words(text), *(text.count(mark) + 1 for mark in ",;\t"))


def _count_words(text: str) -> int:
    return sum(1 for _ in _WORD.finditer(text))


def exact_values(
    values: Array, dtype: np.dtype, name: str, what: str, line_of: Callable[[int], int]
) -> Array:
    """Convert parsed numbers to the type in the header; raise if a value is not of that type.

    ``line_of`` gives the line of the value at a position.
    """
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


def _raise_for_line(block: Block, name: str, width: int | None, delimiter: str | None) -> None:
    """Raise for the first line that is not a row of numbers of the expected width."""
    raise_for_numbers(block, name, width or len(fields(block.texts[0], delimiter)), delimiter)


def raise_for_numbers(
    block: Block, name: str, expected: int | None = None, delimiter: str | None = None
) -> None:
    """Raise for the first line that is not a row of numbers, of the expected width if any."""
    for text, number in block:
        position = 0
        for position, value in enumerate(_values(text, delimiter), start=1):
            if not is_number(value):
                raise FormatError(
                    f"{name}: line {number}, value {position}: {quoted(value)} is not a number"
                )
        if expected is not None and position != expected:
            raise FormatError(
                f"{name}: line {number}: expected {expected} values, found {position}"
            )


def _values(text: str, delimiter: str | None) -> Iterable[str]:
    """The values of a line; those between white space one by one, as there may be many."""
    return fields(text, delimiter) if delimiter else map(re.Match.group, _WORD.finditer(text))


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
