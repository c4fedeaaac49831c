"""2DM, the meshes of SMS, in text: reader and writer.

Each line begins with its card. ``ND`` has the number of a node and its x, y and z; ``E3T`` and
``E4Q`` that of an element, its nodes and its material; ``NS`` are nodestrings, over as many lines
as they need: the last node is negative, and a number of the string may follow. Other cards are
parameters, which are counted.

What is written is counted from 1. Materials are the regions that edges separate, and edges are
nodestrings, those of each marker with its number, as `io.tags` has both.

Source: 2D Mesh Files, wiki of Aquaveo XMS.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any, BinaryIO

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Integers, Mask, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted
from liftmesh.errors import FormatError
from liftmesh.io.columns import Ragged, edges_of, faces_of, gathered, triangulated
from liftmesh.io.metadata import noted
from liftmesh.io.tags import MARKERS, grouped, positive_markers, regions_of
from liftmesh.io.text_tables import (
    BLOCK,
    Block,
    Lines,
    count_kind,
    quoted,
    ragged_numbers,
    shortened,
    whole,
    write_rows,
)

_HEAD = "MESH2D"
_NODE, _TRIANGLE, _QUAD, _STRING = "ND", "E3T", "E4Q", "NS"
_CARDS = (_NODE, _TRIANGLE, _QUAD, _STRING)
_OTHERS = ("E2L", "E3L", "E6T", "E8Q", "E9Q")  # elements
_PARAMETERS = ("NUM_MATERIALS_PER_ELEM", "MESHNAME", "MESHNM")
_NODES = 10  # of a string in a line
_AT_ONCE = 1 << 18  # nodes that are looked for


def read_2dm(stream: BinaryIO, name: str) -> Cloud:
    """Read a mesh."""
    lines = Lines(stream, name)
    if lines.next().split()[:1] != [_HEAD]:
        raise FormatError(f"{name}: not a 2DM file, which begins with {_HEAD}")
    reading = _Reading(name)
    while len(block := lines.take(BLOCK)):
        reading.take(block)
    return reading.cloud()


class _Reading:
    """What the blocks so far hold."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._rows: dict[str, list[Ragged]] = {card: [] for card in _CARDS}
        self._lines: dict[str, list[Integers]] = {card: [] for card in _CARDS}
        self._others: Counter[str] = Counter()

    def take(self, block: Block) -> None:
        """Take the numbers of all lines of a block, by their cards."""
        cards = _kernel.find_keywords(block.data, block.places, _CARDS)
        for text, number in block[cards < 0]:
            self._pass_over(text, number)
        for k, card in enumerate(_CARDS):
            if (is_card := cards == k).any():
                found = block[is_card].behind(len(card) + 1)
                self._rows[card].append(ragged_numbers(found, self._name))
                self._lines[card].append(found.numbers)

    def _pass_over(self, text: str, number: int) -> None:
        card = shortened(text.split(None, 1)[0])
        if card in _PARAMETERS:
            return
        if card in (*_OTHERS, *_CARDS):
            reason = "without numbers" if card in _CARDS else "an element that is not read"
            raise FormatError(f"{self._name}: line {number}: {quoted(text)} is {reason}")
        count_kind(self._others, card)

    def cloud(self) -> Cloud:
        """Return the mesh."""
        nodes, _ = self._of(_NODE, lambda sizes: sizes == 4, "a number and x, y and z")
        if not len(nodes.sizes):
            raise FormatError(f"{self._name}: there are no nodes ({_NODE}) in it")
        table = nodes.values.reshape(-1, 4)
        self._order, self._numbers = self._indexed(table[:, 0])
        parts = [self._elements(card, size) for card, size in ((_TRIANGLE, 3), (_QUAD, 4))]
        faces = [rows for rows, _ in parts if len(rows)]
        materials = np.concatenate([each for _, each in parts])
        edges, markers = self._strings()
        kinds = len(np.unique(materials)) - 1
        left_out = [counted(kinds, "further material")] * (kinds > 0)
        left_out += [f"{counted(count, 'line')} {card}" for card, count in self._others.items()]
        entries = {} if markers is None else {MARKERS: markers}
        return Cloud(
            table[:, 1:].astype(np.float64),
            faces=np.concatenate(faces) if faces else None,
            edges=edges if len(edges) else None,
            metadata=noted(entries, not_read=tuple(left_out)),
        )

    def _of(self, card: str, fits: Callable[[Array], Mask], what: str) -> tuple[Ragged, Integers]:
        """Return the numbers of all lines of a card, and the number of each line."""
        if not self._rows[card]:
            return Ragged.empty(np.dtype(np.int64)), np.zeros(0, np.int64)
        rows, lines = Ragged.joined(self._rows[card]), np.concatenate(self._lines[card])
        self._rows[card] = []
        if not (good := fits(rows.sizes)).all():
            row = int(np.argmin(good))
            raise FormatError(
                f"{self._name}: line {lines[row]}: {card} has "
                f"{counted(int(rows.sizes[row]), 'number')}: expected {what}"
            )
        return rows, lines

    def _indexed(self, numbers: Array) -> tuple[Integers, Integers]:
        """Return an order of the nodes by their numbers, and these."""
        whole_numbers = self._whole(numbers, "a number of a node")
        order = np.argsort(whole_numbers, kind="stable")
        found = whole_numbers[order]
        if (same := np.flatnonzero(found[1:] == found[:-1])).size:
            raise FormatError(f"{self._name}: two nodes have the number {found[same[0]]}")
        return order, found

    def _whole(self, values: Array, what: str, kind: type[Any] = np.int64) -> Array:
        try:
            return whole(values, kind)
        except ValueError as error:
            raise FormatError(f"{self._name}: {what}: {error}") from error

    def _elements(self, card: str, size: int) -> tuple[Rows, Integers]:
        """Return the triangles of elements, and the material of each element."""
        what = f"a number, {size} nodes, and perhaps a material"
        rows, lines = self._of(card, lambda sizes: sizes > size, what)
        starts = np.cumsum(rows.sizes) - rows.sizes
        nodes = gathered(rows.values, starts + 1, np.full(len(starts), size))
        places = self._places(nodes, lambda k: int(lines[k // size]))
        corners = Ragged(np.full(len(starts), size), places)
        has = rows.sizes > size + 1
        materials = np.zeros(len(starts), np.int64)
        materials[has] = self._whole(rows.values[starts[has] + size + 1], "a material")
        return triangulated(corners, len(self._order), self._name), materials

    def _places(self, numbers: Array, line_of: Callable[[int], int]) -> Rows:
        """Return the rows of nodes."""
        found = np.empty(len(numbers), np.int32)
        for first in range(0, len(numbers), _AT_ONCE):
            some = numbers[first : first + _AT_ONCE]
            place = np.minimum(np.searchsorted(self._numbers, some), len(self._numbers) - 1)
            if (unknown := np.flatnonzero(self._numbers[place] != some)).size:
                wrong = int(unknown[0])
                raise FormatError(
                    f"{self._name}: line {line_of(first + wrong)}: the node {some[wrong]:.15g} is "
                    "not there"
                )
            found[first : first + _AT_ONCE] = self._order[place]
        return found

    def _strings(self) -> tuple[Rows, Rows | None]:
        """Return the edges of nodestrings, and their numbers, if all have one."""
        rows, lines = self._of(_STRING, lambda sizes: sizes > 0, "nodes")
        values = self._whole(rows.values, "a node of a string")
        ends = np.flatnonzero(values < 0)
        line_ends = np.cumsum(rows.sizes)
        if len(values) and (not len(ends) or line_ends[-1] - 1 - ends[-1] > 1):
            raise FormatError(f"{self._name}: line {lines[-1]}: a string without a negative end")
        of_line = np.searchsorted(line_ends, ends, side="right")
        has_number = ends + 1 < line_ends[of_line]
        is_node = np.ones(len(values), np.bool_)
        is_node[ends[has_number] + 1] = False
        is_last = (values < 0)[is_node]
        numbers = self._whole(values[ends[has_number] + 1], "a number of a string", np.int32)
        named = values[is_node]

        def line_of(node: int) -> int:
            place = np.flatnonzero(is_node)[node]
            return int(lines[np.searchsorted(line_ends, place, side="right")])

        del values, rows
        nodes = self._places(np.abs(named, out=named), line_of)
        del named
        begins = ~is_last[:-1]
        edges = np.empty((np.count_nonzero(begins), 2), np.int32)
        edges[:, 0], edges[:, 1] = nodes[:-1][begins], nodes[1:][begins]
        if not has_number.all() or not len(ends):
            return edges, None
        string = np.cumsum(is_last, dtype=np.int32)[:-1][begins]
        return edges, numbers[string]


def write_2dm(stream: BinaryIO, cloud: Cloud) -> None:
    """Write a mesh, with regions as materials, and edges as nodestrings."""
    faces, edges = faces_of(cloud), edges_of(cloud)
    markers = positive_markers(cloud, edges[:0], "2DM")
    stream.write(f"{_HEAD}\nNUM_MATERIALS_PER_ELEM 1\n".encode())
    count = np.arange(1, len(faces) + 1)
    write_rows(stream, [count, faces + 1, regions_of(cloud) + 1], prefix=f"{_TRIANGLE} ")
    write_rows(stream, [np.arange(1, len(cloud) + 1), cloud.points], prefix=f"{_NODE} ")
    for marker, rows in grouped(edges, markers):
        strings = (_text_of(each, marker) for each in _chained(rows.tolist()))
        stream.write("".join(strings).encode())


def _text_of(string: Sequence[int], marker: int) -> str:
    words = [*(str(node + 1) for node in string[:-1]), f"-{string[-1] + 1} {marker}"]
    parts = (words[k : k + _NODES] for k in range(0, len(words), _NODES))
    return "".join(f"{_STRING} {' '.join(part)}\n" for part in parts)


def _chained(edges: Sequence[Sequence[int]]) -> Iterator[list[int]]:
    """Join edges to strings, which end where other than two meet, or where they began."""
    around: dict[int, list[int]] = {}
    for k, ends in enumerate(edges):
        for end in ends:
            around.setdefault(end, []).append(k)
    is_left = [True] * len(edges)
    starts = [node for node, found in around.items() if len(found) != 2]
    for node in (*starts, *around):
        for k in around[node]:
            if is_left[k]:
                yield _followed(node, k, edges, around, is_left)


def _followed(
    node: int,
    edge: int | None,
    edges: Sequence[Sequence[int]],
    around: dict[int, list[int]],
    is_left: list[bool],
) -> list[int]:
    """Return the nodes from one on, along edges that are left."""
    string = [node]
    while edge is not None:
        is_left[edge] = False
        first, last = edges[edge]
        node = last if node == first else first
        string.append(node)
        found: list[int] = around[node] if len(around[node]) == 2 else []
        edge = next((each for each in found if is_left[each]), None)
    return string
