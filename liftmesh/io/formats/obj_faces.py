"""Faces of OBJ files: their corners, as indices of vertices and normals.

A corner is vertex, vertex/texture, vertex/texture/normal or vertex//normal. The kernel parses all
faces of a block at once, whatever their sizes.

Colours of OBJ vertices: three further values of each, or comments that ZBrush introduced.

``v x y z r g b`` is what most programs read; but some take all six for coordinates. Lines of
``#MRGB`` are comments to these: after the mark a mask and a colour of two hexadecimal digits a
channel for each vertex, 64 vertices to a line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Integers
from liftmesh.base.colors import as_float, as_uint8
from liftmesh.base.options import as_threads
from liftmesh.errors import FormatError
from liftmesh.io.columns import Ragged
from liftmesh.io.text_tables import BLOCK, Lines, quoted, words_of

if TYPE_CHECKING:
    from liftmesh.io.text_tables import Block


_CORNER = re.compile(r"([+-]?\d{1,9})(?:/(?:[+-]?\d{1,18})?(?:/([+-]?\d{1,9}))?)?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Corners:
    """Faces: vertices, counted from 0, the normal of each corner (-1: none), and line numbers."""

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
    """Parse the face lines of a block, without the keyword ``f``."""
    threads, _ = as_threads(None, len(faces))
    parsed = _kernel.parse_corners(faces.plain, faces.places, threads)
    if parsed is None:
        raise _corner_error(faces, name)
    counts, vertices, normals = parsed
    sizes: Integers = counts.astype(np.int32)
    lines = faces.numbers
    named = None
    if normals is not None:
        named = _from_zero(normals, sizes, lines, numbers[1], before[1])
    from_zero = _from_zero(vertices, sizes, lines, numbers[0], before[0])
    return Corners(Ragged(sizes, from_zero), named, lines)


def _from_zero(
    numbers: Array, sizes: Integers, at: Integers, lines: Integers, before: int
) -> Array:
    """Count from 0, in place; resolve negative indices, which count back from their own line."""
    if not len(numbers) or numbers.min() >= 0:
        numbers -= 1
        return numbers
    backward = numbers < 0
    so_far = np.repeat(before + np.searchsorted(lines, at), sizes)
    resolved = np.where(backward, so_far + numbers, numbers - 1)
    # Before the first there is no vertex; keep it distinct from -1, which means no normal.
    resolved[backward & (resolved < 0)] -= 1
    indices: Array = resolved.astype(np.int32)
    return indices


def outside(index: int, count: int, kind: str = "vertex") -> str:
    """Describe a corner that refers to a missing vertex or normal, in the file's numbers."""
    kinds = "vertices" if kind == "vertex" else f"{kind}s"
    if index < 0:
        return f"refers back to before the first of {count} {kinds}"
    return f"refers to {kind} {index + 1}, but there are {count} {kinds}"


def _corner_error(faces: Block, name: str) -> FormatError:
    bad = (
        (corner, number)
        for text, number in faces
        for corner in words_of(text)
        if not _is_corner(corner)
    )
    corner, number = next(bad)
    return FormatError(
        f"{name}: line {number}: {quoted(corner)} is not a corner of a face: expected vertex, "
        "vertex/texture, vertex/texture/normal or vertex//normal, counted from 1"
    )


def _is_corner(text: str) -> bool:
    match = _CORNER.fullmatch(text)
    return match is not None and all(each is None or int(each) for each in match.groups())


MARK = "#MRGB"
_PER_LINE = 64
_OPAQUE = 255

# k/255 in the shortest digits of single precision: readers that use floats get this number.
_EIGHT_BITS = (np.arange(256) / 255).astype(np.float32)


def color_columns(colors: Array) -> Array:
    """The red, green and blue to be written behind coordinates."""
    rgb = colors[:, :3]
    if rgb.dtype == np.uint8:
        return np.take(_EIGHT_BITS, rgb)
    unit = as_float(rgb)
    # Single precision is kept: it needs fewer digits.
    return unit.astype(rgb.dtype) if rgb.dtype.kind == "f" else unit


def write_comments(stream: BinaryIO, colors: Array) -> None:
    """Write colours as comments, rounded to eight bits."""
    masked = np.full((len(colors), 4), _OPAQUE, dtype=np.uint8)
    masked[:, 1:] = as_uint8(colors)[:, :3]
    for start in range(0, len(masked), _PER_LINE):
        digits = masked[start : start + _PER_LINE].tobytes().hex()
        stream.write(f"{MARK} {digits}\n".encode("ascii"))


def commented_colors(stream: BinaryIO, name: str) -> Array | None:
    """Read the colours that comments hold, from the beginning of a stream."""
    values = bytearray()
    lines = Lines(stream, name)
    while len(block := lines.take(BLOCK)):
        for text in block.texts:
            if text.startswith(MARK):
                try:
                    values += bytes.fromhex(text[len(MARK) :])
                except ValueError:
                    return None
    if len(values) % 4:
        return None
    colors: Array = np.frombuffer(bytes(values), np.uint8).reshape(-1, 4)[:, 1:]
    return np.ascontiguousarray(colors)
