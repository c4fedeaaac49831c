"""``liftmesh thin`` writes fewer rows of a cloud; other commands share its options."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.base.options import CellRow
from liftmesh.cli import inputs, notes, options, outputs, terminal
from liftmesh.cli.options import argument, flag, option, positive, whole

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

SHORT_HELP = "Thin a cloud and write the rows that stay."
HELP = (
    "At random, one of each cell, a distance apart, those without which most is lost, or those of "
    "tops without spikes."
)
EXAMPLES = [
    "liftmesh thin survey.laz few.laz --cell 0.5",
    "liftmesh thin dem.tif points.ply --adaptive 10000",
    "liftmesh thin forest.laz canopy.laz --returns first --spike-free 1",
]
_WAYS = "give one of --random, --cell, --min-distance, --adaptive and --spike-free"


def _thinning(
    random: Annotated[int | None, option("N", "Keep N rows, chosen at random.", whole(1))] = None,
    seed: Annotated[
        int | None,
        option("N", "Of --random, 0 by default; the same rows on every machine.", whole(0)),
    ] = None,
    cell: Annotated[
        float | None, option("SIZE", "Keep one row of each square of this size.", positive)
    ] = None,
    keep: Annotated[
        CellRow | None,
        flag("Of --cell: by height (lowest by default), or nearest to the center."),
    ] = None,
    min_distance: Annotated[
        float | None,
        option("D", "Keep rows of which no two are nearer to each other in the plane.", positive),
    ] = None,
    adaptive: Annotated[
        int | None, option("N", "Keep the N rows without which a surface loses most.", whole(3))
    ] = None,
    spike_free: Annotated[
        float | None,
        option("D", "Keep tops without spikes: none below triangles of shorter sides.", positive),
    ] = None,
    spike_buffer: Annotated[
        float | None,
        option("HEIGHT", "Of --spike-free: of a layer; by default half of it.", positive),
    ] = None,
) -> dict[str, Any]:
    """Check the options of thinning, and return those given, as `liftmesh.thin` has them."""
    thinning = options.given(random=random, cell=cell, min_distance=min_distance, adaptive=adaptive)
    thinning |= options.given(spike_free=spike_free)
    if len(thinning) > 1:
        raise click.BadParameter(_WAYS)
    if seed is not None and random is None:
        raise click.BadParameter("--seed is of --random only: give both, or neither")
    if keep is not None and cell is None:
        raise click.BadParameter("--keep is of --cell only: give both, or neither")
    if spike_buffer is not None and spike_free is None:
        raise click.BadParameter("--spike-buffer is of --spike-free only: give both, or neither")
    return thinning | options.given(seed=seed, keep=keep, spike_buffer=spike_buffer)


Thinning: TypeAlias = Annotated[dict[str, Any], options.Group(_thinning, "Selection")]
Target: TypeAlias = Annotated[outputs.Target, outputs.target("Cloud file; - writes stdout.")]


@outputs.guards("target")
def run(
    sources: Annotated[
        list[Path], argument("IN", "Clouds or rasters, merged; - reads stdin (see --input-format).")
    ],
    target: Target,
    *,
    thin: Annotated[dict[str, Any], options.Group(_thinning)],
    reading: inputs.AllColoredRows,
    json: options.Json = False,
) -> None:
    """Read a cloud, thin it, write what stays, and print a report."""
    if not thin and "every" not in reading:
        raise click.BadParameter(f"{_WAYS}, or --every")
    inputs.check_once(sources)
    target.check()
    start = perf_counter()
    cloud = inputs.read_rows(sources, reading, of_surface=False)
    with inputs.about_rows(sources, cloud):
        target.check_content(cloud)
        kept = thinned(cloud, thin)
    written = target.write(kept)
    told = {
        "thinning": notes.provenance_of(kept).thinning or None,
        "selection": notes.counts_of(cloud),
        "seconds": perf_counter() - start,
    }
    outputs.report(written, f"{len(kept):,} rows", told, as_json=json)


def thinned(cloud: Cloud, thinning: Mapping[str, Any]) -> Cloud:
    """Thin a cloud, and say on stderr how many rows stay."""
    if not thinning:
        return cloud
    from liftmesh.terrain.thinning import thin

    with terminal.stage(f"thinning {len(cloud):,} rows"):
        kept = thin(cloud, **thinning)
    told = notes.provenance_of(kept).thinning.items()
    how = ", ".join(f"{key} {value}" for key, value in told if key not in {"n_rows", "n_kept"})
    terminal.note(f"thinned to {len(kept):,} of {len(cloud):,} rows: {how}")
    if lost := notes.parts_not_read(kept)[len(notes.parts_not_read(cloud)) :]:
        terminal.note(f"thinned without {notes.listed([each.partition(' (')[0] for each in lost])}")
    return kept
