"""From a surface to a raster: heights, slopes, aspects or shades at the centres of pixels.

The centre of a pixel is the point that the transform gives for it, in doubles (`pixels.py`), and
its value is that of the surface there: the kernel scans the faces, row by row, and gives every
centre to one of them (`_core/surface/scan.hpp`). So the heights are bit for bit those of
`Surface.sample`.

What the pixels of a raster hold: heights, or what follows from the gradients of faces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike

from liftmesh._typing import Array, Floats
from liftmesh.base.frozen import constructed_from, freeze
from liftmesh.base.options import RasterQuantity, SampleMethod, as_switch, check_option, shown
from liftmesh.base.threads import as_threads
from liftmesh.crs.comparison import plane_of
from liftmesh.errors import InputError
from liftmesh.io.atomic import replacing
from liftmesh.io.streams import check_suffix
from liftmesh.raster import writer
from liftmesh.raster.pixels import Layout, Transform, centres_of, layout_of
from liftmesh.terrain.sampling import aspect_of, relief_of, slope_of
from liftmesh.terrain.units import names_of, rise_of

if TYPE_CHECKING:
    import os

    from liftmesh.terrain.surface import Surface


_UNITS = {"slope": "degree", "aspect": "degree"}
_TOGETHER = 1 << 22  # pixels whose gradients are held at a time


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Raster:
    """Values of a surface at the centres of pixels, as `Surface.raster` returns them; read-only.

    Parameters
    ----------
    values : (rows, columns) ndarray of float64 or float32
        NaN where the surface has no face.
    transform : tuple of float
        a, b, c, d, e and f: the centre of column i and row j has x = a (i + 1/2) + b (j + 1/2) + c
        and y = d (i + 1/2) + e (j + 1/2) + f, computed in doubles from left to right. Row 0 is the
        northern one, unless e is positive.
    crs : str, optional
        The coordinate reference system.
    quantity : str
        What the values are: "height", "slope", "aspect" or "hillshade".
    unit : str, optional
        Of the values: that of heights, if the surface says it; degrees; none of shades.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
    >>> surface.raster(1)
    <Raster of 2 x 2 pixels: height>
    """

    values: Array
    transform: Transform
    crs: str | None = None
    quantity: str = "height"
    unit: str | None = None

    def __post_init__(self) -> None:
        freeze(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        return f"<Raster of {columns:,} x {rows:,} pixels: {self.quantity}>"

    def centres(self) -> Floats:
        """Compute the centres of the pixels.

        Returns
        -------
        (rows, columns, 2) ndarray of float64
            x and y, rounded as the values assume it.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
        >>> surface.raster(1).centres()[0].tolist()
        [[0.5, 1.5], [1.5, 1.5]]
        """
        rows, columns = self.values.shape
        return centres_of(self.transform, range(rows), columns)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        cog: bool = False,
        compress: str | None = "deflate",
    ) -> Path:
        """Write a GeoTIFF with transform, coordinate system, unit and NaN as nodata.

        Of heights alone the system says what heights are: of others it is that of the plane.

        Parameters
        ----------
        path : path
            Where to write; written whole or not at all.
        cog : bool, default False
            Write a cloud optimised GeoTIFF, which has overviews.
        compress : str, optional
            "deflate", "lzw" or "zstd", in tiles; None for none.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        FormatError
            The name does not end in .tif or .tiff.
        InputError
            The compression or the coordinate system is unknown, or `cog` is neither True nor False.
        MissingDependencyError
            rasterio is not installed.
        OSError
            The file cannot be written.

        Notes
        -----
        The file is made in memory, beside the values, and written at once.

        Examples
        --------
        >>> import liftmesh, tempfile
        >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
        >>> surface.raster(1).save(Path(tempfile.mkdtemp()) / "dtm.tif").name
        'dtm.tif'
        """
        found = Path(path)
        check_name(found)
        is_cog = as_switch("cog", cog)
        crs = written_system(self.crs, self.quantity)
        packed: Any = {"unit": self.unit, "cog": is_cog, "compress": compress}
        with replacing(found) as stream:
            writer.write(stream, self.values, self.transform, crs, **packed)
        return found


def _extent(surface: Surface) -> list[float]:
    """Return xmin, ymin, xmax and ymax of the faces."""
    solved = surface.triangulation
    corners = solved.points[solved.convex_hull if surface.mask is None else surface.faces]
    return [*corners.min(axis=(0, 1)).tolist(), *corners.max(axis=(0, 1)).tolist()]


def written_system(crs: str | None, quantity: str) -> str | None:
    """Return the coordinate system of a file: GDAL takes a unit of heights for that of values."""
    return crs if quantity == "height" else plane_of(crs)


def unit_of(surface: Surface, quantity: str) -> str | None:
    """Return the unit of what a raster holds; None if it is not known, or there is none."""
    return names_of(surface)[1] if quantity == "height" else _UNITS.get(quantity)


def check_name(path: Path) -> None:
    """Raise if a raster cannot be written to a file of this name."""
    check_suffix(path, (".tif", ".tiff"), "rasters are written as GeoTIFF")


def rasterized(
    surface: Surface,
    layout: Layout,
    quantity: RasterQuantity = "height",
    *,
    method: SampleMethod = "linear",
    dtype: DTypeLike = np.float64,
    light: tuple[float, float] = (315.0, 45.0),
    z_factor: float | None = None,
    threads: int | None = None,
) -> Raster:
    """Compute the values of a surface at pixels."""
    wanted = Wanted.checked(surface, quantity, method, dtype, light, z_factor)
    scan = _Scan(surface, layout, as_threads(threads, layout.rows * layout.columns))
    values = np.empty((layout.rows, layout.columns), wanted.kind)
    if quantity == "height":
        _check_range(surface, wanted)
        if method == "linear":
            scan.fill(values[:, :, None])
        else:
            _fill_by(method, surface, layout, values, threads)
    else:
        for block, gradients in scan.gradients(values):
            block[...] = wanted.of_gradients(gradients)
    wanted.finish(values)
    crs = surface.crs if surface.frame.name == "xy" else None
    return Raster(values, layout.transform, crs, quantity, unit_of(surface, quantity))


def _check_range(surface: Surface, wanted: Wanted) -> None:
    """Raise if a height of a face is beyond the type; others than those of faces may be."""
    heights = surface.frame.heights(surface.vertices)
    if not np.fmax.reduce(np.abs(heights)) <= np.finfo(wanted.kind).max:
        wanted.check_range(heights[surface.faces])


def _fill_by(
    method: SampleMethod, surface: Any, layout: Layout, values: Array, threads: int | None
) -> None:
    """Sample the centres, some rows at a time."""
    count = max(_TOGETHER // layout.columns, 1)
    for first in range(0, layout.rows, count):
        block = values[first : first + count]
        rows = range(first, first + len(block))
        centres = centres_of(layout.transform, rows, layout.columns)
        block[...] = surface.sample(centres, method, threads=threads)


def owners(surface: Surface, layout: Layout, *, threads: int | None = None) -> Array:
    """Find the face that each pixel of a raster belongs to."""
    found = np.empty((layout.rows, layout.columns), np.int32)
    _Scan(surface, layout, as_threads(threads, found.size)).fill(found[:, :, None])
    return found


class _Scan:
    """The kernel's scan of a surface, whole or some rows at a time."""

    def __init__(self, surface: Surface, layout: Layout, threads: tuple[int, bool]) -> None:
        self._relief = relief_of(surface)
        self._locator = surface.triangulation._locator  # noqa: SLF001 - as in `Surface.sample`
        self._layout = layout
        self._threads = threads

    def fill(self, pixels: Array, first_row: int = 0) -> None:
        transform = self._layout.transform
        self._relief.scan(self._locator, transform, first_row, pixels, *self._threads)

    def gradients(self, values: Array) -> Iterator[tuple[Array, Floats]]:
        """Yield blocks of rows, and the gradients at their pixels."""
        count = max(_TOGETHER // self._layout.columns, 1)
        for first in range(0, self._layout.rows, count):
            block = values[first : first + count]
            gradients = np.empty((*block.shape, 2))
            self.fill(gradients, first)
            yield block, gradients


class Rasterizing:
    """The method of a `Surface` that makes rasters."""

    __slots__ = ()

    def raster(  # noqa: PLR0913 - options are keywords
        self: Any,
        resolution: float | Sequence[float] | None = None,
        *,
        bounds: Sequence[float] | None = None,
        transform: Sequence[float] | None = None,
        shape: Sequence[int] | None = None,
        quantity: RasterQuantity = "height",
        method: SampleMethod = "linear",
        light: tuple[float, float] = (315.0, 45.0),
        z_factor: float | None = None,
        dtype: DTypeLike = np.float64,
        threads: int | None = None,
    ) -> Raster:
        """Compute heights, or what follows from them, at the centres of pixels.

        Parameters
        ----------
        resolution : float or pair of float, optional
            Width and height of a pixel. The edges of pixels are multiples of it, so that rasters of
            neighbouring surfaces fit together; row 0 is the one with the largest y.
        bounds : sequence of float, optional
            xmin, ymin, xmax and ymax to cover; by default those of the faces.
        transform : sequence of float, optional
            a, b, c, d, e and f of a `Raster`, in place of the resolution: any affine transform, as
            that of another raster.
        shape : pair of int, optional
            Rows and columns, with a transform.
        quantity : {"height", "slope", "aspect", "hillshade"}
            Heights above the plane; or what the face that owns the centre has: degrees as of
            `Surface.slope` and `Surface.aspect`, or brightness from 0 to 255.
        method : {"linear", "nearest", "laplace", "sibson"}, default "linear"
            How heights are interpolated, as for `Surface.sample`.
        light : pair of float, default (315, 45)
            Azimuth of the light, in degrees clockwise from the direction of y, and altitude above
            the plane, for "hillshade".
        z_factor : float, optional
            As for `Surface.slope`; other than 1, it exaggerates shades.
        dtype : {"float64", "float32"}
            Type of the values; heights are rounded once.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        Raster
            The values; NaN where no face contains the centre of a pixel.

        Raises
        ------
        InputError
            An option is unknown, or what is given does not determine a raster.

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
        layout = layout_of(resolution, bounds, transform, shape, lambda: _extent(self))
        return rasterized(
            self,
            layout,
            quantity,
            method=method,
            dtype=dtype,
            light=light,
            z_factor=z_factor,
            threads=threads,
        )


_TYPES = (np.dtype(np.float64), np.dtype(np.float32))
_STEEP, _SCALE = 2.0**500, 2.0**-600


def shade_of(gradients: Floats, light: Floats) -> Floats:
    """Compute how bright faces are under a distant light."""
    steep = np.abs(gradients).max(axis=-1, initial=0) > _STEEP
    scale = np.where(steep, _SCALE, 1.0)  # of the normal, so that its square is a double
    x, y = gradients[..., 0] * scale, gradients[..., 1] * scale
    facing = light[2] * scale - light[0] * x - light[1] * y
    shades: Floats = 255 * np.maximum(facing, 0) / np.sqrt(scale * scale + x * x + y * y)
    return shades


_OF_GRADIENTS: dict[str, Callable[[Floats, Floats], Floats]] = {
    "slope": lambda gradients, _: slope_of(gradients),
    "aspect": lambda gradients, _: aspect_of(gradients),
    "hillshade": shade_of,
}


def check_method(quantity: RasterQuantity, method: SampleMethod) -> None:
    """Raise unless a quantity has a method of interpolation."""
    if quantity != "height" and method != "linear":
        raise InputError(f"{quantity} is that of faces: leave out method={method!r}")


@dataclass(frozen=True)
class Wanted:
    """Which values a raster is asked to hold, checked."""

    quantity: str
    kind: np.dtype[Any]
    light: Floats
    rise: tuple[float, float]

    @classmethod
    def checked(
        cls,
        surface: Any,
        quantity: RasterQuantity,
        method: SampleMethod,
        dtype: DTypeLike,
        light: tuple[float, float],
        z_factor: float | None,
    ) -> Wanted:
        """Check the options."""
        check_option("quantity", quantity, RasterQuantity)
        check_option("method", method, SampleMethod)
        check_method(quantity, method)
        return cls(quantity, _checked_type(dtype), _light_of(light), rise_of(surface, z_factor))

    def check_range(self, heights: Floats) -> None:
        """Raise if a height is finite, but beyond the type."""
        farthest = float(heights.ravel()[np.argmax(np.abs(heights))])
        with np.errstate(over="ignore"):
            is_beyond = math.isfinite(farthest) and np.isinf(self.kind.type(farthest))
        if is_beyond:
            raise InputError(
                f"the height {farthest} is beyond {self.kind.name}: give dtype='float64'"
            )

    def of_gradients(self, gradients: Floats) -> Floats:
        """Compute slopes, aspects or shades."""
        return _OF_GRADIENTS[self.quantity](gradients * self.rise, self.light)

    def finish(self, values: Array) -> None:
        """Change in place what is another value once it is rounded to the type."""
        if self.quantity == "aspect":
            values[values == 360] = 0  # which is north, too


def _light_of(light: tuple[float, float]) -> Floats:
    """Convert azimuth and altitude to the direction towards the light."""
    try:
        azimuth, altitude = (math.radians(float(each)) for each in light)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"light is {shown(light)}: give azimuth and altitude, in degrees"
        ) from error
    if not (math.isfinite(azimuth) and 0 <= altitude <= math.pi / 2):
        raise InputError(f"light is {shown(light)}: give an altitude from 0 to 90 degrees")
    level = math.cos(altitude)
    return np.array([math.sin(azimuth) * level, math.cos(azimuth) * level, math.sin(altitude)])


def _checked_type(dtype: DTypeLike) -> np.dtype[Any]:
    try:
        kind = np.dtype(dtype)
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError):
        kind = np.dtype(np.void)
    if kind not in _TYPES:
        raise InputError(f"dtype is {shown(dtype)}: give 'float64' or 'float32'")
    return kind
