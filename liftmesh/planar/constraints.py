"""The constraints of a triangulation: edges, polylines and polygons as edges between rows.

Corners with coordinates become rows: the first row at exactly that position, or a new one after
those of the caller. Each side of a ring of a polygon says on which side the inside is: outer rings
have it on the left if they turn counter-clockwise, holes if they turn clockwise. The sign of the
area tells, by a filter with a bound of its error, or by integers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Number
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Indices, Integers, Mask, Reals, Rows
from liftmesh.base.arrays import MOST_ROWS, distinct, is_masked_array, starts_of_runs, widened
from liftmesh.base.options import counted, shown
from liftmesh.errors import InputError, Option
from liftmesh.vector.geojson import planar_corners
from liftmesh.vector.polygons import areas_in, lines_in

_BY_ROWS = "give whole numbers, the rows of points, counted from 0"
_MOST_EDGES = 2**31 - 1

Line = Array  # rows, or corners x, y


@dataclass(frozen=True, slots=True, eq=False)
class Constraints:
    """Input edges: those that the caller gave as such, of polylines, of polygons, in this order."""

    edges: Rows  # (k, 2)
    polyline: Rows  # of each edge; -1 for others
    polygon: Rows
    # (k, 2): of a side of an outer ring, and of a hole: 1 if it is on the left, -1 on the right
    winding: Rows
    bounds: Mask  # whether the edge bounds a region that `carve` removes or keeps
    added: Floats  # (a, 2): the positions of new rows

    def named(self, edge: int) -> str:
        """Name an edge in a message."""
        for kind, of_edge in (("polyline", self.polyline), ("polygon", self.polygon)):
            if of_edge[edge] >= 0:
                return f"edge {edge} (of {kind} {of_edge[edge]})"
        return f"edge {edge}"


def gather(points: Reals, edges: Any, polylines: Any, polygons: Any) -> Constraints:
    """Convert all constraints that the caller gives."""
    plain = _as_edges(edges, len(points))
    rows = len(points)
    lines = [_line(each, rows, f"polyline {k}", 2) for k, each in enumerate(_lines(polylines))]
    polygons, is_unsaid = _polygons(polygons)
    areas = [
        [_without_return(_line(ring, rows, f"a ring of polygon {k}", 3)) for ring in rings]
        for k, rings in enumerate(polygons)
    ]
    rings = [ring for area in areas for ring in area]
    corners, added = _as_rows(points, [*lines, *rings])
    tail, head, line = _sides(corners, len(lines))
    joined = np.concatenate([plain, np.stack([tail, head], axis=1)]).astype(np.int32)
    if len(joined) > _MOST_EDGES or len(points) + len(added) > MOST_ROWS:
        raise InputError(
            f"{len(joined):,} edges of {len(points) + len(added):,} rows are more than 32-bit "
            "numbers allow: leave some out"
        )
    count, of_area = len(plain), np.repeat(np.arange(len(areas)), [len(each) for each in areas])
    polyline, polygon = np.full((2, len(joined)), -1, dtype=np.int32)
    is_ring = line >= len(lines)
    polyline[count:] = np.where(is_ring, -1, line)
    polygon[count:][is_ring] = of_area[line[is_ring] - len(lines)]
    winding = np.zeros((len(joined), 2), dtype=np.int32)
    if not is_unsaid:  # else the parity tells
        of_rings = _windings(points, added, corners[len(lines) :], areas)
        winding[count:][is_ring] = of_rings[line[is_ring] - len(lines)]
    bounds = polygon >= 0
    if not areas:
        is_closed = _are_closed(points, corners)
        bounds[:count] = True
        bounds[count:] = False if count else is_closed[line]
    return Constraints(joined, polyline, polygon, winding, bounds, added)


def _as_edges(edges: Any, rows: int) -> Rows:
    """Convert the option ``edges``."""
    if edges is None:
        return np.empty((0, 2), dtype=np.int32)
    try:
        array = np.asanyarray(edges)
    except ValueError as error:
        raise InputError(f"{Option('edges')} cannot be converted to an array: {error}") from error
    if not array.ndim:
        raise InputError(f"{Option('edges')} are {shown(edges)}: give an array (k, 2) of rows")
    if array.size == 0 and array.ndim < 3:
        return np.empty((0, 2), dtype=np.int32)
    if array.ndim != 2 or array.shape[1] != 2:
        hint = "edges.T" if array.ndim == 2 and len(array) == 2 else "two rows for each edge"
        raise InputError(
            f"{Option('edges')} have the shape {array.shape}, not (k, 2): give {hint}; for chains "
            f"of rows, and for coordinates, there is {Option('polylines', ...)}"
        )
    if is_masked_array(array) or array.dtype.kind not in "iu":
        raise InputError(
            f"{Option('edges')} hold {'masked' if is_masked_array(array) else array.dtype} values "
            f"(edge 0: {array[0].tolist()}): {_BY_ROWS}; for coordinates there is "
            f"{Option('polylines', ...)}"
        )
    _check_rows(array, rows, "edge")
    return np.ascontiguousarray(array, dtype=np.int32)


def _check_rows(array: Array, rows: int, name: str) -> None:
    """Raise if a row is out of range, naming the first."""
    wrong = (array < 0) | (array >= rows)
    if not wrong.any():
        return
    row = array[wrong][0]
    if array.ndim == 2:
        of_edge = wrong.any(axis=1)
        place, others = int(of_edge.argmax()), np.count_nonzero(of_edge) - 1
        name += f" {place}, {array[place].tolist()},"
        name += f" (and {counted(others, 'other')})" if others else ""
    remedy = "leave it out, or add the point"
    if row < 0:
        remedy = "negative numbers do not count from the end"
    elif row == rows and array.min() > 0:
        remedy = "if yours count from 1, subtract 1"
    possible = f"where 0 to {rows - 1} are possible" if rows else "and there are no points"
    raise InputError(f"{name} has the row {row}, {possible}: {remedy}")


def _line(given: Any, rows: int, name: str, fewest: int) -> Line:
    """Convert a chain of rows, or of corners."""
    if is_masked_array(given):
        raise InputError(f"{name} is a masked array: give one without masked entries")
    try:
        array = np.asarray(given)
    except ValueError as error:
        raise InputError(f"{name} cannot be converted to an array: {error}") from error
    if array.ndim != 1:
        return planar_corners(given, name, name, fewest)
    if array.dtype.kind not in "iu":
        raise InputError(f"{name} is {shown(given)}: {_BY_ROWS}, or corners as (n, 2) coordinates")
    if len(array) < fewest:
        raise InputError(f"{name} is {shown(given)}: give {fewest} rows or more")
    _check_rows(array, rows, name)
    return array


def _without_return(ring: Line) -> Line:
    """Leave out the last corner of a ring if it repeats the first."""
    return ring[:-1] if ring[0].tolist() == ring[-1].tolist() else ring


def _lines(given: Any) -> list[Any]:
    """Tell polylines apart: each is a chain of rows, or of coordinates."""
    if given is None:
        return []
    shapes = lines_in(given)
    if shapes is not None:
        return list(shapes)
    items = _items("polylines", given)
    if _is_chain(items):
        return [given]
    if _are_integers(items, 2, fewest=2):
        raise InputError(
            f"{Option('polylines')} are {shown(given)}, pairs of integers, which may be rows or "
            f"corners: give edges between rows as {Option('edges', ...)}, and corners as floats"
        )
    _check_triples("polylines", given, fewest=2)
    lines: list[Any] = []
    for each in items:
        shapes = lines_in(each)
        lines += [each] if shapes is None else shapes
    return lines


def _polygons(given: Any) -> tuple[list[Sequence[Any]], bool]:
    """Tell polygons apart: each is a list of rings, of which the first is the outer one.

    Or rings of which nothing says whether they are holes, and True.
    """
    if given is None:
        return [], False
    shapes = areas_in(given)
    if shapes is not None:
        return list(shapes[0]), shapes[1]
    items = _items("polygons", given)
    if _is_chain(items) or (len(items) and _is_corner(items[0]) and len(items[0]) == 2):
        return [[given]], False
    _check_triples("polygons", given, fewest=3)
    polygons: list[Sequence[Any]] = []
    is_unsaid = False
    for each in items:
        shapes = areas_in(each)
        if shapes is not None:
            polygons += shapes[0]
            is_unsaid |= shapes[1]
        elif not len(rings := _items("polygons", each)):
            raise InputError(f"polygon {len(polygons)} is {shown(each)}, without a ring")
        else:
            polygons.append([each] if _is_ring(each, len(polygons)) else rings)
    return polygons, is_unsaid


def _items(name: str, given: Any) -> Sequence[Any]:
    if isinstance(given, list | tuple) or (isinstance(given, np.ndarray) and given.ndim):
        return given  # type: ignore[return-value]
    raise InputError(
        f"{Option(name)} are {shown(given)}: give a list of {name}, each as rows or as coordinates "
        "(n, 2); geometries of shapely, a GeoDataFrame, or the path of a file"
    )


def _is_chain(items: Sequence[Any]) -> bool:
    """Whether this is one chain: rows, or corners whose coordinates are floats."""
    if not len(items):
        return False
    first = items[0]
    if isinstance(first, Number):
        return True
    return _is_corner(first) and any(isinstance(each, float | np.floating) for each in first)


def _is_corner(given: Any) -> bool:
    is_flat = isinstance(given, list | tuple | np.ndarray) and len(given) in (2, 3)
    return is_flat and all(isinstance(each, Number) for each in given)


def _are_integers(items: Sequence[Any], count: int, fewest: int) -> bool:
    """Whether these are some pairs or triples of integers."""
    return len(items) >= fewest and all(
        isinstance(item, list | tuple | np.ndarray)
        and len(item) == count
        and all(isinstance(each, int | np.integer) for each in item)
        for item in items
    )


def _check_triples(name: str, given: Sequence[Any], fewest: int) -> None:
    """Raise if these may be rows or corners; in a list, arrays of integers are rows."""
    is_list = isinstance(given, list | tuple)
    are_arrays = is_list and any(isinstance(each, np.ndarray) for each in given)
    if not are_arrays and _are_integers(given, 3, fewest):
        raise InputError(
            f"{Option(name)} are {shown(given)}, triples of integers, which may be rows or corners "
            "x, y, z: give a list of arrays of rows, or corners as floats"
        )


def _is_ring(given: Any, polygon: int) -> bool:
    """Whether a polygon is one ring: an array, rows, or corners; not a list of rings."""
    if isinstance(given, np.ndarray) or _is_chain(given):
        return True
    first = given[0]
    if not _is_corner(first) or isinstance(first, np.ndarray):
        return False
    if len(first) == 3 and len(given) > 2 and all(map(_is_corner, given)):
        raise InputError(
            f"polygon {polygon} is {shown(given)}, rings of three rows or corners x, y, z: give "
            "each ring of rows as an array, or corners as one array"
        )
    return len(first) == 2


def _as_rows(points: Reals, lines: Sequence[Line]) -> tuple[list[Rows], Floats]:
    """Return the rows of all lines, and the positions of new rows."""
    placed = [k for k, line in enumerate(lines) if line.ndim == 2]
    rows = list(lines)
    if not placed:
        return rows, np.empty((0, 2))
    corners = np.concatenate([lines[k] for k in placed])
    found, added = match_rows(widened(points), corners)
    ends = np.cumsum([len(lines[k]) for k in placed])
    for k, part in zip(placed, np.split(found, ends[:-1]), strict=True):
        rows[k] = part
    return rows, corners[added]


def match_rows(points: Floats, corners: Floats) -> tuple[Integers, Indices]:
    """Return the row at each position: the first there, or a new one; and whose those are."""
    x = distinct(corners[:, 0]) if len(points) else points[:, 0]
    place = np.minimum(np.searchsorted(x, points[:, 0]), len(x) - 1)
    near = np.flatnonzero(x[place] == points[:, 0]) if len(x) else np.empty(0, dtype=np.intp)
    both = np.concatenate([points[near], corners]) + 0.0  # no -0.0
    order = np.lexsort(both.T[::-1])
    starts = starts_of_runs(both[order])
    first = np.empty(len(both), dtype=np.intp)
    first[order] = order[starts][np.cumsum(starts) - 1]
    leader = first[len(near) :] - len(near)  # negative: a row
    added = distinct(leader[leader >= 0])
    rows = len(points) + np.searchsorted(added, leader)
    is_row = leader < 0
    rows[is_row] = near[leader[is_row] + len(near)]
    return rows, added


def _sides(lines: Sequence[Rows], open_lines: int) -> tuple[Integers, Integers, Integers]:
    """Return tail, head and line of all edges along lines, of which those after some are rings."""
    if not lines:
        return (np.empty(0, dtype=np.int64),) * 3
    lengths = np.array([len(each) for each in lines])
    ends = np.cumsum(lengths)
    tail = np.concatenate(lines).astype(np.int64)
    head = np.roll(tail, -1)
    head[ends - 1] = tail[ends - lengths]
    has_side = np.ones(len(tail), dtype=np.bool_)
    has_side[ends[:open_lines] - 1] = False
    return tail[has_side], head[has_side], np.repeat(np.arange(len(lines)), lengths)[has_side]


def _are_closed(points: Reals, lines: Sequence[Rows]) -> Mask:
    """Tell which lines end where they begin; each new row has a position of its own."""
    tail, head = np.array([(line[0], line[-1]) for line in lines], np.int64).reshape(-1, 2).T
    are_closed: Mask = tail == head
    old = np.flatnonzero(np.maximum(tail, head) < len(points))
    are_closed[old] |= (points[tail[old]] == points[head[old]]).all(axis=1)
    return are_closed


def _windings(
    points: Reals, added: Floats, rings: Sequence[Rows], areas: Sequence[Sequence[Line]]
) -> Rows:
    """Tell for each ring, as an outer one and as a hole, on which side its inside is."""
    if not rings:
        return np.empty((0, 2), dtype=np.int32)
    rows = np.concatenate(rings).astype(np.int64)
    is_new = rows >= len(points)
    corners = np.empty((len(rows), 2))
    corners[~is_new], corners[is_new] = points[rows[~is_new]], added[rows[is_new] - len(points)]
    starts = np.concatenate([[0], np.cumsum([len(each) for each in rings])])
    is_hole = np.array([k > 0 for area in areas for k in range(len(area))])
    kinds = np.stack([~is_hole, is_hole], axis=1)
    return np.where(kinds, turns(corners, starts)[:, None], np.int32(0))


def turns(corners: Floats, starts: Integers) -> Rows:
    """Return -1 for rings that turn clockwise, 1 for others, also for loops that cancel out."""
    count = np.diff(starts)
    of_ring = np.repeat(np.arange(len(count)), count)
    if not np.isfinite(corners).all():
        return np.zeros(len(count), dtype=np.int32)  # of rows that are not finite: an error later
    exponent = np.frexp(np.maximum.reduceat(np.abs(corners).max(axis=1), starts[:-1]))[1]
    scaled = np.ldexp(corners, -exponent[of_ring][:, None])
    x, y = (scaled - scaled[starts[:-1]][of_ring]).T
    ahead = np.arange(1, len(x) + 1)
    ahead[starts[1:] - 1] = starts[:-1]
    products = x * y[ahead], y * x[ahead]
    area = np.bincount(of_ring, products[0] - products[1])
    size = np.bincount(of_ring, np.abs(products[0]) + np.abs(products[1]))
    # Each difference and product is rounded once, and each sum as often as there are terms; what
    # underflows is less than 2^-1000.
    length = np.bincount(of_ring, np.abs(x) + np.abs(y))
    doubt = (count + 8) * 2.0**-52 * size + 2.0**-1000 * (length + count)
    turns = np.sign(area).astype(np.int32)
    for ring in np.flatnonzero(~(np.abs(area) > doubt)).tolist():
        turns[ring] = _exact_turn(corners[starts[ring] : starts[ring + 1]]) or 1
    return turns


def _exact_turn(ring: Floats) -> int:
    corners = [(Fraction(x), Fraction(y)) for x, y in ring.tolist()]
    following = [*corners[1:], corners[0]]
    area = sum(
        (a * d - b * c for (a, b), (c, d) in zip(corners, following, strict=True)), Fraction()
    )
    return (area > 0) - (area < 0)
