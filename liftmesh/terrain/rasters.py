"""Rasters of a surface: heights, slopes, aspects, shades and longest sides at centres of pixels.

The centre of a pixel is the point that the transform gives for it, in doubles (`pixels.py`), and
its value is that of the surface there: the kernel scans the faces, row by row, and gives every
centre to one of them (`_core/surface/scan.cpp`). So the heights are bit for bit those of
`Surface.sample`. Other quantities follow from the faces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol, TypedDict

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from liftmesh._typing import Array, Floats
from liftmesh.base.options import Interpolation, RasterQuantity, as_threads, check_option, refused
from liftmesh.errors import InputError, Option
from liftmesh.raster.fill import Reach, filled
from liftmesh.raster.pixels import Layout, centres_of, layout_of
from liftmesh.raster.raster import Raster
from liftmesh.terrain.sampler import Sampler, check_gradients
from liftmesh.terrain.sampling import aspect_degrees, slope_degrees
from liftmesh.terrain.surface_data import (
    OverPlane,
    SurfaceData,
    bounds_of_faces,
    check_planes,
    kernel_surface,
    plane_system,
    slope_scale,
    steepness,
    unit_names,
)
from liftmesh.terrain.values import Values, over_values

if TYPE_CHECKING:
    from typing_extensions import Unpack

_UNITS: dict[str, str | None] = {"slope": "degree", "aspect": "degree"}
_TOGETHER = 1 << 22  # pixels whose gradients are held at a time
_TYPES = (np.dtype(np.float64), np.dtype(np.float32))
_STEEP, _SCALE = 2.0**500, 2.0**-600


class Subtracted(OverPlane, Protocol):
    """A surface whose heights are subtracted: in memory, or in tiles."""

    def sample(
        self, points: ArrayLike, interpolation: Interpolation, *, threads: int | None
    ) -> Floats:
        """Interpolate heights at points."""
        ...


class RasterOptions(TypedDict, total=False):
    """The options of `Surface.raster`, which also describes those of tiles."""

    bounds: Sequence[float] | None
    transform: Sequence[float] | None
    shape: Sequence[int] | None
    quantity: RasterQuantity
    interpolation: Interpolation
    fill: float | None
    light: tuple[float, float]
    z_factor: float | None
    dtype: DTypeLike
    threads: int | None
    minus: Subtracted | None


_DEFAULTS: RasterOptions = {
    "bounds": None,
    "transform": None,
    "shape": None,
    "quantity": "height",
    "interpolation": "linear",
    "fill": None,
    "light": (315.0, 45.0),
    "z_factor": None,
    "dtype": np.float64,
    "threads": None,
    "minus": None,
}


def rasterize(
    surface: SurfaceData,
    resolution: float | Sequence[float] | None = None,
    *,
    values: Values | None = None,
    gradients: ArrayLike | None = None,
    **options: Unpack[RasterOptions],
) -> Raster:
    """Compute heights, or what follows from them, at the centres of pixels.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    resolution : float or pair of float, optional
        Width and height of a pixel. The edges of pixels are multiples of it, so that rasters of
        neighbouring surfaces fit together; row 0 is the one with the largest y.
    values : str or array_like of shape (n,), optional
        Values of the vertices in place of heights, or the name of attributes, which is the
        quantity of the raster then.
    gradients : array_like of shape (n, 2), optional
        As for `heights_at`, with the interpolation "c1".
    **options
        What else is asked for:

        - ``bounds``: xmin, ymin, xmax and ymax to cover; by default those of the faces.
        - ``transform`` and ``shape``, in place of the resolution: a, b, c, d, e and f of a
          `Raster`, any affine transform, as that of another raster; rows and columns.
        - ``quantity``: "height", above the plane; or what the face that owns the centre has:
          "slope" or "aspect", in degrees as of `slopes_at` and `aspects_at`,
          "hillshade", brightness from 0 to 255, or "longest-edge", how long its longest side is in
          the plane: where that is large, the surface is a guess.
        - ``interpolation``: of heights, as for `heights_at`.
        - ``fill``: within which distance pixels without a value get that of the nearest pixel with
          one, as by `Raster.filled`.
        - ``light``, default (315, 45): azimuth of the light, in degrees clockwise from the
          direction of y, and altitude above the plane, for "hillshade".
        - ``z_factor``: as for `slopes_at`; other than 1, it exaggerates shades.
        - ``dtype``: "float64", or "float32"; heights are rounded once.
        - ``threads``: as for `delaunay`.
        - ``minus``: another surface over the same plane, in memory or in tiles, whose height is
          subtracted: a map of cut and fill, with NaN where either has no face.

    Returns
    -------
    Raster
        The values; NaN where no face contains the centre of a pixel, or, with ``fill``, is near.

    Raises
    ------
    InputError
        An option is unknown, or what is given does not determine a raster.

    See Also
    --------
    Surface.sample, Surface.slope, Surface.aspect : The same at any points.
    Raster.save : Write it to a file.

    Notes
    -----
    Pixels near the distance of doubles (0.1 at 1e15) may end one too early: subtract an offset.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]])
    >>> surface.raster(2).values
    array([[2., 6.],
           [2., 6.]])
    >>> surface.raster((4, 2), quantity="aspect").values.ravel()
    array([270., 270.])
    """
    if values is not None:
        if options.get("quantity", "height") != "height":
            raise InputError(f"give {Option('quantity')} or {Option('values')}, not both")
        if options.get("minus") is not None:
            raise InputError(f"give {Option('minus')} or {Option('values')}, not both")
        over = over_values(surface, values)
        made = rasterize(over, resolution, gradients=gradients, **options)
        return replace(made, quantity=values if isinstance(values, str) else "values", unit=None)
    plan = RasterPlan.of(surface, resolution, lambda: bounds_of_faces(surface), options)
    if gradients is not None:
        check_gradients(plan.interpolation)
    pixels = np.empty((plan.layout.rows, plan.layout.columns), plan.kind)
    _put(pixels, surface, plan, gradients)
    plan.finish(pixels)
    if plan.reach is not None:
        pixels = filled(pixels, plan.reach)
    return plan.raster(pixels, plane_system(surface))


def _put(
    pixels: Array, surface: SurfaceData, plan: RasterPlan, gradients: ArrayLike | None
) -> None:
    """Compute the values of pixels."""
    scan = scanner(surface, plan.layout, plan.threads)
    if plan.quantity == "height":
        _check_range(surface, plan)
    if plan.quantity == "height" and plan.interpolation == "linear" and plan.minus is None:
        scan(pixels[:, :, None], 0)
    elif plan.quantity == "height":
        sampler = Sampler(surface, None, plan.interpolation, None, gradients)
        for first, block in _blocks_of_rows(pixels):
            rows = range(first, first + len(block))
            centers = centres_of(plan.layout.transform, rows, plan.layout.columns)
            block[...] = plan.less(centers, sampler.at(centers, plan.threads))
    else:
        _scan_faces(surface, plan, scan, pixels)


def _scan_faces(
    surface: SurfaceData, plan: RasterPlan, scan: Callable[[Array, int], None], pixels: Array
) -> None:
    """Fill pixels with what the faces have that own their centres."""
    if plan.quantity == "longest-edge":
        lengths = longest_sides(surface)
    for first, block in _blocks_of_rows(pixels):
        if plan.quantity == "longest-edge":
            faces = np.empty((*block.shape, 1), np.int32)
            scan(faces, first)
            block[...] = lengths[faces[..., 0]]
        else:
            gradients = np.empty((*block.shape, 2))
            scan(gradients, first)
            block[...] = plan.of_gradients(gradients)


def longest_sides(surface: SurfaceData) -> Floats:
    """Return the length of the longest side of each triangle in the plane, and NaN for none."""
    solved = surface.triangulation
    corners = solved.points.take(solved.simplices, axis=0).astype(np.float64, copy=False)
    with np.errstate(over="ignore"):
        sides = corners - np.roll(corners, 1, axis=1)
        lengths: Floats = np.hypot(sides[..., 0], sides[..., 1]).max(axis=1)
    return np.append(lengths, np.nan)


def _check_range(surface: SurfaceData, plan: RasterPlan) -> None:
    """Raise if a height of a face is beyond the type; others than those of faces may be."""
    heights = surface.frame.heights(surface.vertices)
    if not np.fmax.reduce(np.abs(heights)) <= np.finfo(plan.kind).max:
        plan.check_range(heights.take(surface.faces, axis=0))


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
class RasterPlan:
    """Where the pixels of a raster are, and which values they are asked to hold, checked."""

    layout: Layout
    quantity: str
    interpolation: Interpolation
    reach: Reach | None
    kind: np.dtype[Any]
    light: Floats  # the unit vector towards it
    rise: tuple[float, float]  # what gradients are multiplied by
    unit: str | None
    threads: int | None
    minus: Subtracted | None

    @classmethod
    def of(
        cls,
        surface: OverPlane,
        resolution: float | Sequence[float] | None,
        extent: Callable[[], Sequence[float]],
        options: RasterOptions,
    ) -> RasterPlan:
        """Check the options."""
        for name in options.keys() - _DEFAULTS.keys():
            raise TypeError(f"a raster has no option {name!r}: give some of {', '.join(_DEFAULTS)}")
        all_of = _DEFAULTS | options
        quantity, interpolation = all_of["quantity"], all_of["interpolation"]
        layout = layout_of(
            resolution, all_of["bounds"], all_of["transform"], all_of["shape"], extent
        )
        check_option("quantity", quantity, RasterQuantity)
        check_option("interpolation", interpolation, Interpolation)
        check_interpolation(quantity, interpolation)
        has_slopes = quantity in _OF_GRADIENTS
        rise = (steepness if has_slopes else slope_scale)(surface, all_of["z_factor"])
        lengths = dict(zip(("longest-edge", "height"), unit_names(surface), strict=True))
        unit = (lengths | _UNITS).get(quantity)
        kind, light = _checked_type(all_of["dtype"]), _light_of(all_of["light"])
        fill = all_of["fill"]
        reach = None if fill is None else Reach.of(fill, layout.transform, "fill")
        minus = _checked_minus(surface, all_of["minus"], quantity)
        rest = kind, light, rise, unit, all_of["threads"], minus
        return cls(layout, quantity, interpolation, reach, *rest)

    def raster(self, values: Array, crs: str | None) -> Raster:
        """Put values where they belong."""
        return Raster(values, self.layout.transform, crs, self.named, self.unit)

    @property
    def named(self) -> str:
        """What values are, as files say it."""
        return self.quantity if self.minus is None else "difference"

    def less(self, places: Floats, heights: Floats) -> Floats:
        """Subtract the other surface from heights, if there is one."""
        if self.minus is None:
            return heights
        with np.errstate(over="ignore"):
            rises: Floats = heights - self.minus.sample(
                places, self.interpolation, threads=self.threads
            )
        if (farthest := np.fmax.reduce(np.abs(rises), axis=None)) > np.finfo(self.kind).max:
            raise InputError(f"a difference of {farthest} is beyond {self.kind.name}")
        return rises

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


def _checked_minus(
    surface: OverPlane, minus: Subtracted | None, quantity: RasterQuantity
) -> Subtracted | None:
    """Raise unless the heights of another surface can be subtracted."""
    if minus is None:
        return None
    if quantity != "height":
        raise InputError(f"of {quantity} nothing is subtracted: leave out {Option('minus')}")
    if not (hasattr(minus, "sample") and hasattr(minus, "frame")):
        reason = "triangulate it, open its tiles, or as_surface"
        raise refused("minus", minus, reason)
    check_planes(surface, minus)
    return minus


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
