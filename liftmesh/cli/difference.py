"""``liftmesh difference``: how two surfaces differ, as a mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument

SHORT_HELP = "Write the difference of two meshes or clouds, as a mesh."
HELP = (
    "OUT has the heights of AFTER less those of IN, exactly, where both have faces. It is a mesh "
    "as any other: liftmesh raster makes a map of it, liftmesh contour with --levels 0 the lines "
    "between cut and fill, and liftmesh volume measures both."
)
EXAMPLES = [
    "liftmesh difference before.ply after.ply change.ply",
    "liftmesh difference 2019.laz 2024.laz change.ply --max-edge 20 --json",
]

Target: TypeAlias = Annotated[outputs.Target, outputs.target("Mesh file; - writes stdout.")]


@outputs.guards("target")
def run(
    source: surfaces.Source,
    other: Annotated[Path, argument("AFTER", "What IN becomes.")],
    target: Target,
    *,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read two surfaces, subtract the first, write what is between, and say how much that is."""
    import liftmesh

    other.open("rb").close()
    target.check()
    before, after = surfaces.read(source, reading), surfaces.read(other, reading)
    surfaces.check_grounds({source: before, other: after})
    with terminal.share_bar("laying the surfaces over each other", 0) as progress:
        change = liftmesh.difference(after, before, threads=reading.threads, progress=progress)
    written = target.write(change)
    rows_of = {**notes.provenance(before), "after": notes.provenance(after)}
    volumes, heights = change.volume(), change.frame.heights(change.vertices)
    told = {
        "n_rows": len(heights),
        "n_triangles": len(change.faces),
        "lowest": float(heights.min()),
        "highest": float(heights.max()),
        "cut": volumes.below,
        "fill": volumes.above,
        "planar_area": volumes.area,
        "cubic_metres_per_unit": volumes.cubic_metres,
        **change.metadata["difference"],
    }
    content = f"{len(heights):,} vertices, {len(change.faces):,} triangles, differences from "
    content += f"{told['lowest']:.10g} to {told['highest']:.10g}"
    shown = ("cut", "fill", "planar_area", "displacement")
    rows = [(name.replace("_", " "), f"{told[name]:.10g}") for name in shown]
    outputs.report(written, content, told | rows_of, rows, as_json=json)
