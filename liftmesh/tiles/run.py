"""One run of a tiled triangulation: scan, plan, partition, triangulate and merge, publish.

The scratch folder says what the run is of (``job.json``): the hashes of all chunks of the source,
and the options that its files depend on. A run of something else does not touch them. What the
files of tasks depend on besides, the plan and the program, is in the hash of the plan.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from liftmesh._typing import Floats, Integers
from liftmesh.base.options import NonFinite, ShardFormat, as_count, as_switch, check_option, shown
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.terrain.triangulate import check_system
from liftmesh.tiles.chunks import Scanned, changed, partition, scan
from liftmesh.tiles.claim import (
    check_apart,
    claimed,
    clear,
    folders_of,
    release_copies,
)
from liftmesh.tiles.groups import Groups
from liftmesh.tiles.manifest import MANIFEST, VERSION, manifest_of
from liftmesh.tiles.manifest_shape import wrong_job
from liftmesh.tiles.plan import Plan, planned
from liftmesh.tiles.publish import publish
from liftmesh.tiles.release import released
from liftmesh.tiles.repeated import frequent
from liftmesh.tiles.runs import earlier_plan, save_boxes, save_plan, tile_sample
from liftmesh.tiles.shards import check_format
from liftmesh.tiles.sources import Part, parts_of
from liftmesh.tiles.stages import JOB, Folders, is_recorded
from liftmesh.tiles.store import load_record, save_record, seal
from liftmesh.tiles.surfacing import Surfacing, schema_of_parts
from liftmesh.tiles.tiled import Tiled, open_tiled

if TYPE_CHECKING:
    from liftmesh.tiles.schedule import Runner

Cut = Callable[[object, int, Path], Sequence[Part]]

TILE_ROWS = 1_500_000  # about 300 MB
_PART_ROWS = 2_000_000
_SAMPLED = 2_000  # points of a tile
_LEAST = 16  # rows of a tile
_LARGE = 2  # times the rows of a tile: it is cut again
_ROUNDS = 3  # of sorting; what is too large then stays so

_PROCESS_BYTES = 100_000_000  # of a process without work
ROW_BYTES = 200  # of a tile
SURFACE_ROW_BYTES = 400  # with a few values
_SHARE = 0.6  # of a limit: beyond that Dask takes measures
_FEWEST = 50_000  # rows of a tile: with fewer, most of them would go up


@dataclass(frozen=True)
class Options:
    """The options of `tile`, checked; a size of None is for the run to choose."""

    folders: Folders
    tile_rows: int | None
    skips: bool
    resumes: bool
    surface: Surfacing | None = None

    @classmethod
    def checked(
        cls,
        out: str | os.PathLike[str],
        tile_rows: int | Literal["auto"],
        scratch: str | os.PathLike[str] | None,
        nonfinite: NonFinite,
        resume: bool,
        shards: ShardFormat,
        neighbors: bool,
        surface: Surfacing | None = None,
    ) -> Options:
        """Check the options."""
        check_option("nonfinite", nonfinite, NonFinite)
        resumes = as_switch("resume", resume)
        is_auto = isinstance(tile_rows, str) and tile_rows == "auto"
        rows = None if is_auto else as_count("tile_rows", tile_rows, _LEAST)
        check_option("shards", shards, ShardFormat)
        if surface is not None:
            surface.check_shards(shards)
        is_linked = as_switch("neighbors", neighbors)
        folders = replace(folders_of(out, scratch), shards=shards, neighbors=is_linked)
        return cls(folders, rows, nonfinite == "skip", resumes, surface)


def triangulated(
    source: object,
    options: Options,
    runner: Runner,
    *,
    fitting: int = TILE_ROWS,
    cut: Cut = parts_of,
) -> Tiled:
    """Do everything, or what is left to do."""
    folders = options.folders
    with claimed(folders, anew=not options.resumes):
        before = _earlier_rows(folders) if options.resumes else None
        rows = options.tile_rows or before or fitting
        parts = cut(source, min(rows, _PART_ROWS), folders.scratch)
        check_apart(folders, parts)
        count = sum(part.rows for part in parts)
        check_format(folders.shards, count)
        runner.begin(count)
        if options.surface is not None and parts:
            check_system(schema_of_parts(parts).crs, "xy")
        if not options.resumes:
            clear(folders)
        Run(folders, parts, rows, options.skips, options.surface).finish(runner)
    return open_tiled(folders.out)


@dataclass(frozen=True)
class Run:
    """What is triangulated, and how, in folders that are claimed."""

    folders: Folders
    parts: Sequence[Part]
    tile_rows: int
    skips: bool
    surface: Surfacing | None = None

    def finish(self, runner: Runner) -> None:
        """Do everything, or what is left to do."""
        scanned = self._scanned(runner)
        identity = self._identity([each.as_chunk for each in scanned])
        if self._is_finished(identity):
            return
        plan = self._planned(np.concatenate([each.sample for each in scanned]))
        begun = self._begun(plan, identity)
        plan = begun or plan
        for _ in range(0 if begun else _ROUNDS):
            folders, sizes, skipped = self._sorted(runner, plan, identity, scanned)
            finer = self._cut_again(plan, folders, sizes)
            if finer.tiles == plan.tiles:
                break
            plan = finer
        else:
            folders, sizes, skipped = self._sorted(runner, plan, identity, scanned)
        release_copies(folders, self.parts)
        done = runner.tree(folders, plan, sizes)
        publish(runner, folders, self.parts, plan, identity, done, skipped)

    def _sorted(
        self, runner: Runner, plan: Plan, identity: Mapping[str, Any], scanned: Sequence[Scanned]
    ) -> tuple[Folders, list[int], Integers]:
        """Sort all parts by tile; return the sizes of the tiles, and the rows left out."""
        folders = self._folders(plan, identity)
        save_plan(folders, plan)
        folders = replace(folders, released=released(runner, folders))
        numbered = enumerate(zip(self.parts, self._firsts, scanned, strict=True))
        calls = [(folders, part, i, first, found.as_chunk) for i, (part, first, found) in numbered]
        runner.each("partition", partition, calls)
        return folders, *save_boxes(folders, plan)

    def _folders(self, plan: Plan, identity: Mapping[str, Any]) -> Folders:
        """Say what the files of a plan depend on."""
        groups = Groups.of_plan(plan.tiles, max(part.rows for part in self.parts))
        return replace(
            self.folders,
            plan=seal(_program(), identity, plan.as_dict(), groups.count),
            held=2 * self.tile_rows,
            runs=len(self.parts),
            groups=groups,
            policy="" if self.surface is None else self.surface.duplicates,
        )

    def _begun(self, first: Plan, identity: Mapping[str, Any]) -> Plan | None:
        """Return the plan of an earlier run that has done a tile: it was not to be cut again."""
        plan = earlier_plan(self.folders)
        if plan is None or not plan.extends(first):
            return None
        folders = self._folders(plan, identity)
        has_begun = any(is_recorded(folders, ~tile) for tile in range(plan.tiles))
        return plan if has_begun else None

    def _cut_again(self, plan: Plan, folders: Folders, sizes: Sequence[int]) -> Plan:
        """Cut the tiles that came out too large, by a sample of their own rows."""
        for tile, size in enumerate(sizes):
            if size > _LARGE * self.tile_rows:
                wanted = -(-size // self.tile_rows)
                sample = tile_sample(folders, tile, _SAMPLED * wanted)
                plan = plan.cut_again(tile, planned(sample, wanted))
        return plan

    def _planned(self, sample: Floats) -> Plan:
        """Cut the sample; what is repeated very often takes no room in a tile."""
        repeated, others = frequent(sample)
        tiles = -(-self._tiles * len(others) // max(1, len(sample)))
        return replace(planned(others, max(1, tiles)), repeated=repeated)

    @property
    def _tiles(self) -> int:
        return -(-sum(part.rows for part in self.parts) // self.tile_rows)

    @property
    def _firsts(self) -> list[int]:
        return [0, *accumulate(part.rows for part in self.parts)][:-1]

    def _scanned(self, runner: Runner) -> list[Scanned]:
        if self._tiles == 0:
            raise DegenerateInputError("the source has no rows: a triangle needs three points")
        total = sum(part.rows for part in self.parts)
        calls = [
            (part, first, -(-_SAMPLED * self._tiles * part.rows // total), self.skips)
            for part, first in zip(self.parts, self._firsts, strict=True)
        ]
        found: list[Scanned] = runner.each("scan", scan, calls)
        return found

    def _identity(self, chunks: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """Tell what the files of a run depend on."""
        said: dict[str, Any] = {
            "version": VERSION,
            "tile_rows": self.tile_rows,
            "nonfinite": "skip" if self.skips else "error",
            "shard_format": self.folders.shards,
            "neighbors": self.folders.neighbors,
            "chunks": chunks,
        }
        if self.surface is None:
            return said
        return said | {"surface": self.surface.as_dict(schema_of_parts(self.parts))}

    def _is_finished(self, identity: Mapping[str, Any]) -> bool:
        """Whether it is all done; raise if something else is, or was begun."""
        if (self.folders.out / MANIFEST).exists():
            before = manifest_of(self.folders.out)
            self._check_options(before, "the triangles", identity)
            if before["chunks"] != identity["chunks"]:
                raise InputError(
                    f"{self.folders.out} holds the triangles of other points: choose another "
                    "folder, or replace them with resume=False"
                )
            if Tiled(self.folders.out, before).is_sound():
                return True
        record = self.folders.scratch / JOB
        if record.exists():
            job = load_record(record, "")
            if wrong_job(job) is not None:
                raise InputError(f"{record}: damaged: begin anew with resume=False")
            self._check_options(job, "a run", identity)
            self._check_chunks(job["chunks"], identity["chunks"])
        save_record(record, "", identity)
        (self.folders.out / MANIFEST).unlink(missing_ok=True)
        return False

    def _check_options(self, before: Mapping[str, Any], what: str, now: Mapping[str, Any]) -> None:
        for name in ("version", "tile_rows", "nonfinite", "shard_format", "neighbors"):
            self._check_same(what, name, before[name], now[name])
        one, other = before.get("surface"), now.get("surface")
        if (one is None) != (other is None):
            kinds = ("triangles alone", "a surface")
            held, asked = kinds if one is None else kinds[::-1]
            raise InputError(
                f"{self.folders.out} holds {held}, not {asked}: choose another folder, or begin "
                "anew with resume=False"
            )
        for name in other or {}:
            self._check_same(what, name, (one or {})[name], (other or {})[name])

    def _check_same(self, what: str, name: str, before: object, now: object) -> None:
        if before != now:
            raise InputError(
                f"{self.folders.out} holds {what} with {name} {shown(before)}, not {shown(now)}: "
                "use the same, or begin anew with resume=False"
            )

    def _check_chunks(self, before: Sequence[Any], now: Sequence[Any]) -> None:
        same = [i for i, chunk in enumerate(now) if before[i : i + 1] == [chunk]]
        if not same:
            raise InputError(
                f"{self.folders.out} holds a run with other points: choose another folder, or "
                "begin anew with resume=False"
            )
        for number, part in enumerate(self.parts):
            if number not in same:
                raise changed(part)
        if len(before) > len(now):
            raise InputError(
                f"the source has lost rows since this triangulation was begun: "
                f"{sum(part.rows for part in self.parts):,} are left: restore them, or begin anew "
                "with resume=False"
            )


def _earlier_rows(folders: Folders) -> int | None:
    """Return how many rows the tiles of a run have that was begun, or is finished."""
    record = load_record(folders.scratch / JOB, "")
    job = None if wrong_job(record) else record
    if job is None and (folders.out / MANIFEST).exists():
        job = manifest_of(folders.out)
    return None if job is None else int(job["tile_rows"])


def _program() -> str:
    from liftmesh import __version__  # noqa: PLC0415 - it is found when it is asked for

    return __version__


def rows_within(memory: int, threads: int = 1, row_bytes: int = ROW_BYTES) -> int:
    """Return how large tiles may be."""
    least = int((_PROCESS_BYTES + _FEWEST * row_bytes * threads) / _SHARE)
    if memory < least:
        raise InputError(
            f"{memory / 1e6:,.0f} MB of memory do not hold a process with a tile for each of its "
            f"{threads} threads: {least / 1e6:,.0f} MB are needed at least"
        )
    return int(_SHARE * memory - _PROCESS_BYTES) // (row_bytes * threads)
