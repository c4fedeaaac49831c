"""The tasks of a tiled triangulation; each reads and writes files, and can be done by any process.

A task that finds its work done, and the files sound, returns what it returned then. So a run that
was killed goes on where it was.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.arrays import non_finite
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.tiles.clouds import read_part
from liftmesh.tiles.node import Frontier, Merged, joined, merge
from liftmesh.tiles.repeated import set_apart
from liftmesh.tiles.runs import load_plan, tile_records, tile_values
from liftmesh.tiles.store import (
    concatenated,
    is_sound,
    load_record,
    names_to_disk,
    save_array,
    save_record,
)
from liftmesh.tiles.vertices import Vertices, extent_of, numbered, of_rows

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.sources import Part

_HOPELESS = 0.98  # a share of rows that goes up; the next level is passed, but not two in a row


JOB = "job.json"


@dataclass(frozen=True)
class Folders:
    """Where a run writes: the triangles, and what it needs itself.

    Attributes
    ----------
    out, scratch : Path
        The folders.
    plan : str
        The hash of the plan that the files are of; empty before there is one.
    held : int
        How many points a merge may have in memory; with more, its arrays are in files.
    policy : str
        Of a surface, what is done with rows at equal positions, as ``duplicates`` of `triangulate`;
        empty for triangles alone.
    """

    out: Path
    scratch: Path
    plan: str = ""
    held: int = 0
    policy: str = ""


@dataclass(frozen=True)
class Scanned:
    """What a first reading of a part tells; of a surface, its values have a digest, too."""

    rows: int
    digest: str
    sample: Floats
    values: str = ""

    @property
    def as_chunk(self) -> dict[str, Any]:
        """What a manifest says of the part."""
        said: dict[str, Any] = {"rows": self.rows, "sha256": self.digest}
        return said | ({"values": self.values} if self.values else {})


@dataclass(frozen=True)
class Done:
    """What a node has done.

    Attributes
    ----------
    name : int
        A cut of the plan, or ``~t`` for tile t.
    rows : int
        How many points it was given.
    rows_up : int
        How many it handed up.
    bytes_up : int
        The size of what it handed up.
    triangles, duplicates : int
        How many it wrote.
    is_flat : bool
        Whether its points have no triangle.
    frontier : tuple of int
        The nodes whose files hold what goes up: itself, or, if it left all to its parent, those
        below it.
    shards, notes : dict of str to str
        The SHA-256 of the files it wrote, in the output folder and in the scratch folder.
    vertices, overhangs : int
        Of a surface, how many vertices it wrote, and how many of the duplicates are at another
        height than the row that is used.
    extent : tuple of float
        Of a surface, as from `extent_of`; empty if it wrote no vertices.
    """

    name: int
    rows: int
    rows_up: int
    bytes_up: int
    triangles: int
    duplicates: int
    is_flat: bool
    frontier: tuple[int, ...]
    shards: dict[str, str]
    notes: dict[str, str]
    vertices: int = 0
    overhangs: int = 0
    extent: tuple[float, ...] = ()

    @classmethod
    def from_dict(cls, said: Mapping[str, Any]) -> Done:
        """Return what a record of it says."""
        lists = {name: tuple(said[name]) for name in ("frontier", "extent")}
        return cls(**{**said, **lists})


def label(name: int) -> str:
    """Name the files of a node.

    >>> label(~7), label(3)
    ('tile-00007', 'seam-00003')
    """
    return f"seam-{name:05d}" if name >= 0 else f"tile-{~name:05d}"


def scan(part: Part, first: int, sampled: int, skips: bool) -> Scanned:
    """Read a part for the first time.

    Parameters
    ----------
    part : Part
        Rows of the source.
    first : int
        The number of its first row.
    sampled : int
        How many of its rows to draw.
    skips : bool
        Whether rows that are not finite are left out.

    Returns
    -------
    Scanned
        A function of the rows: they also are the seed of the sample.

    Raises
    ------
    NonFiniteError
        A row is not finite.
    """
    rows, values = read_part(part)
    digest, others = digests_of(rows, values)
    finite = np.isfinite(rows).all(axis=1)
    if values is not None:
        finite &= np.isfinite(values["z"])
    if not skips and not finite.all():
        row = int(finite.argmin())
        place = rows[row] if values is None else np.append(rows[row], values["z"][row])
        raise _non_finite(part, row, first, place)
    pool = np.flatnonzero(finite)
    rng = np.random.default_rng(int(digest[:16], 16))
    drawn = rng.integers(0, max(1, len(pool)), min(sampled, len(pool)))
    return Scanned(len(rows), digest, rows[pool[np.sort(drawn)]] + 0.0, others)


def digests_of(rows: Floats, values: Array | None) -> tuple[str, str]:
    """Hash planar positions, and the values of a surface.

    Parameters
    ----------
    rows : (n, 2) ndarray of float64
        Contiguous.
    values : (n,) structured ndarray, optional
        Contiguous.

    Returns
    -------
    (str, str)
        SHA-256 in hexadecimal digits; the second is empty without values.
    """
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
    """Sort the rows of a part by tile into a file of the scratch folder.

    Beside it: where each tile begins in it, the box of each tile's rows, the rows that are not
    finite, and duplicates of rows at positions that are repeated very often. Of a surface also the
    values of the rows, and the position and height of those duplicates.

    Parameters
    ----------
    folders : Folders
        Where to write.
    part : Part
        Rows of the source.
    number : int
        The number of the part.
    first : int
        The number of its first row.
    chunk : mapping
        What its rows were when they were first read, as of `Scanned`.

    Raises
    ------
    InputError
        The rows have changed since.
    """
    stem = f"run-{number:05d}"
    record = folders.scratch / f"{stem}.json"
    before = load_record(record, folders.plan)
    if before is not None and is_sound(folders.scratch, before):
        return
    rows, values = read_part(part)
    if digests_of(rows, values) != (chunk["sha256"], chunk.get("values", "")):
        raise changed(part)
    arrays = sorted_by_tile(load_plan(folders), rows, first, values, folders.policy)
    digests = {
        f"{stem}{what}.npy": save_array(folders.scratch / f"{stem}{what}.npy", array)
        for what, array in arrays.items()
    }
    save_record(record, folders.plan, digests)


def sorted_by_tile(
    plan: Plan, rows: Floats, first: int, values: Array | None, policy: str
) -> dict[str, Array]:
    """Sort rows by tile.

    Parameters
    ----------
    plan : Plan
        Where the tiles are.
    rows : (n, 2) ndarray of float64
        Points, which are changed.
    first : int
        The number of the first row.
    values : (n,) structured ndarray, optional
        Of a surface, its rows with their values.
    policy : str
        As of `Folders`.

    Returns
    -------
    dict of str to ndarray
        What `partition` writes, by the ends of the names.
    """
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
    """Return the exception for rows that are not what they were.

    Parameters
    ----------
    part : Part
        The rows.

    Returns
    -------
    InputError
        Not yet raised.
    """
    first = part.origin.row
    return InputError(
        f"{part.origin.source}: rows {first:,} to {first + part.rows - 1:,} have changed since "
        "this triangulation was begun: restore them, or begin anew with resume=False"
    )


def node(folders: Folders, name: int, children: Sequence[Done], threads: int) -> Done:
    """Do the work of a tile, or merge the frontiers below a cut.

    Parameters
    ----------
    folders : Folders
        Where to read and write.
    name : int
        A cut of the plan, or ``~t`` for tile t.
    children : sequence of Done
        What the two children of a cut have done.
    threads : int
        Number of threads.

    Returns
    -------
    Done
        What it did, now or in an earlier run.
    """
    record = folders.scratch / f"{label(name)}.json"
    before = load_record(record, folders.plan)
    if before is not None:
        done = Done.from_dict(before)
        if is_sound(folders.out, done.shards) and is_sound(folders.scratch, done.notes):
            return done
    done = _merged(folders, name, children, threads)
    names_to_disk(folders.out)
    save_record(record, folders.plan, asdict(done))
    return done


def _merged(folders: Folders, name: int, children: Sequence[Done], threads: int) -> Done:
    plan = load_plan(folders)
    is_root = name == 0 or plan.tiles == 1
    handed, given = sum(c.rows_up for c in children), sum(c.rows for c in children)
    were_merged = all(child.frontier == (child.name,) for child in children)
    if children and not is_root and were_merged and handed > _HOPELESS * given:
        below = tuple(source for child in children for source in child.frontier)
        return Done(name, given, handed, 0, 0, 0, all(c.is_flat for c in children), below, {}, {})
    part = Frontier(tile_records(folders, ~name)) if name < 0 else _below(folders, children)
    rows = len(part)
    boxes = np.load(folders.scratch / "boxes.npy")[plan.others(name)]
    foreign = boxes[boxes[:, 0] <= boxes[:, 2]]
    scratch = str(folders.scratch) if children and rows > folders.held else None
    records = part.records
    if folders.policy:
        part, records = numbered(part)
    found = merge(
        part, plan.cells[name], foreign, is_root=is_root, threads=threads, scratch=scratch
    )
    del part
    surface = None
    if folders.policy:
        values = tile_values(folders, ~name) if name < 0 else _values_below(folders, children)
        repeated = plan.repeated if name < 0 else plan.repeated[:0]
        surface = of_rows(found, records, values, folders.policy, repeated)
        found = surface.merged
    return _saved(folders, name, rows, found, surface, is_root=is_root)


def _saved(
    folders: Folders,
    name: int,
    rows: int,
    found: Merged,
    surface: Vertices | None,
    *,
    is_root: bool,
) -> Done:
    """Write what a node has decided."""
    stem = label(name)
    up = found.frontier
    keeps: dict[str, Array] = {"duplicates": found.duplicates, "records": up.records, "rim": up.rim}
    if is_root:
        keeps["hull"] = found.hull
    written: dict[str, Array] = {}
    if len(found.triangles):
        written[f"{stem}.npy"] = found.triangles
    if surface is not None:
        keeps |= {"values": surface.up, "heights": surface.heights}
    if surface is not None and len(surface.shard):
        written |= {f"{stem}-vertices.npy": surface.shard, f"{stem}-faces.npy": surface.faces}
    shards = {file: save_array(folders.out / file, array) for file, array in written.items()}
    notes = {
        f"{stem}-{what}.npy": save_array(folders.scratch / f"{stem}-{what}.npy", array)
        for what, array in keeps.items()
    }
    return Done(
        name,
        rows,
        len(up),
        up.nbytes + (0 if surface is None else surface.up.nbytes),
        len(found.triangles),
        len(found.duplicates),
        found.is_flat,
        (name,),
        shards,
        notes,
        0 if surface is None else len(surface.shard),
        0 if surface is None else surface.overhangs,
        () if surface is None or not len(surface.shard) else extent_of(surface.shard),
    )


def _below(folders: Folders, children: Sequence[Done]) -> Frontier:
    """Read what the children handed up."""
    names = [label(source) for child in children for source in child.frontier]
    files = [
        [folders.scratch / f"{name}-{what}.npy" for what in ("records", "rim")] for name in names
    ]
    parts = [Frontier(np.load(records, mmap_mode="r"), np.load(rim)) for records, rim in files]
    return joined(parts)


def _values_below(folders: Folders, children: Sequence[Done]) -> Array:
    """Read the values of what the children handed up."""
    names = [label(source) for child in children for source in child.frontier]
    return concatenated([np.load(folders.scratch / f"{name}-values.npy") for name in names])
