"""``liftmesh tileset``: simplified tiles for viewers, as 3D Tiles or quantized-mesh."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import click

from liftmesh.base.options import Extrapolation, counted
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, numbers, option, positive, whole
from liftmesh.errors import InputError

SHORT_HELP = "Write a mesh or cloud as a pyramid of simplified tiles (3D Tiles)."
HELP = (
    "OUT has a GLB file for each tile, level/column/row.glb, and tileset.json with the error of "
    "each. Borders agree bit for bit between tiles and levels. IN may also be a folder of liftmesh "
    "tile --surface, which is read part by part. With --quantized-mesh, OUT has layer.json and "
    "level/column/row.terrain, tiles of the globe, for Cesium's terrain."
)
EXAMPLES = [
    "liftmesh tileset dem.tif viewer/ --max-error 0.5",
    "liftmesh tileset survey.laz viewer/ --max-error 0.2 --levels 5 --extrapolate hull",
    "liftmesh tileset dem.tif terrain/ --quantized-mesh --max-error 1",
    "liftmesh tileset tiles/ viewer/ --max-error 1 --extent 4500,8000,5500,9000 --skirts 10",
    "liftmesh tileset tiles/ terrain/ --quantized-mesh --max-error 1",
]


@outputs.guards("out", inside=("tileset.json", "layer.json"), prints=True)
def run(
    source: surfaces.Source,
    out: Annotated[Path, argument("OUT", "Folder to write to.")],
    max_error: Annotated[
        float,
        option("HEIGHT", "How far vertices are from tiles of the finest level at most.", positive),
    ],
    levels: Annotated[
        int | None,
        option("N", "Levels, up to 6, each of four times the tiles; default: 4.", whole(1)),
    ] = None,
    extent: Annotated[
        Any,
        option("XMIN,YMIN,XMAX,YMAX", "What the tiles cover; by default all faces.", numbers),
    ] = None,
    extrapolate: Annotated[
        Extrapolation | None, flag("What the heights are beyond the faces: by default an error.")
    ] = None,
    skirts: Annotated[
        float | None, option("HEIGHT", "Walls that hang from the border of each tile.", positive)
    ] = None,
    zoom: Annotated[
        int | None,
        option("N", "Of --quantized-mesh: the finest level; by default by --max-error.", whole(0)),
    ] = None,
    *,
    quantized_mesh: Annotated[bool, flag("Tiles of the globe, for terrain of Cesium.")] = False,
    reading: surfaces.Horizontal,
    json: options.Json = False,
) -> None:
    """Read a surface, write its tiles, and say how far each level is from it."""
    from liftmesh.raster.pixels import bounds_of
    from liftmesh.tiles.globe import write_quantized_mesh
    from liftmesh.tiles.tileset import write_tileset

    with options.as_usage(), _own_names():
        extent = None if extent is None else bounds_of(extent)
    of_plane = options.given(bounds=extent, levels=levels, extrapolate=extrapolate, skirts=skirts)
    of_globe = options.given(zoom=zoom)
    _check_kind(of_plane, of_globe, is_globe=quantized_mesh)
    surface = surfaces.read_or_open(source, reading)
    write, wanted = (
        (write_quantized_mesh, of_globe) if quantized_mesh else (write_tileset, of_plane)
    )
    with terminal.share_bar(f"writing tiles into {out}") as progress, _own_names():
        found: Any = write(surface, out, max_error=max_error, **wanted, progress=progress)
    _say(found, {} if source.is_dir() else notes.provenance(surface), as_json=json)


def _check_kind(of_plane: dict[str, Any], of_globe: dict[str, Any], *, is_globe: bool) -> None:
    """Raise for options that the wanted kind of tiles does not have."""
    wrong = of_plane if is_globe else of_globe
    for name in wrong:
        given = "--extent" if name == "bounds" else f"--{name}"
        without = "without" if is_globe else "with"
        raise click.BadParameter(f"{given} is {without} --quantized-mesh only: leave one out")


def _say(found: Any, rows_of: dict[str, Any], *, as_json: bool) -> None:
    """Say how many triangles each level has, and its error."""
    counts = getattr(found, "n_tiles", None) or [4**level for level in range(len(found.errors))]
    if as_json:
        told = {"path": str(found.path), "errors": found.errors, "n_tiles": counts}
        told |= {"n_triangles": found.n_triangles}
        told |= {"origin": found.origin} if hasattr(found, "origin") else {}
        terminal.as_json({**told, **rows_of})
        return
    levels = zip(counts, found.n_triangles, found.errors, strict=True)
    rows = [
        (f"level {level}", f"{counted(tiles, 'tile')}, {triangles:,} triangles, error {error:.4g}")
        for level, (tiles, triangles, error) in enumerate(levels)
    ]
    terminal.table([*rows, ("written", str(found.path))])


@contextmanager
def _own_names() -> Iterator[None]:
    """Let errors about bounds name the option of this command."""
    try:
        yield
    except InputError as error:
        error.args = (error.message.renamed({"bounds": "--extent"}),)  # --bounds selects rows
        raise
