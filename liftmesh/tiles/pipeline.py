"""One run of a tiled triangulation: scan, plan, partition, triangulate and merge, publish.

The scratch folder says what the run is of (``job.json``): the hashes of all chunks of the source,
and the options that its files depend on. A run of something else does not touch them. What the
files of tasks depend on besides, the plan and the program, is in the hash of the plan.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Integers
from liftmesh.base.options import shown
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.terrain.triangulate import check_system
from liftmesh.tiles.context import JOB, Groups, RunContext
from liftmesh.tiles.lock import check_apart, clear, locked, release_copies
from liftmesh.tiles.manifest import MANIFEST, VERSION, manifest_of, wrong_job
from liftmesh.tiles.options import TILE_ROWS, Options, SurfaceOptions
from liftmesh.tiles.plan import Plan, frequent, planned
from liftmesh.tiles.publish import publish
from liftmesh.tiles.schedule import released
from liftmesh.tiles.shards import check_format
from liftmesh.tiles.sorted_chunks import (
    Scanned,
    changed,
    earlier_plan,
    partition,
    save_boxes,
    save_plan,
    scan,
    tile_sample,
)
from liftmesh.tiles.stages import is_recorded
from liftmesh.tiles.store import load_record, save_record, seal
from liftmesh.tiles.tiled_data import TiledData, is_intact

if TYPE_CHECKING:
    from liftmesh.tiles.context import Runner
    from liftmesh.tiles.source_chunks import SourceChunk

_CHUNK_ROWS = 2_000_000
_SAMPLED = 2_000  # points of a tile
_LARGE = 2  # times the rows of a tile: it is cut again
_ROUNDS = 3  # of sorting; what is too large then stays so


def triangulated(
    source: object,
    options: Options,
    runner: Runner,
    fitting: int = TILE_ROWS,
) -> Path:
    """Do everything, or what is left to do, and return the folder."""
    context = options.context
    with locked(context, anew=not options.resumes):
        before = _earlier_rows(context) if options.resumes else None
        rows = options.tile_rows or before or fitting
        chunks = runner.chunks(source, min(rows, _CHUNK_ROWS), context.scratch, options.reading)
        check_apart(context, chunks)
        count = sum(chunk.rows for chunk in chunks)
        check_format(context.shards, count)
        runner.begin(count)
        if options.surface is not None and chunks:
            check_system(chunks[0].schema.crs, "xy")
        if not options.resumes:
            clear(context)
        Run(context, chunks, rows, options.skips, options.surface).finish(runner)
    return context.out


@dataclass(frozen=True)
class Run:
    """What is triangulated, and how, in folders that are locked."""

    context: RunContext
    chunks: Sequence[SourceChunk]
    tile_rows: int
    skips: bool
    surface: SurfaceOptions | None = None

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
            context, sizes, skipped = self._sorted(runner, plan, identity, scanned)
            finer = self._cut_again(plan, context, sizes)
            if finer.tiles == plan.tiles:
                break
            plan = finer
        else:
            context, sizes, skipped = self._sorted(runner, plan, identity, scanned)
        release_copies(context, self.chunks)
        done = runner.tree(context, plan, sizes)
        publish(runner, context, self.chunks, plan, identity, done, skipped)

    def _sorted(
        self, runner: Runner, plan: Plan, identity: Mapping[str, Any], scanned: Sequence[Scanned]
    ) -> tuple[RunContext, list[int], Integers]:
        """Sort all chunks by tile; return the sizes of the tiles, and the rows left out."""
        context = self._context(plan, identity)
        save_plan(context, plan)
        context = replace(context, released=released(runner, context))
        numbered = enumerate(zip(self.chunks, self._firsts, scanned, strict=True))
        calls = [(context, chunk, i, first, each.as_chunk) for i, (chunk, first, each) in numbered]
        runner.each("partition", partition, calls)
        return context, *save_boxes(context, plan)

    def _context(self, plan: Plan, identity: Mapping[str, Any]) -> RunContext:
        """Say what the files of a plan depend on."""
        groups = Groups.of_plan(plan.tiles, max(chunk.rows for chunk in self.chunks))
        return replace(
            self.context,
            plan=seal(_program(), identity, plan.as_dict(), groups.count),
            held=2 * self.tile_rows,
            chunks=len(self.chunks),
            groups=groups,
            has_values=self.surface is not None,
            on_duplicate="first" if self.surface is None else self.surface.on_duplicate,
        )

    def _begun(self, first: Plan, identity: Mapping[str, Any]) -> Plan | None:
        """Return the plan of an earlier run that has done a tile: it was not to be cut again."""
        plan = earlier_plan(self.context)
        if plan is None or not plan.extends(first):
            return None
        context = self._context(plan, identity)
        has_begun = any(is_recorded(context, ~tile) for tile in range(plan.tiles))
        return plan if has_begun else None

    def _cut_again(self, plan: Plan, context: RunContext, sizes: Sequence[int]) -> Plan:
        """Cut the tiles that came out too large, by a sample of their own rows."""
        for tile, size in enumerate(sizes):
            if size > _LARGE * self.tile_rows:
                wanted = -(-size // self.tile_rows)
                sample = tile_sample(context, tile, _SAMPLED * wanted)
                plan = plan.cut_again(tile, planned(sample, wanted))
        return plan

    def _planned(self, sample: Floats) -> Plan:
        """Cut the sample; what is repeated very often takes no room in a tile."""
        repeated, others = frequent(sample)
        tiles = -(-self._tiles * len(others) // max(1, len(sample)))
        return replace(planned(others, max(1, tiles)), repeated=repeated)

    @property
    def _tiles(self) -> int:
        return -(-sum(chunk.rows for chunk in self.chunks) // self.tile_rows)

    @property
    def _firsts(self) -> list[int]:
        return [0, *accumulate(chunk.rows for chunk in self.chunks)][:-1]

    def _scanned(self, runner: Runner) -> list[Scanned]:
        if self._tiles == 0:
            raise DegenerateInputError("the source has no rows: a triangle needs three points")
        total = sum(chunk.rows for chunk in self.chunks)
        calls = [
            (chunk, first, -(-_SAMPLED * self._tiles * chunk.rows // total), self.skips)
            for chunk, first in zip(self.chunks, self._firsts, strict=True)
        ]
        scanned: list[Scanned] = runner.each("scan", scan, calls)
        return scanned

    def _identity(self, chunks: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        """Tell what the files of a run depend on."""
        said: dict[str, Any] = {
            "version": VERSION,
            "tile_rows": self.tile_rows,
            "nonfinite": "skip" if self.skips else "error",
            "shard_format": self.context.shards,
            "neighbors": self.context.neighbors,
            "chunks": chunks,
        }
        if self.surface is None:
            return said
        return said | {"surface": self.surface.as_dict(self.chunks[0].schema)}

    def _is_finished(self, identity: Mapping[str, Any]) -> bool:
        """Whether it is all done; raise if something else is, or was begun."""
        if (self.context.out / MANIFEST).exists():
            before = manifest_of(self.context.out)
            self._check_options(before, "the triangles", identity)
            if before["chunks"] != identity["chunks"]:
                raise InputError(
                    f"{self.context.out} holds the triangles of other points: choose another "
                    f"folder, or replace them with {Option('resume', False)}"
                )
            if is_intact(TiledData(self.context.out, before)):
                return True
        record = self.context.scratch / JOB
        if record.exists():
            job = load_record(record, "")
            if wrong_job(job) is not None:
                raise InputError(f"{record}: damaged: begin anew with {Option('resume', False)}")
            self._check_options(job, "a run", identity)
            self._check_chunks(job["chunks"], identity["chunks"])
        save_record(record, "", identity)
        (self.context.out / MANIFEST).unlink(missing_ok=True)
        return False

    def _check_options(self, before: Mapping[str, Any], what: str, now: Mapping[str, Any]) -> None:
        for name in ("version", "tile_rows", "nonfinite", "shard_format", "neighbors"):
            self._check_same(what, name, before[name], now[name])
        one, other = before.get("surface"), now.get("surface")
        if (one is None) != (other is None):
            kinds = ("triangles alone", "a surface")
            held, asked = kinds if one is None else kinds[::-1]
            raise InputError(
                f"{self.context.out} holds {held}, not {asked}: choose another folder, or begin "
                f"anew with {Option('resume', False)}"
            )
        for name in other or {}:
            self._check_same(what, name, (one or {})[name], (other or {})[name])

    def _check_same(self, what: str, name: str, before: object, now: object) -> None:
        if before != now:
            told = name if name == "version" else f"{Option(name)}"
            raise InputError(
                f"{self.context.out} holds {what} with {told} {shown(before)}, not {shown(now)}: "
                f"use the same, or begin anew with {Option('resume', False)}"
            )

    def _check_chunks(self, before: Sequence[Any], now: Sequence[Any]) -> None:
        same = [i for i, chunk in enumerate(now) if before[i : i + 1] == [chunk]]
        if not same:
            raise InputError(
                f"{self.context.out} holds a run with other points: choose another folder, or "
                f"begin anew with {Option('resume', False)}"
            )
        for number, chunk in enumerate(self.chunks):
            if number not in same:
                raise changed(chunk)
        if len(before) > len(now):
            rows = sum(chunk.rows for chunk in self.chunks)
            raise InputError(
                f"the source has lost rows since this triangulation was begun: {rows:,} are left: "
                f"restore them, or begin anew with {Option('resume', False)}"
            )


def _earlier_rows(context: RunContext) -> int | None:
    """Return how many rows the tiles of a run have that was begun, or is finished."""
    record = load_record(context.scratch / JOB, "")
    job = None if wrong_job(record) else record
    if job is None and (context.out / MANIFEST).exists():
        job = manifest_of(context.out)
    return None if job is None else int(job["tile_rows"])


def _program() -> str:
    from liftmesh import __version__  # noqa: PLC0415 - it is found when it is asked for

    return __version__
