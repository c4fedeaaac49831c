"""`verify`: an exact test whether given triangles are the Delaunay triangulation of points.

The kernel checks triangles, edges, the boundary and the rows. This module turns its numbers into a
`Certificate`; violations.py describes what it found.
"""

from __future__ import annotations

import os
from collections.abc import Sequence, Sized
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Progress, Reals, Rows
from liftmesh.base.arrays import as_coordinates, is_masked_array, non_finite, widened
from liftmesh.base.options import (
    NonFinite,
    as_switch,
    as_threads,
    check_option,
    check_progress,
    counted,
)
from liftmesh.errors import InputError, Option
from liftmesh.planar.certificate import Certificate, Flaw, narrowest, sha256_of
from liftmesh.planar.kinds import TriangulationKind, as_kind, options_of
from liftmesh.planar.planarity import is_locally_delaunay, is_triangulation
from liftmesh.planar.space_verification import verify_sphere, verify_tetrahedra
from liftmesh.planar.violations import MEANINGS, TriangleViolations

_MOST_CORNERS = 2**31  # the kernel counts them
_REMEDIES = {
    "tetrahedron": "give the four rows of each tetrahedron",
    "triangle": "give the three rows of each triangle; cut other polygons into triangles first",
    "constraint": "give the two rows of each constraint; a polyline is several",
}
_PREMATURE = {"invalid_index", "non_finite"}  # with these, neither edges nor rows are counted


