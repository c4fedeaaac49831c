"""The tasks of chunks, which are parts of a source: a first reading, and rows sorted by tile.

As in `stages.py`, what is done and sound is not done again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import non_finite
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.io.surface_rows import classes_of
from liftmesh.tiles.clouds import read_part
from liftmesh.tiles.repeated import set_apart
from liftmesh.tiles.runs import load_plan, stem_of
from liftmesh.tiles.store import is_sound, load_record, save_array, save_record

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.sources import Part
    from liftmesh.tiles.stages import Folders


@dataclass(frozen=True)
class Scanned:
    """What a first reading of a part tells; of a surface, its values have a digest, too."""

    rows: int
    digest: str
    sample: Floats
    values: str = ""
    classes: Mapping[int, int] = field(default_factory=dict)

    @property
    def as_chunk(self) -> dict[str, Any]:
        """What a manifest says of the part."""
        said: dict[str, Any] = {"rows": self.rows, "sha256": self.digest}
        said |= {"values": self.values} if self.values else {}
        classes = {str(each): rows for each, rows in self.classes.items()}
        return said | ({"classes": classes} if classes else {})


def scan(part: Part, first: int, sampled: int, skips: bool) -> Scanned:
    """Read a part for the first time."""
    rows, values = read_part(part)
    digest, others = digests_of(rows, values)
    finite = np.isfinite(rows[:, 0]) & np.isfinite(rows[:, 1])  # eight times as fast as `all`
    if values is not None:
        finite &= np.isfinite(values["z"])
    is_whole = bool(finite.all())
    if not (skips or is_whole):
        row = int(finite.argmin())
        place = rows[row] if values is None else np.append(rows[row], values["z"][row])
        raise _non_finite(part, row, first, place)
    pool = rows if is_whole else rows[finite]
    rng = np.random.default_rng(int(digest[:16], 16))
    drawn = rng.integers(0, max(1, len(pool)), min(sampled, len(pool)))
    classes = {} if values is None else classes_in(values)
    return Scanned(len(rows), digest, pool[np.sort(drawn)] + 0.0, others, classes)


def classes_in(values: Array) -> dict[int, int]:
    """Count the rows of each class of lidar, as a `Report` does; empty if there are none."""
    return classes_of({name: values[name] for name in values.dtype.names or ()})


def digests_of(rows: Floats, values: Array | None) -> tuple[str, str]:
    """Hash planar positions, and the values of a surface."""
    others = "" if values is None else hashlib.sha256(values.view(np.uint8).data).hexdigest()
    return hashlib.sha256(rows.data).hexdigest(), others


def _non_finite(part: Part, row: int, first: int, values: Floats) -> NonFiniteError:
    """Name a row by its file, its number there, and its number among all."""
    error = non_finite(first + row, values)
    if part.place is None:
        return error
    within = part.origin.row + row
    where = "" if within == first + row else f", its row {within}"
    return NonFiniteError(f"{part.origin.source}{where}: {error}", row=first + row)


def partition(
    folders: Folders, part: Part, number: int, first: int, chunk: Mapping[str, Any]
) -> None:
    """Sort the rows of a part by tile into files of the scratch folder, one for each group."""
    stem = Path(stem_of(folders, number))
    record = stem.with_suffix(".json")
    digests: dict[str, str] = load_record(record, folders.plan) or {}
    missing = _missing(folders, stem.name, digests)
    if not missing:
        return
    rows, values = read_part(part)
    if digests_of(rows, values) != (chunk["sha256"], chunk.get("values", "")):
        raise changed(part)
    arrays = sorted_by_tile(load_plan(folders), rows, first, values, folders.policy)
    parts = folders.groups.apart(arrays)
    for end, name in missing.items():
        digests[name] = save_array(folders.scratch / name, parts[end])
    save_record(record, folders.plan, digests)


def _missing(folders: Folders, stem: str, digests: Mapping[str, str]) -> dict[str, str]:
    """List the files of a part that are needed and not there, by the ends of their names."""
    ends = folders.groups.names(with_values=bool(folders.policy), without=folders.released)
    names = {end: f"{stem}{end}.npy" for end in ends}
    return {
        end: name
        for end, name in names.items()
        if name not in digests or not is_sound(folders.scratch, {name: digests[name]})
    }


def sorted_by_tile(
    plan: Plan, rows: Floats, first: int, values: Array | None, policy: str
) -> dict[str, Array]:
    """Sort rows by tile."""
    if values is not None:
        rows[~np.isfinite(values["z"])] = np.nan
    heights = None if values is None else values["z"]
    apart, which, firsts = set_apart(rows, plan.repeated, heights, policy)
    records, begins, boxes, skipped = plan.partition(rows, first)
    pairs = first + np.column_stack((apart, firsts[which]))
    found = {
        "": records,
        "-begins": begins,
        "-boxes": boxes,
        "-skipped": np.setdiff1d(skipped, pairs[:, 0]),
        "-duplicates": pairs,
    }
    if values is not None:
        found["-values"] = values[records[:, 0] - first]
        found["-apart"] = np.column_stack((which.astype(np.float64), values["z"][apart]))
    return found


def changed(part: Part) -> InputError:
    """Return the exception for rows that are not what they were."""
    first = part.origin.row
    return InputError(
        f"{part.origin.source}: rows {first:,} to {first + part.rows - 1:,} have changed since "
        "this triangulation was begun: restore them, or begin anew with resume=False"
    )
