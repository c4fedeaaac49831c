"""Options of the second table of a command, that of ``--at`` or ``--along``: ``--at-columns``.

They are those of IN with another name each, so that what an error about the table recommends is an
option of the table itself.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from liftmesh.cli import files, groups, tables
from liftmesh.errors import FormatError, InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_LEFT_OUT = "flat"  # where the points are, not how high


@dataclass(frozen=True)
class SecondTable:
    """How the table of an option is read.

    Parameters
    ----------
    option : str
        The option, without its dashes.
    file_format : str, optional
        The format, instead of the suffix.
    table : dict
        Options of `liftmesh.read`.
    """

    option: str
    file_format: str | None
    table: dict[str, Any]

    def read(self, path: Path, limit: int | None, *, flat: bool | None = True) -> Cloud:
        """Read points in the plane.

        Parameters
        ----------
        path : Path
            A cloud; ``-`` is stdin.
        limit : int, optional
            As for `liftmesh.read`.
        flat : bool, optional
            As for `liftmesh.read`, if it is a table and its columns are not given.

        Returns
        -------
        Cloud
            The points.

        Raises
        ------
        FormatError, InputError, typer.BadParameter
            As for `files.read`, in the words of the options of this table.
        """
        is_table = bool(tables.flat_of(self._named(path)))
        own = {"flat": None if "columns" in self.table else flat} if is_table else {}
        try:
            return files.read(path, self.file_format, limit, {**self.table, **own})
        except (FormatError, InputError, typer.BadParameter) as error:
            error.args = (self._worded(str(error)), *error.args[1:])
            if isinstance(error, typer.BadParameter):
                error.message = self._worded(error.message)
            raise

    def _named(self, path: Path) -> Path:
        return path if self.file_format is None else Path(f"a.{self.file_format.lstrip('.')}")

    def _worded(self, message: str) -> str:
        """Name the options of this table where a message names those of IN."""
        from liftmesh.cli.python_options import as_on_command_line  # noqa: PLC0415 - errors only

        names = "|".join(each.replace("_", "-") for each in (*_options(), "from"))
        mine = rf"--{self.option}-\g<1>"
        told = re.sub(rf"--({names})\b", mine, as_on_command_line(message))
        return told.replace(f"--{self.option}-from", f"--{self.option}-format")


def _options() -> dict[str, inspect.Parameter]:
    """Return the options of tables, as typer sees them."""
    found = dict(inspect.signature(tables.parse, eval_str=True).parameters)
    del found[_LEFT_OUT]
    return found


def with_options(option: str, name: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a decorator that gives a command the options of a second table.

    Parameters
    ----------
    option : str
        The option that names the table, without its dashes.
    name : str
        The parameter of the command, which becomes a `SecondTable`.

    Returns
    -------
    callable
        The decorator, as of `groups.taking`.
    """
    parameters = [_renamed(option, each) for each in _options().values()]
    parameters.insert(0, _format(option))

    @wraps(tables.parse)
    def parse(**values: Any) -> SecondTable:
        plain = {key.removeprefix(f"{option}_"): value for key, value in values.items()}
        file_format = plain.pop("format", None)
        try:
            return SecondTable(option, file_format, tables.parse(**plain))
        except typer.BadParameter as error:
            raise typer.BadParameter(error.message.replace("--", f"--{option}-", 1)) from error

    parse.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return groups.taking(name, parse)


def _format(option: str) -> inspect.Parameter:
    info = typer.Option(
        f"--{option}-format", metavar="FORMAT", help=f"Format of --{option}, instead of its suffix."
    )
    return inspect.Parameter(
        f"{option}_format",
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
        default=None,
        annotation=Annotated[str | None, info],
    )


def _renamed(option: str, found: inspect.Parameter) -> inspect.Parameter:
    """Return an option of tables under another name, with a help that says whose it is."""
    kind, given = get_args(found.annotation)
    info, dashed = copy(given), found.name.replace("_", "-")
    info.param_decls = (f"--{option}-{dashed}",)
    info.help = f"As --{dashed}, of the table of --{option}."
    return inspect.Parameter(
        f"{option}_{found.name}",
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
        default=found.default,
        annotation=Annotated[kind, info],
    )
