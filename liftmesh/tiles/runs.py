"""Runs: the rows of each part, sorted by tile, in files of the scratch folder.

No table has the tiles of all runs at once: with 10,000 of each it would have 10^8 numbers. A tile
reads from each run where its rows are, then these rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats, Integers
from liftmesh.tiles.store import save_array, values_of

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.stages import Folders


def tile_records(folders: Folders, tile: int) -> Integers:
    """Read the rows of a tile from all runs, in their order.

    Parameters
    ----------
    folders : Folders
        Where `partition` wrote.
    tile : int
        The number of the tile.

    Returns
    -------
    (k, 3) ndarray of int64
        Row number, x and y, as 64-bit words, by ascending row.
    """
    runs = [*_runs(folders, tile)]
    records = np.empty((sum(end - begin for _, begin, end in runs), 3), dtype=np.int64)
    at = 0
    for run, begin, end in runs:
        records[at : at + end - begin] = values_of(run, 3 * begin, 3 * end).reshape(-1, 3)
        at += end - begin
    return records


def tile_sample(folders: Folders, tile: int, count: int) -> Floats:
    """Draw rows of a tile from all runs, evenly.

    Parameters
    ----------
    folders : Folders
        Where `partition` wrote.
    tile : int
        The number of the tile.
    count : int
        How many rows, about.

    Returns
    -------
    (k, 2) ndarray of float64
        Points.
    """
    runs = [*_runs(folders, tile)]
    step = max(1, sum(end - begin for _, begin, end in runs) // count)
    found = [np.array(np.load(run, mmap_mode="r")[begin:end:step]) for run, begin, end in runs]
    return np.concatenate(found).view(np.float64)[:, 1:]


def _runs(folders: Folders, tile: int) -> Iterator[tuple[Path, int, int]]:
    """Find the rows of a tile in all runs."""
    for number in range(folders.runs):
        stem = folders.scratch / f"run-{number:05d}"
        begin, end = values_of(Path(f"{stem}-begins.npy"), tile, tile + 2).tolist()
        if begin < end:
            yield Path(f"{stem}.npy"), begin, end


def save_boxes(folders: Folders, plan: Plan) -> tuple[list[int], Integers]:
    """Write the boxes of all nodes, from those of the runs; count the rows of the tiles.

    Parameters
    ----------
    folders : Folders
        Where to read and write.
    plan : Plan
        Where the tiles are.

    Returns
    -------
    sizes : list of int
        How many rows each tile has.
    skipped : (k,) ndarray of int64
        The rows that are not finite.
    """
    sizes = np.zeros(plan.tiles, dtype=np.int64)
    tight = np.tile([np.inf, np.inf, -np.inf, -np.inf], (plan.tiles, 1))
    skipped = [np.empty(0, dtype=np.int64)]
    for number in range(folders.runs):
        stem = folders.scratch / f"run-{number:05d}"
        sizes += np.diff(np.load(f"{stem}-begins.npy"))
        boxes = np.load(f"{stem}-boxes.npy")
        tight[:, :2] = np.minimum(tight, boxes)[:, :2]
        tight[:, 2:] = np.maximum(tight, boxes)[:, 2:]
        skipped.append(np.load(f"{stem}-skipped.npy"))
    save_array(folders.scratch / "boxes.npy", plan.around(tight))
    counts: list[int] = sizes.tolist()
    return counts, np.concatenate(skipped)
