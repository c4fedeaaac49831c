"""The options that say which rows of a file are read, and where to: `liftmesh.read` knows them."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from liftmesh.base.options import Returns
from liftmesh.cli import groups
from liftmesh.cli.options import parse_count, parse_length
from liftmesh.errors import InputError


def parse(
    classes: Annotated[
        str | None,
        typer.Option(
            metavar="CLASSES",
            help="Rows of these classes, as 2,9; ground (class 2 if there is any); or all.",
        ),
    ] = None,
    returns: Annotated[
        Returns | None,
        typer.Option(help="Rows of the last or the first return, or of those that are both."),
    ] = None,
    bbox: Annotated[
        str | None,
        typer.Option(metavar="X0,Y0,X1,Y1", help="Rows inside a rectangle, or on its border."),
    ] = None,
    z_range: Annotated[
        str | None, typer.Option("--z-range", metavar="Z0,Z1", help="Rows of these heights.")
    ] = None,
    every: Annotated[
        str, typer.Option(metavar="N", help="Every n-th of the rows that are left.")
    ] = "1",
    withheld: Annotated[
        bool, typer.Option("--withheld", help="Rows flagged as withheld, too.")
    ] = False,
    resolution: Annotated[
        str | None,
        typer.Option(metavar="D", help="Of a COPC file, points at about this distance."),
    ] = None,
    band: Annotated[
        str | None,
        typer.Option(metavar="N", help="Rasters: the band that holds the heights; the first is 1."),
    ] = None,
    from_crs: Annotated[
        str | None,
        typer.Option(
            "--from-crs",
            metavar="CRS",
            help="The coordinate system of the file, as EPSG:25832, in place of what it states; of "
            "several, of those that state none, or the same without heights.",
        ),
    ] = None,
    to_crs: Annotated[
        str | None,
        typer.Option(
            "--to-crs",
            metavar="CRS",
            help="Transform the coordinates to this system, as EPSG:25832.",
        ),
    ] = None,
) -> dict[str, Any]:
    """Check the conditions on rows, and return those that were given."""
    given: dict[str, Any] = {}
    if classes is not None:
        given["classes"] = _classes(classes)
    given |= {} if returns is None else {"returns": returns}
    given |= {} if bbox is None else {"bbox": _numbers("--bbox", bbox)}
    given |= {} if z_range is None else {"z_range": _numbers("--z-range", z_range)}
    count = parse_count("--every", every, 1)
    given |= {"every": count} if count > 1 else {}
    given |= {"withheld": True} if withheld else {}
    if resolution is not None:
        given["resolution"] = parse_length("--resolution", resolution)
    system: dict[str, Any] = {} if to_crs is None else {"to_crs": to_crs}
    system |= {} if from_crs is None else {"crs": from_crs}
    system |= {} if band is None else {"band": parse_count("--band", band, 1)}
    if not given:
        return system
    from liftmesh.io.selection import validate_selection  # noqa: PLC0415 - most runs do without

    try:
        validate_selection(**given)
    except InputError as error:
        raise typer.BadParameter(f"--{error}".replace("--z_range", "--z-range")) from error
    return given | system


def _classes(text: str) -> str | list[int]:
    if text in {"ground", "all"}:
        return text
    words = text.split(",")
    if not all(word.strip().isdecimal() and len(word) < 9 for word in words):
        raise typer.BadParameter(f"--classes {text!r} is unknown: give ground, all or as 2,9")
    return [int(word) for word in words]


def _numbers(option: str, text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{option} {text!r} is no list of numbers, as 0,10") from None


with_options = groups.taking("selection", parse)
