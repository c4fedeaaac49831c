"""Where a graph of disks is wrong, in words: descriptions of the places that the kernel reports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.planar.certificate import Flaw, Offender
from liftmesh.planar.offenders import counted, named

Place: TypeAlias = tuple[int, int]

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
        "pair of the hull is not followed, or has no triangle",
        "pairs of the hull are not followed, or have no triangle",
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


@dataclass(frozen=True, slots=True)
class DiskEvidence:
    """Descriptions of places in a graph whose arrays are converted."""

    centers: Floats
    lists: dict[str, Rows]

    def flaw(self, kind: str, count: int, places: list[Place]) -> Flaw:
        """Describe one kind of flaw."""
        describe = getattr(self, f"_{kind}")
        return counted(kind, count, MEANINGS[kind], [describe(*place) for place in places])

    def _points(self, *rows: int) -> tuple[tuple[float, float], ...]:
        return tuple((float(x), float(y)) for x, y in self.centers[list(rows)])

    def _at(self, text: str, *rows: int, triangles: tuple[int, ...] = ()) -> Offender:
        return Offender(text, rows, self._points(*rows), triangles)

    def _named(self, *rows: int) -> str:
        return named(rows, self._points(*rows))

    def _invalid_index(self, number: int, place: int) -> Offender:
        name, values = list(self.lists.items())[number]
        row, *_ = at = np.unravel_index(place, values.shape)
        is_triangle = name == "neighbors"
        what, others = ("triangle", "") if is_triangle else ("row", ", or not finite")
        value = int(values[at])
        shown = "a number beyond 32 bits" if value == BEYOND else str(value)
        text = f"{name}[{row}] refers to {what} {shown}, which is none{others}"
        return Offender(text, (), triangles=(int(row),) if number < 2 else ())

    def _at_triangle(self, triangle: int, text: str) -> Offender:
        rows = self.lists["simplices"][triangle].tolist()
        of = f"triangle {triangle} of {self._named(*rows)}"
        return self._at(f"{of} {text}", *rows, triangles=(triangle,))

    def _degenerate(self, triangle: int, _: int) -> Offender:
        return self._at_triangle(triangle, "has a disk that is within another of the three")

    def _no_circle(self, triangle: int, _: int) -> Offender:
        return self._at_triangle(triangle, "has no circle that is touched in this order")

    def _other_circles(self, triangle: int, _: int) -> Offender:
        return self._at_triangle(triangle, "has other numbers for its circle than `apollonius`")

    def _edge(self, place: int, text: str) -> Offender:
        """Describe an edge: of a triangle, of the hull, or from a disk of the hull to infinity."""
        simplices, hull = self.lists["simplices"], self.lists["convex_hull"]
        if place < simplices.size:
            triangle, k = divmod(place, 3)
            rows = np.roll(simplices[triangle], -k - 1)[:2].tolist()
            beside = (triangle, int(self.lists["neighbors"][triangle, k]))
            edge = f"the edge of triangle {triangle} between {self._named(*rows)}"
            return self._at(f"{edge} {text}", *rows, triangles=tuple(t for t in beside if t >= 0))
        pair, is_beyond = (place - simplices.size) % len(hull), place >= simplices.size + len(hull)
        if not is_beyond:
            rows = hull[pair].tolist()
            return self._at(f"the edge of the hull between {self._named(*rows)} {text}", *rows)
        rows = [*hull[pair].tolist(), int(hull[(pair + 1) % len(hull)][1])]
        return self._at(f"the hull at the second of {self._named(*rows)} {text}", *rows)

    def _wrong_neighbors(self, place: int, _: int) -> Offender:
        beyond = int(self.lists["neighbors"].flat[place])
        if beyond < 0:
            return self._edge(place, "has no neighbour, and is not in the hull once")
        return self._edge(place, f"names triangle {beyond}, which does not have it, or not this")

    def _wrong_hull(self, pair: int, _: int) -> Offender:
        rows = self.lists["convex_hull"][pair].tolist()
        text = "is not followed by one that begins where it ends, or has not one triangle"
        return self._at(f"the pair {pair} of the hull, {self._named(*rows)}, {text}", *rows)

    def _boundary_winding(self, _: int, windings: int) -> Offender:
        return Offender(f"the hull winds around {windings} times", ())

    def _not_delaunay(self, place: int, _: int) -> Offender:
        return self._edge(place, "has a disk beside it that enters the circle on the other side")

    def _wrong_order(self, place: int, _: int) -> Offender:
        text = "has its two circles in the wrong order along what separates both cells"
        return self._edge(place, text)

    def _not_canonical(self, place: int, _: int) -> Offender:
        return self._edge(place, "is another one under the symbolic perturbation")

    def _missing_vertices(self, row: int, _: int) -> Offender:
        text = f"{self._named(row)} is in no triangle, not hidden, and no duplicate"
        return self._at(text, row)

    def _wrong_hidden(self, row: int, why: int) -> Offender:
        return self._at(f"{self._named(row)} {_NOT_HIDDEN[why]}", row)

    def _wrong_duplicates(self, row: int, other: int) -> Offender:
        text = "are not the same disk, or the second is not the first of its rows with triangles"
        return self._at(f"{self._named(row, other)} {text}", row, other)


BEYOND = -(2**31)  # in place of what has more than 32 bits
