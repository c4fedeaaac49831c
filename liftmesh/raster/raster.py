"""`Raster`: values at the centres of pixels, and its file; grids of heights in memory as clouds.

Grids are a `Raster`, DataArrays of xarray, and arrays with a transform. Each value that is a number
becomes a row at the centre of its pixel, as of a GeoTIFF. xarray is not imported: its grids are
known by the name of their class.
"""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_floats, unmasked, widened
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import Voids, as_switch, counted, refused
from liftmesh.crs.comparison import plane_of
from liftmesh.crs.description import as_wkt
from liftmesh.errors import InputError, Option
from liftmesh.io.atomic import replacing
from liftmesh.io.metadata import Unread, noted
from liftmesh.io.objects.plain import is_array, qualified_name
from liftmesh.io.options import as_missing
from liftmesh.io.streams import at_home, check_suffix
from liftmesh.io.write import WriteResult, written_file
from liftmesh.optional import load
from liftmesh.raster import fill, heightmap, writer
from liftmesh.raster.pixels import Transform, centres_of, layout_of

if TYPE_CHECKING:
    import os

    import xarray


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Raster(FrozenResult, Plotted):
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
        What the values are: a quantity of `Surface.raster`, or the name of other values.
    unit : str, optional
        Of the values: that of heights, if the surface says it; degrees; none of shades.

    See Also
    --------
    Surface.raster : Makes rasters.
    TiledSurface.raster : Of surfaces in tiles.

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

    def __repr__(self) -> str:
        rows, columns = self.values.shape
        unit = f" in {self.unit}" if self.unit else ""
        name = self.quantity if self.quantity.isidentifier() else reprlib.repr(self.quantity)
        return f"<Raster of {columns:,} x {rows:,} pixels: {name}{unit}>"

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest rectangle around all pixels: xmin, ymin, xmax, ymax."""
        a, b, c, d, e, f = self.transform
        rows, columns = self.values.shape
        corners = [(u, v) for u in (0, columns) for v in (0, rows)]
        x, y = ([p * u + q * v + r for u, v in corners] for p, q, r in ((a, b, c), (d, e, f)))
        return min(x), min(y), max(x), max(y)

    def centers(self) -> Floats:
        """Compute the centres of the pixels.

        Returns
        -------
        (rows, columns, 2) ndarray of float64
            x and y, rounded as the values assume it.

        See Also
        --------
        Surface.raster : Heights at these places.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
        >>> surface.raster(1).centers()[0].tolist()
        [[0.5, 1.5], [1.5, 1.5]]
        """
        rows, columns = self.values.shape
        return centres_of(self.transform, range(rows), columns)

    def filled(self, distance: float) -> Raster:
        """Fill voids from the nearest pixels.

        Parameters
        ----------
        distance : float
            How far a pixel with a value may be, from centre to centre, in the units of x and y.

        Returns
        -------
        Raster
            A copy, in which a pixel without a value has that of the nearest pixel with one, of
            several the least, within the distance; NaN where there is none.

        Raises
        ------
        InputError
            The distance is not positive, or the pixels are no rectangles.

        See Also
        --------
        Surface.raster : ``fill=`` does the same at once.

        Notes
        -----
        Distances are those of decimals: three pixels of 0.1 are 0.3. Pixels beyond the border of
        the surface are filled like those of gaps. Time grows with the distance.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
        >>> wide = surface.raster(1, bounds=(0, 0, 5, 1))
        >>> wide.values, wide.filled(2).values
        (array([[0.5, 1.5, nan, nan, nan]]), array([[0.5, 1.5, 1.5, 1.5, nan]]))
        """
        reach = fill.Reach.of(distance, self.transform, "distance")
        return replace(self, values=fill.filled(self.values, reach))

    def to_xarray(self) -> xarray.DataArray:
        """Convert to a grid of xarray, with the coordinates of its pixels.

        Returns
        -------
        xarray.DataArray
            A copy of the values, with the dimensions y and x, ``name`` the quantity, ``units`` the
            unit; the coordinate system is stated as rioxarray and GDAL read it.

        Raises
        ------
        InputError
            The pixels are turned: x depends on the row, or y on the column.
        MissingDependencyError
            xarray is not installed.

        See Also
        --------
        liftmesh.triangulate : Takes grids of xarray.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
        >>> surface.raster(1).to_xarray().sel(x=1.5, y=0.5).item()
        1.5
        """
        _, b, _, d, *_ = self.transform
        if b or d:
            raise InputError(
                f"pixels of the transform {self.transform} are turned: xarray has none"
            )
        library = load("xarray", extra="xarray")
        a, b, c, d, e, f = self.transform
        place = {"GeoTransform": " ".join(map(repr, (c, a, b, f, d, e)))}
        if (text := written_system(self.crs, self.quantity)) is not None:
            place["crs_wkt"] = place["spatial_ref"] = as_wkt(text) or text
        centers = self.centers()
        grid: xarray.DataArray = library.DataArray(
            np.array(self.values),
            coords={"y": centers[:, 0, 1], "x": centers[0, :, 0], "spatial_ref": ((), 0, place)},
            dims=("y", "x"),
            name=self.quantity,
            attrs={} if self.unit is None else {"units": self.unit},
        )
        grid.encoding["grid_mapping"] = "spatial_ref"
        return grid

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        cog: bool = False,
        compress: str | None = "deflate",
        voids: Voids = "error",
    ) -> WriteResult:
        """Write a GeoTIFF with transform, coordinate system, unit and NaN as nodata.

        Of heights alone the system says what heights are: of others it is that of the plane. A name
        in .png or .r16 makes a heightmap of engines: values of 16 bits, from the lowest to the
        highest, in rows from the north; .r16 holds them alone, little-endian, and a file
        beside it, .r16.json, says rows, columns, scale, offset and where the pixels are.

        Parameters
        ----------
        path : path
            Where to write; written whole or not at all.
        cog : bool, default False
            Write a cloud optimised GeoTIFF, which has overviews.
        compress : str, optional
            "deflate", "lzw" or "zstd", in tiles; None for none.
        voids : {"error", "lowest"}, default "error"
            Of a heightmap: pixels without a value are refused, or get the lowest one.

        Returns
        -------
        WriteResult
            The file, its format and its size; of a heightmap with scale and offset.

        Raises
        ------
        FormatError
            The name does not end in .tif, .tiff, .png or .r16.
        InputError
            The compression or the coordinate system is unknown, `cog` is neither True nor False, or
            pixels of a heightmap have no value.
        MissingDependencyError
            rasterio is not installed.
        OSError
            The file cannot be written.

        Notes
        -----
        The file is made in memory, beside the values, and written at once. Of engines, Unreal takes
        a scale of 100 * 65535 * scale / 512 in z, where heights are metres, and Unity the height of
        a terrain, 65535 * scale.

        See Also
        --------
        TiledSurface.save_raster : Write rasters that memory does not hold.
        read : Read a GeoTIFF as a cloud.

        Examples
        --------
        >>> import liftmesh, tempfile
        >>> surface = liftmesh.triangulate([[0, 0, 0], [2, 0, 2], [0, 2, 0], [2, 2, 2]])
        >>> surface.raster(1).save(Path(tempfile.mkdtemp()) / "dtm.tif").format
        'geotiff'
        """
        target = Path(at_home(path))
        check_name(target, may_be_heightmap=True)
        if heightmap.is_heightmap(target):
            about = {"unit": self.unit, "crs": self.crs}
            scaling = heightmap.save(self.values, self.transform, target, voids, about)
            return written_file(target, "heightmap", scaling=scaling)
        is_cog = as_switch("cog", cog)
        crs = written_system(self.crs, self.quantity)
        packed: Any = {"unit": self.unit, "cog": is_cog, "compress": compress}
        with replacing(target) as stream:
            writer.write(stream, self.values, self.transform, crs, **packed)
        return written_file(target, "geotiff")


def written_system(crs: str | None, quantity: str) -> str | None:
    """Return the coordinate system of a file: GDAL takes a unit of heights for that of values."""
    return crs if quantity == "height" else plane_of(crs)


def check_name(path: Path, *, may_be_heightmap: bool = False) -> None:
    """Raise if a raster cannot be written to a file of this name."""
    others = heightmap.SUFFIXES if may_be_heightmap else ()
    check_suffix(path, (".tif", ".tiff", *others), "rasters are written as GeoTIFF")


_SYSTEMS = ("crs_wkt", "spatial_ref")  # attributes of a variable that says where a grid is


def to_cloud(source: Any) -> Cloud:
    """Convert a grid to rows."""
    return _of_raster(source) if isinstance(source, Raster) else _of_xarray(source)


def with_options(source: Any, given: Mapping[str, Any]) -> Cloud:
    """Convert an array of heights, whose places a transform says."""
    others = [name for name in given if name not in ("transform", "nodata")]
    if others:
        raise InputError(
            f"{Option('transform', ...)} is for a grid, and {Option(others[0], ...)} for a table"
        )
    if not is_array(source):
        raise InputError(
            f"{Option('transform', ...)} goes with an array, not with a {qualified_name(source)}"
        )
    heights = _heights(source)
    for missing in as_missing(given.get("nodata")) or ():
        heights = np.where(heights == missing, np.nan, heights)
    layout = layout_of(None, None, given["transform"], heights.shape, lambda: ())
    places = centres_of(layout.transform, range(layout.rows), layout.columns)
    return _cloud(places[..., 0], places[..., 1], heights, None, {})


def _of_raster(raster: Raster) -> Cloud:
    if raster.quantity != "height":
        raise InputError(f"a Raster of {raster.quantity} is no grid of heights: give one of these")
    unit = {} if raster.unit is None else {"unit": raster.unit}
    rows, columns = raster.values.shape
    places = centres_of(raster.transform, range(rows), columns)
    return _cloud(places[..., 0], places[..., 1], raster.values, raster.crs, unit)


def _of_xarray(grid: Any) -> Cloud:
    """Take x from the coordinates of the last dimension, and y from those of the one before."""
    squeezed = grid.squeeze(drop=False)  # a band
    heights = heights_of(squeezed)
    across, along = (_positions(squeezed, name) for name in reversed(squeezed.dims))
    x, y = np.meshgrid(across, along)
    unit = grid.attrs.get("units")
    return _cloud(x, y, heights, _system_of(grid), {"unit": unit} if isinstance(unit, str) else {})


def heights_of(grid: Any) -> Floats:
    """Return the heights of a grid of xarray, with NaN where there is none."""
    if grid.ndim != 2:
        raise InputError(
            f"a DataArray of the dimensions {', '.join(map(str, grid.dims))} is no grid of "
            "heights: choose one, as grid.isel(band=0)"
        )
    heights = _heights(grid.values)
    fill = grid.attrs.get("_FillValue")
    if isinstance(fill, int | float | np.number):
        heights = np.where(heights == fill, np.nan, heights)
    return heights


def _positions(grid: Any, name: Any) -> Floats:
    if name not in grid.coords:
        raise InputError(f"the dimension {name!r} of a DataArray has no coordinates: assign them")
    values = np.asarray(grid.coords[name].values)
    if values.dtype.kind not in "iuf":
        raise InputError(f"the coordinates of the dimension {name!r} are no numbers")
    return values.astype(np.float64)


def _system_of(grid: Any) -> str | None:
    """Return the system that a variable of the conventions of CF states, as rioxarray writes it."""
    variable = grid.coords.get(grid.encoding.get("grid_mapping", "spatial_ref"))
    stated: Mapping[str, Any] = {} if variable is None else variable.attrs
    texts = (stated.get(each) for each in _SYSTEMS)
    return next((each for each in texts if isinstance(each, str) and is_crs(each)), None)


def _heights(values: Any) -> Floats:
    array: Array = np.asanyarray(values)
    if array.ndim != 2 or array.dtype.kind not in "iufb":
        raise refused("transform", array.shape, "goes with an array (rows, columns) of heights")
    return widened(as_floats(unmasked(array)))


def _cloud(x: Floats, y: Floats, heights: Array, crs: str | None, entries: dict[str, Any]) -> Cloud:
    """Make rows of the heights that are numbers, row by row."""
    is_known = ~np.isnan(heights)
    missing = heights.size - int(is_known.sum())
    unread = (f"{counted(missing, 'sample')} without a value",) if missing else ()
    return Cloud(
        np.stack([x[is_known], y[is_known], heights[is_known]], axis=1),
        metadata=noted({"raster": entries} if entries else {}, not_read=Unread(unread)),
        crs=crs,
    )
