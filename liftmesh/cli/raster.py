"""``liftmesh raster``: heights, slopes, aspects or shades as a GeoTIFF."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

import click

from liftmesh.base.options import Interpolation, RasterQuantity, Voids, shown
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, numbers, option, positive, whole
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.io.write import WriteResult
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled import TiledSurface

Compression: TypeAlias = Literal["deflate", "lzw", "zstd", "none"]
_COMPARE_UNITS = ("slope", "hillshade")  # heights with lengths, so units are noted

SHORT_HELP = "Write a mesh or cloud as a raster of heights (GeoTIFF)."
HELP = (
    "A pixel has the height of the surface at its center, by default linear in each face, and no "
    "value where no face contains the center. The edges of pixels are multiples of the resolution. "
    "IN may also be a folder of liftmesh tile --surface."
)
EXAMPLES = [
    "liftmesh raster tin.ply dtm.tif --resolution 0.5 --crs EPSG:7415",
    "liftmesh raster tiles/ dtm.tif --resolution 0.5",
    "liftmesh raster after.laz change.tif --resolution 0.5 --minus before.laz",
    "liftmesh raster scan.laz intensity.tif --resolution 1 --values intensity",
    "liftmesh raster dem.tif landscape.png --size 1009",
    "liftmesh raster survey.csv shade.tif --resolution 2 --quantity hillshade --max-edge 20",
]


@outputs.guards("target", prints=True)
def run(
    source: surfaces.Source,
    target: Annotated[Path, argument("OUT", "GeoTIFF file, or .png or .r16: a heightmap.")],
    resolution: Annotated[
        Any, option("SIZE", "Width and height of a pixel, or X,Y.", numbers)
    ] = None,
    size: Annotated[
        int | None,
        option(
            "N",
            "In place of --resolution: N rows and columns over the largest square in the middle, "
            "or over --raster-bounds, as heightmaps of engines have.",
            whole(1),
        ),
    ] = None,
    voids: Annotated[
        Voids, flag("Of heightmaps: pixels without a value are an error, or get the lowest height.")
    ] = "error",
    raster_bounds: Annotated[
        Any, option("XMIN,YMIN,XMAX,YMAX", "What to cover, by default the surface.", numbers)
    ] = None,
    quantity: Annotated[
        RasterQuantity, flag("What a pixel holds; slope and aspect in degrees.")
    ] = "height",
    interpolation: Annotated[Interpolation, flag("How heights are interpolated.")] = "linear",
    fill: Annotated[
        float | None,
        option(
            "DISTANCE",
            "Fill pixels without a value from the nearest pixel with one, not farther than this.",
            positive,
        ),
    ] = None,
    values: surfaces.Values = None,
    minus: Annotated[
        Path | None,
        option("FILE", "Subtract the heights of this surface, or folder of tiles: cut and fill."),
    ] = None,
    z_factor: Annotated[
        float | None,
        option(
            "FACTOR",
            "Multiply heights by this before slopes and shades are computed; by default they "
            "get the unit of x and y, if the coordinate system says all three.",
            positive,
        ),
    ] = None,
    double: Annotated[bool, flag("Write float64, not float32.")] = False,
    cog: Annotated[bool, flag("Write a cloud optimised GeoTIFF.")] = False,
    compress: Annotated[Compression, flag("Compression of the file.")] = "deflate",
    crs: Annotated[
        str | None, option("CRS", "Coordinate system, as EPSG:25832; IN states no other.")
    ] = None,
    *,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface, compute a raster, write it, and say what it holds."""
    import numpy as np

    from liftmesh.optional import load
    from liftmesh.raster.raster import check_name

    check_name(target, may_be_heightmap=not source.is_dir())
    if (resolution is None) == (size is None):
        raise click.BadParameter("give either --resolution or --size")
    if size is not None and source.is_dir():
        raise click.BadParameter("--size: rasters of tiles have a --resolution")
    steps = None if resolution is None else resolution if len(resolution) > 1 else resolution[0]
    packing = None if compress == "none" else compress
    crs = _checked(steps, raster_bounds, quantity, interpolation, crs, packing)
    outputs.check_place(target)
    wanted = {
        "bounds": raster_bounds,
        "quantity": quantity,
        "interpolation": interpolation,
        "fill": fill,
        "z_factor": z_factor,
        "minus": None if minus is None else _subtracted(minus, reading),
    }
    wanted |= {"dtype": "float64" if double else "float32", "threads": reading.threads}
    if source.is_dir():
        tiled = surfaces.open_tiles(source, reading, crs=crs, values=values)
        if quantity in _COMPARE_UNITS:
            surfaces.note_units(source, tiled, z_factor)
        with terminal.share_bar(f"writing {target.name}") as progress:
            tiled.save_raster(target, steps, cog=cog, compress=packing, progress=progress, **wanted)
        with load("rasterio", extra="terrain").open(target) as file:
            said = quantity if minus is None else "difference"
            _say(target, said, file.shape, (file.transform, tiled.crs), {}, as_json=json)
        return
    surface = surfaces.read_whole(source, reading)
    surface = surface if crs is None else surface.replace(crs=_system(source, surface.crs, crs))
    surface = surfaces.trimmed(surface, reading.trimming)
    if quantity in _COMPARE_UNITS:
        surfaces.note_units(source, surface, z_factor)
    if size is not None:
        wanted |= _pixels(surface, size, wanted.pop("bounds"))
    with terminal.stage("scanning faces"):
        raster = surface.raster(steps, values=values, **wanted)
    with terminal.stage(f"writing {target.name}"):
        written = raster.save(target, cog=cog, compress=packing, voids=voids)
    _note_size(written, raster.values.shape)
    known = int(np.count_nonzero(~np.isnan(raster.values)))
    counts = {"n_known": known, "unit": raster.unit, **notes.provenance(surface)}
    if written.scaling is not None:
        counts |= dict(zip(("scale", "offset"), written.scaling, strict=True))
    place = raster.transform, raster.crs
    _say(target, raster.quantity, raster.values.shape, place, counts, as_json=json)


