"""Grids of heights in xarray as triangulated surfaces.

>>> import xarray
>>> import liftmesh.plugins.xarray
>>> heights = [[0.0, 1, 2], [0, float("nan"), 2], [0, 1, 2]]
>>> grid = xarray.DataArray(heights, {"y": [2.0, 1, 0], "x": [0.0, 1, 2]})
>>> grid.liftmesh.tin(max_error=0.01)
<Surface of 2 triangles over 4 vertices>
>>> grid.liftmesh.fill_gaps().values[1].tolist()
[0.0, 1.0, 2.0]

With this module, each `xarray.DataArray` has an accessor ``liftmesh``. Coordinate systems, as
rioxarray states them, and units are kept.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh.base.options import Interpolation
from liftmesh.optional import load
from liftmesh.raster.raster import heights_of
from liftmesh.terrain.simplification import simplify
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    import xarray as host

    from liftmesh.terrain.surface import Surface
else:
    host = load("xarray", extra="xarray")


@host.register_dataarray_accessor("liftmesh")  # type: ignore[no-untyped-call]
class GridAccessor:
    """What liftmesh does with a grid of heights, as ``grid.liftmesh``.

    Parameters
    ----------
    grid : xarray.DataArray
        With x as the coordinates of its last dimension and y of the one before; other dimensions
        have a length of 1. NaN and ``_FillValue`` are no heights.

    See Also
    --------
    liftmesh.Raster.to_xarray : Grids of surfaces.

    Examples
    --------
    >>> import xarray
    >>> import liftmesh.plugins.xarray
    >>> grid = xarray.DataArray([[0.0, 1], [2, 3]], {"y": [1.0, 0], "x": [0.0, 1]})
    >>> grid.liftmesh.tin()
    <Surface of 2 triangles over 4 vertices>
    """

    def __init__(self, grid: host.DataArray) -> None:
        self._grid = grid

    def tin(self, *, max_error: float | None = None, **options: Any) -> Surface:
        """Make a surface of the grid, of few triangles if an error is allowed.

        Parameters
        ----------
        max_error : float, optional
            The largest vertical distance between the surface and a height of the grid, as of
            `liftmesh.simplify`; by default every height is a vertex.
        **options
            Those of `liftmesh.simplify`, or of `liftmesh.triangulate` without `max_error`.

        Returns
        -------
        Surface
            The surface.

        Raises
        ------
        InputError
            The grid is none of heights, or an option is invalid.

        See Also
        --------
        liftmesh.simplify, liftmesh.triangulate : The functions that do it.

        Examples
        --------
        >>> import xarray
        >>> import liftmesh.plugins.xarray
        >>> grid = xarray.DataArray([[0.0, 1], [2, 9]], {"y": [1.0, 0], "x": [0.0, 1]})
        >>> grid.liftmesh.tin(max_error=0.5).vertices.shape
        (4, 3)
        """
        if max_error is None and options.get("max_points") is None:
            return triangulate(self._grid, **options)
        return simplify(self._grid, max_error=max_error, **options)

    def fill_gaps(self, interpolation: Interpolation = "linear") -> host.DataArray:
        """Give pixels without a height that of the surface of all others.

        Parameters
        ----------
        interpolation : {"linear", "nearest", "laplace", "sibson", "c1"}, default "linear"
            As of `liftmesh.Surface.sample`.

        Returns
        -------
        xarray.DataArray
            A copy, of float64, without gaps between heights; beyond the convex hull of these,
            there are none.

        Raises
        ------
        InputError
            The grid is none of heights, or they are fewer than three, or on a line.

        See Also
        --------
        liftmesh.Raster.filled : From the nearest pixels, up to a distance.

        Examples
        --------
        >>> import xarray
        >>> import liftmesh.plugins.xarray
        >>> heights = [[0.0, 1, 2], [0, float("nan"), 2]]
        >>> grid = xarray.DataArray(heights, {"y": [1.0, 0], "x": [0.0, 1, 2]})
        >>> grid.liftmesh.fill_gaps().values.tolist()
        [[0.0, 1.0, 2.0], [0.0, 1.0, 2.0]]
        """
        surface = triangulate(self._grid)
        grid = self._grid.squeeze()
        heights = np.array(heights_of(grid))
        row, column = np.nonzero(np.isnan(heights))
        y, x = (grid.coords[name].values for name in grid.dims)
        places = np.stack([x[column], y[row]], axis=1)
        heights[row, column] = surface.sample(places, interpolation)
        filled: host.DataArray = self._grid.copy(data=heights.reshape(self._grid.shape))
        return filled
