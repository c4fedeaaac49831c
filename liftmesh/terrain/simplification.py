"""`simplify`: a surface of few triangles that keeps within a distance of every point.

The kernel chooses the vertices. The surface is triangulated of these alone, so it is the canonical
one of its points, and `deviation` checks how far every position is from it along its normal, by
arithmetic of its own.

What lines have become stays: their edges are constraints of the kernel's triangulation, whose ends
are never removed, and of the simplified one. So are the sides between faces and what is left out,
which keep both apart: what is left out has no positions that count, but for the ends of edges.

The height of the surface at a point is that of the plane of the triangle that contains it, found
exactly. The distance is computed in doubles by barycentric coordinates, with a bound on its error.
Where that leaves open whether it exceeds the bound that is asked for, integers of 64 bits decide,
and where these do not suffice rational numbers. None of it is shared with the engine that
simplifies.

With e = 2^-53, and d the doubled area of the triangle, which is a sum of two products of
differences: it is off by at most 4 e D, where D is the sum of the magnitudes. The doubled areas a
and b of the parts opposite two corners are off by 4 e A and 4 e B. So a / d is off by
(4 e A + |a / d| 4 e D) / (|d| - 4 e D) and two roundings. The distance
(z - z_c) - ((z_a - z_c) a / d + (z_b - z_c) b / d) has the errors of the two quotients times the
differences of heights, and six roundings. A factor of 2 covers terms of higher order, 1e-300
underflow.

As integers: differences from the corner c whose rounding error is 0, and the bound, are multiples
of a power of two. Let those along x and y be less than 2^p of one such step, heights and the bound
less than 2^h of another. Then a, b and d are less than 2^(2p+1), and each of the three products in
|(z - z_c) d - (z_a - z_c) a - (z_b - z_c) b| <= bound |d| is less than 2^(2p+h+1), so none of the
sums overflows if 2p + h <= 60. Rasters are such: neighbours are few steps apart, and often just as
far from the surface as permitted.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Progress, Rows
from liftmesh.base.arrays import ends_of, non_finite, pair_keys, used_rows
from liftmesh.base.options import (
    NonFinite,
    OnDuplicate,
    as_count,
    as_distance,
    as_switch,
    check_progress,
    part_of,
    refused,
)
from liftmesh.crs.comparison import given_text
from liftmesh.errors import InputError, Option
from liftmesh.io.columns import edges_of
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import read_for_surface
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation
from liftmesh.planar.delaunay import solve, triangulation_of
from liftmesh.planar.points import pieces
from liftmesh.planar.triangulation import Triangulation, check_unwritten
from liftmesh.terrain.boundary import masked
from liftmesh.terrain.report import report_on
from liftmesh.terrain.surface import Surface
from liftmesh.terrain.surface_data import positions_of
from liftmesh.terrain.triangulate import as_surface, triangulate

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.options import ReadOptions

_DONE_AFTER = {"triangulate": 0.1, "choose": 0.75, "check": 1.0}
_E = 2.0**-53
_PIECE = 2**17  # points that are located in one call: their order makes the way to each short
_CACHED = 2**13  # points whose numbers fit the cache
_MOST_BITS = 60  # of a product of three differences
_LARGE = 2**12  # more than exponents


def simplify(  # noqa: PLR0913 - options are keywords
    cloud: object,
    *,
    max_error: float | None = None,
    max_points: int | None = None,
    prune: bool = True,
    crs: Any = None,
    plane: Literal["xy", "xz", "yz", "fit"] | ArrayLike = "xy",
    on_duplicate: OnDuplicate = "first",
    nonfinite: NonFinite = "error",
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Unpack[ReadOptions],
) -> Surface:
    """Approximate a terrain by few triangles, within a vertical distance of every point.

    Parameters
    ----------
    cloud : path, Cloud, Surface or object
        Anything that `triangulate` takes, as a raster of heights; or a `Surface`. One that follows
        lines keeps them: their edges, and with these all their vertices, also in the middle of
        straight lines, since how far a line may be moved has no bound. So does a mesh that states
        edges, as `Surface.save` writes them.
        Where faces are left out, as in holes or of a surface that was trimmed, the sides around
        them stay in the same way: simplify first, then trim, if that are too many.
    max_error : float, optional
        The vertical distance, in the units of the heights, that no position exceeds: exactly, not
        within rounding. 0 leaves out what lies on the planes of the others.
    max_points : int, optional
        The most vertices. Without `max_error`, as many are taken, or as few as lose nothing.
    prune : bool, default True
        Whether vertices are removed again that the distance does not need. On rasters this takes
        7 to 25 times as long as the choice of vertices. Few go where nearly every position counts.
    crs : str, int or CRS, optional
        As for `triangulate`.
    plane, on_duplicate, nonfinite
        As for `triangulate`; not for a `Surface`, or faces with edges, which have them already.
    threads : int, optional
        Of the triangulations, as for `triangulate`; vertices are chosen on one. The surface is the
        same for any number.
    progress : callable, optional
        As for `triangulate`.
    **options
        As for `triangulate`: those of `read`, of a file.

    Returns
    -------
    Surface
        The rows that are left, in their order, with their colours, normals and named values, and
        the canonical Delaunay triangles of these, or with edges the constrained ones, without those
        that were left out. ``metadata["simplification"]`` counts "n_rows" of the cloud,
        "n_positions", which are distinct and of faces or edges, and "n_kept" of these; it has
        "max_error" as asked for, "error", which no distance of a position exceeds, whether it is
        "within" `max_error`, and "merged": the largest distance of a row from the one that stands
        for its position.

    Raises
    ------
    InputError
        Neither `max_error` nor `max_points` is given, or one is invalid; there are fewer
        `max_points` than corners of the hull and vertices of lines; the surface has weights, radii
        or a metric; or a mesh with edges is refused by `as_surface`.
    NonFiniteError, DuplicateHeightError, DegenerateInputError, UnsupportedTypeError, FormatError
        As for `triangulate`.

    See Also
    --------
    thin : Fewer rows without a bound.
    triangulate : A surface of all rows.

    Notes
    -----
    Greedy insertion: M. Garland and P. S. Heckbert, "Fast polygonal approximation of terrains and
    height fields", 1995. From the corners of the hull, and the edges, on, the position with the
    largest distance, of several the lexicographically least, becomes a vertex, until none is beyond
    `max_error`. Then vertices are removed, one after the other the one without which distances grow
    least, as long as none is beyond it. What is left is exchanged, vertex by vertex, for the worst
    of the other positions that the removal of the vertex leaves, if none is beyond it then, and
    neighbours are removed that are not needed any longer. The worst position of each triangle
    becomes a vertex if then others can go, one by one or two at once; all this again, as long as it
    removes one in twenty. The result depends on the positions alone, not on the order of rows.

    Where heights and `max_error` are multiples of one step, as whole numbers, many positions of a
    raster may be at the bound exactly but for the rounding of the centres of its pixels to
    coordinates of the map, which puts them beyond it by as little as 1e-10. They count as beyond
    it. A bound that is greater by a millionth leaves up to a tenth of the triangles out.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = (each.ravel() for each in np.meshgrid(np.arange(9.0), np.arange(9.0)))
    >>> ridge = simplify(np.column_stack([x, y, -abs(x - 4)]), max_error=0.0)
    >>> len(ridge.vertices), ridge.metadata["simplification"]["error"]
    (6, 0.0)

    A surface keeps its lines:

    >>> import liftmesh
    >>> road = liftmesh.triangulate(ridge.vertices, breaklines=[[0, 2, 0], [5, 3, 0], [8, 7, 0]])
    >>> simplify(road, max_error=9.0).triangulation.constraints.shape
    (2, 2)
    """
    bound, most = _limits(max_error, max_points)
    prunes = as_switch("prune", prune)
    check_progress(progress)
    start = time.perf_counter()
    given: Any = {"plane": plane, "on_duplicate": on_duplicate, "nonfinite": nonfinite}
    given["threads"] = threads
    source = _source(cloud, given_text(crs), options)
    whole = _whole(source, given, part_of(progress, 0.0, _DONE_AFTER["triangulate"]))
    _check_member(whole)
    check_unwritten(whole.triangulation)
    heights = whole.frame.heights(whole.vertices)
    used, positions, hull, edges = _problem(whole, threads)
    between = part_of(progress, _DONE_AFTER["triangulate"], _DONE_AFTER["choose"])
    altitudes = np.ascontiguousarray(heights[used], np.float64) + 0.0
    if len(wrong := used[~np.isfinite(altitudes)]):
        raise non_finite(wrong[0], whole.vertices[wrong[0]], skippable=False)
    chosen = _kernel.simplify(positions, altitudes, hull, edges, bound, most, prunes, between)
    kept, is_within = np.sort(used[chosen[0]]), chosen[1]
    _check_count(len(kept), most, has_edges=len(edges) > 0)
    simplified = _surface(whole, kept, used[edges], start, threads)
    rest = part_of(progress, _DONE_AFTER["choose"], _DONE_AFTER["check"])
    checked = deviation(simplified.triangulation, heights[kept], positions, altitudes, bound, rest)
    _check_bound(checked, bound, is_within)
    summary = {
        "n_rows": len(whole.vertices),
        "n_positions": len(used),
        "n_kept": len(kept),
        "max_error": max_error,
        "error": checked.largest,
        "within": is_within,
        "merged": merged_deviation(heights, whole.report.left_out, whole.report.representatives),
    }
    return replace(simplified, metadata={**whole.metadata, "simplification": summary})


def _limits(max_error: object, max_points: object) -> tuple[float, int]:
    if max_error is None and max_points is None:
        raise InputError(
            f"neither {Option('max_error')} nor {Option('max_points')} is given: give one of them, "
            "or both"
        )
    bound = 0.0
    if max_error is not None:
        bound = as_distance("max_error", max_error, "a distance, in the units of heights")
    most = 0 if max_points is None else as_count("max_points", max_points, 3)
    return bound, min(most, _kernel.MOST_ROWS)


def _source(cloud: object, crs: str | None, options: ReadOptions) -> Surface | Cloud:
    """Return a surface, or the rows that are to be one, in a given system."""
    source: Surface | Cloud
    if isinstance(cloud, Surface) and all(each is None for each in options.values()):
        source = cloud
    else:
        source = read_for_surface(cloud, **options)
    return source if crs is None else replace(source, crs=crs)


def _whole(source: Surface | Cloud, given: dict[str, Any], progress: Progress | None) -> Surface:
    """Return the surface that is to be simplified."""
    if isinstance(source, Surface):
        return source
    as_it_is: Any = {"plane": given["plane"], "threads": given["threads"]}
    faces = 0 if source.faces is None else len(source.faces)
    if faces and len(edges_of(source)):
        return as_surface(source, **as_it_is)
    whole = triangulate(source, **given, progress=progress)
    return (_part(source, as_it_is) if 0 < faces < len(whole.faces) else None) or whole


def _part(mesh: Cloud, options: dict[str, Any]) -> Surface | None:
    """Return the surface of a mesh that may have been trimmed; None if its faces are others."""
    try:
        found = as_surface(mesh, **options)
    except InputError:
        return None
    is_other = isinstance(found.triangulation, ConstrainedTriangulation)
    return None if is_other or Provenance(mesh.metadata).lifted_by else found


def _check_member(surface: Surface) -> None:
    tri = surface.triangulation
    if hasattr(tri, "hidden") or tri.metric is not None:
        raise InputError(
            "the surface has weights, radii or a metric: a simplified one is a Delaunay "
            "triangulation; triangulate its vertices without them"
        )


def _problem(whole: Surface, threads: int | None) -> tuple[Rows, Floats, Rows, Rows]:
    """Return the rows that count, their positions, and the hull and the edges that they have."""
    used, positions, hull = positions_of(whole)
    edges = _edges(whole)
    if whole.mask is not None:
        used = used_rows(len(whole.vertices), np.concatenate([whole.faces.ravel(), edges.ravel()]))
        positions = np.ascontiguousarray(whole.triangulation.points[used], np.float64) + 0.0
        hull = solve(positions, threads=threads).hull
    return used, positions, hull, np.searchsorted(used, edges).astype(np.int32)


def _edges(surface: Surface) -> Rows:
    """Return the edges that lines are, and the sides between faces and what is left out."""
    tri, mask = surface.triangulation, surface.mask
    edges: Rows = getattr(tri, "constraints", np.empty((0, 2), np.int32))
    if mask is None:
        return edges
    is_rim = ~mask[:, None] & mask[tri.neighbors] & (tri.neighbors >= 0)
    return np.unique(np.concatenate([edges, ends_of(tri.simplices, *np.nonzero(is_rim))]), axis=0)


def _sides(simplices: Rows) -> Rows:
    """Return the side opposite each corner, (m, 3, 2), from one end to the other."""
    return np.stack([np.roll(simplices, -1, axis=1), np.roll(simplices, 1, axis=1)], axis=-1)


def _left_out(whole: Surface, tri: ConstrainedTriangulation, kept: Rows) -> Array:
    """Tell which triangles are left out: in regions at whose edges the whole has no faces."""
    triangles, k = np.nonzero(tri.is_constrained)
    known = pair_keys(*_sides(whole.faces).reshape(-1, 2).T)
    found = pair_keys(*kept[_sides(tri.simplices)[triangles, k]].T)
    is_of_face = np.isin(found, known, assume_unique=True)  # no side is of two faces
    is_shown = np.zeros(tri.nsimplex, np.bool_)  # of regions
    is_shown[tri.regions[triangles[is_of_face]]] = True
    return ~is_shown[tri.regions]


def _check_bound(checked: Deviation, bound: float, is_within: bool) -> None:
    if is_within and checked.beyond:
        raise AssertionError(f"{checked.beyond} positions are beyond {bound}: a bug of liftmesh")


def _check_count(least: int, most: int, *, has_edges: bool) -> None:
    if most and least > most:
        reason = f"and the hull has {least} corners: give more"
        if has_edges:
            reason = f"and the hull and edges have {least} vertices, which stay: give more"
        raise refused("max_points", most, reason, mark=", ")


def _surface(whole: Surface, kept: Rows, edges: Rows, start: float, threads: int | None) -> Surface:
    """Triangulate the rows that stay; their order and their coordinates are those of the whole."""
    cloud = whole.to_cloud().select(kept)
    points = whole.triangulation.points[kept]
    triangulation = (
        constrained_delaunay(points, np.searchsorted(kept, edges), threads=threads)
        if len(edges)
        else triangulation_of(solve(points, threads=threads))
    )
    nothing = np.empty(0, np.int32)
    report = report_on(
        cloud,
        n_used=len(kept),
        n_duplicates=0,
        n_overhangs=0,
        n_skipped=0,
        n_triangles=triangulation.nsimplex,
        policy=whole.report.policy,
        seconds={**whole.report.seconds, "simplify": time.perf_counter() - start},
        left_out=nothing,
        representatives=nothing,
        columns=whole.report.columns,
        color_depth=whole.report.color_depth,
    )
    simplified = Surface(
        vertices=cloud.points,
        faces=triangulation.simplices,
        triangulation=triangulation,
        frame=whole.frame,
        report=report,
        colors=cloud.colors,
        normals=cloud.normals,
        attributes=cloud.attributes,
        metadata=whole.metadata,
        crs=whole.crs,
    )
    if isinstance(triangulation, ConstrainedTriangulation):
        return _with_lines(simplified, whole, kept)
    return simplified


def _with_lines(simplified: Surface, whole: Surface, kept: Rows) -> Surface:
    """Leave out the triangles that are no faces of the whole, and count what lines are."""
    tri: Any = simplified.triangulation
    if whole.mask is not None:
        simplified = masked(simplified, _left_out(whole, tri, kept))
    lines = whole.report.lines
    if lines:
        from liftmesh.terrain.breaklines import line_counts  # noqa: PLC0415 - for lines only

        first = np.searchsorted(kept, len(whole.vertices) - lines["rows"])
        unchanged = {key: lines[key] for key in ("edges", "rows_at_crossings", "lines_beyond")}
        lines = {**line_counts(simplified, int(first)), **unchanged}
    report = replace(simplified.report, n_triangles=len(simplified.faces), lines=lines)
    return replace(simplified, report=report)


@dataclass(frozen=True, slots=True)
class Deviation:
    """The largest distance of points from a surface."""

    largest: float  # not less than the largest distance
    beyond: int  # how many points are farther than the bound, exactly


def deviation(
    triangulation: Triangulation,  # covers the points
    heights: Floats,  # of its rows
    points: Floats,
    z: Floats,  # of the points
    bound: float,
    progress: Progress | None = None,
) -> Deviation:
    """Compare points with a surface."""
    largest, beyond = 0.0, 0
    corners = np.column_stack([triangulation.points, heights])
    for part in pieces(len(points), _PIECE):
        rows = triangulation.simplices[triangulation.find_simplex(points[part])]
        sample = np.column_stack([points[part], z[part]])
        for few in pieces(len(sample), _CACHED):
            worst = _compared(corners[rows[few]], sample[few], bound)
            largest, beyond = max(largest, worst.largest), beyond + worst.beyond
        if progress is not None:
            progress(min(part.stop / len(points), 1.0))
    return Deviation(float(largest), beyond)


def _compared(corners: Array, sample: Floats, bound: float) -> Deviation:
    """Compare samples with the planes of their triangles."""
    with np.errstate(all="ignore"):
        distance, error = _distances(corners, sample)
        upper = distance + error
        is_beyond = distance - error > bound
        is_open = ~((upper <= bound) | is_beyond)
        if not is_open.any():
            return Deviation(float(upper.max(initial=0.0)), int(np.count_nonzero(is_beyond)))
        opened = np.flatnonzero(is_open)
        is_corner = _is_corner(corners[opened], sample[opened])
        upper[opened[is_corner]] = 0
        # Those whose error is unknown are left to rationals: `bound` would say nothing of them.
        is_known = np.isfinite(upper[opened])
        is_within = is_corner | (is_known & _within(corners[opened], sample[opened], bound))
    upper[opened[is_within]] = np.minimum(upper[opened[is_within]], bound)
    left = opened[~is_within]
    exact = list(_exactly(corners[left], sample[left]))
    upper[left] = [_upwards(each) for each in exact]
    beyond = np.count_nonzero(is_beyond) + sum(each > Fraction(bound) for each in exact)
    return Deviation(float(upper.max()), int(beyond))


def _is_corner(corners: Array, sample: Floats) -> Array:
    is_corner: Array = (corners == sample[:, None]).all(axis=2).any(axis=1)
    return is_corner


def _within(corners: Array, sample: Floats, bound: float) -> Array:
    """Whether samples are within the bound, by integers; False where these do not suffice."""
    a, b, c = np.moveaxis(corners, 1, 0)
    numbers = np.stack([a, b, sample]).transpose(0, 2, 1)
    apart, is_exact = _difference(numbers, c.T)
    given = np.full_like(apart[0, :1], bound)
    x_y, planar_bits = _in_steps(apart[:, :2].reshape(6, -1))
    heights, height_bits = _in_steps(np.concatenate([apart[:, 2], given]))
    is_exact &= 2 * planar_bits + height_bits <= _MOST_BITS
    (ax, ay), (bx, by), (x, y) = np.where(is_exact, x_y, 0).astype(np.int64).reshape(3, 2, -1)
    to_a, to_b, rise, most = np.where(is_exact, heights, 0).astype(np.int64)
    whole = ax * by - ay * bx
    excess = rise * whole - to_a * (x * by - y * bx) - to_b * (ax * y - ay * x)
    is_within: Array = is_exact & (np.abs(excess) <= most * np.abs(whole))
    return is_within


def _difference(numbers: Floats, less: Floats) -> tuple[Floats, Array]:
    """Subtract; and whether no difference of a sample is rounded (D. E. Knuth's TwoSum)."""
    difference = numbers - less
    back = difference - numbers
    error = (numbers - (difference - back)) + (-less - back)
    return difference, (error == 0).all(axis=(0, 1))


def _in_steps(values: Floats) -> tuple[Floats, Array]:
    """Divide columns by the largest power of two of which all values are multiples."""
    mantissa, exponent = np.frexp(values)
    digits = np.ldexp(mantissa, 53).astype(np.int64)
    lowest = np.frexp((digits & -digits).astype(np.float64))[1] - 54 + exponent
    is_zero = values == 0
    step = np.where(is_zero, _LARGE, lowest).min(axis=0)
    bits = np.where(is_zero, -_LARGE, exponent).max(axis=0) - step
    return np.ldexp(values, -step), bits


def _distances(corners: Array, sample: Floats) -> tuple[Floats, Floats]:
    """Compute distances, and a bound on the error of each."""
    a, b, c = np.moveaxis(corners, 1, 0)
    whole, of_whole = _doubled_area(a - c, b - c)
    first, of_first = _doubled_area(sample - c, b - c)
    second, of_second = _doubled_area(a - c, sample - c)
    u, v = first / whole, second / whole
    rise = sample[:, 2] - c[:, 2]
    to_a, to_b = a[:, 2] - c[:, 2], b[:, 2] - c[:, 2]
    distance = np.abs(rise - (to_a * u + to_b * v))
    sure = np.abs(whole) - of_whole
    of_u = (of_first + np.abs(u) * of_whole) / sure + 4 * _E * np.abs(u)
    of_v = (of_second + np.abs(v) * of_whole) / sure + 4 * _E * np.abs(v)
    rounding = 8 * _E * (np.abs(rise) + np.abs(to_a * u) + np.abs(to_b * v))
    error = 2 * (np.abs(to_a) * of_u + np.abs(to_b) * of_v + rounding) + 1e-300
    return distance, np.where(sure > of_whole, error, np.inf)


def _doubled_area(one: Floats, other: Floats) -> tuple[Floats, Floats]:
    left, right = one[:, 0] * other[:, 1], one[:, 1] * other[:, 0]
    return left - right, 4 * _E * (np.abs(left) + np.abs(right)) + 1e-300


def _exactly(corners: Array, sample: Floats) -> Iterator[Fraction]:
    """Yield distances as rational numbers."""
    for triangle, point in zip(corners.tolist(), sample.tolist(), strict=True):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (map(Fraction, each) for each in triangle)
        x, y, z = map(Fraction, point)
        whole = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
        u = ((x - cx) * (by - cy) - (y - cy) * (bx - cx)) / whole
        v = ((ax - cx) * (y - cy) - (ay - cy) * (x - cx)) / whole
        yield abs(z - cz - u * (az - cz) - v * (bz - cz))


def _upwards(value: Fraction) -> float:
    """Round to a double that is not less."""
    try:
        nearest = float(value)
    except OverflowError:
        return math.inf
    return nearest if Fraction(nearest) >= value else math.nextafter(nearest, math.inf)


def merged_deviation(heights: Floats, left_out: Rows, representatives: Rows) -> float:
    """Return the largest distance of merged rows from the row that stands for them."""
    merged = representatives >= 0
    apart = heights[left_out[merged]] - heights[representatives[merged]]
    return float(np.abs(apart).max(initial=0.0))
