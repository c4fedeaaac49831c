"""Heights, slopes, aspects and shades of a surface: at points of its plane, and of rasters.

The kernel locates each point and interpolates in its face, or between the ends of an edge, by rules
that name coordinates only: no bit of a height depends on the order of the rows or of the points, on
the triangle by which an edge was reached, or on threads (`_core/surface/facet.hpp`).

The centre of a pixel is the point that the transform gives for it, in doubles (`pixels.py`), and
its value is that of the surface there: the kernel scans the faces, row by row, and gives every
centre to one of them (`_core/surface/scan.cpp`). So the heights are bit for bit those of
`Surface.sample`. Other quantities follow from the gradients of faces.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_pairs, planar_bounds
from liftmesh.base.options import (
    Extrapolation,
    Interpolation,
    RasterQuantity,
    as_threads,
    check_option,
    refused,
    shown,
)
from liftmesh.crs.comparison import are_different
from liftmesh.errors import InputError, Option
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import read_cloud
from liftmesh.raster.fill import Reach, filled
from liftmesh.raster.pixels import Layout, centres_of, layout_of
from liftmesh.raster.raster import Raster
from liftmesh.terrain.sampler import Sampler, check_gradients
from liftmesh.terrain.surface_data import (
    OverPlane,
    SurfaceData,
    kernel_surface,
    plane_system,
    slope_scale,
    steepness,
    unit_names,
)
from liftmesh.terrain.values import Values, over_values

Interpolator: TypeAlias = Callable[..., Floats]  # of points, (..., 2), or of x and y

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.base.weights import Weights


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
        The last axis is not of length two, an option is unknown, or another interpolation
        than "linear" is asked of a surface with weights, radii or a metric, or than "linear" and
        "nearest" of one that follows lines; there are no such values.

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
    Values and options are taken as they are when the function is made.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> height = surface.interpolator(extrapolate="nearest")
    >>> height(1, 1), height([[1, 1], [5, 0]]), height([0, 1], 1)
    (np.float64(5.0), array([5., 9.]), array([4., 5.]))
    """
    sampler = Sampler(surface, values, interpolation, extrapolate, gradients)

    def interpolate(*points: ArrayLike, threads: int | None = None) -> Floats:
        return sampler.at(points[0] if len(points) == 1 else _paired(points), threads)

    return interpolate


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


def points_above(surface: SurfaceData, cloud: object) -> Cloud:
    """Read points that are compared with a surface: with heights, and in its system."""
    above = read_cloud(cloud)
    shape = np.shape(cloud) if isinstance(cloud, list | tuple) else getattr(cloud, "shape", ())
    if shape[1:] == (2,) or Provenance(above.metadata).is_flat:
        raise InputError("the points have no z: give rows of x, y and z")
    if Provenance(surface.metadata).is_flat:
        raise InputError("the ground has no z: read it with a column of heights")
    if are_different(surface.crs, above.crs):
        raise InputError(
            f"the points are in {shown(above.crs)}, and the surface in {shown(surface.crs)}: "
            "transform the points first"
        )
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
    pairs = as_pairs(points)
    gradients = np.empty(pairs.shape)
    kernel_surface(surface).gradients(
        surface.triangulation._locator,  # noqa: SLF001 - as above
        pairs.reshape(-1, 2),
        gradients.reshape(-1, 2),
        *as_threads(threads, gradients.size // 2),
    )
    return gradients


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


_UNITS: dict[str, str | None] = {"slope": "degree", "aspect": "degree"}
_TOGETHER = 1 << 22  # pixels whose gradients are held at a time
_TYPES = (np.dtype(np.float64), np.dtype(np.float32))
_STEEP, _SCALE = 2.0**500, 2.0**-600


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
    if plan.quantity == "height" and plan.interpolation == "linear":
        scan(pixels[:, :, None], 0)
    elif plan.quantity == "height":
        sampler = Sampler(surface, None, plan.interpolation, None, gradients)
        for first, block in _blocks_of_rows(pixels):
            rows = range(first, first + len(block))
            centers = centres_of(plan.layout.transform, rows, plan.layout.columns)
            block[...] = sampler.at(centers, plan.threads)
    else:
        _scan_faces(surface, plan, scan, pixels)


def bounds_of_faces(surface: SurfaceData) -> tuple[float, float, float, float]:
    """Return xmin, ymin, xmax and ymax of the faces."""
    solved = surface.triangulation
    corners = solved.convex_hull if surface.mask is None else surface.faces.ravel()
    return planar_bounds(solved.points[corners])


def _scan_faces(
    surface: SurfaceData, plan: RasterPlan, scan: Callable[[Array, int], None], pixels: Array
) -> None:
    """Fill pixels with what the faces have that own their centres."""
    if plan.quantity == "longest-edge":
        lengths = np.append(_longest_sides(surface), np.nan)
    for first, block in _blocks_of_rows(pixels):
        if plan.quantity == "longest-edge":
            faces = np.empty((*block.shape, 1), np.int32)
            scan(faces, first)
            block[...] = lengths[faces[..., 0]]
        else:
            gradients = np.empty((*block.shape, 2))
            scan(gradients, first)
            block[...] = plan.of_gradients(gradients)


def _longest_sides(surface: SurfaceData) -> Floats:
    """Return the length of the longest side of each triangle in the plane."""
    solved = surface.triangulation
    corners = solved.points[solved.simplices].astype(np.float64, copy=False)
    with np.errstate(over="ignore"):
        sides = corners - np.roll(corners, 1, axis=1)
        lengths: Floats = np.hypot(sides[..., 0], sides[..., 1]).max(axis=1)
    return lengths


def _check_range(surface: SurfaceData, plan: RasterPlan) -> None:
    """Raise if a height of a face is beyond the type; others than those of faces may be."""
    heights = surface.frame.heights(surface.vertices)
    if not np.fmax.reduce(np.abs(heights)) <= np.finfo(plan.kind).max:
        plan.check_range(heights[surface.faces])


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
        rest = kind, light, rise, unit, all_of["threads"]
        return cls(layout, quantity, interpolation, reach, *rest)

    def raster(self, values: Array, crs: str | None) -> Raster:
        """Put values where they belong."""
        return Raster(values, self.layout.transform, crs, self.quantity, self.unit)

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
