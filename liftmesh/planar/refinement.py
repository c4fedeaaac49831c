"""refine(): triangles of good shape and size, by rows that are added.

The kernel refines the triangulation of the whole hull, in which regions may be left out. What
bounds the rest is made an input edge, so that rows are added on it, and never beyond.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import MOST_ROWS, as_numbers, ends_of, pair_keys, pairs_of_keys
from liftmesh.base.options import (
    as_count,
    as_number,
    as_switch,
    as_threads,
    check_progress,
    counted,
    part_of,
    refused,
)
from liftmesh.errors import DataWarning, InputError, Option, UnsupportedTypeError
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constrained_triangulation import (
    Bits,
    ConstrainedTriangulation,
    Pieces,
    left_first,
    members_of,
    pieces_of,
    with_sides,
)
from liftmesh.planar.crossing_edges import distances
from liftmesh.planar.kinds import options_of
from liftmesh.planar.refined import RefineResult, below_angle, cosine_of
from liftmesh.planar.triangulation import Triangulation, check_unwritten
from liftmesh.planar.verification import verify

Lengths: TypeAlias = Callable[[Floats, Rows], Floats]  # of flat points and regions

_LARGEST_ANGLE = 45.0  # where nothing is proved, and the cap on rows may be reached
_MOST_MADE = 10_000_000
_MOST_ROUNDS = 1000
_CAUSES = np.array(["", "input angle", "cap", "precision"])  # by the kernel's numbers
_CAP = 2
_SIZE = (
    "give a positive number, one for each row or each region, or a function of points that returns "
    "as many"
)


def refine(  # noqa: PLR0913 - options are keywords
    domain: Any,
    *,
    min_angle: float | None = 30.0,
    max_area: ArrayLike | None = None,
    size: ArrayLike | Callable[[Floats], ArrayLike] | None = None,
    conforming: bool = False,
    max_points: int | None = None,
    smooth: int = 0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> RefineResult:
    """Refine a triangulation until its triangles have good angles and sizes.

    Rows are added, none of the domain is moved or removed, and the triangles stay constrained
    Delaunay, exactly. It always ends, also at small angles between edges and where digits run out:
    what cannot be better is listed, angles with the cause. The triangles depend on the sets of
    points and edges alone.

    Parameters
    ----------
    domain : Triangulation, Surface, RefineResult, list, path or geometries
        A triangulation of `delaunay` or `constrained_delaunay`, carved or not; its hull and the
        boundary of what is left become edges, too. Or polygons in any form that `polygons` of
        `constrained_delaunay` has: what is inside of them is triangulated first. Or a surface,
        whose faces are refined in its plane; or what `refine` returned.
    min_angle : float, default 30
        The smallest angle wanted, in degrees, up to 45; None or 0 for none. Up to 34 the number of
        rows stays small in practice, but where triangles are to conform, which may take several
        times as many at 34; above, rows may be added until `max_points` is reached.
    max_area : float or array_like of shape (r,), optional
        The largest area wanted, of all triangles or by ``domain.regions``. Infinity is no bound.
    size : float, array_like of shape (n,) or (r,), or callable, optional
        The length of edges wanted: one for all; one at each row, linear between them; one by
        ``domain.regions``, where these are not as many as rows; or a function of points, (k, 2),
        that returns the lengths there, (k,). Infinity is no bound. The longest side of a triangle
        is at most the square root of two times the length at its centroid, also between edges that
        meet in a small angle; a warning counts triangles that float64 has no row to divide.
    conforming : bool, default False
        Whether the triangles are to be Delaunay also across constraints, which takes more rows. A
        warning counts the constraints across which they are not, as float64 has no row between.
    max_points : int, optional
        The most rows to be added, by default 10,000,000; those that give way to others are not
        counted, up to three for each. Where they do not suffice, a warning counts the triangles
        that are left.
    smooth : int, default 0
        How many times, up to 1000, every row that was added between edges is then moved to where
        triangles are better. It stays where the smallest angle of those that change would not grow,
        or one of them would miss what is asked for.
    threads : int, optional
        As for `constrained_delaunay`, of polygons. Rows are added by one thread.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    RefineResult
        The triangulation, with the rows that were added and the triangles that are below
        `min_angle` or too large. Rows of the domain keep their numbers. Of a surface it has a
        ``surface``, too, where heights of added rows are those of the surface before, and
        edges have no markers.

    Raises
    ------
    InputError
        An option is out of range or has another shape, `size` returns what is no length, or the
        domain is a triangulation with weights or a metric, or a surface over a plane other than
        "xy", "xz" and "yz".
    UnsupportedTypeError
        The domain is None, or a triangulation of another kind.
    CrossingError, DegenerateInputError, FormatError, MissingDependencyError, NonFiniteError
        Of polygons, as for `constrained_delaunay`.

    See Also
    --------
    constrained_delaunay : The triangulation to start from.
    RefineResult.verify : A check of the result.

    Notes
    -----
    A triangle with a small angle gets a row near the centre of its circle, or, where an edge hides
    that place, the edge is split: J. Ruppert, "A Delaunay refinement algorithm for quality
    2-dimensional mesh generation" (1995); L. P. Chew, "Guaranteed-quality mesh generation for
    curved surfaces" (1993). Off-centres make fewer triangles (A. Ungor, 2004). Edges that meet in a
    small angle are split at distances that are powers of two (J. R. Shewchuk, "Delaunay refinement
    algorithms for triangular mesh generation", 2002), and triangles between them are left (G. L.
    Miller, S. E. Pav and N. J. Walkington, "When and why Ruppert's algorithm works", 2003).

    Smoothing moves a row to the mean of the centres of the circles around it, weighted so that what
    is fine stays fine: L. Chen, "Mesh smoothing schemes based on optimal Delaunay triangulations"
    (2004).

    Angles are compared with the float64 nearest to the cosine of `min_angle`, exactly; areas and
    lengths are compared in float64. Where one `size` is wanted in a square, rows tend to make a
    lattice of halved squares: about 30 % more triangles than programs with other rows make.

    Examples
    --------
    >>> import liftmesh
    >>> strip = [[0.0, 0.0], [9.0, 0.0], [9.0, 1.0], [0.0, 1.0]]
    >>> refined = liftmesh.refine(strip, max_area=0.5)
    >>> len(refined.below), refined.min_angle >= 30
    (0, True)
    >>> tri = refined.triangulation
    >>> tri.points[:4].tolist() == strip, bool(refined.verify())
    (True, True)
    >>> halves = liftmesh.constrained_delaunay([[0, 0], [4, 0], [4, 4], [0, 4]], [[0, 2]])
    >>> fine = liftmesh.refine(halves, max_area=[0.1, 8])
    >>> np.bincount(fine.triangulation.regions) > 99
    array([ True, False])
    """
    angle = as_number(
        "min_angle",
        0.0 if min_angle is None else min_angle,
        f"degrees from 0 to {_LARGEST_ANGLE:g}",
        lambda number: 0 <= number <= _LARGEST_ANGLE,
    )
    is_conforming = as_switch("conforming", conforming)
    most = _MOST_MADE if max_points is None else as_count("max_points", max_points, 0)
    rounds = as_count("smooth", smooth, 0, _MOST_ROUNDS)
    check_progress(progress)
    as_threads(threads, 0)
    if isinstance(domain, RefineResult):
        domain = domain._made  # noqa: SLF001 - of this room
    if hasattr(domain, "_refined"):  # a `Surface`, of a room above
        options: Any = {"max_area": max_area, "size": size, "conforming": conforming}
        options |= {"min_angle": min_angle, "max_points": max_points, "smooth": smooth}
        options["progress"] = part_of(progress, 0.0, 0.9)
        result: RefineResult = domain._refined(lambda tri: refine(tri, **options))  # noqa: SLF001
        if progress is not None:
            progress(1.0)
        return result
    own = _triangulated(domain, threads)
    largest, lengths = _largest(max_area, own), _lengths(size, own)
    tri = with_sides(own, (own.neighbors < 0) & ~own.is_constrained)
    bounds = cosine_of(angle), largest, lengths, is_conforming, min(most, MOST_ROWS - tri.npoints)
    outcome = _kernel.refine(*_arrays(tri), *bounds, rounds, progress)
    refined = _result(tri, outcome, angle)
    if refined.capped:
        _warn(refined)
    else:
        _warn_of_large(len(refined.too_large))
        if is_conforming:
            _warn_of_others(refined.triangulation)
    if progress is not None:
        progress(1.0)
    return refined


def _triangulated(domain: Any, threads: int | None) -> ConstrainedTriangulation:
    """Return the triangulation of a domain."""
    if not isinstance(domain, Triangulation):
        if domain is None:
            raise UnsupportedTypeError("the domain is None: give a triangulation or polygons")
        if hasattr(domain, "simplices"):
            raise UnsupportedTypeError(
                f"the domain is a {type(domain).__name__}: give liftmesh.delaunay of its points, "
                "or constrained_delaunay with edges that are to stay"
            )
        return constrained_delaunay([], polygons=domain, carve="holes", threads=threads)
    return as_constrained(domain)


def as_constrained(tri: Triangulation) -> ConstrainedTriangulation:
    """Return a triangulation as one with constraints, of which it may have none."""
    check_unwritten(tri)
    if isinstance(tri, ConstrainedTriangulation):
        return tri
    if others := options_of(tri):
        raise InputError(
            f"the domain is a triangulation with {Option(next(iter(others)))}, and only Delaunay "
            "triangulations are refined: give liftmesh.delaunay of its points"
        )
    simplices, neighbors, hull, duplicates, skipped = tri._given()  # noqa: SLF001 - of this room
    none = np.empty((0, 2), dtype=np.int32)
    flat = none.reshape(-1)
    pieces = Pieces(none, np.zeros(1, dtype=np.int32), flat, none, flat, flat, flat, 0, 0, 0.0)
    bits = np.zeros(len(simplices), dtype=np.uint8)
    whole = tri.points, simplices, neighbors, hull, duplicates, skipped
    return ConstrainedTriangulation(*whole, bits, pieces, len(simplices))


def _largest(max_area: ArrayLike | None, tri: ConstrainedTriangulation) -> Floats:
    """Convert the option ``max_area``: an area for each region, or none at all."""
    if max_area is None:
        return np.empty(0)
    count = int(tri.regions.max()) + 1
    wanted = "give a positive number" + f", or one for each of the {count:,} regions" * (count > 1)
    areas = as_numbers("max_area", max_area, wanted)
    if areas.ndim == 0:
        return np.full(count, _bound("max_area", max_area, wanted))
    if areas.shape != (count,) or not (areas > 0).all():
        raise refused("max_area", max_area, wanted)
    return areas


def _bound(name: str, value: Any, wanted: str) -> float:
    """Convert a bound of all triangles, which may be infinite."""
    return as_number(name, value, wanted.removeprefix("give "), lambda number: number > 0)


def _lengths(size: Any, tri: ConstrainedTriangulation) -> Lengths | None:
    """Convert the option ``size``."""
    if size is None:
        return None
    if callable(size):
        return lambda places, _: _returned(size, places.reshape(-1, 2))
    lengths = as_numbers("size", size, _SIZE)
    if lengths.ndim == 0:
        length = _bound("size", size, _SIZE)
        return lambda _, regions: np.full(len(regions), length)
    lengths = np.ascontiguousarray(lengths)
    count = int(tri.regions.max()) + 1
    if (lengths.shape == (tri.npoints,)) == (lengths.shape == (count,)):  # neither or both
        raise InputError(
            f"{Option('size')} has the shape {lengths.shape}, and there are "
            f"{counted(tri.npoints, 'row')} and {counted(count, 'region')}: {_SIZE}"
        )
    if len(lengths) == count:
        if not (lengths > 0).all():
            raise refused("size", size, _SIZE)
        return lambda _, regions: lengths[regions]
    _check_lengths(lengths, tri.points)
    simplices, neighbors = map(np.ascontiguousarray, tri._whole)  # noqa: SLF001 - of this room
    relief = _kernel.Relief(tri.points, simplices, neighbors, lengths, None)
    return lambda places, _: _between_rows(relief, tri, places.reshape(-1, 2))


def _returned(size: Callable[[Floats], ArrayLike], places: Floats) -> Floats:
    """Ask the caller's function."""
    given = size(places)
    lengths = as_numbers("size", given, _SIZE, verb="returned")
    if not lengths.ndim:
        raise refused("size", given, _SIZE, verb="returned")
    if lengths.shape != (len(places),):
        raise InputError(
            f"{Option('size')} returned the shape {lengths.shape} of points {places.shape}: {_SIZE}"
        )
    _check_lengths(lengths, places)
    return np.ascontiguousarray(lengths)


