"""The tasks of chunks of a source, a first reading and sorting by tile; and the rows so sorted.

As in `schedule.py`, what is done and sound is not done again. No table has the tiles of all chunks
at once: with 10,000 of each it would have 10^8 numbers. A tile reads from each sorted chunk where
its rows are, then these rows.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.base.arrays import non_finite
from liftmesh.errors import FormatError, InputError, NonFiniteError, Option
from liftmesh.io.read import classes_of
from liftmesh.tiles.options import RunContext, group_suffix
from liftmesh.tiles.plan import Plan, set_apart
from liftmesh.tiles.schema import heights_of, planar_of
from liftmesh.tiles.store import (
    PLAN,
    fill,
    is_sound,
    kind_of,
    load_json,
    load_record,
    save_array,
    save_record,
    values_of,
)

if TYPE_CHECKING:
    from liftmesh.tiles.source_chunks import SourceChunk


@dataclass(frozen=True)
class Scanned:
    """What a first reading of a chunk tells; of a surface, its values have a digest, too."""

    rows: int
    digest: str
    sample: Floats
    values: str = ""
    classes: Mapping[int, int] = field(default_factory=dict)

    @property
    def as_chunk(self) -> dict[str, Any]:
        """What a manifest says of the chunk."""
        said: dict[str, Any] = {"rows": self.rows, "sha256": self.digest}
        said |= {"values": self.values} if self.values else {}
        classes = {str(each): rows for each, rows in self.classes.items()}
        return said | ({"classes": classes} if classes else {})


def scan(chunk: SourceChunk, first: int, sampled: int, skips: bool) -> Scanned:
    """Read a chunk for the first time."""
    records = chunk.records()
    digest, values = digests_of(records)
    rows = planar_of(records)
    finite = np.isfinite(rows[:, 0]) & np.isfinite(rows[:, 1])  # eight times as fast as `all`
    heights = heights_of(records)
    if heights is not None:
        finite &= np.isfinite(heights)
    is_whole = bool(finite.all())
    if not (skips or is_whole):
        raise _non_finite(chunk, int(finite.argmin()), first, records)
    pool = rows if is_whole else rows[finite]
    rng = np.random.default_rng(int(digest[:16], 16))
    drawn = rng.integers(0, max(1, len(pool)), min(sampled, len(pool)))
    return Scanned(len(rows), digest, pool[np.sort(drawn)] + 0.0, values, classes_in(records))


def classes_in(records: Array) -> dict[int, int]:
    """Count the rows of each class of lidar, as a `Report` does; empty if there are none."""
    return classes_of({name: records[name] for name in records.dtype.names or ()})


def digests_of(records: Array) -> tuple[str, str]:
    """Hash planar positions, and the values of a surface; without values, nothing."""
    rows = planar_of(records)
    digest = hashlib.sha256(rows.data).hexdigest()
    if heights_of(records) is None:
        return digest, ""
    return digest, hashlib.sha256(records.view(np.uint8).data).hexdigest()


def _non_finite(chunk: SourceChunk, row: int, first: int, records: Array) -> NonFiniteError:
    """Name a row by its file, its number there, and its number among all."""
    place = np.array([records[name][row] for name, _ in chunk.schema.position])
    error = non_finite(first + row, place)
    if chunk.place is None:
        return error
    within = chunk.origin.row + row
    where = "" if within == first + row else f", its row {within}"
    return error.within(f"{chunk.origin.source}{where}")


def partition(
    context: RunContext, chunk: SourceChunk, number: int, first: int, stated: Mapping[str, Any]
) -> None:
    """Sort the rows of a chunk by tile into files of the scratch folder, one for each group."""
    stem = Path(stem_of(context, number))
    record = stem.with_suffix(".json")
    digests: dict[str, str] = load_record(record, context.plan) or {}
    missing = _missing(context, stem.name, digests)
    if not missing:
        return
    records = chunk.records()
    if digests_of(records) != (stated["sha256"], stated.get("values", "")):
        raise changed(chunk)
    arrays = sorted_by_tile(load_plan(context), records, first, context.on_duplicate)
    parts = context.groups.apart(arrays)
    for end, name in missing.items():
        digests[name] = save_array(context.scratch / name, parts[end])
    save_record(record, context.plan, digests)


def _missing(context: RunContext, stem: str, digests: Mapping[str, str]) -> dict[str, str]:
    """List the files of a chunk that are needed and not there, by the ends of their names."""
    ends = context.groups.names(with_values=context.has_values, without=context.released)
    names = {end: f"{stem}{end}.npy" for end in ends}
    return {
        end: name
        for end, name in names.items()
        if name not in digests or not is_sound(context.scratch, {name: digests[name]})
    }


def sorted_by_tile(plan: Plan, records: Array, first: int, on_duplicate: str) -> dict[str, Array]:
    """Sort rows by tile; planar records are changed."""
    rows = planar_of(records)
    heights = heights_of(records)
    if heights is not None:
        rows[~np.isfinite(heights)] = np.nan
    apart, which, firsts = set_apart(rows, plan.repeated, heights, on_duplicate)
    tiles, begins, boxes, skipped = plan.partition(rows, first)
    pairs = first + np.column_stack((apart, firsts[which]))
    arrays = {
        "": tiles,
        "-begins": begins,
        "-boxes": boxes,
        "-skipped": np.setdiff1d(skipped, pairs[:, 0]),
        "-duplicates": pairs,
    }
    if heights is not None:
        arrays["-values"] = records[tiles[:, 0] - first]
        arrays["-apart"] = np.column_stack((which.astype(np.float64), heights[apart]))
    return arrays


def changed(chunk: SourceChunk) -> InputError:
    """Return the exception for rows that are not what they were."""
    first = chunk.origin.row
    return InputError(
        f"{chunk.origin.source}: rows {first:,} to {first + chunk.rows - 1:,} have changed since "
        f"this triangulation was begun: restore them, or begin anew with {Option('resume', False)}"
    )


def tile_records(context: RunContext, tile: int) -> Integers:
    """Read the rows of a tile from all chunks, in their order."""
    chunks = [*_holding(context, tile)]
    records = np.empty((_count(chunks), 3), dtype=np.int64)
    at = 0
    for stem, begin, end in chunks:
        fill(records[at : at + end - begin], Path(f"{stem}.npy"), 3 * begin)
        at += end - begin
    return records


def tile_values(context: RunContext, tile: int) -> Array:
    """Read the values of a tile's rows from all chunks, in the order of `tile_records`."""
    chunks = [*_holding(context, tile)]
    group = group_suffix(context.groups.of(tile))
    kind = kind_of(Path(f"{stem_of(context, 0)}{group}-values.npy"))  # of all chunks
    values = np.empty(_count(chunks), kind)
    at = 0
    for stem, begin, end in chunks:
        fill(values[at : at + end - begin], Path(f"{stem}-values.npy"), begin)
        at += end - begin
    return values


