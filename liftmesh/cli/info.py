"""``liftmesh info``: summary of the contents of a file."""

from __future__ import annotations

import math
from dataclasses import asdict
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.cli import inputs, notes, options, outputs, terminal

if TYPE_CHECKING:
    from liftmesh.cli.summary import Summary

_SHORT = 20  # characters beyond the name, of a text that is a number rather than WKT
_MOST_DECIMALS = 12

SHORT_HELP = "Summarise a cloud or mesh."
HELP = (
    "Prints the number of rows, extent, spacing, duplicates and overhangs, whether float32 is "
    "accurate enough, whether a triangle exists, and the memory that triangulation needs."
)
EXAMPLES = ["liftmesh info cloud.ply", "liftmesh info lidar.csv --json"]


def run(
    source: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Cloud or mesh; - reads stdin (see --input-format)."),
    ],
    input_format: options.InputFormat = None,
    *,
    rows: inputs.RowOptions,
    max_bytes: options.MaxBytes = None,
    json: options.Json = False,
) -> None:
    """Read a file and print its summary."""
    outputs.check_stdout()
    reading = {**rows, "format": input_format, "max_bytes": max_bytes}
    cloud = inputs.read(source, reading)
    from liftmesh.cli.summary import summarise

    with terminal.stage(f"summarising {len(cloud):,} rows"):
        summary = summarise(cloud)
    if json:
        derived = ("extent", "offset", "float32_is_enough")
        terminal.as_json(asdict(summary) | {name: getattr(summary, name) for name in derived})
    else:
        terminal.table(_lines(summary))


def _lines(summary: Summary) -> list[tuple[str, str]]:
    lines = [("rows", f"{summary.rows:,}" + _count_note(summary.not_finite, "not finite"))]
    if summary.faces:
        lines.append(("faces", f"{summary.faces:,}"))
    lines.append(("holds", ", ".join(("coordinates", *summary.holds))))
    if summary.columns:
        pairs = (f"{part} = {name}" for part, name in summary.columns.items())
        lines.append(("columns", ", ".join(pairs)))
    lines += notes.lidar_lines(summary.lidar)
    if summary.raster:
        lines.append(("raster", _samples(summary.raster)))
    if summary.crs is not None:
        lines.append(("crs", _system(summary.crs)))
    elif summary.lidar.get("scale") or summary.raster:  # formats that have a place for one
        lines.append(("crs", "not stated"))
    if summary.units:
        axes = zip("xyz", summary.units, strict=True)
        lines.append(("units", ", ".join(f"{axis}: {unit or 'not stated'}" for axis, unit in axes)))
    if summary.positions:
        lines += _measures(summary)
    memory = terminal.bytes_text(summary.memory)
    return [*lines, ("memory", f"about {memory} to triangulate")]


def _system(crs: str) -> str:
    """Name a coordinate system that is WKT; --json has the text."""
    from liftmesh.crs.description import parse_crs

    system = parse_crs(crs)
    if system is None:
        return crs
    number = f"{crs}, " if len(crs) < len(system.name) + _SHORT else ""
    return f"{number}{system.name} ({system.kind})"


def _samples(raster: dict[str, Any]) -> str:
    """Say how many samples a raster has, and how far apart they are."""
    a, b, _, d, e, _ = raster["transform"]
    across, down = math.hypot(a, d), math.hypot(b, e)
    turned = ", turned" if b or d else ""
    return (
        f"{raster['width']:,} x {raster['height']:,} samples, "
        f"{across:.6g} x {down:.6g} apart{turned}"
    )


def _measures(summary: Summary) -> list[tuple[str, str]]:
    shown = [f".{each}f" for each in map(_decimals, summary.lidar.get("scale", ()))] or [".10g"] * 3
    axes = zip("xyz", summary.minimum, summary.maximum, summary.extent, shown, strict=True)
    return [
        *((k, f"{low:{form}} to {high:{form}}  ({size:.6g})") for k, low, high, size, form in axes),
        ("spacing", _spacing(summary)),
        ("duplicates", f"{summary.duplicates:,}"),
        ("overhangs", f"{summary.overhangs:,}"),
        ("collinear", _collinear(summary)),
        ("offset", f"{summary.offset:.6g}  (centre to origin)"),
        ("float32", _float32(summary)),
    ]


def _decimals(scale: float) -> int:
    """Count the decimals that multiples of a scale have."""
    exponent = Decimal(f"{scale:.6g}").normalize().as_tuple().exponent
    return min(max(0, -int(exponent)), _MOST_DECIMALS)


def _count_note(count: int, what: str) -> str:
    return f", {count:,} {what}" if count else ""


def _spacing(summary: Summary) -> str:
    if summary.spacing is None:
        return "none: one position"
    return f"{summary.spacing:.6g}  (median distance to the nearest neighbour)"


def _float32(summary: Summary) -> str:
    if summary.float32_shift == 0:
        return "enough: holds every coordinate exactly"
    if math.isinf(summary.float32_shift):
        return "not enough: coordinates overflow"
    change = f"changes coordinates by up to {summary.float32_shift:.3g}"
    if summary.spacing:
        change += f", {summary.float32_shift / summary.spacing:.2g} of the spacing"
    return f"enough: {change}" if summary.float32_is_enough else f"not enough: {change}"


def _collinear(summary: Summary) -> str:
    if not summary.collinear:
        return "no"
    reason = "all points are collinear" if summary.positions > 2 else "fewer than three positions"
    return f"yes: no triangle exists, {reason}"
