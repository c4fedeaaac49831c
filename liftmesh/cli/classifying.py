"""``--ground``: the ground of a cloud without classes, found before it is triangulated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liftmesh.base.options import GroundMethod
from liftmesh.cli import groups
from liftmesh.cli.files import without_warnings
from liftmesh.cli.options import parse_length
from liftmesh.cli.terminal import note, stage
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_GROUND = 2  # not "ground", which takes all rows where there is none

_NO_UNIT = "; the unit is not known, and taken to be metres"
_UNITS = {  # what is said where that of the plane and that of heights are known
    (True, True): "", (False, True): _NO_UNIT, (False, False): _NO_UNIT,
    (True, False): "; the unit of z is not stated, and taken to be that of x",
}  # fmt: skip


def parse(
    ground: Annotated[
        GroundMethod | None,
        typer.Option(help="Find the ground of an unclassified cloud, by the cloth simulation CSF."),
    ] = None,
    cloth_resolution: Annotated[
        str | None,
        typer.Option(
            metavar="METRES",
            help="Of --ground: between the nodes of the cloth; default: 0.5.",
        ),
    ] = None,
    cloth_rigidness: Annotated[
        str | None,
        typer.Option(
            metavar="N",
            help="Of --ground: 1 for steep slopes, 2, or 3 for flat terrain; default: 2.",
        ),
    ] = None,
    cloth_threshold: Annotated[
        str | None,
        typer.Option(
            metavar="METRES",
            help="Of --ground: rows nearer to the cloth are ground; default: 0.5.",
        ),
    ] = None,
) -> dict[str, Any]:
    """Check the options, and return those that were given."""
    found: dict[str, Any] = {}
    for name, text in (("resolution", cloth_resolution), ("threshold", cloth_threshold)):
        found |= {} if text is None else {name: parse_length(f"--cloth-{name}", text)}
    if cloth_rigidness is not None:
        if cloth_rigidness not in {"1", "2", "3"}:
            raise typer.BadParameter(f"--cloth-rigidness {cloth_rigidness!r} is not 1, 2 or 3")
        found["rigidness"] = int(cloth_rigidness)
    if found and ground is None:
        raise typer.BadParameter(f"--cloth-{next(iter(found))} is an option of --ground csf")
    return {} if ground is None else {"method": ground, **found}


def parted(selection: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Part the conditions on rows: classes count only once there are some."""
    later = {"classes": selection.get("classes", _GROUND)}
    return {**selection, "classes": "all"}, later


def classified(cloud: Cloud, ground: Mapping[str, Any], selection: Mapping[str, Any]) -> Cloud:
    """Classify a cloud and select the ground; say on stderr what was found."""
    from liftmesh.io.selection import Selector, selected, validate_selection  # noqa: PLC0415 - help does without
    from liftmesh.terrain.ground import bare_warning, classify_ground  # noqa: PLC0415 - as above

    with stage(f"finding the ground among {len(cloud):,} rows"):
        try:
            with without_warnings():
                found = classify_ground(cloud, **ground)
        except InputError as error:
            said = str(error).replace("resolution= to classify_ground", "--cloth-resolution")
            error.args = (said,)
            raise
    counts = found.metadata["ground"]
    if not counts["ground"]:
        raise InputError(f"{counts['method']} finds no ground among {counts['rows']:,} rows")
    unit = _UNITS[counts["unit_known"], counts["z_unit_known"]]
    note(
        f"ground by {counts['method']}: {counts['ground']:,} of {counts['rows']:,} rows (cloth of "
        f"{counts['resolution']:g} m, rigidness {counts['rigidness']}{unit}); where ground is "
        "sparse, it may hold low vegetation and roofs"
    )
    if lost := bare_warning(counts):
        remedy = ("a smaller resolution= to classify_ground, or rigidness=1",)
        note(lost.replace(*remedy, "a smaller --cloth-resolution, or --cloth-rigidness 1"))
    chosen = validate_selection(**selection)
    found = found if chosen is None else selected(found, Selector(chosen, "the cloud"))
    if not len(found):
        raise InputError(f"none of {counts['rows']:,} rows has one of these classes")
    return found


with_options = groups.taking("ground", parse)
