"""The options that leave out faces, which every command about surfaces has: `Surface.trim`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.cli import groups
from liftmesh.cli.surfaces import parse_number

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


def parse(
    max_edge: Annotated[
        str | None,
        typer.Option(
            "--max-edge", metavar="LENGTH", help="Leave out faces with a side that is longer."
        ),
    ] = None,
    boundary_only: Annotated[
        bool,
        typer.Option(
            "--boundary-only",
            help="With --max-edge: only from the boundary inwards, so that gaps stay closed.",
        ),
    ] = False,
    max_radius: Annotated[
        str | None,
        typer.Option(
            "--max-radius",
            metavar="RADIUS",
            help="Leave out faces whose circumcircle is larger: the alpha shape.",
        ),
    ] = None,
    polygon: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Leave out faces whose centroid is outside (GeoJSON, GeoPackage)."
        ),
    ] = None,
) -> dict[str, Any]:
    """Check the options of trimming, before the work starts."""
    if max_edge is None and boundary_only:
        raise typer.BadParameter("--boundary-only needs --max-edge")
    lengths = {
        "max_edge": parse_number("--max-edge", max_edge, positive=True),
        "max_radius": parse_number("--max-radius", max_radius, positive=True),
    }
    given: dict[str, Any] = {key: each for key, each in lengths.items() if each is not None}
    given |= {"boundary_only": True} if boundary_only else {}
    if polygon is not None:
        polygon.open("rb").close()
        given["polygon"] = polygon
    return given


def trimmed(surface: Surface, trimming: Mapping[str, Any]) -> Surface:
    """Leave out faces as the options say."""
    return surface.trim(**trimming) if trimming else surface


with_options = groups.taking("trimming", parse)
