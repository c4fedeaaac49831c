"""Lines of text turned into tables of numbers; errors name the line.

``numpy.loadtxt`` parses: fast, and every number rounds exactly as Python rounds it. When it
refuses a block of lines, they are looked at one by one for the line and the value to blame.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liftmesh.errors import FormatError

BLOCK = 1 << 17


@dataclass(frozen=True, slots=True)
class Block:
    """Lines without their line ends, and the number of each in the file, counted from 1."""

    texts: list[str]
    numbers: list[int]

    def __len__(self) -> int:
        return len(self.texts)


class Lines:
    """The lines of a stream that hold something, taken block by block.

    Lines that are empty, or begin with one of ``comments``, are passed over but counted; with
    comments, what follows a ``#`` is cut off.
    """

    def __init__(
        self,
        raw: Iterable[bytes],
        name: str,
        *,
        encoding: str = "latin-1",
        comments: tuple[str, ...] = (),
        before: int = 0,
    ) -> None:
        self.number = before
        self._raw = iter(raw)
        self._name = name
        self._encoding = encoding
        self._comments = comments

    def __iter__(self) -> Iterator[str]:
        for raw in self._raw:
            self.number += 1
            text = self._bare(self._decoded(raw).strip())
            if text:
                yield text

    def _bare(self, text: str) -> str:
        if not self._comments:
            return text
        return "" if text.startswith(self._comments) else text.partition("#")[0].rstrip()

    def _decoded(self, raw: bytes) -> str:
        try:
            return raw.decode(self._encoding)
        except UnicodeDecodeError as error:
            raise FormatError(
                f"{self._name}: line {self.number}: byte {error.start} of the line "
                f"(0x{raw[error.start]:02x}) is not UTF-8: not a text file, or save it as UTF-8"
            ) from error

    def take(self, count: int) -> Block:
        """Take at most ``count`` lines."""
        texts: list[str] = []
        numbers: list[int] = []
        if count > 0:
            for text in self:
                texts.append(text)
                numbers.append(self.number)
                if len(texts) == count:
                    break
        return Block(texts, numbers)


def number_table(
    block: Block, name: str, *, width: int | None = None, delimiter: str | None = None
) -> NDArray[np.float64]:
    """Parse every line of a block as ``width`` numbers (by default as many as its first line).

    Raises
    ------
    FormatError
        A line has another number of values, or a value is no number.
    """
    if not block.texts:
        return np.empty((0, width or 0))
    quote = '"' if delimiter else None
    try:
        table = np.loadtxt(
            block.texts, delimiter=delimiter, comments=None, quotechar=quote, ndmin=2, dtype=float
        )
    except ValueError as error:
        _blame(block, name, width, delimiter)
        raise FormatError(f"{name}: line {block.numbers[0]} or later: {error}") from error
    if table.shape != (len(block), width or table.shape[1]):
        _blame(block, name, width, delimiter)
        raise FormatError(f"{name}: line {block.numbers[0]} or later: a quote is not closed")
    return table


def exact_column(
    column: NDArray[np.float64], dtype: np.dtype, name: str, what: str, numbers: Sequence[int]
) -> NDArray[np.generic]:
    """Convert parsed numbers to the type a header promises, or name the line that cannot be."""
    with np.errstate(invalid="ignore", over="ignore"):
        converted = column.astype(dtype)
    if dtype.kind in "iu":
        wide = dtype.itemsize == 8
        wrong = np.flatnonzero((converted != column) | (wide & (np.abs(column) >= 2.0**53)))
        if len(wrong):
            row = int(wrong[0])
            raise FormatError(
                f"{name}: line {numbers[row]}: {what} is {column[row]!s}, which is no {dtype}"
            )
    return converted


def _blame(block: Block, name: str, width: int | None, delimiter: str | None) -> None:
    expected = width or len(fields(block.texts[0], delimiter))
    for text, number in zip(block.texts, block.numbers, strict=True):
        values = fields(text, delimiter)
        for position, value in enumerate(values, start=1):
            if not is_number(value):
                raise FormatError(
                    f"{name}: line {number}, value {position}: {shown(value)} is not a number"
                )
        if len(values) != expected:
            raise FormatError(
                f"{name}: line {number}: expected {expected} values, found {len(values)}"
            )


def fields(text: str, delimiter: str | None) -> list[str]:
    """Split a line into its values."""
    return [value.strip().strip('"') for value in text.split(delimiter)]


def is_number(text: str) -> bool:
    """Say whether the text is a number as files spell them (Python also allows 1_000)."""
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text


def shown(text: str) -> str:
    """Quote a piece of a file, shortened: broken files have long lines."""
    return repr(text if len(text) <= 40 else text[:37] + "...")
