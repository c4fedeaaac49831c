"""``liftmesh contour``: lines of equal height as GeoJSON or GeoPackage."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from liftmesh.cli import (
    files,
    lidar,
    options,
    overwriting,
    standard_streams,
    surfaces,
    terminal,
)
from liftmesh.cli.reading import with_options as with_reading
from liftmesh.cli.tiled_surfaces import opened
from liftmesh.cli.values import checked

SHORT_HELP = "Write lines of equal height over a mesh or cloud (GeoJSON, GeoPackage)."
HELP = (
    "Every line is closed or ends at the border; what is above is on its left. Properties of a "
    "line are its height, whether it is closed, and whether it is an index contour. IN may also be "
    "a folder of liftmesh tile --surface."
)
EXAMPLES = [
    "liftmesh contour tin.ply lines.geojson --interval 1",
    "liftmesh contour tin.ply shore.gpkg --levels -2,0 --polygon parish.gpkg",
    "liftmesh contour survey.csv lines.geojson --interval 0.5 --min-length 10 --max-edge 20",
]


@overwriting.guards("target")
@with_reading
def run(
    source: surfaces.Source,
    target: Annotated[Path, typer.Argument(metavar="OUT", help="GeoJSON or GeoPackage file.")],
    interval: Annotated[
        str | None, typer.Option(metavar="HEIGHT", help="Lines at all multiples of this height.")
    ] = None,
    levels: Annotated[
        str | None, typer.Option(metavar="HEIGHTS", help="Lines at these heights, as 1,2.5.")
    ] = None,
    base: Annotated[
        str, typer.Option(metavar="HEIGHT", help="Height that multiples are counted from.")
    ] = "0",
    index_every: Annotated[
        str, typer.Option("--index-every", metavar="N", help="Every n-th is an index contour.")
    ] = "5",
    min_length: Annotated[
        str, typer.Option("--min-length", metavar="LENGTH", help="Leave out shorter lines.")
    ] = "0",
    reading: Any = None,
    json: options.Json = False,
) -> None:
    """Read a surface, find its contours, write them, and say how many there are."""
    from liftmesh.terrain.contours import check_name, length_of  # noqa: PLC0415 - help and --version do without

    standard_streams.check_stdout()
    check_name(target)
    wanted = _wanted(interval, levels, base)
    with checked():
        least = length_of(surfaces.parse_number("--min-length", min_length))
    every = options.parse_count("--index-every", index_every, 1)
    files.check_place(target)
    if source.is_dir():
        surface: Any = opened(source, reading)
        with terminal.stage("finding contours"):
            lines = surface.contours(**wanted, index_every=every)
    else:
        surface = reading.surface(source)
        if not reading.trimming:
            surfaces.note_slivers(source, surface)
        with terminal.stage("finding contours"):
            lines = surface.contours(**wanted, index_every=every, threads=reading.threads)
    if not len(lines):
        terminal.note(
            "{}: no line: its heights are from {:.10g} to {:.10g}".format(
                source, *_heights(surface)
            )
        )
    lines = lines.longer_than(least)
    with terminal.stage(f"writing {target.name}"):
        path = lines.save(target)
    heights, length = len({*lines.levels.tolist()}), float(lines.lengths.sum())
    if json:
        values: dict[str, Any] = {"lines": len(lines), "levels": heights, "length": length}
        values |= {} if source.is_dir() else lidar.provenance(surface)
        terminal.as_json({"path": str(path), **values})
    else:
        terminal.sentence(
            f"{path}: {len(lines):,} line{'' if len(lines) == 1 else 's'} at {heights:,} "
            f"level{'' if heights == 1 else 's'}, {length:,.2f} long",
            "good",
        )


def _heights(surface: Any) -> tuple[float, float]:
    """Return the least and the greatest height of a surface, or of one in tiles."""
    if hasattr(surface, "extent"):
        return surface.extent[2], surface.extent[5]
    heights = surface.frame.heights(surface.vertices)[surface.faces]
    return float(heights.min()), float(heights.max())


def _wanted(interval: str | None, levels: str | None, base: str) -> dict[str, Any]:
    """Parse which heights are wanted: either an interval or levels."""
    if (interval is None) == (levels is None):
        raise typer.BadParameter("give either --interval or --levels")
    if levels is not None:
        return {"levels": [surfaces.parse_number("--levels", each) for each in levels.split(",")]}
    step = surfaces.parse_number("--interval", interval, positive=True)
    return {"interval": step, "base": surfaces.parse_number("--base", base)}
