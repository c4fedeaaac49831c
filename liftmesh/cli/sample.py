"""``liftmesh sample``: heights of a surface at points."""

from __future__ import annotations

import re
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import SampleMethod, shown
from liftmesh.cli import (
    files,
    lidar,
    options,
    outputs,
    overwriting,
    rows,
    second_tables,
    shapes,
    standard_streams,
    surfaces,
    tables,
    terminal,
)
from liftmesh.cli.trimming import trimmed, with_options as with_trimming
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

SHORT_HELP = "Write the heights of a mesh or cloud at points."
HELP = (
    "OUT has the points of --at with the heights of the surface as z, their own heights, if they "
    "have any, as given_z, and their other numbers. "
    "Where no face contains the point, there is no height: an empty field in CSV and TSV, else NaN."
)
EXAMPLES = [
    "liftmesh sample tin.ply heights.csv --at points.csv",
    "liftmesh sample tin.ply heights.csv --at wells.geojson",
    "liftmesh sample survey.csv heights.ply --at points.ply --max-edge 20 --boundary-only",
]

_CSV = frozenset({"csv", "tsv"})
_NAN = re.compile(rb"(?m)(?:^|(?<=[,\t]))nan(?=[,\t\n])")


@overwriting.guards("target")
@second_tables.with_options("at", "points")
@tables.with_options
@rows.with_options
@with_trimming
def run(
    source: surfaces.Source,
    target: Annotated[Path, typer.Argument(metavar="OUT", help="Cloud file; - writes stdout.")],
    at: Annotated[
        Path,
        typer.Option(
            metavar="FILE", help="Points x, y: a cloud of any format, GeoJSON or GeoPackage."
        ),
    ],
    points: Any = None,
    method: Annotated[SampleMethod, typer.Option(help="How heights are interpolated.")] = "linear",
    nonfinite: options.SkipNonFinite = "error",
    source_format: options.SourceFormat = None,
    target_format: Annotated[
        str | None,
        typer.Option("--format", metavar="FORMAT", help="Format of OUT, instead of its suffix."),
    ] = None,
    trimming: Any = None,
    threads: options.Threads = None,
    table: Any = None,
    selection: Any = None,
    max_bytes: options.MaxBytes = None,
    json: options.Json = False,
) -> None:
    """Read a surface and points, write the points with heights, and say how many have one."""
    if json:
        standard_streams.check_stdout()
    count, limit = options.parse_threads(threads), options.parse_size(max_bytes)
    files.check_target(target, target_format)
    surface = surfaces.read(
        source,
        source_format,
        "xy",
        nonfinite=nonfinite,
        threads=count,
        max_bytes=limit,
        table=table,
        selection=selection,
    )
    surface = trimmed(surface, trimming)
    asked = _asked(at, points, source, surface.crs, limit)
    with terminal.stage(f"sampling at {len(asked):,} points"):
        found, known = _sampled(surface, asked, method, count)
    path = _write(target, found, target_format)
    place = redirect_stdout(sys.stderr) if path is None else standard_streams.dispensable_stdout()
    with place, standard_streams.after_writing(path):
        if json:
            counts: dict[str, Any] = {"points": len(asked), "known": known}
            counts |= lidar.provenance(surface)
            terminal.as_json({"path": str(path or "-"), "method": method, **counts})
        else:
            terminal.note(f"{path or 'stdout'}: {known:,} of {len(asked):,} points have a height")


def _asked(at: Path, points: Any, source: Path, own: str | None, limit: int | None) -> Cloud:
    """Read the points, which have to be in the system of the surface."""
    if points.file_format is not None or files.is_stream(at) or shapes.is_cloud(at):
        asked: Cloud = points.read(at, limit, flat=None)
        _check_systems(source, own, at, asked.crs)
        return asked
    from liftmesh.vector.points import points_of  # noqa: PLC0415 - help and --version do without

    with terminal.stage(f"reading {at.name}"):
        asked = points_of(at, own)
    if not_read := files.parts_not_read(asked):
        terminal.note(f"{at}: not read: {files.listed(not_read)}")
    return asked


def _check_systems(source: Path, own: str | None, at: Path, given: str | None) -> None:
    """Raise if the points are in another system than the surface."""
    from liftmesh.crs.comparison import are_different  # noqa: PLC0415 - help and --version do without

    if are_different(own, given):
        raise InputError(
            f"{at} is in {shown(given)}, {source} in {shown(own)}: transform the points first"
        )


def _sampled(
    surface: Any, asked: Any, method: SampleMethod, threads: int | None
) -> tuple[Any, int]:
    """Return the points with heights as z, and how many have one."""
    from dataclasses import replace  # noqa: PLC0415 - help and --version do without

    import numpy as np  # noqa: PLC0415 - as above

    heights = surface.sample(asked.points[:, :2], method, threads=threads)
    points = np.column_stack([asked.points[:, :2], heights])
    own = {"given_z": asked.points[:, 2]} if asked.points[:, 2].any() else {}
    values = {**own, **asked.attributes}
    crs = asked.crs or surface.crs
    found = replace(asked, points=points, attributes=values, faces=None, crs=crs)
    return found, int(np.count_nonzero(np.isfinite(heights)))


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


def _write(target: Path, found: Any, file_format: str | None) -> Path | None:
    """Write the points; return the file, or None for stdout."""
    from liftmesh.io import atomic, write  # noqa: PLC0415 - help and --version do without
    from liftmesh.io.streams import suffix_of  # noqa: PLC0415 - as above

    kind = file_format or suffix_of(target.name)
    if kind.lower().lstrip(".") not in _CSV:
        written = outputs.write(target, found, file_format).path
        return None if written is None else Path(written)
    if files.is_stream(target):
        with outputs.stdout_of_bytes() as stream:
            write.write(_EmptyFields(stream), found, format=kind)  # type: ignore[arg-type]
        return None
    with terminal.stage(f"writing {target.name}"), atomic.replacing(target) as stream:
        write.write(_EmptyFields(stream), found, format=kind)  # type: ignore[arg-type]
    return target
