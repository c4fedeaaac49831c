"""The application: its commands as click knows them, their help, and completion for shells."""

from __future__ import annotations

import inspect
import os
import subprocess
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

import click
from click import shell_completion

from liftmesh.cli import exit_codes
from liftmesh.cli.options import PANELS, Spec, as_usage, with_single_options

HELP = (
    "Exact Delaunay meshes of point clouds: planar points are lifted to a paraboloid, and the "
    "lower hull of the lifted points, projected back, is the mesh."
)
DEBUG = "--debug with any command prints the traceback of an error."
COMMANDS = (
    "triangulate", "tile", "simplify", "thin", "verify", "compare", "info", "sample", "height",
    "accuracy", "profile", "raster", "contour", "volume", "difference", "clip", "solid", "tileset",
    "voronoi", "constrain", "refine", "tetrahedralize", "hull", "alpha-shape",
    "plot", "view", "paper", "doctor",
)  # fmt: skip
SHELLS = ("bash", "zsh", "fish", "powershell", "pwsh")
VARIABLE = "_LIFTMESH_COMPLETE"
_NAME = "liftmesh"
_CONTEXT = {
    "help_option_names": ["-h", "--help"], "max_content_width": 120, "show_default": True,
}  # fmt: skip


def run(words: Sequence[str]) -> int | None:
    """Run a command, or show the help; errors are exceptions."""
    program = Program()
    if VARIABLE in os.environ:  # a shell asks what may follow
        program.main([*words], prog_name=_NAME)
    try:
        with program.make_context(_NAME, [*words] or ["--help"]) as context:
            program.invoke(context)
    except click.exceptions.Exit as end:
        return end.exit_code
    return None


class Program(click.Group):
    """The program: a command is imported when it is called, or when the help names it."""

    def __init__(self) -> None:
        codes = [f"{code:>3}  {meaning}" for code, meaning in exit_codes.MEANINGS.items()]
        flags = {
            "--version": "Show the version and exit.",
            "--install-completion": "Install completion for the shell of this name, or $SHELL.",
            "--show-completion": "Show the script that completes commands in a shell.",
        }  # which precede a command: `liftmesh.cli` answers them
        super().__init__(
            name=_NAME,
            help=HELP,
            epilog=f"{_listed('Exit codes', codes)}\n\n{DEBUG}",
            context_settings=_CONTEXT,
            params=[
                click.Option([flag], is_flag=True, expose_value=False, help=text)
                for flag, text in flags.items()
            ],
        )

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - as click has it
        """Return the names of all commands."""
        return [*COMMANDS]

    def get_command(self, ctx: click.Context, cmd_name: str) -> Command | None:  # noqa: ARG002
        """Make a command."""
        return Command(cmd_name) if cmd_name in COMMANDS else None