def _subtracted(path: Path, reading: surfaces.SurfaceOptions) -> Surface | TiledSurface:
    """Read a surface, or open its tiles."""
    if path.is_dir():
        return surfaces.open_tiles(path, surfaces.SurfaceOptions({}, "xy", "error", None, {}))
    path.open("rb").close()
    return surfaces.read(path, reading)


def _checked(
    steps: float | list[float] | None,
    bounds: list[float] | None,
    quantity: RasterQuantity,
    interpolation: Interpolation,
    crs: str | None,
    compress: str | None,
) -> str | None:
    """Return the coordinate system; raise before the work starts if the options make no raster."""
    from liftmesh.crs.comparison import as_system
    from liftmesh.raster import writer
    from liftmesh.raster.pixels import bounds_of, steps_of
    from liftmesh.terrain.rasters import check_interpolation

    with options.as_usage():
        if steps is not None:
            steps_of(steps)
        if bounds is not None:
            bounds_of(bounds, "raster_bounds")
        check_interpolation(quantity, interpolation)
        crs = None if crs is None else as_system("crs", crs)
        writer.validate_geotiff_options(crs, compress)
    return crs


def _pixels(surface: Surface, size: int, bounds: list[float] | None) -> dict[str, Any]:
    """Return where so many rows and columns are."""
    from liftmesh.raster.heightmap import square, stretched
    from liftmesh.terrain.surface_data import bounds_of_faces

    found = square(bounds_of_faces(surface), size) if bounds is None else stretched(bounds, size)
    return {"transform": found, "shape": (size, size)}


def _note_size(written: WriteResult, shape: tuple[int, ...]) -> None:
    """Say which sizes engines take if a heightmap has another one."""
    from liftmesh.raster.heightmap import SIZES, suits_engines

    if written.scaling is not None and not (shape[0] == shape[1] and suits_engines(shape[0])):
        terminal.note(f"{written.path}: {SIZES}: give --size")


def _system(source: Path, stated: str | None, given: str) -> str:
    """Return the system of an option; raise if the file states another."""
    from liftmesh.crs.comparison import are_different

    if are_different(stated, given):
        raise InputError(f"{source} is in {shown(stated)}, not in --crs {given}: leave --crs out")
    return given


def _say(
    path: Path,
    quantity: str,
    shape: tuple[int, int],
    place: tuple[Any, str | None],
    counts: dict[str, Any],
    *,
    as_json: bool,
) -> None:
    """Say how large a raster is, and how many pixels have a value, if they were counted."""
    (rows, columns), (transform, crs) = shape, place
    if as_json:
        size = {"n_rows": rows, "n_columns": columns}
        there = {"transform": list(transform)[:6], "crs": crs}
        terminal.as_json({"path": str(path), "quantity": quantity, **size, **counts, **there})
        return
    known = f", {counts['n_known']:,} with a value" if counts else ""
    if "scale" in counts:
        width, height = abs(transform[0]), abs(transform[4])
        known += f", {width:.6g} x {height:.6g} each"
        known += f": {quantity} = {counts['scale']:.9g} * value + {counts['offset']:.9g}"
    terminal.sentence(f"{path}: {columns:,} x {rows:,} pixels of {quantity}{known}", "good")