def verify(  # noqa: PLR0913 - options are keywords
    points: Any,
    simplices: ArrayLike | None = None,
    *,
    nonfinite: NonFinite = "error",
    threads: int | None = None,
    progress: Progress | None = None,
    weights: ArrayLike | None = None,
    radii: ArrayLike | None = None,
    metric: ArrayLike | None = None,
    furthest_site: bool = False,
    constraints: ArrayLike | None = None,
    carved: bool = False,
    spherical: bool = False,
) -> Certificate:
    """Verify exactly that triangles, from any source, are the Delaunay triangulation of points.

    Or another member of the family: their regular triangulation by weights or radii, their Delaunay
    triangulation in a metric, their farthest-point Delaunay triangulation, or their constrained
    Delaunay triangulation. Of tetrahedra and points in space the same is verified, by facets
    instead of edges, and of triangles on the sphere.

    The checks are: every corner is a row; every triangle is counter-clockwise; every edge has one
    triangle on either side, or lies on the boundary; the boundary is one convex curve that winds
    around once, so that no two triangles overlap; Euler's relation holds; every row is a vertex or
    has one at its position; and no triangle's circumcircle contains the apex of a neighbour, so
    that none contains any point. No tolerance decides anything. The only code that decides here and
    in the engines is the predicates, and the scaling by powers of two, which is checked.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3), or a mesh
        The points; of tetrahedra with z, which is ignored otherwise. Without `simplices`, a mesh: a
        `Surface`, which is checked in its own plane, by the faces that are left if it was trimmed,
        which `Surface.triangulation` still has all (with breaklines, as `carved`); a
        `Triangulation`, `Tetrahedralization` or `SphericalTriangulation`, or one of SciPy or
        matplotlib; a mesh of trimesh or
        Open3D, a `Cloud` with faces, or the path of a file, which are seen from above, but for VTU,
        VTK and MSH, whose tetrahedra are taken. Or an `ApolloniusGraph`, which is checked as
        `ApolloniusGraph.verify` says; only `threads` and `progress` can be given with it.
    simplices : array_like of int, of shape (m, 3) or (m, 4), optional
        The corners of each triangle as rows of `points`. Triangles may be in any order, and any
        corner may be first. Those of tetrahedra, which must be positively oriented (`orient3d`).
    nonfinite : {"error", "skip"}, default "error"
        Rows with NaN or infinity raise, or are skipped and must not be corners. Those that a
        `Surface` or a `Triangulation` skipped are always skipped.
    threads : int, optional
        As for `delaunay`. The certificate is the same for any number.
    progress : callable, optional
        As for `delaunay`.
    weights, radii : (n,) array_like, optional
        As for `regular`: the triangles are to be the regular triangulation by these. Rows whose
        value is not finite count as rows that are not. The square of a radius is never rounded.
    metric : (2, 2) array_like, optional
        As for `delaunay`: the triangles are to be the Delaunay triangulation in this metric.
    furthest_site : bool, default False
        Whether the triangles are to be the farthest-point Delaunay triangulation, as of
        `scipy.Delaunay`. Without any of these options, a `Triangulation`, a `Surface` or a file
        that liftmesh wrote says itself which member it is.
    constraints : (k, 2) array_like of int, optional
        Edges between two rows each: the triangles are to be the constrained Delaunay triangulation.
        Each constraint must be a union of edges of the triangles; it may lead through other rows,
        and on top of other constraints. Those whose ends are at one position are ignored. Edges
        along constraints need not be locally Delaunay, all others must.
    carved : bool, default False
        Whether regions that constraints bound may be missing, outside and inside: then the boundary
        need not be convex, and may have several curves, but each of its edges must be on a
        constraint or on the convex hull of the rows. Rows where no triangle is are counted
        (``n_outside``), and of constraints only the parts that touch triangles must be edges. It is
        not proved that the right regions are missing.
    spherical : bool, default False
        Whether the triangles are to be those of `spherical_delaunay`: `points` are vectors of any
        length, whose directions count. A file that liftmesh wrote says so itself.

    Returns
    -------
    Certificate
        True if the triangulation is valid; ``canonical`` is whether it is also the one that
        liftmesh makes, as a set of triangles. ``planar`` tells of triangles that are not valid
        whether any overlap, and ``delaunay`` of those with constraints whether their circles are
        empty across these, too.

    Raises
    ------
    InputError
        `points` or `simplices` have another shape or other values, `simplices` are masked, a mesh
        has no triangles, an option is unknown or invalid, or several members are named. Or a
        constraint has an end that is no row, or is skipped.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    UnsupportedTypeError
        The object is no mesh.
    FormatError
        The file cannot be read.

    See Also
    --------
    Triangulation.verify : The check of one's own triangles.
    Tiled.verify : The check of more triangles than memory holds.
    compare : Where trimesh's hull differs.

    Notes
    -----
    That the local test suffices was shown by B. Delaunay, "Sur la sphère vide" (1934). Edges are
    paired in one pass over the triangles, or by hashing and sorting: O(n log n) on every input. If
    all triangles are clockwise (or degenerate), as in a mesh to be seen from below, that is
    reported, and everything else is checked as if their corners were in the opposite order.
    Otherwise in-circle tests skip clockwise and degenerate triangles and non-manifold edges.

    For other members, the apex of a neighbour must not be below the plane of the lifted triangle:
    so the lifted triangles are a convex surface. Each row without a vertex must be strictly above
    it, or a duplicate of a vertex. Point location finds the triangle under such a row, and three
    orientations check that it is there.

    That the local test of all other edges suffices where constraints are given was shown by D. T.
    Lee and A. K. Lin, "Generalized Delaunay triangulation for planar graphs" (1986). Carved
    triangles do not overlap if a line that sweeps over their boundary enters and leaves covered
    ground in turns (M. I. Shamos and D. Hoey, 1976): O(b log b) for b edges of the boundary, rows
    outside and constraints there. Constraints that cross each other are not all unions of edges.

    The boundary of tetrahedra is convex if it is closed, has an inner point on the inner side of
    all its facets, no valley, and turns once around its largest vertex: then it is seen once in
    every direction from the inner point. Their facets are sorted. Triangles on the sphere are
    proved to be the surface of a convex body in the same way, whose corners are unit vectors, none
    of which is rounded. If all are on one circle, only the canonical triangles are valid.

    Examples
    --------
    >>> import liftmesh
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.25]]
    >>> bool(verify(square, liftmesh.delaunay(square).simplices))
    True
    >>> bool(verify(liftmesh.triangulate(square)))
    True
    >>> print(verify(square, [[0, 1, 2], [0, 2, 3]]))
    not valid: 1 row has no vertex; first: row 4 (0.5, 0.25) is not a vertex, and no vertex is ...
    >>> kite, across = [[0, 0], [4, -1], [8, 0], [4, 1]], [[0, 1, 2], [0, 2, 3]]
    >>> bool(verify(kite, across)), bool(verify(kite, across, constraints=[[0, 2]]))
    (False, True)
    """
    check_option("nonfinite", nonfinite, NonFinite)
    check_progress(progress)
    given = (weights, radii, metric)
    lifted_by: dict[str, Any] = dict(zip(("weights", "radii", "metric"), given, strict=True))
    lifted_by |= {"furthest_site": (is_farthest := as_switch("furthest_site", furthest_site))}
    edges = None if constraints is None else _as_tuples(constraints, 2, "constraints", "constraint")
    is_carved = as_switch("carved", carved)
    is_spherical = as_switch("spherical", spherical)
    _refuse_other_results(points, simplices)
    if _is_graph_of_disks(points):
        others = (*given, simplices, constraints)
        _refuse_more(is_farthest, is_carved, is_spherical, *(each is not None for each in others))
        certificate: Certificate = points.verify(threads=threads, progress=progress)
        return certificate
    if _are_tetrahedra(points, simplices):
        are_given = (each is not None for each in (*given, constraints))
        _refuse_with_tetrahedra(is_farthest, is_carved, is_spherical, *are_given)
        return verify_tetrahedra(
            *_space_triangulation(points, simplices, nonfinite), threads, progress
        )
    if simplices is None:
        told = is_farthest or any(each is not None for each in (*given, constraints))
        points, simplices, is_skipping, own = _points_and_triangles(points, told=told)
        nonfinite = "skip" if is_skipping else nonfinite
        edges = own.pop("constraints", edges)
        is_carved = own.pop("carved", is_carved)
        is_spherical = own.pop("spherical", is_spherical)
        lifted_by |= own
    if is_spherical:
        _refuse_on_sphere(is_farthest, is_carved, edges, *given)
        vectors = widened(_in_space(points, "triangles on the sphere"))
        triangles = _as_tuples(simplices, 3, "simplices", "triangle")
        return verify_sphere(vectors, triangles, nonfinite == "skip", threads, progress)
    _refuse_members(edges is not None, is_carved, lifted_by)
    rows = as_coordinates(points)
    kind = as_kind(len(rows), **lifted_by)
    triangles = _as_tuples(simplices, 3, "simplices", "triangle")
    corners = _as_int32(triangles)
    ends = None if edges is None else _as_ends(edges, rows)
    most = max(len(rows), len(corners))
    count, shared = as_threads(threads, most)
    run = (rows, corners, nonfinite == "skip", count, shared, progress)
    verdict = _kernel.verify(*run, kind.name, widened(kind.values), ends, is_carved)
    status, row, *_ = verdict
    if status == "non-finite":
        if kind.has_values and not np.isfinite(kind.values[row]):
            raise kind.non_finite(row)
        raise non_finite(row, rows[row])
    sums = _sums(rows, triangles, count > 1 and most >= 2 * _kernel.ROWS_PER_THREAD)
    certificate = _certify(rows, triangles, verdict, sums, kind, ends, is_carved)
    certificate = _with_shape(certificate, rows, corners, threads)
    if progress is not None:
        progress(1.0)
    return certificate


