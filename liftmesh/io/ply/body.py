"""The body of a PLY file, text or binary: the rows of its elements in order."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.errors import FormatError
from liftmesh.io.faces import Ragged
from liftmesh.io.streams import read_exactly, remaining
from liftmesh.io.text_tables import BLOCK, Block, Lines, exact_column, fields, number_table

if TYPE_CHECKING:
    from liftmesh.io.ply.header import Element, Property


class AsciiBody:
    """Reads the elements of a text body in order."""

    def __init__(self, stream: BinaryIO, name: str, lines: int) -> None:
        self._name = name
        self._size = remaining(stream)
        self._lines = Lines(stream, name, before=lines)

    def blocks(self, element: Element) -> Iterator[Mapping[str, Array]]:
        """Yield the rows of an element without lists in blocks, as named columns."""
        for block in self._lines_of(element):
            table = number_table(block, self._name, width=len(element.properties))
            yield {
                each.name: self._column(table[:, position], each, block)
                for position, each in enumerate(element.properties)
            }

    def lists(self, element: Element) -> dict[str, Ragged]:
        """Read an element with lists; a scalar property counts as a list of one."""
        if not element.rows:
            return {each.name: Ragged.empty(each.dtype) for each in element.properties}
        parts = [
            self._uniform(element, block) or self._by_line(element, block)
            for block in self._lines_of(element)
        ]
        return {
            each.name: Ragged.joined([part[position] for part in parts])
            for position, each in enumerate(element.properties)
        }

    def _lines_of(self, element: Element) -> Iterator[Block]:
        """Yield the lines of an element, if the file can hold as many as the header promises."""
        wanted = element.rows if element.properties else 0
        if wanted * 2 > self._size + 1:
            raise self._too_few(element)
        while wanted:
            block = self._lines.take(min(wanted, BLOCK))
            if not len(block):
                raise self._too_few(element)
            yield block
            wanted -= len(block)

    def check_end(self) -> None:
        """Raise for rows beyond those that the header promises: they would be lost."""
        block = self._lines.take(1)
        if len(block):
            raise FormatError(
                f"{self._name}: line {int(block.numbers[0])}: more rows follow than the header "
                "promises: correct its counts"
            )

    def _uniform(self, element: Element, block: Block) -> list[Ragged] | None:
        """Parse lines that all have the shape of the first; None if they do not."""
        shape = _shape(element, fields(block.texts[0], None))
        if shape is None:
            return None
        try:
            table = number_table(block, self._name, width=shape[-1].stop)
        except FormatError:
            return None
        for each, place in zip(element.properties, shape, strict=True):
            size = place.stop - place.start
            if each.length is not None and (table[:, place.start - 1] != size).any():
                return None
        return [
            Ragged.uniform(self._columns(table[:, place], each, block))
            for each, place in zip(element.properties, shape, strict=True)
        ]

    def _by_line(self, element: Element, block: Block) -> list[Ragged]:
        parts: list[list[Ragged]] = [[] for _ in element.properties]
        for row, (text, number) in enumerate(block):
            line = block[row : row + 1]
            table = number_table(line, self._name)
            shape = _shape(element, fields(text, None))
            if shape is None:
                raise FormatError(
                    f"{self._name}: line {number}: lists in this row of element "
                    f"{element.name} do not have the lengths given before them"
                )
            for part, each, place in zip(parts, element.properties, shape, strict=True):
                part.append(Ragged.uniform(self._columns(table[:, place], each, line)))
        return [Ragged.joined(part) for part in parts]

    def _columns(self, table: Floats, each: Property, block: Block) -> Array:
        columns = [self._column(column, each, block) for column in table.T]
        return np.stack(columns, axis=1) if columns else np.empty((len(table), 0), each.dtype)

    def _column(self, column: Floats, each: Property, block: Block) -> Array:
        return exact_column(column, each.dtype, self._name, each.name, block.numbers)

    def _too_few(self, element: Element) -> FormatError:
        return FormatError(
            f"{self._name}: line {self._lines.number}: the file ends before the {element.rows} "
            f"rows of element {element.name} that its header promises"
        )


def _shape(element: Element, values: list[str]) -> list[slice] | None:
    """Locate each property among the values of a line; None if they do not fit."""
    places: list[slice] = []
    position = 0
    for each in element.properties:
        size = 1
        if each.length is not None:
            size = _length(values, position)
            position += 1
        if size < 0:
            return None
        places.append(slice(position, position + size))
        position += size
    return places if position == len(values) else None


def _length(values: list[str], position: int) -> int:
    """Read the length of a list, -1 if it is missing or invalid."""
    text = values[position] if position < len(values) else ""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1


_BLOCK = 1 << 18  # bytes that fit in the cache of one core
_LONGEST_UNIFORM = 255


class BinaryBody:
    """Reads the elements of a binary body in order."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        self._stream = stream
        self._name = name

    def blocks(self, element: Element) -> Iterator[Mapping[str, Array]]:
        """Yield the rows of an element without lists in blocks, as named columns."""
        layout = np.dtype([(each.name, each.dtype) for each in element.properties])
        if not element.properties:
            return
        self._expect(element, layout.itemsize)
        step = max(_BLOCK // layout.itemsize, 1)
        for start in range(0, element.rows, step):
            count = min(step, element.rows - start)
            data = read_exactly(
                self._stream, count * layout.itemsize, self._name, f"element {element.name}"
            )
            block = np.frombuffer(data, layout, count)
            yield {each.name: block[each.name] for each in element.properties}

    def lists(self, element: Element) -> dict[str, Ragged]:
        """Read an element with lists; a scalar property counts as a list of one."""
        self._expect(
            element, sum((each.length or each.dtype).itemsize for each in element.properties)
        )
        if not element.rows:
            return {each.name: Ragged.empty(each.dtype) for each in element.properties}
        begin = self._stream.tell()
        data = self._stream.read(remaining(self._stream))
        walk = _Walk(element, data, f"{self._name}: byte {begin}")
        found, used = walk.uniform() or walk.rows()
        self._stream.seek(begin + used)
        return found

    def check_end(self) -> None:
        """Raise for rows beyond those that the header promises: they would be lost."""
        here, left = self._stream.tell(), remaining(self._stream)
        if left and self._stream.read(left).strip(b"\0 \r\n"):
            raise FormatError(
                f"{self._name}: byte {here}: {left} bytes follow the rows that the header "
                "promises: correct its counts"
            )

    def _expect(self, element: Element, row: int) -> None:
        """Compare the size that the header promises with the file before memory is allocated."""
        here, left = self._stream.tell(), remaining(self._stream)
        if element.rows * row > left:
            raise FormatError(
                f"{self._name}: byte {here}: the header promises {element.rows} rows of element "
                f"{element.name}, at least {element.rows * row} bytes, but {left} are left: "
                "the file is truncated, or its header is wrong"
            )


class _Walk:
    """Parser of one element with lists in a buffer."""

    def __init__(self, element: Element, data: bytes, where: str) -> None:
        self._element = element
        self._data = data
        self._where = where
        self._readers = [_length_reader(each) for each in element.properties]

    def uniform(self) -> tuple[dict[str, Ragged], int] | None:
        """Read rows that all have the shape of the first; None if they do not."""
        rows, properties = self._element.rows, self._element.properties
        sizes = [size for _, size in self._row(0, 0)[1]]
        if max(sizes) > _LONGEST_UNIFORM:
            return None
        layout = _layout(properties, sizes)
        if rows * layout.itemsize > len(self._data):
            return None
        table = np.frombuffer(self._data, layout, rows)
        for position, each in enumerate(properties):
            if each.length is not None and (table[f"n{position}"] != sizes[position]).any():
                return None
        found = {each.name: table[f"v{k}"] for k, each in enumerate(properties)}
        return {key: Ragged.uniform(rows) for key, rows in found.items()}, table.nbytes

    def rows(self) -> tuple[dict[str, Ragged], int]:
        """Read row by row."""
        places: list[tuple[int, int]] = []
        position = 0
        for row in range(self._element.rows):
            position, lists = self._row(row, position)
            places += lists
        columns = np.array(places, dtype=np.int64).reshape(self._element.rows, -1, 2)
        found = {
            each.name: self._gathered(each.dtype, *columns[:, k].T)
            for k, each in enumerate(self._element.properties)
        }
        return found, position

    def _row(self, row: int, position: int) -> tuple[int, list[tuple[int, int]]]:
        """Locate the properties of a row: where each begins, and its number of values."""
        lists: list[tuple[int, int]] = []
        try:
            for each, reader in zip(self._element.properties, self._readers, strict=True):
                size = 1
                if reader is not None:
                    (size,) = reader.unpack_from(self._data, position)
                    position += reader.size
                lists.append((position, size))
                position += size * each.dtype.itemsize
                if size < 0 or position > len(self._data):
                    raise self._error(row, f"{each.name} has {size} values")
        except struct.error as error:
            raise self._error(row, "the row is missing") from error
        return position, lists

    def _gathered(self, dtype: np.dtype, starts: Integers, sizes: Integers) -> Ragged:
        step = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        first = np.repeat(starts, sizes) + step * dtype.itemsize
        octets = np.frombuffer(self._data, np.uint8)[first[:, None] + np.arange(dtype.itemsize)]
        return Ragged(sizes.copy(), np.ascontiguousarray(octets).view(dtype).reshape(-1))

    def _error(self, row: int, cause: str) -> FormatError:
        return FormatError(
            f"{self._where}: row {row} of element {self._element.name}: {cause}, "
            "but the file ends before: it is truncated or damaged"
        )


def _layout(properties: tuple[Property, ...], sizes: list[int]) -> np.dtype:
    spec: list[Any] = []
    for position, (each, size) in enumerate(zip(properties, sizes, strict=True)):
        if each.length is not None:
            spec.append((f"n{position}", each.length))
        spec.append((f"v{position}", each.dtype, (size,)))
    return np.dtype(spec)


def _length_reader(each: Property) -> struct.Struct | None:
    if each.length is None:
        return None
    order = ">" if each.length.str.startswith(">") else "<"
    return struct.Struct(order + {"i8": "q", "u8": "Q"}.get(each.length.str[1:], each.length.char))
