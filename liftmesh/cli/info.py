"""``liftmesh info``: what is in a file, and what to expect of it."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from liftmesh.cli import files, options, terminal

if TYPE_CHECKING:
    from liftmesh.cli.facts import Facts

SHORT_HELP = "Tell what a cloud or mesh holds."
HELP = (
    "Rows, extent, spacing, duplicates, overhangs, whether float32 is enough, whether a triangle "
    "exists, and the memory that triangulating takes."
)
EXAMPLES = ["liftmesh info cloud.ply", "liftmesh info lidar.csv --json"]


def run(
    source: Annotated[
        Path, typer.Argument(metavar="FILE", help="Cloud or mesh; - reads stdin (see --from).")
    ],
    source_format: options.SourceFormat = None,
    json: options.Json = False,
) -> None:
    """Read a file and print its facts.

    Parameters
    ----------
    source : Path
        FILE.
    source_format : str, optional
        Format, in place of the suffix.
    json : bool
        Print JSON.
    """
    cloud = files.read(source, source_format)
    from liftmesh.cli.facts import gather  # noqa: PLC0415 - help and --version do without

    with terminal.stage(f"measuring {len(cloud):,} rows"):
        facts = gather(cloud)
    if json:
        derived = ("extent", "offset", "float32_is_enough")
        terminal.as_json(asdict(facts) | {name: getattr(facts, name) for name in derived})
    else:
        terminal.table(_lines(facts))


def _lines(facts: Facts) -> list[tuple[str, str]]:
    lines = [("rows", f"{facts.rows:,}" + _noted(facts.not_finite, "not finite"))]
    if facts.faces:
        lines.append(("faces", f"{facts.faces:,}"))
    lines.append(("holds", ", ".join(("coordinates", *facts.holds))))
    if facts.positions:
        lines += _measures(facts)
    memory = terminal.bytes_text(facts.memory)
    return [*lines, ("memory", f"about {memory} to triangulate")]


def _measures(facts: Facts) -> list[tuple[str, str]]:
    axes = zip("xyz", facts.minimum, facts.maximum, facts.extent, strict=True)
    return [
        *((axis, f"{low:.10g} to {high:.10g}  ({size:.6g})") for axis, low, high, size in axes),
        ("spacing", _spacing(facts)),
        ("duplicates", f"{facts.duplicates:,}"),
        ("overhangs", f"{facts.overhangs:,}"),
        ("collinear", _collinear(facts)),
        ("offset", f"{facts.offset:.6g}  (centre to origin)"),
        ("float32", _float32(facts)),
    ]


def _noted(count: int, what: str) -> str:
    return f", {count:,} {what}" if count else ""


def _spacing(facts: Facts) -> str:
    if facts.spacing is None:
        return "none: one position"
    return f"{facts.spacing:.6g}  (median distance to the nearest neighbour)"


def _float32(facts: Facts) -> str:
    if facts.float32_shift == 0:
        return "enough: holds every coordinate exactly"
    if math.isinf(facts.float32_shift):
        return "not enough: coordinates overflow"
    moved = f"moves coordinates by up to {facts.float32_shift:.3g}"
    if facts.spacing:
        moved += f", {facts.float32_shift / facts.spacing:.2g} of the spacing"
    return f"enough: {moved}" if facts.float32_is_enough else f"not enough: {moved}"


def _collinear(facts: Facts) -> str:
    if not facts.collinear:
        return "no"
    reason = "all points lie on one line" if facts.positions > 2 else "it needs three points"
    return f"yes: there is no triangle, {reason}"
