"""`verify`: an exact test whether given triangles are the Delaunay triangulation of points.

The kernel checks triangles, edges, the boundary and the rows. This module turns its numbers into a
`Certificate`, with descriptions and coordinates of the first offenders.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence, Sized
from contextlib import suppress
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Progress, Reals, Rows
from liftmesh.arrays import as_coordinates, non_finite
from liftmesh.choices import NonFinite, check_option, check_progress
from liftmesh.errors import InputError
from liftmesh.planar.certificate import Certificate, Flaw, Offender
from liftmesh.planar.meshes import points_and_triangles
from liftmesh.predicates import incircle, orient2d
from liftmesh.shapes import is_masked_array
from liftmesh.threads import as_threads

Place: TypeAlias = tuple[int, int]

MOST_TRIANGLES = 2**31 // 3  # the kernel counts corners
_HASHED_AT_ONCE = 1 << 20
_REMEDY = "give the three rows of each triangle; cut other polygons into triangles first"

# In the order of the kernel's enumeration: what each kind means, for one and for several.
_MEANINGS = {
    "invalid_index": ("corner is not a row", "corners are not rows"),
    "non_finite": (
        "corner is on a row that is not finite",
        "corners are on rows that are not finite",
    ),
    "clockwise": ("triangle is clockwise", "triangles are clockwise"),
    "degenerate": ("triangle is degenerate", "triangles are degenerate"),
    "non_manifold_edges": (
        "edge is non-manifold: another triangle lies on the same side",
        "edges are non-manifold: another triangle lies on the same side",
    ),
    "non_manifold_vertices": (
        "vertex is non-manifold: the boundary visits it more than once",
        "vertices are non-manifold: the boundary visits them more than once",
    ),
    "boundary_loops": (
        "closed curve is the boundary",
        "closed curves are the boundary, which should be one",
    ),
    "boundary_winding": (
        "boundary winds around more than once",
        "boundaries wind around more than once",
    ),
    "not_convex": (
        "vertex of the boundary is not convex",
        "vertices of the boundary are not convex",
    ),
    "missing_vertices": ("row has no vertex", "rows have no vertex"),
    "not_delaunay": ("edge is not locally Delaunay", "edges are not locally Delaunay"),
    "not_canonical": ("edge is not the canonical choice", "edges are not the canonical choice"),
}
_PREMATURE = {"invalid_index", "non_finite"}  # with these, neither edges nor rows are counted


def verify(
    points: Any,
    simplices: ArrayLike | None = None,
    *,
    nonfinite: NonFinite = "error",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Certificate:
    """Verify exactly that triangles, from any source, are the Delaunay triangulation of points.

    The checks are: every corner is a row; every triangle is counter-clockwise; every edge has one
    triangle on either side, or lies on the boundary; the boundary is one convex curve that winds
    around once, so that no two triangles overlap; Euler's relation holds; every row is a vertex or
    has one at its position; and no triangle's circumcircle contains the apex of a neighbour, so
    that none contains any point. No tolerance decides anything. The only code that decides here and
    in the engines is the predicates, and the scaling by powers of two, which is checked.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3), or a mesh
        The points; z is ignored. Without `simplices`, a mesh: a `Surface`, which is checked in its
        own plane; a `Triangulation`, or one of SciPy or matplotlib; a mesh of trimesh or Open3D, a
        `Cloud` with faces, or the path of a file, which are seen from above.
    simplices : array_like of int, of shape (m, 3), optional
        The corners of each triangle as rows of `points`. Triangles may be in any order, and any
        corner may be first.
    nonfinite : {"error", "skip"}, default "error"
        Rows with NaN or infinity raise, or are skipped and must not be corners. Those that a
        `Surface` or a `Triangulation` skipped are always skipped.
    threads : int, optional
        As for `delaunay`. The certificate is the same for any number.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    Certificate
        True if the triangulation is valid; ``canonical`` is whether it is also the one that
        `delaunay` makes, as a set of triangles.

    Raises
    ------
    InputError
        `points` or `simplices` have another shape or other values, `simplices` are masked, a mesh
        has no triangles, or an option is unknown.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    UnsupportedTypeError
        The object is no mesh.
    FormatError
        The file cannot be read.

    Notes
    -----
    That the local test suffices was shown by B. Delaunay, "Sur la sphère vide" (1934). Edges are
    paired in one pass over the triangles, or by hashing and sorting: O(n log n) on every input. If
    all triangles are clockwise (or degenerate), as in a mesh to be seen from below, that is
    reported, and everything else is checked as if their corners were in the opposite order.
    Otherwise in-circle tests skip clockwise and degenerate triangles and non-manifold edges.

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
    """
    check_option("nonfinite", nonfinite, NonFinite)
    check_progress(progress)
    if simplices is None:
        points, simplices, is_skipping = points_and_triangles(points)
        nonfinite = "skip" if is_skipping else nonfinite
    rows = as_coordinates(points)
    given = _as_triples(simplices)
    corners = _as_int32(given)
    most = max(len(rows), len(corners))
    count, shared = as_threads(threads, most)
    verdict = _kernel.verify(rows, corners, nonfinite == "skip", count, shared, progress)
    status, row, *_ = verdict
    if status == "non-finite":
        raise non_finite(row, rows[row])
    sums = _sums(rows, given, count > 1 and most >= 2 * _kernel.ROWS_PER_THREAD)
    certificate = _certify(rows, given, verdict, sums)
    if progress is not None:
        progress(1.0)
    return certificate


def _as_triples(simplices: ArrayLike) -> Array:
    array = _as_integers(_as_array(simplices))
    if array.ndim == 2 and array.shape[1] == 3 and array.dtype.kind in "iu":
        if len(array) > MOST_TRIANGLES:
            raise InputError(f"{len(array):,} triangles are more than {MOST_TRIANGLES:,}")
        return array
    if array.size == 0:
        return np.empty((0, 3), dtype=np.int32)
    remedy = "give simplices.T" if array.ndim == 2 and len(array) == 3 else _REMEDY
    raise InputError(
        f"simplices need the shape (m, 3) and 64-bit integers, not {array.shape} of "
        f"{array.dtype}: {remedy}"
    )


def _as_array(simplices: ArrayLike) -> Array:
    try:
        array = np.asanyarray(simplices)
    except ValueError as error:
        raise InputError(
            f"simplices are not an array: {_odd(simplices, error)}: {_REMEDY}"
        ) from error
    if is_masked_array(array) and np.ma.is_masked(array):
        first = np.argwhere(np.atleast_1d(np.ma.getmaskarray(array)))[0, 0]
        raise InputError(f"simplices are masked, first at triangle {first}: leave masked ones out")
    return np.asarray(array)


def _odd(simplices: Any, error: ValueError) -> str:
    """Describe the triangle because of which simplices are not an array."""
    reason = str(error).rstrip(".")
    if not isinstance(simplices, Sequence):
        return reason
    odd = (at for at, row in enumerate(simplices) if not isinstance(row, Sized) or len(row) != 3)
    row = next(odd, None)
    return reason if row is None else f"triangle {row} is {repr(simplices[row])[:80]}"


def _as_integers(array: Array) -> Array:
    """Convert Python's integers, which may be of any size, to 64-bit ones."""
    if array.dtype.kind != "O" or array.ndim != 2:
        return array
    for (triangle, _), value in np.ndenumerate(array):
        if not isinstance(value, int | np.integer) or not -(2**63) <= value < 2**63:
            raise InputError(
                f"triangle {triangle} refers to row {repr(value)[:80]}, which is not a 64-bit "
                f"integer: {_REMEDY}"
            )
    return array.astype(np.int64)


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
) -> Certificate:
    _, _, skipped, vertices, merged, interior_edges, boundary_edges, places = verdict
    evidence = _Evidence(rows, given)
    found = zip(_MEANINGS, places, strict=True)
    flaws = {kind: evidence.flaw(kind, *counted) for kind, counted in found if counted[0]}
    is_counted = not flaws.keys() & _PREMATURE
    edges = interior_edges + boundary_edges
    if is_counted:
        flaws |= _disk_flaw(len(given), vertices, edges, boundary_edges)
    missing = flaws["missing_vertices"].count if "missing_vertices" in flaws else 0
    return Certificate(
        rows=len(rows),
        skipped=skipped,
        vertices=vertices if is_counted else None,
        duplicates=len(rows) - skipped - vertices - missing if is_counted else None,
        merged=merged if is_counted else None,
        triangles=len(given),
        edges=edges if is_counted else None,
        hull_edges=boundary_edges if is_counted else None,
        flaws=tuple(sorted(flaws.values(), key=lambda flaw: flaw.kind == "not_canonical")),
        points_sha256=sums[0],
        simplices_sha256=sums[1],
        version=_kernel.VERSION,
    )


