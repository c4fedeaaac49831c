"""``liftmesh voronoi``: Voronoi or power cells of a cloud, or cells of disks, as polygons."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, BinaryIO, cast

import click

from liftmesh.cli import inputs, options, outputs, terminal
from liftmesh.cli.options import argument, is_stream, option
from liftmesh.cli.surfaces import is_table

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.cells.clipped import ClippedCells

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
    json: options.Json = False,
) -> None:
    """Read a cloud, compute its cells, write them, and print a report."""
    if json:
        outputs.check_stdout()
    _check_one(weights, radii, disks, max_deviation)
    kind = _kind(target, output_format)
    outputs.check_place(target)
    planar = {"flat": None} if is_table(source, file.get("format")) else {}
    cloud = inputs.read(source, {**planar, **table, **file})
    area, crs = _domain(domain, cloud)
    with inputs.about(source), terminal.stage(f"cells of {len(cloud):,} rows"):
        cells = _cells(cloud, area, weights, radii, disks, max_deviation)
    _note_rows_elsewhere(cells)
    size, dropped = _write(target, cells, kind, cloud, crs)
    with outputs.report_after(target):
        _report(target, kind, size, cells, dropped, as_json=json)


def _check_one(
    weights: str | None, radii: str | None, disks: str | None, max_deviation: float | None
) -> None:
    if disks is not None and (weights is not None or radii is not None):
        raise click.BadParameter("--disks makes other cells than --weights and --radii: give one")
    if disks is None and max_deviation is not None:
        raise click.BadParameter("--max-deviation needs --disks: give --disks COLUMN, too")


def _kind(target: Path, name: str | None) -> str:
    from liftmesh.cells.files import check_format, format_of

    if name is not None:
        return check_format(name)
    if is_stream(target):
        raise click.BadParameter(
            "stdout has no suffix: give the format with --output-format geojson"
        )
    return format_of(target)


def _domain(text: str | None, cloud: Cloud) -> tuple[Any, str | None]:
    """The domain, and the coordinate system of the cells."""
    if text is None or text == "bounds":
        return None, cloud.crs
    if (box := options.box(text)) is not None:
        return box, cloud.crs
    path = Path(text).expanduser()
    if not path.exists():
        raise click.BadParameter(
            f"--domain {text!r} is no file, and no box: a box is XMIN,YMIN,XMAX,YMAX"
        )
    from liftmesh.cells.files import read_domain
    from liftmesh.crs.comparison import common_system

    shape, crs = read_domain(path)
    return shape, common_system(cloud.crs, crs)


def _cells(
    cloud: Cloud,
    area: Any,
    weights: str | None,
    radii: str | None,
    disks: str | None,
    max_deviation: float | None,
) -> ClippedCells:
    import liftmesh
    from liftmesh.planar.kinds import named_values, weights_or_radii

    planar = cloud.points[:, :2]
    if disks is not None:
        reach = named_values(cloud, "disks", disks)
        return liftmesh.apollonius_diagram(planar, reach, domain=area, max_deviation=max_deviation)
    if weights is None and radii is None:
        return liftmesh.voronoi(planar, domain=area)
    kind, name = weights_or_radii(weights, radii)
    return liftmesh.power_diagram(planar, **{kind: named_values(cloud, kind, name)}, domain=area)


def _note_rows_elsewhere(cells: ClippedCells) -> None:
    """Say so if no row is near the domain: most often it is in another coordinate system."""
    low, high = cells.domain.corners.min(axis=0), cells.domain.corners.max(axis=0)
    if not ((cells.points >= low) & (cells.points <= high)).all(axis=1).any():
        terminal.note("no row lies in the box of the domain: are both in one coordinate system?")


def _columns(cloud: Cloud) -> dict[str, Any]:
    """The values of rows: the named ones, and heights if there are any."""
    from liftmesh.cells.clipped import free_name

    heights = cloud.points[:, 2]
    named = {**cloud.attributes}
    return {free_name("z", named): heights, **named} if heights.any() else named


def _write(
    target: Path, cells: ClippedCells, kind: str, cloud: Cloud, crs: str | None
) -> tuple[int, list[str]]:
    """Write the cells; return the number of bytes, and what the file does not keep."""
    from liftmesh.cells.files import own_names, write_cells

    columns = _columns(cloud)
    with outputs.opened(target) as stream:
        counted = _Counting(stream)
        dropped = write_cells(cast("BinaryIO", counted), cells, kind, columns, crs)
    if kind != "svg":
        for name, own in zip(("row", "area"), own_names(columns), strict=True):
            if name != own:
                terminal.note(f"{name} is a column of the points: that of cells is {own}")
    lost = [part for part in ("colors", "normals") if getattr(cloud, part) is not None]
    return counted.count, [*dropped, *lost]


class _Counting:
    """A stream that counts the bytes written to it."""

    def __init__(self, stream: Any) -> None:
        self._stream, self.count = stream, 0

    def write(self, data: Any) -> None:
        self.count += len(data)
        self._stream.write(data)


def _report(
    target: Path, kind: str, size: int, cells: ClippedCells, dropped: list[str], *, as_json: bool
) -> None:
    counts = {
        "rows": len(cells.points),
        "cells": len(cells.points) - len(cells.empty),
        "duplicates": len(cells.duplicates),
        "hidden": len(cells.hidden),
        "empty": len(cells.empty),
    }
    if as_json:
        told = {"path": str(target), "format": kind, "bytes": size, "domain": cells.domain.text}
        if cells.max_deviation is not None:
            told["max_deviation"] = cells.max_deviation
        terminal.as_json({**told, **counts, "dropped": dropped})
        return
    bytes_text = terminal.bytes_text(size)
    line = f"{target}: {counts['cells']:,} cells in {cells.domain.text}, {bytes_text}"
    if cells.max_deviation is not None:
        line += f"; arcs are polylines within {cells.max_deviation:.3g}"
    if dropped:
        line += f"; {kind} does not keep {', '.join(dropped)}"
    terminal.sentence(line, "good")
    terminal.table([(name, f"{count:,}") for name, count in counts.items()])
