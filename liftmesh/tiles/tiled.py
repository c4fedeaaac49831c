"""`Tiled` and `TiledSurface`: the results of `tile` and `tile_surface`, opened."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Integers, Progress, Rows
from liftmesh.base.display import Plotted
from liftmesh.base.options import Interpolation, as_folder
from liftmesh.errors import FormatError
from liftmesh.tiles import (
    surface_lines,
    surface_parts,
    surface_raster,
    tiled_data,
    verification,
)
from liftmesh.tiles.store import manifest_of
from liftmesh.tiles.tiled_data import TiledData, TiledSurfaceData

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.planar.certificate import Certificate
    from liftmesh.raster.raster import Raster
    from liftmesh.terrain.contours import Contours
    from liftmesh.terrain.filled import FilledContours
    from liftmesh.terrain.rasters import RasterOptions
    from liftmesh.terrain.report import Report
    from liftmesh.terrain.surface import Surface


class Tiled(TiledData, Plotted):
    """A triangulation in shards, as returned by `tile` and `open_tiled`.

    Triangles name rows of the whole source, counted through all of its files. Each is in one
    shard; all shards together hold what `delaunay` returns for all points.

    Attributes
    ----------
    folder : pathlib.Path
        The folder with the shards.
    manifest : dict
        What the folder holds: counts, the files of the source with their first rows, the shards
        with their SHA-256, and the SHA-256 of each chunk of the source.

    See Also
    --------
    tile : Makes such triangulations.
    open_tiled : Open a folder.
    TiledSurface : With heights and values.

    Examples
    --------
    >>> import tempfile
    >>> import liftmesh
    >>> import numpy as np
    >>> points = np.random.default_rng(0).random((1000, 2))
    >>> tiled = liftmesh.tile(points, tempfile.mkdtemp(), tile_rows=300)
    >>> len(tiled.shards) > 1, tiled.to_array().shape == liftmesh.delaunay(points).simplices.shape
    (True, True)
    """

    def __repr__(self) -> str:
        return (
            f"<Tiled: {self.nsimplex} triangles over {self.npoints} rows "
            f"in {len(self.shards)} shards>"
        )

    @property
    def report(self) -> Report:
        """What became of every row: a vertex, a duplicate, or skipped; with rows of 64 bits.

        It is as from `triangulate`, and holds 16 bytes for each row that is left out; `duplicates`
        and `skipped` map files.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> points = [[0, 0], [1, 0], [0, 1], [1, 0], [float("nan"), 2]]
        >>> report = liftmesh.tile(points, tempfile.mkdtemp(), nonfinite="skip").report
        >>> print(report)
        5 rows, 3 of them used in 1 triangle. Left out: 1 duplicate, 1 row skipped.
        >>> report.left_out.tolist(), report.representatives.tolist()
        ([3, 4], [1, -1])
        """
        return tiled_data.report_of(self)

    def iter_blocks(self) -> Iterator[Integers]:
        """Yield the triangles of one shard after the other.

        Yields
        ------
        (m, 3) ndarray of int64
            Counter-clockwise, from the lexicographically least corner; NPY is mapped, not read.

        Raises
        ------
        FormatError, OSError
            A file is damaged, or cannot be read.

        See Also
        --------
        to_array : All triangles at once.
        iter_neighbor_blocks : Their neighbours.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> [block.tolist() for block in tiled.iter_blocks()]
        [[[0, 1, 2]]]
        """
        return tiled_data.blocks_of(self)

    def to_array(self) -> Integers:
        """Read all triangles into memory: 24 bytes each.

        Returns
        -------
        (m, 3) ndarray of int64
            The shards in their order.

        Raises
        ------
        FormatError, OSError
            A file is damaged, or cannot be read.
        MemoryError
            There are too many.

        See Also
        --------
        iter_blocks : The same, shard by shard.
        to_delayed : As tasks of Dask.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> tiled.to_array()
        array([[0, 1, 2]])
        """
        return tiled_data.all_triangles(self)

    def iter_neighbor_blocks(self) -> Iterator[Integers]:
        """Yield which triangles are beyond the edges of one shard after the other.

        Yields
        ------
        (m, 3, 2) ndarray of int64
            The number of the shard, and the row in it, of the triangle across the edge opposite
            vertex k; both are -1 outside.

        Raises
        ------
        InputError
            The folder was made without neighbours.
        FormatError, OSError
            As for `iter_blocks`.

        See Also
        --------
        iter_blocks : The triangles.
        neighbors_to_array : All at once.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> square = [[0, 0], [1, 0], [0, 1], [1, 2]]
        >>> tiled = liftmesh.tile(square, tempfile.mkdtemp(), neighbors=True)
        >>> next(tiled.iter_neighbor_blocks())[0].tolist()
        [[-1, -1], [-1, -1], [0, 1]]
        """
        return (tiled_data.neighbor_pairs(self, k) for k in range(len(self.shards)))

    def neighbors_to_array(self) -> Integers:
        """Read all neighbours into memory, as rows of `to_array`: 24 bytes a triangle.

        Returns
        -------
        (m, 3) ndarray of int64
            The triangle across the edge opposite vertex k; -1 outside.

        Raises
        ------
        InputError, FormatError, OSError
            As for `iter_neighbor_blocks`.
        MemoryError
            There are too many.

        See Also
        --------
        iter_neighbor_blocks : The same, shard by shard.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> square = [[0, 0], [1, 0], [0, 1], [1, 2]]
        >>> liftmesh.tile(square, tempfile.mkdtemp(), neighbors=True).neighbors_to_array()
        array([[-1, -1,  1],
               [ 0, -1, -1]])
        """
        return tiled_data.all_neighbors(self)

    @property
    def simplices(self) -> Any:
        """The triangles as an array of Dask, (m, 3) int64, a chunk for each shard.

        Needs ``liftmesh[dask]``. The workers of a cluster must see the folder.
        """
        return tiled_data.dask_simplices(self)

    @property
    def neighbors(self) -> Any:
        """The neighbours as an array of Dask, (m, 3, 2) int64, as of `iter_neighbor_blocks`.

        Needs ``liftmesh[dask]``. The workers of a cluster must see the folder.
        """
        return tiled_data.dask_neighbors(self)

    def to_delayed(self) -> list[Any]:
        """Return the shards as delayed objects of Dask, which read them.

        Returns
        -------
        list of dask.delayed.Delayed
            Each computes an (m, 3) ndarray of int64.

        Raises
        ------
        MissingDependencyError
            Dask is not installed.

        See Also
        --------
        to_dask_dataframe : As columns.
        dask.delaunay : Make them on workers, too.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> tiled.to_delayed()[0].compute()
        array([[0, 1, 2]])
        """
        return tiled_data.delayed_shards(self)

    def to_dask_dataframe(self) -> Any:
        """Return the triangles as a DataFrame of Dask.

        Returns
        -------
        dask.dataframe.DataFrame
            The columns a, b and c are the corners; a partition for each shard.

        Raises
        ------
        MissingDependencyError
            Dask, or its DataFrame, is not installed.

        See Also
        --------
        to_delayed : A task for each shard.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> tiled.to_dask_dataframe().compute().to_numpy().tolist()
        [[0, 1, 2]]
        """
        return tiled_data.dask_dataframe(self)

    def is_sound(self) -> bool:
        """Whether every file still has the SHA-256 that the manifest states.

        Returns
        -------
        bool
            False if one was changed, truncated or removed.

        Raises
        ------
        OSError
            A file cannot be read.

        See Also
        --------
        verify : Prove the triangles against the points.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> _ = tiled.shards[0].write_bytes(b"")
        >>> tiled.is_sound()
        False
        """
        return tiled_data.is_intact(self)

    def verify(
        self,
        points: object = None,
        *,
        scratch: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Certificate:
        """Verify exactly, part by part, that the shards are the triangulation of all points.

        The checks are those of `liftmesh.verify`, and so is the certificate, but neither points nor
        triangles are held at once. Also checked are the hull, the duplicates, the skipped rows,
        the neighbours, if there are any, and the SHA-256 of every file; of a surface also which row
        stands for each position, by the policy, and every height and value of a vertex against the
        source.

        Parameters
        ----------
        points : path, list of paths, array_like, or iterator of arrays, optional
            The source, as for `tile`; by default the files that the manifest names.
        scratch : str or path, optional
            Where to make a folder for 24 bytes a row, which is removed; by default `folder`.
        threads, progress
            As for `tile`.

        Returns
        -------
        Certificate
            True if all is right. It is ``canonical`` where the triangles are those of liftmesh.

        Raises
        ------
        InputError
            The source is not known, or has changed since, or an option is invalid.
        FormatError, OSError
            A file is damaged, or cannot be read or written.

        Notes
        -----
        A tile takes as much memory as when it was triangulated. If nearly nothing is settled in
        the tiles, as for points on one circle, the last part holds all points, and takes as much
        memory as `liftmesh.verify`.

        See Also
        --------
        Triangulation.verify : The same for one call.
        is_sound : Only compare the files with the manifest.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> import numpy as np
        >>> points = np.random.default_rng(0).random((1000, 2))
        >>> tiled = liftmesh.tile(points, tempfile.mkdtemp(), tile_rows=300)
        >>> print(tiled.verify(points))
        valid: these 1,980 triangles are the canonical Delaunay triangulation of 1,000 rows
        """
        return verification.verify_tiled(self, points, scratch, threads, progress)


class TiledSurface(TiledSurfaceData, Tiled):
    """A surface in shards, as returned by `tile_surface` and `open_tiled`.

    Triangles, corners and values are those of `triangulate` for all rows. Triangles name the rows
    that the policy has chosen, as `Surface.faces` does, and `duplicates` the rows that it has not
    chosen, each with the one at its position that it has.

    Attributes
    ----------
    folder, manifest
        As of a `Tiled`; the entry "surface" says policy, coordinate system, values and box.

    See Also
    --------
    tile_surface : Makes such surfaces.
    Surface : A surface in memory.

    Examples
    --------
    >>> import tempfile
    >>> import liftmesh
    >>> import numpy as np
    >>> points = np.random.default_rng(0).random((1000, 3))
    >>> tiled = liftmesh.tile_surface(points, tempfile.mkdtemp(), tile_rows=300)
    >>> tiled
    <TiledSurface: 1976 triangles over 1000 rows in 7 shards>
    >>> np.array_equal(tiled.raster(0.1).values, liftmesh.triangulate(points).raster(0.1).values,
    ...                equal_nan=True)
    True
    """

    def __repr__(self) -> str:
        return super().__repr__().replace("<Tiled:", "<TiledSurface:")

    @property
    def report(self) -> Report:
        """What became of every row, as from `triangulate`, with rows of 64 bits.

        It holds 16 bytes for each row that is left out; `duplicates` and `skipped` map files.
        """
        return tiled_data.surface_report(self)

    def iter_vertices(self) -> Iterator[Array]:
        """Yield the vertices of one shard after the other.

        Yields
        ------
        (v,) structured ndarray
            The corners of its triangles by ascending row: the fields row, x, y and z, then colours,
            normals and named values, of their own types; mapped, not read.

        Raises
        ------
        FormatError, OSError
            As for `iter_blocks`.

        See Also
        --------
        iter_faces : The faces.
        iter_meshes : Both, part by part.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile_surface([[0, 0, 5], [1, 0, 6], [0, 1, 7]], tempfile.mkdtemp())
        >>> [each["z"].tolist() for each in tiled.iter_vertices()]
        [[5.0, 6.0, 7.0]]
        """
        return tiled_data.vertices_of(self)

    def iter_faces(self) -> Iterator[Rows]:
        """Yield the triangles of one shard after the other, as numbers of its vertices.

        Yields
        ------
        (m, 3) ndarray of int32
            The triangles that `iter_blocks` yields; mapped, not read.

        Raises
        ------
        FormatError, OSError
            As for `iter_blocks`.

        See Also
        --------
        iter_vertices : What they are indices of.
        iter_meshes : Both, part by part.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile_surface([[0, 0, 5], [1, 0, 6], [0, 1, 7]], tempfile.mkdtemp())
        >>> [each.tolist() for each in tiled.iter_faces()]
        [[[0, 1, 2]]]
        """
        return tiled_data.faces_of(self)

    def iter_meshes(self) -> Iterator[Cloud]:
        """Yield each shard as a mesh of its own.

        Yields
        ------
        Cloud
            The vertices of the shard with their values, the numbers of their rows among them as
            ``row``, and faces between them.

        Raises
        ------
        FormatError, OSError
            As for `iter_blocks`.

        See Also
        --------
        iter_vertices : Vertices alone.
        iter_faces : Faces alone.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile_surface([[0, 0, 5], [1, 0, 6], [0, 1, 7]], tempfile.mkdtemp())
        >>> [(len(mesh), mesh.faces.tolist()) for mesh in tiled.iter_meshes()]
        [(3, [[0, 1, 2]])]
        """
        return tiled_data.meshes_of(self)

    def sample(
        self,
        points: ArrayLike,
        interpolation: Interpolation = "linear",
        *,
        threads: int | None = None,
    ) -> Floats:
        """Interpolate heights at points, reading the faces around them.

        Returns (...) float64: those of `Surface.sample`, bit for bit; errors also of `iter_blocks`.
        In full: `liftmesh.terrain.sampling.heights_at`.

        Parameters
        ----------
        points, interpolation, threads : as for `Surface.sample`; "c1" needs a surface in memory
        """
        return surface_parts.heights_at(self, points, interpolation, threads)

    def height_above(
        self,
        cloud: object,
        *,
        interpolation: Interpolation = "linear",
        threads: int | None = None,
    ) -> Floats:
        """Compute how high the points of a cloud are above the faces.

        Returns (n,) float64: those of `Surface.height_above`, bit for bit; errors also of `sample`.
        In full: `liftmesh.terrain.sampling.heights_above`.

        Parameters
        ----------
        cloud, interpolation, threads : as for `Surface.height_above`, and for `sample`
        """
        return surface_parts.heights_above(self, cloud, interpolation, threads)

    def raster(
        self,
        resolution: float | Sequence[float] | None = None,
        *,
        progress: Progress | None = None,
        **options: Unpack[RasterOptions],
    ) -> Raster:
        """Compute a raster in memory, reading the faces window by window.

        Returns the Raster of `Surface.raster`, bit for bit; errors also of `iter_blocks`.
        In full: `liftmesh.terrain.rasters.rasterize`.

        Parameters
        ----------
        resolution, progress, **options : as for `Surface.raster`
        """
        return surface_raster.rasterize(self, resolution, progress, options)

    def save_raster(
        self,
        path: str | os.PathLike[str],
        resolution: float | Sequence[float] | None = None,
        *,
        cog: bool = False,
        compress: str | None = "deflate",
        progress: Progress | None = None,
        **options: Unpack[RasterOptions],
    ) -> WriteResult:
        """Write a raster as GeoTIFF, window by window: no more than a window is in memory.

        Parameters
        ----------
        path : path
            Where to write; written whole or not at all.
        resolution : float or pair of float, optional
            As for `Surface.raster`.
        cog, compress
            As for `Raster.save`; a cloud optimised one is written by way of a plain one beside it.
        progress, **options
            As for `raster`; `dtype` is float32 by default.

        Returns
        -------
        WriteResult
            Of the file; its values are those of `Surface.raster`, bit for bit.

        Raises
        ------
        InputError, FormatError, MissingDependencyError, OSError
            As for `raster` and `Raster.save`.

        See Also
        --------
        raster : As an array.
        Raster.save : Write a raster in memory.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> points = [[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]]
        >>> tiled = liftmesh.tile_surface(points, tempfile.mkdtemp())
        >>> tiled.save_raster(Path(tempfile.mkdtemp()) / "dtm.tif", 2).format
        'geotiff'
        """
        return surface_raster.save_raster(
            self, path, resolution, progress, options, cog=cog, compress=compress
        )

    def contours(
        self,
        levels: ArrayLike | None = None,
        *,
        interval: float | None = None,
        contour_base: float = 0.0,
        index_every: int = 5,
        smooth: float | None = None,
    ) -> Contours:
        """Compute lines of equal height, reading one shard after the other.

        Returns Contours, held in memory: those of `Surface.contours`, point for point and in the
        same order; errors also of `iter_blocks`.
        In full: `liftmesh.terrain.contours.contour_lines`.

        Parameters
        ----------
        levels, interval, contour_base, index_every, smooth : as for `Surface.contours`
        """
        return surface_lines.contour_lines(
            self, levels, interval, contour_base, index_every, smooth
        )

    def filled_contours(
        self,
        levels: ArrayLike | None = None,
        *,
        interval: float | None = None,
        contour_base: float = 0.0,
        progress: Progress | None = None,
    ) -> FilledContours:
        """Compute the parts of the plane between levels, with the bits of one surface.

        Returns FilledContours, which are held in memory; an error where contours cross by rounding.
        In full: `liftmesh.terrain.filled.filled_contours`.

        Parameters
        ----------
        levels, interval, contour_base, progress : as for `Surface.contours`, and `raster`
        """
        return surface_lines.filled_contours(self, levels, interval, contour_base, progress)

    def clip(
        self, polygon: object, *, threads: int | None = None, progress: Progress | None = None
    ) -> Surface:
        """Cut the faces along a polygon, and make a surface in memory of what is inside.

        Returns the Surface of `Surface.clip`, bit for bit; errors also of `iter_blocks`.
        In full: `liftmesh.terrain.clipping.clip`.

        Parameters
        ----------
        polygon, threads, progress : as for `Surface.clip`; the shards that touch its box are read
        """
        return surface_parts.clipped(self, polygon, threads, progress)


def open_tiled(folder: str | os.PathLike[str]) -> Tiled:
    """Open what `tile` or `tile_surface` has written.

    Parameters
    ----------
    folder : str or path
        The folder.

    Returns
    -------
    Tiled
        The triangulation; its files are read when they are asked for. A `TiledSurface` if there
        are heights.

    Raises
    ------
    InputError
        `folder` is no path.
    FormatError
        The folder holds no finished triangulation, or files of it are missing or truncated.
    OSError
        It cannot be read.

    See Also
    --------
    tile : Makes such folders.
    tile_surface : With heights and values.

    Examples
    --------
    >>> import tempfile
    >>> import liftmesh
    >>> folder = tempfile.mkdtemp()
    >>> liftmesh.tile([[0, 0], [1, 0], [0, 1]], folder)
    <Tiled: 1 triangles over 3 rows in 1 shards>
    >>> open_tiled(folder).convex_hull.tolist()
    [0, 1, 2]
    """
    folder = Path(as_folder("folder", folder))
    manifest = manifest_of(folder)
    kind = TiledSurface if "surface" in manifest else Tiled
    tiled = kind(folder, manifest)
    for file, each in tiled_data.stated_files(tiled).items():
        path = folder / file
        size = path.stat().st_size if path.is_file() else 0
        if size != each["bytes"]:
            raise FormatError(
                f"{path}: {size:,} bytes of {each['bytes']:,}: the file is damaged: tile the "
                "source again, into the same folder"
            )
    return tiled
