"""Colours: whole numbers over their full range, or floats in [0, 1]; and their bit depth.

trimesh keeps 8-bit RGBA, Open3D floats from 0 to 1, files either, and text files just numbers. An
integer k of b bits is the float k / (2^b - 1); rounding to the nearest step inverts this, so 8-bit
colours round-trip unchanged. Signed integers, NumPy's default for a plain list, are read as 8-bit.

Where colours are recognised: `recognized` and `ColorScale` find the type of numbers in text, for
`text` (which also takes the last three of six unnamed columns) and `obj`; `columns` joins columns
called red, green and blue; `objects.trimesh` reads colours only where the object defines them.
Where precision is lost: PLY, unless written with ``colors="exact"``, and glTF round to 8 bits.

The type of whole numbers says how much it can hold, not how much was meant. LAS keeps colours in 16
bits, and most programs put 8-bit values there; NumPy makes 64-bit integers of any list. So the
values decide the depth, all of a file's or object's together: colours up to 255 are 8-bit, up to
65,535 16-bit, and larger ones use the full range of their type. A part is never judged by itself: a
dark corner of a 16-bit image holds no value above 255 either.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats
from liftmesh.base.options import refused
from liftmesh.errors import InputError, Option

DEPTHS = (8, 16, 32, 64)

# Error of k/255 when printed with six digits, or in single precision.
_PRINTED = 1e-6

_ROWS = 1 << 14  # converted at a time


def as_uint8(colors: Array) -> NDArray[np.uint8]:
    """Convert colours to 8-bit integers."""
    colors = check_colors(colors)
    if colors.dtype == np.uint8:
        return colors
    if colors.dtype.kind == "i":
        return colors.astype(np.uint8)
    return np.rint(as_float(colors) * 255.0).astype(np.uint8)


def as_float(colors: Array) -> Floats:
    """Convert colours to floats in [0, 1]."""
    colors = check_colors(colors)
    return colors.astype(np.float64, copy=False) / _full_scale(colors.dtype)


def with_alpha(colors: Array) -> Array:
    """Convert RGB colours to opaque RGBA; RGBA colours stay as they are."""
    if colors.shape[1] == 4:
        return colors
    opaque = np.full((len(colors), 1), _full_scale(colors.dtype), dtype=colors.dtype)
    return np.concatenate([colors, opaque], axis=1)


def is_opaque(colors: Array) -> bool:
    """Whether colours have no alpha, or a full-scale alpha everywhere."""
    return colors.shape[1] < 4 or bool((colors[:, 3] == _full_scale(colors.dtype)).all())


def fits_eight_bits(colors: Array) -> bool:
    """Whether eight bits per channel hold colours without loss."""
    if colors.dtype == np.uint8:
        return True
    blocks = (colors[start : start + _ROWS] for start in range(0, len(colors), _ROWS))
    return all(map(_is_eight_bits, blocks))


def _is_eight_bits(colors: Array) -> bool:
    values = as_float(colors)
    levels = _levels(values) / 255.0
    if colors.dtype.kind == "f":
        levels = levels.astype(colors.dtype).astype(np.float64)
    return np.array_equal(levels, values)


def recognized(values: Floats) -> Array | None:
    """Detect the type of colours that a text file holds as numbers."""
    scale = ColorScale()
    scale.examine(values)
    return scale.convert(values)


class ColorScale:
    """Type of the colours in a text file, determined block by block."""

    def __init__(self) -> None:
        self._inside = self._whole = self._eighths = True
        self._top = 0.0

    def examine(self, values: Floats) -> None:
        """Examine further numbers."""
        self._inside = self._inside and bool(np.all((values >= 0) & (values <= 65535)))
        if not self._inside:
            return
        self._whole &= bool(np.all(values == np.rint(values)))
        self._eighths &= bool(np.all(np.abs(values - _levels(values) / 255.0) <= _PRINTED))
        self._top = max(self._top, float(values.max(initial=0.0)))

    def convert(self, values: Floats) -> Array | None:
        """Convert numbers that were examined."""
        if not self._inside or (self._top > 1 and not self._whole):
            return None
        if self._top > 1:
            return values.astype(np.uint8 if self._top <= 255 else np.uint16)
        return _levels(values).astype(np.uint8) if self._eighths else values


def check_colors(colors: Array) -> Array:
    """Validate type, shape and range of colours; the error names the row."""
    colors = np.asarray(colors)
    if colors.ndim != 2 or colors.shape[1] not in (3, 4) or colors.dtype.kind not in "uif":
        raise InputError(
            f"colours need shape (n, 3) or (n, 4) and numbers, not {colors.dtype} {colors.shape}"
        )
    if colors.dtype.kind != "u":
        _check_range(colors, _full_scale(colors.dtype))
    return colors


def _check_range(colors: Array, top: float) -> None:
    """Raise for the first row with a value outside 0..top; NaN is outside."""
    inside = ((colors >= 0) & (colors <= top)).all(axis=1)
    if inside.all():
        return
    row = int(np.argmin(inside))
    raise InputError(
        f"row {row} has the colour {colors[row].tolist()}, outside 0..{top:g}: give unsigned "
        "integers over their full range, or floats in [0, 1]"
    )


def _full_scale(dtype: np.dtype[Any]) -> float:
    if dtype.kind == "u":
        return float(np.iinfo(dtype).max)
    return 255.0 if dtype.kind == "i" else 1.0


def _levels(values: Floats) -> Floats:
    scaled: Floats = np.rint(values * 255.0)
    return scaled


def judged(colors: Array) -> tuple[Array, int | None]:
    """Decide the depth of colours from all their values; None if they need no decision."""
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
            f"{Option('color_depth', depth)}: give another depth, or none: the values decide"
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
        raise refused("color_depth", depth, f"give 8, 16, 32 or 64 bits{none}")


def _of_depth(colors: Array, depth: int) -> Array:
    return colors.astype(f"u{depth // 8}", copy=False)
