"""`Raster`: values at the centres of pixels, and its file."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftmesh._typing import Array, Floats
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import Voids, as_switch
from liftmesh.crs.comparison import plane_of
from liftmesh.io.atomic import replacing
from liftmesh.io.streams import at_home, check_suffix
from liftmesh.io.write import WriteResult, written_file
from liftmesh.raster import fill, heightmap, writer
from liftmesh.raster.pixels import Transform, centres_of

if TYPE_CHECKING:
    import os


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Raster(FrozenResult):
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
        return f"<Raster of {columns:,} x {rows:,} pixels: {self.quantity}>"

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
