"""Rasters of tiled surfaces, window by window: bit for bit those of `Surface.raster`.

The raster is cut into windows; for each, the faces that touch the centres of its pixels are read
(`windows.py`), or with natural neighbours those whose circles do (`circles.py`). A window with too
many faces is cut again, so memory is bounded: by the faces of two large shards, and by the pixels
of a window where these go to a file.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike

from liftmesh._typing import Array, Floats, Progress
from liftmesh.base.options import RasterQuantity, SampleMethod, as_switch, check_progress
from liftmesh.raster import writer
from liftmesh.raster.pixels import Layout, centres_of, layout_of
from liftmesh.raster.raster import Raster, check_name, written_system
from liftmesh.terrain.raster import Wanted, unit_of
from liftmesh.tiles.circles import Circles
from liftmesh.tiles.windows import part_of, touching

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled_surface import TiledSurface

_SIDE = 1024  # pixels of a window, a multiple of the blocks of a file
_FACES = 1 << 16  # which a window may have at least
_FEWEST = 256  # pixels of a window, if circles count: many may have one pixel inside

Window = tuple[range, range]


class _Windows:
    """Computes the values of a raster, some pixels at a time."""

    def __init__(
        self,
        tiled: TiledSurface,
        layout: Layout,
        wanted: Wanted,
        method: SampleMethod,
        threads: int | None,
    ) -> None:
        self._tiled = tiled
        self._layout = layout
        self._wanted = wanted
        self._method: SampleMethod = method
        self._threads = threads
        is_linear = method == "linear"
        self._near = partial(touching, tiled) if is_linear else Circles(tiled).near
        self._fewest = 1 if is_linear else _FEWEST
        largest = max(shard["triangles"] for shard in tiled.manifest["shards"])
        self._most = max(_FACES, 2 * largest)

    def values(self, progress: Progress | None) -> Iterator[tuple[Window, Array]]:
        """Yield windows, block of rows by block of rows, and their values."""
        rows, columns = self._layout.rows, self._layout.columns
        done = 0
        for top in range(0, rows, _SIDE):
            for left in range(0, columns, _SIDE):
                down = range(top, min(top + _SIDE, rows))
                across = range(left, min(left + _SIDE, columns))
                yield (down, across), self._of(down, across)
                done += len(down) * len(across)
                if progress is not None:
                    progress(done / (rows * columns))

    def _of(self, down: range, across: range) -> Array:
        centres = centres_of(self._layout.transform, down, across)
        low, high = centres.min(axis=(0, 1)).tolist(), centres.max(axis=(0, 1)).tolist()
        most = self._most if centres.size > 2 * self._fewest else 1 << 31
        surface = part_of(self._tiled, self._near((*low, *high)), most, self._threads)
        if not isinstance(surface, int):
            return self._at(centres, surface)
        if surface == 0:
            return self._at(centres, None)
        axis = int(len(across) > len(down))
        halves = [self._of(*each) for each in _halves(down, across, axis)]
        return np.concatenate(halves, axis=axis)

    def _at(self, centres: Floats, surface: Surface | None) -> Array:
        """Compute the values at centres; without a face, these are NaN."""
        found = np.empty(centres.shape[:2], self._wanted.kind)
        if self._wanted.quantity == "height":
            found[...] = np.nan
            if surface is not None:
                found[...] = surface.sample(centres, self._method, threads=self._threads)
        else:
            gradients = np.full(centres.shape, np.nan)
            if surface is not None:
                gradients = surface.gradient(centres, threads=self._threads)
            found[...] = self._wanted.of_gradients(gradients)
        self._wanted.finish(found)
        return found


def _halves(down: range, across: range, axis: int) -> list[Window]:
    if axis:
        middle = len(across) // 2
        return [(down, across[:middle]), (down, across[middle:])]
    middle = len(down) // 2
    return [(down[:middle], across), (down[middle:], across)]


class Rasterizing:
    """The methods of a `TiledSurface` that make rasters."""

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
        progress: Progress | None = None,
    ) -> Raster:
        """Compute a raster in memory, reading the faces window by window.

        The values are those of `Surface.raster`, bit for bit.

        Parameters
        ----------
        resolution, bounds, transform, shape, quantity, method, light, z_factor, dtype, threads
            As for `Surface.raster`.
        progress : callable, optional
            Called with the fraction of the pixels done.

        Returns
        -------
        Raster
            The values; NaN where no face contains the centre of a pixel.

        Raises
        ------
        InputError
            As for `Surface.raster`.
        FormatError
            A file is damaged.
        OSError
            A file cannot be read.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> points = [[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]]
        >>> liftmesh.tile_surface(points, tempfile.mkdtemp()).raster(2).values
        array([[2., 6.],
               [2., 6.]])
        """
        check_progress(progress)
        layout = _layout(self, resolution, bounds, transform, shape)
        windows, wanted = _windows(self, layout, quantity, method, dtype, light, z_factor, threads)
        values = np.empty((layout.rows, layout.columns), wanted.kind)
        for (down, across), found in windows.values(progress):
            values[down.start : down.stop, across.start : across.stop] = found
        return Raster(values, layout.transform, self.crs, quantity, unit_of(self, quantity))

    def save_raster(  # noqa: PLR0913 - options are keywords
        self: Any,
        path: str | os.PathLike[str],
        resolution: float | Sequence[float] | None = None,
        *,
        bounds: Sequence[float] | None = None,
        transform: Sequence[float] | None = None,
        shape: Sequence[int] | None = None,
        quantity: RasterQuantity = "height",
        method: SampleMethod = "linear",
        light: tuple[float, float] = (315.0, 45.0),
        z_factor: float | None = None,
        dtype: DTypeLike = np.float32,
        cog: bool = False,
        compress: str | None = "deflate",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Path:
        """Write a raster as GeoTIFF, window by window: no more than a window is in memory.

        Parameters
        ----------
        path : path
            Where to write; written whole or not at all.
        resolution, bounds, transform, shape, quantity, method, light, z_factor
            As for `Surface.raster`.
        dtype : {"float32", "float64"}
            Type of the values; heights are rounded once.
        cog : bool, default False
            Write a cloud optimised GeoTIFF, by way of a plain one beside it.
        compress : str, optional
            As for `Raster.save`.
        threads : int, optional
            As for `delaunay`.
        progress : callable, optional
            Called with the fraction of the pixels done.

        Returns
        -------
        pathlib.Path
            The file; its values are those of `Surface.raster`, bit for bit.

        Raises
        ------
        InputError
            As for `Surface.raster` and `Raster.save`.
        FormatError
            The name does not end in .tif or .tiff, or a file of the surface is damaged.
        MissingDependencyError
            rasterio is not installed.
        OSError
            A file cannot be read or written.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> points = [[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]]
        >>> tiled = liftmesh.tile_surface(points, tempfile.mkdtemp())
        >>> tiled.save_raster(Path(tempfile.mkdtemp()) / "dtm.tif", 2).name
        'dtm.tif'
        """
        check_progress(progress)
        target = Path(path)
        check_name(target)
        is_cog = as_switch("cog", cog)
        layout = _layout(self, resolution, bounds, transform, shape)
        windows, wanted = _windows(self, layout, quantity, method, dtype, light, z_factor, threads)
        writer.write_windows(
            target,
            (layout.rows, layout.columns),
            wanted.kind,
            windows.values(progress),
            layout.transform,
            written_system(self.crs, quantity),
            unit=unit_of(self, quantity),
            cog=is_cog,
            compress=compress,
        )
        return target


def _layout(
    tiled: TiledSurface, resolution: Any, bounds: Any, transform: Any, shape: Any
) -> Layout:
    west, south, _, east, north, _ = tiled.extent
    return layout_of(resolution, bounds, transform, shape, lambda: (west, south, east, north))


def _windows(
    tiled: TiledSurface,
    layout: Layout,
    quantity: RasterQuantity,
    method: SampleMethod,
    dtype: DTypeLike,
    light: tuple[float, float],
    z_factor: float | None,
    threads: int | None,
) -> tuple[_Windows, Wanted]:
    wanted = Wanted.checked(tiled, quantity, method, dtype, light, z_factor)
    if quantity == "height":
        wanted.check_range(np.array(tiled.extent)[[2, 5]])
    return _Windows(tiled, layout, wanted, method, threads), wanted