def _check_lengths(lengths: Floats, places: Floats) -> None:
    is_wrong = ~(lengths > 0)
    if is_wrong.any():
        at = int(is_wrong.argmax())
        raise InputError(
            f"{Option('size')} is {lengths[at].item()!r} at {tuple(places[at].tolist())}: {_SIZE}"
        )


def _between_rows(relief: _kernel.Relief, tri: ConstrainedTriangulation, places: Floats) -> Floats:
    lengths = np.empty(len(places))
    run = as_threads(None, len(places))
    relief.sample(tri._locator, places, lengths, "linear", *run)  # noqa: SLF001 - of this room
    lengths[np.isnan(lengths)] = np.inf  # beyond the hull by rounding: no bound there
    return lengths


def _arrays(
    tri: ConstrainedTriangulation,
) -> tuple[Floats, Rows, Rows, Rows, Bits, Rows, Rows]:
    """Return a triangulation as the kernel refines it: outside there are no regions."""
    simplices, neighbors, hull = map(np.ascontiguousarray, (*tri._whole, tri._hull))  # noqa: SLF001 - of this room
    marks, pieces = np.ascontiguousarray(tri._constrained), np.ascontiguousarray(tri.constraints)  # noqa: SLF001 - of this room
    regions = np.full(len(marks), -1, dtype=np.int32)
    regions[: tri.nsimplex] = tri.regions
    return tri.points, simplices, neighbors, hull, marks, pieces, regions


