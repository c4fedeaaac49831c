"""Verification of Apollonius graphs: whether arrays are the Delaunay graph of disks.

The kernel checks triangles, edges, the hull and the rows; the proof that this suffices stands at
the top of `verify/disks.cpp`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Indices, Mask, Progress, Rows
from liftmesh.base.options import as_threads, check_progress, counted
from liftmesh.disks.graph import DiskGraph, are_finite, as_disks
from liftmesh.errors import InputError
from liftmesh.planar.certificate import Certificate, Flaw, Violation, sha256_of
from liftmesh.planar.points import edges_around
from liftmesh.planar.violations import Place, Violations

_SHAPES = {"simplices": (3,), "neighbors": (3,), "convex_hull": (), "hidden": ()}
_SHAPES |= {"duplicates": (2,), "skipped": ()}
_OF_ROWS = ("missing_vertices", "wrong_hidden", "wrong_duplicates")
BEYOND = -(2**31)  # in place of what has more than 32 bits


def verify_graph(
    graph: DiskGraph, *, threads: int | None = None, progress: Progress | None = None
) -> Certificate:
    """Verify exactly that a graph, from any source, is the Delaunay graph of its disks."""
    check_progress(progress)
    disks = as_disks(graph.centers, graph.radii, "skip" if len(graph.skipped) else "error")
    lists = {name: _whole(name, getattr(graph, name), shape) for name, shape in _SHAPES.items()}
    circles = _as_circles(graph.circles, len(lists["simplices"]))
    if len(lists["neighbors"]) != len(lists["simplices"]):
        raise InputError(
            f"neighbors have {counted(len(lists['neighbors']), 'row')} for "
            f"{counted(len(lists['simplices']), 'triangle')}: give one for each"
        )
    skipped = lists.pop("skipped")
    finite = are_finite(disks)
    rows = np.flatnonzero(finite)
    flat = {name: _among(finite, name, values) for name, values in lists.items()}
    vertices, places = _kernel.verify_apollonius(
        disks[rows],
        *(flat["simplices"], flat["neighbors"], circles.reshape(-1)),
        *(edges_around(flat["convex_hull"]).reshape(-1), flat["hidden"], flat["duplicates"]),
        *as_threads(threads, len(disks)),
        progress,
    )
    violations = DiskViolations(disks[:, :2], lists)
    reported = zip(MEANINGS, places, strict=True)
    flaws = [
        violations.flaw(kind, count, _in_all_rows(rows, kind, first))
        for kind, (count, first) in reported
        if count
    ]
    if skipped.tolist() != np.flatnonzero(~finite).tolist():
        text = "the rows that are said to be skipped are others than those that are not finite"
        flaws.append(Flaw("other_skipped", 1, text))
    certificate = _certify(disks, lists, vertices, flaws)
    if progress is not None:
        progress(1.0)
    return certificate


def _among(finite: Mask, name: str, values: Rows) -> Rows:
    """Count rows without those that are not finite, which become none."""
    flat = values.reshape(-1)
    if name == "neighbors" or finite.all():
        return flat
    places = np.where(finite, np.cumsum(finite) - 1, BEYOND)
    is_row = (flat >= 0) & (flat < len(finite))
    return np.where(is_row, places[np.where(is_row, flat, 0)], BEYOND).astype(np.int32)


def _in_all_rows(rows: Indices, kind: str, places: list[Place]) -> list[Place]:
    """Count rows with all others again, where places are rows."""
    if kind not in _OF_ROWS:
        return places
    is_pair = kind == "wrong_duplicates"
    return [(int(rows[at]), int(rows[other]) if is_pair else other) for at, other in places]


def _certify(
    disks: Floats, lists: dict[str, Rows], vertices: int, flaws: list[Flaw]
) -> Certificate:
    is_counted = not any(flaw.kind == "invalid_index" for flaw in flaws)
    triangles, hull = len(lists["simplices"]), len(lists["convex_hull"])
    return Certificate(
        n_rows=len(disks),
        n_skipped=int((~are_finite(disks)).sum()),
        n_vertices=vertices if is_counted else None,
        n_duplicates=len(lists["duplicates"]) if is_counted else None,
        n_merged=0 if is_counted else None,
        n_triangles=triangles,
        n_edges=(3 * triangles + hull) // 2 if is_counted else None,
        n_hull_edges=hull if is_counted else None,
        flaws=tuple(sorted(flaws, key=_comes_last)),
        points_sha256=sha256_of(disks[:, :2], "<f8"),
        simplices_sha256=sha256_of(lists["simplices"], "<i4"),
        version=_kernel.VERSION,
        member="apollonius",
        n_hidden=len(lists["hidden"]) if is_counted else None,
        values_sha256=sha256_of(disks[:, 2], "<f8"),
    )


def _comes_last(flaw: Flaw) -> bool:
    return flaw.kind == "not_canonical"


def _whole(name: str, given: ArrayLike, columns: tuple[int, ...]) -> Rows:
    """Convert a list of rows or triangles to int32."""
    array: Any = np.asarray(given)
    if array.size == 0:
        return np.empty((0, *columns), dtype=np.int32)
    if array.ndim != 1 + len(columns) or array.shape[1:] != columns or array.dtype.kind not in "iu":
        shape = f"(k, {columns[0]})" if columns else "(k,)"
        raise InputError(
            f"{name} have the shape {array.shape} and the type {array.dtype}: give whole numbers "
            f"of the shape {shape}"
        )
    fits = (array > BEYOND) & (array < -BEYOND)
    return np.ascontiguousarray(np.where(fits, array, BEYOND), dtype=np.int32)


def _as_circles(given: ArrayLike, triangles: int) -> Floats:
    array: Any = np.asarray(given)
    if array.size == 0 and triangles == 0:
        return np.empty((0, 3))
    if array.shape != (triangles, 3) or array.dtype.kind not in "fiu":
        raise InputError(
            f"circles have the shape {array.shape} and the type {array.dtype}: give three numbers "
            f"for each of {triangles:,} triangles"
        )
    return np.ascontiguousarray(array, dtype=np.float64)


# In the order of the kernel's enumeration: what each kind means, for one and for several.
MEANINGS = {
    "invalid_index": ("entry is no row or triangle", "entries are no rows or triangles"),
    "degenerate": (
        "triangle is degenerate: one of its disks is within another",
        "triangles are degenerate: one of their disks is within another",
    ),
    "no_circle": (
        "triangle has no circle that touches its disks in their order",
        "triangles have no circle that touches their disks in their order",
    ),
    "wrong_neighbors": (
        "side has the wrong neighbour",
        "sides have the wrong neighbour",
    ),
    "wrong_hull": (
        "pair of the hull has no triangle, or several",
        "pairs of the hull have no triangle, or several",
    ),
    "boundary_winding": ("hull does not wind around once", "hulls do not wind around once"),
    "not_delaunay": (
        "edge is not Delaunay: a disk beside it enters the circle on its other side",
        "edges are not Delaunay: a disk beside them enters the circle on their other side",
    ),
    "wrong_order": (
        "edge has its two circles in the wrong order",
        "edges have their two circles in the wrong order",
    ),
    "not_canonical": ("edge is not the canonical choice", "edges are not the canonical choice"),
    "missing_vertices": (
        "row has no triangles, and is not hidden",
        "rows have no triangles, and are not hidden",
    ),
    "wrong_hidden": ("row is not hidden", "rows are not hidden"),
    "wrong_duplicates": (
        "row is not a duplicate of the row that is named",
        "rows are not duplicates of the rows that are named",
    ),
    "other_circles": (
        "circle is not the one that touches the disks of its triangle",
        "circles are not those that touch the disks of their triangles",
    ),
}
_NOT_HIDDEN = ("has triangles", "is listed twice", "is within no other disk")


class DiskViolations(Violations):
    """Places in a graph whose arrays are converted."""

    def __init__(self, centers: Floats, lists: dict[str, Rows]) -> None:
        super().__init__(centers, MEANINGS)
        self._lists = lists

    def _invalid_index(self, number: int, place: int) -> Violation:
        name, values = list(self._lists.items())[number]
        if name == "convex_hull":  # of which the kernel has pairs
            place = (place + 1) // 2 % len(values)
        row, *_ = at = np.unravel_index(place, values.shape)
        is_triangle = name == "neighbors"
        what, others = ("triangle", "") if is_triangle else ("row", ", or not finite")
        value = int(values[at])
        shown = "a number beyond 32 bits" if value == BEYOND else str(value)
        text = f"{name}[{row}] refers to {what} {shown}, which is none{others}"
        return Violation(text, (), triangles=(int(row),) if number < 2 else ())

    def _at_triangle(self, triangle: int, text: str) -> Violation:
        rows = self._lists["simplices"][triangle].tolist()
        of = f"triangle {triangle} of {self._named(*rows)}"
        return self._at(f"{of} {text}", *rows, triangles=(triangle,))

    def _degenerate(self, triangle: int, _: int) -> Violation:
        return self._at_triangle(triangle, "has a disk that is within another of the three")

    def _no_circle(self, triangle: int, _: int) -> Violation:
        return self._at_triangle(triangle, "has no circle that is touched in this order")

    def _other_circles(self, triangle: int, _: int) -> Violation:
        return self._at_triangle(triangle, "has other numbers for its circle than `apollonius`")

    def _edge(self, place: int, text: str) -> Violation:
        """Describe an edge: of a triangle, of the hull, or from a disk of the hull to infinity."""
        simplices, hull = self._lists["simplices"], self._lists["convex_hull"]
        if place < simplices.size:
            triangle, k = divmod(place, 3)
            rows = np.roll(simplices[triangle], -k - 1)[:2].tolist()
            beside = (triangle, int(self._lists["neighbors"][triangle, k]))
            edge = f"the edge of triangle {triangle} between {self._named(*rows)}"
            return self._at(f"{edge} {text}", *rows, triangles=tuple(t for t in beside if t >= 0))
        pair, is_beyond = (place - simplices.size) % len(hull), place >= simplices.size + len(hull)
        if not is_beyond:
            rows = [int(hull[pair]), int(hull[(pair + 1) % len(hull)])]
            return self._at(f"the edge of the hull between {self._named(*rows)} {text}", *rows)
        rows = [int(hull[(pair + k) % len(hull)]) for k in range(3)]
        return self._at(f"the hull at the second of {self._named(*rows)} {text}", *rows)

    def _wrong_neighbors(self, place: int, _: int) -> Violation:
        beyond = int(self._lists["neighbors"].flat[place])
        if beyond < 0:
            return self._edge(place, "has no neighbour, and is not in the hull once")
        return self._edge(place, f"names triangle {beyond}, which does not have it, or not this")

    def _wrong_hull(self, pair: int, _: int) -> Violation:
        rows = edges_around(self._lists["convex_hull"])[pair].tolist()
        text = f"the pair {pair} of the hull, {self._named(*rows)}, has no triangle, or several"
        return self._at(text, *rows)

    def _boundary_winding(self, _: int, windings: int) -> Violation:
        return Violation(f"the hull winds around {windings} times", ())

    def _not_delaunay(self, place: int, _: int) -> Violation:
        return self._edge(place, "has a disk beside it that enters the circle on the other side")

    def _wrong_order(self, place: int, _: int) -> Violation:
        text = "has its two circles in the wrong order along what separates both cells"
        return self._edge(place, text)

    def _not_canonical(self, place: int, _: int) -> Violation:
        return self._edge(place, "is another one under the symbolic perturbation")

    def _missing_vertices(self, row: int, _: int) -> Violation:
        text = f"{self._named(row)} is in no triangle, not hidden, and no duplicate"
        return self._at(text, row)

    def _wrong_hidden(self, row: int, why: int) -> Violation:
        return self._at(f"{self._named(row)} {_NOT_HIDDEN[why]}", row)

    def _wrong_duplicates(self, row: int, other: int) -> Violation:
        text = "are not the same disk, or the second is not the first of its rows with triangles"
        return self._at(f"{self._named(row, other)} {text}", row, other)
