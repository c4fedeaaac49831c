"""The body of a binary PLY file.

An element without lists is an array of structures. One with lists is too if every row has lists of
the same length, as in a mesh of triangles: that is tried first. Otherwise the rows are walked one
by one for where their lists begin, and the values are gathered afterwards.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.errors import FormatError
from liftmesh.io.ragged import Ragged
from liftmesh.io.streams import read_exactly, remaining

if TYPE_CHECKING:
    from liftmesh.io.ply.header import Element, Property


_BLOCK = 1 << 18  # bytes that stay in the cache of one core
_LONGEST_UNIFORM = 255


class BinaryBody:
    """Reads the elements of a binary body in their order."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        self._stream = stream
        self._name = name

    def blocks(self, element: Element) -> Iterator[tuple[slice, Mapping[str, Array]]]:
        """Yield the rows of an element without lists, some at a time, column by name."""
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
            yield (
                slice(start, start + count),
                {each.name: block[each.name] for each in element.properties},
            )

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
        """Refuse rows beyond those that the header promises: they would be lost."""
        here, left = self._stream.tell(), remaining(self._stream)
        if left and self._stream.read(left).strip(b"\0 \r\n"):
            raise FormatError(
                f"{self._name}: byte {here}: {left} bytes follow the rows that the header "
                "promises: correct its counts"
            )

    def _expect(self, element: Element, row: int) -> None:
        """Compare what the header promises with what is there before anything is allocated."""
        here, left = self._stream.tell(), remaining(self._stream)
        if element.rows * row > left:
            raise FormatError(
                f"{self._name}: byte {here}: the header promises {element.rows} rows of element "
                f"{element.name}, at least {element.rows * row} bytes, but {left} are left: "
                "the file is cut short, or its header is wrong"
            )


class _Walk:
    """One element with lists in a buffer."""

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
        """Walk row by row."""
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
        """Find where each property of a row begins and how many values it has."""
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
            raise self._error(row, "the row is not there") from error
        return position, lists

    def _gathered(self, dtype: np.dtype, starts: Integers, sizes: Integers) -> Ragged:
        step = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        first = np.repeat(starts, sizes) + step * dtype.itemsize
        octets = np.frombuffer(self._data, np.uint8)[first[:, None] + np.arange(dtype.itemsize)]
        return Ragged(sizes.copy(), np.ascontiguousarray(octets).view(dtype).reshape(-1))

    def _error(self, row: int, cause: str) -> FormatError:
        return FormatError(
            f"{self._where}: row {row} of element {self._element.name}: {cause}, "
            "but the file ends before: it is cut short or damaged"
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
