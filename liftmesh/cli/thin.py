"""``liftmesh thin``: fewer rows of a cloud, in a file of their own."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Annotated, Any

import typer

from liftmesh.cli import (
    files,
    inputs,
    options,
    outputs,
    overwriting,
    rows,
    standard_streams,
    tables,
    terminal,
    thinning,
)

SHORT_HELP = "Thin a cloud and write the rows that stay."
HELP = "At random, one of each cell, a distance apart, or those without which most is lost."
EXAMPLES = [
    "liftmesh thin survey.laz few.laz --cell 0.5",
    "liftmesh thin dem.tif points.ply --adaptive 10000",
]


@overwriting.guards("target")
@tables.with_options
@rows.with_options
@thinning.with_thinning
@outputs.with_options
def run(
    sources: Annotated[
        list[Path],
        typer.Argument(metavar="IN", help="Clouds or rasters, merged; - reads stdin (see --from)."),
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="Cloud file; - writes stdout.")],
    source_format: options.SourceFormat = None,
    target_format: options.TargetFormat = None,
    table: Any = None,
    selection: Any = None,
    thin: Any = None,
    max_bytes: options.MaxBytes = None,
    color_depth: options.ColorDepth = None,
    writing: Any = None,
    json: options.Json = False,
) -> None:
    """Read a cloud, thin it, write what stays, and print a report."""
    if not thin and "every" not in selection:
        ways = "give one of --random, --cell, --min-distance and --adaptive"
        raise typer.BadParameter(f"{ways}, or --every")
    if json:
        standard_streams.check_stdout()
    depth, limit = options.parse_color_depth(color_depth), options.parse_size(max_bytes)
    inputs.check_once(sources)
    files.check_target(target, target_format)
    outputs.check_options(target, target_format, writing)
    start = perf_counter()
    read = partial(files.read, file_format=source_format, max_bytes=limit, table=table)
    cloud = inputs.merged(sources, partial(read, color_depth=depth), selection)
    with inputs.about(sources, cloud):
        files.check_content(target, target_format, cloud, writing)
        kept = thinning.thinned(cloud, thin)
    written = outputs.write(target, kept, target_format, writing)
    told = {
        **outputs.values(written),
        "thinning": kept.metadata.get("thinning"),
        "selection": files.counts_of(cloud),
        "seconds": perf_counter() - start,
    }
    is_stdout = files.is_stream(target)
    place = redirect_stdout(sys.stderr) if is_stdout else standard_streams.dispensable_stdout()
    with place, standard_streams.after_writing(written.path):
        if json:
            terminal.as_json(told)
            return
        terminal.sentence(outputs.headline(written, f"{len(kept):,} rows"), "good")
