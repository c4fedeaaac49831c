"""The text body of a PLY file: a line for each row of its elements, in order.

An element without lists is a table of numbers. With lists, rows differ in length: the numbers of
many lines become one flat array, and each property is located in all of its rows at once.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array, Integers, Mask
from liftmesh.errors import FormatError
from liftmesh.io.columns import Ragged, gathered, type_in_text
from liftmesh.io.streams import remaining
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
