"""``liftmesh tetrahedralize``: the Delaunay triangulation of points in space."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click

from liftmesh.cli import inputs, options, outputs, terminal
from liftmesh.cli.options import argument, is_stream

SHORT_HELP = "Tetrahedra of points in space, exact and canonical."
HELP = (
    "OUT is VTU, VTK or MSH of Gmsh, with every row of IN in its place. Of rows at one position "
    "the first is a corner. liftmesh verify proves the file."
)
EXAMPLES = [
    "liftmesh tetrahedralize cloud.ply cells.vtu",
    "liftmesh tetrahedralize scan.laz cells.msh --json",
]


@outputs.guards("target", prints=True)
def run(
    source: options.Source,
    target: Annotated[Path, argument("OUT", "Tetrahedra, as .vtu, .vtk or .msh.")],
    *,
    reading: inputs.AllRows,
    nonfinite: options.SkipNonFinite = "error",
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, make tetrahedra, write them, and print a report."""
    import liftmesh
    from liftmesh.io.tetrahedra import checked_format

    if is_stream(target):
        raise click.BadParameter("tetrahedra are not written to stdout: name a file")
    checked_format(target)
    outputs.check_place(target)
    cloud = inputs.read_rows([source], reading, of_surface=False)
    with inputs.about(source), terminal.share_bar("making tetrahedra", len(cloud)) as progress:
        tetra = liftmesh.tetrahedralize(
            cloud, nonfinite=nonfinite, threads=threads, progress=progress
        )
    with terminal.stage(f"writing {target.name}"):
        written = tetra.save(target)
    counts = {
        "rows": len(tetra.points),
        "tetrahedra": len(tetra.simplices),
        "hull facets": len(tetra.convex_hull),
        "duplicates": len(tetra.duplicates),
        "skipped": len(tetra.skipped),
    }
    line = f"{counts['tetrahedra']:,} tetrahedra of {counts['rows']:,} rows"
    outputs.report(written, line, outputs.as_named(counts), outputs.as_rows(counts), as_json=json)
