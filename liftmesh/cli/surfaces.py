"""What the commands about surfaces share: reading one, and numbers."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liftmesh.choices import NonFinite
from liftmesh.cli import files, inputs, terminal
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled_surface import TiledSurface

Source: TypeAlias = Annotated[
    Path,
    typer.Argument(
        metavar="IN", help="Mesh as liftmesh triangulate writes it, or a cloud, which it does."
    ),
]


def read(
    source: Path,
    file_format: str | None,
    plane: Any,
    *,
    nonfinite: NonFinite,
    threads: int | None,
    max_bytes: int | None,
    table: Any,
    selection: Any,
) -> Surface:
    """Read a mesh as a surface, or a cloud, which is triangulated first.

    Parameters
    ----------
    source : Path
        IN.
    file_format : str, optional
        Its format, instead of its suffix.
    plane : object
        As for `liftmesh.triangulate`.
    nonfinite : str
        As for `liftmesh.triangulate`.
    threads, max_bytes : int, optional
        As for `liftmesh.triangulate` and `liftmesh.read`.
    table, selection : mapping
        Options of tables and of the rows to read.

    Returns
    -------
    Surface
        The surface.

    Raises
    ------
    InputError
        The faces are not those of a triangulation.
    """
    import liftmesh  # noqa: PLC0415 - help and --version do without

    read = partial(files.read_ground, file_format=file_format, max_bytes=max_bytes, table=table)
    cloud = inputs.merged([source], read, selection)
    with files.about(source), files.without_warnings():  # the notes say it
        if cloud.faces is None or not len(cloud.faces):
            with terminal.stage(f"triangulating {len(cloud):,} rows"):
                return liftmesh.triangulate(
                    cloud, plane=plane, nonfinite=nonfinite, threads=threads
                )
        with terminal.stage(f"finding {len(cloud.faces):,} faces"):
            try:
                return liftmesh.as_surface(cloud, plane=plane, threads=threads)
            except InputError as error:
                error.args = (f"{source}: {error}", *error.args[1:])
                raise


def note_units(source: Path, surface: Surface | TiledSurface, factor: float | None) -> None:
    """Say on stderr that heights are taken to be in the unit of x and y where nothing says so.

    Parameters
    ----------
    source : Path
        The file of the surface.
    surface : Surface or TiledSurface
        The surface.
    factor : float, optional
        What the caller says that heights are to be multiplied by.
    """
    from liftmesh.terrain.units import metres_of  # noqa: PLC0415 - help and --version do without

    if factor is None and metres_of(surface) is None:  # type: ignore[arg-type]
        terminal.note(
            f"{source}: the units of x, y and z are not all known: z is taken to be in that of x "
            "and y (--z-factor says another)"
        )


def parse_number(option: str, text: str | None, *, positive: bool = False) -> float | None:
    """Parse the value of an option that is a finite number.

    Parameters
    ----------
    option : str
        The option, for the message.
    text : str, optional
        The number.
    positive : bool
        Whether it must be above zero.

    Returns
    -------
    float or None
        The number; None without an option.

    Raises
    ------
    typer.BadParameter
        The text is no such number.

    Examples
    --------
    >>> parse_number("--interval", "0.5", positive=True)
    0.5
    """
    if text is None:
        return None
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    least = 0.0 if positive else float("-inf")
    if not least < number < float("inf"):
        kind = "positive number" if positive else "number"
        raise typer.BadParameter(f"{option} {text!r} is not a {kind}")
    return number
