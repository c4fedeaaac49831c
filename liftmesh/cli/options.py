"""Options that several commands have, and groups of options that a command takes as one.

A parameter of a command that is annotated with a `Group` stands for all options of the function
that the group is parsed by. A group may hold groups. An option of the command's own takes the place
of one of that name in a group, which then has its default.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeAlias, get_args

import typer

from liftmesh.base.options import Duplicates as Policy, NonFinite
from liftmesh.cli import values


@dataclass(frozen=True)
class Group:
    """Says which function parses the options of a group to the value of a parameter."""

    parse: Callable[..., Any]


def with_single_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Give a function the options of its groups one by one, as typer knows them."""
    signature = inspect.signature(function, eval_str=True)
    groups = {
        each.name: with_single_options(kind.parse)
        for each in signature.parameters.values()
        for kind in get_args(each.annotation)
        if isinstance(kind, Group)
    }
    if not groups:
        return function
    own = signature.parameters.keys() - groups.keys()
    taken = {
        name: [each for each in _parameters(parse) if each.name not in own]
        for name, parse in groups.items()
    }
    single: list[inspect.Parameter] = []
    for each in signature.parameters.values():
        single += taken.get(each.name, [each])

    @wraps(function)
    def command(**options: Any) -> Any:
        for name, parse in groups.items():
            names = [each.name for each in taken[name] if each.name in options]
            options[name] = parse(**{each: options.pop(each) for each in names})
        return function(**options)

    return with_parameters(command, single)


def with_parameters(
    function: Callable[..., Any], parameters: list[inspect.Parameter]
) -> Callable[..., Any]:
    """State the parameters of a function that takes any."""
    named = [each.replace(kind=inspect.Parameter.KEYWORD_ONLY) for each in parameters]
    function.__signature__ = inspect.Signature(named)  # type: ignore[attr-defined]
    function.__annotations__ = {each.name: each.annotation for each in named}
    return function


def _parameters(function: Callable[..., Any]) -> list[inspect.Parameter]:
    return list(inspect.signature(function, eval_str=True).parameters.values())


def given(**options: Any) -> dict[str, Any]:
    """Return the options that were given: those that are neither None nor False."""
    return {name: each for name, each in options.items() if each is not None and each is not False}


Source: TypeAlias = Annotated[
    Path, typer.Argument(metavar="IN", help="Cloud or mesh; - reads stdin (see --from).")
]
SourceFormat: TypeAlias = Annotated[
    str | None,
    values.option("FORMAT", "Format of the input, instead of its suffix.", name="--from"),
]
TargetFormat: TypeAlias = Annotated[
    str | None,
    values.option("FORMAT", "Format of OUT, instead of its suffix.", name="--format"),
]
Plane: TypeAlias = Annotated[
    Any,
    values.option(
        "PLANE",
        "Projection plane: xy, xz, yz, fit (least squares), a normal NX,NY,NZ, A,B,C,D of the "
        "plane ax + by + cz + d = 0, or a file (text or .npy) with the rigid 4x4 matrix from space "
        "to plane coordinates.",
        values.plane,
    ),
]
Duplicates: TypeAlias = Annotated[
    Policy,
    typer.Option(help="Which of several rows at one planar position is used as the vertex."),
]
SkipNonFinite: TypeAlias = Annotated[
    NonFinite, typer.Option("--nonfinite", help="Policy for rows with NaN or infinity.")
]
Threads: TypeAlias = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        parser=values.threads,
        callback=values.checked_threads,
        help="Number of threads; by default LIFTMESH_NUM_THREADS, or one per core.",
    ),
]
MaxBytes: TypeAlias = Annotated[
    int | None,
    values.option(
        "SIZE",
        "Limit of what a compressed, instanced or very wide file may expand to in memory, as "
        "500M or 4G.",
        values.size,
    ),
]
ColorDepth: TypeAlias = Annotated[
    int | None,
    values.option(
        "BITS",
        "Bits per channel of integer colours, 8 or 16; by default their values decide.",
        values.color_depth,
    ),
]
Weights: TypeAlias = Annotated[
    str | None,
    values.option(
        "COLUMN",
        "Values of IN that are weights: makes the regular triangulation, the dual of the "
        "power diagram, which may hide rows.",
    ),
]
Radii: TypeAlias = Annotated[
    str | None,
    values.option("COLUMN", "The same with radii, whose squares are weights."),
]
Metric: TypeAlias = Annotated[
    Any,
    values.option(
        "A,B,C",
        "Triangulate in the metric a x^2 + 2 b xy + c y^2 of plane coordinates.",
        values.metric,
    ),
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def lifting(weights: str | None, radii: str | None, metric: Any) -> dict[str, Any]:
    """Return the option that says by what points are lifted, of which there may be one."""
    found = given(weights=weights, radii=radii, metric=metric)
    if len(found) > 1:
        raise typer.BadParameter(f"--{' and --'.join(found)} are given: give one of them")
    return found
