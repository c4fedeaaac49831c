"""What stands beside a raster that does not say it itself: where it is, and in which system.

A world file has six numbers, of which the last two are the centre of the first pixel; a .prj file
has the text of a coordinate system. They have the name of the raster with another suffix.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

from liftmesh.base.cloud import is_crs
from liftmesh.crs.description import parse_crs
from liftmesh.errors import FormatError

_WORLDS = (".tfw", ".tifw", ".tiffw", ".wld", ".TFW", ".TIFW", ".WLD")
_MOST = 1 << 16  # bytes


class Transform(NamedTuple):
    """From column and row to x and y, as that of rasterio: ``x = a * column + b * row + c``."""

    a: float
    b: float
    c: float
    d: float
    e: float
    f: float

    @property
    def is_identity(self) -> bool:
        """Whether it says nothing."""
        return self == (1, 0, 0, 0, 1, 0)


def world_of(name: str) -> tuple[Transform, str] | None:
    """Read the world file beside a raster."""
    path = _beside(name, _WORLDS)
    if path is None:
        return None
    words = _text(path).split()
    try:
        a, d, b, e, x, y = map(float, words)
    except ValueError:
        a, d, b, e, x, y = [math.nan] * 6
    if not all(map(math.isfinite, (a, d, b, e, x, y))) or a * e == b * d:
        raise FormatError(f"{path}: a world file has six numbers that place a raster")
    return Transform(a, b, x - a / 2 - b / 2, d, e, y - d / 2 - e / 2), path.name


def system_of(name: str) -> str | None:
    """Read the coordinate system beside a raster; None if there is none, or in another language."""
    text = text_beside(name, ".prj")
    return text if is_crs(text) and parse_crs(text) else None


def text_beside(name: str, suffix: str) -> str | None:
    """Read at most 64 KiB of a file that has the name of another, and a suffix in either case."""
    path = _beside(name, (suffix, suffix.upper()))
    return None if path is None else _text(path).strip("\0\ufeff \r\n\t")


def _beside(name: str, suffixes: tuple[str, ...]) -> Path | None:
    path = Path(name)
    if not path.suffix or "\0" in name:
        return None
    return next((each for each in map(path.with_suffix, suffixes) if each.is_file()), None)


def _text(path: Path) -> str:
    with path.open("rb") as stream:
        return stream.read(_MOST).decode("utf-8", "replace")
