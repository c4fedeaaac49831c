"""Surfaces that commands read: options of reading and trimming, and what is said of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liftmesh.base.options import NonFinite, counted
from liftmesh.cli import inputs, options, terminal
from liftmesh.cli.options import option, positive
from liftmesh.cli.wording import spelled
from liftmesh.errors import InputError, Option

if TYPE_CHECKING:
    from liftmesh._typing import Array
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled import TiledSurface

_FACES = 1 << 20  # at once
_LONG = 20  # times the median of all sides

Source: TypeAlias = Annotated[
    Path,
    typer.Argument(
        metavar="IN", help="Mesh as liftmesh triangulate writes it, or a cloud, which it does."
    ),
]


def _trimming(
    max_edge: Annotated[
        float | None, option("LENGTH", "Leave out faces with a side that is longer.", positive)
    ] = None,
    boundary_only: Annotated[
        bool,
        typer.Option(
            "--boundary-only",
            help="With --max-edge: only from the boundary inwards, so that gaps stay closed.",
        ),
    ] = False,
    max_radius: Annotated[
        float | None,
        option(
            "RADIUS", "Leave out faces whose circumcircle is larger: the alpha shape.", positive
        ),
    ] = None,
    trim_polygon: Annotated[
        Path | None,
        option("FILE", "Leave out faces whose centroid is outside (GeoJSON, GeoPackage)."),
    ] = None,
) -> dict[str, Any]:
    """Check the options of trimming, and return those given, as `Surface.trim` has them."""
    if max_edge is None and boundary_only:
        raise typer.BadParameter("--boundary-only needs --max-edge")
    if trim_polygon is not None:
        trim_polygon.open("rb").close()
    trimming = options.given(max_edge=max_edge, max_radius=max_radius, boundary_only=boundary_only)
    return trimming | options.given(polygon=trim_polygon)


Trimming: TypeAlias = Annotated[dict[str, Any], options.Group(_trimming)]


def trimmed(surface: Surface, trimming: dict[str, Any]) -> Surface:
    """Leave out faces as the options say."""
    return surface.trim(**trimming) if trimming else surface


@dataclass(frozen=True)
class SurfaceOptions:
    """How surfaces are read and trimmed."""

    rows: dict[str, Any]  # options of `liftmesh.read`
    plane: Any
    nonfinite: NonFinite
    threads: int | None
    trimming: dict[str, Any]


def _reading(
    input_format: options.InputFormat = None,
    plane: options.Plane = "xy",
    nonfinite: options.SkipNonFinite = "error",
    *,
    trimming: Trimming,
    threads: options.Threads = None,
    rows: inputs.RowOptions,
    max_bytes: options.MaxBytes = None,
) -> SurfaceOptions:
    rows = rows | options.given(format=input_format, max_bytes=max_bytes)
    return SurfaceOptions(rows, plane.value, nonfinite, threads, trimming)


Reading: TypeAlias = Annotated[SurfaceOptions, options.Group(_reading)]


def read(source: Path, reading: SurfaceOptions) -> Surface:
    """Read a mesh as a surface, or a cloud, which is triangulated first; trim it."""
    return trimmed(read_whole(source, reading), reading.trimming)


def read_whole(source: Path, reading: SurfaceOptions) -> Surface:
    """Read a surface without trimming it."""
    import liftmesh

    cloud = inputs.read_rows([source], reading.rows)
    choices = {"plane": reading.plane, "threads": reading.threads}
    with inputs.about(source), inputs.without_warnings():  # the notes say it
        if cloud.faces is None or not len(cloud.faces):
            with terminal.stage(f"triangulating {len(cloud):,} rows"):
                made = liftmesh.triangulate(cloud, nonfinite=reading.nonfinite, **choices)
            _note_overhangs(source, made.report.n_overhangs)
            return made
        with terminal.stage(f"finding {len(cloud.faces):,} faces"):
            return liftmesh.as_surface(cloud, **choices)


def open_tiles(source: Path, reading: SurfaceOptions, **others: object) -> TiledSurface:
    """Open a folder that ``liftmesh tile --surface`` has written."""
    from liftmesh.tiles.tiled import open_tiled

    of_files = {"format", "max_bytes"}
    given = [*reading.trimming]
    given += [name for name in reading.rows if name not in of_files]
    given += [name for name, value in others.items() if value not in (None, False)]
    given += ["format"] if "format" in reading.rows else []
    given += ["nonfinite"] if reading.nonfinite != "error" else []
    given += ["plane"] if reading.plane != "xy" else []
    if given:
        raise typer.BadParameter(
            f"{spelled(Option(given[0]))} is for files: {source} is a surface in tiles as it is"
        )
    tiled = open_tiled(source)
    if "surface" not in tiled.manifest:
        raise InputError(
            f"{source} holds triangles without heights: tile the source with --surface"
        )
    return tiled  # type: ignore[return-value]  # the manifest says so


def _note_overhangs(source: Path, count: int) -> None:
    """Say on stderr how many rows the surface does not have: its heights are those of others."""
    if count:
        terminal.note(
            f"{source}: {counted(count, 'overhang')} left out: where rows share x and y at "
            "different heights, the first counts; a mesh of triangulate --on-duplicate has others"
        )


def note_slivers(source: Path, surface: Surface) -> None:
    """Say on stderr how many faces are far longer than others, as between the corners of a hull."""
    import numpy as np

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
    import numpy as np

    corners = points[faces, :2]
    sides = corners - np.roll(corners, 1, axis=1)
    lengths: Array = np.hypot(sides[..., 0], sides[..., 1])
    return lengths


def note_units(source: Path, surface: Surface | TiledSurface, factor: float | None) -> None:
    """Say on stderr that heights are taken to be in the unit of x and y, but refuse degrees."""
    from liftmesh.terrain.units import metres_of, steepness

    steepness(surface, factor)
    if factor is None and metres_of(surface) is None:
        terminal.note(
            f"{source}: the units of x, y and z are not all known: z is taken to be in that of x "
            "and y (--z-factor says another)"
        )
