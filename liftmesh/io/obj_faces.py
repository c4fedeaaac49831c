"""Faces of OBJ files: their corners, as indices of vertices and normals.

A corner is vertex, vertex/texture, vertex/texture/normal or vertex//normal. All faces of a block
are parsed at once, whatever their sizes: with blanks in place of the slashes, a text is a list of
whole numbers, and the slashes in each corner say which of its numbers is which.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.errors import FormatError
from liftmesh.io.number_lines import integers, joined, per_line, whole, words
from liftmesh.io.ragged import Ragged
from liftmesh.io.text_tables import quoted

if TYPE_CHECKING:
    from liftmesh.io.lines import Block

_PIECE = 1 << 20  # bytes parsed at a time

_WORD = re.compile(r"\S+")
_CORNER = re.compile(r"([+-]?\d{1,9})(?:/(?:[+-]?\d{1,18})?(?:/([+-]?\d{1,9}))?)?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Corners:
    """Faces: vertices, counted from 0, the normal of each corner (-1: none), and line numbers.

    ``normals`` is None if no corner has one.
    """

    vertices: Ragged
    normals: Integers | None
    lines: Integers

    @classmethod
    def joined(cls, parts: Sequence[Corners]) -> Corners:
        """Concatenate the faces of all parts."""
        normals = None
        if any(each.normals is not None for each in parts):
            normals = np.concatenate([each.normals_or_none() for each in parts])
        return cls(
            Ragged.joined([each.vertices for each in parts]),
            normals,
            np.concatenate([each.lines for each in parts]),
        )

    def normals_or_none(self) -> Integers:
        """Return the normal of each corner, -1 for none."""
        if self.normals is not None:
            return self.normals
        return np.full(len(self.vertices.values), -1, dtype=np.int32)


def parse_corners(
    faces: Block, name: str, numbers: tuple[Integers, Integers], before: tuple[int, int]
) -> Corners:
    """Parse the face lines of a block, without the keyword ``f``.

    ``numbers`` are the lines of the block's vertices and of its normals, ``before`` the counts of
    both in earlier blocks: backward indices count from there.

    Raises
    ------
    FormatError
        A corner is invalid; the message gives it and its line.
    """
    try:
        sizes, vertices, normals = _indices(faces)
    except ValueError as error:
        raise _corner_error(faces, name) from error
    lines = faces.numbers
    if normals is not None:
        normals = _from_zero(normals, sizes, lines, numbers[1], before[1])
    vertices = _from_zero(vertices, sizes, lines, numbers[0], before[0])
    return Corners(Ragged(sizes, vertices), normals, lines)


def _indices(faces: Block) -> tuple[Integers, Array, Array | None]:
    """Parse corners: their number in each face, vertices, and normals, 0 for none, if any."""
    text, ends = joined(faces)
    parts = [_parsed(piece) for piece in _pieces(text)]
    vertices = np.concatenate([each for each, _ in parts])
    sizes: Integers = per_line(words(text), ends).astype(np.int32)
    if all(normals is None for _, normals in parts):
        return sizes, vertices, None
    each_of = (np.zeros(len(v), np.int32) if normals is None else normals for v, normals in parts)
    return sizes, vertices, np.concatenate([*each_of])


def _pieces(text: bytes) -> Iterator[bytes]:
    """Cut a text between its corners: a face may have millions of them."""
    start = 0
    while start < len(text):
        stop = text.find(b" ", start + _PIECE)
        stop = stop if stop >= 0 else len(text)
        yield text[start:stop]
        start = stop


def _parsed(text: bytes) -> tuple[Array, Array | None]:
    """Parse corners: vertices, and normals, 0 for none, if any."""
    begins = words(text)
    if b"/" not in text:
        return _indexes(_numbers(text, len(begins))), None
    plain = text.replace(b"/", b" ")
    starts = words(plain)
    values = _numbers(plain, len(starts))
    first = np.searchsorted(starts, begins)
    found = np.diff(first, append=len(starts))
    slashes = _slashes(text, begins, found)
    if (starts[first] != begins).any():
        raise ValueError("a corner without vertex")
    named = slashes == 2
    vertices = _indexes(values[first])  # textures may be any whole numbers
    if not named.any():
        return vertices, None
    normals = np.zeros(len(named), dtype=np.int32)
    normals[named] = _indexes(values[(first + found - 1)[named]])
    return vertices, normals


def _slashes(text: bytes, begins: Integers, found: Integers) -> Integers:
    """Count the slashes of each corner, and compare them with the numbers found in it."""
    octets = np.frombuffer(text, np.uint8) == ord("/")
    slashes = _in_corners(np.flatnonzero(octets), begins)
    doubled = _in_corners(np.flatnonzero(octets[1:] & octets[:-1]), begins)
    whole_corners = (found == slashes + 1) & (doubled == 0)
    without_texture = (slashes == 2) & (doubled == 1) & (found == 2)
    empty_texture = (slashes == 1) & (found == 1)
    if (slashes > 2).any() or not (whole_corners | without_texture | empty_texture).all():
        raise ValueError("a corner with other slashes")
    return slashes


def _in_corners(positions: Integers, begins: Integers) -> Integers:
    """Count positions in each corner."""
    counts: Integers = np.diff(np.searchsorted(positions, begins), append=len(positions))
    return counts


def _numbers(text: bytes, count: int) -> Integers:
    values = integers(text, count)
    if values is None:
        raise ValueError("a corner that is no number")
    return values


def _indexes(numbers: Integers) -> Array:
    """Narrow indices counted from 1, or backwards."""
    indices = whole(numbers, np.int32)
    if not indices.all():
        raise ValueError("0")
    return indices


def _from_zero(
    numbers: Array, sizes: Integers, at: Integers, lines: Integers, before: int
) -> Array:
    """Count from 0; resolve negative indices, which count back from their own line."""
    backward = numbers < 0
    if not backward.any():
        counted: Array = numbers - np.int32(1)
        return counted
    so_far = np.repeat(before + np.searchsorted(lines, at), sizes)
    resolved = np.where(backward, so_far + numbers, numbers - 1)
    # Before the first there is no vertex; keep it distinct from -1, which means no normal.
    resolved[backward & (resolved < 0)] -= 1
    found: Array = resolved.astype(np.int32)
    return found


def _corner_error(faces: Block, name: str) -> FormatError:
    bad = (
        (corner[0], number)
        for text, number in faces
        for corner in _WORD.finditer(text)
        if not _is_corner(corner[0])
    )
    corner, number = next(bad)
    return FormatError(
        f"{name}: line {number}: {quoted(corner)} is not a corner of a face: expected vertex, "
        "vertex/texture, vertex/texture/normal or vertex//normal, counted from 1"
    )


def _is_corner(text: str) -> bool:
    found = _CORNER.fullmatch(text)
    return found is not None and all(each is None or int(each) for each in found.groups())