def _is_graph_of_disks(value: Any) -> bool:
    """Whether this is an `ApolloniusGraph`, of a room above."""
    return hasattr(value, "circles") and hasattr(value, "radii")


def _are_tetrahedra(points: Any, simplices: Any) -> bool:
    """Whether simplices, or those of an object or a file, have four corners."""
    if simplices is None and isinstance(points, str | os.PathLike):
        from liftmesh.io.tetrahedra import is_of_tetrahedra  # noqa: PLC0415 - arrays do without

        return is_of_tetrahedra(points)
    given: Any = getattr(points, "simplices", None) if simplices is None else simplices
    try:
        shape = np.shape(given)
    except ValueError:  # ragged
        return False
    return isinstance(shape, tuple) and len(shape) == 2 and shape[1] == 4  # classes have others


def _space_triangulation(
    points: Any, simplices: Any, nonfinite: NonFinite
) -> tuple[Floats, Array, bool]:
    """Return points in space, tetrahedra, and whether rows are skipped."""
    is_skipping = nonfinite == "skip"
    if simplices is None and isinstance(points, str | os.PathLike):
        from liftmesh.io.tetrahedra import read_tetrahedra  # noqa: PLC0415 - arrays do without

        points, simplices = read_tetrahedra(points)
    elif simplices is None:
        is_skipping |= len(getattr(points, "skipped", ())) > 0
        points, simplices = points.points, points.simplices
    rows = _in_space(points, "tetrahedra")
    return widened(rows), _as_tuples(simplices, 4, "simplices", "tetrahedron"), is_skipping


