"""``liftmesh simplify``: a mesh of few triangles within a distance of every point."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, TypeAlias

import click

from liftmesh.cli import inputs, notes, options, outputs, terminal
from liftmesh.cli.options import argument, flag, option, whole

if TYPE_CHECKING:
    from liftmesh.io.write import WriteResult
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Approximate a raster or a cloud by a mesh of few triangles."
HELP = (
    "No point is further away from the mesh, along z, than --max-error: exactly. A mesh with "
    "edges, as liftmesh triangulate --breaklines writes it, keeps them with their vertices; where "
    "faces are left out, the sides around these stay. Where heights are whole numbers, a bound of "
    "1.000001 in place of 1 needs fewer triangles: centers of pixels are rounded, and a distance "
    "of 1 is a little more."
)
EXAMPLES = [
    "liftmesh simplify dem.tif tin.ply --max-error 1",
    "liftmesh simplify dem.tif tin.xml --max-error 0.5 --max-points 100000",
    "liftmesh simplify ground.laz tin.ply --max-error 0.2",
    "liftmesh simplify road.ply few.ply --max-error 0.2",
]

Target: TypeAlias = Annotated[outputs.Target, outputs.target("Mesh file; - writes stdout.")]


@outputs.guards("target")
def run(
    sources: Annotated[
        list[Path], argument("IN", "Rasters or clouds, merged; - reads stdin (see --input-format).")
    ],
    target: Target,
    max_error: Annotated[
        float | None,
        option("Z", "The largest distance along z, in the units of the heights.", options.distance),
    ] = None,
    max_points: Annotated[
        int | None, option("N", "The most vertices of the mesh.", whole(3))
    ] = None,
    prune: Annotated[
        bool,
        flag("Remove vertices that the distance does not need."),
    ] = True,
    plane: options.Plane = "xy",
    on_duplicate: options.OnDuplicate = "first",
    *,
    reading: inputs.ColoredReading,
    nonfinite: options.SkipNonFinite = "error",
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, simplify its surface, write the mesh, and print a report."""
    import liftmesh

    if max_error is None and max_points is None:
        raise click.BadParameter("give --max-error or --max-points")
    limits = options.given(max_points=max_points, max_error=max_error)
    inputs.check_once(sources)
    target.check()
    start = perf_counter()
    cloud = inputs.read_rows(sources, reading)
    text = f"simplifying {len(cloud):,} rows"
    with inputs.about_rows(sources, cloud):
        target.check_content(cloud)
        with terminal.share_bar(text, len(cloud)) as progress, inputs.without_warnings() as told:
            surface = liftmesh.simplify(
                cloud,
                **limits,
                prune=prune,
                plane=plane.value,
                on_duplicate=on_duplicate,
                nonfinite=nonfinite,
                threads=threads,
                progress=progress,
            )
    written = target.write(surface)
    _report(written, surface, perf_counter() - start, told, as_json=json)


def _report(
    written: WriteResult, surface: Surface, seconds: float, told: list[str], *, as_json: bool
) -> None:
    counts = notes.provenance_of(surface).simplification
    cloud = surface.to_cloud()
    values = {
        "n_triangles": len(surface.faces),
        **counts,
        "notes": [*notes.cloud_notes(cloud), *told],
        "selection": notes.counts_of(cloud),
        **notes.provenance(surface),
        "seconds": seconds,
    }
    content = f"{counts['n_kept']:,} of {counts['n_positions']:,} positions"
    content += f", {len(surface.faces):,} triangles"
    lines = [("largest distance", f"{counts['error']:.6g}")]
    if counts["max_error"] is not None and not counts["within"]:
        lines.append(("asked for", f"{counts['max_error']:.6g}: --max-points came first"))
    if counts["merged"]:
        lines.append(("of merged rows", f"{counts['merged']:.6g}"))
    lines.append(("seconds", f"{seconds:.2f}"))
    outputs.report(written, content, values, lines, as_json=as_json)
