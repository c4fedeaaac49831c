"""`verify`: is it the Delaunay triangulation? Asked of anybody's triangles, answered exactly.

The kernel looks at triangles, sides, the border and the rows; here its numbers become a
`Certificate`, with words and coordinates for the first offenders.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence, Sized
from contextlib import suppress
from importlib.metadata import version
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Progress, Reals, Rows
from liftmesh.arrays import as_coordinates, non_finite
from liftmesh.errors import InputError
from liftmesh.options import NonFinite, check_option
from liftmesh.planar.certificate import Certificate, Flaw, Offender
from liftmesh.predicates import incircle, orient2d
from liftmesh.threads import as_threads

Place: TypeAlias = tuple[int, int]

MOST_TRIANGLES = 2**31 // 3  # the kernel counts corners
_HASHED_AT_ONCE = 1 << 20
_REMEDY = "give the three rows of each triangle; cut other polygons into triangles first"

# In the order of the kernel's list: what each means for one, and for more.
_MEANINGS = {
    "index": ("corner is no row", "corners are no rows"),
    "non-finite": ("corner is a row that is not finite", "corners are rows that are not finite"),
    "clockwise": ("triangle turns clockwise", "triangles turn clockwise"),
    "flat": ("triangle is flat", "triangles are flat"),
    "doubled": (
        "side has another triangle on its own side",
        "sides have another triangle on their own side",
    ),
    "pinched": (
        "row is passed by the border more than once",
        "rows are passed by the border more than once",
    ),
    "pieces": ("closed curve is the border", "closed curves are the border, where one should be"),
    "winding": ("border goes round more than once", "borders go round more than once"),
    "hull": ("row of the border turns inward", "rows of the border turn inward"),
    "missing": ("row has no vertex", "rows have no vertex"),
    "delaunay": ("side is not Delaunay", "sides are not Delaunay"),
    "canonical": ("side is not the rule's choice", "sides are not the rule's choice"),
}
_PREMATURE = {"index", "non-finite"}  # where these are found, no sides or rows are counted


def verify(
    points: ArrayLike,
    simplices: ArrayLike,
    *,
    nonfinite: NonFinite = "error",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Certificate:
    """Verify that triangles are the Delaunay triangulation of points: anybody's, exactly.

    Looked at are: that every corner is a row, every triangle turns counter-clockwise, sides fit
    together in pairs, the border is one convex curve that goes round once (so no two triangles
    overlap), Euler's relation, that every row is a vertex or has one at its position, and that no
    triangle's circle holds the apex of a neighbour (so none holds any point). No tolerance decides
    anything, and nothing that decides is shared with the engines but the predicates and a checked
    scaling by powers of two.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        The points; z is not looked at.
    simplices : array_like of int, of shape (m, 3)
        The corners of each triangle as rows of `points`, in any order of triangles, with any corner
        first.
    nonfinite : {"error", "skip"}, default "error"
        Rows with NaN or infinity raise, or are counted and must not be corners.
    threads : int, optional
        As for `delaunay`. The certificate is the same for any number.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    Certificate
        True where the triangulation is valid; ``canonical`` tells whether it is also the one that
        `delaunay` makes, as a set of triangles.

    Raises
    ------
    InputError
        `points` or `simplices` have another shape or other values, `simplices` are masked, or an
        option is unknown.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".

    Notes
    -----
    That the local test suffices is B. Delaunay, "Sur la sphère vide" (1934). Sides are paired as
    triangles pass by, or by sorting: O(n log n) on every input. Where all triangles turn clockwise
    (or are flat), as in a mesh made to be seen from below, that is told, and all else is judged as
    if each were named in the other order. Of others that turn clockwise, and across sides that are
    doubled, no circle is asked.

    Examples
    --------
    >>> import liftmesh
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.25]]
    >>> bool(verify(square, liftmesh.delaunay(square).simplices))
    True
    >>> print(verify(square, [[0, 1, 2], [0, 2, 3]]))
    not valid: 1 row has no vertex; first: row 4 (0.5, 0.25) is no vertex, nor is one at its ...
    """
    check_option("nonfinite", nonfinite, NonFinite)
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
    array = _whole_numbers(_as_array(simplices))
    if array.ndim == 2 and array.shape[1] == 3 and array.dtype.kind in "iu":
        if len(array) > MOST_TRIANGLES:
            raise InputError(f"{len(array):,} triangles are more than {MOST_TRIANGLES:,}")
        return array
    if array.size == 0:
        return np.empty((0, 3), dtype=np.int32)
    raise InputError(
        f"simplices need the shape (m, 3) and whole numbers of 64 bits, not {array.shape} of "
        f"{array.dtype}: {_REMEDY}"
    )


def _as_array(simplices: ArrayLike) -> Array:
    try:
        array = np.asanyarray(simplices)
    except ValueError as error:
        raise InputError(f"simplices are no array: {_odd(simplices, error)}: {_REMEDY}") from error
    if np.ma.is_masked(array):
        first = np.argwhere(np.atleast_1d(np.ma.getmaskarray(array)))[0, 0]
        raise InputError(f"simplices are masked, first at triangle {first}: leave masked ones out")
    return np.asarray(array)


def _odd(simplices: Any, error: ValueError) -> str:
    """Name the triangle that keeps simplices from being an array."""
    reason = str(error).rstrip(".")
    if not isinstance(simplices, Sequence):
        return reason
    odd = (at for at, row in enumerate(simplices) if not isinstance(row, Sized) or len(row) != 3)
    row = next(odd, None)
    return reason if row is None else f"triangle {row} is {repr(simplices[row])[:80]}"


def _whole_numbers(array: Array) -> Array:
    """Turn Python's integers, which may be of any size, into those of 64 bits."""
    if array.dtype.kind != "O" or array.ndim != 2:
        return array
    for (triangle, _), value in np.ndenumerate(array):
        if not isinstance(value, int | np.integer) or not -(2**63) <= value < 2**63:
            raise InputError(
                f"triangle {triangle} names row {repr(value)[:80]}, which is no whole number of "
                f"64 bits: {_REMEDY}"
            )
    return array.astype(np.int64)


