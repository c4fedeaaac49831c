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

from liftmesh.base.options import Duplicates as Policy, NonFinite, Returns
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
    typer.Option("--from", metavar="FORMAT", help="Format of the input, instead of its suffix."),
]
TargetFormat: TypeAlias = Annotated[
    str | None,
    typer.Option("--format", metavar="FORMAT", help="Format of OUT, instead of its suffix."),
]
Plane: TypeAlias = Annotated[
    Any,
    typer.Option(
        metavar="PLANE",
        parser=values.plane,
        help="Projection plane: xy, xz, yz, fit (least squares), a normal NX,NY,NZ, A,B,C,D of the "
        "plane ax + by + cz + d = 0, or a file (text or .npy) with the rigid 4x4 matrix from space "
        "to plane coordinates.",
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
    typer.Option(
        metavar="SIZE",
        parser=values.size,
        help="Limit of what a compressed, instanced or very wide file may expand to in memory, as "
        "500M or 4G.",
    ),
]
ColorDepth: TypeAlias = Annotated[
    int | None,
    typer.Option(
        metavar="BITS",
        parser=values.color_depth,
        help="Bits per channel of integer colours, 8 or 16; by default their values decide.",
    ),
]
Weights: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="COLUMN",
        help="Values of IN that are weights: makes the regular triangulation, the dual of the "
        "power diagram, which may hide rows.",
    ),
]
Radii: TypeAlias = Annotated[
    str | None,
    typer.Option(metavar="COLUMN", help="The same with radii, whose squares are weights."),
]
Metric: TypeAlias = Annotated[
    Any,
    typer.Option(
        metavar="A,B,C",
        parser=values.metric,
        help="Triangulate in the metric a x^2 + 2 b xy + c y^2 of plane coordinates.",
    ),
]
Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def lifting(weights: str | None, radii: str | None, metric: Any) -> dict[str, Any]:
    """Return the option that says by what points are lifted, of which there may be one."""
    found = given(weights=weights, radii=radii, metric=metric)
    if len(found) > 1:
        raise typer.BadParameter(f"--{' and --'.join(found)} are given: give one of them")
    return found


def table(
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Tables: the columns, as x=East,y=North,z=H (z=-Depth for depths), or the names "
            "of all in order, as id,x,y,z; - leaves one out.",
        ),
    ] = None,
    flat: Annotated[
        bool, typer.Option("--flat", help="Tables: heights do not matter; z is 0.")
    ] = False,
    delimiter: Annotated[
        str | None,
        typer.Option(metavar="MARK", help="Tables: what separates values, as ';', tab or space."),
    ] = None,
    decimal: Annotated[
        str | None, typer.Option(metavar="MARK", help="Tables: the decimal mark, . or ,")
    ] = None,
    skip_rows: Annotated[
        int,
        typer.Option(metavar="N", parser=values.count(0), help="Tables: skip the first N lines."),
    ] = 0,
    no_header: Annotated[
        bool, typer.Option("--no-header", help="Tables: the first line is a row.")
    ] = False,
    nodata: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE",
            help="Tables and rasters: what stands for a missing value, as -9999; none if nothing "
            "does.",
        ),
    ] = None,
    end: Annotated[
        str | None, typer.Option(metavar="LINE", help="Tables: the line that ends them, as END.")
    ] = None,
    encoding: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Tables: the encoding of the text, as cp1252, if not UTF."
        ),
    ] = None,
) -> dict[str, Any]:
    """Check the options of tables, and return those given, as `liftmesh.read` has them."""
    found = given(columns=columns, delimiter=delimiter, decimal=decimal, nodata=nodata)
    found |= given(end=end, encoding=encoding, flat=flat)
    found |= {"header": False} if no_header else {}
    found |= given(skip_rows=skip_rows or None)
    if found:
        from liftmesh.io.formats.text.options import validate_table_options  # noqa: PLC0415 - as below

        with values.as_option():
            validate_table_options(**found)
    return found


def _selection(
    classes: Annotated[
        Any,
        typer.Option(
            metavar="CLASSES",
            parser=values.classes,
            help="Rows of these classes, as 2,9; ground (class 2 if there is any); or all.",
        ),
    ] = None,
    returns: Annotated[
        Returns | None,
        typer.Option(help="Rows of the last or the first return, or of those that are both."),
    ] = None,
    bbox: Annotated[
        Any,
        typer.Option(
            metavar="X0,Y0,X1,Y1",
            parser=values.ends,
            help="Rows inside a rectangle, or on its border.",
        ),
    ] = None,
    z_range: Annotated[
        Any,
        typer.Option(metavar="Z0,Z1", parser=values.ends, help="Rows of these heights."),
    ] = None,
    every: Annotated[
        int,
        typer.Option(
            metavar="N", parser=values.count(1), help="Every n-th of the rows that are left."
        ),
    ] = 1,
    withheld: Annotated[
        bool, typer.Option("--withheld", help="Rows flagged as withheld, too.")
    ] = False,
    resolution: Annotated[
        float | None,
        typer.Option(
            metavar="D",
            parser=values.positive,
            help="Of a COPC file, points at about this distance.",
        ),
    ] = None,
    band: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            parser=values.count(1),
            help="Rasters: the band that holds the heights; the first is 1.",
        ),
    ] = None,
    from_crs: Annotated[
        str | None,
        typer.Option(
            metavar="CRS",
            help="The coordinate system of the file, as EPSG:25832, in place of what it states; of "
            "several, of those that state none, or the same without heights.",
        ),
    ] = None,
    to_crs: Annotated[
        str | None,
        typer.Option(
            metavar="CRS", help="Transform the coordinates to this system, as EPSG:25832."
        ),
    ] = None,
) -> dict[str, Any]:
    """Check the conditions on rows, and return those given, with where the rows are read to."""
    found = given(classes=classes, returns=returns, bbox=bbox, z_range=z_range)
    found |= given(every=every if every > 1 else None, withheld=withheld, resolution=resolution)
    if found:
        from liftmesh.io.selection import validate_selection  # noqa: PLC0415 - most runs do without

        with values.as_option():
            validate_selection(**found)
    return found | given(to_crs=to_crs, crs=from_crs, band=band)


Table: TypeAlias = Annotated[dict[str, Any], Group(table)]
Selection: TypeAlias = Annotated[dict[str, Any], Group(_selection)]
