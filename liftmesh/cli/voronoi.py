"""``liftmesh voronoi``: Voronoi or power cells of a cloud, or cells of disks, as polygons."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.cli import inputs, options, outputs, terminal
from liftmesh.cli.options import argument, is_stream, option
from liftmesh.cli.surfaces import is_table

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.cells.files import SavableCells

SHORT_HELP = "Write the Voronoi or power cells of a cloud, or cells of disks, as polygons."
HELP = (
    "Cells of x and y are clipped to a domain, exactly, and carry the values of their rows. "
    "OUT is GeoJSON, a GeoPackage (.gpkg), a mesh (.ply) or a picture (.svg)."
)
EXAMPLES = [
    "liftmesh voronoi schools.csv districts.geojson --domain city.geojson",
    "liftmesh voronoi wells.csv cells.gpkg --domain 0,0,1000,800",
    "liftmesh voronoi trees.csv crowns.gpkg --radii crown_radius",
    "liftmesh voronoi masts.csv coverage.gpkg --disks reach --max-deviation 5",
]


@outputs.guards("target")
def run(
    source: options.Source,
    target: Annotated[
        Path,
        argument("OUT", "Polygons: .geojson, .gpkg, .ply or .svg; - for stdout."),
    ],
    domain: Annotated[
        str | None,
        option(
            "DOMAIN",
            "A file of polygons, a box XMIN,YMIN,XMAX,YMAX, or 'bounds', as by default: that "
            "of the points, widened by a tenth of its longer side.",
        ),
    ] = None,
    weights: Annotated[
        str | None, option("COLUMN", "Values of IN that are weights: makes power cells.")
    ] = None,
    radii: options.Radii = None,
    disks: Annotated[
        str | None,
        option(
            "COLUMN",
            "Values of IN that are radii of disks: makes cells of what is nearest to their "
            "boundaries, with arcs as sides, unlike --radii, whose cells have straight sides.",
        ),
    ] = None,
    max_deviation: Annotated[
        float | None,
        option(
            "LENGTH",
            "How far the sides of cells of disks may be from the arcs; by default a "
            "thousandth of the side of a square as large as a cell.",
            float,
        ),
    ] = None,
    output_format: Annotated[
        str | None, option("FORMAT", "geojson, gpkg, ply or svg, for stdout.", panel="Output")
    ] = None,
    *,
    table: inputs.Table,
    file: inputs.File,
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, compute its cells, write them, and print a report."""
    kinds = {"weights": weights, "radii": radii, "disks": disks}
    choices = options.given(max_deviation=max_deviation, threads=threads)
    _check_one(kinds, choices)
    kind = _kind(target, output_format)
    outputs.check_place(target)
    planar = {"flat": None} if is_table(source, file.get("format")) else {}
    cloud = inputs.read(source, {**planar, **table, **file})
    choices["domain"] = _domain(domain)
    text = f"cells of {len(cloud):,} rows"
    with inputs.about(source), terminal.share_bar(text, len(cloud)) as progress:
        cells = _cells(cloud, kinds, {**choices, "progress": progress})
    _note_rows_elsewhere(cells)
    with outputs.opened(target) as stream:
        written = cells.save(stream, _columns(cloud), format=kind)
    for name, own in written.renamed:
        terminal.note(f"{name} is a column of the points: that of cells is {own}")
    lost = [part for part in ("colors", "normals") if getattr(cloud, part) is not None]
    dropped = [*written.dropped, *lost]
    with outputs.report_after(target):
        _report(target, kind, written.bytes, cells, dropped, as_json=json)


def _check_one(kinds: Mapping[str, str | None], choices: Mapping[str, Any]) -> None:
    is_of_disks = kinds["disks"] is not None
    if is_of_disks and (kinds["weights"] is not None or kinds["radii"] is not None):
        raise click.BadParameter("--disks makes other cells than --weights and --radii: give one")
    if is_of_disks and "threads" in choices:
        raise click.BadParameter("--disks makes cells on one thread: leave out --threads")
    if not is_of_disks and "max_deviation" in choices:
        raise click.BadParameter("--max-deviation needs --disks: give --disks COLUMN, too")


def _kind(target: Path, name: str | None) -> str:
    from liftmesh.cells.files import format_of

    if name is None and is_stream(target):
        raise click.BadParameter(
            "stdout has no suffix: give the format with --output-format geojson"
        )
    return format_of(target, name)


def _domain(text: str | None) -> Any:
    if text is None or text == "bounds":
        return None
    if (box := options.box(text)) is not None:
        return box
    path = Path(text).expanduser()
    if not path.exists():
        raise click.BadParameter(
            f"--domain {text!r} is no file: give a file of polygons, XMIN,YMIN,XMAX,YMAX or bounds"
        )
    from liftmesh.cells.files import read_domain

    return read_domain(path)


def _cells(cloud: Cloud, kinds: Mapping[str, str | None], choices: dict[str, Any]) -> SavableCells:
    import liftmesh
    from liftmesh.planar.kinds import named_values

    if (disks := kinds["disks"]) is not None:
        return liftmesh.apollonius_diagram(cloud, named_values(cloud, "disks", disks), **choices)
    if kinds["weights"] is None and kinds["radii"] is None:
        return liftmesh.voronoi(cloud, **choices)
    return liftmesh.power_diagram(cloud, weights=kinds["weights"], radii=kinds["radii"], **choices)


def _note_rows_elsewhere(cells: SavableCells) -> None:
    """Say so if no row is near the domain: most often it is in another coordinate system."""
    left, low, right, high = cells.domain.bounds
    x, y = cells.points.T
    if not ((x >= left) & (x <= right) & (y >= low) & (y <= high)).any():
        terminal.note("no row lies in the box of the domain: are both in one coordinate system?")


def _columns(cloud: Cloud) -> dict[str, Any]:
    """The values of rows: the named ones, and heights if there are any."""
    from liftmesh.cells.files import free_name

    heights = cloud.points[:, 2]
    named = {**cloud.attributes}
    return {free_name("z", named): heights, **named} if heights.any() else named


def _report(
    target: Path, kind: str, size: int, cells: SavableCells, dropped: list[str], *, as_json: bool
) -> None:
    counts = {
        "rows": len(cells),
        "cells": len(cells) - len(cells.empty),
        "duplicates": len(cells.duplicates),
        "hidden": len(cells.hidden),
        "empty": len(cells.empty),
    }
    if as_json:
        told = {"path": str(target), "format": kind, "bytes": size, "domain": cells.domain.text}
        if cells.max_deviation is not None:
            told["max_deviation"] = cells.max_deviation
        terminal.as_json({**told, **outputs.as_named(counts), "dropped": dropped})
        return
    bytes_text = terminal.bytes_text(size)
    line = f"{target}: {counts['cells']:,} cells in {cells.domain.text}, {bytes_text}"
    if cells.max_deviation is not None:
        line += f"; arcs are polylines within {cells.max_deviation:.3g}"
    if dropped:
        line += f"; {kind} does not keep {', '.join(dropped)}"
    terminal.sentence(line, "good")
    terminal.table(outputs.as_rows(counts))
