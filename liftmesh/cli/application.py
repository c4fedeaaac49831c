"""The application: its commands, and the text of ``liftmesh --help``."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Annotated

import typer

from liftmesh.cli import exit_codes
from liftmesh.cli.wording import Command, Group

HELP = (
    "Exact Delaunay meshes of point clouds: planar points are lifted to a paraboloid, and the "
    "lower hull of the lifted points, projected back, is the mesh."
)


def _listed(title: str, lines: list[str]) -> str:
    as_it_stands = "\b"  # click wraps other paragraphs
    return "\n".join([as_it_stands, f"{title}:", *(f"  {line}" for line in lines)])


EXIT_CODES = _listed(
    "Exit codes", [f"{code:>3}  {meaning}" for code, meaning in exit_codes.MEANINGS.items()]
)
DEBUG = "--debug with any command prints the traceback of an error."

COMMANDS = (
    "triangulate", "tile", "simplify", "thin", "verify", "compare", "info", "sample", "profile",
    "raster", "contour", "volume", "solid", "voronoi", "paper",
)  # fmt: skip


def application(words: Sequence[str]) -> typer.Typer:
    """Make the application with the command that is called, or with all for help and messages."""
    app = typer.Typer(
        name="liftmesh",
        cls=Group,
        help=HELP,
        epilog=f"{EXIT_CODES}\n\n{DEBUG}",
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
        )(module.run)
    return app


def liftmesh(
    _version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    """Define the options that precede a command; `liftmesh.cli` answers ``--version``."""
