"""What is wrong with triangles in tiles: counts of flaws and their first places, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from liftmesh._typing import Array, Integers, Rows
from liftmesh.planar.certificate import Flaw, Violation
from liftmesh.planar.violations import MEANINGS, counted_flaw

_SHOWN = 16
_MEANINGS = {
    **MEANINGS,
    "invalid_index": (
        "triangle names a row of another tile, or one at the position of a lower row",
        "triangles name rows of another tile, or rows at the position of a lower row",
    ),
    "other_hull": ("boundary is not the hull that the folder states",) * 2,
    "other_duplicates": ("list of duplicates is not that of the points",) * 2,
    "other_skipped": ("list of skipped rows is not that of the points",) * 2,
    "other_neighbors": (
        "neighbour is not the triangle beyond the edge",
        "neighbours are not the triangles beyond the edges",
    ),
    "other_coordinates": (
        "vertex of a shard is not at the position of its row",
        "vertices of shards are not at the positions of their rows",
    ),
    "other_vertices": (
        "file of vertices or faces is not that of the triangles and the points",
        "files of vertices or faces are not those of the triangles and the points",
    ),
    "damaged_files": ("file is not as it was written", "files are not as they were written"),
}


class Findings:
    """Counts of flaws, and of edges."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._first: dict[str, list[Violation]] = {}
        self.interior_edges = 0

    def add(self, kind: str, count: int, first: Sequence[Violation] = ()) -> None:
        """Count a kind of flaw, and keep some of its places."""
        if count == 0:
            return
        self._counts[kind] = self._counts.get(kind, 0) + count
        held = self._first.setdefault(kind, [])
        held += list(first)[: _SHOWN - len(held)]

    def add_rows(self, kind: str, records: Integers) -> None:
        """Count records, each with its row and coordinates."""
        first = [
            Violation(f"row {row} ({x!r}, {y!r}) has no triangle", (row,), ((x, y),))
            for row, x, y in _shown(records[:_SHOWN])
        ]
        self.add(kind, len(records), first)

    def add_strange(self, triangles: Integers, is_strange: Array, shard: str) -> None:
        """Count triangles whose rows are not those of their part."""
        at = np.flatnonzero(is_strange)
        first = [
            Violation(f"{shard}: triangle {t} of rows {_listed(triangles[t])}", (), (), (int(t),))
            for t in at[:_SHOWN]
        ]
        self.add("invalid_index", len(at), first)

    def add_edges(self, kind: str, rows: Integers) -> None:
        """Count edges between shards; the rows are the corners of a triangle, and the apex."""
        first = [Violation(_contains(each), tuple(each.tolist())) for each in rows[:_SHOWN]]
        self.add(kind, len(rows), first)

    def add_flaws(
        self,
        flaws: list[tuple[int, list[tuple[int, int]]]],
        corners: Rows,
        records: Integers,
        shard: str,
    ) -> None:
        """Count what the kernel has found within a shard."""
        for kind, (count, places) in zip(MEANINGS, flaws, strict=True):
            first = [_violation(kind, place, corners, records, shard) for place in places]
            self.add(kind, count, first)

    def flaws(self) -> tuple[Flaw, ...]:
        """Return all flaws; that of ties is the last."""
        flaws = [
            counted_flaw(kind, count, _MEANINGS, self._first[kind])
            for kind, count in self._counts.items()
        ]
        return tuple(sorted(flaws, key=lambda flaw: flaw.kind == "not_canonical"))


def _violation(
    kind: str, place: tuple[int, int], corners: Rows, records: Integers, shard: str
) -> Violation:
    """Name a triangle, or the two at an edge; edge k is opposite corner k."""
    at, other = place
    if kind in ("not_delaunay", "not_canonical"):
        triangle, apex = at // 3, corners[other // 3, other % 3]
        rows = records[:, 0][np.append(corners[triangle], apex)]
        text = _contains(rows)
    else:
        triangle = at
        rows = records[:, 0][corners[triangle]]
        text = f"triangle {triangle} of rows {_listed(rows)} is {kind}"
    return Violation(f"{shard}: {text}", tuple(rows.tolist()), (), (triangle,))


def _contains(rows: Array) -> str:
    return f"the circumcircle of rows {_listed(rows[:3])} contains row {rows[3]}"


def _listed(rows: Array) -> str:
    return ", ".join(str(row) for row in rows.tolist())


def _shown(records: Integers) -> list[tuple[int, float, float]]:
    points = records.view(np.float64)[:, 1:].tolist()
    return [(row, *point) for row, point in zip(records[:, 0].tolist(), points, strict=True)]
