"""``liftmesh profile``: heights of a surface along lines, and lines draped over it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.base.options import counted
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import option, positive
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.terrain.profile import Profile
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Write the heights of a mesh or cloud along lines."
HELP = (
    "OUT has a point at every corner of a line and at every side of a face that the line crosses, "
    "with its distance along the line; as GeoJSON or GeoPackage, the lines in space. Where a line "
    "leaves the faces, a part of it ends. With --spacing and --half-width, OUT has cross sections "
    "instead: the station of each along the line, and offsets from it, negative on its left."
)
EXAMPLES = [
    "liftmesh profile tin.ply profile.csv --along 0,0 --along 250,80",
    "liftmesh profile tin.ply heights.csv --along roads.geojson",
    "liftmesh profile survey.csv draped.gpkg --along roads.gpkg --max-edge 20",
    "liftmesh profile tin.ply sections.csv --along roads.geojson --spacing 20 --half-width 15",
]

_ROUNDING = 1e-9  # of the length

Corners: TypeAlias = Annotated[surfaces.Places, surfaces.places("along")]
Target: TypeAlias = Annotated[
    outputs.Target,
    outputs.target("CSV or any cloud file; GeoJSON or GeoPackage of lines.", has_writing=False),
]


@outputs.guards("target")
def run(
    source: surfaces.Source,
    target: Target,
    along: Annotated[
        list[str],
        option(
            "FILE|X,Y",
            "Lines (GeoJSON, GeoPackage), a table of the corners of one line, or one corner "
            "after the other.",
        ),
    ],
    spacing: Annotated[
        float | None, option("LENGTH", "Cross sections, one every so far.", positive)
    ] = None,
    half_width: Annotated[
        float | None, option("LENGTH", "Of --spacing: how far to both sides.", positive)
    ] = None,
    *,
    corners_table: Corners,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface and lines, drape them over it, write them, and say what was found."""
    from liftmesh.terrain.profile import sections_across

    corners = _corners(along)
    path = None if corners else Path(along[0])
    if (spacing is None) != (half_width is None):
        raise click.BadParameter("--spacing and --half-width go together")
    is_shapes = target.file_format is None and target.path.suffix.lower() in surfaces.SHAPES
    if is_shapes:
        _check_shapes(target.path)
    else:
        target.check()
    surface = surfaces.read(source, reading)
    max_bytes = reading.rows.get("max_bytes")
    lines: list[Any] = [corners]
    if path is not None:
        lines = _lines(path, corners_table, source, surface, max_bytes)
    cuts = None
    if spacing is not None and half_width is not None:
        with options.as_usage():
            cuts = sections_across(lines, spacing, half_width)
        lines = list(cuts.ends)
    with terminal.stage(f"draping {counted(len(lines), 'line')}"):
        draped = _draped(surface, lines, along)
    draped = draped if cuts is None else cuts.of(draped)
    if is_shapes:
        with terminal.stage(f"writing {target.path.name}"):
            written = draped.save(target.path).path
    else:
        name = target.write(draped.to_cloud()).path
        written = None if name is None else Path(name)
    with outputs.report_after(target.path):
        kind = "line" if cuts is None else "section"
        _say(written, draped, lines, surface, kind=kind, as_json=json)


def _corners(along: list[str]) -> list[list[float]] | None:
    """Parse the corners of one line; None if a file is given."""
    pairs = [_pair(word) for word in along]
    if len(along) == 1 and pairs[0] is None:
        return None
    if None in pairs:
        word = along[pairs.index(None)]
        raise click.BadParameter(f"--along {word!r} is not a corner x,y: give one file, or corners")
    if len(along) == 1:
        raise click.BadParameter(f"--along {along[0]!r} is one corner: give another --along X,Y")
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
    if target.suffix.lower() in (".gpkg", ".shp"):
        from liftmesh.optional import load

        load("geopandas", extra="shapes")
    outputs.check_place(target)


def _lines(
    path: Path, table: surfaces.Places, source: Path, surface: Surface, max_bytes: int | None
) -> list[Any]:
    """Read lines, or the corners of one as a table or a cloud, in the system of the surface."""
    from liftmesh.terrain.surface_data import plane_system
    from liftmesh.vector.files import lines_of

    crs = plane_system(surface)
    if table.are_shapes(path):
        return list(lines_of(path, crs))
    cloud = table.read(path, source, crs, max_bytes)
    if len(cloud) < 2:
        raise InputError(f"{path} holds {len(cloud)} of the two corners that a line has at least")
    return [cloud.points[:, :2]]


def _draped(surface: Surface, lines: list[Any], along: list[str]) -> Profile:
    from liftmesh.terrain.profile import drape

    try:
        return drape(surface, lines)
    except InputError as error:
        error.within(f"--along {' '.join(along)}")
        raise


def _length(lines: list[Any]) -> float:
    """Return how long lines are in the plane, where they lie on faces or not."""
    corners = ([each[:2] for each in line] for line in lines)
    return sum(math.fsum(map(math.dist, each, each[1:])) for each in corners)


def _say(
    path: Path | None,
    draped: Profile,
    given: list[Any],
    surface: Surface,
    *,
    kind: str,
    as_json: bool,
) -> None:
    """Print how long lines or cross sections are and which heights they have, with the units."""
    from liftmesh.terrain.surface_data import unit_names

    plane, upright = unit_names(surface)
    length, heights = float(draped.lengths.sum()), draped.points[:, 2]
    lines, whole = len(given), _length(given)
    if as_json:
        terminal.as_json(
            {
                "path": str(path or "-"),
                f"n_{kind}s": lines,
                "n_parts": len(draped.lines),
                "n_points": len(heights),
                "length": length,
                f"length_of_{kind}s": whole,
                "lowest": float(heights.min()),
                "highest": float(heights.max()),
                "unit": plane,
                "height_unit": upright,
                **notes.provenance(surface),
            }
        )
        return
    if whole - length > _ROUNDING * whole:
        terminal.note(
            f"{whole - length:.6g} of {whole:.6g} that the {kind}s are long lie on no face"
        )
    terminal.sentence(
        f"{path or 'stdout'}: {len(heights):,} points in {counted(len(draped.lines), 'part')} of "
        f"{counted(lines, kind)}, "
        f"{length:,.10g} {plane or '(unit unknown)'} long, heights from {heights.min():.10g} to "
        f"{heights.max():.10g} {upright or '(unit unknown)'}",
        "good",
    )
