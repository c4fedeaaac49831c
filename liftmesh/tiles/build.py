"""tile() and tile_surface(): the result of one call, computed tile by tile in bounded memory.

One run scans, plans, partitions, triangulates and merges, and publishes. The scratch folder says
what the run is of (``job.json``): the hashes of all chunks of the source, and the options that its
files depend on. A run of something else does not touch them. What the files of tasks depend on
besides, the plan and the program, is in the hash of the plan.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from liftmesh._typing import Floats, Integers, Progress
from liftmesh.base.options import (
    NonFinite,
    OnDuplicate,
    ShardFormat,
    as_threads,
    check_progress,
    shown,
)
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.terrain.triangulate import check_system
from liftmesh.tiles.lock import check_apart, clear, locked, release_copies
from liftmesh.tiles.options import (
    JOB,
    TILE_ROWS,
    Groups,
    Options,
    RunContext,
    Runner,
    TiledSurfaceOptions,
)
from liftmesh.tiles.plan import Plan, frequent, planned
from liftmesh.tiles.publish import publish
from liftmesh.tiles.schedule import Serial, is_recorded, released
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
from liftmesh.tiles.store import (
    MANIFEST,
    VERSION,
    load_record,
    manifest_of,
    save_record,
    seal,
    wrong_job,
)
from liftmesh.tiles.tiled import Tiled, TiledSurface, open_tiled
from liftmesh.tiles.tiled_data import TiledData, is_intact

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.io.options import ChunkOptions
    from liftmesh.tiles.source_chunks import SourceChunk

_MANY = 1 << 30  # rows: enough for any number of threads


def tile(  # noqa: PLR0913 - options are keywords
    points: object,
    out: str | os.PathLike[str],
    *,
    tile_rows: int | Literal["auto"] = "auto",
    scratch: str | os.PathLike[str] | None = None,
    nonfinite: NonFinite = "error",
    resume: bool = True,
    shards: ShardFormat = "npy",
    neighbors: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Tiled:
    """Triangulate more points than fit in memory, tile by tile, into files.

    The triangles of all files together are exactly those of `delaunay` for all points: no seam, no
    overlap, and the same choice among points on one circle. They do not depend on the tiles.

    Parameters
    ----------
    points : path, list of paths, array_like, or iterator of arrays
        Planar points; a third column is ignored. NPY files, mapped arrays, LAS files and
        Parquet files with columns x and y are read by ranges, other files that `read_chunks` reads,
        LAZ among them, and iterators, once. Rows are numbered through all files.
    out : str or path
        The folder to write to; it is made if it is missing. Files in it that no run has made stay
        as they are, and stand in the way if they have the names of shards.
    tile_rows : int or "auto", default "auto"
        How many rows a tile has, about. A tile takes some 200 bytes a row; "auto" means 1,500,000
        rows, or as many as in the run that is resumed.
    scratch : str or path, optional
        Where to make a folder for 24 bytes a row; by default `out`. It shrinks as tiles are
        finished, and is removed at the end.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are listed in ``skipped``.
    resume : bool, default True
        Whether to continue a run that was interrupted, with its finished parts; the source is read
        again and must be the same. False begins anew, and replaces what a former run has written.
    shards : {"npy", "parquet", "ply"}, default "npy"
        The format of the triangles. NPY holds rows of the source. Parquet holds them as columns a,
        b and c, in half the bytes, and needs pyarrow (``liftmesh[dask]``). PLY holds meshes that
        viewers open: each shard has the vertices of its triangles, with z = 0 and their ``row``;
        it is refused beyond 2**31 rows, because it has no 64-bit integers.
    neighbors : bool, default False
        Whether to write which triangles share an edge, within and across shards, for
        `Tiled.neighbors`: 12 bytes a triangle.
    threads : int, optional
        As for `delaunay`; one tile is triangulated at a time.
    progress : callable, optional
        Called with the fraction of the work done. If it has a method ``begin``, this is called with
        the number of rows, first of all, or when a source that is read once has been read. An
        exception that it raises ends the run, which can be resumed.

    Returns
    -------
    Tiled
        The triangles in shards, with the rows of the whole source as 64-bit numbers.

    Raises
    ------
    InputError
        The points or an option are invalid; the source has changed since the run began; `out` holds
        the triangles of another one, or files that no run has made, or another run writes to it.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    FormatError
        A file is damaged, or has no points.
    MissingDependencyError
        Parquet is read or written, and pyarrow is not installed.
    OSError
        A file cannot be read or written; after a full disk, the run can be resumed.

    Notes
    -----
    Each tile is triangulated by itself, without overlap. Triangles whose circumcircle is clear of
    all other tiles are written; the corners of the others, a per cent or two of the points, are
    merged from tile to tile up a tree. If nearly nothing is settled in the tiles, as for points on
    one circle, the last merge takes all points, and as much memory as `delaunay`; the large arrays
    of merges that are larger than two tiles are in files of the scratch folder.

    See Also
    --------
    delaunay : Points in memory.
    tile_surface : With heights and values.
    dask.delaunay : On workers of Dask.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> points = np.random.default_rng(0).random((1000, 2))
    >>> tiled = tile(points, tempfile.mkdtemp(), tile_rows=300)
    >>> from liftmesh import delaunay
    >>> expected = delaunay(points, order="canonical").simplices
    >>> {*map(tuple, tiled.to_array().tolist())} == {*map(tuple, expected.tolist())}
    True
    """
    check_progress(progress)
    count, _ = as_threads(threads, _MANY)
    options = Options.validated(out, tile_rows, scratch, nonfinite, resume, shards, neighbors)
    tiled = open_tiled(triangulated(points, options, Serial(count, progress)))
    if progress is not None:
        progress(1.0)
    return tiled


def tile_surface(  # noqa: PLR0913 - options are keywords
    cloud: object,
    out: str | os.PathLike[str],
    *,
    crs: Any = None,
    plane: Literal["xy"] = "xy",
    on_duplicate: OnDuplicate = "first",
    nonfinite: NonFinite = "error",
    tile_rows: int | Literal["auto"] = "auto",
    scratch: str | os.PathLike[str] | None = None,
    resume: bool = True,
    shards: Literal["npy"] = "npy",
    neighbors: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
    **reading: Unpack[ChunkOptions],
) -> TiledSurface:
    """Make a surface of more points than fit in memory, tile by tile, in files.

    The triangles are those of `triangulate` for all rows, and so are the vertices with heights,
    colours, normals and named values, bit for bit, and the use of every row.

    Parameters
    ----------
    cloud : path, list of paths, array_like, cloud, table, or iterator of these
        Points in space, as for `triangulate`; also Parquet. Rows are numbered through all files,
        which must have the same values and coordinate system. NPY files and mapped arrays are read
        by ranges; what else is read is written to the scratch folder first.
    out : str or path
        The folder to write to, as for `tile`.
    crs : str, int or CRS, optional
        The coordinate system, in place of that of the source, as for `triangulate`.
    plane : "xy"
        The projection plane; only ``"xy"`` is supported.
    on_duplicate : {"first", "last", "lowest", "highest", "mean", "error"}
        As for `triangulate`. An error names two rows of the first tile that has any.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows whose x, y or z is NaN or infinity raise an error, or are listed in
        ``skipped``.
    tile_rows : int or "auto", default "auto"
        How many rows a tile has, about. A tile takes some 250 bytes a row, and a few times what the
        values of the row take; "auto" means 1,500,000, or as many as in the run that is resumed.
    scratch : str or path, optional
        Where to make a folder for 48 bytes a row and its values, twice where the source cannot be
        read by ranges, until its rows are sorted by tile; by default `out`. It shrinks as tiles are
        finished, and is removed at the end.
    resume
        As for `tile`.
    shards : "npy"
        The format of the triangles; only ``"npy"`` is supported, as vertices and faces stand beside
        them. `TiledSurface.iter_meshes` gives each shard for a file of any format.
    neighbors, threads, progress
        As for `tile`.
    **reading
        Which rows of files are read, and how, as for `read_chunks`: ``classes``, ``bounds``,
        ``dst_crs``, ``columns`` and so on. Rows are numbered as they are read. Of LAS, LAZ and
        COPC, the ground (class 2) is taken, or all rows if no file has any, and no withheld rows,
        as by `triangulate`; ``classes="all"`` takes all. `TiledSurface.report` says which were
        taken.

    Returns
    -------
    TiledSurface
        Triangles and vertices in shards.

    Raises
    ------
    InputError
        As for `tile`; `plane` is another; the rows of several files have not the same values; or
        weights, a metric, lines or trimming are asked for, which only `triangulate` knows.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DuplicateHeightError
        Rows at one planar position have different heights and `on_duplicate` is "error".
    DegenerateInputError
        There are fewer than three distinct planar positions, or all lie on one line.
    UnsupportedTypeError, FormatError, MissingDependencyError, OSError
        As for `triangulate` and `tile`.

    Warns
    -----
    DataWarning
        The coordinate system has degrees, or units that differ.

    Notes
    -----
    Equal positions share a tile, which therefore chooses among all rows at a position. Of a
    position with very many rows it is given only those that the policy needs: one or two of each
    chunk, but for "mean" and "error" one for each different height.

    See Also
    --------
    triangulate : A cloud in memory.
    tile : Triangles alone.
    dask.triangulate : On workers of Dask.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from liftmesh import triangulate
    >>> points = np.random.default_rng(0).integers(0, 30, (1000, 3))
    >>> tiled = tile_surface(points, tempfile.mkdtemp(), on_duplicate="highest", tile_rows=300)
    >>> faces = triangulate(points, on_duplicate="highest").faces
    >>> {frozenset(face) for face in tiled.to_array().tolist()} == {*map(frozenset, faces.tolist())}
    True
    >>> print(tiled.report)
    1,000 rows, 602 of them used in 1,127 triangles. Left out: 11 duplicates, 387 overhangs ...
    """
    check_progress(progress)
    count, _ = as_threads(threads, _MANY)
    surface = TiledSurfaceOptions.validated(on_duplicate, plane, crs, reading)
    options = Options.validated(
        out, tile_rows, scratch, nonfinite, resume, shards, neighbors, surface
    )
    tiled = open_tiled(triangulated(cloud, options, Serial(count, progress)))
    if progress is not None:
        progress(1.0)
    return cast("TiledSurface", tiled)


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
    surface: TiledSurfaceOptions | None = None

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
