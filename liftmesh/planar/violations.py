"""Descriptions of the places where the kernel finds triangles wrong.

`Violations` is what those of triangles and those of graphs of disks share.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, TypeAlias

from liftmesh._typing import Array, Reals
from liftmesh.planar.certificate import Flaw, Violation
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.planar.kinds import TriangulationKind


Place: TypeAlias = tuple[int, int]
# In the order of the kernel's enumeration: what each kind means, for one and for several.
MEANINGS = {
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
    "missing_constraints": (
        "constraint is not a union of edges",
        "constraints are not unions of edges",
    ),
    "open_boundaries": (
        "edge of the boundary is on no constraint, and not on the convex hull",
        "edges of the boundary are on no constraint, and not on the convex hull",
    ),
    "overlaps": ("overlap of triangles is found", "overlaps of triangles are found"),
    "not_delaunay": ("edge is not locally Delaunay", "edges are not locally Delaunay"),
    "not_canonical": ("edge is not the canonical choice", "edges are not the canonical choice"),
}
_OF_LIFTED = {
    "missing_vertices": (
        "row has no vertex, and is not hidden",
        "rows have no vertex, and are not hidden",
    ),
    "not_delaunay": ("edge is not locally convex", "edges are not locally convex"),
}


def counted_flaw(
    kind: str, count: int, meanings: Mapping[str, tuple[str, str]], first: Iterable[Violation]
) -> Flaw:
    """Make a flaw whose text says how often it occurs; meanings are for one place and several."""
    one, more = meanings[kind]
    return Flaw(kind, count, f"1 {one}" if count == 1 else f"{count:,} {more}", tuple(first))


class Violations:
    """The places that the kernel reports: a method for each kind of flaw describes one of them."""

    def __init__(self, rows: Reals, meanings: Mapping[str, tuple[str, str]]) -> None:
        self._rows = rows
        self._meanings = meanings  # of each kind, for one place and for several

    def flaw(self, kind: str, count: int, places: list[Place]) -> Flaw:
        """Describe one kind of flaw, with its first places."""
        describe = getattr(self, f"_{kind}")
        return counted_flaw(kind, count, self._meanings, [describe(*place) for place in places])

    def _points(self, *rows: int) -> tuple[tuple[float, float], ...]:
        return tuple((float(x), float(y)) for x, y in self._rows[list(rows), :2])

    def _named(self, *rows: int) -> str:
        """Name rows with their coordinates."""
        named = zip(rows, self._points(*rows), strict=True)
        each = [f"{row} ({x!r}, {y!r})" for row, (x, y) in named]
        listed = " and ".join(filter(None, (", ".join(each[:-1]), each[-1])))
        return f"row{'s' if len(rows) > 1 else ''} {listed}"

    def _at(self, text: str, *rows: int, triangles: tuple[int, ...] = ()) -> Violation:
        return Violation(text, rows, self._points(*rows), triangles)


class TriangleViolations(Violations):
    """Places where triangles are wrong, with exact signs."""

    def __init__(
        self,
        rows: Reals,
        given: Array,
        kind: TriangulationKind,
        constraints: Array | None = None,
    ) -> None:
        super().__init__(rows, MEANINGS if kind.name == "delaunay" else MEANINGS | _OF_LIFTED)
        self._given = given
        self._kind = kind
        self._constraints = constraints

    def _corners(self, triangle: int) -> tuple[int, int, int]:
        a, b, c = self._given[triangle].tolist()
        return a, b, c

    def _edge(self, place: int) -> tuple[int, int]:
        corners = self._corners(place // 3) * 2
        return corners[place % 3 + 1], corners[place % 3 + 2]

    def _invalid_index(self, place: int, _: int) -> Violation:
        triangle, corner = divmod(place, 3)
        rows = self._corners(triangle)
        text = (
            f"triangle {triangle} refers to row {rows[corner]}; there are {len(self._rows):,} rows"
        )
        return Violation(text, rows, triangles=(triangle,))

    def _non_finite(self, place: int, _: int) -> Violation:
        triangle, corner = divmod(place, 3)
        rows = self._corners(triangle)
        text = f"triangle {triangle} has a corner on {self._named(rows[corner])}"
        return self._at(text, *rows, triangles=(triangle,))

    def _at_triangle(self, triangle: int, how: str) -> Violation:
        rows = self._corners(triangle)
        points = self._points(*rows)
        text = f"triangle {triangle} of {self._named(*rows)} {how}"
        return Violation(text, rows, points, (triangle,), int(orient2d(*points)))

    def _clockwise(self, triangle: int, _: int) -> Violation:
        return self._at_triangle(triangle, "is clockwise: give its corners in the opposite order")

    def _degenerate(self, triangle: int, _: int) -> Violation:
        return self._at_triangle(triangle, "is degenerate: its corners are collinear")

    def _non_manifold_edges(self, place: int, other: int) -> Violation:
        rows = self._edge(place)
        triangles = (other // 3, place // 3)
        text = (
            f"triangles {triangles[0]} and {triangles[1]} lie on the same side of the edge between "
            f"{self._named(*rows)}"
        )
        return self._at(text, *rows, triangles=triangles)

    def _at_row(self, row: int, how: str) -> Violation:
        return self._at(f"{self._named(row)} {how}", row)

    def _non_manifold_vertices(self, row: int, _: int) -> Violation:
        return self._at_row(row, "is visited by the boundary more than once")

    def _boundary_loops(self, row: int, _: int) -> Violation:
        return self._at_row(row, "is on one of the closed curves")

    def _boundary_winding(self, row: int, windings: int) -> Violation:
        return self._at_row(row, f"is on a boundary that winds around {windings} times")

    def _not_convex(self, row: int, around: int) -> Violation:
        rows = (around >> 32, row, around & 0xFFFFFFFF)
        points = self._points(*rows)
        text = f"the boundary turns right, or back, at the second of {self._named(*rows)}"
        return Violation(text, rows, points, sign=int(orient2d(*points)))

    def _missing_vertices(self, row: int, beside: int) -> Violation:
        if not beside:
            return self._at_row(row, "is not a vertex, and no vertex is at its position")
        corners = self._turned(beside - 1)
        rows = (*corners, row)
        points = self._points(*rows)
        sign = self._kind.side(rows, points)
        text = (
            f"{self._named(row)} is not a vertex, and its lift is {'below' if sign else 'on'} the "
            f"plane of triangle {beside - 1} of {self._named(*corners)}, not above it"
        )
        return Violation(text, rows, points, (beside - 1,), sign)

    def _missing_constraints(self, constraint: int, row: int) -> Violation:
        assert self._constraints is not None  # noqa: S101 - for the type checker
        ends: tuple[int, int] = tuple(self._constraints[constraint].tolist())
        text = (
            f"constraint {constraint} between {self._named(*ends)} is not a union of edges: none "
            f"goes on along it at {self._named(row)}"
        )
        return self._at(text, *ends, row)

    def _open_boundaries(self, place: int, _: int) -> Violation:
        rows = self._edge(place)
        text = f"the edge between {self._named(*rows)} has a triangle on one side only"
        return self._at(text, *rows, triangles=(place // 3,))

    def _overlaps(self, place: int, other: int) -> Violation:
        one, two = self._edge(place), self._edge(other)
        text = (
            f"the edges of the boundary between {self._named(*one)} and between "
            f"{self._named(*two)} cross or touch, or what they bound overlaps"
        )
        return self._at(text, *one, *two, triangles=(place // 3, other // 3))

    def _turned(self, triangle: int) -> tuple[int, int, int]:
        """Corners in counter-clockwise order, in which the kernel checks them."""
        a, b, c = self._corners(triangle)
        return (a, b, c) if orient2d(*self._points(a, b, c)) >= 0 else (a, c, b)

    def _across(self, place: int, other: int, perturbed: str) -> Violation:
        triangle = place // 3
        corners = self._turned(triangle)
        rows = (*corners, int(self._given[other // 3, other % 3]))
        points = self._points(*rows)
        apex = f"{self._named(rows[3])}, the apex of triangle {other // 3}"
        of = f"triangle {triangle} of {self._named(*corners)}"
        if self._kind.name == "delaunay":
            text = f"the circumcircle of {of} contains{perturbed} {apex}"
        else:
            text = f"the plane of the lifted {of} has below it{perturbed} {apex}"
        return Violation(text, rows, points, (triangle, other // 3), self._kind.side(rows, points))

    def _not_delaunay(self, place: int, other: int) -> Violation:
        return self._across(place, other, "")

    def _not_canonical(self, place: int, other: int) -> Violation:
        return self._across(place, other, ", under the symbolic perturbation,")
