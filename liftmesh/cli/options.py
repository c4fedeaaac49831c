"""Options of commands: how their values are parsed, those that several have, and groups of them.

*Values.* click calls a parser with what was typed, before the command runs. What a parser refuses,
or the library of values that were parsed, is told as wrong usage (`as_usage`). Parsers name the
option `VALUE`.

*Groups.* A parameter of a command that is annotated with a `Group` stands for all options of the
function that the group is parsed by. A group may hold groups.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, NamedTuple, TypeAlias, get_args

from liftmesh.base.options import (
    MOST_THREADS,
    NonFinite,
    OnDuplicate as Policy,
    as_count,
    as_distance,
    as_number,
    as_positive,
    as_threads,
    refused,
)
from liftmesh.cli.wording import VALUE
from liftmesh.errors import InputError, Option

PANELS = ("Arguments", "Options", "Input", "Selection", "Lines", "Output", "Advanced")
"""Parts of the help of a command, in this order."""


@dataclass(frozen=True)
class Spec:
    """What is said of an argument or an option, beside its name, its type and its default."""

    text: str
    metavar: str = ""
    parser: Callable[[str], Any] | None = None  # where its type is not
    check: Callable[[Any], Any] | None = None  # also of the default
    panel: str = ""
    is_argument: bool = False


def option(
    metavar: str, text: str, parser: Callable[[str], Any] | None = None, *, panel: str = ""
) -> Spec:
    """Describe an option with a value, which a parser converts."""
    return Spec(text, metavar, parser, panel=panel)


def flag(text: str, *, panel: str = "") -> Spec:
    """Describe an option without a value, or whose values say all."""
    return Spec(text, panel=panel)


def argument(metavar: str, text: str) -> Spec:
    """Describe an argument."""
    return Spec(text, metavar, is_argument=True)


@dataclass(frozen=True)
class Group:
    """Says which function parses the options of a group to the value of a parameter."""

    parse: Callable[..., Any]
    panel: str = "Options"  # of those of the group that name no other
    texts: Mapping[str, str] = field(default_factory=dict)  # by name, in place of their own


def with_single_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Give a function the options of its groups one by one."""
    single: list[inspect.Parameter] = []
    groups: dict[str, tuple[Callable[..., Any], list[str]]] = {}
    for each in _parameters(function):
        spec = get_args(each.annotation)[1]
        if not isinstance(spec, Group):
            single.append(each)
            continue
        parse = with_single_options(spec.parse)
        inner = [_in_group(one, spec) for one in _parameters(parse)]
        groups[each.name] = parse, [one.name for one in inner]
        single += inner
    if not groups:
        return function

    @wraps(function)
    def command(**options: Any) -> Any:
        for name, (parse, names) in groups.items():
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


def parameter(name: str, kind: Any, spec: Spec, default: Any = None) -> inspect.Parameter:
    """Make a parameter with this annotation."""
    annotation = Annotated[kind, spec]
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation
    )


def _parameters(function: Callable[..., Any]) -> list[inspect.Parameter]:
    return list(inspect.signature(function, eval_str=True).parameters.values())


def _in_group(each: inspect.Parameter, group: Group) -> inspect.Parameter:
    kind, spec = get_args(each.annotation)
    text = group.texts.get(each.name, spec.text)
    spec = replace(spec, panel=spec.panel or group.panel, text=text)
    return each.replace(annotation=Annotated[kind, spec])


def given(**options: Any) -> dict[str, Any]:
    """Return the options that were given: those that are neither None nor False."""
    return {name: each for name, each in options.items() if each is not None and each is not False}


@contextmanager
def as_usage() -> Iterator[None]:
    """Tell what the library refuses as wrong usage."""
    try:
        yield
    except InputError as error:
        import click  # `liftmesh doctor` does without

        raise click.BadParameter(error.message) from error


def whole(least: int) -> Callable[[str], int]:
    """Make a parser of whole numbers from a least one."""
    return lambda text: as_count(VALUE, _digits(text), least)


def number(text: str) -> float:
    """Parse a finite number."""
    return as_number(VALUE, _number(text))


def positive(text: str) -> float:
    """Parse a positive number."""
    return as_positive(VALUE, _number(text))


def distance(text: str) -> float:
    """Parse a number that is not below zero."""
    return as_distance(VALUE, _number(text))


def numbers(text: str) -> list[float]:
    """Parse finite numbers separated by commas."""
    return [number(word) for word in text.split(",")]


def origin(text: str) -> str | list[float]:
    """Parse a place of three numbers, or the word for one that is chosen."""
    return text if text == "center" else numbers(text)


def ends(text: str) -> list[float]:
    """Parse numbers separated by commas that bound something, which may be infinite."""
    return [as_number(VALUE, _number(word), "a number", _is_end) for word in text.split(",")]


def _is_end(value: float) -> bool:
    return not math.isnan(value)


def box(text: str) -> tuple[float, ...] | None:
    """Parse a box of four numbers separated by commas; None if the text is something else."""
    return _exactly(4, text)


def classes(text: str) -> str | list[int]:
    """Parse classes of rows."""
    if text == "ground":
        return text
    if text == "all":
        raise refused(VALUE, text, "give --all-classes")
    words = text.split(",")
    if not all(word.strip().isdecimal() and len(word) < 9 for word in words):
        raise refused(VALUE, text, "give ground, or numbers as 2,9")
    return [int(word) for word in words]


def size(text: str) -> int:
    """Parse a number of bytes."""
    match = re.fullmatch(r"([0-9]{1,18})([kMGT]?)B?", text, re.IGNORECASE)
    value = 0 if match is None else int(match[1]) * 1000 ** " KMGT".index(match[2].upper() or " ")
    if not value:
        raise refused(VALUE, text, "give a size, as 500M or 4G")
    return value