def _result(tri: ConstrainedTriangulation, outcome: _kernel.Refined, angle: float) -> RefineResult:
    """Make the result of what the kernel returns."""
    added, divided, simplices, neighbors, hull, marks, regions, causes, is_large, capped = outcome
    order, simplices, neighbors = left_first(regions >= 0, simplices, neighbors)
    causes, left = causes[order], int(np.count_nonzero(regions >= 0))
    made = ConstrainedTriangulation(
        np.concatenate([tri.points, added]),
        simplices,
        neighbors,
        hull,
        tri.duplicates,
        tri.skipped,
        marks[order],
        _parts(tri, simplices, neighbors, marks[order], divided),
        left,
    )
    indptr, members = tri.constraint_inputs
    edges = np.full(len(divided), -1, dtype=np.int32)
    is_on = divided >= 0
    edges[is_on] = members[indptr[divided[is_on]]]
    lines = tri.points[tri.input_edges[edges[is_on]]]
    below = below_angle(made, cosine_of(angle), np.flatnonzero(causes[:left])).astype(np.int32)
    return RefineResult(
        made,
        np.arange(tri.npoints, made.npoints, dtype=np.int32),
        edges,
        below,
        _CAUSES[causes[below]],
        angle,
        float(distances(lines, added[is_on]).max(initial=0.0)),
        capped,
        np.flatnonzero(is_large[order][:left]).astype(np.int32),
    )