def _as_int32(given: Array) -> Rows:
    """Narrow the corners; what is too large for the kernel to count becomes -1, which is no row."""
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
    _, _, skipped, vertices, merged, inner, border, places = verdict
    evidence = _Evidence(rows, given)
    found = zip(_MEANINGS, places, strict=True)
    flaws = {kind: evidence.flaw(kind, *told) for kind, told in found if told[0]}
    whole = not flaws.keys() & _PREMATURE
    if whole:
        flaws |= _disk_flaw(len(given), vertices, inner + border, border)
    missing = flaws["missing"].count if "missing" in flaws else 0
    return Certificate(
        rows=len(rows),
        skipped=skipped,
        vertices=vertices if whole else None,
        duplicates=len(rows) - skipped - vertices - missing if whole else None,
        merged=merged if whole else None,
        triangles=len(given),
        edges=inner + border if whole else None,
        hull_edges=border if whole else None,
        flaws=tuple(sorted(flaws.values(), key=lambda flaw: flaw.kind == "canonical")),
        points_sha256=sums[0],
        simplices_sha256=sums[1],
        version=version("liftmesh"),
    )


def _disk_flaw(triangles: int, vertices: int, edges: int, border: int) -> dict[str, Flaw]:
    """Hold the counts against what a disk that is cut into triangles has."""
    if not triangles:
        return {"empty": Flaw("empty", 1, "there is no triangle")}
    if not border:
        return {"border": Flaw("border", 1, "there is no border")}
    characteristic = vertices - edges + triangles
    if characteristic == 1:
        return {}
    text = f"vertices - edges + triangles is {characteristic}, not 1 as Euler's relation asks"
    return {"euler": Flaw("euler", 1, text)}


def _sums(rows: Reals, given: Array, side_by_side: bool) -> tuple[str, str]:
    """Hash points and triangles; side by side, if there is a thread to be had."""
    points, triangles = (rows[:, :2], "<f8"), (given, _narrowest(given))
    if side_by_side:
        from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - few runs need it

        with suppress(RuntimeError), ThreadPoolExecutor(1) as pool:  # "can't start new thread"
            other = pool.submit(_sha256, *points)
            own = _sha256(*triangles)
            return other.result(), own
    return _sha256(*points), _sha256(*triangles)


def _narrowest(given: Array) -> str:
    """Find the type in which corners are hashed: another than int32 only where one is no row."""
    if given.dtype == np.int32 or given.size == 0:
        return "<i4"
    least, most = int(given.min()), int(given.max())
    if least >= -(2**31) and most < 2**31:
        return "<i4"
    return "<i8" if most < 2**63 else "<u8"


