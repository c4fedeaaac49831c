"""``liftmesh tile``: triangulate more points than memory holds, into a folder."""

from __future__ import annotations

import logging
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.choices import ShardFormat
from liftmesh.cli import options, standard_streams, terminal

if TYPE_CHECKING:
    from liftmesh._typing import Progress
    from liftmesh.tiles.tiled import Tiled

SHORT_HELP = "Triangulate more points than memory holds, in tiles."
HELP = (
    "Writes shards of triangles and a manifest to a folder. Together they are exactly the "
    "triangles of all points. A run that was stopped goes on where it was."
)
EXAMPLES = [
    "liftmesh tile cloud.npy tiles/",
    "liftmesh tile a.laz b.laz tiles/ --memory 1GB --workers 2",
    "liftmesh tile cloud.npy /shared/tiles/ --scheduler tcp://10.0.0.1:8786",
]
SHOWN = ("rows", "triangles", "duplicates", "skipped", "hull")


def run(
    sources: Annotated[
        list[Path],
        typer.Argument(metavar="IN...", help="NPY, Parquet, LAS, LAZ, PLY, text."),
    ],
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to write to.")],
    memory: Annotated[
        str | None,
        typer.Option(
            metavar="SIZE", help="Memory of each process, as 500M or 4G: sizes the tiles."
        ),
    ] = None,
    tile_rows: Annotated[
        str | None, typer.Option(metavar="N", help="Rows of a tile, in place of --memory.")
    ] = None,
    workers: Annotated[
        str | None,
        typer.Option(metavar="N", help="Processes, run by Dask; by default this one alone."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Scheduler of Dask whose workers do the work."),
    ] = None,
    scratch: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="For 24 bytes a row; by default a folder in OUT."),
    ] = None,
    anew: Annotated[
        bool, typer.Option("--anew", help="Replace what a former run has written to OUT.")
    ] = False,
    shards: Annotated[
        ShardFormat, typer.Option(help="Format of the triangles; ply holds meshes.")
    ] = "npy",
    neighbors: Annotated[
        bool, typer.Option("--neighbors", help="Also write which triangles share an edge.")
    ] = False,
    nonfinite: options.SkipNonFinite = "error",
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Triangulate in tiles, and say how many triangles there are.

    Parameters
    ----------
    sources : list of Path
        IN...
    out : Path
        OUT.
    memory, tile_rows, workers, scheduler : str, optional
        How large tiles are, and who works.
    scratch : Path, optional
        As in `liftmesh.tile`.
    anew : bool
        Whether not to resume.
    shards : str
        The format of the triangles.
    neighbors : bool
        Whether neighbours are written.
    nonfinite, threads : str
        As in `liftmesh.tile`.
    json : bool
        Print JSON.
    """
    standard_streams.check_stdout()
    _check_options(memory, tile_rows, workers, scheduler, threads)
    from liftmesh.tiles.run import rows_within  # noqa: PLC0415 - help and --version do without

    limit = options.parse_size(memory, "--memory")
    rows: Any = "auto" if limit is None else rows_within(limit)
    if tile_rows is not None:
        rows = options.parse_count("--tile-rows", tile_rows, 16)
    common = {"tile_rows": rows, "scratch": scratch, "nonfinite": nonfinite, "resume": not anew}
    common |= {"shards": shards, "neighbors": neighbors}
    paths = [str(path) for path in sources]
    with terminal.bar(1.0) as advance:
        shown = [0.0]

        def progress(share: float) -> None:
            advance(f"triangulating into {out}", share - shown[0])
            shown[0] = share

        if workers is None and scheduler is None:
            found = _alone(paths, out, options.parse_threads(threads), progress, common)
        else:
            found = _by_dask(paths, out, workers, scheduler, limit, progress, common)
    _say(found, json=json)


def _check_options(
    memory: str | None,
    tile_rows: str | None,
    workers: str | None,
    scheduler: str | None,
    threads: str | None,
) -> None:
    """Raise if two options contradict each other."""
    for one, other, given in (
        ("--memory", "--tile-rows", (memory, tile_rows)),
        ("--workers", "--scheduler", (workers, scheduler)),
        ("--workers", "--threads", (workers, threads)),
        ("--scheduler", "--threads", (scheduler, threads)),
    ):
        if None not in given:
            raise typer.BadParameter(f"{one} and {other} exclude each other: leave one out")


def _alone(
    paths: list[str], out: Path, threads: int | None, progress: Progress, common: dict[str, Any]
) -> Tiled:
    from liftmesh.tiles.build import tile  # noqa: PLC0415 - help and --version do without

    return tile(paths, out, threads=threads, progress=progress, **common)


def _by_dask(
    paths: list[str],
    out: Path,
    workers: str | None,
    scheduler: str | None,
    limit: int | None,
    progress: Progress,
    common: dict[str, Any],
) -> Tiled:
    from liftmesh.dask import delaunay  # noqa: PLC0415 - as above
    from liftmesh.optional import load  # noqa: PLC0415 - as above

    count = None if workers is None else options.parse_count("--workers", workers, 1)
    distributed = load("dask.distributed", extra="dask")
    with ExitStack() as stack:
        place = scheduler
        if count is not None:
            settings: dict[str, Any] = {"threads_per_worker": 1, "dashboard_address": ":0"}
            settings |= {} if limit is None else {"memory_limit": limit}
            settings["silence_logs"] = logging.CRITICAL  # errors of tasks are raised here
            place = stack.enter_context(distributed.LocalCluster(n_workers=count, **settings))
        client = stack.enter_context(distributed.Client(place))
        return delaunay(paths, out, client=client, progress=progress, **common)


def _say(found: Tiled, *, json: bool) -> None:
    counts = {name: found.manifest[name] for name in SHOWN}
    if json:
        terminal.as_json(
            {"folder": str(found.directory), **counts, "merges": dict(found.manifest["merges"])}
        )
        return
    merges = found.manifest["merges"]
    share = merges["rows_up_from_tiles"] / max(1, counts["rows"])
    terminal.table(
        [
            *((name, f"{count:,}") for name, count in counts.items()),
            ("tiles", f"{merges['tiles']:,}  ({share:.2%} of the rows were merged)"),
            ("shards", f"{len(found.shards):,} in {found.directory}"),
        ]
    )
