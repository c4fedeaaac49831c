"""``liftmesh accuracy``: errors of a surface at checkpoints, or at each vertex left out in turn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, TypeAlias

from liftmesh.base.options import Interpolation
from liftmesh.cli import inputs, notes, options, outputs, sample, surfaces, terminal
from liftmesh.cli.options import argument, flag, option
from liftmesh.errors import FormatError, InputError

SHORT_HELP = "Compare a mesh or cloud with checkpoints, or each vertex with the others."
HELP = (
    "Prints RMSE, mean, standard deviation and what is within 95 % of the errors: heights of the "
    "surface less those of the points of --at. Without --at, each vertex is left out in turn. OUT "
    "has the points, and as residual the error of each: none where no face contains the point."
)
EXAMPLES = [
    "liftmesh accuracy tin.ply --at checkpoints.csv",
    "liftmesh accuracy survey.laz residuals.csv --at checkpoints.csv --at-columns id,x,y,z",
    "liftmesh accuracy tin.ply leave-one-out.ply --interpolation sibson --json",
]
_NAME = "residual"
_MEASURES = (
    "n_points", "n_outside", "rmse", "mean", "std", "confidence_95", "percentile_95", "min", "max",
)  # fmt: skip

Points: TypeAlias = Annotated[surfaces.Places, surfaces.places("at", has_layers=True)]


@outputs.guards("target", prints=True)
def run(
    source: surfaces.Source,
    target: Annotated[
        Path | None, argument("[OUT]", "Cloud file of the points with their errors.")
    ] = None,
    at: Annotated[
        Path | None, option("FILE", "Checkpoints x, y, z: a cloud of any format, or GeoJSON.")
    ] = None,
    *,
    points: Points,
    interpolation: Annotated[Interpolation, flag("How heights are interpolated.")] = "linear",
    reading: surfaces.Horizontal,
    json: options.Json = False,
) -> None:
    """Read a surface and checkpoints, compare them, and print what was found."""
    from liftmesh.terrain.accuracy import table

    written = None if target is None else outputs.Target(target)
    if written is not None:
        written.check()
    surface = surfaces.read(source, reading)
    cloud = surface.to_cloud() if at is None else _checkpoints(at, points, source, surface, reading)
    if _NAME in cloud.attributes:
        raise InputError(f"the points have values named {_NAME!r}, which this command writes")
    with (
        inputs.about(source if at is None else at),
        terminal.stage(f"comparing {len(cloud):,} points"),
    ):
        asked = None if at is None else cloud
        found = surface.accuracy(asked, interpolation=interpolation, threads=reading.threads)
    if written is not None:
        sample.write_points(written, _with_errors(cloud, found.residuals, surface.crs))
    with outputs.report_after(target):
        if json:
            measures: dict[str, Any] = {name: getattr(found, name) for name in _MEASURES}
            measures |= {"unit": found.unit, **notes.provenance(surface)}
            terminal.as_json({"interpolation": interpolation, **measures})
        else:
            terminal.table(table(found))


def _checkpoints(
    at: Path, points: surfaces.Places, source: Path, surface: Any, reading: surfaces.SurfaceOptions
) -> Any:
    """Read the checkpoints, which have to have heights."""
    from liftmesh.io.metadata import Provenance

    if points.are_shapes(at):
        cloud = points.read_shapes(at, surface.crs)
        if Provenance(cloud.metadata).is_flat:
            raise FormatError(
                f"{at}: the points have no heights: give them in space, or name the column that "
                "has them, as --at-columns z=H"
            )
        return cloud
    limit = reading.rows.get("max_bytes")
    return points.read(at, source, surface.crs, limit, flat=False)


def _with_errors(cloud: Any, residuals: Any, crs: str | None) -> Any:
    from dataclasses import replace

    attributes = {**cloud.attributes, _NAME: residuals}
    return replace(cloud, attributes=attributes, crs=cloud.crs or crs)
