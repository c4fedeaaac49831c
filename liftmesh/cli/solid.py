"""``liftmesh solid``: a surface closed by walls and a base, as for printing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.base.options import Pinched
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import flag, number, option, positive

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Close a mesh or cloud to a solid, as for 3D printing."
HELP = (
    "Walls and a base are added below the surface: the result is watertight. Give the height of a "
    "flat base, or a thickness."
)
EXAMPLES = [
    "liftmesh solid jacksboro.tif fault.stl --base-height 236",
    "liftmesh solid dem.tif model.3mf --base-mm 3 --longest 150 --z-factor 2",
    "liftmesh solid tin.ply shell.stl --thickness 2 --max-edge 20 --pinched trim",
]

Target: TypeAlias = Annotated[outputs.Target, outputs.target("Mesh file, as STL or 3MF.")]


@outputs.guards("target")
def run(
    source: surfaces.Source,
    target: Target,
    base_height: Annotated[
        float | None, option("HEIGHT", "The height of a flat base.", number)
    ] = None,
    thickness: Annotated[
        float | None, option("HEIGHT", "The base is the surface itself, so much lower.", positive)
    ] = None,
    longest: Annotated[
        float | None,
        option("MM", "Scale the longer of width and depth to so many millimetres.", positive),
    ] = None,
    base_mm: Annotated[
        float | None,
        option("MM", "With --longest: a flat base, so far below the lowest vertex.", positive),
    ] = None,
    thickness_mm: Annotated[
        float | None, option("MM", "With --longest: the thickness in millimetres.", positive)
    ] = None,
    z_factor: Annotated[
        float | None, option("FACTOR", "With --longest: multiply heights by this.", positive)
    ] = None,
    pinched: Annotated[
        Pinched, flag("Faces that touch in a vertex only: refuse, or leave them out.")
    ] = "error",
    *,
    reading: surfaces.Reading,
    json: options.Json = False,
) -> None:
    """Read a surface, close it, write the solid, and say how large it is."""
    from liftmesh.terrain.boundary import solid_and_wall

    bases = {"base_height": base_height, "thickness": thickness}
    bases |= {"base_mm": base_mm, "thickness_mm": thickness_mm}
    if sum(each is not None for each in bases.values()) != 1:
        names = (f"--{each.replace('_', '-')}" for each in bases)
        raise click.BadParameter(f"give one of {', '.join(names)}")
    scaled = {"z-factor": z_factor, "base-mm": base_mm, "thickness-mm": thickness_mm}
    for name, each in scaled.items():
        if longest is None and each is not None:
            raise click.BadParameter(f"--{name} needs --longest")
    target.check()
    surface = surfaces.read(source, reading)
    if longest is not None:
        surfaces.note_units(source, surface, z_factor)
    with terminal.stage(f"closing {len(surface.faces):,} faces"):
        solid, wall = solid_and_wall(surface, bases, pinched, longest, z_factor)
    written = target.write(solid)
    rows_of = notes.provenance(surface)
    _say(written, solid, _left_out(surface, solid), wall, rows_of, as_json=json)


def _left_out(surface: Surface, solid: Cloud) -> list[str]:
    """Name what a surface has, and no solid of it."""
    values: dict[str, Any] = {"colors": surface.colors, "normals": surface.normals}
    if solid.crs is None:
        values["crs"] = surface.crs  # of a solid that is scaled
    return [*(name for name in values if values[name] is not None), *sorted(surface.attributes)]


def _say(
    written: WriteResult,
    solid: Cloud,
    left_out: list[str],
    wall: float | None,  # in millimetres, of a solid that is scaled to them
    rows_of: dict[str, Any],
    *,
    as_json: bool,
) -> None:
    faces = 0 if solid.faces is None else len(solid.faces)
    size = (solid.points.max(axis=0) - solid.points.min(axis=0)).tolist()
    told = {"dropped": [*left_out, *written.dropped], "n_triangles": faces}
    told |= {"volume": _volume(solid), "size": size, **rows_of}
    told |= {} if wall is None else {"unit": "mm", "thinnest_wall": wall}
    width, depth, height = (f"{each:.6g}" for each in size)
    measures = f"volume {_volume(solid):,.10g}, size {width} x {depth} x {height}"
    measures += "" if wall is None else f" mm, thinnest wall {wall:.3g} mm"
    lost = f" (a solid does not keep {notes.listed(left_out)})" if left_out else ""
    content = f"{faces:,} triangles{lost}, {measures}"
    outputs.report(written, content, told, as_json=as_json)


def _volume(solid: Cloud) -> float:
    """Return the volume inside the faces: a sixth of the determinants of their corners."""
    import math

    import numpy as np

    corners = (solid.points - solid.points.min(axis=0)).take(solid.faces, axis=0)
    parts = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return math.fsum(parts.tolist()) / 6
