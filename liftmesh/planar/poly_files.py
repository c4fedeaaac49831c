"""Writer for Triangle's .poly files: points, edges, markers, and of a carved mesh points in holes.

Triangle removes the region around each such point, up to the segments, and what can be reached from
outside; with its option -c it keeps the latter. So a carved mesh needs a point in each region that
edges enclose and whose triangles are missing, unless one is stated; and in those at the convex hull
only if others there are left, as then -c has to be given. The point is a centroid that exact
predicates find strictly inside of its triangle, of the largest one where it is rounded least.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Floats, Integers, Mask
from liftmesh.base.arrays import triangles_of_faces
from liftmesh.errors import FormatError, InputError
from liftmesh.io.columns import edges_of
from liftmesh.io.formats.triangle_files import HOLES, REGIONS, write_numbered, write_points
from liftmesh.io.metadata import CARVED
from liftmesh.io.tags import stated_markers
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation

_NONE = np.empty((0, 2))


def write_poly(stream: BinaryIO, cloud: Cloud) -> frozenset[str]:
    """Write points, edges, holes, and the regions that the metadata state.

    Returns the names of the holes of a mesh whose edges do not make its triangles.
    """
    stated, made = _stated(cloud, HOLES, 2, 2), _made(cloud)
    holes = np.concatenate([stated, hole_points(made, stated)])
    regions = _stated(cloud, REGIONS, 3, 4)
    write_points(stream, cloud, 2)
    edges = edges_of(cloud)
    markers = stated_markers(cloud)
    stream.write(b"%d %d\n" % (len(edges), markers is not None))
    write_numbered(stream, [edges] if markers is None else [edges, markers])
    for rows in (holes, regions) if len(regions) else (holes,):
        stream.write(b"%d\n" % len(rows))
        write_numbered(stream, [rows])
    is_mesh = cloud.faces is not None and len(cloud.faces) and len(edges)
    lost = {"holes between faces"} if is_mesh and made is None else set()
    if CARVED in cloud.metadata and (lost or cloud.metadata[CARVED] is not True):
        lost.add(f"metadata {CARVED}")
    return frozenset(lost)


def _stated(cloud: Cloud, name: str, least: int, most: int) -> Floats:
    """Return an entry of the metadata as rows of numbers."""
    given: Any = cloud.metadata.get(name, ())
    try:
        rows = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        rows = np.full(1, np.nan)
    if not rows.size:
        return np.empty((0, least))
    if rows.ndim != 2 or not least <= rows.shape[1] <= most or not np.isfinite(rows).all():
        raise FormatError(
            f"metadata {name} are no rows of {least}{f' or {most}' * (most > least)} finite "
            "numbers, as .poly files hold them: correct or leave them out"
        )
    return rows


def _made(cloud: Cloud) -> tuple[ConstrainedTriangulation, Integers] | None:
    """Return what the edges of a mesh make, and which of it its faces are; None if others."""
    if cloud.faces is None or cloud.edges is None:
        return None
    try:
        tri = constrained_delaunay(cloud.points[:, :2], cloud.edges)
    except InputError:
        return None
    first = np.arange(len(cloud), dtype=np.int32)
    first[tri.duplicates[:, 0]] = tri.duplicates[:, 1]
    place = triangles_of_faces(tri.simplices, first[cloud.faces], len(cloud))
    return None if (place < 0).any() else (tri, place)


def hole_points(made: tuple[ConstrainedTriangulation, Integers] | None, stated: Floats) -> Floats:
    """Return a point in each hole of a mesh, (h, 2), but for those that have one already."""
    if made is None:
        return _NONE
    tri, place = made
    are_holes = _are_holes(tri, place)
    known = tri.find_simplex(stated)
    are_holes[tri.regions[known[known >= 0]]] = False
    holes = np.where(are_holes[tri.regions], tri.regions, -1)
    of_holes = np.flatnonzero(holes >= 0)
    corners = tri.points.take(tri.simplices[of_holes], axis=0)
    centers = (corners / 3).sum(axis=1)
    sizes = _sizes(corners, centers)
    order = np.lexsort((sizes, holes[of_holes]))
    largest = order[np.diff(holes[of_holes[order]], append=-1) != 0]
    if (sizes[largest] < 0).any():
        narrow = tri.simplices[of_holes[largest[sizes[largest].argmin()]]].tolist()
        raise FormatError(
            f"the hole at rows {narrow} is too narrow for a point that .poly files need: all "
            "centroids are rounded to its edges; give it more room, or write PLY"
        )
    points: Floats = centers[largest]
    return points


def _are_holes(tri: ConstrainedTriangulation, left: Integers) -> Mask:
    """Tell which regions are holes of the mesh that has these triangles left."""
    count = int(tri.regions.max()) + 1
    has_faces = np.bincount(tri.regions[left], minlength=count) > 0
    is_open = ((tri.neighbors < 0) & ~tri.is_constrained).any(axis=1)
    at_hull = np.bincount(tri.regions[is_open], minlength=count) > 0
    are_holes: Mask = ~has_faces & (~at_hull | (has_faces & at_hull).any())
    return are_holes


def _sizes(corners: Floats, centers: Floats) -> Floats:
    """Return about the areas of triangles; -1 where the centroid, rounded, is not inside."""
    a, b, c = corners.transpose(1, 0, 2)
    is_in = [orient2d(tail, head, centers) > 0 for tail, head in ((a, b), (b, c), (c, a))]
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        u, v = b - a, c - a
        areas = np.nan_to_num(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]))
    return np.where(np.all(is_in, axis=0), areas, -1.0)
