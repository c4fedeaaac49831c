"""Triangulations and Voronoi polygons with the signatures of shapely, and on tables of GeoPandas.

>>> from shapely import MultiPoint
>>> from liftmesh.plugins.shapely import delaunay_triangles
>>> print(delaunay_triangles(MultiPoint([(0, 0), (1, 0), (0, 1)])))
GEOMETRYCOLLECTION (POLYGON ((0 0, 1 0, 0 1, 0 0)))

The functions take what those of shapely take, one geometry or an array of them, and return the same
kinds of geometries. What differs from shapely's own:

- Triangles and the corners of cells are exact, so triangles leave no gap, and cells do not overlap;
  of cocircular points the triangles are the same in whatever order they are given.
- Repeated points are no error with ``ordered=True``: the first has the cell, the others an empty
  polygon.
- With a tolerance, points are left out so that no two are nearer to each other than it, and no
  other fits between; shapely leaves out points as it inserts them.
- A coordinate that is not finite is an error.

A ``GeoSeries`` or ``GeoDataFrame`` is taken as GeoPandas's methods take it: triangles and Voronoi
cells are those of all its coordinates together, and a constrained triangulation is one for each
row. The coordinate system is kept; each constrained triangulation and each cell of a point carries
the index and the columns of its row.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.options import as_distance, counted
from liftmesh.cells.clipped import rows_of_corners
from liftmesh.cells.domain import following_corners
from liftmesh.cells.voronoi import voronoi
from liftmesh.errors import CrossingError, DegenerateInputError, UnsupportedTypeError
from liftmesh.io.objects.plain import is_of
from liftmesh.optional import load
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.thinning import rows_apart

if TYPE_CHECKING:
    import shapely

    from liftmesh.cells.voronoi import Cells
else:
    shapely = load("shapely", extra="shapes")

_WITH_HEIGHTS = 0x80000000

_is_series = is_of("geopandas", {"GeoSeries"})
_is_frame = is_of("geopandas", {"GeoDataFrame"})


def delaunay_triangles(geometry: Any, tolerance: Any = 0.0, only_edges: Any = False) -> Any:
    """Compute the Delaunay triangulation of the vertices of geometries.

    Parameters
    ----------
    geometry : geometry, array_like of geometries, GeoSeries or GeoDataFrame
        Of any kinds; None stays None.
    tolerance : float or array_like, default 0.0
        Points nearer to another one than this are left out. Of NaN the result is None.
    only_edges : bool or array_like, default False
        Return a MultiLineString of edges in place of triangles.

    Returns
    -------
    GeometryCollection of Polygon, or MultiLineString, or ndarray of these
        Triangles counter-clockwise, with the heights of their points if these have any; empty for
        fewer than three points, and for points on a line, which have edges only. A GeoSeries of
        triangles or edges for a table.

    Raises
    ------
    InputError
        A coordinate is not finite, or the tolerance is negative.
    UnsupportedTypeError
        Something is no geometry.
    MissingDependencyError
        shapely is not installed: as this module is imported.

    See Also
    --------
    liftmesh.delaunay : The triangles of arrays.

    Examples
    --------
    >>> from shapely import MultiPoint
    >>> from liftmesh.plugins.shapely import delaunay_triangles
    >>> print(delaunay_triangles(MultiPoint([(0, 0), (2, 0), (1, 0)]), only_edges=True))
    MULTILINESTRING ((0 0, 1 0), (1 0, 2 0))
    """
    return _of_all(_triangles, geometry, tolerance, only_edges)


def voronoi_polygons(
    geometry: Any,
    tolerance: Any = 0.0,
    extend_to: Any = None,
    only_edges: Any = False,
    ordered: Any = False,
) -> Any:
    """Compute the Voronoi cells of the vertices of geometries.

    Parameters
    ----------
    geometry : geometry, array_like of geometries, GeoSeries or GeoDataFrame
        Of any kinds; None stays None.
    tolerance : float or array_like, default 0.0
        Points nearer to another one than this are left out.
    extend_to : geometry or array_like of geometries, optional
        The cells reach over the box of the points, widened by its longer side on each side, and
        over the box of this.
    only_edges : bool or array_like, default False
        Return a MultiLineString of edges in place of cells.
    ordered : bool or array_like, default False
        Return a polygon for each coordinate, in their order: an empty one for those that are
        repeated or left out. By default there are no empty ones.

    Returns
    -------
    GeometryCollection of Polygon, or MultiLineString, or ndarray of these
        Cells in the order of their points; empty for fewer than two different ones. For a table of
        points, the same table with cells, empty ones of rows without a point; for one of other
        geometries, a row for each of their vertices, with the index of its row; for edges a
        GeoSeries.

    Raises
    ------
    InputError
        A coordinate is not finite, or the tolerance is negative.
    UnsupportedTypeError
        Something is no geometry.
    MissingDependencyError
        shapely is not installed: as this module is imported.

    See Also
    --------
    liftmesh.voronoi : Cells inside any domain, with their measures.

    Examples
    --------
    >>> from shapely import MultiPoint
    >>> from liftmesh.plugins.shapely import voronoi_polygons
    >>> print(voronoi_polygons(MultiPoint([(0, 0), (2, 0)]), only_edges=True))
    MULTILINESTRING ((1 -2, 1 2))
    """
    if _is_frame(geometry) or _is_series(geometry):
        return _cells_of_table(geometry, tolerance, extend_to, only_edges)
    return _of_each(_cells, geometry, tolerance, extend_to, only_edges, ordered)


def constrained_delaunay_triangles(geometry: Any) -> Any:
    """Compute the constrained Delaunay triangulation of polygons, without their holes.

    Parameters
    ----------
    geometry : geometry, array_like of geometries, GeoSeries or GeoDataFrame
        Of others than polygons, and collections of them, there are no triangles; None stays None.

    Returns
    -------
    GeometryCollection of Polygon, or ndarray of these
        The triangles of each, counter-clockwise. For a table, the same table with these.

    Raises
    ------
    InputError
        A coordinate is not finite.
    CrossingError
        A polygon crosses itself; the message says where.
    UnsupportedTypeError
        Something is no geometry.
    MissingDependencyError
        shapely is not installed: as this module is imported.

    See Also
    --------
    liftmesh.constrained_delaunay : Triangulations of points, edges and polygons.

    Examples
    --------
    >>> from shapely import Polygon
    >>> from liftmesh.plugins.shapely import constrained_delaunay_triangles
    >>> print(constrained_delaunay_triangles(Polygon([(0, 0), (4, 0), (1, 1), (0, 4)])).geoms[0])
    POLYGON ((0 0, 1 1, 0 4, 0 0))
    """
    if _is_frame(geometry):
        return geometry.set_geometry(constrained_delaunay_triangles(geometry.geometry))
    if _is_series(geometry):
        made = _of_each(_inside, geometry.to_numpy())
        return type(geometry)(made, index=geometry.index, crs=geometry.crs)
    return _of_each(_inside, geometry)


def _of_each(make: Callable[..., Any], geometry: Any, *options: Any) -> Any:
    """Call a function with each of geometries and options, broadcast as shapely does."""
    each = np.broadcast(*(np.asarray(given, dtype=object) for given in (geometry, *options)))
    made = np.empty(each.shape, dtype=object)
    for place, (shape, *rest) in enumerate(each):
        is_left_out = shape is None or any(value != value for value in rest)  # noqa: PLR0124 - NaN
        made.flat[place] = None if is_left_out else make(_checked(shape), *rest)
    return made if made.shape else made[()]


def _of_all(make: Callable[..., Any], geometry: Any, *options: Any) -> Any:
    """Do the same, or take a table for one geometry, and return the parts in a series."""
    if not (_is_frame(geometry) or _is_series(geometry)):
        return _of_each(make, geometry, *options)
    series = geometry.geometry
    made = make(shapely.geometrycollections(series.to_numpy()), *options)
    return type(series)(shapely.get_parts(made), crs=series.crs)


def _checked(shape: Any) -> Any:
    if not shapely.is_geometry(shape):
        raise UnsupportedTypeError(f"shapely's geometries are needed, not {type(shape).__name__}")
    return shape


def _triangles(shape: Any, tolerance: float, only_edges: bool) -> Any:
    coordinates = _coordinates(shape)
    if distance := as_distance("tolerance", tolerance):
        coordinates = coordinates[rows_apart(coordinates[:, :2], distance)]
    planar = coordinates[:, :2]
    try:
        tri = delaunay(planar)
    except DegenerateInputError:
        ends = _along(planar) if only_edges else np.empty((0, 3), dtype=np.int32)
    else:
        ends = tri.edges if only_edges else tri.simplices
    return _made_of(coordinates, ends)


def _made_of(coordinates: Floats, ends: Array) -> Any:
    """Make a collection of triangles, or the lines of edges; at once, as well-known binary."""
    is_lines = ends.shape[1] == 2
    many, one, rings = (5, 2, ()) if is_lines else (7, 3, (1,))
    around = ends if is_lines else ends.take([0, 1, 2, 0], axis=1)
    space = _WITH_HEIGHTS if coordinates.shape[1] == 3 else 0
    width = around.shape[1] * coordinates.shape[1]
    corners = coordinates.take(around, axis=0).astype("<f8", copy=False).reshape(-1, width)
    head = b"\x01" + np.array([one | space, *rings, around.shape[1]], dtype="<u4").tobytes()
    whole = b"\x01" + np.array([many | space, len(ends)], dtype="<u4").tobytes()
    text = np.empty(len(whole) + len(ends) * (len(head) + 8 * width), dtype=np.uint8)
    text[: len(whole)] = np.frombuffer(whole, np.uint8)
    parts = text[len(whole) :].reshape(-1, len(head) + 8 * width)
    parts[:, : len(head)] = np.frombuffer(head, np.uint8)
    parts[:, len(head) :] = corners.view(np.uint8)
    return shapely.from_wkb(text.tobytes())


def _along(planar: Floats) -> Array:
    """Return the pairs of points that follow each other on a line."""
    first = np.unique(planar, axis=0, return_index=True)[1]  # in lexicographic order
    return np.stack([first[:-1], first[1:]], axis=1)


def _cells(shape: Any, tolerance: float, extend_to: Any, only_edges: bool, ordered: bool) -> Any:
    coordinates = _coordinates(shape)[:, :2]
    kept = rows_apart(coordinates, as_distance("tolerance", tolerance))
    points = coordinates[kept]
    if len(np.unique(points, axis=0)) < 2:
        return shapely.MultiLineString() if only_edges else shapely.GeometryCollection()
    cells = voronoi(points, domain=_box(coordinates, extend_to))
    if only_edges:
        return shapely.multilinestrings(_edges(cells))
    polygons = np.full(len(coordinates), shapely.Polygon(), dtype=object)
    polygons[kept] = cells.to_shapely()
    return shapely.geometrycollections(
        polygons if ordered else polygons[~shapely.is_empty(polygons)]
    )


def _edges(cells: Cells) -> Array:
    """Make a line of each side between two cells."""
    start = np.flatnonzero(cells.beyond > rows_of_corners(cells))
    ends = np.stack([start, following_corners(cells.ring_corners)[start]], axis=1)
    lines = cells.corners[ends]
    lines = lines[(lines[:, 0] != lines[:, 1]).any(axis=1)]  # corners may be equal once rounded
    return np.asarray(shapely.linestrings(lines), dtype=object)


def _box(coordinates: Floats, extend_to: Any) -> tuple[float, ...]:
    """Return the box of points, widened by its longer side, and of a geometry."""
    low, high = coordinates.min(axis=0), coordinates.max(axis=0)
    wider = (high - low).max()
    box = np.array([*(low - wider), *(high + wider)])
    if extend_to is not None and not shapely.is_empty(_checked(extend_to)):
        other = shapely.bounds(extend_to)
        box = np.array([*np.minimum(box[:2], other[:2]), *np.maximum(box[2:], other[2:])])
    return tuple(box.tolist())


def _cells_of_table(table: Any, tolerance: float, extend_to: Any, only_edges: bool) -> Any:
    """Give each row of a table its cell, or one for each of its vertices."""
    series = table.geometry
    whole = shapely.geometrycollections(series.to_numpy())
    made = _cells(whole, tolerance, extend_to, only_edges, True)
    if only_edges:
        return type(series)(shapely.get_parts(made), crs=series.crs)
    count = shapely.get_num_coordinates(series.to_numpy())
    row = np.repeat(np.arange(len(count)), np.maximum(count, 1))  # also of what has none
    polygons = np.full(len(row), shapely.Polygon(), dtype=object)
    if parts := made.geoms:
        polygons[count[row] > 0] = list(parts)
    cells = type(series)(polygons, index=series.index[row], crs=series.crs)
    return cells if _is_series(table) else table.iloc[row].set_geometry(cells)


def _inside(shape: Any) -> Any:
    """Triangulate each polygon of a geometry."""
    collections = [
        _parts(_of_polygon(part))
        for part in _parts(shape)
        if shapely.get_dimensions(part) == 2 and not shapely.is_empty(part)
    ]
    return shapely.geometrycollections(np.concatenate([np.empty(0, dtype=object), *collections]))


def _parts(shape: Any) -> Array:
    """Return what a collection is made of, also of collections in it."""
    parts = np.atleast_1d(shapely.get_parts(shape))
    while (shapely.get_type_id(parts) > 3).any():
        parts = shapely.get_parts(parts)
    return parts


def _of_polygon(polygon: Any) -> Any:
    coordinates = _coordinates(polygon)
    try:
        tri = constrained_delaunay(coordinates[:, :2], polygons=polygon, carve="holes")
    except CrossingError as error:
        x, y = error.places[0].tolist()
        times = counted(len(error.crossings), "time")
        message = f"a polygon crosses itself {times}, first at ({x!r}, {y!r}): shapely.make_valid"
        lists = {"crossings": error.crossings, "rows": error.rows, "places": error.places}
        raise CrossingError(f"{message} divides it there", **lists) from error
    return _made_of(coordinates, tri.simplices)


def _coordinates(shape: Any) -> Floats:
    """Return the coordinates of a geometry, with heights if it has any."""
    coordinates: Floats = shapely.get_coordinates(shape, include_z=bool(shapely.has_z(shape)))
    return coordinates