def threads(text: str) -> int:
    """Parse a number of threads."""
    return as_count("threads", _digits(text), 1, MOST_THREADS)


def checked_threads(value: int | None) -> int | None:
    """Check the number of threads that the environment gives, where no option does."""
    if value is None:
        from liftmesh.base.arrays import MOST_ROWS

        with as_usage():
            as_threads(None, MOST_ROWS)
    return value


def color_depth(text: str) -> int:
    """Parse a number of bits of a channel."""
    from liftmesh.base.colors import check_depth

    depth: Any = _digits(text)
    check_depth(depth, is_optional=False)
    return int(depth)


def metric(text: str) -> Any:
    """Parse A,B,C to the matrix of a metric."""
    values = _exactly(3, text)
    if values is None:
        raise refused("metric", text, "give three numbers A,B,C")
    from liftmesh.planar.kinds import as_metric

    a, b, c = values
    as_metric([[a, b], [b, c]])
    return (a, b), (b, c)


def apex(text: str) -> Any:
    """Parse the apex of the paraboloid."""
    if text in {"median", "origin"}:
        return text
    place = _exactly(2, text)
    if place is None or not all(map(math.isfinite, place)):
        raise refused(VALUE, text, "give median, origin or a finite X,Y")
    return place


class ProjectionPlane(NamedTuple):
    """A projection plane as `liftmesh.triangulate` takes it, and the file that it is read from."""

    value: Any
    file: Path | None = None


def plane(text: str) -> ProjectionPlane:
    """Parse a projection plane."""
    if text in {"xy", "xz", "yz", "fit"}:
        return ProjectionPlane(text)
    coefficients = _exactly(3, text) or _exactly(4, text)
    if coefficients:
        return ProjectionPlane(coefficients)
    return ProjectionPlane(_matrix(Path(text), text), Path(text))


def _matrix(path: Path, text: str) -> Any:
    """Read a 4x4 matrix from a text or .npy file."""
    import numpy as np

    if not path.is_file():
        raise InputError(
            f"{Option('plane')} is {text!r}, neither a known name nor a file: "
            "give xy, xz, yz, fit, NX,NY,NZ, A,B,C,D or a file with a 4x4 matrix"
        )
    try:
        matrix = _read_npy(path) if path.suffix == ".npy" else np.loadtxt(path)
    except (ValueError, OSError) as error:
        raise InputError(f"{Option('plane')} {path}: cannot read a matrix: {error}") from error
    if matrix.shape != (4, 4):
        raise InputError(f"{Option('plane')} {path}: the matrix is {matrix.shape}, not 4x4")
    return matrix


def _read_npy(path: Path) -> Any:
    from liftmesh.io.formats.numpy_arrays import read_array

    with path.open("rb") as stream:
        return read_array(stream, path.name)


def is_stream(path: Path) -> bool:
    """Whether a path denotes a standard stream."""
    return str(path) == "-"


def _digits(text: str) -> int | str:
    """Convert digits, and leave other text."""
    return int(text) if re.fullmatch(r"[+-]?[0-9]{1,18}", str(text)) else text


def _number(text: str) -> float | str:
    """Convert a number, and leave other text."""
    try:
        return int(text) if text.isdecimal() else float(text)
    except ValueError:
        return text


def _exactly(length: int, text: str) -> tuple[float, ...] | None:
    """Parse so many numbers separated by commas; None if the text is something else."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        return None
    return numbers if len(numbers) == length else None


Source: TypeAlias = Annotated[
    Path, argument("IN", "Cloud or mesh; - reads stdin (see --input-format).")
]
Plane: TypeAlias = Annotated[
    Any,
    option(
        "PLANE",
        "Projection plane: xy, xz, yz, fit (least squares), a normal NX,NY,NZ, A,B,C,D of the "
        "plane ax + by + cz + d = 0, or a file (text or .npy) with the rigid 4x4 matrix from space "
        "to plane coordinates.",
        plane,
    ),
]
Apex: TypeAlias = Annotated[
    Any,
    option(
        "APEX",
        "Apex of the paraboloid: median (of the points), origin or X,Y.",
        apex,
        panel="Advanced",
    ),
]
OnDuplicate: TypeAlias = Annotated[
    Policy, flag("Which of several rows at one planar position is used as the vertex.")
]
SkipNonFinite: TypeAlias = Annotated[
    NonFinite, flag("Policy for rows with NaN or infinity.", panel="Input")
]
Threads: TypeAlias = Annotated[
    int | None,
    Spec(
        "Number of threads; by default LIFTMESH_NUM_THREADS, or one per core.",
        "N",
        threads,
        checked_threads,
        panel="Advanced",
    ),
]
Weights: TypeAlias = Annotated[
    str | None,
    option(
        "COLUMN",
        "Values of IN that are weights: makes the regular triangulation, the dual of the "
        "power diagram, which may hide rows.",
    ),
]
Radii: TypeAlias = Annotated[
    str | None, option("COLUMN", "The same with radii, whose squares are weights.")
]
Metric: TypeAlias = Annotated[
    Any,
    option(
        "A,B,C", "Triangulate in the metric a x^2 + 2 b xy + c y^2 of plane coordinates.", metric
    ),
]
Json: TypeAlias = Annotated[bool, flag("Print one JSON object.", panel="Output")]


def lifting(
    weights: str | None, radii: str | None, metric: Any, spherical: bool | None = None
) -> dict[str, Any]:
    """Return the lifting option (weights, radii, metric or the sphere), at most one."""
    chosen = given(weights=weights, radii=radii, metric=metric, spherical=spherical)
    if len(chosen) > 1:
        import click

        raise click.BadParameter(f"--{' and --'.join(chosen)} are given: give one of them")
    return chosen
