"""The tasks of a tiled triangulation; each reads and writes files, and can be done by any process.

A task that finds its work done, and the files sound, returns what it returned then. So a run that
was killed goes on where it was.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.arrays import non_finite
from liftmesh.choices import ShardFormat
from liftmesh.errors import FormatError, InputError, NonFiniteError
from liftmesh.tiles.edges import open_edges, paired
from liftmesh.tiles.node import Frontier, Merged, joined, merge
from liftmesh.tiles.plan import Plan
from liftmesh.tiles.repeated import set_apart
from liftmesh.tiles.runs import tile_records
from liftmesh.tiles.shards import save_shard
from liftmesh.tiles.sources import Part, planar
from liftmesh.tiles.store import (
    is_sound,
    load_record,
    names_to_disk,
    save_array,
    save_record,
)

_HOPELESS = 0.98  # a share of rows that goes up; the next level is passed, but not two in a row


JOB = "job.json"
_PLAN = "plan.json"


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
    runs : int
        How many parts the source has.
    shards : {"npy", "parquet", "ply"}
        The format of the triangles.
    neighbors : bool
        Whether neighbours are written, too.
    """

    out: Path
    scratch: Path
    plan: str = ""
    held: int = 0
    runs: int = 0
    shards: ShardFormat = "npy"
    neighbors: bool = False


@dataclass(frozen=True)
class Scanned:
    """What a first reading of a part tells."""

    rows: int
    digest: str
    sample: Floats


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


def label(name: int) -> str:
    """Name the files of a node.

    >>> label(~7), label(3)
    ('tile-00007', 'seam-00003')
    """
    return f"seam-{name:05d}" if name >= 0 else f"tile-{~name:05d}"


def node_of(stem: str) -> int:
    """Return the node whose files have a name.

    >>> node_of("tile-00007"), node_of("seam-00003")
    (-8, 3)
    """
    kind, number = stem.split("-")
    return int(number) if kind == "seam" else ~int(number)


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
    rows = planar(part)
    finite = np.isfinite(rows).all(axis=1)
    if not skips and not finite.all():
        row = int(finite.argmin())
        raise _non_finite(part, row, first, rows[row])
    digest = hashlib.sha256(rows.data).hexdigest()
    pool = np.flatnonzero(finite)
    rng = np.random.default_rng(int(digest[:16], 16))
    drawn = rng.integers(0, max(1, len(pool)), min(sampled, len(pool)))
    return Scanned(len(rows), digest, rows[pool[np.sort(drawn)]] + 0.0)


def _non_finite(part: Part, row: int, first: int, values: Floats) -> NonFiniteError:
    """Name a row by its file, its number there, and its number among all."""
    error = non_finite(first + row, values)
    if part.place is None:
        return error
    within = part.origin.row + row
    where = "" if within == first + row else f", its row {within}"
    return NonFiniteError(f"{part.origin.source}{where}: {error}", row=first + row)


def partition(folders: Folders, part: Part, number: int, first: int, digest: str) -> None:
    """Sort the rows of a part by tile into a file of the scratch folder.

    Beside it: where each tile begins in it, the box of each tile's rows, the rows that are not
    finite, and duplicates of rows at positions that are repeated very often.

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
    digest : str
        The SHA-256 of its rows when they were first read.

    Raises
    ------
    InputError
        The rows have changed since.
    """
    stem = f"run-{number:05d}"
    notes = [f"{stem}{what}.npy" for what in ("", "-begins", "-boxes", "-skipped", "-duplicates")]
    record = folders.scratch / f"{stem}.json"
    before = load_record(record, folders.plan)
    if before is not None and is_sound(folders.scratch, before):
        return
    rows = planar(part)
    if hashlib.sha256(rows.data).hexdigest() != digest:
        raise changed(part)
    plan = load_plan(folders)
    apart, which, firsts = set_apart(rows, plan.repeated)
    *found, skipped = plan.partition(rows, first)
    del rows
    pairs = first + np.column_stack((apart, firsts[which]))
    arrays = *found, np.setdiff1d(skipped, pairs[:, 0]), pairs
    digests = {
        name: save_array(folders.scratch / name, array)
        for name, array in zip(notes, arrays, strict=True)
    }
    save_record(record, folders.plan, digests)


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
        done = Done(**{**before, "frontier": tuple(before["frontier"])})
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
    found = merge(
        part,
        plan.cells[name],
        foreign,
        is_root=is_root,
        with_neighbors=folders.neighbors,
        threads=threads,
        scratch=scratch,
    )
    corners = part.records if folders.shards == "ply" else part.records[:0]
    del part
    stem = label(name)
    up = found.frontier
    keeps: dict[str, Array] = {"duplicates": found.duplicates, "records": up.records, "rim": up.rim}
    if is_root:
        keeps["hull"] = found.hull
    if folders.neighbors:
        keeps["links"], keeps["edges"] = _linked(folders, name, found, children)
    shards, notes = _saved_shard(folders, stem, found, corners), {}
    for what, array in keeps.items():
        notes[f"{stem}-{what}.npy"] = save_array(folders.scratch / f"{stem}-{what}.npy", array)
    return Done(
        name,
        rows,
        len(up),
        up.nbytes,
        len(found.triangles),
        len(found.duplicates),
        found.is_flat,
        (name,),
        shards,
        notes,
    )


def _saved_shard(folders: Folders, stem: str, found: Merged, corners: Integers) -> dict[str, str]:
    """Write what a node has decided; return the SHA-256 of the files."""
    if not len(found.triangles):
        return {}
    shard = f"{stem}.{folders.shards}"
    saved = {shard: save_shard(folders.out / shard, found.triangles, corners)}
    if folders.neighbors:
        beside = f"{stem}-neighbors.npy"
        saved[beside] = save_array(folders.out / beside, found.neighbors)
    return saved


def _linked(
    folders: Folders, name: int, found: Merged, children: Sequence[Done]
) -> tuple[Integers, Integers]:
    """Pair the open edges of a node and of those below it; return links, and what goes up."""
    below = [folders.scratch / f"{label(each)}-edges.npy" for c in children for each in c.frontier]
    edges = [open_edges(name, found.triangles, found.neighbors), *map(np.load, below)]
    return paired(np.concatenate(edges))


def _below(folders: Folders, children: Sequence[Done]) -> Frontier:
    """Read what the children handed up."""
    names = [label(source) for child in children for source in child.frontier]
    files = [
        [folders.scratch / f"{name}-{what}.npy" for what in ("records", "rim")] for name in names
    ]
    parts = [Frontier(np.load(records, mmap_mode="r"), np.load(rim)) for records, rim in files]
    return joined(parts)


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
