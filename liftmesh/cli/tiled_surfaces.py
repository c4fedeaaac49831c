"""Folders of tiled surfaces as input of commands that take surfaces."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from liftmesh.cli.python_options import of_reading
from liftmesh.errors import FormatError, InputError

if TYPE_CHECKING:
    from liftmesh.cli.reading import Reading
    from liftmesh.tiles.tiled_surface import TiledSurface


def check_file(path: Path) -> None:
    """Raise if a file is expected and a folder of triangles in tiles is given."""
    if not path.is_dir():
        return
    from liftmesh.tiles.manifest import MANIFEST  # noqa: PLC0415 - as below

    if (path / MANIFEST).is_file():
        raise FormatError(
            f"{path}: this is a folder of tiles, not a file: of the commands, raster, contour and "
            "verify take it"
        )


def opened(source: Path, reading: Reading, **others: object) -> TiledSurface:
    """Open a folder that ``liftmesh tile --surface`` has written."""
    from liftmesh.tiles.tiled import open_tiled  # noqa: PLC0415 - help and --version do without

    given = [*reading.trimming, *map(of_reading, [*reading.table, *reading.selection])]
    given += [name for name, value in others.items() if value not in (None, False)]
    given += ["format"] if reading.file_format is not None else []
    given += ["nonfinite"] if reading.nonfinite != "error" else []
    given += ["plane"] if reading.plane != "xy" else []
    if given:
        name = f"--{given[0].lstrip('-').replace('_', '-')}"
        raise typer.BadParameter(f"{name} is for files: {source} is a surface in tiles as it is")
    found = open_tiled(source)
    if "surface" not in found.manifest:
        raise InputError(
            f"{source} holds triangles without heights: tile the source with --surface"
        )
    return found  # type: ignore[return-value]  # the manifest says so
