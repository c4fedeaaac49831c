"""Triangulations and surfaces in tiles on the workers of Dask, identical to those of one call.

The files are those of `liftmesh.tile` and `liftmesh.tile_surface`, byte for byte. Workers exchange
them through the scratch folder, which all must see, so only a sample of the points, names and
counts go through the scheduler. A worker that dies loses the task it was at; a client that dies can
begin again and finds what is done.

Examples
--------
>>> import liftmesh.dask
>>> liftmesh.dask.delaunay.__name__
'delaunay'
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from liftmesh.base.options import NonFinite, OnDuplicate, ShardFormat, check_progress, counted
from liftmesh.errors import InputError
from liftmesh.io.atomic import working_folder
from liftmesh.optional import load
from liftmesh.tiles.build import triangulated
from liftmesh.tiles.options import (
    ROW_BYTES,
    SURFACE_ROW_BYTES,
    TILE_ROWS,
    Done,
    Options,
    RunContext,
    TiledSurfaceOptions,
    label,
    rows_within,
)
from liftmesh.tiles.schedule import Meter, in_order, node, release
from liftmesh.tiles.source_chunks import (
    Origin,
    SavedChunk,
    SourceChunk,
    in_files,
    numbered,
    planar_columns,
    saved,
)
from liftmesh.tiles.sources import (
    alike,
    check_no_options,
    file_chunks,
    files_of,
    readings,
    records_of,
    source_chunks,
    stage_of,
)
from liftmesh.tiles.tiled import Tiled, TiledSurface, open_tiled

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh._typing import Progress
    from liftmesh.io.options import ChunkOptions
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.schema import Reading


__all__ = ["delaunay", "local_cluster", "triangulate"]

_TRIES = 3  # of a task that raises OSError, as a network disk may


_SETTINGS = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.deploy.lost-worker-timeout": "10 minutes",
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
}


def delaunay(  # noqa: PLR0913 - options are keywords
    points: object,
    out: str | os.PathLike[str],
    *,
    client: Any = None,
    tile_rows: int | Literal["auto"] = "auto",
    scratch: str | os.PathLike[str] | None = None,
    nonfinite: NonFinite = "error",
    resume: bool = True,
    shards: ShardFormat = "npy",
    neighbors: bool = False,
    progress: Progress | None = None,
) -> Tiled:
    """Triangulate more points than fit in memory, on the workers of Dask.

    The triangles are exactly those of `liftmesh.delaunay` for all points, and the files those of
    `liftmesh.tile`. Needs ``liftmesh[dask]``.

    Parameters
    ----------
    points : path, list of paths, array_like, iterator, dask.array.Array or dask.dataframe.DataFrame
        As for `liftmesh.tile`; also arrays of Dask with two or three columns, and DataFrames with
        columns x and y. Paths must lead to the same files on all workers.
    out : str or path
        The folder to write to, which all workers see.
    client : distributed.Client, optional
        By default the current client; if there is none, a `LocalCluster` for this call, with a
        worker of one thread for each core. A script must then begin with
        ``if __name__ == "__main__":``.
    tile_rows : int or "auto", default "auto"
        How many rows a tile has, about. "auto" means 1,500,000, or fewer if 60 % of a worker's
        memory limit would not hold a tile for each of its threads; or as many as in the run that is
        resumed.
    scratch : str or path, optional
        As for `liftmesh.tile`, in a folder that all workers see.
    nonfinite, resume, shards, neighbors, progress
        As for `liftmesh.tile`.

    Returns
    -------
    Tiled
        The triangles in shards.

    Raises
    ------
    InputError, NonFiniteError, DegenerateInputError, FormatError, OSError
        As for `liftmesh.tile`.
    ConnectionError
        The scheduler is gone, or has dropped the tasks, or workers died several times at one of
        them; the run can be resumed.
    MissingDependencyError
        Dask is not installed, or Parquet is read or written without pyarrow.

    See Also
    --------
    tile : The same in one process.
    dask.triangulate : Surfaces.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from dask.distributed import Client
    >>> points = np.random.default_rng(0).random((1000, 2))
    >>> with Client(n_workers=1, processes=False, dashboard_address="127.0.0.1:0") as client:
    ...     tiled = delaunay(points, tempfile.mkdtemp(), tile_rows=300, client=client)
    >>> tiled
    <Tiled: 1980 triangles over 1000 rows in 7 shards>
    """
    check_progress(progress)
    options = Options.validated(out, tile_rows, scratch, nonfinite, resume, shards, neighbors)
    with client_of(client) as used:
        workers = _Workers(used, progress)
        fitting = _tile_rows(used)
        tiled = open_tiled(triangulated(points, options, workers, fitting))
    if progress is not None:
        progress(1.0)
    return tiled


def triangulate(  # noqa: PLR0913 - options are keywords
    cloud: object,
    out: str | os.PathLike[str],
    *,
    client: Any = None,
    crs: Any = None,
    plane: Literal["xy"] = "xy",
    on_duplicate: OnDuplicate = "first",
    nonfinite: NonFinite = "error",
    tile_rows: int | Literal["auto"] = "auto",
    scratch: str | os.PathLike[str] | None = None,
    resume: bool = True,
    shards: Literal["npy"] = "npy",
    neighbors: bool = False,
    progress: Progress | None = None,
    **reading: Unpack[ChunkOptions],
) -> TiledSurface:
    """Make a surface of more points than fit in memory, on the workers of Dask.

    Triangles, vertices and the use of every row are those of `liftmesh.triangulate` for all rows,
    and the files those of `liftmesh.tile_surface`. Needs ``liftmesh[dask]``.

    Parameters
    ----------
    cloud : path, list of paths, array_like, iterator, dask.array.Array or dask.dataframe.DataFrame
        As for `liftmesh.tile_surface`; also arrays of Dask with two or three columns, and
        DataFrames, whose columns are known by their names. Paths must lead to the same files on all
        workers.
    out : str or path
        The folder to write to, which all workers see.
    client : distributed.Client, optional
        As for `delaunay`.
    crs, plane, on_duplicate, nonfinite
        As for `liftmesh.tile_surface`. An error about duplicates is that of the tile that is done
        first.
    tile_rows : int or "auto", default "auto"
        As for `delaunay`.
    scratch : str or path, optional
        As for `liftmesh.tile_surface`, in a folder that all workers see.
    resume, shards, neighbors, progress
        As for `liftmesh.tile_surface`.
    **reading
        As for `liftmesh.tile_surface`.

    Returns
    -------
    TiledSurface
        Triangles and vertices in shards.

    Raises
    ------
    InputError, NonFiniteError, DuplicateHeightError, DegenerateInputError, FormatError, OSError
        As for `liftmesh.tile_surface`.
    MissingDependencyError
        Dask is not installed.

    See Also
    --------
    tile_surface : The same in one process.
    dask.delaunay : Points in the plane.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> from dask.distributed import Client
    >>> points = np.random.default_rng(0).random((1000, 3))
    >>> with Client(n_workers=1, processes=False, dashboard_address="127.0.0.1:0") as client:
    ...     tiled = triangulate(points, tempfile.mkdtemp(), tile_rows=300, client=client)
    >>> tiled
    <TiledSurface: 1976 triangles over 1000 rows in 7 shards>
    """
    check_progress(progress)
    surface = TiledSurfaceOptions.validated(on_duplicate, plane, crs, reading)
    options = Options.validated(
        out, tile_rows, scratch, nonfinite, resume, shards, neighbors, surface
    )
    with client_of(client) as used:
        workers = _Workers(used, progress)
        fitting = _tile_rows(used, SURFACE_ROW_BYTES)
        tiled = open_tiled(triangulated(cloud, options, workers, fitting))
    if progress is not None:
        progress(1.0)
    return cast("TiledSurface", tiled)


class _Workers:
    """Hands tasks to workers, under names that the dashboard groups by stage."""

    def __init__(self, client: Any, progress: Progress | None) -> None:
        self._client = client
        self._distributed = load("dask.distributed", extra="dask")
        self._meter = Meter(progress)
        self._run = os.urandom(4).hex()  # no other run has the same names
        self._rounds = 0  # nor has another round of the same stage
        self._copied = partial(self._meter.show, "spool")

    def begin(self, rows: int) -> None:
        """Hear how many rows there are."""
        self._meter.begin(rows)

    def chunks(
        self, source: object, rows: int, scratch: Path, reading: Reading
    ) -> list[SourceChunk]:
        """Cut a source into chunks that all workers can read."""
        files = files_of(source)
        if files is not None:
            names = [os.path.abspath(file.source) for file in files]  # noqa: PTH100 - links stay
            (each,) = self.each("open", readings, [(names, reading)])
            calls = [
                (file, name, rows, scratch, how)
                for file, name, how in zip(files, names, each, strict=True)
            ]
            chunks_of_files = self.each(stage_of(files, reading), file_chunks, calls)
            return alike([chunk for chunks in chunks_of_files for chunk in chunks])
        blocks = _blocks(source, rows, every_column=not reading.is_planar)
        if blocks is None:
            return in_files(source_chunks(source, rows, scratch, reading, self._copied), scratch)
        check_no_options(reading)
        return alike(self._spooled(blocks, scratch, reading))

    def _spooled(self, blocks: list[Any], scratch: Path, reading: Reading) -> list[SourceChunk]:
        """Write blocks to files, each on a worker."""
        write = load("dask", extra="dask").delayed(_tried, pure=False)
        places = [scratch / f"points-{number:05d}.npy" for number in range(len(blocks))]
        tasks = [
            write(_in_file, block, place, reading, dask_key_name=self._key("spool", number))
            for number, (block, place) in enumerate(zip(blocks, places, strict=True))
        ]
        return [*numbered(self._gathered("spool", self._client.compute(tasks)))]

    def each(self, stage: str, task: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Any:
        """Call a task with each of some arguments, on any worker."""
        self._rounds += 1
        return self._gathered(
            stage,
            [self._submit(stage, number, task, *call) for number, call in enumerate(calls)],
        )

    def tree(self, context: RunContext, plan: Plan, sizes: Sequence[int]) -> list[Done]:
        """Submit all nodes: groups in order, large tiles first, and merges before tiles."""
        futures: dict[int, Any] = {}
        groups = context.groups
        for name, children in in_order(plan):
            below = [futures[child] for child in children]
            priority = 2 if name >= 0 else sizes[~name] / max(1, *sizes) - groups.of(~name)
            futures[name] = self._client.submit(
                _tried, node, context, name, below, 1,
                key=f"{label(name)}-{self._run}", priority=priority, pure=False,
            )  # fmt: skip
        released = []
        for group in range(groups.count):
            tiles = [futures[~tile] for tile in groups.tiles_of(group)]
            released.append(self._submit("release", group, release, context, group, tiles))
        results = self._gathered("triangulate", [*released, *futures.values()])
        return results[len(released) :]

    def _submit(self, stage: str, number: int, task: Callable[..., Any], *arguments: Any) -> Any:
        key = self._key(stage, number)
        return self._client.submit(_tried, task, *arguments, key=key, priority=2, pure=False)

    def _key(self, stage: str, number: int) -> str:
        return f"{stage}-{number:05d}-{self._run}-{self._rounds}"

    def _gathered(self, stage: str, futures: Sequence[Any]) -> list[Any]:
        """Wait for all; the first error ends the others."""
        try:
            return self._waited(stage, futures)
        except self._distributed.KilledWorker as error:
            times = counted(error.allowed_failures + 1, "time")
            raise ConnectionError(
                f"workers died {times} at {error.task}, as they do if memory is short: give "
                "them more, and call again with the same arguments: what is done is kept; or begin "
                "anew with fewer tile_rows"
            ) from error
        except CancelledError as error:
            reason = next(iter(str(error).splitlines()), "cancelled")
            raise ConnectionError(
                f"Dask has dropped the tasks ({reason}): look whether the scheduler is up, and "
                "call again with the same arguments: what is done is kept"
            ) from error

    def _waited(self, stage: str, futures: Sequence[Any]) -> list[Any]:
        results: dict[str, Any] = {}
        done = self._distributed.as_completed(
            futures, with_results=True, raise_errors=True, loop=self._client.loop
        )
        try:
            for future, result in done:
                results[future.key] = future.result() if future.cancelled() else result
                self._meter.show(stage, len(results) / len(futures))
        except BaseException:
            self._client.cancel(list(futures))
            raise
        return [results[future.key] for future in futures]


def _tile_rows(client: Any, row_bytes: int = ROW_BYTES) -> int:
    """Return how many rows of a tile fit the least of the workers."""
    workers = client.scheduler_info(n_workers=-1)["workers"].values()
    fitting = [
        rows_within(int(worker["memory_limit"]), worker["nthreads"], row_bytes)
        for worker in workers
        if worker["memory_limit"]
    ]
    return min([TILE_ROWS, *fitting])


def _blocks(source: object, rows: int, *, every_column: bool = False) -> list[Any] | None:
    """Return the blocks of an array or a DataFrame of Dask, delayed; None for anything else."""
    kind = type(source).__module__.partition(".")[0]
    if kind not in ("dask", "dask_expr"):
        return None
    whole: Any = source
    if hasattr(whole, "columns"):
        if every_column:
            return list(whole.to_delayed())
        return list(whole[list(planar_columns("DataFrame", whole.columns.tolist()))].to_delayed())
    if whole.ndim != 2 or whole.shape[1] not in (2, 3):
        raise InputError(f"points need the shape (n, 2) or (n, 3), not {whole.shape}")
    known = not any(np.isnan(length) for length in whole.chunks[0])
    return list(whole.rechunk({0: rows, 1: -1} if known else {1: -1}).to_delayed().reshape(-1))


def _in_file(block: Any, path: Path, reading: Reading) -> SavedChunk:
    """Write a block to a file; only its name goes back, so the block can be released."""
    records, schema = records_of(block, reading, "Dask")
    return saved(records, path, schema, Origin("Dask"))


def _tried(task: Callable[..., Any], *arguments: Any) -> Any:
    """Call a task again if a disk fails; other errors would come again."""
    for _ in range(_TRIES - 1):
        with suppress(OSError):
            return task(*arguments)
    return task(*arguments)


# Tasks are long calls of the kernel: samples of their stacks say nothing, and take a twentieth.
# Nor does anybody look at pages of a cluster that lasts for a call.


@contextmanager
def client_of(given: Any) -> Iterator[Any]:
    """Use a client, the current one, or a cluster of this machine for as long as it is needed."""
    distributed = load("dask.distributed", extra="dask")
    if given is not None and not isinstance(given, distributed.Client):
        raise InputError(f"client is a {type(given).__name__}: give a dask.distributed.Client")
    used = given if given is not None else _current(distributed)
    if used is None:
        with local_cluster() as made:
            yield made
    elif used.asynchronous:
        raise InputError("the client is asynchronous: give one made with asynchronous=False")
    else:
        yield used


@contextmanager
def local_cluster(**options: Any) -> Iterator[Any]:
    """Start workers of one thread on this machine, and close them in the end.

    Whoever can talk to a scheduler can run anything as its user. So it and its workers listen on
    the loopback address alone, and take nobody without the credentials of this cluster, which are
    made for it and never leave memory. There is no dashboard. A worker that dies is replaced, also
    if that takes longer than the 15 seconds that Dask waits.

    Parameters
    ----------
    **options
        As for `dask.distributed.LocalCluster`.

    Yields
    ------
    distributed.Client
        A client of the cluster.

    Raises
    ------
    MissingDependencyError
        Dask, or cryptography, is not installed.

    See Also
    --------
    dask.delaunay, dask.triangulate : Take its client.

    Examples
    --------
    >>> with local_cluster(n_workers=1, processes=False) as client:
    ...     client.submit(abs, -1).result()
    1
    """
    distributed, config = (load(f"dask.{name}", extra="dask") for name in ("distributed", "config"))
    load("cryptography", extra="dask")  # which makes credentials
    place = config.get("temporary-directory") or tempfile.gettempdir()
    with config.set(_SETTINGS), working_folder(place, "workers") as folder:
        settings = {
            "threads_per_worker": 1,
            "security": True,
            "dashboard_address": "127.0.0.1:0",
            "scheduler_kwargs": {"dashboard": False},
            "local_directory": str(folder),
            **options,
        }
        with (
            distributed.LocalCluster(**settings) as cluster,
            distributed.Client(cluster, set_as_default=False) as client,
        ):
            yield client


def _current(distributed: Any) -> Any:
    with suppress(ValueError):
        return distributed.Client.current()
    return None
