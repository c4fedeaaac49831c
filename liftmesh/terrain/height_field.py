"""Whether a cloud is a height field, with one height at each position: terrain is, a statue is not.

Some four thousand rows are chosen and triangulated. One is *folded* if the heights at its position
and at its neighbours there differ by more than a tenth of the cloud's width, which is the side of a
square as large as the rectangle around them, and by more than a quarter of the range of all these
heights. A cloud of which more than half of them are folded is no height field: points above each
other are neighbours, and the triangulation jumps up and down between them.

Clouds that fill a volume are spared, as tree crowns and random numbers do, and those that are drawn
out to lines, as metres above degrees: they are no other surface, whose shape would be lost. The
dimension of a cloud follows from how much farther than the fourth neighbour in space the sixteenth
is: of surfaces it is 1.8 to 2, of volumes more than 2.3 (P. Grassberger and I. Procaccia, 1983).

The rule does not depend on scale nor on the number of rows, and the second condition spares heights
in another unit than x and y, as metres beside degrees. Of spheres, tubes, rooms and the walls of
buildings 56 to 99 % are folded; of airborne lidar with trees and roofs 0 to 12 %, of its ground at
most 1. A part of it that is less than some two and a half times as wide as its heights range, as a
plot in a wood, has up to 96 %, and is told unless it is spared as a volume: returns of crowns and
of the ground below are neighbours there, too.

Closed shapes that are thinner than a tenth of their width pass, as rough ground does. Where there
are faces, these tell more: those of a height field cover no place twice. A mesh whose faces have
more than one and a quarter of the area of the hull, seen from above, is none: closed shapes have up
to twice as much, whatever the order of their corners.

Rows are chosen by a hash of x and y, so it does not matter in which order they are, and all rows at
a position are chosen or none (D. E. Knuth, The Art of Computer Programming, volume 3, 6.4).
"""

from __future__ import annotations

import warnings
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats, Integers, Rows
from liftmesh.base.arrays import lower_to
from liftmesh.crs.description import parse_crs
from liftmesh.errors import DataWarning, DegenerateInputError, FormatError
from liftmesh.io.columns import checked_faces
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.points import as_complex, pieces

if TYPE_CHECKING:
    from liftmesh.terrain.surface_data import SurfaceData

LEAST, _CHOSEN = 1_000, 4_096  # rows
_OF_WIDTH, _OF_RANGE, _MOST = 0.1, 0.25, 0.5
_NEAR, _FAR, _OF_SURFACES = 4, 16, (1.4, 2.2)  # neighbours, and dimensions
_ASKED = 8  # every so many rows
_FACTOR = np.uint64(0x9E3779B97F4A7C15)  # 2^64 by the golden ratio
_PIECE, _AT_ONCE = 1 << 11, 2
_COVERED = 1.25
_REMEDY = (
    "A surface has one height at each position: take a part that is seen from one side, as the "
    "ground, give another plane, or use a program for closed meshes"
)


def warn_if_folded(surface: SurfaceData, faces: Rows | None, stacklevel: int) -> None:
    """Warn of a cloud that is no height field; in degrees, no height can be compared."""
    if faces is not None and (cover := _cover(surface, faces)) > _COVERED:
        warnings.warn(
            f"the cloud is no height field: seen from above, its faces have {cover:.2g} times the "
            f"area of its hull, so they overlap, as in closed objects. {_REMEDY}",
            DataWarning,
            stacklevel=stacklevel,
        )
        return
    system = parse_crs(surface.crs)
    if system is not None and system.kind == "geographic":
        return
    planar = surface.triangulation.points
    rows = chosen(planar)
    share, count = folded_share(planar[rows], surface.frame.heights(surface.vertices[rows]))
    if share > _MOST:
        warnings.warn(
            f"the cloud is no height field: at {100 * share:.0f} % of {count:,} rows the heights "
            "of neighbours differ by more than a tenth of its width, as in scans of closed "
            f"objects, rooms or walls, or of a few trees. {_REMEDY}",
            DataWarning,
            stacklevel=stacklevel,
        )


