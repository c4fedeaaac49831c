"""The faces of an OBJ file, as ``f`` lines spell them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Integers
from liftmesh.errors import FormatError
from liftmesh.io.ragged import Ragged
from liftmesh.io.text_tables import Block, number_table, shown

_PAIRS = re.compile(r"-?\d+//-?\d+(?:[ \t]+-?\d+//-?\d+)*", re.ASCII)


@dataclass(frozen=True, slots=True)
class Corners:
    """Faces: their vertices, counted from 0, the normal of each corner (-1: none), their lines."""

    vertices: Ragged
    normals: Integers
    lines: Integers

    @classmethod
    def joined(cls, parts: Sequence[Corners]) -> Corners:
        """Stack faces upon faces."""
        return cls(
            Ragged.joined([each.vertices for each in parts]),
            np.concatenate([each.normals for each in parts]),
            np.concatenate([each.lines for each in parts]),
        )


def parse_corners(
    faces: Block, name: str, numbers: tuple[Integers, Integers], before: tuple[int, int]
) -> Corners:
    """Parse the face lines of a block.

    Parameters
    ----------
    faces : Block
        What follows the keyword ``f``.
    name : str
        The file's name for messages.
    numbers : pair of arrays of int
        The lines of the block's vertices and of its normals: backward indices count from there.
    before : pair of int
        How many vertices and normals the blocks before had.

    Raises
    ------
    FormatError
        A corner is broken; the message names its line.
    """
    sizes, vertices, normals = _plain(faces, name) or _general(faces, name)
    at = np.repeat(faces.numbers, sizes)
    return Corners(
        Ragged(sizes, _from_zero(vertices, at, numbers[0], before[0])),
        _from_zero(normals, at, numbers[1], before[1]),
        faces.numbers,
    )


def _plain(faces: Block, name: str) -> tuple[Integers, Integers, Integers] | None:
    """Parse faces all of one size, each corner ``vertex`` or ``vertex//normal``, as most are."""
    texts, pair = faces.texts, False
    if any("/" in text for text in texts):
        if not all(map(_PAIRS.fullmatch, texts)):
            return None
        texts, pair = [text.replace("//", " ") for text in texts], True
    try:
        table = number_table(Block(texts, faces.numbers), name)
    except FormatError:
        return None
    with np.errstate(invalid="ignore"):
        numbers = table.astype(np.int64)
    if not np.all(numbers == table) or not numbers.all():
        return None
    vertices = numbers[:, ::2] if pair else numbers
    normals = numbers[:, 1::2] if pair else np.zeros_like(numbers)
    sizes = np.full(len(faces), vertices.shape[1], dtype=np.int64)
    return sizes, vertices.reshape(-1), normals.reshape(-1)


def _general(faces: Block, name: str) -> tuple[Integers, Integers, Integers]:
    corners = [text.split() for text in faces.texts]
    sizes = np.fromiter(map(len, corners), np.int64, len(corners))
    try:
        vertices, normals = _indices([corner for row in corners for corner in row])
    except (ValueError, OverflowError) as error:
        raise _blame(faces, name) from error
    return sizes, vertices, normals


def _indices(corners: list[str]) -> tuple[Integers, Integers]:
    """Split corners into vertex and normal numbers, 0 for no normal."""
    joined = " ".join(corners)
    if "_" in joined:
        raise ValueError("_")
    if "/" not in joined:
        vertices = np.fromiter(map(int, corners), np.int64, len(corners))
        return _nonzero(vertices), np.zeros(len(corners), dtype=np.int64)
    parts = [corner.split("/") for corner in corners]
    if max(map(len, parts)) > 3:
        raise ValueError("/")
    count = len(parts)
    vertices = np.fromiter((int(part[0]) for part in parts), np.int64, count)
    has_normal = np.fromiter((len(part) == 3 for part in parts), bool, count)
    normals = np.zeros(count, dtype=np.int64)
    normals[has_normal] = [int(part[2]) for part in parts if len(part) == 3]
    _nonzero(normals[has_normal])
    return _nonzero(vertices), normals


def _nonzero(numbers: Integers) -> Integers:
    if not numbers.all():
        raise ValueError("0")
    return numbers


def _from_zero(numbers: Integers, at: Integers, lines: Integers, before: int) -> Integers:
    """Count from 0; negative numbers count back from what the file held up to their own line."""
    backward = numbers < 0
    if not backward.any():
        return numbers - 1
    so_far = before + np.searchsorted(lines, at)
    resolved = np.where(backward, so_far + numbers, numbers - 1)
    # Back beyond the first is no vertex at all; -1 would mean that there is no normal.
    return np.where(backward & (resolved < 0), resolved - 1, resolved)


def _blame(faces: Block, name: str) -> FormatError:
    bad = (
        (corner, number)
        for text, number in faces
        for corner in text.split()
        if not _is_corner(corner)
    )
    corner, number = next(bad)
    return FormatError(
        f"{name}: line {number}: {shown(corner)} is no corner of a face: it should be vertex, "
        "vertex/texture, vertex/texture/normal or vertex//normal, counted from 1"
    )


def _is_corner(text: str) -> bool:
    try:
        _indices([text])
    except (ValueError, OverflowError):
        return False
    return True
