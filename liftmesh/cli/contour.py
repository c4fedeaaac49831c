"""``liftmesh contour``: lines of equal height as GeoJSON, GeoPackage, shapefile or DXF."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import click

from liftmesh.base.options import counted
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, number, numbers, option, positive, whole
from liftmesh.cli.wording import spelled
from liftmesh.errors import Option

SHORT_HELP = "Write lines of equal height over a mesh or cloud (GeoJSON, GeoPackage, DXF)."
HELP = (
    "Every line is closed or ends at the border; what is above is on its left. Properties of a "
    "line are its height, whether it is closed, and whether it is an index contour; DXF has these "
    "in a layer of their own. With --filled, OUT has polygons between the levels instead, with the "
    "properties lower and upper. IN may also be a folder of liftmesh tile --surface."
)
EXAMPLES = [
    "liftmesh contour tin.ply lines.geojson --interval 1",
    "liftmesh contour tin.ply shore.gpkg --levels -2,0 --trim-polygon parish.gpkg",
    "liftmesh contour tin.ply lines.dxf --interval 1 --index-every 5",
    "liftmesh contour tin.ply depths.gpkg --levels -20,-10,-5,0 --filled",
    "liftmesh contour survey.csv lines.geojson --interval 0.5 --min-length 10 --max-edge 20",
]


@outputs.guards("target", prints=True)
def run(
    source: surfaces.Source,
    target: Annotated[Path, argument("OUT", "GeoJSON, GeoPackage, shapefile, or lines as DXF.")],
    interval: Annotated[
        float | None, option("HEIGHT", "Lines at all multiples of this height.", positive)
    ] = None,
    levels: Annotated[Any, option("HEIGHTS", "Lines at these heights, as 1,2.5.", numbers)] = None,
    contour_base: Annotated[
        float | None,
        option(
            "HEIGHT", "Of --interval: height that multiples are counted from; default: 0.", number
        ),
    ] = None,
    index_every: Annotated[
        int | None,
        option("N", "Of --interval: every n-th is an index contour; default: 5.", whole(1)),
    ] = None,
    min_length: Annotated[float, option("LENGTH", "Leave out shorter lines.", number)] = 0,
    smooth: Annotated[
        float | None,
        option("HEIGHT", "Smooth lines; heights differ from the level by less.", positive),
    ] = None,
    values: surfaces.Values = None,
    *,
    filled: Annotated[bool, flag("Polygons between the levels, not lines.")] = False,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface, find its contours, write them, and say how many there are."""
    from liftmesh.terrain.contours import length_of
    from liftmesh.vector.files import check_written

    check_written(target, "bands" if filled else "contours", may_be_drawing=not filled)
    of_interval = options.given(contour_base=contour_base, index_every=index_every)
    heights = options.given(levels=levels, interval=interval)
    _check_heights(heights, of_interval)
    if filled:
        _check_no_lines(min_length=min_length or None, smooth=smooth, index_every=index_every)
    wanted = {**heights, **of_interval, **options.given(smooth=smooth)}
    with options.as_usage():
        least = length_of(min_length)
    outputs.check_place(target)
    more: dict[str, Any] = {}
    if source.is_dir():
        surface: Any = surfaces.open_tiles(source, reading, values=values)
    else:
        surface = surfaces.read(source, reading)
        more = {"values": values, "threads": reading.threads}
        if not reading.trimming:
            surfaces.note_slivers(source, surface)
    with terminal.stage("finding contours"):
        found = (surface.filled_contours if filled else surface.contours)(**wanted, **more)
    if not filled and not len(found):
        low, high = _heights(surface, values)
        named = "heights" if values is None else f"values {values!r}"
        terminal.note(f"{source}: no line: its {named} are from {low:.10g} to {high:.10g}")
    found = found if filled else found.longer_than(least)
    with terminal.stage(f"writing {target.name}"):
        found.save(target)
    counts, said = (_of_bands if filled else _of_lines)(found)
    if json:
        rows_of = {} if source.is_dir() else notes.provenance(surface)
        terminal.as_json({"path": str(target), **counts, **rows_of})
    else:
        terminal.sentence(f"{target}: {said}", "good")


def _check_heights(heights: dict[str, Any], of_interval: dict[str, Any]) -> None:
    if len(heights) != 1:
        raise click.BadParameter("give either --interval or --levels")
    if "levels" in heights and of_interval:
        given = spelled(Option(next(iter(of_interval))))
        raise click.BadParameter(
            f"{given} is of --interval only, and --levels is given: leave one out"
        )


def _check_no_lines(**of_lines: Any) -> None:
    if given := options.given(**of_lines):
        name = spelled(Option(next(iter(given))))
        raise click.BadParameter(f"{name} is of lines, and --filled is given: leave one out")


def _of_lines(lines: Any) -> tuple[dict[str, Any], str]:
    """Count lines, and say it."""
    levels, length = len({*lines.levels.tolist()}), float(lines.lengths.sum())
    counts = {"n_lines": len(lines), "n_levels": levels, "length": length}
    said = f"{counted(len(lines), 'line')} at {counted(levels, 'level')}, {length:,.2f} long"
    return counts, said


def _of_bands(bands: Any) -> tuple[dict[str, Any], str]:
    """Count bands and their polygons, and say it."""
    polygons = len(bands.polygons) - 1
    counts = {"n_bands": len(bands), "n_polygons": polygons, "area": float(bands.areas.sum())}
    return counts, f"{counted(len(bands), 'band')} of {counted(polygons, 'polygon')}"


def _heights(surface: Any, values: str | None) -> tuple[float, float]:
    """Return the least and the greatest height, or value, of a surface, or of one in tiles."""
    from liftmesh.terrain.values import over_known
    from liftmesh.tiles.tiled_data import TiledSurfaceData, box_of

    if isinstance(surface, TiledSurfaceData):
        _, _, low, _, _, high = box_of(surface)
        return low, high
    if values is not None:
        surface = over_known(surface, values)
    heights = surface.frame.heights(surface.vertices).take(surface.faces, axis=0)
    return float(heights.min()), float(heights.max())