def _cover(surface: SurfaceData, faces: Rows) -> float:
    """Return the area of faces in the plane as a multiple of that of the hull."""
    points, hull = surface.triangulation.points, surface.triangulation.convex_hull
    exponent = int(np.frexp(np.abs(points[hull]).max())[1])
    fan = np.stack([np.full(len(hull) - 2, hull[0]), hull[1:-1], hull[2:]], axis=1)
    areas = []
    with suppress(FormatError), np.errstate(invalid="ignore"):
        faces = checked_faces(faces, len(points), "the mesh")
        places = as_complex(np.ldexp(points, -exponent))
        for some in (fan, *(faces[piece] for piece in pieces(len(faces)))):
            a, b, c = places[some.T]
            areas.append(np.nansum(np.abs(((b - a).conj() * (c - a)).imag)))
    return float(sum(areas[1:]) / areas[0]) if areas else 0.0


def folded_share(planar: Floats, heights: Floats) -> tuple[float, int]:
    """Return which share of rows are folded, and how many these are; 0 for few rows."""
    is_finite = np.isfinite(planar).all(axis=1) & np.isfinite(heights)
    points, z = planar[is_finite], heights[is_finite]
    if len(planar) < LEAST or len(points) < LEAST // 2:
        return 0.0, 0
    try:
        tri = delaunay(points, threads=1)
    except DegenerateInputError:
        return 0.0, 0
    with np.errstate(over="ignore", invalid="ignore"):
        between = _between(tri.simplices, tri.duplicates, z)
        width = np.sqrt(np.ptp(points[:, 0])) * np.sqrt(np.ptp(points[:, 1]))
        are_folded = (between > _OF_WIDTH * width) & (between > _OF_RANGE * np.ptp(z))
        share = float(np.mean(are_folded))
    if share > _MOST:
        low, high = _OF_SURFACES
        share *= low < _dimension(np.column_stack([points, z])) < high
    return share, len(points)


def _dimension(points: Floats) -> float:
    """Estimate the dimension of what rows are spread over."""
    ordered = points[np.lexsort(points.T)]
    with np.errstate(over="ignore"):
        ordered /= np.ptp(ordered, axis=0).max()
    found: list[Floats] = []
    for start in range(0, len(ordered), _ASKED * _AT_ONCE):
        asked = ordered[start : start + _ASKED * _AT_ONCE : _ASKED]
        squares = sum(
            np.subtract.outer(one, all_) ** 2 for one, all_ in zip(asked.T, ordered.T, strict=True)
        )
        found.append(np.partition(squares, (_NEAR, _FAR), axis=1)[:, [_NEAR, _FAR]])
    distance = np.sqrt(np.concatenate(found))
    near, far = distance[distance[:, 0] > 0].T
    growth = np.log(far / near).mean() if len(near) else 0.0
    return float(np.log(_FAR / _NEAR) / growth) if growth > 0 else np.inf


def chosen(planar: Floats) -> Integers:
    """Choose rows by their coordinates."""
    if len(planar) <= _CHOSEN:
        return np.arange(len(planar))
    limit = np.uint64(int(_CHOSEN / len(planar) * 2**64))
    found = []
    for start in range(0, len(planar), _PIECE):
        x, y = (planar[start : start + _PIECE].T + 0.0).astype(np.float64).view(np.uint64)
        found.append(start + np.flatnonzero((x * _FACTOR ^ y) * _FACTOR < limit))
    return np.concatenate(found)


def _between(simplices: Rows, duplicates: Rows, z: Floats) -> Floats:
    """Return the range of heights at each row's position and around it."""
    row, kept = duplicates.T
    names = np.arange(len(z))
    names[row] = kept
    around = []
    for heights in (z, -z):
        least = heights.copy()
        lower_to(least, names, heights)
        a, b, c = (least[np.ascontiguousarray(corner, np.intp)] for corner in simplices.T)
        of_faces = np.minimum(np.minimum(a, b, out=a), c, out=a)
        del b, c
        for corner in simplices.T:
            lower_to(least, corner, of_faces)
        around.append(least)
    between: Floats = (-around[1] - around[0])[names]
    return between
