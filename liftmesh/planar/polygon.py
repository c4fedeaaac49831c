"""`triangulate_polygon`: triangles of one polygon, with the arguments and results of trimesh."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers
from liftmesh.base.arrays import as_pairs, used_rows
from liftmesh.base.options import as_switch, counted, refused
from liftmesh.errors import InputError, Option
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.refinement import refine

_NUMBER = r"\d+(?:\.\d*)?|\.\d+"
_SWITCHES = re.compile(rf"p?(?P<q>q(?P<angle>{_NUMBER})?)?(?:a(?P<area>{_NUMBER}))?(?P<D>D?)[Qz]*")
_ANGLE_OF_TRIANGLE = 20.0  # its "q" without a number


def triangulate_polygon(
    polygon: Any,
    triangle_args: str | None = None,
    engine: str | None = None,
    force_vertices: bool = False,
    *,
    quality: float | None = None,
    max_area: float | None = None,
    steiner: ArrayLike | None = None,
) -> tuple[Floats, Integers]:
    """Triangulate a polygon with holes: constrained Delaunay, exactly, also where holes touch.

    Parameters
    ----------
    polygon : shapely.Polygon or polygons in any form that `constrained_delaunay` takes
        Its rings may touch, but not cross. None, and an empty one, have no triangles.
    triangle_args : str, optional
        Switches of Triangle: "p", "q" and "q30" for `quality`, "a0.5" for `max_area`, and "D" for
        triangles that are Delaunay across edges, too, in this order. "Q" and "z" change nothing.
    engine : {"liftmesh"}, optional
        Accepted as trimesh calls with it.
    force_vertices : bool, default False
        Raise if vertices would have to be added.
    quality : float, optional
        The smallest angle wanted, in degrees, as `min_angle` of `refine`; adds vertices.
    max_area : float, optional
        The largest area wanted; adds vertices.
    steiner : (k, 2) array_like, optional
        Points inside of the polygon that become vertices, too.

    Returns
    -------
    vertices : (n, 2) ndarray of float64
        Each position once: those of `steiner`, then the corners of the rings, then those that were
        added for `quality` and `max_area`.
    faces : (m, 3) ndarray of int64
        Triangles, counter-clockwise.

    Raises
    ------
    InputError
        A coordinate is not finite, or an argument, the polygon among them, is invalid; vertices
        would have to be added, or one of `steiner` is outside.
    CrossingError
        Rings cross; the message says where.

    See Also
    --------
    constrained_delaunay : Triangulations of points, edges and polygons.
    refine : Triangles of good angles and sizes.

    Examples
    --------
    >>> from shapely import Polygon
    >>> import liftmesh
    >>> liftmesh.triangulate_polygon(Polygon([(0, 0), (4, 0), (1, 1), (0, 4)]))[1]
    array([[0, 2, 3],
           [0, 1, 2]])
    """
    if not (engine is None or (isinstance(engine, str) and engine == "liftmesh")):
        raise refused("engine", engine, "not liftmesh: call trimesh.creation.triangulate_polygon")
    conforming = False
    if triangle_args is not None:
        quality, max_area, conforming = _read(triangle_args, quality, max_area)
    adds = quality is not None or max_area is not None or conforming
    if as_switch("force_vertices", force_vertices) and (adds or steiner is not None):
        raise InputError(
            f"{Option('force_vertices')} allows no vertices beside the polygon's: leave out "
            f"{Option('quality')}, {Option('max_area')}, {Option('steiner')} and the switches of "
            f"{Option('triangle_args')} that add some"
        )
    if polygon is None or getattr(polygon, "is_empty", False):
        return np.empty((0, 2)), np.empty((0, 3), dtype=np.int64)
    inside = np.empty((0, 2)) if steiner is None else as_pairs(steiner)
    tri = constrained_delaunay(inside, polygons=polygon, carve="holes")
    _check_inside(inside, tri)
    points, triangles = tri.points, tri.simplices
    if adds:
        refined = refine(
            tri, min_angle=quality, max_area=max_area, conforming=conforming
        ).triangulation
        points, triangles = refined.points, refined.simplices
    used = used_rows(len(points), triangles)
    if len(used) == len(points):
        return np.array(points), triangles.astype(np.int64)
    return points[used], np.searchsorted(used, triangles)  # without repeated points


def _read(
    switches: str, quality: float | None, max_area: float | None
) -> tuple[float | None, float | None, bool]:
    """Read Triangle's switches."""
    found = _SWITCHES.fullmatch(switches) if isinstance(switches, str) else None
    if found is None:
        raise refused("triangle_args", switches, "none of p, q, a and D with their numbers")
    if found["q"]:
        quality = float(found["angle"] or _ANGLE_OF_TRIANGLE)
    if found["area"]:
        max_area = float(found["area"])
    return quality, max_area, bool(found["D"])


def _check_inside(points: Floats, tri: Any) -> None:
    """Raise for points that no triangle has."""
    if not len(points):
        return
    is_outside = np.ones(len(points), dtype=np.bool_)
    used = np.unique(tri.simplices)
    is_outside[used[used < len(points)]] = False
    row, kept = tri.duplicates.T
    repeated = row < len(points)
    is_outside[row[repeated]] = is_outside[kept[repeated]]
    if is_outside.any():
        row = int(is_outside.argmax())
        raise InputError(
            f"{Option('steiner')}: row {row}, {tuple(points[row].tolist())}, is outside of the "
            f"polygon, as {counted(int(is_outside.sum()), 'row')} of {len(points):,} are"
        )
