"""The body of a PLY file, binary or text: the rows of its elements in order, read in blocks.

*Binary.* The length of a list stands in front of it, so a row with lists is found only after those
before it. Most files repeat one shape: while rows have the lengths of the first, they are a table,
and one comparison finds how many do. Otherwise Python steps from length to length, and all the rest
is computed for many rows at once: from the lengths, where each property starts; from these, its
values.

*Text* has a line for each row. An element without lists is a table of numbers. With lists, rows
differ in length: the numbers of many lines become one flat array, and each property is located in
all of its rows at once.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Integers, Mask
from liftmesh.errors import FormatError
from liftmesh.io.columns import Ragged, gathered, type_in_text
from liftmesh.io.streams import read_exactly, read_most, remaining
from liftmesh.io.text_tables import (
    BLOCK,
    Block,
    Lines,
    check_end,
    exact_values,
    number_table,
    ragged_numbers,
)

if TYPE_CHECKING:
    from liftmesh.io.formats.ply.header import Element, Property

_BLOCK = 1 << 18  # bytes that fit in the cache of one core
_LISTS = 1 << 20  # bytes of rows with lists
_LEAST = 1 << 12
_USUAL = 16  # bytes of the lists in a row


class BinaryBody:
    """Reads the elements of a binary body in order."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        self._stream = stream
        self._name = name

    def tables(self, element: Element, names: Collection[str]) -> Iterator[Mapping[str, Array]]:
        """Yield the rows of an element without lists in blocks: the columns of these names."""
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
            yield {name: block[name] for name in names}

    def lists(self, element: Element, names: Collection[str]) -> Iterator[Mapping[str, Ragged]]:
        """Yield the rows of an element with lists in blocks; a scalar is a list of one."""
        rows = ListRows(element)
        self._expect(element, rows.least)
        begin, done = self._stream.tell(), 0
        size = least = min(max(element.rows * (rows.least + _USUAL), _LEAST), _LISTS)
        while done < element.rows:
            self._stream.seek(begin)
            data = read_most(self._stream, size)
            taken, end = 0, 0
            for part in rows.parts(data, element.rows - done, names):
                taken, end = taken + part.rows, part.end
                self._stream.seek(begin + end)  # the last part may be the last thing asked for
                yield part.properties
            if not taken and len(data) < size:
                cause = rows.complaint(data)
                raise FormatError(
                    f"{self._name}: byte {begin}: row {done} of element {element.name}: {cause}, "
                    "but the file ends before: it is truncated or damaged"
                )
            size = least if taken else 2 * size
            begin, done = begin + end, done + taken

    def check_end(self) -> None:
        """Raise for rows beyond those that the header promises: they would be lost."""
        here, left = self._stream.tell(), remaining(self._stream)
        while data := self._stream.read(_BLOCK):
            if data.strip(b"\0 \r\n"):
                raise FormatError(
                    f"{self._name}: byte {here}: {left} bytes follow the rows that the header "
                    "promises: correct its counts"
                )

    def _expect(self, element: Element, row: int) -> None:
        """Compare the size that the header promises with the file before memory is allocated."""
        here, left = self._stream.tell(), remaining(self._stream)
        if element.rows * row > left:
            rows = "1 row" if element.rows == 1 else f"{element.rows} rows"
            raise FormatError(
                f"{self._name}: byte {here}: the header promises {rows} of element "
                f"{element.name}, at least {element.rows * row} bytes, but {left} are left: "
                "the file is truncated, or its header is wrong"
            )


_ALIKE = 64  # rows of one shape that are worth a table
_STEPS = 1024  # rows to step through before another look
_LONGEST = 255  # length of a list in a table


@dataclass(frozen=True, slots=True)
class Part:
    """Whole rows of a block: how many, where they end in the block, and their properties."""

    rows: int
    end: int
    properties: Mapping[str, Ragged]


@dataclass(frozen=True, slots=True)
class _List:
    """A list in a row: ``skip`` bytes from the end of the last one lies its length."""

    skip: int
    length: struct.Struct
    item: int