def _parts(
    tri: ConstrainedTriangulation, simplices: Rows, neighbors: Rows, marks: Bits, divided: Rows
) -> Pieces:
    """Describe the parts of pieces, each with the input edges of its piece."""
    numbers = np.arange(len(marks), dtype=np.int32)
    faces = [  # of both sides the later
        np.flatnonzero((marks & (1 << k) > 0) & (neighbors[:, k] < numbers)) for k in range(3)
    ]
    k = np.repeat(np.arange(3), [*map(len, faces)])
    keys = np.sort(pair_keys(*ends_of(simplices, np.concatenate(faces), k).T))
    ends = np.stack(pairs_of_keys(keys), axis=1).astype(np.int32)
    of_row = np.concatenate([np.full(tri.npoints, -1, dtype=np.int32), divided])
    piece = np.maximum(*of_row[ends.T])  # a row that was added is on one piece at most
    is_whole = piece < 0
    piece[is_whole] = np.searchsorted(pair_keys(*tri.constraints.T), keys[is_whole])
    pieces = pieces_of(tri, ends, *members_of(piece, *tri.constraint_inputs))
    return replace(pieces, steiner=pieces.steiner + len(divided))


def _warn(refined: RefineResult) -> None:
    """Count what is left where the rows that may be added do not suffice."""
    small = int(np.count_nonzero(refined.causes == _CAUSES[_CAP]))
    warnings.warn(
        f"{counted(len(refined.steiner), 'row')} were added, and no more may be: "
        f"{counted(small, 'triangle')} under {refined.asked_angle:g} degrees and "
        f"{len(refined.too_large):,} too large are left; give a larger {Option('max_points')}, "
        f"a larger {Option('max_area')} or {Option('size')}, or a smaller {Option('min_angle')}",
        DataWarning,
        stacklevel=3,
    )


def _warn_of_large(count: int) -> None:
    if count:
        warnings.warn(
            f"{counted(count, 'triangle')} stayed larger than asked for, see `too_large`: float64 "
            f"has no row that would divide them; give a larger {Option('max_area')} or "
            f"{Option('size')}, or coordinates nearer to 0",
            DataWarning,
            stacklevel=3,
        )


def _warn_of_others(tri: ConstrainedTriangulation) -> None:
    """Count the constraints across which triangles that are to conform are not `delaunay`'s."""
    whole = tri._whole[0]  # noqa: SLF001 - of this room
    flaws = verify(tri.points, whole, nonfinite="skip").flaws
    kinds = {"not_delaunay", "not_canonical"}
    if count := sum(flaw.count for flaw in flaws if flaw.kind in kinds):
        warnings.warn(
            f"triangles are not those of `delaunay` across {counted(count, 'constraint')}: float64 "
            "has no row that would divide them",
            DataWarning,
            stacklevel=3,
        )
