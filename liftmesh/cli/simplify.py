"""``liftmesh simplify``: a mesh of few triangles within a distance of every point."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import Duplicates
from liftmesh.cli import (
    files,
    inputs,
    lidar,
    options,
    outputs,
    overwriting,
    rows,
    standard_streams,
    tables,
    terminal,
)
from liftmesh.cli.triangulate import bar_steps

if TYPE_CHECKING:
    from liftmesh.io.write import Written
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Approximate a raster or a cloud by a mesh of few triangles."
HELP = (
    "No point is further away from the mesh, along z, than --max-error: exactly. The mesh covers "
    "the hull of the points: simplify first, then trim with liftmesh triangulate. Where heights "
    "are whole numbers, a bound of 1.000001 in place of 1 needs fewer triangles: centres of pixels "
    "are rounded, and a distance of 1 is a little more."
)
EXAMPLES = [
    "liftmesh simplify dem.tif tin.ply --max-error 1",
    "liftmesh simplify dem.tif tin.xml --max-error 0.5 --max-points 100000",
    "liftmesh simplify ground.laz tin.ply --max-error 0.2",
]


@overwriting.guards("target")
@tables.with_options
@rows.with_options
@outputs.with_options
def run(
    sources: Annotated[
        list[Path],
        typer.Argument(metavar="IN", help="Rasters or clouds, merged; - reads stdin (see --from)."),
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="Mesh file; - writes stdout.")],
    max_error: Annotated[
        str | None,
        typer.Option(
            metavar="Z", help="The largest distance along z, in the units of the heights."
        ),
    ] = None,
    tolerance: Annotated[
        str | None, typer.Option(metavar="Z", help="Another name of --max-error.")
    ] = None,
    max_points: Annotated[
        str | None, typer.Option(metavar="N", help="The most vertices of the mesh.")
    ] = None,
    prune: Annotated[
        bool,
        typer.Option("--prune/--no-prune", help="Remove vertices that the distance does not need."),
    ] = True,
    plane: options.Plane = "xy",
    duplicates: Annotated[
        Duplicates,
        typer.Option(help="Which of several rows at one planar position is used as the vertex."),
    ] = "first",
    nonfinite: options.SkipNonFinite = "error",
    source_format: options.SourceFormat = None,
    target_format: options.TargetFormat = None,
    table: Any = None,
    selection: Any = None,
    max_bytes: options.MaxBytes = None,
    color_depth: options.ColorDepth = None,
    writing: Any = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, simplify its surface, write the mesh, and print a report."""
    frame, limits = options.parse_plane(plane), _limits(max_error, tolerance, max_points)
    if json:
        standard_streams.check_stdout()
    depth, limit = options.parse_color_depth(color_depth), options.parse_size(max_bytes)
    inputs.check_once(sources)
    files.check_target(target, target_format)
    outputs.check_options(target, target_format, writing)
    start = perf_counter()
    read = partial(files.read_ground, file_format=source_format, max_bytes=limit, table=table)
    cloud = inputs.merged(sources, partial(read, color_depth=depth), selection)
    with inputs.about(sources, cloud):
        files.check_content(target, target_format, cloud, writing)
        import liftmesh  # noqa: PLC0415 - help and --version do without

        with terminal.bar(1.0, len(cloud)) as bar, files.without_warnings():
            surface = liftmesh.simplify(
                cloud,
                **limits,
                prune=prune,
                plane=frame,
                duplicates=duplicates,
                nonfinite=nonfinite,
                progress=bar_steps(bar, f"simplifying {len(cloud):,} rows"),
            )
    written = outputs.write(target, surface, target_format, writing)
    place = (
        redirect_stdout(sys.stderr)
        if files.is_stream(target)
        else standard_streams.dispensable_stdout()
    )
    with place, standard_streams.after_writing(written.path):
        _print_report(written, surface, perf_counter() - start, as_json=json)


def _limits(max_error: str | None, tolerance: str | None, max_points: str | None) -> dict[str, Any]:
    """Convert the options, of which there must be one."""
    if max_error is not None and tolerance is not None:
        raise typer.BadParameter("--max-error and --tolerance are the same: give one")
    option = "--max-error" if tolerance is None else "--tolerance"
    max_error = max_error if tolerance is None else tolerance
    if max_error is None and max_points is None:
        raise typer.BadParameter("give --max-error or --max-points")
    found: dict[str, Any] = {}
    if max_points is not None:
        found["max_points"] = options.parse_count("--max-points", max_points, 3)
    if max_error is None:
        return found
    try:
        value = float(max_error)
    except ValueError:
        value = -1.0
    if not 0 <= value < float("inf"):
        raise typer.BadParameter(f"{option} {max_error!r} is not a distance: 0, or more")
    return found | {"max_error": value}


def _print_report(written: Written, surface: Surface, seconds: float, *, as_json: bool) -> None:
    told = surface.metadata["simplification"]
    if as_json:
        cloud = surface.to_cloud()
        terminal.as_json(
            {
                **outputs.values(written),
                "triangles": len(surface.faces),
                **told,
                "notes": list(files.notes(cloud)),
                "selection": files.counts_of(cloud),
                **lidar.provenance(surface),
                "seconds": seconds,
            }
        )
        return
    content = f"{told['kept']:,} of {told['positions']:,} positions"
    content += f", {len(surface.faces):,} triangles"
    terminal.sentence(outputs.headline(written, content), "good")
    lines = [("largest distance", f"{told['error']:.6g}")]
    if told["max_error"] is not None and not told["within"]:
        lines.append(("asked for", f"{told['max_error']:.6g}: --max-points came first"))
    if told["merged"]:
        lines.append(("of merged rows", f"{told['merged']:.6g}"))
    terminal.table([*lines, ("seconds", f"{seconds:.2f}")])
