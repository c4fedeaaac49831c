"""Points as lines of numbers whose columns the format fixes: PTS, XYZRGB and XYZN.

PTS comes from laser scanners. Each scan is a line with its number of points and a line for each
point: x y z, then an intensity, a colour, or both. XYZRGB and XYZN have x y z and a colour or a
normal in each line, and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import kept_depth, recognized
from liftmesh.errors import FormatError
from liftmesh.io.columns import COLOR, NORMAL, POSITION
from liftmesh.io.text_tables import (
    BLOCK,
    Block,
    Lines,
    Syntax,
    is_count,
    number_table,
    promised,
    quoted,
    regrouped,
)

_SYNTAX = Syntax(comments=("#", "//"))
_TOGETHER = 1 << 14  # rows: small scans are joined, since each array takes memory of its own

# What the values of a PTS line are, by their number.
_PTS = {
    3: POSITION,
    4: (*POSITION, "intensity"),
    6: (*POSITION, *COLOR),
    7: (*POSITION, "intensity", *COLOR),
}


def read_xyzrgb(stream: BinaryIO, name: str) -> Cloud:
    """Read lines of x y z r g b."""
    return _cloud(_table(stream, name, 6), (*POSITION, *COLOR))


def read_xyzn(stream: BinaryIO, name: str) -> Cloud:
    """Read lines of x y z nx ny nz."""
    return _cloud(_table(stream, name, 6), (*POSITION, *NORMAL))


def read_pts(stream: BinaryIO, name: str) -> Cloud:
    """Read a PTS file: one scan or several, with or without their numbers of points."""
    scans = _Scans(Lines(stream, name, _SYNTAX), name)
    parts = [*regrouped(scans.tables(), _TOGETHER)]
    if not parts:
        raise FormatError(f"{name}: the file has no points")
    table = np.concatenate(parts)
    said = {"scans": scans.count} if scans.count > 1 else {}
    return _cloud(table, _PTS[table.shape[1]], **said)


class _Scans:
    """The scans of a PTS file, and how many there are."""

    def __init__(self, lines: Lines, name: str) -> None:
        self.count = 0
        self._lines = lines
        self._name = name
        self._width: int | None = None

    def tables(self) -> Iterator[Floats]:
        """Parse the points of all scans, block by block."""
        while len(first := self._lines.take(1)):
            self.count += 1
            for block in self._blocks(first):
                table = number_table(block, self._name, width=self._width)
                self._width = table.shape[1]
                _check_width(table, block, self._name)
                yield table

    def _blocks(self, first: Block) -> Iterator[Block]:
        """Take the lines of a scan: as many as its first line says, or all."""
        count = _count(first)
        if count is not None:
            yield from promised(self._lines, count, "points", self._name)
            return
        if self.count > 1:
            raise FormatError(
                f"{self._name}: line {self._lines.number}: more points follow than the counts "
                "promise: correct them"
            )
        yield first
        while len(block := self._lines.take(BLOCK)):
            yield block


def _count(first: Block) -> int | None:
    """The number of points that a line states; None if it is a point."""
    word = first.texts[0]
    return int(word) if is_count(word) else None


def _check_width(table: Floats, block: Block, name: str) -> None:
    if table.shape[1] not in _PTS:
        raise FormatError(
            f"{name}: line {block.numbers[0]}: {quoted(block.texts[0])} has {table.shape[1]} "
            "values: a point has x y z, an intensity, and a colour of three values, or fewer"
        )


def _table(stream: BinaryIO, name: str, width: int) -> Floats:
    lines = Lines(stream, name, _SYNTAX)
    parts: list[Floats] = []
    while len(block := lines.take(BLOCK)):
        parts.append(number_table(block, name, width=width))
    if not parts:
        raise FormatError(f"{name}: the file has no points: no line holds numbers")
    return np.concatenate(parts)


def _cloud(table: Floats, names: tuple[str, ...], **metadata: object) -> Cloud:
    columns = {each: np.ascontiguousarray(table[:, k]) for k, each in enumerate(names) if k > 2}
    colors = None
    if "red" in columns:
        colors = recognized(np.stack([columns[each] for each in COLOR], axis=1))
    normals = np.stack([columns[each] for each in NORMAL], axis=1) if "nx" in columns else None
    used = {*NORMAL, *(COLOR if colors is not None else ())}
    return Cloud(
        np.ascontiguousarray(table[:, :3]),
        colors=colors,
        color_depth=kept_depth(colors),
        normals=normals,
        attributes={key: values for key, values in columns.items() if key not in used},
        metadata=metadata,
    )
