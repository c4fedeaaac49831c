"""What tasks read of a run: the plan, and rows sorted by tile, in a file for each part.

`stages.partition` writes the rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.errors import FormatError
from liftmesh.tiles.plan import Plan
from liftmesh.tiles.store import (
    concatenated,
    load_record,
    records_of,
    rows_of,
    save_array,
    save_record,
)

if TYPE_CHECKING:
    from liftmesh.tiles.stages import Folders


_PLAN = "plan.json"


def tile_records(folders: Folders, tile: int) -> Integers:
    """Read the rows of a tile from all runs, in their order.

    Parameters
    ----------
    folders : Folders
        Where `save_tables` wrote.
    tile : int
        The number of the tile.

    Returns
    -------
    (k, 3) ndarray of int64
        Row number, x and y, as 64-bit words, by ascending row.
    """
    runs = rows_of(folders.scratch / "begins.npy", tile, tile + 2).T
    records = np.empty((int((runs[:, 1] - runs[:, 0]).sum()), 3), dtype=np.int64)
    at = 0
    for number, (begin, end) in enumerate(runs.tolist()):
        if begin < end:
            path = folders.scratch / f"run-{number:05d}.npy"
            records[at : at + end - begin] = rows_of(path, begin, end)
            at += end - begin
    return records


def tile_values(folders: Folders, tile: int) -> Array:
    """Read the values of a tile's rows from all runs, in the order of `tile_records`.

    Parameters
    ----------
    folders : Folders
        Where `save_tables` wrote.
    tile : int
        The number of the tile.

    Returns
    -------
    (k,) structured ndarray
        Their coordinates and values.
    """
    runs = rows_of(folders.scratch / "begins.npy", tile, tile + 2).T.tolist()
    found = [
        records_of(folders.scratch / f"run-{number:05d}-values.npy", begin, end)
        for number, (begin, end) in enumerate(runs)
        if begin < end
    ]
    return concatenated(found or [np.load(folders.scratch / "run-00000-values.npy")[:0]])


def tile_sample(folders: Folders, tile: int, count: int) -> Floats:
    """Draw rows of a tile from all runs, evenly.

    Parameters
    ----------
    folders : Folders
        Where `save_tables` wrote.
    tile : int
        The number of the tile.
    count : int
        How many rows, about.

    Returns
    -------
    (k, 2) ndarray of float64
        Points.
    """
    runs = rows_of(folders.scratch / "begins.npy", tile, tile + 2).T
    step = max(1, int((runs[:, 1] - runs[:, 0]).sum()) // count)
    found = [
        np.array(np.load(folders.scratch / f"run-{number:05d}.npy", mmap_mode="r")[begin:end:step])
        for number, (begin, end) in enumerate(runs.tolist())
        if begin < end
    ]
    return np.concatenate(found).view(np.float64)[:, 1:]


def save_tables(folders: Folders, plan: Plan, runs: int) -> tuple[list[int], Integers]:
    """Write what all nodes need to know of the runs: boxes, and where each tile begins.

    Parameters
    ----------
    folders : Folders
        Where to read and write.
    plan : Plan
        Where the tiles are.
    runs : int
        How many parts were sorted.

    Returns
    -------
    sizes : list of int
        How many rows each tile has.
    skipped : (k,) ndarray of int64
        The rows that are not finite.
    """
    begins = np.empty((plan.tiles + 1, runs), dtype=np.int64)
    tight = np.tile([np.inf, np.inf, -np.inf, -np.inf], (plan.tiles, 1))
    skipped = [np.empty(0, dtype=np.int64)]
    for number in range(runs):
        stem = folders.scratch / f"run-{number:05d}"
        begins[:, number] = np.load(f"{stem}-begins.npy")
        boxes = np.load(f"{stem}-boxes.npy")
        tight[:, :2] = np.minimum(tight, boxes)[:, :2]
        tight[:, 2:] = np.maximum(tight, boxes)[:, 2:]
        skipped.append(np.load(f"{stem}-skipped.npy"))
    save_array(folders.scratch / "boxes.npy", plan.around(tight))
    save_array(folders.scratch / "begins.npy", begins)
    sizes: list[int] = np.diff(begins, axis=0).sum(axis=1).tolist()
    return sizes, np.concatenate(skipped)


def save_plan(folders: Folders, plan: Plan) -> None:
    """Write where the tiles are.

    Parameters
    ----------
    folders : Folders
        Where to write.
    plan : Plan
        The plan.
    """
    save_record(folders.scratch / _PLAN, folders.plan, plan.as_dict())


def load_plan(folders: Folders) -> Plan:
    """Read where the tiles are.

    Parameters
    ----------
    folders : Folders
        Where `save_plan` wrote.

    Returns
    -------
    Plan
        The plan.

    Raises
    ------
    FormatError
        It is of another run, or damaged.
    """
    lists = load_record(folders.scratch / _PLAN, folders.plan)
    if lists is None:
        raise FormatError(f"{folders.scratch / _PLAN}: not of this run: tile the source again")
    return Plan.from_dict(lists)
