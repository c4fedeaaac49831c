"""``liftmesh tileset``: a pyramid of simplified tiles for viewers of 3D Tiles."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

from liftmesh.base.options import Extrapolation
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import argument, flag, numbers, option, positive, whole
from liftmesh.errors import InputError

SHORT_HELP = "Write a mesh or cloud as a pyramid of simplified tiles (3D Tiles)."
HELP = (
    "OUT has a GLB file for each tile, level/column/row.glb, and tileset.json with the error of "
    "each. Borders agree bit for bit between tiles and levels. IN may also be a folder of liftmesh "
    "tile --surface, which is read part by part."
)
EXAMPLES = [
    "liftmesh tileset dem.tif viewer/ --max-error 0.5",
    "liftmesh tileset survey.laz viewer/ --max-error 0.2 --levels 5 --extrapolate hull",
    "liftmesh tileset tiles/ viewer/ --max-error 1 --extent 4500,8000,5500,9000 --skirts 10",
]


@outputs.guards("out", inside="tileset.json")
def run(
    source: surfaces.Source,
    out: Annotated[Path, argument("OUT", "Folder to write to.")],
    max_error: Annotated[
        float,
        option("HEIGHT", "How far vertices are from tiles of the finest level at most.", positive),
    ],
    levels: Annotated[
        int, option("N", "Levels, up to 6; each has four times the tiles.", whole(1))
    ] = 4,
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
    *,
    reading: surfaces.Horizontal,
    json: options.Json = False,
) -> None:
    """Read a surface, write its tiles, and say how far each level is from it."""
    from liftmesh.raster.pixels import bounds_of
    from liftmesh.tiles.tileset import write_tileset

    outputs.check_stdout()
    with options.as_usage(), _own_names():
        extent = None if extent is None else bounds_of(extent)
    wanted: dict[str, Any] = {"max_error": max_error, "levels": levels}
    wanted |= options.given(bounds=extent, extrapolate=extrapolate, skirts=skirts)
    if source.is_dir():
        surface: Any = surfaces.open_tiles(source, reading)
    else:
        surface = surfaces.read(source, reading)
    with terminal.share_bar(f"writing tiles into {out}") as progress, _own_names():
        found = write_tileset(surface, out, **wanted, progress=progress)
    if json:
        rows_of = {} if source.is_dir() else notes.provenance(surface)
        levels_of = {"errors": found.errors, "n_triangles": found.n_triangles}
        terminal.as_json({"path": str(found.path), **levels_of, "origin": found.origin, **rows_of})
        return
    rows = [
        (f"level {level}", f"{4**level:,} tiles, {triangles:,} triangles, error {error:.4g}")
        for level, (error, triangles) in enumerate(
            zip(found.errors, found.n_triangles, strict=True)
        )
    ]
    terminal.table([*rows, ("tileset", str(found.path))])


@contextmanager
def _own_names() -> Iterator[None]:
    """Let errors about bounds name the option of this command."""
    try:
        yield
    except InputError as error:
        error.args = (error.message.renamed({"bounds": "--extent"}),)  # --bounds selects rows
        raise