class Command(click.Command):
    """A command: a module whose function `run` has annotations that say what its options are."""

    def __init__(self, name: str) -> None:
        module = import_module(f"liftmesh.cli.{name.replace('-', '_')}")
        function = with_single_options(module.run)
        parameters = inspect.signature(function, eval_str=True).parameters
        specs = {key: get_args(each.annotation)[1] for key, each in parameters.items()}
        self._specs: dict[str, Spec] = specs
        super().__init__(
            name=name,
            callback=function,
            params=[_parameter(each) for each in parameters.values()],
            help=f"{module.SHORT_HELP} {module.HELP}",
            short_help=module.SHORT_HELP,
            epilog=_listed("Examples", [f"$ {line}" for line in module.EXAMPLES]),
            context_settings=_CONTEXT,
        )

    def format_arguments(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Leave arguments to the first panel."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write arguments and options in panels."""
        for name, records in self.panels(ctx).items():
            with formatter.section(name):
                formatter.write_dl(records)

    def panels(self, ctx: click.Context) -> dict[str, list[tuple[str, str]]]:
        """Return the parts of the help that have arguments or options, with their texts."""
        panels: dict[str, list[tuple[str, str]]] = {name: [] for name in PANELS}
        for each in self.get_params(ctx):
            spec = self._specs.get(each.name or "", Spec("", panel=PANELS[-1]))  # that of --help
            if isinstance(each, click.Argument):
                panels[PANELS[0]].append((each.make_metavar(ctx), spec.text))
            elif record := each.get_help_record(ctx):
                panels[spec.panel or PANELS[1]].append(record)
        return {name: records for name, records in panels.items() if records}


def _listed(title: str, lines: list[str]) -> str:
    as_it_stands = "\b"  # click wraps other paragraphs
    return "\n".join([as_it_stands, f"{title}:", *(f"  {line}" for line in lines)])


def _parameter(each: inspect.Parameter) -> click.Parameter:
    """Make an argument or an option of an annotated parameter of a command."""
    kind, spec = get_args(each.annotation)
    one, is_list = _type_of_one(kind)
    is_required = each.default is each.empty
    shared: dict[str, Any] = {
        "type": _converter(spec, one),
        "shell_complete": _files,
        "required": is_required,
        "callback": _finish(spec, is_list=is_list),
    }
    if get_origin(one) is Literal:
        shared |= {"type": click.Choice(get_args(one)), "shell_complete": None}
    if not is_required and each.default is not None:
        shared["default"] = each.default
    if spec.is_argument:
        metavar = f"{spec.metavar}{'...' if is_list else ''}"
        return click.Argument([each.name], nargs=-1 if is_list else 1, metavar=metavar, **shared)
    name = f"--{each.name.replace('_', '-')}"
    if one is bool:
        name += f"/--no-{name[2:]}" if each.default else ""
        return click.Option([each.name, name], is_flag=True, default=each.default, help=spec.text)
    shared |= {"metavar": spec.metavar or None, "multiple": is_list}
    names = [each.name, name, *(["-o"] if each.name == "output" else [])]
    return click.Option(names, help=spec.text, **shared)


def _type_of_one(kind: Any) -> tuple[Any, bool]:
    """Return X of ``X``, ``X | None`` and ``list[X]``, and whether there may be several."""
    if get_origin(kind) in (UnionType, Union):
        kind = next(each for each in get_args(kind) if each is not NoneType)
    return (get_args(kind)[0], True) if get_origin(kind) is list else (kind, False)


def _finish(spec: Spec, *, is_list: bool) -> Callable[..., Any]:
    """Make what click calls with the values of a parameter."""

    def finish(_context: click.Context, _parameter: click.Parameter, value: Any) -> Any:
        if is_list:
            value = [*value] if value else None
        return value if spec.check is None else spec.check(value)

    return finish


def _converter(spec: Spec, kind: Any) -> Callable[[Any], Any]:
    """Make what converts a value that was typed; most defaults are values already."""
    parse = spec.parser or kind

    def convert(value: Any) -> Any:
        try:
            with as_usage():
                return parse(value) if isinstance(value, str) else value
        except ValueError as error:
            raise click.BadParameter(f"{value!r} is no such value") from error

    return convert


def _files(_context: Any, _parameter: Any, incomplete: str) -> list[Any]:
    """Let a shell complete names of files."""
    return [shell_completion.CompletionItem(incomplete, type="file")]


def complete(option: str, names: Sequence[str]) -> None:
    """Print the script that completes commands in a shell, or install it."""
    shell = names[0] if names else Path(os.environ.get("SHELL", "")).name
    maker = shell_completion.get_completion_class({"pwsh": "powershell"}.get(shell, shell))
    if len(names) > 1 or shell not in SHELLS or maker is None:
        said = " ".join(names) or shell or "a shell that is not known"
        raise click.BadParameter(
            f"there is no completion for {said}: give liftmesh {option} SHELL, with one of "
            f"{', '.join(SHELLS)}"
        )
    script = maker(Program(), {}, _NAME, VARIABLE).source()
    if option == "--show-completion":
        click.echo(script)
    else:
        path = _install(shell, script)
        click.echo(f"{path}: completion for {shell}, in terminals that are opened from now on")


def _install(shell: str, script: str) -> Path:
    """Write the script where the shell finds it, and a line that loads it to its profile."""
    home = Path.home()
    profile, line = None, ""
    if shell == "bash":
        path, profile = home / ".bash_completions/liftmesh.sh", home / ".bashrc"
        line = "source ~/.bash_completions/liftmesh.sh"
    elif shell == "zsh":
        path, profile = home / ".zfunc/_liftmesh", home / ".zshrc"
        line = "fpath+=~/.zfunc; autoload -Uz compinit; compinit"
    elif shell == "fish":
        path = home / ".config/fish/completions/liftmesh.fish"
    else:
        asked = [shell, "-NoProfile", "-Command", "$profile"]
        profile = Path(subprocess.check_output(asked, text=True).strip())  # noqa: S603 - a name of SHELLS
        path = profile.with_name("liftmesh.ps1")
        line = f". '{path}'"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(script)
    before = profile.read_text() if profile is not None and profile.is_file() else ""
    if profile is not None and line not in before:
        profile.write_text(f"{before.rstrip()}\n{line}\n".lstrip())
    return path
