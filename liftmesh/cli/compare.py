"""``liftmesh compare``: comparison of liftmesh's lower hull with trimesh's convex hull."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import click

from liftmesh.cli import exit_codes, inputs, notes, options, outputs, terminal
from liftmesh.cli.options import option, whole

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.comparison.report import Comparison

SHORT_HELP = "Compare liftmesh's triangles with trimesh's convex hull."
HELP = (
    "trimesh's hull (Qhull) is built from the same lifted points, and its lower facets are matched "
    "with the triangles. Inside exactly cocircular cells both results are correct; all other "
    "differences are errors, reported with exact proofs and exit code 1."
)
EXAMPLES = [
    "liftmesh compare cloud.ply",
    "liftmesh compare cloud.ply --lower lower.ply --hull hull.ply",
    "liftmesh compare utm.csv --apex origin --proofs 3",
]


@outputs.guards("lower", "hull", prints=True)
def run(
    source: options.Source,
    apex: options.Apex = "median",
    lower: Annotated[
        Path | None, option("FILE", "Write liftmesh's lower hull of the lifted points.")
    ] = None,
    hull: Annotated[Path | None, option("FILE", "Write trimesh's convex hull of them.")] = None,
    proofs: Annotated[int, option("N", "Maximum number of proofs to print.", whole(0))] = 4,
    plane: options.Plane = "xy",
    *,
    reading: inputs.Reading,
    nonfinite: options.SkipNonFinite = "error",
    json: options.Json = False,
) -> None:
    """Compare the hulls, write the requested files, and print the result."""
    for each in (lower, hull):
        if each is not None:
            outputs.Target(each).check()
    cloud = inputs.read_rows([source], reading)
    with inputs.about(source):
        result = _compare(
            cloud, apex=apex, plane=plane.value, nonfinite=nonfinite, max_proofs=proofs
        )
    if lower is not None:
        outputs.Target(lower).write(result.lower_hull())
    if hull is not None and result.error is None:
        outputs.Target(hull).write(result.trimesh_hull())
    with outputs.after_writing(lower, None if result.error else hull):
        if json:
            terminal.as_json(_values(result) | notes.provenance(cloud))
        else:
            _print_result(result, hull)
    if not result.agrees:
        raise click.exceptions.Exit(exit_codes.DIFFERENT)


def _compare(cloud: Cloud, **choices: Any) -> Comparison:
    import liftmesh

    with terminal.stage(f"comparing {len(cloud):,} rows with trimesh's convex hull"):
        return liftmesh.compare(cloud, **choices)


def _print_result(result: Comparison, hull: Path | None) -> None:
    style = "good" if result.agrees else "bad"
    styles = {"really different": style}
    terminal.table(result.table(), header=("", "liftmesh", "trimesh"), styles=styles)
    terminal.blank()
    terminal.sentence(result.conclusion(), style)
    if hull is not None and result.error is not None:
        terminal.sentence(f"{hull} was not written.", style)
    for proof in result.proofs:
        terminal.item(str(proof))


def _values(result: Comparison) -> dict[str, Any]:
    return {
        "verdict": result.verdict,
        "error": result.error,
        "apex": list(result.apex),
        "n_triangles": result.n_triangles,
        "n_lower_facets": len(result.lower),
        "n_hull_facets": len(result.hull),
        "n_vertical_facets": result.n_vertical,
        "n_identical": result.n_identical,
        "n_cocircular": result.n_cocircular,
        "n_cells": result.n_cells,
        "n_missing": len(result.missing),
        "n_wrong": len(result.wrong),
        "n_lost": len(result.lost),
        "lost_rows": result.lost[:1000].tolist(),
        "n_coincident": result.n_coincident,
        "n_violations": result.n_violations,
        "seconds": dict(result.seconds),
        "proofs": [
            {
                "claim": proof.claim,
                "rows": list(proof.rows),
                "determinants": [[row, str(value)] for row, value in proof.determinants],
                "tested": proof.tested,
                "text": str(proof),
            }
            for proof in result.proofs
        ],
    }
