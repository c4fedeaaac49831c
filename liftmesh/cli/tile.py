"""``liftmesh tile``: triangles or a surface of more points than memory holds, in a folder."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.base.options import OnDuplicate, ShardFormat
from liftmesh.cli import inputs, notes, options, outputs, terminal
from liftmesh.cli.options import argument, flag, option, whole
from liftmesh.cli.wording import spelled
from liftmesh.errors import DegenerateInputError, Option

if TYPE_CHECKING:
    from liftmesh.tiles.tiled import Tiled

SHORT_HELP = "Triangulate more points than memory holds, in tiles."
HELP = (
    "Writes shards of triangles and a manifest to a folder. Together they are exactly the "
    "triangles of all points. A run that was stopped resumes. With --surface, shards "
    "also hold vertices with heights and values, and IN may be any cloud."
)
EXAMPLES = [
    "liftmesh tile cloud.npy tiles/",
    "liftmesh tile a.laz b.laz tiles/ --memory 1GB --workers 2",
    "liftmesh tile a.laz b.laz ground/ --surface --classes 2 --on-duplicate lowest",
    "liftmesh tile cloud.npy /shared/tiles/ --scheduler tcp://10.0.0.1:8786",
]
_NO_LEAKS = "ignore:resource_tracker:UserWarning:multiprocessing.resource_tracker"
SHOWN = ("rows", "triangles", "duplicates", "skipped", "hull")


def run(
    sources: Annotated[list[Path], argument("IN", "NPY, Parquet, LAS, LAZ, PLY, text.")],
    out: Annotated[Path, argument("OUT", "Folder to write to.")],
    surface: Annotated[bool, flag("Keep heights, colours and named values, too.")] = False,
    on_duplicate: Annotated[
        OnDuplicate | None,
        flag(
            "Of a surface, which of several rows at one planar position is the vertex; by "
            "default the first."
        ),
    ] = None,
    memory: Annotated[
        int | None,
        option("SIZE", "Memory of each process, as 500M or 4G: sizes the tiles.", options.size),
    ] = None,
    tile_rows: Annotated[
        int | None, option("N", "Rows of a tile, in place of --memory.", whole(16))
    ] = None,
    workers: Annotated[
        int | None, option("N", "Processes, run by Dask; by default this one alone.", whole(1))
    ] = None,
    scheduler: Annotated[
        str | None, option("ADDRESS", "Scheduler of Dask whose workers do the work.")
    ] = None,
    scratch: Annotated[
        Path | None,
        option(
            "FOLDER", "For 24 bytes a row, fewer as tiles are finished; by default a folder in OUT."
        ),
    ] = None,
    restart: Annotated[bool, flag("Replace what a former run has written to OUT.")] = False,
    shards: Annotated[
        ShardFormat, flag("Format of triangles without heights; ply holds meshes.")
    ] = "npy",
    neighbors: Annotated[bool, flag("Also write which triangles share an edge.")] = False,
    nonfinite: options.SkipNonFinite = "error",
    threads: options.Threads = None,
    *,
    rows: inputs.Rows,
    json: options.Json = False,
) -> None:
    """Triangulate in tiles, and say how many triangles there are."""
    outputs.check_stdout()
    inputs.check_once(sources)
    _check_options(memory, tile_rows, workers, scheduler, threads)
    if not surface and (on_duplicate or rows):
        given = "--on-duplicate" if on_duplicate else spelled(Option(next(iter(rows))))
        raise click.BadParameter(f"{given} is for surfaces: give --surface, too, or leave it out")
    if surface and shards != "npy":
        raise click.BadParameter(f"--shards {shards} is for triangles alone: a surface has NPY")
    from liftmesh.tiles.options import (
        ROW_BYTES,
        SURFACE_ROW_BYTES,
        rows_within,
    )

    row_bytes = SURFACE_ROW_BYTES if surface else ROW_BYTES
    rows_of_tile: Any = "auto" if tile_rows is None else tile_rows
    if memory is not None:
        with options.as_usage():
            rows_of_tile = rows_within(memory, row_bytes=row_bytes)
    common = {"tile_rows": rows_of_tile, "scratch": scratch, "nonfinite": nonfinite}
    common |= {"resume": not restart, "shards": shards, "neighbors": neighbors}
    if surface:
        common |= {"on_duplicate": on_duplicate or "first", **rows}
    paths = [str(path) for path in sources]
    with _named(paths), terminal.share_bar(f"triangulating into {out}") as progress:
        common |= {"progress": progress}
        by_dask = workers is not None or scheduler is not None
        make = _maker(surface=surface, by_dask=by_dask)
        if not by_dask:
            tiled = make(paths, out, threads=threads, **common)
        else:
            with _client(workers, scheduler, memory) as client:
                tiled = make(paths, out, client=client, **common)
    _say(tiled, json=json)


@contextmanager
def _named(paths: list[str]) -> Iterator[None]:
    """Add the names of the files to an error about all of their points."""
    try:
        yield
    except DegenerateInputError as error:
        error.within(notes.listed(paths))
        raise


def _check_options(
    memory: int | None,
    tile_rows: int | None,
    workers: int | None,
    scheduler: str | None,
    threads: int | None,
) -> None:
    """Raise if two options contradict each other."""
    for one, other, given in (
        ("--memory", "--tile-rows", (memory, tile_rows)),
        ("--workers", "--scheduler", (workers, scheduler)),
        ("--workers", "--threads", (workers, threads)),
        ("--scheduler", "--threads", (scheduler, threads)),
    ):
        if None not in given:
            raise click.BadParameter(f"{one} and {other} exclude each other: leave one out")


def _maker(*, surface: bool, by_dask: bool) -> Callable[..., Tiled]:
    """Return what does the work, in this process or on the workers of Dask."""
    if by_dask:
        from liftmesh.dask import delaunay, triangulate

        return triangulate if surface else delaunay
    from liftmesh.tiles.build import tile, tile_surface

    return tile_surface if surface else tile


@contextmanager
def _client(workers: int | None, scheduler: str | None, limit: int | None) -> Iterator[Any]:
    from liftmesh.dask import local_cluster
    from liftmesh.optional import load

    if scheduler is not None:
        distributed = load("dask.distributed", extra="dask")
        _check_address(scheduler)
        with distributed.Client(scheduler) as client:
            yield client
        return
    settings: dict[str, Any] = {} if limit is None else {"memory_limit": limit}
    settings["silence_logs"] = logging.CRITICAL  # errors of tasks are raised here
    # A signal ends this process while workers end, too: whatever semaphores they had are removed by
    # the tracker of multiprocessing, which takes the options of warnings from its parent.
    sys.warnoptions.append(_NO_LEAKS)
    try:
        with local_cluster(n_workers=workers, **settings) as client:
            yield client
    finally:
        sys.warnoptions.remove(_NO_LEAKS)


def _check_address(text: str) -> None:
    """Raise unless it is an address that a process may connect to."""
    from liftmesh.optional import load

    addressing = load("distributed.comm.addressing", extra="dask")
    protocols = {*load("distributed.comm.registry", extra="dask").backends} - {"inproc"}
    try:
        protocol, place = addressing.parse_address(text)
        host, port = addressing.parse_host_port(place)
    except ValueError:
        protocol, host, port = "", "", 0
    if protocol not in protocols or not host or not 0 < port < 1 << 16:
        raise click.BadParameter(
            f"--scheduler {text!r} is no address: give one as tcp://10.0.0.1:8786"
        )


def _say(tiled: Tiled, *, json: bool) -> None:
    counts = {name: tiled.manifest[name] for name in SHOWN}
    if "surface" in tiled.manifest:
        counts["overhangs"] = tiled.manifest["surface"]["overhangs"]
        counts["duplicates"] -= counts["overhangs"]
    classes: dict[int, int] = getattr(tiled, "classes", {})
    if json:
        named = outputs.as_named(counts)
        named["n_hull_edges"] = named.pop("n_hull")
        said = {"folder": str(tiled.folder), **named, "classes": classes}
        terminal.as_json({**said, "merges": dict(tiled.manifest["merges"])})
        return
    merges = tiled.manifest["merges"]
    share = merges["rows_up_from_tiles"] / max(1, counts["rows"])
    terminal.table(
        [
            *outputs.as_rows(counts),
            *notes.lidar_lines({"classes": classes}),
            ("tiles", f"{merges['tiles']:,}  ({share:.2%} of the rows were merged)"),
            ("shards", f"{len(tiled.shards):,} in {tiled.folder}"),
        ]
    )
