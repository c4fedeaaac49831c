"""Files as commands name them: ``-`` for the standard streams, and a check before the work."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from liftmesh.cli.terminal import stage
from liftmesh.errors import (
    DegenerateInputError,
    DuplicateHeightError,
    FormatError,
    InputError,
    NonFiniteError,
)

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud
    from liftmesh.io.files import Written

_OF_ROWS = (DegenerateInputError, DuplicateHeightError, NonFiniteError)


def read(path: Path, file_format: str | None) -> Cloud:
    """Read a cloud, or stdin if the path is ``-``.

    Parameters
    ----------
    path : Path
        The file.
    file_format : str, optional
        Its format; by default its suffix tells.

    Returns
    -------
    Cloud
        Its rows.

    Raises
    ------
    FormatError
        The format is unknown, or the file is broken.
    typer.BadParameter
        It is stdin, and no format is given.
    """
    from liftmesh.io import files as formats  # noqa: PLC0415 - help and --version do without

    if is_stream(path) and file_format is None:
        raise typer.BadParameter("stdin has no suffix: give its format with --from")
    source = sys.stdin.buffer if is_stream(path) else path
    name = "stdin" if is_stream(path) else path
    with _about_reading(str(name)), stage(f"reading {name if is_stream(path) else path.name}"):
        return formats.read(source, format=file_format)


@contextmanager
def _about_reading(name: str) -> Iterator[None]:
    """Say which file it is that cannot be read: streams do not know."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            error.filename = name
        raise


def write(path: Path, mesh: Any, file_format: str | None = None) -> Written:
    """Write a mesh, or to stdout if the path is ``-``.

    Parameters
    ----------
    path : Path
        The file.
    mesh : Cloud or anything with vertices and faces
        What to write.
    file_format : str, optional
        Its format; by default the suffix tells.

    Returns
    -------
    Written
        What was written.

    Raises
    ------
    FormatError
        The file cannot be written.
    """
    from liftmesh.io import files as formats  # noqa: PLC0415 - help and --version do without

    with stage(f"writing {'stdout' if is_stream(path) else path.name}"):
        if not is_stream(path):
            return formats.write(path, mesh, format=file_format)
        # A stream of its own: an unbuffered sys.stdout may write a part and not say so.
        with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as stream:
            return formats.write(stream, mesh, format=file_format)


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Say which file it is whose rows are wrong.

    Parameters
    ----------
    path : Path
        The file that the rows are from.
    """
    try:
        yield
    except InputError as error:
        if isinstance(error, _OF_ROWS) or str(error).startswith("row "):
            name = "stdin" if is_stream(path) else path
            error.args = (f"{name}: {error}", *error.args[1:])
        raise


def is_stream(path: Path) -> bool:
    """Whether a path stands for a standard stream.

    Parameters
    ----------
    path : Path
        As given on the command line.

    Returns
    -------
    bool
        True for ``-``.

    Examples
    --------
    >>> is_stream(Path("-"))
    True
    """
    return str(path) == "-"


def check_apart(*paths: Path | None) -> None:
    """Refuse two names for one file: the second that is written would take the place of the first.

    Parameters
    ----------
    *paths : Path, optional
        The file that is read, if there is one, and those to be written.

    Raises
    ------
    typer.BadParameter
        Two of them are the same file.
    """
    for one, other in combinations([path for path in paths if path is not None], 2):
        if not (is_stream(one) or is_stream(other)) and _same(one, other):
            raise typer.BadParameter(
                f"{one} and {other} are one file, and one would take the place of the other: "
                "give another name"
            )


def _same(one: Path, other: Path) -> bool:
    if one.is_file() and other.is_file():
        return one.samefile(other)  # by another link, too
    return not one.exists() and one.resolve() == other.resolve()


def check_target(path: Path | None, file_format: str | None = None) -> None:
    """Refuse what cannot be written before the work starts.

    Parameters
    ----------
    path : Path, optional
        The file to be written; none is fine.
    file_format : str, optional
        Its format; by default the suffix tells.

    Raises
    ------
    FormatError
        The format is unknown or cannot be written.
    OSError
        The place is one where nothing can be written, as `check_place` says.
    typer.BadParameter
        Nothing tells the format.
    """
    from liftmesh.io.registry import find_format  # noqa: PLC0415 - as above

    if path is None:
        return
    if not (file_format or path.suffix):
        raise typer.BadParameter(f"{path} has no suffix to tell its format: give it with --format")
    found = find_format(file_format or path.suffix, str(path))
    if found.write is None:
        raise FormatError(f"{path}: {found.name} files can be read, not written")
    check_place(path)


def check_place(path: Path | None) -> None:
    """Refuse a place where nothing can be written before the work starts.

    Parameters
    ----------
    path : Path, optional
        The file to be written; none is fine, and so is a standard stream.

    Raises
    ------
    OSError
        It is a folder or a read-only file, or its folder is not there or is read-only.
    """
    from liftmesh.io.atomic import check_writable  # noqa: PLC0415 - as above

    if path is not None and not is_stream(path):
        check_writable(path)
