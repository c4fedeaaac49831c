"""The binary body of a PLY file: the rows of its elements in order, read in blocks."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.formats.ply.binary_lists import ListRows
from liftmesh.io.streams import read_exactly, read_most, remaining

if TYPE_CHECKING:
    from liftmesh.io.formats.ply.header import Element
    from liftmesh.io.ragged import Ragged

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
