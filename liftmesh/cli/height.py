"""``liftmesh height``: how high the points of a cloud are above the ground."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.base.options import Extrapolation, Interpolation
from liftmesh.cli import inputs, options, outputs, surfaces, terminal, thin
from liftmesh.cli.options import argument, flag, option
from liftmesh.errors import FormatError, InputError, Message, Option

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled import TiledSurface

SHORT_HELP = "Write heights of points above the ground."
HELP = (
    "OUT has all points of IN and their values, and as HeightAboveGround the height above the "
    "faces of the ground: that of IN's own points of class 2, or of another mesh or cloud, or a "
    "folder of liftmesh tile --surface. Where no face is below a point, it is NaN. LAS and LAZ "
    "become LAS or LAZ in chunks, if all rows are written and z stays."
)
EXAMPLES = [
    "liftmesh height scan.laz heights.laz",
    "liftmesh height scan.laz heights.laz --ground dtm.ply --extrapolate nearest",
    "liftmesh height large.laz heights.laz --ground tiles",
    "liftmesh height trees.csv flat.csv --ground ground.csv --replace-z",
]
_NAME = "HeightAboveGround"
_GIVEN = "given_z"
_OF_CHUNKS = {"format", "max_bytes", "color_depth"}
_OF_ROWS = {  # which rows are measured, above the whole ground
    "classes", "all_classes", "withheld", "returns", "bounds", "z_range", "every", "color_depth",
    "copc_resolution",
}  # fmt: skip


@outputs.guards("target")
def run(
    source: Annotated[Path, argument("IN", "Cloud file, all rows of which count.")],
    target: thin.Target,
    ground: Annotated[
        Path | None,
        option("FILE", "Mesh, cloud or folder of tiles of the ground, in place of IN's class 2."),
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
    from liftmesh.io.streams import progress

    target.check()
    is_chunked = not replace_z and _comes_in_chunks(source, target, reading)
    clouds = _clouds(source, reading, is_chunked=is_chunked)
    first = next(clouds)
    made = _GIVEN if replace_z else _NAME
    if made in first.attributes:
        raise InputError(
            f"{source}: the points have values named {made!r}, which this command writes: rename "
            "them, or leave them out"
        )
    below = _ground(source, ground, first, reading, threads)
    asked = {"interpolation": interpolation, "threads": threads}
    asked |= options.given(extrapolate=extrapolate)
    if extrapolate is not None and ground is not None and ground.is_dir():
        raise click.BadParameter(f"--extrapolate is for files: {ground} is a surface in tiles")
    heights = _Heights(source, below, asked, replace_z=replace_z)
    with inputs.about_rows([source], first):
        if is_chunked:
            with terminal.reading(f"measuring {source.name}", progress):
                written = target.write_chunks(heights.added(chain([first], clouds)))
        else:
            written = _written(target, heights, first)
    told = f"{heights.known:,} of {heights.points:,} points have a height"
    outputs.report(written, told, heights.counts(), as_json=json)


def _comes_in_chunks(source: Path, target: outputs.Target, reading: dict[str, Any]) -> bool:
    """Whether all rows of a file are written in its own format, which has chunks."""
    from liftmesh.io.registry import find_format
    from liftmesh.io.streams import suffix_of

    kind = reading.get("format") or suffix_of(source.name)
    if options.is_stream(source) or not kind or not reading.keys() <= _OF_CHUNKS:
        return False
    return target.takes_chunks_of(find_format(kind, str(source)).name)


def _clouds(source: Path, reading: dict[str, Any], *, is_chunked: bool) -> Iterator[Cloud]:
    """Read the points, of a file without any as a whole, which says so."""
    some = None
    for some in inputs.read_chunks(source, reading) if is_chunked else ():
        yield some
    if some is None:
        yield inputs.read_rows([source], reading, of_surface=False)


class _Heights:
    """Adds heights to clouds, and counts them."""

    def __init__(
        self,
        source: Path,
        ground: Surface | TiledSurface,
        asked: dict[str, Any],
        *,
        replace_z: bool,
    ) -> None:
        self._source, self._ground, self._asked = source, ground, asked
        self.replaces_z, self.has_beyond = replace_z, "extrapolate" in asked
        self.points = self.known = 0

    def added(self, clouds: Iterable[Cloud]) -> Iterator[Cloud]:
        """Yield clouds with heights; say at the end if there are none."""
        import numpy as np

        for cloud in clouds:
            heights = self._ground.height_above(cloud, **self._asked)
            self.points += len(cloud)
            self.known += int(np.count_nonzero(~np.isnan(heights)))
            yield _with_heights(cloud, heights, replace_z=self.replaces_z)
        if not self.known and not self.has_beyond:
            left, low, right, high = (f"{each:.10g}" for each in self._ground.bounds)
            terminal.note(
                f"{self._source}: no point is over the ground, whose x is from {left} to {right}, "
                f"and y from {low} to {high}"
            )

    def counts(self) -> dict[str, int]:
        """Return what `--json` prints."""
        ground: Any = self._ground
        n_faces = ground.nsimplex if hasattr(ground, "nsimplex") else len(ground.faces)
        return {"n_points": self.points, "n_known": self.known, "n_faces": n_faces}


def _written(target: outputs.Target, heights: _Heights, cloud: Cloud) -> WriteResult:
    """Measure and write a cloud as a whole."""
    with terminal.stage(f"measuring {len(cloud):,} points"):
        [measured] = heights.added([cloud])
    try:
        target.check_content(measured)
    except FormatError as error:
        if heights.replaces_z and heights.known < len(cloud) and not heights.has_beyond:
            remedy = f"{error.message.marked}, or give {Option('extrapolate', 'nearest')}"
            error.args = (Message(remedy),)
        raise
    return target.write(measured)


def _ground(
    source: Path, ground: Path | None, cloud: Cloud, reading: dict[str, Any], threads: int | None
) -> Surface | TiledSurface:
    """Make the surface of the ground, or open it."""
    rows: dict[str, Any] = {}
    if ground is None:
        if "classification" not in cloud.attributes:
            raise InputError(f"{source} has no classes: give --ground FILE")
        ground = source
        rows = {name: value for name, value in reading.items() if name not in _OF_ROWS}
        rows["classes"] = (2,)
        if cloud.color_depth is not None:
            rows["color_depth"] = 16  # which all have: what they are was said
    how = surfaces.SurfaceOptions(rows, "xy", "error", threads, {})
    surface: Surface | TiledSurface = surfaces.read_or_open(ground, how)
    return surface


def _with_heights(cloud: Cloud, heights: Any, *, replace_z: bool) -> Cloud:
    from dataclasses import replace

    import numpy as np

    if not replace_z:
        return replace(cloud, attributes={**cloud.attributes, _NAME: heights})
    points = np.column_stack([cloud.points[:, :2], heights])
    return replace(
        cloud, points=points, attributes={**cloud.attributes, _GIVEN: cloud.points[:, 2]}
    )
