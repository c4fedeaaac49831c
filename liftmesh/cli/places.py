"""Points and lines that a command takes beside a surface, by ``--at`` or ``--along``.

The options of their table are those of IN with another name each, as ``--at-columns``, so that what
an error about the table recommends is an option of the table itself.
"""

from __future__ import annotations

import inspect
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args

import typer

from liftmesh.base.options import shown
from liftmesh.cli import inputs, options
from liftmesh.errors import FormatError, InputError, Message

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

SHAPES = {".geojson", ".json", ".gpkg"}
_LEFT_OUT = "flat"  # where the points are, not how high


@dataclass(frozen=True)
class Places:
    """How the table of an option is read."""

    option: str  # without its dashes
    file_format: str | None
    table: dict[str, Any]

    def are_shapes(self, path: Path) -> bool:
        """Whether a file holds shapes, and neither a table nor a cloud."""
        return self.file_format is None and is_shapes(path)

    def read(
        self,
        path: Path,
        source: Path,
        crs: str | None,
        max_bytes: int | None,
        *,
        flat: bool | None = True,  # as of `liftmesh.read`, for a table without named columns
    ) -> Cloud:
        """Read points over a surface of this source and system, in which they have to be."""
        from liftmesh.crs.comparison import are_different

        kind: dict[str, Any] = {} if self.file_format is None else {"format": self.file_format}
        if (self.file_format or path.suffix) and is_table(path, self.file_format):
            kind["flat"] = None if "columns" in self.table else flat
        try:
            cloud = inputs.read(path, {**self.table, **kind, "max_bytes": max_bytes})
        except (FormatError, InputError) as error:
            error.args = (error.message.renamed(_own_names(self.option)),)
            raise
        if are_different(crs, cloud.crs):
            there, here = shown(cloud.crs), shown(crs)
            raise InputError(
                f"{path} is in {there}, {source} in {here}: transform the points first"
            )
        return cloud


def _own_names(option: str) -> dict[str, str]:
    """Return by option of IN that of the table which an option names."""
    names = {each: f"--{option}-{each.replace('_', '-')}" for each in _table_options()}
    return names | {"format": f"--{option}-input-format", "header": f"--{option}-no-header"}


def group(option: str) -> options.Group:
    """Make the group of options of the table that an option, without its dashes, names."""

    def parse(**given: Any) -> Places:
        plain = {key.removeprefix(f"{option}_"): value for key, value in given.items()}
        file_format = plain.pop("input_format")
        try:
            return Places(option, file_format, inputs.table(**plain))
        except typer.BadParameter as error:
            message = Message(error.message).renamed(_own_names(option))
            raise typer.BadParameter(message) from error

    file_format = typer.Option(
        metavar="FORMAT", help=f"Format of --{option}, instead of its suffix."
    )
    parameters = [_parameter(f"{option}_input_format", None, str | None, file_format)]
    for name, each in _table_options().items():
        kind, info = get_args(each.annotation)
        own, dashed = copy(info), name.replace("_", "-")
        own.default = f"--{option}-{dashed}"  # of an annotation, this is the first name
        own.param_decls = ()
        own.help = f"As --{dashed}, of the table of --{option}."
        parameters.append(_parameter(f"{option}_{name}", each.default, kind, own))
    return options.Group(options.with_parameters(parse, parameters))


def _parameter(name: str, default: Any, kind: Any, info: Any) -> inspect.Parameter:
    annotation = Annotated[kind, info]
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation
    )


def _table_options() -> dict[str, inspect.Parameter]:
    """Return the options of tables, as typer sees them."""
    parameters = dict(inspect.signature(inputs.table, eval_str=True).parameters)
    del parameters[_LEFT_OUT]
    return parameters


def is_shapes(path: Path) -> bool:
    """Whether a file holds shapes, by its suffix, and neither a table nor a cloud."""
    from liftmesh.io.registry import find_format
    from liftmesh.io.streams import suffix_of

    if path.suffix.lower() in SHAPES or not path.suffix:
        return True
    try:
        return find_format(suffix_of(path.name), str(path)) is None
    except FormatError:
        return True


def is_table(path: Path, file_format: str | None = None) -> bool:
    """Whether a file is a table, by its format or its suffix."""
    from liftmesh.io.registry import find_format
    from liftmesh.io.streams import suffix_of

    kind = file_format or suffix_of(path.name)
    return bool(kind) and find_format(kind, str(path)).name == "text"
