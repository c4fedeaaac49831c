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

    target.check()
    cloud = inputs.read_rows([source], reading, of_surface=False)
    with inputs.about(source):
        target.check_content(cloud)
        with terminal.share_bar("finding the hull", len(cloud)) as progress:
            hull = liftmesh.convex_hull(
                cloud, nonfinite=nonfinite, threads=threads, progress=progress
            )
    written = target.write(replace(hull.to_cloud(), crs=cloud.crs))
    rows, vertices, facets = len(hull.points), len(hull.vertices), len(hull.faces)
    told = {"n_rows": rows, "n_vertices": vertices, "n_facets": facets}
    line = f"{facets:,} facets on {vertices:,} of {rows:,} rows"
    outputs.report(written, line, told, as_json=json)
