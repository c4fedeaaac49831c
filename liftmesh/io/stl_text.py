"""STL as text: the corners of its facets.

A text file holds solids, each from a line ``solid`` to a line ``endsolid``, both with a name or
without, and between them facets of seven lines::

    facet normal nx ny nz
    outer loop
    vertex x y z        (three times)
    endloop
    endfacet

Keywords are in lower or upper case; empty lines do not count. The lines are taken in large blocks,
and all numbers of a block are parsed at once.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError
from liftmesh.io.lines import BLOCK, Block, Lines
from liftmesh.io.text_tables import number_table, quoted

_FACET = ("facet normal", "outer loop", "vertex", "vertex", "vertex", "endloop", "endfacet")
_ALONE = ("outer loop", "endloop", "endfacet")  # without numbers
_LINES = len(_FACET)
_MARK = "\ufeff".encode().decode("latin-1")  # some editors begin a text with it


def read_corners(stream: BinaryIO, name: str) -> Floats:
    """Read the corners of all facets of a text file.

    Returns
    -------
    (3 n, 3) ndarray of float64
        Three rows for each facet, in the order of the file.

    Raises
    ------
    FormatError
        A line is not what should be at its place, or the last solid has no end; the message gives
        the line.
    """
    parts = [_corners(facets, name) for facets in _facets(Lines(stream, name), name)]
    return np.concatenate(parts) if parts else np.empty((0, 3))


def _facets(lines: Lines, name: str) -> Iterator[Block]:
    """Yield the lines of whole facets, without those of the solids around them."""
    solids = _Solids(name)
    left = Block([], np.empty(0, dtype=np.int64))
    while len(block := lines.take(BLOCK)):
        facets, left = solids.split(_joined(left, block))
        yield facets  # errors in them come first
        solids.check()
    solids.finish(left, lines.number)


def _joined(one: Block, other: Block) -> Block:
    return Block([*one.texts, *other.texts], np.concatenate([one.numbers, other.numbers]))


class _Solids:
    """Finds the facets among the lines, and checks that every solid has its end."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._begin = 0  # the line of the solid that has no end yet
        self._wrong: FormatError | None = None

    def split(self, block: Block) -> tuple[Block, Block]:
        """Return the lines of the whole facets, and those of an unfinished one at the end."""
        facets: list[slice] = []
        at = 0
        while at < len(block):
            end = self._end_of_facets(block.texts, at)
            facets.append(slice(at, end))
            at = end
            if at == len(block) or self._within_facet(block.texts[at]):
                break
            if not self._take(block.texts[at], int(block.numbers[at])):
                break
            at += 1
        return _cut(block, facets), block[at:]

    def check(self) -> None:
        """Raise if a line was wrong."""
        if self._wrong is not None:
            raise self._wrong

    def _end_of_facets(self, texts: list[str], at: int) -> int:
        while at + _LINES <= len(texts) and self._within_facet(texts[at]):
            at += _LINES
        return at

    def _within_facet(self, text: str) -> bool:
        return self._begin > 0 and text[:5].lower() == "facet"

    def _take(self, text: str, number: int) -> bool:
        """Take the first or last line of a solid; return whether it is one."""
        word = text.removeprefix(_MARK).split(None, 1)[0].lower()
        if word != ("endsolid" if self._begin else "solid"):
            expected = "'facet normal' or 'endsolid'" if self._begin else "'solid'"
            self._wrong = _unexpected(self._name, number, text, expected)
            return False
        self._begin = 0 if self._begin else number
        return True

    def finish(self, left: Block, number: int) -> None:
        """Raise if the file ends too early."""
        if self._begin:
            part = "a facet" if len(left) else f"the solid that begins in line {self._begin}"
            raise FormatError(
                f"{self._name}: not a valid stl file: line {number}: the file ends within {part}: "
                "it is truncated"
            )


def _cut(block: Block, runs: list[slice]) -> Block:
    """Join some runs of lines."""
    if len(runs) == 1:
        return block[runs[0]]
    texts = [text for run in runs for text in block.texts[run]]
    return Block(texts, np.concatenate([block.numbers[run] for run in runs]))


def _corners(facets: Block, name: str) -> Floats:
    """Parse the lines of whole facets."""
    parts = [Block(facets.texts[k::_LINES], facets.numbers[k::_LINES]) for k in range(_LINES)]
    values = [_values(lines, words, name) for lines, words in zip(parts, _FACET, strict=True)]
    number_table(Block(values[0], parts[0].numbers), name, width=3)
    texts = [text for corners in zip(*values[2:5], strict=True) for text in corners]
    numbers = np.column_stack([part.numbers for part in parts[2:5]]).reshape(-1)
    return number_table(Block(texts, numbers), name, width=3)


def _values(lines: Block, words: str, name: str) -> list[str]:
    """Return what follows a keyword in each line: numbers, or nothing."""
    if words in _ALONE and set(lines.texts) <= {words}:
        return []
    begin, size = f"{words} ", len(words) + 1
    values = [text[size:] for text in lines.texts if text[:size] == begin]
    if len(values) == len(lines) and words not in _ALONE:
        return values
    return [_value(text, number, words, name) for text, number in lines]


def _value(text: str, number: int, words: str, name: str) -> str:
    count = len(words.split())
    found = text.split(None, count)
    is_keyword = [word.lower() for word in found[:count]] == words.split()
    if not is_keyword or (len(found) > count) == (words in _ALONE):
        numbers = "" if words in _ALONE else " with three numbers"
        raise _unexpected(name, number, text, f"{words!r}{numbers}")
    return "".join(found[count:])


def _unexpected(name: str, number: int, text: str, expected: str) -> FormatError:
    return FormatError(
        f"{name}: not a valid stl file: line {number}: {quoted(text)}, where {expected} should be"
    )
