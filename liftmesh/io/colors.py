"""Colours between the conventions: unsigned integers over their full range, or floats in [0, 1].

trimesh keeps 8-bit RGBA, Open3D floats from 0 to 1, files either. An integer k of b bits is the
float k / (2^b - 1); rounding to the nearest step takes it back, so 8-bit colours survive the way
there and back unchanged. Signed integers, NumPy's default for a plain list, are read as 8-bit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats
from liftmesh.errors import InputError


def as_uint8(colors: Array) -> NDArray[np.uint8]:
    """Colours as 8-bit integers.

    Parameters
    ----------
    colors : (n, c) ndarray
        Unsigned integers over their full range, signed integers in 0..255, or floats in [0, 1].

    Returns
    -------
    (n, c) ndarray of uint8
        The nearest 8-bit colours; ``colors`` itself where it is 8-bit already.

    Raises
    ------
    InputError
        A value is outside its range or not a number.

    Examples
    --------
    >>> as_uint8(np.array([[0.0, 0.5, 1.0]]))
    array([[  0, 128, 255]], dtype=uint8)
    """
    colors = _checked(colors)
    if colors.dtype == np.uint8:
        return colors
    if colors.dtype.kind == "i":
        return colors.astype(np.uint8)
    return np.rint(as_float(colors) * 255.0).astype(np.uint8)


def as_float(colors: Array) -> Floats:
    """Colours as floats in [0, 1].

    Parameters
    ----------
    colors : (n, c) ndarray
        Unsigned integers over their full range, signed integers in 0..255, or floats in [0, 1].

    Returns
    -------
    (n, c) ndarray of float64
        Integers divided by the largest value of their type; floats as they are.

    Raises
    ------
    InputError
        A value is outside its range or not a number.

    Examples
    --------
    >>> as_float(np.array([[0, 51, 255]], dtype=np.uint8))
    array([[0. , 0.2, 1. ]])
    """
    colors = _checked(colors)
    return colors.astype(np.float64, copy=False) / _full_scale(colors.dtype)


def with_alpha(colors: Array) -> Array:
    """RGB colours as opaque RGBA; RGBA as it is.

    Parameters
    ----------
    colors : (n, 3) or (n, 4) ndarray
        Unsigned integers over their full range, or floats in [0, 1].

    Returns
    -------
    (n, 4) ndarray
        Colours of the same type, with an alpha of full scale where none was given.

    Examples
    --------
    >>> with_alpha(np.array([[1, 2, 3]], dtype=np.uint8))
    array([[  1,   2,   3, 255]], dtype=uint8)
    """
    if colors.shape[1] == 4:
        return colors
    opaque = np.full((len(colors), 1), _full_scale(colors.dtype), dtype=colors.dtype)
    return np.concatenate([colors, opaque], axis=1)


def _full_scale(dtype: np.dtype[Any]) -> float:
    if dtype.kind == "u":
        return float(np.iinfo(dtype).max)
    return 255.0 if dtype.kind == "i" else 1.0


def _checked(colors: Array) -> Array:
    """Colours of a usable type, shape and range, or an error that names the row."""
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
