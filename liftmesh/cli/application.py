"""The application: its commands, the text of ``liftmesh --help``, and ``--version``."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from liftmesh.cli import compare, exit_codes, info, paper, triangulate, verify
from liftmesh.cli.wording import Command, Group

HELP = (
    "Exact Delaunay meshes of point clouds: planar points are lifted to a paraboloid, and the "
    "lower hull of the lifted points, projected back, is the mesh."
)


def _listed(title: str, lines: list[str]) -> str:
    return "\n".join([f"[bold]{title}[/bold]", *(f"  {line}" for line in lines)])


EXIT_CODES = _listed(
    "Exit codes", [f"{code:>3}  {meaning}" for code, meaning in exit_codes.MEANINGS.items()]
)
DEBUG = "[cyan]--debug[/cyan] with any command prints the traceback of an error."

app = typer.Typer(
    name="liftmesh",
    cls=Group,
    help=HELP,
    epilog=f"{EXIT_CODES}\n\n{DEBUG}",
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _show_version(requested: bool) -> None:
    if requested:
        typer.echo(f"liftmesh {version('liftmesh')}")
        raise typer.Exit


@app.callback()
def liftmesh(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Define the options that precede a command."""


for module in (triangulate, verify, compare, info, paper):
    app.command(
        cls=Command,
        name=module.__name__.rpartition(".")[2],
        help=f"{module.SHORT_HELP} {module.HELP}",
        short_help=module.SHORT_HELP,
        epilog=_listed("Examples", [f"[green]$[/green] {line}" for line in module.EXAMPLES]),
    )(module.run)
