"""Where the pixels of a raster are: from a resolution, or from the transform of another raster.

What a file does not say itself may stand beside it, under its name with another suffix: a world
file has six numbers, of which the last two are the centre of the first pixel; a .prj file has the
text of a coordinate system.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_decimal, as_numbers, as_reals
from liftmesh.base.cloud import is_crs
from liftmesh.base.options import as_thousands, refused
from liftmesh.crs.description import parse_crs
from liftmesh.errors import FormatError, InputError, Option

Transform: TypeAlias = tuple[float, float, float, float, float, float]

_MOST_SIDE = 1 << 30
_MOST_PIXELS = 1 << 36


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the pixels of a raster are."""

    transform: Transform
    rows: int
    columns: int


def layout_of(
    resolution: float | Sequence[float] | None,
    bounds: Sequence[float] | None,
    transform: Sequence[float] | None,
    shape: Sequence[int] | None,
    extent: Callable[[], Sequence[float]],  # the bounds if none are given
) -> Layout:
    """Decide where the pixels of a raster are."""
    if (resolution is None) == (transform is None) or (transform is None) != (shape is None):
        raise InputError(f"give either {Option('resolution')}, or transform and shape")
    if transform is not None and bounds is not None:
        raise InputError(
            f"{Option('bounds')} go with {Option('resolution')}: transform and shape say where the "
            "pixels are"
        )
    if resolution is None:
        return _checked(_numbers("transform", _without_last_row(transform), 6), *_whole(shape))
    steps = steps_of(resolution)
    return _aligned(*bounds_of(extent() if bounds is None else bounds), steps)


def steps_of(resolution: object) -> tuple[float, ...]:
    """Convert a resolution to the width and height of a pixel."""
    steps = _steps(resolution)
    if not all(step > 0 for step in steps):
        raise refused("resolution", resolution, "give a positive number, or two")
    return steps


def bounds_of(bounds: object, name: str = "bounds") -> tuple[float, float, float, float]:
    """Convert bounds to numbers."""
    left, low, right, high = _numbers(name, bounds, 4)
    if not (left < right and low < high):
        raise refused(name, bounds, "give xmin, ymin, xmax, ymax", verb="are")
    return left, low, right, high


def _steps(resolution: Any) -> tuple[float, ...]:
    """Convert a resolution to width and height; zeros if it is none."""
    try:
        steps = as_reals(resolution)
        return _numbers("resolution", np.repeat(steps, 2) if steps.ndim == 0 else steps, 2)
    except (TypeError, ValueError, OverflowError, InputError):
        return (0.0, 0.0)


def _aligned(left: float, low: float, right: float, high: float, steps: Sequence[float]) -> Layout:
    """Cover bounds by pixels whose edges are multiples of the resolution, as neighbours' are."""
    x, y = map(as_decimal, steps)
    first, last = math.floor(as_decimal(left) / x), math.ceil(as_decimal(right) / x)
    top, bottom = math.ceil(as_decimal(high) / y), math.floor(as_decimal(low) / y)
    columns, rows = max(last - first, 1), max(top - bottom, 1)
    _check_count(rows, columns)
    try:
        origin = float(first * x), float(top * y)
    except OverflowError as error:
        raise InputError("the edge of a pixel is beyond the largest double: give bounds") from error
    return _checked((steps[0], 0.0, origin[0], 0.0, -steps[1], origin[1]), rows, columns)


def _check_count(rows: int, columns: int) -> None:
    if min(rows, columns) < 1 or max(rows, columns) > _MOST_SIDE or rows * columns > _MOST_PIXELS:
        counts = f"{as_thousands(rows)} rows of {as_thousands(columns)} pixels"
        raise InputError(f"{counts} are too many, or none: give another resolution, or bounds")


def _checked(transform: Sequence[float], rows: int, columns: int) -> Layout:
    _check_count(rows, columns)
    a, b, c, d, e, f = transform
    exact_a, exact_b, exact_d, exact_e = map(Fraction, (a, b, d, e))
    if exact_a * exact_e == exact_b * exact_d:
        raise refused("transform", transform, "its pixels have no area")
    return Layout((a, b, c, d, e, f), rows, columns)


def _numbers(name: str, values: Any, count: int) -> tuple[float, ...]:
    """Convert an option to so many finite numbers."""
    numbers = as_numbers(name, values, f"give {count} numbers")
    if numbers.shape != (count,) or not np.isfinite(numbers).all():
        raise refused(name, values, f"give {count} finite numbers")
    return tuple(numbers.tolist())


def _without_last_row(transform: Any) -> Any:
    """Leave out 0, 0, 1 at the end of the nine numbers of an Affine, of any version."""
    is_affine = hasattr(transform, "is_rectilinear") and tuple(transform)[6:] == (0, 0, 1)
    return tuple(transform)[:6] if is_affine else transform


def _whole(shape: Any) -> tuple[int, int]:
    rows, columns = _numbers("shape", shape, 2)
    if rows != int(rows) or columns != int(columns):
        raise refused("shape", shape, "give rows and columns")
    return int(rows), int(columns)


def centres_of(transform: Transform, rows: range, columns: int | range) -> Floats:
    """Compute the centres of some rows of pixels."""
    a, b, c, d, e, f = transform
    across = range(columns) if isinstance(columns, int) else columns
    u, v = np.array(across) + 0.5, np.array(rows)[:, None] + 0.5
    centres: Floats = np.stack([a * u + b * v + c, d * u + e * v + f], axis=-1)
    return centres


_WORLDS = (".tfw", ".tifw", ".tiffw", ".wld", ".TFW", ".TIFW", ".WLD")
_MOST_BYTES = 1 << 16


class Affine(NamedTuple):
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


def world_of(name: str) -> tuple[Affine, str] | None:
    """Read the world file beside a raster."""
    path = file_beside(name, _WORLDS)
    if path is None:
        return None
    words = _text(path).split()
    try:
        a, d, b, e, x, y = map(float, words)
    except ValueError:
        a, d, b, e, x, y = [math.nan] * 6
    if not all(map(math.isfinite, (a, d, b, e, x, y))) or a * e == b * d:
        raise FormatError(f"{path}: a world file has six numbers that place a raster")
    return Affine(a, b, x - a / 2 - b / 2, d, e, y - d / 2 - e / 2), path.name


def system_of(name: str) -> str | None:
    """Read the coordinate system beside a raster; None if there is none, or in another language."""
    text = text_beside(name, ".prj")
    return text if is_crs(text) and parse_crs(text) else None


def text_beside(name: str, suffix: str) -> str | None:
    """Read at most 64 KiB of a file that has the name of another, and a suffix in either case."""
    path = file_beside(name, (suffix, suffix.upper()))
    return None if path is None else _text(path).strip("\0\ufeff \r\n\t")


def file_beside(name: str, suffixes: tuple[str, ...]) -> Path | None:
    """Find the file that has the name of another, and the first of these suffixes."""
    path = Path(name)
    if not path.suffix or "\0" in name:
        return None
    return next((each for each in map(path.with_suffix, suffixes) if each.is_file()), None)


def _text(path: Path) -> str:
    with path.open("rb") as stream:
        return stream.read(_MOST_BYTES).decode("utf-8", "replace")
