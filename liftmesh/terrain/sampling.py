"""Heights, slopes and aspects of a surface, or other values, at points of its plane.

The kernel locates each point and interpolates in its face, or between the ends of an edge, by rules
that name coordinates only: no bit of a height depends on the order of the rows or of the points, on
the triangle by which an edge was reached, or on threads (`_core/surface/facet.hpp`).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Rows
from liftmesh.base.options import Extrapolation, Interpolation, as_threads
from liftmesh.crs.comparison import common_system
from liftmesh.errors import InputError
from liftmesh.io.metadata import Provenance
from liftmesh.io.objects.plain import is_table
from liftmesh.io.read import read_cloud
from liftmesh.terrain.sampler import Sampler
from liftmesh.terrain.surface_data import (
    OverPlane,
    SurfaceData,
    kernel_surface,
    places_on,
    steepness,
)

Interpolator: TypeAlias = Callable[..., Floats]  # of points, (..., 2), or of x and y

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.base.weights import Weights
    from liftmesh.terrain.values import Values


def heights_at(
    surface: SurfaceData,
    points: ArrayLike,
    interpolation: Interpolation = "linear",
    *,
    values: Values | None = None,
    gradients: ArrayLike | None = None,
    extrapolate: Extrapolation | None = None,
    threads: int | None = None,
) -> Floats:
    """Interpolate heights, or other values, at points of the plane.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    points : array_like of shape (..., 2)
        Coordinates in the plane of the surface: x and y, unless it was triangulated on another.
    interpolation : {"linear", "nearest", "laplace", "sibson", "c1"}, default "linear"
        Linear in each face; the height of the nearest vertex, of several the lexicographically
        least; or, smooth but for the vertices, from natural neighbours: by the lengths of the
        sides that Voronoi cells would share ("laplace"), or by the areas that a cell would take
        from others ("sibson"). At a vertex the height is the vertex's own; on an edge, linear,
        and on the hull by all but the nearest, it comes from the two ends. Or "c1": smooth
        everywhere, by cubics over the faces (Clough, Tocher 1965), across lines as well; on an
        edge it comes from the values and gradients of the two ends, and may be beyond all values.
    values : str or array_like of shape (n, ...), optional
        Values of the vertices in place of heights: numbers of any shape for each, or the name of
        attributes, or "colors". NaN, and what a masked array masks, are none.
    gradients : array_like of shape (n, ..., 2), optional
        For "c1", dz/dx and dz/dy of the values at the vertices; by default those by which the
        cubics along the edges bend least (Nielson 1983), as in SciPy's CloughTocher2DInterpolator.
    extrapolate : {"nearest", "hull"}, optional
        What there is where no face contains a point: the value of the nearest vertex of a face, or,
        of points beyond the convex hull of these vertices, that of the nearest place on it, linear
        between its vertices, or cubic by "c1".
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    (...) ndarray of float64
        Heights above the plane, or values, of shape (..., ...); NaN where no face contains the
        point, and for points that are not finite. The same bits for any order of the rows and of
        the points.

    Raises
    ------
    InputError
        The last axis is not of length two, an option is unknown, or another interpolation than
        "linear" and "c1", or the nearest vertex beyond, is asked of a surface with weights, radii
        or a metric, or "laplace" or "sibson" of one that follows lines; there are no such values.

    See Also
    --------
    Surface.raster : At the centres of pixels.
    Surface.profile : Along a line.
    Surface.weights : For many values at the same points.
    Surface.gradient, Surface.slope, Surface.aspect

    Notes
    -----
    A linear height is never beyond those of the corners of its face. In faces that fill less
    than a thousandth of their bounding box the weights come from exact determinants.

    Which vertices are natural neighbours is decided exactly; vertices of faces that are left out
    are among them, and where one has no value (NaN), the point has none. Weights are right to 1e-12
    of the largest. By them a point takes time for each of its neighbours: many, near the centre of
    a circle of vertices. The nearest vertex takes longer where many vertices are about as near, as
    in the middle of a circle.
    Slopes and aspects are those of faces, whatever the interpolation.

    The nearest place on the hull is right to rounding at any distance, and takes log h time for h
    vertices; of points further away than 10^15 times its size, 0.4 ms each. Each column of values
    locates the points anew, which `weights_at` does once.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> surface.sample([[1, 1], [2, 2], [0, 4], [3, 3]])
    array([ 5.,  5.,  1., nan])
    >>> surface.sample([3, 3], extrapolate="hull"), surface.sample([3, 2], extrapolate="nearest")
    (np.float64(5.0), np.float64(9.0))
    >>> surface.sample([[1, 1], [2, 2]], values=[[0, 1], [4, 1], [8, 1]])
    array([[3., 1.],
           [6., 1.]])
    """
    return Sampler(surface, values, interpolation, extrapolate, gradients).at(points, threads)


def weights_at(
    surface: SurfaceData,
    points: ArrayLike,
    interpolation: Interpolation = "linear",
    *,
    extrapolate: Extrapolation | None = None,
    threads: int | None = None,
) -> Weights:
    """Weigh the vertices at points of the plane, for values that are sampled there again and again.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    points : array_like of shape (..., 2)
        As for `heights_at`; m points in all.
    interpolation, extrapolate, threads
        As for `heights_at`.

    Returns
    -------
    Weights
        A sparse matrix of m points and n vertices, with the entries of CSR. ``weights @ values`` is
        ``heights_at(surface, points, values=values)`` bit for bit, one row for each point, NaN
        where it is; ``weights.to_scipy()`` makes a ``csr_array``, whose products differ by
        rounding. Linear weights may be negative by rounding.

    Raises
    ------
    InputError
        As for `heights_at`; or the array of points was written to since it was triangulated.

    See Also
    --------
    Surface.sample : Once, without weights.
    natural_neighbors : Sibson's weights of points alone.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> weights = surface.weights([[1, 1], [2, 2], [3, 3]])
    >>> weights @ [0, 4, 8], weights @ [8, 8, 0]
    (array([ 3.,  6., nan]), array([ 6.,  4., nan]))
    """
    return Sampler(surface, None, interpolation, extrapolate).weights(points, threads)


def interpolator_of(
    surface: SurfaceData,
    values: Values | None = None,
    interpolation: Interpolation = "linear",
    *,
    gradients: ArrayLike | None = None,
    extrapolate: Extrapolation | None = None,
) -> Interpolator:
    """Make a function of points, with the calls of SciPy's ``LinearNDInterpolator``.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    values, interpolation, gradients, extrapolate
        As for `heights_at`.

    Returns
    -------
    Interpolator
        Called with points, (..., 2), or with x and y, two arrays that broadcast, it returns what
        `heights_at` does.

    Raises
    ------
    InputError
        As for `heights_at`; or, when it is called, the points are none.

    See Also
    --------
    Surface.sample : The same at once.

    Notes
    -----
    Values and options are taken as they are when the function is made. It can be pickled, with the
    surface, for other processes and Dask, and has the same bits there.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> height = surface.interpolator(extrapolate="nearest")
    >>> height(1, 1), height([[1, 1], [5, 0]]), height([0, 1], 1)
    (np.float64(5.0), array([5., 9.]), array([4., 5.]))
    """
    sampler = Sampler(surface, values, interpolation, extrapolate, gradients)
    return partial(_interpolated, sampler)


def _interpolated(sampler: Sampler, *points: ArrayLike, threads: int | None = None) -> Floats:
    """Answer the call of an interpolator, which has to be picklable."""
    return sampler.at(points[0] if len(points) == 1 else _paired(points), threads)


def _paired(columns: tuple[ArrayLike, ...]) -> Floats:
    """Make points of x and y."""
    if len(columns) != 2:
        raise InputError(f"{len(columns)} arrays are given: give one of points, or x and y")
    try:
        return np.stack(np.broadcast_arrays(*columns), axis=-1)
    except ValueError as error:
        x, y = map(np.shape, columns)
        raise InputError(
            f"x has the shape {x}, and y {y}: give two that broadcast, or one array of points"
        ) from error


def heights_above(
    surface: SurfaceData,
    cloud: object,
    *,
    interpolation: Interpolation = "linear",
    extrapolate: Extrapolation | None = None,
    threads: int | None = None,
) -> Floats:
    """Compute how high the points of a cloud are above the faces.

    Parameters
    ----------
    surface : Surface
        The ground.
    cloud : Cloud, array_like of shape (n, 3), path or object
        The points, in the coordinate system of the surface: all rows of a file or of an object
        that holds points.
    interpolation, extrapolate, threads
        As for `heights_at`.

    Returns
    -------
    (n,) ndarray of float64
        The height of each point above the plane less that of the surface there: below it,
        negative; NaN as of `heights_at`.

    Raises
    ------
    InputError
        As for `heights_at`, or the cloud is in another coordinate system; or the points have no z,
        or the ground, by the columns it was read from, has none.
    UnsupportedTypeError, FormatError, OSError
        As for `read`.

    See Also
    --------
    Surface.sample : The heights of the ground.

    Examples
    --------
    >>> import liftmesh
    >>> ground = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> ground.height_above([[1, 1, 12], [2, 1, 6], [9, 9, 9]])
    array([ 7.,  0., nan])
    """
    above = points_above(surface, cloud)
    ground = heights_at(
        surface,
        surface.frame.planar(above.points),
        interpolation,
        extrapolate=extrapolate,
        threads=threads,
    )
    heights: Floats = surface.frame.heights(above.points) - ground
    return heights


def points_above(surface: OverPlane, cloud: object) -> Cloud:
    """Read points that are compared with a surface: with heights, and in its system."""
    above = read_cloud(cloud)
    shape = np.shape(cloud) if isinstance(cloud, list | tuple) else getattr(cloud, "shape", ())
    is_flat = shape[1:] == (2,) and not is_table(cloud)  # a column may hold points in space
    if is_flat or Provenance(above.metadata).is_flat:
        raise InputError("the points have no z: give rows of x, y and z")
    if Provenance(surface.metadata).is_flat:
        raise InputError("the ground has no z: read it with a column of heights")
    common_system(above.crs, surface.crs, ("the points", "the surface"))
    return above


def gradients_at(surface: SurfaceData, points: ArrayLike, *, threads: int | None = None) -> Floats:
    """Compute the gradient of the face at points of the plane.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    points : array_like of shape (..., 2)
        As for `heights_at`.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    (..., 2) ndarray of float64
        dz/dx and dz/dy, in heights per length; NaN where no face contains the point. On an edge
        or at a vertex they are those of one face: the first counter-clockwise, from the
        direction just above that of x on.

    Raises
    ------
    InputError
        As for `heights_at`.

    See Also
    --------
    Surface.slope, Surface.aspect
    Surface.sample : Heights.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> surface.gradient([1, 1])
    array([ 1., -1.])
    """
    pairs = places_on(surface, points)
    gradients = np.empty(pairs.shape)
    kernel_surface(surface).gradients(
        surface.triangulation._locator,  # noqa: SLF001 - as above
        pairs.reshape(-1, 2),
        gradients.reshape(-1, 2),
        *as_threads(threads, gradients.size // 2),
    )
    return gradients


def faces_at(surface: SurfaceData, points: Floats, threads: int | None) -> Rows:
    """Return the triangle that owns each point, whose gradient it has; -1 where there is none."""
    faces = np.empty(points.shape[:-1], np.int32)
    kernel_surface(surface).owners(
        surface.triangulation._locator,  # noqa: SLF001 - as above
        points.reshape(-1, 2),
        faces.reshape(-1),
        *as_threads(threads, faces.size),
    )
    return faces


def slopes_at(
    surface: SurfaceData,
    points: ArrayLike,
    *,
    z_factor: float | None = None,
    threads: int | None = None,
) -> Floats:
    """Compute how steep the face is at points of the plane.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    points : array_like of shape (..., 2)
        As for `heights_at`.
    z_factor : float, optional
        What heights are multiplied by; by default what gives them the unit of x and y, if the
        coordinate system says the units of all three.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    (...) ndarray of float64
        Degrees from the plane, 0 to 90; NaN where no face contains the point. On edges as
        `gradients_at`.

    Raises
    ------
    InputError
        As for `heights_at`, the factor is not positive, or x and y are degrees and it is not given.

    See Also
    --------
    Surface.aspect : Which way the face descends.
    Surface.gradient : In heights per length.
    Surface.raster : At the centres of pixels.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 5]])
    >>> surface.slope([1, 1]).round(9)
    np.float64(45.0)
    """
    return slope_degrees(
        gradients_at(surface, points, threads=threads) * steepness(surface, z_factor)
    )


def aspects_at(surface: SurfaceData, points: ArrayLike, *, threads: int | None = None) -> Floats:
    """Compute which way the face descends at points of the plane.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    points : array_like of shape (..., 2)
        As for `heights_at`.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    (...) ndarray of float64
        Degrees clockwise from the direction of y, which is north on maps, from 0 up to 360; NaN
        on level faces and where no face contains the point. On edges as `gradients_at`.

    Raises
    ------
    InputError
        As for `heights_at`, or x and y are degrees.

    See Also
    --------
    Surface.slope : How steep the face is.
    Surface.gradient : In heights per length.
    Surface.raster : At the centres of pixels.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 5]])
    >>> surface.aspect([1, 1])  # down to the west
    np.float64(270.0)
    """
    return aspect_degrees(gradients_at(surface, points, threads=threads) * steepness(surface, None))


def slope_degrees(gradients: Floats) -> Floats:
    """Convert gradients to degrees from the plane."""
    slopes: Floats = np.degrees(np.arctan(np.hypot(gradients[..., 0], gradients[..., 1])))
    return slopes


def aspect_degrees(gradients: Floats) -> Floats:
    """Convert gradients to directions of descent."""
    east, north = -gradients[..., 0], -gradients[..., 1]
    turned = np.degrees(np.arctan2(east, north)) % 360
    is_level = (east == 0) & (north == 0)
    aspects: Floats = np.where(is_level, np.nan, np.where(turned == 360, 0.0, turned))
    return aspects[()]