class ListRows:
    """Finds the rows of an element with lists in a block; ``least`` is the least size of a row."""

    def __init__(self, element: Element) -> None:
        self._properties = element.properties
        self._tables: dict[tuple[int, ...], np.dtype] = {}
        self._lists: list[_List] = []
        self._tail = 0
        self._offsets: list[tuple[int, int]] = []  # bytes before a property, and lists before it
        self.least = 0
        for each in element.properties:
            self._add(each)
        self._items = np.array([each.item for each in self._lists], dtype=np.int64)

    def _add(self, each: Property) -> None:
        if each.length is None:
            self._offsets.append((self.least, len(self._lists)))
            self._tail += each.dtype.itemsize
            self.least += each.dtype.itemsize
        else:
            reader = _length_reader(each.length)
            self.least += reader.size
            self._offsets.append((self.least, len(self._lists)))
            self._lists.append(_List(self._tail, reader, each.dtype.itemsize))
            self._tail = 0

    def parts(self, data: bytes, most: int, names: Collection[str]) -> Iterator[Part]:
        """Yield the whole rows of a block in parts, at most ``most``: properties of these names."""
        position = 0
        while most:
            sizes, _ = self._stepped(data, position, 1)
            if not sizes:
                return
            part = self._alike(data, position, most, names, sizes)
            part = part or self._unlike(data, position, min(most, _STEPS), names)
            most, position = most - part.rows, part.end
            yield part

    def _alike(
        self, data: bytes, position: int, most: int, names: Collection[str], sizes: list[int]
    ) -> Part | None:
        """Read rows as long as they have the shape of the first; None if these are few."""
        if max(sizes) > _LONGEST:
            return None
        layout = self._layout(tuple(sizes))
        whole = min(most, (len(data) - position) // layout.itemsize)
        if whole < min(_ALIKE, most):
            return None
        table = np.frombuffer(data, layout, whole, position)
        count = whole
        for number, size in enumerate(sizes):
            for some in (_ALIKE, count):
                differ = table[f"n{number}"][:some] != size
                if differ.any():
                    count = min(int(np.argmax(differ)), count)
        if count < min(_ALIKE, whole):
            return None
        columns = {
            each.name: Ragged.uniform(table[f"v{number}"][:count], each.length)
            for number, each in enumerate(self._properties)
            if each.name in names
        }
        return Part(count, position + count * layout.itemsize, columns)

    def _layout(self, sizes: tuple[int, ...]) -> np.dtype:
        if sizes not in self._tables:
            self._tables = {sizes: _table(self._properties, sizes)}
        return self._tables[sizes]

    def _unlike(self, data: bytes, position: int, most: int, names: Collection[str]) -> Part:
        """Read rows of any shape."""
        stepped, end = self._stepped(data, position, most)
        sizes = np.array(stepped, dtype=np.int64).reshape(-1, len(self._lists))
        before = np.zeros((len(sizes), len(self._lists) + 1), dtype=np.int64)
        np.cumsum(sizes * self._items, axis=1, out=before[:, 1:])
        widths = before[:, -1] + self.least
        starts = position + np.cumsum(widths) - widths
        octets = np.frombuffer(data, np.uint8)
        columns: dict[str, Ragged] = {}
        for each, (offset, lists) in zip(self._properties, self._offsets, strict=True):
            if each.name in names:
                one = np.broadcast_to(np.int64(1), len(sizes))
                size = one if each.length is None else sizes[:, lists]
                begins = starts + before[:, lists] + offset
                taken = gathered(octets, begins, size * each.dtype.itemsize).view(each.dtype)
                columns[each.name] = Ragged(_narrow(size, each), taken)
        return Part(len(sizes), end, columns)

    def _stepped(self, data: bytes, position: int, most: int) -> tuple[list[int], int]:
        """Step through whole rows: the lengths of their lists, and where the last row ends."""
        sizes: list[int] = []
        lists = [
            (each.skip, each.length.unpack_from, each.length.size, each.item)
            for each in self._lists
        ]
        end, last = len(data), 0
        for _ in range(most):
            at = position
            for skip, length, width, item in lists:
                at += skip
                if at + width > end:
                    break
                (size,) = length(data, at)
                sizes.append(size)
                at = at + width + size * item if size >= 0 else end + 1
            if at + self._tail > end or len(sizes) - last < len(lists):
                break
            position, last = at + self._tail, len(sizes)
        return sizes[:last], position

    def complaint(self, data: bytes) -> str:
        """Say what is missing of the first row, which the file does not hold as a whole."""
        at = 0
        lists = iter(self._lists)
        for each in self._properties:
            size = 1
            if each.length is not None:
                length = next(lists).length
                if at + length.size > len(data):
                    break
                (size,) = length.unpack_from(data, at)
                at += length.size
            at += size * each.dtype.itemsize
            if size < 0 or at > len(data):
                return f"{each.name} has {size} values"
        return "the row is missing"


def _narrow(sizes: Integers, each: Property) -> Integers:
    """Give lengths the type that they have in the file."""
    return sizes if each.length is None else sizes.astype(each.length.newbyteorder("="))


def _table(properties: tuple[Property, ...], sizes: tuple[int, ...]) -> np.dtype:
    """The type of rows whose lists have these lengths."""
    spec: list[Any] = []
    lists = iter(enumerate(sizes))
    for position, each in enumerate(properties):
        size = 1
        if each.length is not None:
            number, size = next(lists)
            spec.append((f"n{number}", each.length))
        spec.append((f"v{position}", each.dtype, (size,)))
    return np.dtype(spec)


def _length_reader(length: np.dtype) -> struct.Struct:
    order = ">" if length.str.startswith(">") else "<"
    return struct.Struct(order + {"i8": "q", "u8": "Q"}.get(length.str[1:], length.char))


class AsciiBody:
    """Reads the elements of a text body in order."""

    def __init__(self, stream: BinaryIO, name: str, lines: int) -> None:
        self._name = name
        self._size = remaining(stream)
        self._lines = Lines(stream, name, before=lines)

    def tables(self, element: Element, names: Collection[str]) -> Iterator[Mapping[str, Array]]:
        """Yield the rows of an element without lists in blocks: the columns of these names."""
        for block in self._lines_of(element):
            table = number_table(block, self._name, width=len(element.properties))
            columns = {
                each.name: self._exact(table[:, position], each, block.numbers.__getitem__)
                for position, each in enumerate(element.properties)
            }
            yield {name: columns[name] for name in names}

    def lists(self, element: Element, names: Collection[str]) -> Iterator[Mapping[str, Ragged]]:
        """Yield the rows of an element with lists in blocks; a scalar is a list of one."""
        for block in self._lines_of(element):
            numbers = ragged_numbers(block, self._name)
            places = _located(element, numbers, block, self._name)
            columns = {
                each.name: self._list(each, numbers.values, located, block.numbers)
                for each, located in zip(element.properties, places, strict=True)
            }
            yield {name: columns[name] for name in names}

    def check_end(self) -> None:
        """Raise for rows beyond those that the header promises: they would be lost."""
        check_end(self._lines, self._name)

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

    def _list(
        self, each: Property, values: Array, located: tuple[Integers, Integers], lines: Integers
    ) -> Ragged:
        """Gather the values of a property and convert them to its type."""
        starts, sizes = located
        taken = gathered(values, starts, sizes)
        of_rows = Ragged(sizes, taken)
        converted = self._exact(taken, each, lambda position: lines[of_rows.row_of(position)])
        kept = np.broadcast_to(np.int64(1), len(sizes)) if each.length is None else sizes
        return Ragged(kept if each.length is None else kept.astype(each.length), converted)

    def _exact(self, values: Array, each: Property, line_of: Callable[[int], int]) -> Array:
        dtype = type_in_text(each.name, each.dtype)
        return exact_values(values, dtype, self._name, each.name, line_of)

    def _too_few(self, element: Element) -> FormatError:
        return FormatError(
            f"{self._name}: line {self._lines.number}: the file ends before the {element.rows} "
            f"rows of element {element.name} that its header promises"
        )


def _located(
    element: Element, numbers: Ragged, block: Block, name: str
) -> list[tuple[Integers, Integers]]:
    """Locate each property in all rows: where its values start among the numbers, and how many."""
    ends = np.cumsum(numbers.sizes)
    position = ends - numbers.sizes
    wrong = np.zeros(len(ends), dtype=bool)
    places: list[tuple[Integers, Integers]] = []
    for each in element.properties:
        sizes = np.ones(len(ends), dtype=np.int64)
        if each.length is not None:
            sizes = _lengths(numbers.values, position, ends, wrong)
            position = position + 1
        places.append((position, sizes))
        position = position + sizes
        wrong |= position > ends
        np.minimum(position, ends, out=position)
    wrong |= position < ends
    if wrong.any():
        raise FormatError(
            f"{name}: line {block.numbers[np.argmax(wrong)]}: lists in this row of element "
            f"{element.name} do not have the lengths given before them"
        )
    return places


def _lengths(values: Array, position: Integers, ends: Integers, wrong: Mask) -> Integers:
    """Read the length of a list in all rows; 0 where there is none, which is marked as wrong."""
    inside = position < ends
    stated = values[np.where(inside, position, 0)]
    fits = inside & (stated >= 0) & (stated <= ends - position) & (stated == np.rint(stated))
    wrong |= ~fits
    return np.where(fits, stated, 0).astype(np.int64)
