"""``liftmesh raster``: heights, slopes, aspects or shades as a GeoTIFF."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import RasterQuantity, SampleMethod, shown
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
from liftmesh.cli.trimming import trimmed
from liftmesh.cli.values import checked
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.tiles.tiled_surface import TiledSurface

_ANGLES = ("slope", "hillshade")

SHORT_HELP = "Write a mesh or cloud as a raster of heights (GeoTIFF)."
HELP = (
    "A pixel has the height of the surface at its centre, by default linear in each face, and no "
    "value where no face contains the centre. The edges of pixels are multiples of the resolution. "
    "IN may also be a folder of liftmesh tile --surface."
)
EXAMPLES = [
    "liftmesh raster tin.ply dtm.tif --resolution 0.5 --crs EPSG:7415",
    "liftmesh raster tiles/ dtm.tif --resolution 0.5",
    "liftmesh raster survey.csv shade.tif --resolution 2 --quantity hillshade --max-edge 20",
]


@overwriting.guards("target")
@with_reading
def run(
    source: surfaces.Source,
    target: Annotated[Path, typer.Argument(metavar="OUT", help="GeoTIFF file.")],
    resolution: Annotated[
        str, typer.Option(metavar="SIZE", help="Width and height of a pixel, or X,Y.")
    ],
    bounds: Annotated[
        str | None,
        typer.Option(metavar="X0,Y0,X1,Y1", help="What to cover, by default the surface."),
    ] = None,
    quantity: Annotated[
        RasterQuantity, typer.Option(help="What a pixel holds; slope and aspect in degrees.")
    ] = "height",
    method: Annotated[SampleMethod, typer.Option(help="How heights are interpolated.")] = "linear",
    z_factor: Annotated[
        str | None,
        typer.Option(
            "--z-factor",
            metavar="FACTOR",
            help="Multiply heights by this before slopes and shades are computed; by default they "
            "get the unit of x and y, if the coordinate system says all three.",
        ),
    ] = None,
    double: Annotated[bool, typer.Option("--double", help="Write float64, not float32.")] = False,
    cog: Annotated[bool, typer.Option("--cog", help="Write a cloud optimised GeoTIFF.")] = False,
    compress: Annotated[
        str, typer.Option(metavar="METHOD", help="deflate, lzw, zstd or none.")
    ] = "deflate",
    crs: Annotated[
        str | None,
        typer.Option(metavar="CRS", help="Coordinate system, as EPSG:25832; IN states no other."),
    ] = None,
    reading: Any = None,
    json: options.Json = False,
) -> None:
    """Read a surface, compute a raster, write it, and say what it holds."""
    from liftmesh.raster.raster import check_name  # noqa: PLC0415 - help and --version do without

    standard_streams.check_stdout()
    check_name(target)
    steps = _numbers("--resolution", resolution)
    factor = surfaces.parse_number("--z-factor", z_factor, positive=True)
    covered = None if bounds is None else _numbers("--bounds", bounds)
    packing = None if compress == "none" else compress
    _check(steps, covered, quantity, method, crs, packing)
    files.check_place(target)
    if source.is_dir():
        tiled = opened(source, reading, crs=crs)
        if quantity in _ANGLES:
            surfaces.note_units(source, tiled, factor)
        values: dict[str, Any] = {"quantity": quantity, "z_factor": factor, "bounds": covered}
        values |= {"method": method, "cog": cog}
        values |= {"dtype": "float64" if double else "float32", "compress": packing}
        values |= {"threads": reading.threads}
        _write(tiled, target, steps if len(steps) > 1 else steps[0], values, as_json=json)
        return
    surface = reading.untrimmed(source)
    surface = surface if crs is None else surface.replace(crs=_system(source, surface.crs, crs))
    surface = trimmed(surface, reading.trimming)
    if quantity in _ANGLES:
        surfaces.note_units(source, surface, factor)
    with terminal.stage("scanning faces"):
        found = surface.raster(
            steps if len(steps) > 1 else steps[0],
            bounds=covered,
            quantity=quantity,
            method=method,
            z_factor=factor,
            dtype="float64" if double else "float32",
            threads=reading.threads,
        )
    with terminal.stage(f"writing {target.name}"):
        path = found.save(target, cog=cog, compress=packing)
    _say(path, found, lidar.provenance(surface), as_json=json)


def _check(
    steps: list[float],
    bounds: list[float] | None,
    quantity: RasterQuantity,
    method: SampleMethod,
    crs: str | None,
    compress: str | None,
) -> None:
    """Raise before the work starts if the options make no raster."""
    from liftmesh.raster import writer  # noqa: PLC0415 - as above
    from liftmesh.raster.pixels import bounds_of, steps_of  # noqa: PLC0415 - as above
    from liftmesh.terrain.raster import check_method  # noqa: PLC0415 - as above

    with checked():
        steps_of(steps if len(steps) > 1 else steps[0])
        if bounds is not None:
            bounds_of(bounds)
        check_method(quantity, method)
        writer.checked(crs, compress)


def _write(
    tiled: TiledSurface, target: Path, steps: Any, values: dict[str, Any], *, as_json: bool
) -> None:
    """Write the raster of a folder window by window, and say how large it is."""
    with terminal.bar(1.0) as advance:
        shown = [0.0]

        def progress(share: float) -> None:
            advance(f"writing {target.name}", share - shown[0])
            shown[0] = share

        path = tiled.save_raster(target, steps, progress=progress, **values)
    from liftmesh.optional import load  # noqa: PLC0415 - as above

    with load("rasterio", extra="terrain").open(path) as file:
        rows_, columns, transform = file.height, file.width, list(file.transform)[:6]
    if as_json:
        place = {"transform": transform, "crs": tiled.crs}
        counts = {"rows": rows_, "columns": columns}
        told = {"path": str(path), "quantity": values["quantity"], **counts, **place}
        terminal.as_json(told)
        return
    terminal.sentence(f"{path}: {columns:,} x {rows_:,} pixels of {values['quantity']}", "good")


def _system(source: Path, stated: str | None, given: str) -> str:
    """Return the system of an option; raise if the file states another."""
    from liftmesh.crs.comparison import are_different  # noqa: PLC0415 - as above

    if are_different(stated, given):
        raise InputError(f"{source} is in {shown(stated)}, not in --crs {given}: leave --crs out")
    return given


def _numbers(option: str, text: str) -> list[float]:
    """Parse finite numbers separated by commas."""
    found = [surfaces.parse_number(option, word) for word in text.split(",")]
    return [number for number in found if number is not None]


def _say(path: Path, found: Any, rows_of: dict[str, Any], *, as_json: bool) -> None:
    import numpy as np  # noqa: PLC0415 - help and --version do without

    rows_, columns = found.values.shape
    known = int(np.count_nonzero(~np.isnan(found.values)))
    if as_json:
        place = {"transform": list(found.transform), "crs": found.crs}
        counts = {"rows": rows_, "columns": columns, "known": known, "unit": found.unit, **rows_of}
        terminal.as_json({"path": str(path), "quantity": found.quantity, **counts, **place})
        return
    terminal.sentence(
        f"{path}: {columns:,} x {rows_:,} pixels of {found.quantity}, {known:,} with a value",
        "good",
    )
