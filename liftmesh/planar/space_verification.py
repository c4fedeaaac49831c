"""Verification of tetrahedra, and of triangles on the sphere: a certificate, as in the plane.

The kernel checks simplices, facets, the surface and the rows.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Progress
from liftmesh.base.arrays import non_finite
from liftmesh.base.options import as_threads, check_progress
from liftmesh.errors import InputError
from liftmesh.planar.certificate import Certificate, Flaw, Violation, narrowest, sha256_of
from liftmesh.planar.violations import counted_flaw
from liftmesh.predicates import insphere, orient3d

# In the order of the kernel's enumeration: what each kind means, for one and for several.
_MEANINGS = {
    "invalid_index": ("corner is not a row", "corners are not rows"),
    "non_finite": (
        "corner is on a row that is not finite",
        "corners are on rows that are not finite",
    ),
    "negative": ("tetrahedron is negative", "tetrahedra are negative"),
    "degenerate": ("tetrahedron is flat", "tetrahedra are flat"),
    "non_manifold_facets": (
        "facet is non-manifold: another tetrahedron lies on the same side",
        "facets are non-manifold: another tetrahedron lies on the same side",
    ),
    "non_manifold_edges": (
        "edge of the boundary does not join two facets",
        "edges of the boundary do not join two facets",
    ),
    "boundary_winding": (
        "vertex is one around which the boundary turns more than once",
        "places are where the boundary turns more than once around a vertex",
    ),
    "not_convex": (
        "facet of the boundary is not convex",
        "places of the boundary are not convex",
    ),
    "missing_vertices": ("row has no vertex", "rows have no vertex"),
    "not_delaunay": ("facet is not locally Delaunay", "facets are not locally Delaunay"),
    "not_canonical": ("facet is not the canonical choice", "facets are not the canonical choice"),
}
_PREMATURE = {"invalid_index", "non_finite"}  # with these, nothing else is looked at


_ON_SPHERE = _MEANINGS | {
    "degenerate": (
        "triangle has two corners of one direction",
        "triangles have two corners of one direction",
    ),
    "non_manifold_edges": (
        "edge does not join two triangles",
        "edges do not join two triangles",
    ),
    "boundary_winding": (
        "vertex is one around which the triangles turn more than once",
        "places are where the triangles turn more than once around a vertex",
    ),
    "not_convex": (
        "triangle is inside of others, seen from the middle",
        "triangles are inside of others, seen from the middle",
    ),
    "missing_vertices": (
        "direction of rows has no vertex",
        "directions of rows have no vertex",
    ),
    "not_delaunay": ("edge is not locally Delaunay", "edges are not locally Delaunay"),
    "not_canonical": ("edge is not the canonical choice", "edges are not the canonical choice"),
}
_SIMPLICES = {3: ("triangle", "triangles"), 4: ("tetrahedron", "tetrahedra")}


def verify_tetrahedra(
    rows: Floats,
    given: Array,
    is_skipping: bool,
    threads: int | None,
    progress: Progress | None,
) -> Certificate:
    """Verify that tetrahedra of rows x, y, z are their Delaunay triangulation."""
    return _verified(rows, given, is_skipping, threads, progress, dimension=3)


def verify_sphere(
    rows: Floats,
    given: Array,
    is_skipping: bool,
    threads: int | None,
    progress: Progress | None,
) -> Certificate:
    """Verify that triangles of rows x, y, z are the Delaunay triangulation of their directions."""
    check_directions(rows)
    return _verified(rows, given, is_skipping, threads, progress, member="spherical")


def check_directions(rows: Floats) -> None:
    """Raise for a vector that has no direction."""
    zero = np.flatnonzero((rows == 0).all(axis=1))
    if len(zero):
        raise InputError(f"row {zero[0]} is (0, 0, 0), which has no direction: remove such rows")


def _verified(
    rows: Floats,
    given: Array,
    is_skipping: bool,
    threads: int | None,
    progress: Progress | None,
    **about: Any,
) -> Certificate:
    """Verify simplices in space. Corners that are no rows may be any integers."""
    check_progress(progress)
    used = as_threads(threads, len(rows))
    is_row = (given >= 0) & (given < len(rows))
    corners = np.ascontiguousarray(np.where(is_row, given, -1), dtype=np.int32)
    in_kernel = _kernel.verify_sphere if given.shape[1] == 3 else _kernel.verify_tetrahedra
    meanings = _ON_SPHERE if given.shape[1] == 3 else _MEANINGS
    status, row, skipped, vertices, merged, facets, hull_facets, found = in_kernel(
        rows, corners, is_skipping, *used, progress
    )
    if status == "non-finite":
        raise non_finite(row, rows[row])
    describe = _Places(rows, given) if given.shape[1] == 4 else _PlacesOnSphere(rows, given)
    flaws = [
        counted_flaw(kind, count, meanings, itertools.starmap(getattr(describe, kind), places))
        for kind, (count, places) in zip(meanings, found, strict=True)
        if count
    ]
    if not len(corners):
        _, several = _SIMPLICES[given.shape[1]]
        flaws.insert(0, Flaw(f"no_{several}", 1, f"there are no {several}"))
    kinds = {flaw.kind for flaw in flaws}
    is_counted = not kinds & _PREMATURE
    missing = sum(flaw.count for flaw in flaws if flaw.kind == "missing_vertices")
    if progress is not None:
        progress(1.0)
    return Certificate(
        n_rows=len(rows),
        n_skipped=skipped,
        n_vertices=vertices if is_counted else None,
        n_duplicates=len(rows) - skipped - vertices - missing if is_counted else None,
        n_merged=merged if is_counted else None,
        n_triangles=len(corners),
        n_edges=facets if is_counted else None,
        n_hull_edges=hull_facets if is_counted else None,
        flaws=tuple(flaws),
        points_sha256=sha256_of(rows, "<f8"),
        simplices_sha256=sha256_of(given, narrowest(given)),
        version=_kernel.VERSION,
        **about,
    )


class _Places:
    """Descriptions of the places that the kernel reports, one method for each kind of flaw."""

    def __init__(self, rows: Floats, corners: Array) -> None:
        self._rows = rows
        self._corners = corners
        self._size = corners.shape[1]
        self._one, _ = _SIMPLICES[self._size]

    def _facet(self, place: int) -> tuple[int, tuple[int, ...]]:
        simplex, k = divmod(place, self._size)
        return simplex, tuple(np.delete(self._corners[simplex], k).tolist())

    def _at(
        self, text: str, rows: tuple[int, ...], *simplices: int, sign: int | None = None
    ) -> Violation:
        points = tuple(tuple(map(float, self._rows[row])) for row in rows)
        return Violation(text, rows, points, simplices, sign)

    def invalid_index(self, place: int, _: int) -> Violation:
        simplex, k = divmod(place, self._size)
        row = int(self._corners[simplex, k])
        text = f"{self._one} {simplex} has the corner {row}, which is no row"
        return Violation(text, (row,), (), (simplex,))

    def non_finite(self, place: int, _: int) -> Violation:
        simplex, k = divmod(place, self._size)
        row = int(self._corners[simplex, k])
        text = f"{self._one} {simplex} has a corner on row {row}, which is not finite"
        return self._at(text, (row,), simplex)

    def negative(self, tetrahedron: int, _: int) -> Violation:
        rows = tuple(self._corners[tetrahedron].tolist())
        sign = int(orient3d(*self._rows[list(rows)]))
        return self._at(
            f"tetrahedron {tetrahedron} is {'negative' if sign else 'flat'}: rows {list(rows)}",
            rows,
            tetrahedron,
            sign=sign,
        )

    degenerate = negative

    def non_manifold_facets(self, place: int, other: int) -> Violation:
        tetrahedron, rows = self._facet(place)
        first, _ = self._facet(other)
        text = f"tetrahedra {first} and {tetrahedron} are on one side of rows {list(rows)}"
        return self._at(text, rows, first, tetrahedron)

    def non_manifold_edges(self, tail: int, head: int) -> Violation:
        what = "triangles" if self._size == 3 else "facets of the boundary"
        text = f"the edge between rows {tail} and {head} does not join two {what}"
        return self._at(text, (tail, head))

    def boundary_winding(self, row: int, _: int) -> Violation:
        what = "triangles turn" if self._size == 3 else "boundary turns"
        return self._at(f"the {what} more than once around row {row}", (row,))

    def not_convex(self, place: int, _: int) -> Violation:
        tetrahedron, rows = self._facet(place)
        text = f"the boundary is not convex at the facet of rows {list(rows)}"
        return self._at(text, rows, tetrahedron)

    def missing_vertices(self, row: int, _: int) -> Violation:
        point = ", ".join(repr(float(value)) for value in self._rows[row])
        there = "has its direction" if self._size == 3 else "is at its position"
        text = f"row {row} ({point}) is not a vertex, and no vertex {there}"
        return self._at(text, (row,))

    def _flippable(self, place: int, other: int, what: str) -> Violation:
        tetrahedron = place // 4
        apex = int(self._corners[other // 4, other % 4])
        rows = (*self._corners[tetrahedron].tolist(), apex)
        text = f"the sphere of tetrahedron {tetrahedron} {what} row {apex} of a neighbour"
        sign = int(insphere(*self._rows[list(rows)]))
        return self._at(text, rows, tetrahedron, other // 4, sign=sign)

    def not_delaunay(self, place: int, other: int) -> Violation:
        return self._flippable(place, other, "contains")

    def not_canonical(self, place: int, other: int) -> Violation:
        return self._flippable(place, other, "goes through, and by the rule contains,")


class _PlacesOnSphere(_Places):
    def degenerate(self, triangle: int, _: int) -> Violation:
        rows = tuple(self._corners[triangle].tolist())
        text = f"triangle {triangle} has two corners of one direction: rows {list(rows)}"
        return self._at(text, rows, triangle)

    def not_convex(self, place: int, _: int) -> Violation:
        triangle = place // 3
        rows = tuple(self._corners[triangle].tolist())
        text = f"triangle {triangle} is inside of others: rows {list(rows)}"
        return self._at(text, rows, triangle)

    def _circle(self, place: int, other: int, what: str, sign: int) -> Violation:
        triangle = place // 3
        apex = int(self._corners[other // 3, other % 3])
        rows = (*self._corners[triangle].tolist(), apex)
        text = f"the circle of triangle {triangle} {what} row {apex} of a neighbour"
        return self._at(text, rows, triangle, other // 3, sign=sign)

    def not_delaunay(self, place: int, other: int) -> Violation:
        return self._circle(place, other, "contains", 1)

    def not_canonical(self, place: int, other: int) -> Violation:
        return self._circle(place, other, "goes through, and by the rule contains,", 0)