def _disk_flaw(triangles: int, vertices: int, edges: int, boundary_edges: int) -> dict[str, Flaw]:
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
    points, triangles = (rows[:, :2], "<f8"), (given, _narrowest(given))
    if in_parallel:
        from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - few runs need it

        with suppress(RuntimeError), ThreadPoolExecutor(1) as pool:  # "can't start new thread"
            other = pool.submit(_sha256, *points)
            own = _sha256(*triangles)
            return other.result(), own
    return _sha256(*points), _sha256(*triangles)


def _narrowest(given: Array) -> str:
    """Find the type in which corners are hashed: int32, unless one of them does not fit."""
    if given.dtype == np.int32 or given.size == 0:
        return "<i4"
    least, most = int(given.min()), int(given.max())
    if least >= -(2**31) and most < 2**31:
        return "<i4"
    return "<i8" if most < 2**63 else "<u8"


def _sha256(array: Array, dtype: str) -> str:
    """Hash the values in one form, for any layout, without copying the whole array."""
    digest = hashlib.sha256()
    for first in range(0, len(array), _HASHED_AT_ONCE):
        piece = np.ascontiguousarray(array[first : first + _HASHED_AT_ONCE], dtype=dtype)
        digest.update(piece.data)
    return digest.hexdigest()


class _Evidence:
    """Descriptions, coordinates and exact signs of the places that the kernel reports."""

    def __init__(self, rows: Reals, given: Array) -> None:
        self._rows = rows
        self._given = given

    def flaw(self, kind: str, count: int, places: list[Place]) -> Flaw:
        one, more = _MEANINGS[kind]
        describe = getattr(self, f"_{kind}")
        return Flaw(
            kind,
            count,
            f"1 {one}" if count == 1 else f"{count:,} {more}",
            tuple(describe(*place) for place in places),
        )

    def _points(self, *rows: int) -> tuple[tuple[float, float], ...]:
        return tuple((float(x), float(y)) for x, y in self._rows[list(rows), :2])

    def _named(self, *rows: int) -> str:
        shown = zip(rows, self._points(*rows), strict=True)
        named = [f"{row} ({x!r}, {y!r})" for row, (x, y) in shown]
        listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
        return f"row{'s' if len(rows) > 1 else ''} {listed}"

    def _corners(self, triangle: int) -> tuple[int, int, int]:
        a, b, c = self._given[triangle].tolist()
        return a, b, c

    def _edge(self, place: int) -> tuple[int, int]:
        corners = self._corners(place // 3) * 2
        return corners[place % 3 + 1], corners[place % 3 + 2]

    def _invalid_index(self, place: int, _: int) -> Offender:
        triangle, corner = divmod(place, 3)
        rows = self._corners(triangle)
        text = (
            f"triangle {triangle} refers to row {rows[corner]}; there are {len(self._rows):,} rows"
        )
        return Offender(text, rows, triangles=(triangle,))

    def _non_finite(self, place: int, _: int) -> Offender:
        triangle, corner = divmod(place, 3)
        rows = self._corners(triangle)
        text = f"triangle {triangle} has a corner on {self._named(rows[corner])}"
        return Offender(text, rows, self._points(*rows), (triangle,))

    def _at_triangle(self, triangle: int, how: str) -> Offender:
        rows = self._corners(triangle)
        points = self._points(*rows)
        text = f"triangle {triangle} of {self._named(*rows)} {how}"
        return Offender(text, rows, points, (triangle,), int(orient2d(*points)))

    def _clockwise(self, triangle: int, _: int) -> Offender:
        return self._at_triangle(triangle, "is clockwise: give its corners in the opposite order")

    def _degenerate(self, triangle: int, _: int) -> Offender:
        return self._at_triangle(triangle, "is degenerate: its corners are collinear")

    def _non_manifold_edges(self, place: int, other: int) -> Offender:
        rows = self._edge(place)
        triangles = (other // 3, place // 3)
        text = (
            f"triangles {triangles[0]} and {triangles[1]} lie on the same side of the edge between "
            f"{self._named(*rows)}"
        )
        return Offender(text, rows, self._points(*rows), triangles)

    def _at_row(self, row: int, how: str) -> Offender:
        return Offender(f"{self._named(row)} {how}", (row,), self._points(row))

    def _non_manifold_vertices(self, row: int, _: int) -> Offender:
        return self._at_row(row, "is visited by the boundary more than once")

    def _boundary_loops(self, row: int, _: int) -> Offender:
        return self._at_row(row, "is on one of the closed curves")

    def _boundary_winding(self, row: int, windings: int) -> Offender:
        return self._at_row(row, f"is on a boundary that winds around {windings} times")

    def _not_convex(self, row: int, around: int) -> Offender:
        rows = (around >> 32, row, around & 0xFFFFFFFF)
        points = self._points(*rows)
        text = f"the boundary turns right, or back, at the second of {self._named(*rows)}"
        return Offender(text, rows, points, sign=int(orient2d(*points)))

    def _missing_vertices(self, row: int, _: int) -> Offender:
        return self._at_row(row, "is not a vertex, and no vertex is at its position")

    def _across(self, place: int, other: int, how: str) -> Offender:
        triangle = place // 3
        a, b, c = self._corners(triangle)
        if orient2d(*self._points(a, b, c)) < 0:  # checked as if in the opposite order
            b, c = c, b
        rows = (a, b, c, int(self._given[other // 3, other % 3]))
        points = self._points(*rows)
        text = (
            f"the circumcircle of triangle {triangle} of {self._named(*rows[:3])} {how} "
            f"{self._named(rows[3])}, the apex of triangle {other // 3}"
        )
        return Offender(text, rows, points, (triangle, other // 3), int(incircle(*points)))

    def _not_delaunay(self, place: int, other: int) -> Offender:
        return self._across(place, other, "contains")

    def _not_canonical(self, place: int, other: int) -> Offender:
        return self._across(place, other, "contains, under the symbolic perturbation,")
