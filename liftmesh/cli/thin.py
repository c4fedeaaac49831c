"""``liftmesh thin``: fewer rows of a cloud, in a file of their own; and how others thin theirs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liftmesh.base.options import CellRow
from liftmesh.cli import inputs, notes, options, outputs, terminal
from liftmesh.cli.options import option, positive, whole

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

SHORT_HELP = "Thin a cloud and write the rows that stay."
HELP = "At random, one of each cell, a distance apart, or those without which most is lost."
EXAMPLES = [
    "liftmesh thin survey.laz few.laz --cell 0.5",
    "liftmesh thin dem.tif points.ply --adaptive 10000",
]
_WAYS = "give one of --random, --cell, --min-distance and --adaptive"


def _thinning(
    random: Annotated[int | None, option("N", "Thin: n rows, chosen at random.", whole(1))] = None,
    seed: Annotated[
        int | None,
        option("N", "Of --random, 0 by default; the same rows on every machine.", whole(0)),
    ] = None,
    cell: Annotated[
        float | None, option("SIZE", "Thin: one row of each square of this size.", positive)
    ] = None,
    keep: Annotated[
        CellRow | None,
        typer.Option(help="Of --cell: by height (lowest by default), or nearest to the centre."),
    ] = None,
    min_distance: Annotated[
        float | None,
        option("D", "Thin: rows of which no two are nearer to each other in the plane.", positive),
    ] = None,
    adaptive: Annotated[
        int | None, option("N", "Thin: the n rows without which a surface loses most.", whole(3))
    ] = None,
) -> dict[str, Any]:
    """Check the options of thinning, and return those given, as `liftmesh.thin` has them."""
    thinning = options.given(random=random, cell=cell, min_distance=min_distance, adaptive=adaptive)
    if len(thinning) > 1:
        raise typer.BadParameter(_WAYS)
    if seed is not None and random is None:
        raise typer.BadParameter("--seed is of --random only: give both, or neither")
    if keep is not None and cell is None:
        raise typer.BadParameter("--keep is of --cell only: give both, or neither")
    return thinning | options.given(seed=seed, keep=keep)


Thinning: TypeAlias = Annotated[dict[str, Any], options.Group(_thinning)]


@outputs.guards("target")
def run(
    sources: Annotated[
        list[Path],
        typer.Argument(
            metavar="IN", help="Clouds or rasters, merged; - reads stdin (see --input-format)."
        ),
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="Cloud file; - writes stdout.")],
    input_format: options.InputFormat = None,
    output_format: options.OutputFormat = None,
    *,
    rows: inputs.RowOptions,
    thin: Thinning,
    max_bytes: options.MaxBytes = None,
    color_depth: options.ColorDepth = None,
    writing: outputs.Writing,
    json: options.Json = False,
) -> None:
    """Read a cloud, thin it, write what stays, and print a report."""
    if not thin and "every" not in rows:
        raise typer.BadParameter(f"{_WAYS}, or --every")
    if json:
        outputs.check_stdout()
    inputs.check_once(sources)
    outputs.check_target(target, output_format, writing)
    start = perf_counter()
    reading = {**rows, "format": input_format, "max_bytes": max_bytes}
    reading |= {"color_depth": color_depth}
    cloud = inputs.read_rows(sources, reading, of_surface=False)
    with inputs.about_rows(sources, cloud):
        outputs.check_content(target, output_format, cloud, writing)
        kept = thinned(cloud, thin)
    written = outputs.write(target, kept, output_format, writing)
    told = {
        **outputs.as_values(written),
        "thinning": notes.provenance_of(kept).thinning or None,
        "selection": notes.counts_of(cloud),
        "seconds": perf_counter() - start,
    }
    with outputs.report_after(target):
        if json:
            terminal.as_json(told)
        else:
            terminal.sentence(outputs.headline(written, f"{len(kept):,} rows"), "good")


def thinned(cloud: Cloud, thinning: Mapping[str, Any]) -> Cloud:
    """Thin a cloud, and say on stderr how many rows stay."""
    if not thinning:
        return cloud
    from liftmesh.terrain.thinning import thin

    with terminal.stage(f"thinning {len(cloud):,} rows"):
        kept = thin(cloud, **thinning)
    told = notes.provenance_of(kept).thinning.items()
    how = ", ".join(f"{key} {value}" for key, value in told if key not in {"rows", "kept"})
    terminal.note(f"thinned to {len(kept):,} of {len(cloud):,} rows: {how}")
    return kept
