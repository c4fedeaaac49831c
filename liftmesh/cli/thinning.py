"""The options that thin a cloud before it is triangulated: `liftmesh.thin` knows them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import CellRow
from liftmesh.cli import groups
from liftmesh.cli.options import parse_count, parse_length
from liftmesh.cli.terminal import note, stage

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


def parse_thinning(
    random: Annotated[
        str | None, typer.Option(metavar="N", help="Thin: n rows, chosen at random.")
    ] = None,
    seed: Annotated[
        str | None,
        typer.Option(
            metavar="N", help="Of --random, 0 by default; the same rows on every machine."
        ),
    ] = None,
    cell: Annotated[
        str | None,
        typer.Option(metavar="SIZE", help="Thin: one row of each square of this size."),
    ] = None,
    keep: Annotated[
        CellRow | None,
        typer.Option(help="Of --cell: by height (lowest by default), or nearest to the centre."),
    ] = None,
    distance: Annotated[
        str | None,
        typer.Option(
            "--min-distance",
            metavar="D",
            help="Thin: rows of which no two are nearer to each other in the plane.",
        ),
    ] = None,
    adaptive: Annotated[
        str | None,
        typer.Option(metavar="N", help="Thin: the n rows without which a surface loses most."),
    ] = None,
) -> dict[str, Any]:
    """Check the options, and return those that were given."""
    found: dict[str, Any] = {}
    if random is not None:
        found |= {"random": parse_count("--random", random, 1)}
    found |= {} if cell is None else {"cell": parse_length("--cell", cell)}
    found |= {} if distance is None else {"distance": parse_length("--min-distance", distance)}
    if adaptive is not None:
        found |= {"adaptive": parse_count("--adaptive", adaptive, 3)}
    if len(found) > 1:
        message = "give one of --random, --cell, --min-distance and --adaptive"
        raise typer.BadParameter(message)
    if seed is not None:
        if "random" not in found:
            raise typer.BadParameter("--seed is of --random only: give both, or neither")
        found["seed"] = parse_count("--seed", seed, 0)
    if keep is not None:
        if "cell" not in found:
            raise typer.BadParameter("--keep is of --cell only: give both, or neither")
        found["keep"] = keep
    return found


def thinned(cloud: Cloud, options: Mapping[str, Any]) -> Cloud:
    """Thin a cloud, and say on stderr how many rows stay."""
    if not options:
        return cloud
    from liftmesh.terrain.thinning import thin  # noqa: PLC0415 - help and --version do without

    with stage(f"thinning {len(cloud):,} rows"):
        found = thin(cloud, **options)
    told = found.metadata["thinning"].items()
    how = ", ".join(f"{key} {value}" for key, value in told if key not in {"rows", "kept"})
    note(f"thinned to {len(found):,} of {len(cloud):,} rows: {how}")
    return found


with_thinning = groups.taking("thin", parse_thinning)
