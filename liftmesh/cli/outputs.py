"""Files that commands write, and the options of their formats."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, BinaryIO

import typer

from liftmesh.base.interruption import check
from liftmesh.base.options import Unit3MF
from liftmesh.cli import groups, terminal
from liftmesh.cli.files import is_stream
from liftmesh.cli.options import parse_count, parse_length
from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.io.write import Written

_NONE: Mapping[str, Any] = MappingProxyType({})


def parse(
    scale: Annotated[
        str | None,
        typer.Option(metavar="STEP", help="Of LAS: the step that coordinates are rounded to."),
    ] = None,
    point_format: Annotated[
        str | None, typer.Option(metavar="N", help="Of LAS: the point format, 0 to 10.")
    ] = None,
    unit: Annotated[Unit3MF | None, typer.Option(help="Of 3MF: the unit of coordinates.")] = None,
) -> dict[str, Any]:
    """Check the options of formats, and return those that were given."""
    found: dict[str, Any] = {}
    found |= {} if scale is None else {"scale": parse_length("--scale", scale)}
    if point_format is not None:
        found["point_format"] = parse_count("--point-format", point_format, 0)
    return found | ({} if unit is None else {"unit": unit})


def check_options(target: Path, target_format: str | None, options: Mapping[str, Any]) -> None:
    """Raise before the work starts if a format has no such options."""
    if not options:
        return
    from liftmesh.io.registry import find_written  # noqa: PLC0415 - help does without
    from liftmesh.io.streams import suffix_of  # noqa: PLC0415 - help does without
    from liftmesh.io.write import writer_of  # noqa: PLC0415 - as above

    found = find_written(target_format or suffix_of(target.name), str(target))
    try:
        for each in options:
            writer_of(found, str(target), {each: options[each]})
    except FormatError as error:
        option = each.replace("_", "-")
        raise typer.BadParameter(f"--{option}: {found.name} files have none") from error


def write(
    path: Path, mesh: Any, file_format: str | None = None, options: Mapping[str, Any] = _NONE
) -> Written:
    """Write a mesh, or to stdout if the path is ``-``."""
    from liftmesh.io import streams, write  # noqa: PLC0415 - help and --version do without

    if not is_stream(path):
        with terminal.writing(f"writing {path.name}", streams.written):
            # The command's guard has looked before the work started.
            return write.write(path, mesh, format=file_format, overwrite=True, **options)
    with stdout_of_bytes() as stream:
        return write.write(stream, mesh, format=file_format, **options)


@contextmanager
def stdout_of_bytes() -> Iterator[BinaryIO]:
    """Open stdout for a file, unless a signal came."""
    with terminal.stage("writing stdout"):
        check()
        with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as stream:
            yield stream


def headline(written: Written, content: str) -> str:
    """Say in a line what was written, and how the file differs from the mesh."""
    line = f"{written.path or '-'}: {content}, {terminal.bytes_text(written.bytes)}"
    if written.dropped:
        line += f"; {written.format} does not keep {', '.join(written.dropped)}"
    if written.renamed:
        line += f"; renamed: {', '.join(f'{name!r} to {new}' for name, new in written.renamed)}"
    if written.origin is None:
        return line
    moved = ", ".join(f"{value:.10g}" for value in written.origin)
    return f"{line}; float32, so the origin ({moved}) was subtracted"


def values(written: Written) -> dict[str, Any]:
    """Return what `--json` prints of a file that was written."""
    return {
        "path": str(written.path or "-"),
        "format": written.format,
        "bytes": written.bytes,
        "origin": written.origin,
        "dropped": list(written.dropped),
        "renamed": dict(written.renamed),
    }


with_options = groups.taking("writing", parse)
