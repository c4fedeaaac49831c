"""Whether the vertices of a tiled surface are those that its policy makes of the source.

Besides what `proof.py` checks of triangles: at each position the row that `triangulate` would
choose is the one that may be named, the others are duplicates of it; and the vertices of each shard
have the coordinates and values of their rows in the source, byte for byte, but for heights that the
policy "mean" has moved. The function of `triangulate` makes the choice.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.terrain.equal_positions import choose_rows
from liftmesh.tiles.chunks import sorted_by_tile
from liftmesh.tiles.proof import Loose, Proof, duplicated
from liftmesh.tiles.repeated import positions_of
from liftmesh.tiles.runs import tile_records, tile_values
from liftmesh.tiles.stages import label
from liftmesh.tiles.store import mapped
from liftmesh.tiles.surface_files import faces_name, vertices_name
from liftmesh.tiles.vertices import mesh_of

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.tiled import Tiled


def proof_of(tiled: Tiled, plan: Plan, scratch: Path, threads: int) -> Proof:
    """Begin the proof of a folder."""
    kind = SurfaceProof if "surface" in tiled.manifest else Proof
    return kind(tiled, plan, scratch, threads)


class SurfaceProof(Proof):
    """Collects what is wrong with the triangles and the vertices of a folder."""

    def __init__(self, tiled: Tiled, plan: Plan, scratch: Path, threads: int) -> None:
        super().__init__(tiled, plan, scratch, threads)
        self._policy: str = tiled.manifest["surface"]["duplicates"]
        self._chosen = np.full(len(plan.repeated), -1, dtype=np.int64)
        self._heights = np.full(len(plan.repeated), np.nan)
        self._overhangs = 0

    def _sorted(self, rows: Floats, chunk: Array, first: int) -> dict[str, Array]:
        return sorted_by_tile(self._plan, rows, first, chunk, self._policy)

    def _tile(self, tile: int) -> Loose:
        records = tile_records(self._folders, tile)
        values = np.array(tile_values(self._folders, tile))
        corners = self._corners(records, ~tile)
        is_bare = np.ones(len(records), dtype=np.bool_)
        is_bare[corners.reshape(-1)] = False
        positions = records.view(np.float64)[:, 1:]
        pairs = duplicated(positions, is_bare).astype(np.int32)
        policy = "first" if self._policy == "error" else self._policy  # overhangs are counted
        choice = choose_rows(pairs, values["z"], positions, policy)
        self._overhangs += int(np.count_nonzero(choice.overhanging))
        self.found.add("invalid_index", int((~is_bare[choice.left_out]).sum()))
        left_out = np.column_stack((choice.left_out, choice.representatives))
        self._check_duplicates(records[left_out, 0])
        is_bare[:] = True
        is_bare[choice.left_out] = False  # nothing may name them
        self._keep(records[is_bare, 0], positions[is_bare], values["z"][is_bare])
        values["z"][choice.moved] = choice.new_heights
        loose = Loose(records, np.empty((0, 3), dtype=np.int32), is_bare, values)
        return self._checked(loose, corners, ~tile)

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
        for number in range(self._folders.runs):
            stem = self._folders.scratch / f"run-{number:05d}"
            pairs, apart = np.load(f"{stem}-duplicates.npy"), np.load(f"{stem}-apart.npy")
            at = apart[:, 0].astype(np.int64)
            self._check_duplicates(np.column_stack((pairs[:, 0], self._chosen[at])))
            self._overhangs += int((self._heights[at] != apart[:, 1]).sum())
        if self._overhangs != self._tiled.manifest["surface"]["overhangs"]:
            self.found.add("other_duplicates", 1)

    def _check_vertices(self, loose: Loose, corners: Rows, name: int) -> None:
        shard = f"{label(name)}.npy"
        if label(name) not in self._shards:
            return
        rows = np.ascontiguousarray(loose.records[:, 0])
        expected = mesh_of(corners, rows, loose.values)
        names = vertices_name(shard), faces_name(shard)
        for array, file in zip(expected, names, strict=True):
            if not _is_same(array, mapped(self._tiled.directory / file)):
                self.found.add("other_vertices", 1)


def _is_same(one: Array, other: Array) -> bool:
    """Whether two arrays have the same type, shape and bytes."""
    if one.dtype != other.dtype or one.shape != other.shape:
        return False
    ours, theirs = (np.ascontiguousarray(each).view(np.uint8) for each in (one, other))
    return np.array_equal(ours, theirs)
