"""The body of a PLY file in text: one row of an element on each line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError
from liftmesh.io.ragged import Ragged
from liftmesh.io.streams import remaining
from liftmesh.io.text_tables import BLOCK, Block, Lines, exact_column, fields, number_table

if TYPE_CHECKING:
    from liftmesh.io.ply.header import Element, Property


class AsciiBody:
    """Reads the elements of a text body in their order."""

    def __init__(self, stream: BinaryIO, name: str, lines: int) -> None:
        self._name = name
        self._size = remaining(stream)
        self._lines = Lines(stream, name, before=lines)

    def blocks(self, element: Element) -> Iterator[tuple[slice, Mapping[str, Array]]]:
        """Yield the rows of an element without lists, some at a time, column by name."""
        start = 0
        for block in self._taken(element):
            table = number_table(block, self._name, width=len(element.properties))
            yield (
                slice(start, start + len(block)),
                {
                    each.name: self._column(table[:, position], each, block)
                    for position, each in enumerate(element.properties)
                },
            )
            start += len(block)

    def lists(self, element: Element) -> dict[str, Ragged]:
        """Read an element with lists; a scalar property counts as a list of one."""
        if not element.rows:
            return {each.name: Ragged.empty(each.dtype) for each in element.properties}
        parts = [
            self._uniform(element, block) or self._by_line(element, block)
            for block in self._taken(element)
        ]
        return {
            each.name: Ragged.joined([part[position] for part in parts])
            for position, each in enumerate(element.properties)
        }

    def _taken(self, element: Element) -> Iterator[Block]:
        """Take the lines of an element, if the file can hold as many as the header promises."""
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
        """Refuse rows beyond those that the header promises: they would be lost."""
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
                    f"{self._name}: line {number}: the lists of this row of element "
                    f"{element.name} do not have the lengths that stand before them"
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
    """Read the length of a list, -1 if there is none."""
    text = values[position] if position < len(values) else ""
    return int(text) if text.isascii() and text.isdigit() and len(text) < 19 else -1
