"""``liftmesh height``: how high the points of a cloud are above the ground."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from liftmesh.base.options import Extrapolation, Interpolation
from liftmesh.cli import inputs, options, outputs, surfaces, terminal, thin
from liftmesh.cli.options import argument, flag, option
from liftmesh.errors import FormatError, InputError, Message, Option

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.terrain.surface import Surface

SHORT_HELP = "Write heights of points above the ground."
HELP = (
    "OUT has all points of IN and their values, and as HeightAboveGround the height above the "
    "faces of the ground: that of IN's own points of class 2, or of another mesh or cloud. Where "
    "no face is below a point, it is NaN."
)
EXAMPLES = [
    "liftmesh height scan.laz heights.laz",
    "liftmesh height scan.laz heights.laz --ground dtm.ply --extrapolate nearest",
    "liftmesh height trees.csv flat.csv --ground ground.csv --replace-z",
]
_NAME = "HeightAboveGround"
_GIVEN = "given_z"
_PARTS = {"bounds", "z_range", "copc_resolution"}  # by which parts of a file are read
_OF_ROWS = {  # which rows are measured, above the whole ground
    "classes", "all_classes", "withheld", "returns", "bounds", "z_range", "every", "color_depth",
    "copc_resolution",
}  # fmt: skip


@outputs.guards("target")
def run(
    source: Annotated[Path, argument("IN", "Cloud file, all rows of which count.")],
    target: thin.Target,
    ground: Annotated[
        Path | None, option("FILE", "Mesh or cloud of the ground, in place of IN's class 2.")
    ] = None,
    interpolation: Annotated[
        Interpolation, flag("How heights of the ground are interpolated.")
    ] = "linear",
    extrapolate: Annotated[
        Extrapolation | None, flag("What the ground is where it has no face.")
    ] = None,
    *,
    replace_z: Annotated[bool, flag("Write the heights as z, and z as given_z.")] = False,
    reading: inputs.AllColoredRows,
    threads: options.Threads = None,
    json: options.Json = False,
) -> None:
    """Read points and the ground, write the points with heights, and say how many have one."""
    import numpy as np

    if json:
        outputs.check_stdout()
    target.check()
    cloud = inputs.read_rows([source], reading, of_surface=False)
    made = _GIVEN if replace_z else _NAME
    if made in cloud.attributes:
        raise InputError(
            f"{source}: the points have values named {made!r}, which this command writes: rename "
            "them, or leave them out"
        )
    below = _ground(source, ground, cloud, reading, threads)
    with inputs.about_rows([source], cloud):
        with terminal.stage(f"measuring {len(cloud):,} points"):
            heights = below.height_above(
                cloud, interpolation=interpolation, extrapolate=extrapolate, threads=threads
            )
        measured = _with_heights(cloud, heights, replace_z=replace_z)
        known = int(np.count_nonzero(~np.isnan(heights)))
        if not known and extrapolate is None:
            left, low, right, high = (f"{each:.10g}" for each in below.bounds)
            terminal.note(
                f"{source}: no point is over the ground, whose x is from {left} to {right}, and y "
                f"from {low} to {high}"
            )
        try:
            target.check_content(measured)
        except FormatError as error:
            if replace_z and known < len(cloud) and extrapolate is None:
                remedy = f"{error.message.marked}, or give {Option('extrapolate', 'nearest')}"
                error.args = (Message(remedy),)
            raise
    written = target.write(measured)
    with outputs.report_after(target.path):
        if json:
            counts = {"n_points": len(cloud), "n_known": known, "n_faces": len(below.faces)}
            terminal.as_json({**outputs.as_values(written), **counts})
        else:
            told = f"{known:,} of {len(cloud):,} points have a height"
            terminal.sentence(outputs.headline(written, told), "good")


def _ground(
    source: Path, ground: Path | None, cloud: Cloud, reading: dict[str, Any], threads: int | None
) -> Surface:
    """Make the surface of the ground."""
    if ground is None:
        if "classification" not in cloud.attributes:
            raise InputError(f"{source} has no classes: give --ground FILE")
        ground = source
        rows = {name: value for name, value in reading.items() if name not in _OF_ROWS}
        rows["classes"] = (2,)
        if cloud.color_depth is not None and not _PARTS & reading.keys():
            rows["color_depth"] = cloud.color_depth  # decided, and said, once
    else:
        rows = {}
    return surfaces.read(ground, surfaces.SurfaceOptions(rows, "xy", "error", threads, {}))


def _with_heights(cloud: Cloud, heights: Any, *, replace_z: bool) -> Cloud:
    from dataclasses import replace

    import numpy as np

    if not replace_z:
        return replace(cloud, attributes={**cloud.attributes, _NAME: heights})
    points = np.column_stack([cloud.points[:, :2], heights])
    return replace(
        cloud, points=points, attributes={**cloud.attributes, _GIVEN: cloud.points[:, 2]}
    )
