"""From a surface to a raster: heights, slopes, aspects or shades at the centres of pixels.

The centre of a pixel is the point that the transform gives for it, in doubles (`pixels.py`), and
its value is that of the surface there: the kernel scans the faces, row by row, and gives every
centre to one of them (`_core/surface/scan.hpp`). So the heights are bit for bit those of
`Surface.sample`. Other quantities follow from the gradients of faces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from liftmesh._typing import Array, Floats
from liftmesh.base.options import (
    Interpolation,
    RasterQuantity,
    as_threads,
    check_option,
    refused,
)
from liftmesh.errors import InputError, Option
from liftmesh.raster.pixels import Layout, centres_of, layout_of
from liftmesh.raster.raster import Raster
from liftmesh.terrain.sampling import aspect_degrees, heights_at, slope_degrees
from liftmesh.terrain.surface_data import SurfaceData, kernel_surface, plane_system
from liftmesh.terrain.units import OverPlane, slope_scale, steepness, unit_names

_UNITS = {"slope": "degree", "aspect": "degree"}
_TOGETHER = 1 << 22  # pixels whose gradients are held at a time
_TYPES = (np.dtype(np.float64), np.dtype(np.float32))
_STEEP, _SCALE = 2.0**500, 2.0**-600


def rasterize(  # noqa: PLR0913 - options are keywords
    surface: SurfaceData,
    resolution: float | Sequence[float] | None,
    *,
    bounds: Sequence[float] | None,
    transform: Sequence[float] | None,
    shape: Sequence[int] | None,
    quantity: RasterQuantity,
    interpolation: Interpolation,
    light: tuple[float, float],
    z_factor: float | None,
    dtype: DTypeLike,
    threads: int | None,
) -> Raster:
    """Compute heights, or what follows from them, at the centres of pixels."""
    layout = layout_of(resolution, bounds, transform, shape, lambda: _extent(surface))
    wanted = Wanted.validated(surface, quantity, interpolation, dtype, light, z_factor)
    scan = scanner(surface, layout, threads)
    values = np.empty((layout.rows, layout.columns), wanted.kind)
    if quantity == "height":
        _check_range(surface, wanted)
    if quantity == "height" and interpolation == "linear":
        scan(values[:, :, None], 0)
    elif quantity == "height":
        for first, block in _blocks_of_rows(values):
            rows = range(first, first + len(block))
            centres = centres_of(layout.transform, rows, layout.columns)
            block[...] = heights_at(surface, centres, interpolation, threads=threads)
    else:
        for first, block in _blocks_of_rows(values):
            gradients = np.empty((*block.shape, 2))
            scan(gradients, first)
            block[...] = wanted.of_gradients(gradients)
    wanted.finish(values)
    unit = unit_of(surface, quantity)
    return Raster(values, layout.transform, plane_system(surface), quantity, unit)


def _extent(surface: SurfaceData) -> list[float]:
    """Return xmin, ymin, xmax and ymax of the faces."""
    solved = surface.triangulation
    corners = solved.points[solved.convex_hull if surface.mask is None else surface.faces.ravel()]
    return [*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist()]


def unit_of(surface: OverPlane, quantity: str) -> str | None:
    """Return the unit of what a raster holds; None if it is not known, or there is none."""
    return unit_names(surface)[1] if quantity == "height" else _UNITS.get(quantity)


def _check_range(surface: SurfaceData, wanted: Wanted) -> None:
    """Raise if a height of a face is beyond the type; others than those of faces may be."""
    heights = surface.frame.heights(surface.vertices)
    if not np.fmax.reduce(np.abs(heights)) <= np.finfo(wanted.kind).max:
        wanted.check_range(heights[surface.faces])


def _blocks_of_rows(values: Array) -> Iterator[tuple[int, Array]]:
    """Yield the rows of a raster, some at a time, and the number of the first."""
    count = max(_TOGETHER // values.shape[1], 1)
    for first in range(0, len(values), count):
        yield first, values[first : first + count]


def scanner(
    surface: SurfaceData, layout: Layout, threads: int | None
) -> Callable[[Array, int], None]:
    """Return the kernel's scan of a surface, which fills pixels from a row of the raster on.

    Pixels are (rows, columns, k): heights if k is 1, gradients if it is 2, and integers get faces.
    """
    limit = as_threads(threads, layout.rows * layout.columns)
    locator = surface.triangulation._locator  # noqa: SLF001 - as in `heights_at`
    relief = kernel_surface(surface)

    def scan(pixels: Array, first_row: int) -> None:
        relief.scan(locator, layout.transform, first_row, pixels, *limit)

    return scan


@dataclass(frozen=True)
class Wanted:
    """Which values a raster is asked to hold, checked."""

    quantity: str
    kind: np.dtype[Any]
    light: Floats  # the unit vector towards it
    rise: tuple[float, float]  # what gradients are multiplied by

    @classmethod
    def validated(
        cls,
        surface: OverPlane,
        quantity: RasterQuantity,
        interpolation: Interpolation,
        dtype: DTypeLike,
        light: tuple[float, float],
        z_factor: float | None,
    ) -> Wanted:
        """Check the options."""
        check_option("quantity", quantity, RasterQuantity)
        check_option("interpolation", interpolation, Interpolation)
        check_interpolation(quantity, interpolation)
        scale = slope_scale if quantity == "height" else steepness
        return cls(quantity, _checked_type(dtype), _light_of(light), scale(surface, z_factor))

    def check_range(self, heights: Floats) -> None:
        """Raise if one of some heights, or of their bounds, is finite but beyond the type."""
        farthest = float(heights.ravel()[np.argmax(np.abs(heights))])
        with np.errstate(over="ignore"):
            is_beyond = math.isfinite(farthest) and np.isinf(self.kind.type(farthest))
        if is_beyond:
            raise InputError(
                f"the height {farthest} is beyond {self.kind.name}: give "
                f"{Option('dtype', 'float64')}"
            )

    def of_gradients(self, gradients: Floats) -> Floats:
        """Compute slopes, aspects or shades."""
        return _OF_GRADIENTS[self.quantity](gradients * self.rise, self.light)

    def finish(self, values: Array) -> None:
        """Change in place what is another value once it is rounded to the type."""
        if self.quantity == "aspect":
            values[values == 360] = 0  # which is north, too


def check_interpolation(quantity: RasterQuantity, interpolation: Interpolation) -> None:
    """Raise unless a quantity has an interpolation."""
    if quantity != "height" and interpolation != "linear":
        raise InputError(
            f"{quantity} is that of faces: leave out {Option('interpolation', interpolation)}"
        )


def _checked_type(dtype: DTypeLike) -> np.dtype[Any]:
    try:
        kind = np.dtype(dtype)
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError):
        kind = np.dtype(np.void)
    if kind not in _TYPES:
        raise refused("dtype", dtype, "give 'float64' or 'float32'")
    return kind


def _light_of(light: tuple[float, float]) -> Floats:
    """Convert azimuth and altitude to the direction towards the light."""
    try:
        azimuth, altitude = (math.radians(float(each)) for each in light)
    except (TypeError, ValueError) as error:
        raise refused("light", light, "give azimuth and altitude, in degrees") from error
    if not (math.isfinite(azimuth) and 0 <= altitude <= math.pi / 2):
        raise refused("light", light, "give an altitude from 0 to 90 degrees")
    level = math.cos(altitude)
    return np.array([math.sin(azimuth) * level, math.cos(azimuth) * level, math.sin(altitude)])


def shade_of(gradients: Floats, light: Floats) -> Floats:
    """Compute how bright faces are under a distant light: 0 in the shade, 255 facing it."""
    steep = np.abs(gradients).max(axis=-1, initial=0) > _STEEP
    scale = np.where(steep, _SCALE, 1.0)  # of the normal, so that its square is a double
    x, y = gradients[..., 0] * scale, gradients[..., 1] * scale
    facing = light[2] * scale - light[0] * x - light[1] * y
    shades: Floats = 255 * np.maximum(facing, 0) / np.sqrt(scale * scale + x * x + y * y)
    return shades


_OF_GRADIENTS: dict[str, Callable[[Floats, Floats], Floats]] = {
    "slope": lambda gradients, _: slope_degrees(gradients),
    "aspect": lambda gradients, _: aspect_degrees(gradients),
    "hillshade": shade_of,
}
