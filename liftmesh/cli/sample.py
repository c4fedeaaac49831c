"""``liftmesh sample``: heights of a surface at points."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from liftmesh.base.options import Interpolation
from liftmesh.cli import notes, options, outputs, surfaces, terminal
from liftmesh.cli.options import flag, is_stream, option

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

SHORT_HELP = "Write the heights of a mesh or cloud at points."
HELP = (
    "OUT has the points of --at with the heights of the surface as z, their own heights, if they "
    "have any, as given_z, and their other numbers. "
    "Where no face contains the point, there is no height: an empty field in CSV and TSV, else NaN."
    " IN may also be a folder of liftmesh tile --surface."
)
EXAMPLES = [
    "liftmesh sample tin.ply heights.csv --at points.csv",
    "liftmesh sample tin.ply heights.csv --at wells.geojson",
    "liftmesh sample tiles/ heights.csv --at points.csv",
    "liftmesh sample survey.csv heights.ply --at points.ply --max-edge 20 --boundary-only",
]

_CSV = frozenset({"csv", "tsv"})
_NAN = re.compile(rb"(?m)(?:^|(?<=[,\t]))nan(?=[,\t\n])")

Points: TypeAlias = Annotated[surfaces.Places, surfaces.places("at", has_layers=True)]
Target: TypeAlias = Annotated[
    outputs.Target, outputs.target("Cloud file; - writes stdout.", has_writing=False)
]


@outputs.guards("target")
def run(
    source: surfaces.Source,
    target: Target,
    at: Annotated[
        Path, option("FILE", "Points x, y: a cloud of any format, GeoJSON or GeoPackage.")
    ],
    *,
    points: Points,
    interpolation: Annotated[Interpolation, flag("How heights are interpolated.")] = "linear",
    reading: surfaces.Horizontal,
    json: options.Json = False,
) -> None:
    """Read a surface and points, write the points with heights, and say how many have one."""
    target.check()
    surface = surfaces.read_or_open(source, reading)
    asked = _asked(at, points, source, surface.crs, reading.rows.get("max_bytes"))
    with terminal.stage(f"sampling at {len(asked):,} points"):
        sampled, known = _sampled(surface, asked, interpolation, reading.threads)
    path = write_points(target, sampled)
    with outputs.report_after(target.path):
        if json:
            counts: dict[str, Any] = {"n_points": len(asked), "n_known": known}
            counts |= {} if source.is_dir() else notes.provenance(surface)
            terminal.as_json({"path": str(path or "-"), "interpolation": interpolation, **counts})
        else:
            terminal.note(f"{path or 'stdout'}: {known:,} of {len(asked):,} points have a height")


def _asked(
    at: Path, points: surfaces.Places, source: Path, own: str | None, max_bytes: int | None
) -> Cloud:
    """Read the points, which have to be in the system of the surface."""
    if is_stream(at) or not points.are_shapes(at):
        return points.read(at, source, own, max_bytes, flat=None)
    return points.read_shapes(at, own, flat=None)


def _sampled(
    surface: Any, asked: Any, interpolation: Interpolation, threads: int | None
) -> tuple[Any, int]:
    """Return the points with heights as z, and how many have one."""
    from dataclasses import replace

    import numpy as np

    heights = surface.sample(asked.points[:, :2], interpolation, threads=threads)
    points = np.column_stack([asked.points[:, :2], heights])
    own = {"given_z": asked.points[:, 2]} if asked.points[:, 2].any() else {}
    attributes = {**own, **asked.attributes}
    crs = asked.crs or surface.crs
    sampled = replace(asked, points=points, attributes=attributes, faces=None, crs=crs)
    return sampled, int(np.count_nonzero(np.isfinite(heights)))


class _EmptyFields:
    """A stream of lines of CSV or TSV in which fields that are NaN become empty."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._is_amid_names = True

    def seekable(self) -> bool:
        return False

    def write(self, lines: bytes) -> int:
        values = lines
        if self._is_amid_names:
            names, end, values = bytes(lines).partition(b"\n")
            self._is_amid_names = not end
            self._stream.write(names + end)
        self._stream.write(_NAN.sub(b"", values))
        return len(lines)


def write_points(target: outputs.Target, found: Any) -> Path | None:
    """Write the points; return the file, or None for stdout."""
    from liftmesh.io import write
    from liftmesh.io.streams import suffix_of

    kind = target.file_format or suffix_of(target.path.name)
    if kind.lower().lstrip(".") not in _CSV:
        written = target.write(found).path
        return None if written is None else Path(written)
    with outputs.opened(target.path) as stream:
        write.write(_EmptyFields(stream), found, format=kind)  # type: ignore[arg-type]
    return None if is_stream(target.path) else target.path
