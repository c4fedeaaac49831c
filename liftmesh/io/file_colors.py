"""Colours as files hold them: eight bits a channel, or floats in [0, 1]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError

# What six printed digits, or single precision, leave of k/255.
_PRINTED = 1e-6


def eight_bit(colors: Array) -> NDArray[np.uint8]:
    """Round colours to eight bits a channel: unsigned over their full range, floats from [0, 1].

    Raises
    ------
    FormatError
        A float is NaN or outside [0, 1]; the message names the row.
    """
    if colors.dtype == np.uint8:
        return colors
    if colors.dtype.kind == "u":
        full = float(np.iinfo(colors.dtype).max)
        return np.rint(colors * (255.0 / full)).astype(np.uint8)
    return np.rint(_checked(colors) * 255.0).astype(np.uint8)


def unit(colors: Array) -> Array:
    """Turn colours into floats in [0, 1]; floats stay as they are."""
    if colors.dtype.kind == "u":
        return colors / float(np.iinfo(colors.dtype).max)
    return _checked(colors)


def recognized(values: Floats) -> Array | None:
    """Tell what colours in a text file are: eight or sixteen bits, floats in [0, 1], or none.

    Whole numbers up to 255 are eight bits, up to 65,535 sixteen; where no value exceeds one they
    are floats. Floats that are all k/255, as far as printed digits tell, are eight bits too.
    """
    if not np.all((values >= 0) & (values <= 65535)):
        return None
    if not np.any(values > 1):
        return _eighths(values)
    if np.any(values != np.rint(values)):
        return None
    return values.astype(np.uint8 if np.all(values <= 255) else np.uint16)


def _eighths(values: Floats) -> Array:
    scaled = np.rint(values * 255.0)
    exact = np.all(np.abs(values - scaled / 255.0) <= _PRINTED)
    return scaled.astype(np.uint8) if exact else values


def _checked(colors: Array) -> Array:
    if colors.dtype.kind != "f":
        raise FormatError(
            f"colours of type {colors.dtype} cannot be written: "
            "use uint8, uint16, or floats between 0 and 1"
        )
    wrong = ~((colors >= 0) & (colors <= 1)).all(axis=1)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise FormatError(
            f"colour of row {row} is {colors[row].tolist()}: floats must lie between 0 and 1"
        )
    return colors