def tile_sample(context: RunContext, tile: int, count: int) -> Floats:
    """Draw rows of a tile from all chunks, evenly."""
    chunks = [*_holding(context, tile)]
    step = max(1, _count(chunks) // count)
    drawn = [
        np.array(np.load(f"{stem}.npy", mmap_mode="r")[begin:end:step])
        for stem, begin, end in chunks
    ]
    return np.concatenate(drawn).view(np.float64)[:, 1:]


def stem_of(context: RunContext, number: int) -> str:
    """Return how the names of the files of a chunk begin, with the folder."""
    return str(context.scratch / f"run-{number:05d}")


def _holding(context: RunContext, tile: int) -> Iterator[tuple[str, int, int]]:
    """Find the rows of a tile in all chunks: how the names of the files begin, and which rows."""
    group = context.groups.of(tile)
    first = context.groups.tiles_of(group).start
    for number in range(context.chunks):
        stem = stem_of(context, number)
        begins = values_of(Path(f"{stem}-begins.npy"), first, tile + 2).tolist()
        if begins[-2] < begins[-1]:
            yield f"{stem}{group_suffix(group)}", begins[-2] - begins[0], begins[-1] - begins[0]


def _count(chunks: list[tuple[str, int, int]]) -> int:
    return sum(end - begin for _, begin, end in chunks)


def save_boxes(context: RunContext, plan: Plan) -> tuple[list[int], Integers]:
    """Write the boxes of all nodes, from those of the chunks; count the rows of the tiles."""
    sizes = np.zeros(plan.tiles, dtype=np.int64)
    tight = np.tile([np.inf, np.inf, -np.inf, -np.inf], (plan.tiles, 1))
    skipped = [np.empty(0, dtype=np.int64)]
    for number in range(context.chunks):
        stem = stem_of(context, number)
        sizes += np.diff(np.load(f"{stem}-begins.npy"))
        boxes = np.load(f"{stem}-boxes.npy")
        tight[:, :2] = np.minimum(tight, boxes)[:, :2]
        tight[:, 2:] = np.maximum(tight, boxes)[:, 2:]
        skipped.append(np.load(f"{stem}-skipped.npy"))
    save_array(context.scratch / "boxes.npy", plan.around(tight))
    counts: list[int] = sizes.tolist()
    return counts, np.concatenate(skipped)


def save_plan(context: RunContext, plan: Plan) -> None:
    """Write where the tiles are."""
    save_record(context.scratch / PLAN, context.plan, plan.as_dict())


def earlier_plan(context: RunContext) -> Plan | None:
    """Read where the tiles of an earlier run are."""
    try:
        name = load_json(context.scratch / PLAN).get("plan")
    except (FileNotFoundError, FormatError):
        return None
    lists = load_record(context.scratch / PLAN, name) if isinstance(name, str) else None
    return None if lists is None else Plan.from_dict(lists)


def load_plan(context: RunContext) -> Plan:
    """Read where the tiles are."""
    lists = load_record(context.scratch / PLAN, context.plan)
    if lists is None:
        raise FormatError(f"{context.scratch / PLAN}: not of this run: tile the source again")
    return Plan.from_dict(lists)
