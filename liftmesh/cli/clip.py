"""``liftmesh clip``: the part of a surface that is inside, or outside, of polygons."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import click

from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import flag, option

SHORT_HELP = "Cut a mesh or cloud along polygons, and keep what is inside."
HELP = (
    "Faces are cut along the border, and keep their planes; where the border crosses their sides, "
    "there are new rows with the heights of the faces. What is inside and what is outside have the "
    "same rows at the border. --trim-polygon, in contrast, leaves out whole faces. IN may also be "
    "a folder of liftmesh tile --surface, of which a part is read."
)
EXAMPLES = [
    "liftmesh clip tin.ply parish.ply --within parish.gpkg",
    "liftmesh clip tiles/ parish.ply --within parish.gpkg",
    "liftmesh clip tin.ply around.ply --within lake.geojson --invert",
    "liftmesh clip site.ply built.ply --within pad.geojson --paste pad.ply",
]

Target: TypeAlias = Annotated[outputs.Target, outputs.target("Mesh file; - writes stdout.")]


@outputs.guards("target")
def run(
    source: surfaces.Source,
    target: Target,
    within: Annotated[Path, option("FILE", "Polygons to keep (GeoJSON, GeoPackage, shapefile).")],
    invert: Annotated[bool, flag("Keep what is outside instead.")] = False,
    paste: Annotated[
        Path | None, option("FILE", "Keep what is outside, and put this surface inside.")
    ] = None,
    *,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface, cut it, write what is left, and say how much that is."""
    import liftmesh

    if paste is not None and invert:
        raise click.BadParameter("--paste keeps what is outside: leave --invert out")
    for path in (within, paste):
        if path is not None:
            path.open("rb").close()
    if source.is_dir() and (invert or paste is not None):
        raise click.BadParameter("--invert and --paste need a file: of tiles, a part is taken out")
    target.check()
    surface = surfaces.read_or_open(source, reading)
    other = None if paste is None else surfaces.read(paste, reading)
    with terminal.stage("cutting faces"):
        if other is None:
            left = surface.clip(within, **options.given(invert=invert or None))
        else:
            left = liftmesh.paste(surface, other, within)
    written = target.write(left)
    rows_of = {} if source.is_dir() else notes.provenance(surface)
    added = int(left.attributes["steiner"].sum()) if "steiner" in left.attributes else 0
    area = left.area(planar=True)
    rows, faces = len(left.vertices), len(left.faces)
    told = {"n_rows": rows, "n_added": added, "n_triangles": faces, "planar_area": area, **rows_of}
    content = f"{rows:,} vertices, {added:,} of them added, {faces:,} triangles, "
    content += f"planar area {area:,.10g}"
    outputs.report(written, content, told, as_json=json)
