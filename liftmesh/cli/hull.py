"""``liftmesh hull``: the convex hull of points in space."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from liftmesh.cli import inputs, options, outputs, terminal

SHORT_HELP = "The convex hull of points in space, exact, as a watertight mesh."
HELP = (
    "Facets are seen counter-clockwise from outside. Points on facets and edges of the hull are "
    "vertices too; rows inside are left out. The facets depend on the points alone."
)
EXAMPLES = [
    "liftmesh hull cloud.ply hull.stl",
    "liftmesh hull scan.laz hull.glb --json",
]


@outputs.guards("target")
def run(
    source: options.Source,
    target: Annotated[outputs.Target, outputs.target("Mesh; the suffix determines the format.")],
    *,
    reading: inputs.AllRows,
    nonfinite: options.SkipNonFinite = "error",
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, find its hull, write it, and print a report."""
    import liftmesh

    if json:
        outputs.check_stdout()
    target.check()
    cloud = inputs.read_rows([source], reading, of_surface=False)
    with inputs.about(source):
        target.check_content(cloud)
        with terminal.share_bar("finding the hull", len(cloud)) as progress:
            hull = liftmesh.convex_hull(
                cloud, nonfinite=nonfinite, threads=threads, progress=progress
            )
    written = target.write(replace(hull.to_cloud(), crs=cloud.crs))
    with outputs.report_after(target.path):
        counts = {
            "rows": len(hull.points),
            "vertices": len(hull.vertices),
            "facets": len(hull.faces),
        }
        line = f"{counts['facets']:,} facets on {counts['vertices']:,} of {counts['rows']:,} rows"
        outputs.report_counts(written, line, counts, as_json=json)