def _in_space(points: Any, what: str) -> Reals:
    rows = as_coordinates(points)
    if rows.shape[1] != 3:
        raise InputError(f"{what} are given with points of two columns: give z as a third")
    return rows


def _refuse_on_sphere(is_farthest: bool, is_carved: bool, *are_given: Any) -> None:
    if is_farthest or is_carved or any(each is not None for each in are_given):
        raise InputError(
            f"{Option('spherical', True)} is given with another member: triangles on the sphere "
            "are verified without weights, radii, metric, furthest_site, constraints or carved"
        )


def _refuse_with_tetrahedra(*are_given: bool) -> None:
    if any(are_given):
        raise InputError(
            "tetrahedra are verified as the Delaunay triangulation only: give them without "
            "weights, radii, metric, furthest_site, constraints, carved or spherical"
        )


def _refuse_more(*are_given: bool) -> None:
    if any(are_given):
        raise InputError(
            "a graph of disks has triangles and radii of its own: give it without simplices, "
            "weights, radii, metric, furthest_site, constraints, carved or spherical"
        )


def _refuse_members(constrained: bool, carved: bool, lifted_by: dict[str, Any]) -> None:
    others = [name for name, value in lifted_by.items() if value is not None and value is not False]
    if constrained and others:
        raise InputError(
            f"{Option('constraints')} and {Option(others[0])} are given: only Delaunay "
            "triangulations are verified with constraints; give one of the two"
        )
    if carved and not constrained:
        raise InputError(
            f"{Option('carved', True)} is given without constraints, which bound what may be "
            f"missing: give {Option('constraints')}"
        )


def _refuse_other_results(points: Any, simplices: Any) -> None:
    if _is_graph_of_disks(simplices):
        raise InputError("simplices are a graph of disks, which has its own points: give it alone")
    if hasattr(type(points), "inconsistent"):  # `AnisotropicStars`, of a module above
        raise InputError(
            "anisotropic stars are no triangulation and cannot be verified: their `consistent` and "
            "`inconsistent` say which stars agree"
        )
    if hasattr(points, "ring_corners"):  # of a room above
        own = "their `graph`" if hasattr(points, "graph") else "the triangulation they are dual to"
        raise InputError(f"cells are no triangulation and cannot be verified: give {own}")


def _points_and_triangles(
    mesh: Any, *, told: bool = False
) -> tuple[Array, Array, bool, dict[str, Any]]:
    """Return points and triangles of a mesh, whether it skipped rows, and how it says to lift."""
    solved = getattr(mesh, "triangulation", None)  # of a `Surface`, whose plane may be any
    said = (lambda _: {}) if told else options_of
    lifted_by = said(mesh if solved is None else solved)
    if solved is not None and hasattr(mesh, "faces"):
        if "constraints" in lifted_by and len(mesh.faces) < len(solved.simplices):
            lifted_by["carved"] = True
        return solved.points, mesh.faces, len(solved.skipped) > 0, lifted_by
    if hasattr(mesh, "points") and hasattr(mesh, "simplices"):
        return mesh.points, mesh.simplices, len(getattr(mesh, "skipped", ())) > 0, lifted_by
    if hasattr(mesh, "get_masked_triangles"):  # of matplotlib
        return np.column_stack([mesh.x, mesh.y]), mesh.get_masked_triangles(), False, {}
    cloud = _as_mesh(mesh)
    return cloud.points, cloud.faces, False, said(cloud)


def _as_mesh(mesh: Any) -> Any:
    from liftmesh.io.read import read_cloud  # noqa: PLC0415 - arrays do without

    cloud = read_cloud(mesh)
    if cloud.faces is None or not len(cloud.faces):
        what = repr(mesh) if isinstance(mesh, str | os.PathLike) else f"a {type(mesh).__name__}"
        raise InputError(
            f"{what} without triangles cannot be verified: give a mesh, or give simplices besides; "
            "simplices need the shape (m, 3)"
        )
    return cloud


