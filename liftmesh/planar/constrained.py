"""constrained_delaunay(): triangulations that contain given edges.

What bounds the regions that are removed: the rings of polygons, if there are any; else the edges;
else those polylines that end where they begin. Others separate no regions, however they lie.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask, Progress, Reals, Rows
from liftmesh.base.arrays import (
    as_coordinates,
    as_numbers,
    is_after,
    of_one_array,
    pair_keys,
    widened,
)
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import (
    Carve,
    Crossing,
    NonFinite,
    RowOrder,
    as_threads,
    check_option,
    counted,
    exhausted,
)
from liftmesh.errors import InputError, Option
from liftmesh.planar.constrained_triangulation import (
    Bits,
    ConstrainedTriangulation,
    Pieces,
    left_first,
)
from liftmesh.planar.constraints import Constraints, gather
from liftmesh.planar.crossing_edges import Split, crossing_error, origins_of, split_crossings
from liftmesh.planar.delaunay import Solution, check_options, solution_of
from liftmesh.planar.points import rows_of
from liftmesh.predicates import orient2d

_SHOWN = 10
_SEED = "give a point x, y in each region that is to be removed"
_FOLLOWING, _AFTER = np.array([1, 2, 0]), np.array([2, 0, 1])


@of_one_array
def constrained_delaunay(  # noqa: PLR0913 - options are keywords
    points: ArrayLike,
    edges: ArrayLike | None = None,
    *,
    polylines: Any = None,
    polygons: Any = None,
    crossing: Crossing = "error",
    carve: Carve | None = None,
    seeds: ArrayLike | None = None,
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
) -> ConstrainedTriangulation:
    """Compute the constrained Delaunay triangulation, exact for every finite double.

    It contains the given edges, and is as near to Delaunay as they allow: no row that can be seen
    from within a triangle is inside its circumcircle, where edges block the view. The result is
    unique: ties are decided as by `delaunay`, in each polygon of rows on a circle that the edges
    leave whole. It depends on the sets of points and edges alone. An edge through rows is divided
    there; edges may overlap, repeat, and lie along the hull.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `delaunay`.
    edges : array_like of int, of shape (k, 2), optional
        Edges as pairs of rows of `points`; those of a `Cloud` by default, if there are no lines.
    polylines : list, path or geometries, optional
        Chains of edges, each as rows of `points`, in one dimension, or as coordinates, an array of
        shape (c, 2) or (c, 3), whose heights are left out; one chain of rows, or of coordinates
        that are floats, may stand by itself. Several pairs of integers, and several triples, are
        refused, as they may be either: edges between rows are `edges`, arrays of three rows may be
        in a list, and a list of chains, ``[chain]``, has coordinates of any type. Or lines, and
        polygons as their rings: geometries of shapely, or a list of them; a GeoDataFrame or
        GeoSeries; GeoJSON as a mapping; a ``trimesh.path.Path2D``; or the path of a file: GeoJSON,
        GeoPackage, shapefile, DXF, or OBJ, whose ``l`` elements are read.
    polygons : list, path or geometries, optional
        Polygons, each as a ring, or as a list of rings: the outer one, then its holes. A ring is
        given as a polyline is; it may repeat its first corner, turn either way, and touch itself
        and others. Or polygons in any of the other forms. Where there are only lines, as in DXF and
        OBJ, those that end where they begin are the rings; nested ones are outer rings and holes in
        turn. What is in two holes of one polygon counts as inside, as an island; two holes with the
        same sides are an error.
    crossing : {"error", "split"}, default "error"
        What is done where edges cross and no row is: raise an error that names all crossings, or
        insert each crossing, rounded to the nearest float64, as a row. Where edges cross again for
        that rounding, a row that is near may be taken instead. Then the result is exact for the
        rounded rows; ``displacement`` tells how far they are from the edges.
    carve : {"outside", "holes"}, optional
        What is removed. With "outside", what can be reached from the hull without crossing the
        sides of polygons; with "holes", all that is inside of none: also in their holes, or
        enclosed between them. What is in more holes than polygons is in a hole, so one may be given
        twice, overlap others or be within one. Without polygons, `edges` bound regions, and without
        these polylines that end at the position where they begin: "holes" then also removes what is
        an even number of crossings away. Other edges never count: they divide no region.
    seeds : array_like of shape (s, 2), optional
        A point in each region to be removed besides; regions are bounded as for `carve`.
    nonfinite : {"error", "skip"}, default "error"
        As for `delaunay`. An edge that ends at a skipped row is an error.
    order, threads, progress
        As for `delaunay`.

    Returns
    -------
    ConstrainedTriangulation
        Indices are rows of `points`, after which come those that coordinates have become
        (``added``) unless a row is exactly there, and those at crossings (``crossing_rows``).
        ``constraints`` are the edges that were asked for, piece by piece, with the input edges of
        each. Edges whose ends are at one position are in ``zero_length``.

    Raises
    ------
    InputError
        As for `delaunay`; an edge has a row that is out of range or skipped; a line or polygon
        cannot be read, has too few corners, or one that is not finite; an option is unknown; a seed
        is not finite, outside, or on an edge; nothing would be left.
    CrossingError
        Edges cross, and `crossing` is "error"; or still do after many rounds of splits.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    FormatError
        A file cannot be read.
    MissingDependencyError
        A package is missing: of DXF files ezdxf, of shapefiles with holes shapely.
    UnsupportedTypeError
        `points` is a path, or a column for each axis was given.

    See Also
    --------
    delaunay : Without constraints.
    verify : An exact check of the result.
    triangulate : From a cloud to a surface.

    Notes
    -----
    D. T. Lee and A. K. Lin, "Generalized Delaunay triangulation for planar graphs", Discrete
    Comput. Geom. 1 (1986): a triangulation that contains the edges is the one wanted if every other
    edge is locally Delaunay. The edges are inserted into the triangulation of `delaunay`, and what
    they crossed is triangulated anew: J. R. Shewchuk and B. C. Brown, "Fast segment insertion and
    incremental construction of constrained Delaunay triangulations", Comput. Geom. 48 (2015).

    Examples
    --------
    >>> points = [[0, 0], [4, -1], [8, 0], [4, 1]]
    >>> [0, 2] in constrained_delaunay(points, [[0, 2]]).edges.tolist()
    True
    >>> square = [[0, 0], [3, 0], [3, 3], [0, 3]]
    >>> hole = [[1, 1], [2, 1], [2, 2], [1, 2]]
    >>> tri = constrained_delaunay(square, polygons=[[square, hole]], carve="holes")
    >>> tri.added, tri.nsimplex
    (array([4, 5, 6, 7], dtype=int32), 8)
    >>> constrained_delaunay(square, [[0, 2], [1, 3]], crossing="split").points[-1]
    array([1.5, 1.5])
    """
    check_options(nonfinite, order, progress)
    check_option("crossing", crossing, Crossing)
    if carve is not None:
        check_option("carve", carve, Carve)
    if isinstance(points, list | tuple) and not len(points):
        points = np.empty((0, 2))  # corners of lines are enough
    rows = as_coordinates(rows_of(points))
    planar = rows if rows.shape[1] == 2 else rows[:, :2]
    if isinstance(points, Cloud) and edges is polylines is polygons is None:
        edges = points.edges
    given = gather(planar, edges, polylines, polygons)
    if len(given.added):
        rows = planar = np.concatenate([widened(planar), given.added])

    def build(points: Reals, edges: Rows, part: Progress | None) -> tuple[Any, ...]:
        run = nonfinite == "skip", *as_threads(threads, len(points)), part
        return _kernel.constrained(points, edges, *run)

    if crossing == "split":
        split = split_crossings(planar, given, build, progress)
    elif crossing == "error":  # `_solved` raises it
        split = Split(planar, given.edges, np.arange(len(given.edges), dtype=np.int32))
        split.built = build(planar, given.edges, progress)
    else:  # pragma: no cover - mypy refuses
        exhausted(crossing)
    solved = _solved(rows, split, given, order, threads, progress)
    keep = _kept(solved, given, carve, seeds)
    solution, bits, left = _left_first(solved, keep)
    return ConstrainedTriangulation(*solution[:6], bits, _pieces(solved, split, given), left)


class _Solved(NamedTuple):
    """A triangulation with all of its triangles, and the pieces of edges, or of their parts."""

    solution: Solution
    bits: Bits
    pieces: Rows
    indptr: Rows
    members: Rows  # parts
    parts: Rows
    origins: Rows  # of parts

    @property
    def piece_of(self) -> Integers:
        """The piece of each member."""
        return np.repeat(np.arange(len(self.pieces)), np.diff(self.indptr))


def _solved(
    rows: Array,
    split: Split,
    given: Constraints,
    order: RowOrder,
    threads: int | None,
    progress: Progress | None,
) -> _Solved:
    """Convert the outcome of a run of the kernel."""
    outcome, bits, pieces, indptr, members, _, unplaced, crossings = split.built
    if len(unplaced):
        raise _unplaced(split.points, given, unplaced)
    if len(crossings):
        remedy = f"give {Option('crossing', 'split')}"
        raise crossing_error(split.points, given, crossings, remedy)
    if len(split.points) > len(rows):
        rows = split.points
    solution = solution_of(outcome, rows, split.points, "engine", progress)
    if order == "canonical":
        simplices, neighbors, bits = _kernel.canonical_order(
            split.points,
            solution.simplices,
            solution.neighbors,
            bits,
            len(split.points),
            *as_threads(threads, len(bits)),
        )
        solution = solution._replace(simplices=simplices, neighbors=neighbors)
    return _Solved(solution, bits, pieces, indptr, members, split.edges, split.origins)


def _unplaced(points: Reals, given: Constraints, unplaced: Rows) -> InputError:
    """Name edges that end at rows that are skipped."""
    named = []
    for edge, ends in zip(unplaced[:_SHOWN].tolist(), given.edges[unplaced].tolist(), strict=False):
        row = next(each for each in ends if not np.isfinite(points[each]).all())
        named.append(f"{given.named(edge)}, {ends}, at row {row} {tuple(points[row].tolist())}")
    rest = f", and {len(unplaced) - _SHOWN:,} more" if len(unplaced) > _SHOWN else ""
    return InputError(
        f"{counted(len(unplaced), 'edge')} end{'s' * (len(unplaced) == 1)} at rows that are "
        f"skipped as not finite: {'; '.join(named)}{rest}: leave these edges out, or correct the "
        "rows"
    )


def _found(pieces: Rows, simplices: Rows) -> tuple[Mask, Integers]:
    """Tell which sides of triangles are pieces, (m, 3), and which pieces they are."""
    ends = np.sort(np.stack([simplices[:, _FOLLOWING], simplices[:, _AFTER]]), axis=0)
    keys, known = pair_keys(*ends), pair_keys(*pieces.T)
    place = np.searchsorted(known, keys)
    if not len(known):
        return np.zeros(keys.shape, dtype=np.bool_), place
    place = np.minimum(place, len(known) - 1)
    return known[place] == keys, place


def _pieces(solved: _Solved, split: Split, given: Constraints) -> Pieces:
    """Describe the pieces by what the caller gave."""
    indptr, members, zero_length = solved.indptr, solved.members, split.built[5]
    if len(split.edges) > len(given.edges):
        indptr, members = origins_of(indptr, members, split.origins)
        zero_length = split.zero_length
    return Pieces(
        solved.pieces,
        indptr,
        members,
        given.edges,
        given.polyline,
        given.polygon,
        zero_length,
        len(given.added),
        len(split.points) - split.own,
        split.displacement,
    )


def _kept(
    solved: _Solved, given: Constraints, carve: Carve | None, seeds: ArrayLike | None
) -> Mask | None:
    """Tell which triangles are left; None if all are."""
    if carve is None and seeds is None:
        return None
    simplices, neighbors = solved.solution.simplices, solved.solution.neighbors
    bounds, winding = _roles(solved, given)
    seeded = np.empty(0, dtype=np.int32)
    if seeds is not None:
        seeded = _seeded(solved, seeds, bounds)
    arrays = simplices, neighbors, solved.bits, solved.pieces, bounds, winding
    keep = _kernel.carve(*arrays, carve or "none", seeded).astype(np.bool_)
    if carve == "holes" and given.winding.any() and not winding.any():
        keep[:] = False  # rings cancel out, and their parity does not count
    if not keep.any():
        unseeded = seeded[:0]
        by_seeds = len(seeded) and (carve is None or _kernel.carve(*arrays, carve, unseeded).any())
        by_holes = carve == "holes" and not by_seeds and given.winding[:, 1].any()
        raise _nothing_left(counted(len(keep), "triangle"), bool(by_seeds), bool(by_holes))
    return keep


def _nothing_left(all_of_them: str, by_seeds: bool, by_holes: bool) -> InputError:
    if by_holes:
        said = f"{Option('carve')} removes all of {all_of_them}, since the holes of "
        said += f"{Option('polygons')} cover all of these: leave them out, or make them smaller"
    elif by_seeds:
        said = f"{Option('seeds')} remove all of {all_of_them} that there are: leave out those in "
        said += "regions that stay, or close these regions with edges or polygons"
    else:
        said = f"{Option('carve')} removes all of {all_of_them}, since nothing closes a region "
        said += "around them: give closed edges or polygons"
    return InputError(f"no triangle is left: {said}")


def _roles(solved: _Solved, given: Constraints) -> tuple[Bits, Rows]:
    """Return which pieces bound regions, and how the winding numbers change across each."""
    piece, count = solved.piece_of, len(solved.pieces)
    origin = solved.origins[solved.members]
    bounds = np.zeros(count, dtype=np.uint8)
    bounds[piece[given.bounds[origin]]] = 1
    of_polygon = np.flatnonzero(given.winding[origin].any(axis=1))
    piece, origin = piece[of_polygon], origin[of_polygon]
    points = solved.solution.points
    pairs = solved.pieces[piece], solved.parts[solved.members[of_polygon]]
    along = np.equal(*(is_after(*points.take(each.T, axis=0)) for each in pairs))
    steps = np.where(along, 1, -1) * given.winding[origin].T
    windings = [np.bincount(piece, each, minlength=count).astype(np.int32) for each in steps]
    return bounds, np.stack(windings, axis=1)


def _seeded(solved: _Solved, seeds: ArrayLike, bounds: Bits) -> Rows:
    """Find the triangles of seeds, which have to be inside of a region."""
    solution = solved.solution
    places = np.ascontiguousarray(as_numbers("seeds", seeds, _SEED, verb="are"))
    if places.size and (places.shape[-1:] != (2,) or places.ndim > 2):
        raise InputError(f"{Option('seeds')} have the shape {places.shape}: {_SEED}")
    places = places.reshape(-1, 2)
    is_finite = np.isfinite(places).all(axis=1)
    if not is_finite.all():
        raise _misplaced(places, int(is_finite.argmin()), "not finite")
    triangles = np.empty(len(places), dtype=np.int32)
    locator = _kernel.Locator(solution.points, solution.simplices, solution.neighbors)
    locator.find(places, triangles, *as_threads(None, len(places)))
    if (triangles < 0).any():
        raise _misplaced(places, int((triangles < 0).argmax()), "outside of all triangles")
    around = solution.simplices[triangles]
    sides, piece = _found(solved.pieces, around)
    sides[sides] = bounds[piece[sides]] > 0
    corners = solution.points[around]
    turns = orient2d(corners[:, _FOLLOWING], corners[:, _AFTER], places[:, None])
    is_end = (corners == places[:, None]).all(axis=2) & np.isin(around, solved.pieces[bounds > 0])
    is_on = ((turns == 0) & sides | is_end).any(axis=1)
    if is_on.any():
        raise _misplaced(places, int(is_on.argmax()), "on an edge that bounds a region")
    return triangles


def _misplaced(places: Floats, seed: int, where: str) -> InputError:
    return InputError(f"seed {seed}, {tuple(places[seed].tolist())}, is {where}: {_SEED}")


def _left_first(solved: _Solved, keep: Mask | None) -> tuple[Solution, Bits, int]:
    """Put the triangles that are left before the others."""
    solution, bits = solved.solution, solved.bits
    if keep is None or keep.all():
        return solution, bits, len(bits)
    order, simplices, neighbors = left_first(keep, solution.simplices, solution.neighbors)
    sorted_ones = solution._replace(simplices=simplices, neighbors=neighbors)
    return sorted_ones, bits[order], int(np.count_nonzero(keep))
