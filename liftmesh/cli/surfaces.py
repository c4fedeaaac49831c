"""Surfaces that commands read and trim, and the places of ``--at`` and ``--along`` on them."""

from __future__ import annotations

import inspect
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, get_args

import click

from liftmesh.base.options import NonFinite, counted, shown
from liftmesh.cli import inputs, notes, options, terminal
from liftmesh.cli.options import argument, flag, option, positive
from liftmesh.cli.wording import spelled
from liftmesh.errors import FormatError, InputError, Message, Option

if TYPE_CHECKING:
    from liftmesh._typing import Array
    from liftmesh.base.cloud import Cloud
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled import TiledSurface

SHAPES = {".geojson", ".json", ".gpkg", ".shp"}
_LEFT_OUT = "flat"  # of places: where they are, not how high
_FACES = 1 << 20  # at once
_LONG = 20  # times the median of all sides

Source: TypeAlias = Annotated[
    Path,
    argument("IN", "Mesh as liftmesh triangulate writes it, or a cloud, triangulated first."),
]
Values: TypeAlias = Annotated[
    str | None, option("NAME", "Values of the vertices in place of heights, as intensity.")
]


def _trimming(
    max_edge: Annotated[
        float | None, option("LENGTH", "Leave out faces with a side that is longer.", positive)
    ] = None,
    boundary_only: Annotated[
        bool,
        flag("With --max-edge: only from the boundary inwards, so that gaps stay closed."),
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
        raise click.BadParameter("--boundary-only needs --max-edge")
    if trim_polygon is not None:
        trim_polygon.open("rb").close()
    trimming = options.given(max_edge=max_edge, max_radius=max_radius, boundary_only=boundary_only)
    return trimming | options.given(polygon=trim_polygon)


Trimming: TypeAlias = Annotated[dict[str, Any], options.Group(_trimming, "Selection")]


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


def _horizontal(
    *,
    rows: inputs.Reading,
    nonfinite: options.SkipNonFinite = "error",
    trimming: Trimming,
    threads: options.Threads = None,
) -> SurfaceOptions:
    return SurfaceOptions(rows, "xy", nonfinite, threads, trimming)


Horizontal: TypeAlias = Annotated[SurfaceOptions, options.Group(_horizontal)]


def _reading(plane: options.Plane = "xy", *, horizontal: Horizontal) -> SurfaceOptions:
    return replace(horizontal, plane=plane.value)


Reading: TypeAlias = Annotated[SurfaceOptions, options.Group(_reading)]


def read(source: Path, reading: SurfaceOptions) -> Surface:
    """Read a mesh as a surface, or a cloud, which is triangulated first; trim it."""
    return trimmed(read_whole(source, reading), reading.trimming)


def read_whole(source: Path, reading: SurfaceOptions) -> Surface:
    """Read a surface without trimming it."""
    cloud = inputs.read_rows([source], reading.rows)
    choices = {"plane": reading.plane, "threads": reading.threads}
    return of_cloud(cloud, source, nonfinite=reading.nonfinite, **choices)


def of_cloud(cloud: Cloud, source: Path, *, nonfinite: NonFinite, **choices: Any) -> Surface:
    """Make a surface of the faces of a file, or of its rows."""
    import liftmesh

    with inputs.about(source), inputs.without_warnings():  # the notes say it
        if cloud.faces is None or not len(cloud.faces):
            with terminal.stage(f"triangulating {len(cloud):,} rows"):
                made = liftmesh.triangulate(cloud, nonfinite=nonfinite, **choices)
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
        raise click.BadParameter(
            f"{spelled(Option(given[0]))} is for files: {source} is a surface in tiles as it is"
        )
    tiled = open_tiled(source)
    if "surface" not in tiled.manifest:
        raise InputError(
            f"{source} holds triangles without heights: tile the source with --surface"
        )
    return tiled  # type: ignore[return-value]  # the manifest says so


def read_or_open(source: Path, reading: SurfaceOptions) -> Any:
    """Read a surface, or open the tiles of one."""
    return open_tiles(source, reading) if source.is_dir() else read(source, reading)


def _note_overhangs(source: Path, count: int) -> None:
    """Say on stderr how many rows the surface does not have: its heights are those of others."""
    if count:
        terminal.note(
            f"{source}: {counted(count, 'overhang')} left out: where rows share x and y at "
            "different heights, the first counts; a mesh of triangulate --on-duplicate has others"
        )


def check_grounds(surfaces_: dict[Path, Any]) -> None:
    """Raise if one surface is of ground, and the other one of all rows, as it has no ground."""
    from liftmesh.io.metadata import Provenance
    from liftmesh.io.read import check_grounds as check

    check((str(path), Provenance(each.metadata).selection) for path, each in surfaces_.items())


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
    from liftmesh.terrain.surface_data import metres_of, steepness

    steepness(surface, factor)
    if factor is None and metres_of(surface) is None:
        terminal.note(
            f"{source}: the units of x, y and z are not all known: z is taken to be in that of x "
            "and y (--z-factor says another)"
        )


@dataclass(frozen=True)
class Places:
    """How the table of an option is read."""

    option: str  # without its dashes
    file_format: str | None
    table: dict[str, Any]
    layer: str | None = None

    def are_shapes(self, path: Path) -> bool:
        """Whether a file holds shapes, and neither a table nor a cloud."""
        return self.file_format is None and is_shapes(path)

    def read(
        self,
        path: Path,
        source: Path,
        crs: str | None,
        max_bytes: int | None,
        *,
        flat: bool | None = True,  # as of `liftmesh.read`, for a table without named columns
    ) -> Cloud:
        """Read points over a surface of this source and system, in which they have to be."""
        from liftmesh.crs.comparison import are_different

        kind: dict[str, Any] = {} if self.file_format is None else {"format": self.file_format}
        if (self.file_format or path.suffix) and is_table(path, self.file_format):
            kind["flat"] = None if "columns" in self.table else flat
        try:
            limit = options.given(max_bytes=max_bytes, layer=self.layer)
            cloud = inputs.read(path, {**self.table, **kind, **limit})
        except (FormatError, InputError) as error:
            error.args = (error.message.renamed(_own_names(self.option)),)
            raise
        except click.BadParameter as error:
            raise _renamed(error, self.option) from error
        if are_different(crs, cloud.crs):
            there, here = shown(cloud.crs), shown(crs)
            raise InputError(
                f"{path} is in {there}, {source} in {here}: transform the points first"
            )
        return cloud

    def read_shapes(self, path: Path, crs: str | None, *, flat: bool | None = False) -> Cloud:
        """Read points of a file of shapes over a surface of this system; say what is not read."""
        from liftmesh.vector.clouds import points_of

        own = {key: each for key, each in self.table.items() if key in ("columns", "nodata")}
        with terminal.stage(f"reading {path.name}"):
            try:
                cloud = points_of(path, crs, self.layer, **{"flat": flat, **own})
            except (FormatError, InputError) as error:
                error.args = (error.message.renamed(_own_names(self.option)),)
                raise
        if not_read := notes.parts_not_read(cloud):
            terminal.note(f"{path}: not read: {notes.listed(not_read)}")
        return cloud


def _renamed(error: click.BadParameter, option_name: str) -> click.BadParameter:
    return click.BadParameter(Message(error.message).renamed(_own_names(option_name)))


def _own_names(option_name: str) -> dict[str, str]:
    """Return by option of IN that of the table which an option names."""
    names = {each: f"--{option_name}-{each.replace('_', '-')}" for each in _table_options()}
    names["layer"] = f"--{option_name}-layer"
    other = {"format": f"--{option_name}-input-format", "header": f"--{option_name}-no-header"}
    return names | other


def places(option_name: str, *, has_layers: bool = False) -> options.Group:
    """Make the group of options of the table that an option, without its dashes, names.

    They are those of IN with another name each, as ``--at-columns``, so that what an error about
    the table recommends is an option of the table itself.
    """

    def parse(**given: Any) -> Places:
        plain = {key.removeprefix(f"{option_name}_"): value for key, value in given.items()}
        file_format = plain.pop("input_format")
        try:
            layer = plain.pop("layer", None)
            return Places(option_name, file_format, inputs.table(**plain), layer)
        except click.BadParameter as error:
            raise _renamed(error, option_name) from error

    text = f"Format of --{option_name}, instead of its suffix."
    parameters = [
        options.parameter(f"{option_name}_input_format", str | None, option("FORMAT", text))
    ]
    if has_layers:
        own = option("NAME", f"GeoPackage of --{option_name}: the layer to read, of several.")
        parameters.append(options.parameter(f"{option_name}_layer", str | None, own))
    for name, each in _table_options().items():
        kind, spec = get_args(each.annotation)
        text = f"As --{name.replace('_', '-')}, of the table of --{option_name}."
        own = replace(spec, text=text)
        parameters.append(options.parameter(f"{option_name}_{name}", kind, own, each.default))
    return options.Group(options.with_parameters(parse, parameters), "Input")


def _table_options() -> dict[str, inspect.Parameter]:
    """Return the options of tables, by name."""
    parameters = dict(inspect.signature(inputs.table, eval_str=True).parameters)
    del parameters[_LEFT_OUT]
    return parameters


def is_shapes(path: Path) -> bool:
    """Whether a file holds shapes, by its suffix, and neither a table nor a cloud."""
    from liftmesh.io.registry import find_format
    from liftmesh.io.streams import suffix_of

    if path.suffix.lower() in SHAPES or not path.suffix:
        return True
    try:
        return find_format(suffix_of(path.name), str(path)) is None
    except FormatError:
        return True


def is_table(path: Path, file_format: str | None = None) -> bool:
    """Whether a file is a table, by its format or its suffix."""
    from liftmesh.io.registry import find_format
    from liftmesh.io.streams import suffix_of

    kind = file_format or suffix_of(path.name)
    return bool(kind) and find_format(kind, str(path)).name == "text"