def _as_tuples(given: ArrayLike, width: int, name: str, each: str) -> Array:
    """Convert the corners of triangles, or the ends of constraints."""
    array = _as_integers(_as_array(given, width, name, each), each)
    if array.ndim == 2 and array.shape[1] == width and array.dtype.kind in "iu":
        if width > 2 and len(array) > (most := _MOST_CORNERS // width):
            what = "triangles" if width == 3 else "tetrahedra"
            raise InputError(f"{len(array):,} {what} are more than {most:,}")
        return array
    if array.size == 0:
        return np.empty((0, width), dtype=np.int32)
    remedy = f"give {name}.T" if array.ndim == 2 and len(array) == width else _REMEDIES[each]
    raise InputError(
        f"{name} need the shape ({'m' if width > 2 else 'k'}, {width}) and 64-bit integers, not "
        f"{array.shape} of {array.dtype}: {remedy}"
    )


def _as_array(given: ArrayLike, width: int, name: str, each: str) -> Array:
    try:
        array = np.asanyarray(given)
    except ValueError as error:
        odd = _odd(given, width, each, error)
        raise InputError(f"{name} are not an array: {odd}: {_REMEDIES[each]}") from error
    if is_masked_array(array) and np.ma.is_masked(array):
        first = np.argwhere(np.atleast_1d(np.ma.getmaskarray(array)))[0, 0]
        raise InputError(f"{name} are masked, first at {each} {first}: leave masked ones out")
    return np.asarray(array)


def _odd(given: Any, width: int, each: str, error: ValueError) -> str:
    """Describe the triangle, or the constraint, because of which there is no array."""
    reason = str(error).rstrip(".")
    if not isinstance(given, Sequence):
        return reason
    odd = (at for at, row in enumerate(given) if not isinstance(row, Sized) or len(row) != width)
    row = next(odd, None)
    return reason if row is None else f"{each} {row} is {repr(given[row])[:80]}"


def _as_integers(array: Array, each: str) -> Array:
    """Convert Python's integers, which may be of any size, to 64-bit ones."""
    if array.dtype.kind != "O" or array.ndim != 2:
        return array
    for (row, _), value in np.ndenumerate(array):
        if not isinstance(value, int | np.integer) or not -(2**63) <= value < 2**63:
            raise InputError(
                f"{each} {row} refers to row {repr(value)[:80]}, which is not a 64-bit integer: "
                f"{_REMEDIES[each]}"
            )
    return array.astype(np.int64)


def _as_ends(edges: Array, rows: Reals) -> Rows:
    """Check that both ends of each constraint are finite rows."""
    is_row = (edges >= 0) & (edges < len(rows))
    if not is_row.all():
        constraint, end = np.argwhere(~is_row)[0]
        raise InputError(
            f"constraint {constraint} refers to row {edges[constraint, end]}; there are "
            f"{counted(len(rows), 'row')}: leave it out, or add the point"
        )
    ends = np.ascontiguousarray(edges, dtype=np.int32)
    finite = np.isfinite(rows[:, 0]) & np.isfinite(rows[:, 1])
    if not finite.all() and not (are_finite := finite[ends]).all():
        constraint, end = np.argwhere(~are_finite)[0]
        row = int(ends[constraint, end])
        x, y = rows[row, :2].tolist()
        raise InputError(
            f"constraint {constraint} ends at row {row} ({x!r}, {y!r}), which is not finite: leave "
            "it out"
        )
    return ends


def _as_int32(given: Array) -> Rows:
    """Narrow the corners to int32; those that do not fit become -1, which is not a row."""
    if given.dtype.itemsize >= 4 and given.dtype != np.int32:
        fits = (given >= 0) & (given <= np.iinfo(np.int32).max)
        if not fits.all():
            given = np.where(fits, given, -1)
    return np.ascontiguousarray(given, dtype=np.int32)


def _certify(
    rows: Reals,
    given: Array,
    verdict: _kernel.Verdict,
    sums: tuple[str, str],
    kind: TriangulationKind,
    constraints: Rows | None,
    carved: bool,
) -> Certificate:
    _, _, skipped, vertices, merged, hidden, interior_edges, boundary_edges, places, off = verdict
    violations = TriangleViolations(rows, given, kind, constraints)
    reported = zip(MEANINGS, places, strict=True)
    flaws = {name: violations.flaw(name, *counted) for name, counted in reported if counted[0]}
    is_counted = not flaws.keys() & _PREMATURE
    edges = interior_edges + boundary_edges
    if is_counted:
        found = _euler_flaw(len(given), vertices, edges, boundary_edges)
        flaws |= found if not carved else {k: v for k, v in found.items() if k != "euler"}
    missing = flaws["missing_vertices"].count if "missing_vertices" in flaws else 0
    # Of lifts that may hide rows, those without a vertex are judged if nothing else is wrong.
    is_judged = not kind.may_hide or not flaws.keys() - {"not_canonical", "missing_vertices"}
    is_swept = not carved or off is not None
    outside = off or 0
    others = len(rows) - skipped - vertices - missing - hidden - outside
    return Certificate(
        n_rows=len(rows),
        n_skipped=skipped,
        n_vertices=vertices if is_counted else None,
        n_duplicates=others if is_counted and is_judged and is_swept else None,
        n_merged=merged if is_counted else None,
        n_triangles=len(given),
        n_edges=edges if is_counted else None,
        n_hull_edges=boundary_edges if is_counted else None,
        flaws=tuple(sorted(flaws.values(), key=lambda flaw: flaw.kind == "not_canonical")),
        points_sha256=sums[0],
        simplices_sha256=sums[1],
        version=_kernel.VERSION,
        member=kind.name if constraints is None else "constrained",
        n_hidden=hidden if is_counted and is_judged else None,
        metric=kind.metric,
        values_sha256=sha256_of(kind.values, "<f8") if kind.has_values else None,
        n_constraints=None if constraints is None else len(constraints),
        n_outside=outside if is_counted and is_swept else None,
        carved=carved,
        constraints_sha256=None if constraints is None else sha256_of(constraints, "<i4"),
    )


def _with_shape(
    certificate: Certificate, rows: Reals, corners: Rows, threads: int | None
) -> Certificate:
    """Add whether triangles that are not valid are planar, and others Delaunay."""
    is_lined = certificate.member == "constrained"
    if certificate.member != "delaunay" and not is_lined:
        return certificate
    is_delaunay = is_planar = certificate.valid
    if not certificate.valid:
        kinds = {flaw.kind for flaw in certificate.flaws}
        is_asked = len(corners) > 0 and not kinds & _PREMATURE
        is_planar = is_asked and is_triangulation(rows, corners, threads)
    elif is_lined:
        is_delaunay = is_locally_delaunay(rows, corners, threads)
    told = None if is_lined and not certificate.valid else is_delaunay
    return replace(certificate, planar=is_planar, delaunay=told)


def _euler_flaw(triangles: int, vertices: int, edges: int, boundary_edges: int) -> dict[str, Flaw]:
    """Compare the counts with those of a triangulated disk."""
    if not triangles:
        return {"no_triangles": Flaw("no_triangles", 1, "there are no triangles")}
    if not boundary_edges:
        return {"no_boundary": Flaw("no_boundary", 1, "the triangles have no boundary")}
    characteristic = vertices - edges + triangles
    if characteristic == 1:
        return {}
    text = f"vertices - edges + triangles is {characteristic}; Euler's relation requires 1"
    return {"euler": Flaw("euler", 1, text)}


def _sums(rows: Reals, given: Array, in_parallel: bool) -> tuple[str, str]:
    """Hash points and triangles, in parallel if a thread can be started."""
    points, triangles = (rows[:, :2], "<f8"), (given, narrowest(given))
    if in_parallel:
        from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - few runs need it

        with suppress(RuntimeError), ThreadPoolExecutor(1) as pool:  # "can't start new thread"
            other = pool.submit(sha256_of, *points)
            own = sha256_of(*triangles)
            return other.result(), own
    return sha256_of(*points), sha256_of(*triangles)
