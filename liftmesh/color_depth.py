"""The depth of whole-number colours: how many bits per channel their numbers mean.

A type says how much it can hold, not how much was meant. LAS keeps colours in 16 bits, and most
programs put 8-bit values there; NumPy makes 64-bit integers of any list. So the values decide,
all of a file's or object's together: colours up to 255 are 8-bit, up to 65,535 16-bit, and larger
ones use the full range of their type. A part is never judged by itself: a dark corner of a 16-bit
image holds no value above 255 either.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array
from liftmesh.choices import shown
from liftmesh.errors import InputError

DEPTHS = (8, 16, 32, 64)


def judged(colors: Array) -> tuple[Array, int | None]:
    """Decide the depth of colours from all their values."""
    if colors.dtype.kind not in "iu" or colors.dtype == np.uint8:
        return colors, None
    low, high = (int(colors.min()), int(colors.max())) if colors.size else (0, 0)
    is_signed = colors.dtype.kind == "i"
    if low < 0 or (is_signed and high > 65535):
        return colors, None
    depth = 8 if high <= 255 else 16 if high <= 65535 else 8 * colors.dtype.itemsize
    return _of_depth(colors, depth), depth


def with_depth(colors: Array, depth: int) -> Array:
    """Take the numbers of whole-number colours as those of a depth."""
    check_depth(depth, is_optional=False)
    if colors.dtype.kind not in "iu":
        return colors
    top = 2**depth - 1
    if colors.size and (int(colors.min()) < 0 or int(colors.max()) > top):
        outside = ((colors < 0) | (colors > top)).reshape(len(colors), -1).any(axis=1)
        row = int(np.argmax(outside))
        raise InputError(
            f"row {row} has the colour {colors[row].tolist()}, outside 0..{top}, the range of "
            f"color_depth={depth}: give another depth, or none: the values decide"
        )
    return _of_depth(colors, depth)


def kept_depth(colors: Array | None) -> int | None:
    """Return the depth that the type of decided colours says, for a part of them or a copy."""
    is_wide = colors is not None and colors.dtype.kind == "u" and colors.dtype.itemsize > 1
    return 8 * colors.dtype.itemsize if colors is not None and is_wide else None


def stated_depth(colors: Array | None) -> int | None:
    """Return the depth that a file must state, because its values alone would tell another."""
    depth = kept_depth(colors)
    return None if colors is None or judged(colors)[1] == depth else depth


def confirmed_depth(colors: Array | None, stated: int | None) -> int | None:
    """Return the depth that a file states of its colours, if it is that of their type."""
    return stated if stated == kept_depth(colors) else None


def check_depth(depth: int | None, *, is_optional: bool = True) -> None:
    """Raise if an option is no depth."""
    if depth is None and is_optional:
        return
    if not isinstance(depth, int | np.integer) or depth not in DEPTHS:
        none = ", or None" if is_optional else ""
        raise InputError(f"color_depth is {shown(depth)}: give 8, 16, 32 or 64 bits{none}")


def _of_depth(colors: Array, depth: int) -> Array:
    return colors.astype(f"u{depth // 8}", copy=False)