def _sha256(array: Array, dtype: str) -> str:
    """Hash the values in one form, whatever the array's, without a copy of it all."""
    digest = hashlib.sha256()
    for first in range(0, len(array), _HASHED_AT_ONCE):
        piece = np.ascontiguousarray(array[first : first + _HASHED_AT_ONCE], dtype=dtype)
        digest.update(piece.data)
    return digest.hexdigest()


class _Evidence:
    """Words, coordinates and exact sides for the places that the kernel names."""

    def __init__(self, rows: Reals, given: Array) -> None:
        self._rows = rows
        self._given = given

    def flaw(self, kind: str, count: int, places: list[Place]) -> Flaw:
        one, more = _MEANINGS[kind]
        tell = getattr(self, f"_{kind.replace('-', '_')}")
        return Flaw(
            kind,
            count,
            f"1 {one}" if count == 1 else f"{count:,} {more}",
            tuple(tell(*place) for place in places),
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

    def _side(self, place: int) -> tuple[int, int]:
        corners = self._corners(place // 3) * 2
        return corners[place % 3 + 1], corners[place % 3 + 2]

    def _index(self, place: int, _: int) -> Offender:
        triangle, corner = divmod(place, 3)
        rows = self._corners(triangle)
        text = f"triangle {triangle} names row {rows[corner]}; there are {len(self._rows):,} rows"
        return Offender(text, rows, triangles=(triangle,))

    def _non_finite(self, place: int, _: int) -> Offender:
        triangle, corner = divmod(place, 3)
        rows = self._corners(triangle)
        text = f"triangle {triangle} has a corner on {self._named(rows[corner])}"
        return Offender(text, rows, self._points(*rows), (triangle,))

    def _turned(self, triangle: int, how: str) -> Offender:
        rows = self._corners(triangle)
        points = self._points(*rows)
        text = f"triangle {triangle} of {self._named(*rows)} {how}"
        return Offender(text, rows, points, (triangle,), int(orient2d(*points)))

    def _clockwise(self, triangle: int, _: int) -> Offender:
        return self._turned(triangle, "turns clockwise: name its corners in the other order")

    def _flat(self, triangle: int, _: int) -> Offender:
        return self._turned(triangle, "is flat")

    def _doubled(self, place: int, other: int) -> Offender:
        rows = self._side(place)
        triangles = (other // 3, place // 3)
        text = (
            f"triangles {triangles[0]} and {triangles[1]} lie on the same side of "
            f"{self._named(*rows)}"
        )
        return Offender(text, rows, self._points(*rows), triangles)

    def _at_row(self, row: int, how: str) -> Offender:
        return Offender(f"{self._named(row)} {how}", (row,), self._points(row))

    def _pinched(self, row: int, _: int) -> Offender:
        return self._at_row(row, "is passed by the border more than once")

    def _pieces(self, row: int, _: int) -> Offender:
        return self._at_row(row, "is on one of the closed curves")

    def _winding(self, row: int, rounds: int) -> Offender:
        return self._at_row(row, f"is on a border that goes round {rounds} times")

    def _hull(self, row: int, around: int) -> Offender:
        rows = (around >> 32, row, around & 0xFFFFFFFF)
        points = self._points(*rows)
        text = f"the border turns inward, or back, at the second of {self._named(*rows)}"
        return Offender(text, rows, points, side=int(orient2d(*points)))

    def _missing(self, row: int, _: int) -> Offender:
        return self._at_row(row, "is no vertex, nor is one at its position")

    def _across(self, place: int, other: int, how: str) -> Offender:
        triangle = place // 3
        a, b, c = self._corners(triangle)
        if orient2d(*self._points(a, b, c)) < 0:  # judged as if named in the other order
            b, c = c, b
        rows = (a, b, c, int(self._given[other // 3, other % 3]))
        points = self._points(*rows)
        text = (
            f"the circle of triangle {triangle} of {self._named(*rows[:3])} {how} "
            f"{self._named(rows[3])}, the apex of triangle {other // 3}"
        )
        return Offender(text, rows, points, (triangle, other // 3), int(incircle(*points)))

    def _delaunay(self, place: int, other: int) -> Offender:
        return self._across(place, other, "holds")

    def _canonical(self, place: int, other: int) -> Offender:
        return self._across(place, other, "holds, by the rule for ties,")
