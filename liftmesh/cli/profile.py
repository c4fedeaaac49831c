"""``liftmesh profile``: heights of a surface along lines, and lines draped over it."""

from __future__ import annotations

import math
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import shown
from liftmesh.cli import (
    files,
    lidar,
    options,
    outputs,
    overwriting,
    second_tables,
    shapes,
    standard_streams,
    surfaces,
    terminal,
)
from liftmesh.cli.reading import with_options as with_reading
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.terrain.profile import Draped
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Write the heights of a mesh or cloud along lines."
HELP = (
    "OUT has a point at every corner of a line and at every side of a face that the line crosses, "
    "with its distance along the line; as GeoJSON or GeoPackage, the lines in space. Where a line "
    "leaves the faces, a part of it ends."
)
EXAMPLES = [
    "liftmesh profile tin.ply profile.csv --along 0,0 --along 250,80",
    "liftmesh profile tin.ply heights.csv --along roads.geojson",
    "liftmesh profile survey.csv draped.gpkg --along roads.gpkg --max-edge 20",
]


_ROUNDING = 1e-9  # of the length


@overwriting.guards("target")
@second_tables.with_options("along", "corners_table")
@with_reading
def run(
    source: surfaces.Source,
    target: Annotated[
        Path,
        typer.Argument(
            metavar="OUT", help="CSV or any cloud file; GeoJSON or GeoPackage of lines."
        ),
    ],
    along: Annotated[
        list[str],
        typer.Option(
            metavar="FILE|X,Y",
            help="Lines (GeoJSON, GeoPackage), a table of the corners of one line, or one corner "
            "after the other.",
        ),
    ],
    corners_table: Any = None,
    target_format: Annotated[
        str | None,
        typer.Option("--format", metavar="FORMAT", help="Format of OUT, instead of its suffix."),
    ] = None,
    reading: Any = None,
    json: options.Json = False,
) -> None:
    """Read a surface and lines, drape them over it, write them, and say what was found."""
    corners = _corners(along)
    path = None if corners else Path(along[0])
    if json:
        standard_streams.check_stdout()
    is_shapes = target_format is None and target.suffix.lower() in shapes.SHAPES
    if is_shapes:
        _check_shapes(target)
    else:
        files.check_target(target, target_format)
    surface = reading.surface(source)
    lines = [corners] if path is None else _lines(path, corners_table, source, surface, reading)
    with terminal.stage(f"draping {len(lines):,} line{'' if len(lines) == 1 else 's'}"):
        found = _draped(surface, lines, along)
    if is_shapes:
        with terminal.stage(f"writing {target.name}"):
            written: Path | None = found.save(target)
    else:
        name = outputs.write(target, found.as_cloud(), target_format).path
        written = None if name is None else Path(name)
    is_stdout = files.is_stream(target)
    place = redirect_stdout(sys.stderr) if is_stdout else standard_streams.dispensable_stdout()
    with place, standard_streams.after_writing(written):
        _say(written, found, lines, surface, as_json=json)


def _corners(along: list[str]) -> list[list[float]] | None:
    """Parse the corners of one line; None if a file is given."""
    pairs = [_pair(word) for word in along]
    if len(along) == 1 and pairs[0] is None:
        return None
    if None in pairs:
        word = along[pairs.index(None)]
        raise typer.BadParameter(f"--along {word!r} is not a corner x,y: give one file, or corners")
    if len(along) == 1:
        raise typer.BadParameter(f"--along {along[0]!r} is one corner: give another --along X,Y")
    return [pair for pair in pairs if pair is not None]


def _pair(word: str) -> list[float] | None:
    """Parse two finite numbers; None if they are something else."""
    try:
        pair = [float(each) for each in word.split(",")]
    except ValueError:
        return None
    return pair if len(pair) == 2 and all(map(math.isfinite, pair)) else None


def _check_shapes(target: Path) -> None:
    """Raise before the work starts if a file of lines cannot be written."""
    if target.suffix.lower() == ".gpkg":
        from liftmesh.optional import load  # noqa: PLC0415 - help and --version do without

        load("geopandas", extra="shapes")
    files.check_place(target)


def _lines(path: Path, table: Any, source: Path, surface: Surface, reading: Any) -> list[Any]:
    """Read lines, or the corners of one as a table or a cloud, in the system of the surface."""
    from liftmesh.terrain.surface_data import plane_system  # noqa: PLC0415 - help and --version do without
    from liftmesh.vector.lines import lines_of  # noqa: PLC0415 - help and --version do without

    if table.file_format is None and not shapes.is_cloud(path):
        return list(lines_of(path, plane_system(surface)))
    from liftmesh.crs.comparison import are_different  # noqa: PLC0415 - as above

    cloud = table.read(path, reading.max_bytes)
    crs = plane_system(surface)
    if are_different(crs, cloud.crs):
        raise InputError(
            f"{path} is in {shown(cloud.crs)}, {source} in {shown(crs)}: transform the points first"
        )
    if len(cloud) < 2:
        raise InputError(f"{path} holds {len(cloud)} of the two corners that a line has at least")
    return [cloud.points[:, :2]]


def _draped(surface: Surface, lines: list[Any], along: list[str]) -> Draped:
    from liftmesh.terrain.profile import drape  # noqa: PLC0415 - help and --version do without

    try:
        return drape(surface, lines)
    except InputError as error:
        error.args = (f"--along {' '.join(along)}: {error}",)
        raise


def _length(lines: list[Any]) -> float:
    """Return how long lines are in the plane, where they lie on faces or not."""
    corners = ([each[:2] for each in line] for line in lines)
    return sum(math.fsum(map(math.dist, each, each[1:])) for each in corners)


def _say(
    path: Path | None, found: Draped, given: list[Any], surface: Surface, *, as_json: bool
) -> None:
    """Print how long the lines are and which heights they have, with the units."""
    from liftmesh.terrain.units import unit_names  # noqa: PLC0415 - help and --version do without

    plane, upright = unit_names(surface)
    length, heights = float(found.lengths.sum()), found.points[:, 2]
    lines, whole = len(given), _length(given)
    if as_json:
        terminal.as_json(
            {
                "path": str(path or "-"),
                "lines": lines,
                "parts": len(found.lines),
                "points": len(heights),
                "length": length,
                "length_of_lines": whole,
                "lowest": float(heights.min()),
                "highest": float(heights.max()),
                "unit": plane,
                "height_unit": upright,
                **lidar.provenance(surface),
            }
        )
        return
    if whole - length > _ROUNDING * whole:
        terminal.note(f"{whole - length:.6g} of {whole:.6g} that the lines are long lie on no face")
    terminal.sentence(
        f"{path or 'stdout'}: {len(heights):,} points in {len(found.lines):,} part"
        f"{'' if len(found.lines) == 1 else 's'} of {lines:,} line{'' if lines == 1 else 's'}, "
        f"{length:,.10g} {plane or '(unit unknown)'} long, heights from {heights.min():.10g} to "
        f"{heights.max():.10g} {upright or '(unit unknown)'}",
        "good",
    )
