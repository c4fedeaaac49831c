"""What tasks read of a run: the plan, and the rows of each part, sorted by tile.

`chunks.partition` writes the rows. No table has the tiles of all runs at once: with 10,000 of each
it would have 10^8 numbers. A tile reads from each run where its rows are, then these rows.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.errors import FormatError
from liftmesh.tiles.groups import suffix
from liftmesh.tiles.manifest import PLAN
from liftmesh.tiles.plan import Plan
from liftmesh.tiles.ranges import fill, kind_of, values_of
from liftmesh.tiles.store import load_json, load_record, save_array, save_record

if TYPE_CHECKING:
    from liftmesh.tiles.stages import Folders


def tile_records(folders: Folders, tile: int) -> Integers:
    """Read the rows of a tile from all runs, in their order."""
    runs = [*_runs(folders, tile)]
    records = np.empty((_count(runs), 3), dtype=np.int64)
    at = 0
    for stem, begin, end in runs:
        fill(records[at : at + end - begin], Path(f"{stem}.npy"), 3 * begin)
        at += end - begin
    return records


def tile_values(folders: Folders, tile: int) -> Array:
    """Read the values of a tile's rows from all runs, in the order of `tile_records`."""
    runs = [*_runs(folders, tile)]
    group = suffix(folders.groups.of(tile))
    kind = kind_of(Path(f"{stem_of(folders, 0)}{group}-values.npy"))  # of all runs
    values = np.empty(_count(runs), kind)
    at = 0
    for stem, begin, end in runs:
        fill(values[at : at + end - begin], Path(f"{stem}-values.npy"), begin)
        at += end - begin
    return values


def tile_sample(folders: Folders, tile: int, count: int) -> Floats:
    """Draw rows of a tile from all runs, evenly."""
    runs = [*_runs(folders, tile)]
    step = max(1, _count(runs) // count)
    found = [
        np.array(np.load(f"{stem}.npy", mmap_mode="r")[begin:end:step]) for stem, begin, end in runs
    ]
    return np.concatenate(found).view(np.float64)[:, 1:]


def stem_of(folders: Folders, number: int) -> str:
    """Return how the names of the files of a part begin, with the folder."""
    return str(folders.scratch / f"run-{number:05d}")


def _runs(folders: Folders, tile: int) -> Iterator[tuple[str, int, int]]:
    """Find the rows of a tile in all runs: how the names of the files begin, and which rows."""
    group = folders.groups.of(tile)
    first = folders.groups.tiles_of(group).start
    for number in range(folders.runs):
        stem = stem_of(folders, number)
        begins = values_of(Path(f"{stem}-begins.npy"), first, tile + 2).tolist()
        if begins[-2] < begins[-1]:
            yield f"{stem}{suffix(group)}", begins[-2] - begins[0], begins[-1] - begins[0]


def _count(runs: list[tuple[str, int, int]]) -> int:
    return sum(end - begin for _, begin, end in runs)


def save_boxes(folders: Folders, plan: Plan) -> tuple[list[int], Integers]:
    """Write the boxes of all nodes, from those of the runs; count the rows of the tiles."""
    sizes = np.zeros(plan.tiles, dtype=np.int64)
    tight = np.tile([np.inf, np.inf, -np.inf, -np.inf], (plan.tiles, 1))
    skipped = [np.empty(0, dtype=np.int64)]
    for number in range(folders.runs):
        stem = stem_of(folders, number)
        sizes += np.diff(np.load(f"{stem}-begins.npy"))
        boxes = np.load(f"{stem}-boxes.npy")
        tight[:, :2] = np.minimum(tight, boxes)[:, :2]
        tight[:, 2:] = np.maximum(tight, boxes)[:, 2:]
        skipped.append(np.load(f"{stem}-skipped.npy"))
    save_array(folders.scratch / "boxes.npy", plan.around(tight))
    counts: list[int] = sizes.tolist()
    return counts, np.concatenate(skipped)


def save_plan(folders: Folders, plan: Plan) -> None:
    """Write where the tiles are."""
    save_record(folders.scratch / PLAN, folders.plan, plan.as_dict())


def earlier_plan(folders: Folders) -> Plan | None:
    """Read where the tiles of an earlier run are."""
    try:
        name = load_json(folders.scratch / PLAN).get("plan")
    except (FileNotFoundError, FormatError):
        return None
    lists = load_record(folders.scratch / PLAN, name) if isinstance(name, str) else None
    return None if lists is None else Plan.from_dict(lists)


def load_plan(folders: Folders) -> Plan:
    """Read where the tiles are."""
    lists = load_record(folders.scratch / PLAN, folders.plan)
    if lists is None:
        raise FormatError(f"{folders.scratch / PLAN}: not of this run: tile the source again")
    return Plan.from_dict(lists)
