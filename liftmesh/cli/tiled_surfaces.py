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
    """Raise if a file is expected and a folder of triangles in tiles is given.

    Parameters
    ----------
    path : Path
        What a command reads.

    Raises
    ------
    FormatError
        It is such a folder; the message says which commands take it.
    """
    if not path.is_dir():
        return
    from liftmesh.tiles.manifest import MANIFEST  # noqa: PLC0415 - as below

    if (path / MANIFEST).is_file():
        raise FormatError(
            f"{path}: this is a folder of tiles, not a file: of the commands, raster, contour and "
            "verify take it"
        )


def opened(source: Path, reading: Reading, **others: object) -> TiledSurface:
    """Open a folder that ``liftmesh tile --surface`` has written.

    Parameters
    ----------
    source : Path
        The folder.
    reading : Reading
        How surfaces are read and trimmed: a folder takes nothing of that.
    **others
        Further options of the command that only whole surfaces take, by their names; None and False
        say that they were not given.

    Returns
    -------
    TiledSurface
        Its files are read when they are needed.

    Raises
    ------
    typer.BadParameter
        An option was given that a folder does not take.
    InputError
        The folder holds triangles without heights.
    FormatError
        It holds no finished surface.
    """
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
