"""``liftmesh volume``: areas of a surface, and volumes above and below a level."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.cli import lidar, options, standard_streams, surfaces, terminal
from liftmesh.cli.reading import with_options as with_reading

if TYPE_CHECKING:
    from liftmesh.terrain.earthwork import Earthwork
    from liftmesh.terrain.measures import Volume

SHORT_HELP = "Measure volumes above and below a level, or between two surfaces."
HELP = (
    "Volumes are counted where there are faces only; their unit is that of x, y and z. With "
    "--within, those of all polygons together come first, then those of each: by the property or "
    "column --by, or by the number."
)
EXAMPLES = [
    "liftmesh volume before.ply after.ply --json",
    "liftmesh volume heap.ply --level 12.5",
    "liftmesh volume before.ply after.ply --within lots.geojson --json",
    "liftmesh volume survey.csv --level 0 --max-edge 20 --boundary-only --json",
]

_VOLUMES = ("above", "below", "cut", "fill", "net")


@with_reading
def run(
    source: surfaces.Source,
    other: Annotated[
        Path | None,
        typer.Argument(
            metavar="[AFTER]", help="What IN becomes: prints cut and fill.", show_default=False
        ),
    ] = None,
    level: Annotated[
        str | None, typer.Option(metavar="HEIGHT", help="The level, 0 by default.")
    ] = None,
    within: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Measure inside of polygons alone, cut at their borders."
        ),
    ] = None,
    by: Annotated[
        str | None,
        typer.Option(
            metavar="PROPERTY",
            help="The property or column that names the polygons, 'name' by default.",
        ),
    ] = None,
    reading: Any = None,
    json: options.Json = False,
) -> None:
    """Read a surface, measure it, and print what was found.

    Parameters
    ----------
    source : Path
        IN.
    other : Path, optional
        AFTER.
    level : str, optional
        As in `Surface.volume`.
    within : Path, optional
        Polygons, as in `Surface.cut_and_fill`.
    by : str, optional
        As in `Surface.cut_and_fill_by_polygon`.
    reading : Reading
        How surfaces are read and trimmed.
    json : bool
        Print JSON.
    """
    standard_streams.check_stdout()
    if by is not None and within is None:
        raise typer.BadParameter("--by goes with --within")
    named = "name" if by is None else by
    if within is not None:
        within.open("rb").close()
    height = surfaces.parse_number("--level", level)
    if other is not None and height is not None:
        raise typer.BadParameter("--level goes with one surface, not with two")

    surface = reading.surface(source)
    rows_of = lidar.provenance(surface)
    if other is None:
        with terminal.stage(f"measuring {len(surface.faces):,} faces"):
            values = _values(surface.volume(height or 0.0, polygon=within))
            if within is None:
                values["surface_area"] = surface.area()
            else:
                parts = surface.volume_by_polygon(within, height or 0.0, by=named)
                values["polygons"] = _by_name({key: _values(part) for key, part in parts.items()})
    else:
        after = reading.surface(other)
        _check_grounds({source: surface, other: after})
        rows_of["after"] = lidar.provenance(after)
        with terminal.stage("laying the surfaces over each other"):
            values = _changes(surface.cut_and_fill(after, polygon=within))
            if within is not None:
                works = surface.cut_and_fill_by_polygon(after, within, by=named)
                values["polygons"] = _by_name({key: _changes(work) for key, work in works.items()})
    _print(values, rows_of, as_json=json)


def _check_grounds(surfaces_: dict[Path, Any]) -> None:
    """Raise if one surface is of ground, and the other one of all rows, as it has no ground."""
    from liftmesh.io.selection import found_selection  # noqa: PLC0415 - help and --version do without
    from liftmesh.io.surface_rows import check_grounds  # noqa: PLC0415 - as above

    check_grounds((str(path), found_selection(each.metadata)) for path, each in surfaces_.items())


def _values(found: Volume) -> dict[str, Any]:
    return {
        "level": found.level,
        "above": found.above,
        "below": found.below,
        "net": found.net,
        "planar_area": found.area,
        "cubic_metres_per_unit": found.cubic_metres,
    }


def _changes(found: Earthwork) -> dict[str, Any]:
    return {
        "cut": found.cut,
        "fill": found.fill,
        "net": found.net,
        "planar_area": found.area,
        "cubic_metres_per_unit": found.cubic_metres,
    }


def _by_name(parts: dict[str | int, dict[str, Any]]) -> list[dict[str, Any]]:
    """Name the polygons of measures, without what all share."""
    shared = {"level", "cubic_metres_per_unit"}
    return [
        {"polygon": name} | {key: value for key, value in part.items() if key not in shared}
        for name, part in parts.items()
    ]


def _print(values: dict[str, Any], rows_of: dict[str, Any], *, as_json: bool) -> None:
    """Print numbers, those of volumes with their unit."""
    if as_json:
        terminal.as_json(values | rows_of)
        return
    unit, polygons = values.pop("cubic_metres_per_unit"), values.pop("polygons", [])
    terminal.table(
        [(name.replace("_", " "), _shown(name, value, unit)) for name, value in values.items()]
    )
    if len(polygons) > 1:
        terminal.blank()
        terminal.table([(str(part.pop("polygon")), _line(part)) for part in polygons])


def _line(part: dict[str, Any]) -> str:
    """Print the measures of one polygon, in the units of the whole."""
    return "  ".join(f"{name.replace('_', ' ')} {value:.10g}" for name, value in part.items())


def _shown(name: str, value: float, unit: float | None) -> str:
    if name in _VOLUMES:
        return _volume(value, unit)
    is_doubtful = name == "surface_area" and unit is None
    return f"{value:.10g}" + ("  (z taken to be in the unit of x and y)" if is_doubtful else "")


def _volume(value: float, unit: float | None) -> str:
    """Print a volume in its own unit, and in cubic metres if that is another one."""
    if unit is None:
        return f"{value:.10g}  (the units of x, y and z are not all known)"
    return f"{value:.10g} m3" if unit == 1 else f"{value:.10g}  ({value * unit:.10g} m3)"
