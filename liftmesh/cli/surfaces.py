"""What the commands about surfaces share: reading one, and numbers."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liftmesh.base.options import NonFinite, counted
from liftmesh.cli import files, inputs, terminal
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh._typing import Array
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled_surface import TiledSurface

_FACES = 1 << 20  # at once
_LONG = 20  # times the median of all sides

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
    """Read a mesh as a surface, or a cloud, which is triangulated first."""
    import liftmesh  # noqa: PLC0415 - help and --version do without

    read = partial(files.read_ground, file_format=file_format, max_bytes=max_bytes, table=table)
    cloud = inputs.merged([source], read, selection)
    with files.about(source), files.without_warnings():  # the notes say it
        if cloud.faces is None or not len(cloud.faces):
            with terminal.stage(f"triangulating {len(cloud):,} rows"):
                made = liftmesh.triangulate(
                    cloud, plane=plane, nonfinite=nonfinite, threads=threads
                )
            _note_overhangs(source, made.report.overhangs)
            return made
        with terminal.stage(f"finding {len(cloud.faces):,} faces"):
            try:
                return liftmesh.as_surface(cloud, plane=plane, threads=threads)
            except InputError as error:
                error.args = (f"{source}: {error}", *error.args[1:])
                raise


def _note_overhangs(source: Path, count: int) -> None:
    """Say on stderr how many rows the surface does not have: its heights are those of others."""
    if count:
        terminal.note(
            f"{source}: {counted(count, 'overhang')} left out: where rows share x and y at "
            "different heights, the first counts; a mesh of triangulate --duplicates has others"
        )


def note_slivers(source: Path, surface: Surface) -> None:
    """Say on stderr how many faces are far longer than others, as between the corners of a hull."""
    import numpy as np  # noqa: PLC0415 - help and --version do without

    points, faces = surface.triangulation.points, surface.faces
    if not len(faces):
        return
    usual = np.median(_sides(points, faces[:: max(1, len(faces) // _FACES)]))
    blocks = (faces[k : k + _FACES] for k in range(0, len(faces), _FACES))
    count = sum(int((_sides(points, each).max(axis=1) > _LONG * usual).sum()) for each in blocks)
    if count:
        terminal.note(
            f"{source}: {counted(count, 'face')} with a side longer than {_LONG * usual:.4g}, "
            f"{_LONG} times the median: what lies there follows few points; --max-edge leaves "
            "such faces out"
        )


def _sides(points: Array, faces: Array) -> Array:
    """Return the lengths of the three sides of each face in the plane."""
    import numpy as np  # noqa: PLC0415 - as above

    corners = points[faces, :2]
    sides = corners - np.roll(corners, 1, axis=1)
    lengths: Array = np.hypot(sides[..., 0], sides[..., 1])
    return lengths


def note_units(source: Path, surface: Surface | TiledSurface, factor: float | None) -> None:
    """Say on stderr that heights are taken to be in the unit of x and y, but refuse degrees."""
    from liftmesh.terrain.units import metres_of, steepness  # noqa: PLC0415 - help does without

    steepness(surface, factor)
    if factor is None and metres_of(surface) is None:
        terminal.note(
            f"{source}: the units of x, y and z are not all known: z is taken to be in that of x "
            "and y (--z-factor says another)"
        )


def parse_number(option: str, text: str | None, *, positive: bool = False) -> float | None:
    """Parse the value of an option that is a finite number."""
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
