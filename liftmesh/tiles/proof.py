"""A proof, part by part, that a folder's triangles are the canonical triangulation of its points.

The argument of `verify` holds for parts, because half-edges cancel in any order. The points are
read again and sorted by tile. Each tile pairs the half-edges of its own triangles and tests the
edges between them; what has no partner goes up, with the points that have no triangle so far. Each
cut adds the triangles that lie across it and pairs what came up from both sides. What is left at
the root has to be the convex hull, edge by edge. No merge of `tile` is repeated: besides the
predicates, only the sorting of points by tile is shared with it.

Of a surface also the vertices are proved: at each position the row that `triangulate` would choose
is the one that may be named, the others are duplicates of it; and the vertices of each shard have
the coordinates and values of their rows in the source, byte for byte, but for heights that the
policy "mean" has moved. The function of `triangulate` makes the choice.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import pair_keys
from liftmesh.planar.certificate import Flaw, Violation
from liftmesh.planar.violations import MEANINGS, counted_flaw
from liftmesh.terrain.equal_positions import choose_rows
from liftmesh.tiles.adjacency import AdjacencyProof
from liftmesh.tiles.node import mesh_of
from liftmesh.tiles.options import Groups, RunContext, label
from liftmesh.tiles.plan import Plan, positions_of, set_apart
from liftmesh.tiles.schedule import in_order
from liftmesh.tiles.schema import planar_of
from liftmesh.tiles.shards import open_shard, vertices_of
from liftmesh.tiles.sorted_chunks import save_boxes, sorted_by_tile, tile_records, tile_values
from liftmesh.tiles.store import concatenated, faces_name, mapped, save_array, vertices_name

if TYPE_CHECKING:
    from liftmesh.tiles.tiled_data import TiledData

_BLOCK = 1 << 20  # triangles whose corners are looked up at once


@dataclass(frozen=True)
class Loose:
    """What a part leaves to others."""

    records: Integers
    edges: Rows
    is_bare: Array
    values: Any = None

    @property
    def points(self) -> Floats:
        """The coordinates, in place."""
        return self.records.view(np.float64)[:, 1:]


class Proof:
    """Collects what is wrong with the triangles of a folder."""

    def __init__(self, tiled: TiledData, plan: Plan, scratch: Path, threads: int) -> None:
        self._tiled = tiled
        self._plan = plan
        self._context = RunContext(tiled.folder, scratch, groups=Groups(plan.tiles))
        self._threads = threads
        self._lowest = np.full(len(plan.repeated), -1, dtype=np.int64)
        self._shards = {path.stem: path for path in tiled.shards}
        self.findings = Findings()
        self._adjacency = (
            AdjacencyProof(tiled, plan, scratch, self.findings.add)
            if tiled.manifest["neighbors"]
            else None
        )
        self.duplicates = 0

    def read(self, chunks: Iterator[Array]) -> tuple[int, str]:
        """Sort the points by tile; return how many rows were skipped, and the hash of all."""
        digest, number, first = hashlib.sha256(), 0, 0
        for number, chunk in enumerate(chunks, 1):
            digest.update(planar_of(chunk).data)
            stem = self._context.scratch / f"run-{number - 1:05d}"
            arrays = self._context.groups.apart(self._sorted(chunk, first))
            for what, array in arrays.items():
                save_array(Path(f"{stem}{what}.npy"), array)
            first += len(chunk)
        self._context = replace(self._context, chunks=number)
        _, skipped = save_boxes(self._context, self._plan)
        if not np.array_equal(skipped, self._tiled.skipped):
            self.findings.add("other_skipped", 1)
        return len(skipped), digest.hexdigest()

    def _sorted(self, records: Array, first: int) -> dict[str, Array]:
        """Sort a chunk by tile."""
        rows = planar_of(records)
        pairs = self._set_apart(rows, first)
        *arrays, skipped = self._plan.partition(rows, first)
        arrays.append(np.setdiff1d(skipped, pairs[:, 0]))
        return dict(zip(("", "-begins", "-boxes", "-skipped"), arrays, strict=True))

    def _set_apart(self, rows: Floats, first: int) -> Integers:
        """Leave out rows at positions that are repeated very often; the lowest one is known."""
        apart, which, firsts = set_apart(rows, self._plan.repeated)
        is_new = (self._lowest < 0) & (firsts >= 0)
        self._lowest[is_new] = first + firsts[is_new]
        pairs: Integers = np.column_stack((first + apart, self._lowest[which]))
        self._check_duplicates(pairs)
        return pairs

    def parts(self) -> Iterator[None]:
        """Check one part after the other, and the boundary at the end."""
        waiting: dict[int, Loose] = {}
        for name, children in in_order(self._plan):
            if name < 0:
                waiting[name] = self._tile(~name)
            else:
                waiting[name] = self._cut(name, [waiting.pop(child) for child in children])
            if self._adjacency is not None:
                self._adjacency.add(name, children)
            yield
        (root,) = waiting.values()
        self.hull_edges = len(root.edges)
        self.findings.add_rows("missing_vertices", root.records[root.is_bare])
        self._check_boundary(root)
        if self._adjacency is not None:
            self._adjacency.finish(len(root.edges))
        self._check_apart()
        if self.duplicates != len(self._tiled.duplicates):
            self.findings.add("other_duplicates", 1)

    def _tile(self, tile: int) -> Loose:
        records = tile_records(self._context, tile)
        corners = self._corners(records, ~tile)
        is_bare = np.ones(len(records), dtype=np.bool_)
        is_bare[corners.reshape(-1)] = False
        pairs = duplicated(records.view(np.float64)[:, 1:], is_bare)
        pairs, values = self._chosen_rows(tile, records, pairs)
        self.findings.add("invalid_index", int((~is_bare[pairs[:, 0]]).sum()))
        self._check_duplicates(records[pairs, 0])
        is_bare[:] = True
        is_bare[pairs[:, 0]] = False  # nothing may name them
        loose = Loose(records, np.empty((0, 3), dtype=np.int32), is_bare, values)
        return self._checked(loose, corners, ~tile)

    def _chosen_rows(self, tile: int, records: Integers, pairs: Integers) -> tuple[Integers, Any]:  # noqa: ARG002 - for surfaces
        """Return the rows left out with those that stand for them, and the values of all."""
        return pairs, None

    def _check_apart(self) -> None:
        """Check what no tile knows of duplicates: nothing is left, unless policies choose."""

    def _check_vertices(self, loose: Loose, corners: Rows, name: int) -> None:
        """Check the values of the corners of a shard, if it has any."""

    def _check_duplicates(self, pairs: Integers) -> None:
        stated = self._tiled.duplicates
        at = np.searchsorted(stated[:, 0], pairs[:, 0])
        at[at == len(stated)] = 0
        if len(pairs) and (len(stated) == 0 or not np.array_equal(stated[at], pairs)):
            self.findings.add("other_duplicates", 1)
        self.duplicates += len(pairs)

    def _cut(self, name: int, children: Sequence[Loose]) -> Loose:
        records = np.concatenate([child.records for child in children])
        order = np.argsort(records[:, 0])
        place = np.empty(len(order), dtype=np.int32)
        place[order] = np.arange(len(order), dtype=np.int32)
        begins = np.cumsum([0, *(len(child.records) for child in children)])
        edges = [place[c.edges + begin] for c, begin in zip(children, begins, strict=False)]
        is_bare = np.concatenate([child.is_bare for child in children])[order]
        values = [child.values for child in children if child.values is not None]
        joined = concatenated(values)[order] if values else None
        loose = Loose(records[order], np.concatenate(edges), is_bare, joined)
        return self._checked(loose, self._corners(loose.records, name), name)

    def _checked(self, loose: Loose, corners: Rows, name: int) -> Loose:
        """Add the triangles of a shard, and pair edges."""
        self._check_vertices(loose, corners, name)
        flaws, interior, opened = _kernel.verify_part(loose.points, corners, self._threads, False)
        self.findings.add_flaws(flaws, corners, loose.records, f"{label(name)}.npy")
        self.findings.interior_edges += interior
        is_bare = loose.is_bare.copy()
        is_bare[corners.reshape(-1)] = False
        edges = self._paired(loose, np.concatenate((loose.edges, opened)))
        stays = is_bare.copy()
        stays[edges.reshape(-1)] = True
        kept = np.flatnonzero(stays)
        place = np.empty(len(stays), dtype=np.int32)
        place[kept] = np.arange(len(kept), dtype=np.int32)
        values = None if loose.values is None else loose.values[kept]
        return Loose(loose.records[kept], place[edges], is_bare[kept], values)

    def _corners(self, records: Integers, name: int) -> Rows:
        """Read a shard, with its corners as records; triangles with others are left out."""
        path = self._shards.get(label(name))
        if path is None:
            return np.empty((0, 3), dtype=np.int32)
        triangles = open_shard(path)
        self._check_positions(path, records)
        corners = np.empty(triangles.shape, dtype=np.int32)
        is_known = np.ones(len(triangles), dtype=np.bool_)
        rows = np.ascontiguousarray(records[:, 0])
        for begin in range(0, len(triangles), _BLOCK):
            block = np.array(triangles[begin : begin + _BLOCK])
            places = _kernel.find_rows(rows, block, self._threads)
            corners[begin : begin + _BLOCK] = places
            is_known[begin : begin + _BLOCK] = (places >= 0).all(axis=1)
        if not is_known.all():
            self.findings.add_strange(triangles, ~is_known, path.name)
            corners = corners[is_known]
        return corners

    def _check_positions(self, path: Path, records: Integers) -> None:
        """Vertices that a shard has itself are where the source has them."""
        vertices = vertices_of(path)
        if vertices is None or not len(records):
            return
        order = np.argsort(records[:, 0])
        rows = records[order, 0]
        at = np.minimum(np.searchsorted(rows, vertices[:, 0]), max(0, len(rows) - 1))
        places = records[order[at], 1:].view(np.float64)
        is_right = (places == vertices[:, 1:].view(np.float64)).all(axis=1)
        self.findings.add("other_coordinates", int((~is_right).sum()))

    def _paired(self, loose: Loose, edges: Rows) -> Rows:
        """Test the edges with one triangle on either side; return those without a partner."""
        low, high = edges[:, :2].min(axis=1), edges[:, :2].max(axis=1)
        key = pair_keys(low, high)
        order = np.lexsort((edges[:, 0] > edges[:, 1], key))
        key = key[order]
        begins = np.flatnonzero(np.r_[True, key[1:] != key[:-1]]) if len(key) else order
        sizes = np.diff(np.r_[begins, len(key)])
        first = begins[sizes == 2]
        one, other = order[first], order[first + 1]
        is_pair = edges[one, 0] == edges[other, 1]
        one, other = one[is_pair], other[is_pair]
        self._check_pairs(loose, edges[one], edges[other, 2])
        self.findings.interior_edges += len(one)
        is_open = np.ones(len(edges), dtype=np.bool_)
        is_open[one] = is_open[other] = False
        return edges[is_open]

    def _check_pairs(self, loose: Loose, edges: Rows, apexes: Array) -> None:
        rows = np.column_stack((edges, apexes))
        for kind, canonical in (("not_canonical", True), ("not_delaunay", False)):
            a, b, c, d = (np.ascontiguousarray(loose.points[each]) for each in rows.T)
            signs = np.empty(len(rows), dtype=np.int8)
            _kernel.incircle(a, b, c, d, signs, canonical)
            rows = rows[signs > 0]
            self.findings.add_edges(kind, loose.records[:, 0][rows])

    def _check_boundary(self, root: Loose) -> None:
        """The edges that are left have to be those of the stated hull, and the hull convex."""
        rows = np.ascontiguousarray(root.records[:, 0])
        stated = np.asarray(self._tiled.convex_hull)
        if len(root.edges) != len(stated) or not np.isin(stated, rows).all():
            self.findings.add("other_hull", 1)
            return
        hull = np.searchsorted(rows, stated)
        follows = np.full(len(rows), -1, dtype=np.int64)
        follows[root.edges[:, 0]] = root.edges[:, 1]
        is_cycle = len(np.unique(hull)) == len(hull)
        if not is_cycle or not np.array_equal(follows[hull], np.roll(hull, -1)):
            self.findings.add("other_hull", 1)
        elif not is_convex(np.ascontiguousarray(root.points[hull])):
            self.findings.add("not_convex", 1)


def duplicated(points: Floats, is_bare: Array) -> Integers:
    """Find rows at the position of a lower one, where one of them has no triangle."""
    positions = positions_of(points)
    sought = np.unique(positions[is_bare])
    if not len(sought):
        return np.empty((0, 2), dtype=np.int64)
    at = np.minimum(np.searchsorted(sought, positions), len(sought) - 1)
    rows = np.flatnonzero(sought[at] == positions)
    order = np.argsort(at[rows], kind="stable")
    rows, group = rows[order], at[rows][order]
    is_first = np.r_[True, group[1:] != group[:-1]]
    lowest = rows[is_first][np.cumsum(is_first) - 1]
    pairs: Integers = np.column_stack((rows, lowest))[~is_first]
    return pairs


def is_convex(points: Floats) -> bool:
    """Whether a closed curve turns left only, and winds around once."""
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    turns = np.empty(len(points), dtype=np.int8)
    _kernel.orient2d(before, points, after, turns)
    comes, goes = _is_less(before, points), _is_less(points, after)
    is_straight = (comes == goes) & (before != points).any(axis=1)
    is_left = (turns > 0) | ((turns == 0) & is_straight)
    return bool(is_left.all()) and int((~comes & goes).sum()) == 1


def _is_less(p: Floats, q: Floats) -> Array:
    less: Array = (p[:, 0] < q[:, 0]) | ((p[:, 0] == q[:, 0]) & (p[:, 1] < q[:, 1]))
    return less


def proof_of(tiled: TiledData, plan: Plan, scratch: Path, threads: int) -> Proof:
    """Begin the proof of a folder."""
    kind = SurfaceProof if "surface" in tiled.manifest else Proof
    return kind(tiled, plan, scratch, threads)


class SurfaceProof(Proof):
    """Collects what is wrong with the triangles and the vertices of a folder."""

    def __init__(self, tiled: TiledData, plan: Plan, scratch: Path, threads: int) -> None:
        super().__init__(tiled, plan, scratch, threads)
        self._policy: str = tiled.manifest["surface"]["on_duplicate"]
        self._chosen = np.full(len(plan.repeated), -1, dtype=np.int64)
        self._heights = np.full(len(plan.repeated), np.nan)
        self._overhangs = 0

    def _sorted(self, records: Array, first: int) -> dict[str, Array]:
        return sorted_by_tile(self._plan, records, first, self._policy)

    def _chosen_rows(self, tile: int, records: Integers, pairs: Integers) -> tuple[Integers, Any]:
        values = np.array(tile_values(self._context, tile))
        positions = records.view(np.float64)[:, 1:]
        policy = "first" if self._policy == "error" else self._policy  # overhangs are counted
        choice = choose_rows(pairs.astype(np.int32), values["z"], positions, policy)
        self._overhangs += int(np.count_nonzero(choice.overhanging))
        stays = np.ones(len(records), dtype=np.bool_)
        stays[choice.left_out] = False
        self._keep(records[stays, 0], positions[stays], values["z"][stays])
        values["z"][choice.moved] = choice.new_heights
        return np.column_stack((choice.left_out, choice.representatives)), values

    def _keep(self, rows: Integers, positions: Floats, heights: Floats) -> None:
        """Remember the rows that are chosen at positions of very many rows."""
        if not len(self._plan.repeated):
            return
        sought, here = positions_of(self._plan.repeated), positions_of(positions)
        at = np.minimum(np.searchsorted(sought, here), len(sought) - 1)
        is_there = sought[at] == here
        self._chosen[at[is_there]] = rows[is_there]
        self._heights[at[is_there]] = heights[is_there]

    def _check_apart(self) -> None:
        """Rows that are in no tile are duplicates of those that tiles have chosen."""
        for number in range(self._context.chunks):
            stem = self._context.scratch / f"run-{number:05d}"
            pairs, apart = np.load(f"{stem}-duplicates.npy"), np.load(f"{stem}-apart.npy")
            at = apart[:, 0].astype(np.int64)
            self._check_duplicates(np.column_stack((pairs[:, 0], self._chosen[at])))
            self._overhangs += int((self._heights[at] != apart[:, 1]).sum())
        if self._overhangs != self._tiled.manifest["surface"]["overhangs"]:
            self.findings.add("other_duplicates", 1)

    def _check_vertices(self, loose: Loose, corners: Rows, name: int) -> None:
        shard = f"{label(name)}.npy"
        if label(name) not in self._shards:
            return
        rows = np.ascontiguousarray(loose.records[:, 0])
        expected = mesh_of(corners, rows, loose.values)
        names = vertices_name(shard), faces_name(shard)
        for array, file in zip(expected, names, strict=True):
            if not _is_same(array, mapped(self._tiled.folder / file)):
                self.findings.add("other_vertices", 1)


def _is_same(one: Array, other: Array) -> bool:
    """Whether two arrays have the same type, shape and bytes."""
    if one.dtype != other.dtype or one.shape != other.shape:
        return False
    ours, theirs = (np.ascontiguousarray(each).view(np.uint8) for each in (one, other))
    return np.array_equal(ours, theirs)


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
