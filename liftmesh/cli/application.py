"""The application: its commands, the text of ``liftmesh --help``, and completion for shells."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import typer
from typer.core import TyperCommand, TyperGroup

from liftmesh.cli import exit_codes
from liftmesh.cli.options import with_single_options

HELP = (
    "Exact Delaunay meshes of point clouds: planar points are lifted to a paraboloid, and the "
    "lower hull of the lifted points, projected back, is the mesh."
)
DEBUG = "--debug with any command prints the traceback of an error."
COMMANDS = (
    "triangulate", "tile", "simplify", "thin", "verify", "compare", "info", "sample", "profile",
    "raster", "contour", "volume", "solid", "voronoi", "paper",
)  # fmt: skip
SHELLS = ("bash", "zsh", "fish", "powershell", "pwsh")
_PROGRAM = {"prog_name": "liftmesh", "complete_var": "_LIFTMESH_COMPLETE"}


def application(words: Sequence[str]) -> typer.Typer:
    """Make the application with the command that is called, or with all for help and messages."""
    codes = [f"{code:>3}  {meaning}" for code, meaning in exit_codes.MEANINGS.items()]
    app = typer.Typer(
        name="liftmesh",
        cls=Group,
        help=HELP,
        epilog=f"{_listed('Exit codes', codes)}\n\n{DEBUG}",
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
    )
    app.callback()(liftmesh)
    for name in words[:1] if words and words[0] in COMMANDS else COMMANDS:
        module = import_module(f"liftmesh.cli.{name}")
        app.command(
            cls=Command,
            name=name,
            help=f"{module.SHORT_HELP} {module.HELP}",
            short_help=module.SHORT_HELP,
            epilog=_listed("Examples", [f"$ {line}" for line in module.EXAMPLES]),
        )(with_single_options(module.run))
    return app


def liftmesh(
    _version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    """Define the options that precede a command; `liftmesh.cli` answers ``--version``."""


def _listed(title: str, lines: list[str]) -> str:
    as_it_stands = "\b"  # click wraps other paragraphs
    return "\n".join([as_it_stands, f"{title}:", *(f"  {line}" for line in lines)])


class _OwnParameters:
    """Flags without a type in the help, and values that are converted without pydantic."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the parameters."""
        parameters: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for each in parameters:
            if getattr(each, "is_flag", False) and each.metavar is None:
                each.metavar = ""
            _convert_without_pydantic(each)
        return parameters


class Command(_OwnParameters, TyperCommand):
    """A command."""


class Group(_OwnParameters, TyperGroup):
    """The program."""


def _convert_without_pydantic(parameter: Any) -> None:
    """Let a parameter of a simple type convert its value itself.

    Some versions of typer convert values with pydantic, whose import and schemas take longer than
    most commands. They ask each parameter by `get_runtime_param` for what converts its value. A
    parameter of another type, or of a typer that is made otherwise, is left as it is.
    """
    described = getattr(parameter, "type_descriptor", None)
    if described is None or not hasattr(parameter, "get_runtime_param"):
        return
    kind = _type_of_one(described.annotation)
    parse = described.parameter_info.parser
    if parse is None and kind in (str, int, bool, Path):
        parse = kind
    if parse is None and get_origin(kind) is Literal:
        parse = partial(_choice, get_args(kind))
    if parse is not None:
        parameter.get_runtime_param = partial(_Conversion, parse)


class _Conversion:
    """What typer calls for a value of an option, or for the values of one that may have several."""

    def __init__(self, parse: Any) -> None:
        self._parse = parse

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """Convert what was typed; defaults stay as they are."""
        if param.multiple or isinstance(value, list | tuple):
            return [self._one(each, param, ctx) for each in value or ()]
        return self._one(value, param, ctx)

    def _one(self, value: Any, param: Any, ctx: Any) -> Any:
        if not isinstance(value, str):
            return value
        if self._parse is bool:  # a flag takes no text
            raise typer.BadParameter(f"{value!r} is no such value", ctx=ctx, param=param)
        try:
            return self._parse(value)
        except ValueError as error:
            raise typer.BadParameter(f"{value!r} is no such value", ctx=ctx, param=param) from error


def _type_of_one(kind: Any) -> Any:
    """Return the type of one value: X of ``X | None`` and of ``list[X]``."""
    if get_origin(kind) in (UnionType, Union):
        kinds = [each for each in get_args(kind) if each is not NoneType]
        return _type_of_one(kinds[0]) if len(kinds) == 1 else kind
    return get_args(kind)[0] if get_origin(kind) is list else kind


def _choice(choices: Sequence[str], text: str) -> str:
    if text not in choices:
        raise ValueError(text)
    return text


def complete(option: str, names: Sequence[str]) -> None:
    """Print the script that completes commands in a shell, or install it.

    typer has these options, and their help. But its own take no name: ``--show-completion zsh``
    would print the script of the shell at hand, and a shell that has none gets another exit code.
    """
    shell = names[0] if names else _detected()
    if len(names) > 1 or shell not in SHELLS:
        said = " ".join(names) or shell or "a shell that is not known"
        raise typer.BadParameter(
            f"there is no completion for {said}: give liftmesh {option} SHELL, with one of "
            f"{', '.join(SHELLS)}"
        )
    scripts: Any = import_module("typer.completion")
    if option == "--show-completion":
        typer.echo(scripts.get_completion_script(shell=shell, **_PROGRAM))
    else:
        _, path = scripts.install(shell=shell, **_PROGRAM)
        typer.echo(f"{path}: completion for {shell}, in terminals that are opened from now on")


def _detected() -> str | None:
    """Return the name of the shell that runs the program."""
    shells: Any = import_module("shellingham")
    try:
        name: str = shells.detect_shell()[0]
    except shells.ShellDetectionFailure:
        return None
    return name
