"""Conversion of colours between unsigned integers over their full range and floats in [0, 1].

trimesh keeps 8-bit RGBA, Open3D floats from 0 to 1, files either, and text files just numbers. An
integer k of b bits is the float k / (2^b - 1); rounding to the nearest step inverts this, so 8-bit
colours round-trip unchanged. Signed integers, NumPy's default for a plain list, are read as 8-bit.

Where colours are recognised: `recognized` and `ColorScale` find the type of numbers in text, for
`text` (which also takes the last three of six unnamed columns) and `obj`; `columns` joins columns
called red, green and blue; `objects.trimesh` reads colours only where the object defines them.
Where precision is lost: PLY, unless written with ``colors="exact"``, and glTF round to 8 bits.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats
from liftmesh.errors import InputError

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


def _levels(values: Floats) -> Floats:
    scaled: Floats = np.rint(values * 255.0)
    return scaled


def _full_scale(dtype: np.dtype[Any]) -> float:
    if dtype.kind == "u":
        return float(np.iinfo(dtype).max)
    return 255.0 if dtype.kind == "i" else 1.0


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
