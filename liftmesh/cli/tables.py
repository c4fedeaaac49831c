"""The options of tables, which every command that reads points has: `liftmesh.read` knows them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from liftmesh.cli import groups
from liftmesh.cli.options import parse_count
from liftmesh.errors import InputError


def parse(
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
        str, typer.Option("--skip-rows", metavar="N", help="Tables: skip the first N lines.")
    ] = "0",
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
    """Check the options of tables, and return those that were given."""
    words = {"columns": columns, "delimiter": delimiter, "decimal": decimal, "nodata": nodata}
    words |= {"end": end, "encoding": encoding}
    given: dict[str, Any] = {k: word for k, word in words.items() if word is not None}
    given |= {"flat": True} if flat else {}
    given |= {"header": False} if no_header else {}
    lines = parse_count("--skip-rows", skip_rows, 0)
    given |= {"skip_rows": lines} if lines else {}
    if not given:
        return given
    from liftmesh.io.formats.text.options import validate_table_options  # noqa: PLC0415 - most runs do without

    try:
        validate_table_options(**given)
    except InputError as error:
        raise typer.BadParameter(f"--{error}") from error
    return given


def flat_of(path: Path) -> dict[str, bool]:
    """Return the option that says that heights do not matter, if a file is a table."""
    from liftmesh.io.registry import find_format  # noqa: PLC0415 - help does without
    from liftmesh.io.streams import suffix_of  # noqa: PLC0415 - help does without

    is_table = bool(path.suffix) and find_format(suffix_of(path.name), str(path)).name == "text"
    return {"flat": True} if is_table else {}


with_options = groups.taking("table", parse)
