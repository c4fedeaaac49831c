"""``liftmesh volume``: areas of a surface, volumes at levels, or between two surfaces."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, number, numbers, option, positive

if TYPE_CHECKING:
    from liftmesh.terrain.measures import CutFillResult, VolumeResult
    from liftmesh.terrain.stages import StageStorage
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Measure volumes above and below a level or many, or between two surfaces."
HELP = (
    "Volumes are counted where there are faces only; their unit is that of x, y and z. With "
    "--within, those of all polygons together come first, then those of each: by the property or "
    "column --by, or by the number."
)
EXAMPLES = [
    "liftmesh volume before.ply after.ply --json",
    "liftmesh volume heap.ply --level 12.5",
    "liftmesh volume reservoir.ply --interval 0.5",
    "liftmesh volume before.ply after.ply --within lots.geojson --json",
    "liftmesh volume survey.csv --level 0 --max-edge 20 --boundary-only --json",
]

_UNKNOWN = "the units of x, y and z are not all known"
_MEASURES = ("level", "above", "below", "cut", "fill", "net")


def run(
    source: surfaces.Source,
    other: Annotated[
        Path | None,
        argument("[AFTER]", "What IN becomes: prints cut and fill."),
    ] = None,
    level: Annotated[float | None, option("HEIGHT", "The level, 0 by default.", number)] = None,
    within: Annotated[
        Path | None, option("FILE", "Measure inside of polygons alone, cut at their borders.")
    ] = None,
    levels: Annotated[Any, option("HEIGHTS", "A table of these levels, as 1,2.5.", numbers)] = None,
    interval: Annotated[
        float | None, option("HEIGHT", "A table of all multiples of this height.", positive)
    ] = None,
    volumes: Annotated[
        Any, option("VOLUMES", "A table of the levels that hold these volumes.", numbers)
    ] = None,
    above: Annotated[bool, flag("Of a table: what is above the levels, not below.")] = False,
    by: Annotated[
        str | None,
        options.option(
            "PROPERTY", "The property or column that names the polygons, 'name' by default."
        ),
    ] = None,
    *,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface, measure it, and print what was found."""
    outputs.check_stdout()
    if by is not None and within is None:
        raise click.BadParameter("--by goes with --within")
    named = "name" if by is None else by
    if within is not None:
        within.open("rb").close()
    if other is not None and level is not None:
        raise click.BadParameter("--level goes with one surface, not with two")

    tabled = options.given(levels=levels, interval=interval, volumes=volumes)
    _check_table(tabled, above, others=(level, within, other))
    surface = surfaces.read(source, reading)
    if tabled:
        with terminal.stage(f"measuring {len(surface.faces):,} faces"):
            found = _stages(surface, above, **tabled)
        _print_stages(found, surface, as_json=json)
        return
    rows_of = notes.provenance(surface)
    if other is None:
        with terminal.stage(f"measuring {len(surface.faces):,} faces"):
            measures = _values(surface.volume(level or 0.0, within=within))
            if within is None:
                measures["surface_area"] = surface.area()
            else:
                parts = surface.volume_by_polygon(within, level or 0.0, by=named)
                measures["polygons"] = _by_name({key: _values(part) for key, part in parts.items()})
    else:
        after = surfaces.read(other, reading)
        surfaces.check_grounds({source: surface, other: after})
        rows_of["after"] = notes.provenance(after)
        with terminal.stage("laying the surfaces over each other"):
            measures = _values(surface.cut_and_fill(after, within=within))
            if within is not None:
                works = surface.cut_and_fill_by_polygon(after, within, by=named)
                measures["polygons"] = _by_name({key: _values(work) for key, work in works.items()})
    _print(measures, rows_of, as_json=json)


def _check_table(tabled: dict[str, Any], above: bool, others: tuple[Any, ...]) -> None:
    """Raise for options that do not go together."""
    if len(tabled) > 1:
        raise click.BadParameter("give one of --levels, --interval and --volumes")
    if tabled and any(each is not None for each in others):
        (name,) = tabled
        raise click.BadParameter(f"--{name} goes with one surface, without --level and --within")
    if above and not tabled:
        raise click.BadParameter("--above goes with --levels, --interval or --volumes")


def _stages(surface: Surface, above: bool, volumes: Any = None, **wanted: Any) -> StageStorage:
    """Measure at levels, or at those that hold volumes."""
    if volumes is None:
        return surface.stage_storage(**wanted, above=above)
    return surface.stage_storage(
        surface.stage_storage(0.0, above=above).level_of(volumes), above=above
    )


def _print_stages(found: StageStorage, surface: Surface, *, as_json: bool) -> None:
    """Print levels, areas and volumes, as a table."""
    columns = found.levels.tolist(), found.areas.tolist(), found.volumes.tolist()
    name = "above" if found.above else "below"
    names = "level", "planar_area", name
    rows = zip(*columns, strict=True)
    if as_json:
        told = {"cubic_metres_per_unit": found.cubic_metres, **notes.provenance(surface)}
        terminal.as_json({"stages": [dict(zip(names, row, strict=True)) for row in rows], **told})
        return
    header = "level", f"planar area {name}", f"volume {name}"
    terminal.table([tuple(f"{each:.10g}" for each in row) for row in rows], header=header)
    if found.cubic_metres != 1:
        unit = found.cubic_metres
        terminal.note(f"a unit of volume is {unit:.10g} m3" if unit else _UNKNOWN)


def _values(measures: VolumeResult | CutFillResult) -> dict[str, Any]:
    """Return what was measured, by the names that are printed."""
    measured = {name: getattr(measures, name) for name in _MEASURES if hasattr(measures, name)}
    return measured | {
        "planar_area": measures.area,
        "cubic_metres_per_unit": measures.cubic_metres,
    }


def _by_name(parts: dict[str | int, dict[str, Any]]) -> list[dict[str, Any]]:
    """Name the polygons of measures, without what all share."""
    shared = {"level", "cubic_metres_per_unit"}
    return [
        {"polygon": name} | {key: value for key, value in part.items() if key not in shared}
        for name, part in parts.items()
    ]


def _print(measures: dict[str, Any], rows_of: dict[str, Any], *, as_json: bool) -> None:
    """Print numbers, those of volumes with their unit."""
    if as_json:
        terminal.as_json(measures | rows_of)
        return
    unit, polygons = measures.pop("cubic_metres_per_unit"), measures.pop("polygons", [])
    terminal.table(
        [(name.replace("_", " "), _shown(name, value, unit)) for name, value in measures.items()]
    )
    if len(polygons) > 1:
        terminal.blank()
        terminal.table([(str(part.pop("polygon")), _line(part)) for part in polygons])


def _line(part: dict[str, Any]) -> str:
    """Print the measures of one polygon, in the units of the whole."""
    return "  ".join(f"{name.replace('_', ' ')} {value:.10g}" for name, value in part.items())


def _shown(name: str, value: float, unit: float | None) -> str:
    if name in _MEASURES[1:]:
        return _volume(value, unit)
    is_doubtful = name == "surface_area" and unit is None
    return f"{value:.10g}" + ("  (z taken to be in the unit of x and y)" if is_doubtful else "")


def _volume(value: float, unit: float | None) -> str:
    """Print a volume in its own unit, and in cubic metres if that is another one."""
    if unit is None:
        return f"{value:.10g}  ({_UNKNOWN})"
    return f"{value:.10g} m3" if unit == 1 else f"{value:.10g}  ({value * unit:.10g} m3)"
