"""``liftmesh plot``: a picture of a mesh, a cloud, a raster or tiles."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import click

from liftmesh.cli import options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, option, positive, whole

SHORT_HELP = "Draw a mesh, a cloud or tiles as a map: PNG, SVG or PDF."
HELP = (
    "Shaded relief with contours, a scale bar, and units where the file says them. A cloud is "
    "triangulated first. IN may also be a folder of liftmesh tile --surface."
)
EXAMPLES = [
    "liftmesh plot tin.ply map.png",
    "liftmesh plot survey.laz map.pdf --interval 5 --dpi 300",
    "liftmesh plot tin.ply edges.svg --edges --no-contours",
    "liftmesh plot tin.ply intensity.png --values intensity --cmap viridis",
]


@outputs.guards("target", prints=True)
def run(
    source: surfaces.Source,
    target: Annotated[Path, argument("OUT", "Picture, as .png, .svg or .pdf.")],
    interval: Annotated[
        float | None, option("HEIGHT", "Contours at its multiples; default: a round one.", positive)
    ] = None,
    cmap: Annotated[str | None, option("NAME", "Colour map of matplotlib.")] = None,
    values: surfaces.Values = None,
    dpi: Annotated[int, option("N", "Pixels an inch, of 8 by 6 inches.", whole(1))] = 150,
    *,
    contours: Annotated[bool, flag("Draw lines of equal height.")] = True,
    edges: Annotated[bool, flag("Draw the sides of all faces.")] = False,
    tiles: Annotated[bool, flag("Draw the cuts between tiles, and what crosses them.")] = False,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface, draw it, and say where the picture is."""
    import liftmesh
    from liftmesh.io.atomic import replacing
    from liftmesh.plots.plot import check_picture

    check_picture(target)
    outputs.check_place(target)
    surface = surfaces.read_or_open(source, reading)
    style: dict[str, Any] = {"edges": edges, **options.given(cmap=cmap, values=values)}
    if source.is_dir():
        style["tiles"] = tiles
    elif tiles:
        raise click.BadParameter("--tiles is for a folder of liftmesh tile --surface")
    wanted = (interval or True) if contours else False
    with terminal.stage(f"drawing {target.name}"):
        figure: Any = liftmesh.plot(surface, contours=wanted, **style).figure
        with replacing(target) as stream:
            figure.savefig(stream, format=target.suffix[1:].lower(), dpi=dpi)
    if json:
        terminal.as_json({"path": str(target), "bytes": target.stat().st_size})
    else:
        terminal.sentence(f"{target}: {target.stat().st_size / 1e6:,.1f} MB", "good")
