"""Colours of OBJ vertices: three further values of each, or comments that ZBrush introduced.

``v x y z r g b`` is what most programs read; but some take all six for coordinates. Lines of
``#MRGB`` are comments to these: after the mark a mask and a colour of two hexadecimal digits a
channel for each vertex, 64 vertices to a line.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.io.colors import as_float, as_uint8
from liftmesh.io.lines import BLOCK, Lines

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
    found: Array = np.frombuffer(bytes(values), np.uint8).reshape(-1, 4)[:, 1:]
    return np.ascontiguousarray(found)
