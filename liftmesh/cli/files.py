"""Files of the commands: ``-`` for the standard streams, and checks before the work starts."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import typer

from liftmesh.cli import systems, tiled_surfaces
from liftmesh.cli.python_options import as_on_command_line
from liftmesh.cli.standard_streams import check_stdout
from liftmesh.cli.terminal import note, reading, stage
from liftmesh.errors import (
    DataWarning,
    DegenerateInputError,
    DuplicateHeightError,
    FormatError,
    InputError,
    NonFiniteError,
)

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_MOST_LISTED = 8
_LONGEST = 80  # characters of each
CRS_OF_OTHERS = "crs_of_others"  # the option for files that state no system
_TAKEN_UNITS = {"landxml": "metres", "3mf": "millimetres"}
_OF_ROWS = (DegenerateInputError, DuplicateHeightError, NonFiniteError)
_ABOUT_A_FILE = (
    *("row ", "the coordinates ", "weights are ", "radii are "),
    *("the points have ", "the mesh says "),
)


def read(
    path: Path,
    file_format: str | None,
    max_bytes: int | None = None,
    table: Mapping[str, Any] = MappingProxyType({}),
    color_depth: int | None = None,
    selection: Mapping[str, Any] = MappingProxyType({}),
) -> Cloud:
    """Read a cloud, or stdin if the path is ``-``; say on stderr how, and what is not read."""
    if is_stream(path) and file_format is None:
        raise typer.BadParameter("stdin has no suffix: give its format with --from")
    source = sys.stdin.buffer if is_stream(path) else path
    name = "stdin" if is_stream(path) else path
    tiled_surfaces.check_file(path)
    from liftmesh.io.streams import progress  # noqa: PLC0415 - help and --version do without

    shown = f"reading {name if is_stream(path) else path.name}"
    place = stage(shown) if is_stream(path) else reading(shown, progress)
    with _about_reading(str(name)), place:
        choices = {**table, **selection}
        cloud = _read_quietly(
            source, format=file_format, max_bytes=max_bytes, color_depth=color_depth, **choices
        )
    for each in notes(cloud, is_transformed="to_crs" in selection):
        note(f"{name}: {each}")
    if not_read := parts_not_read(cloud):
        note(f"{name}: not read: {listed(not_read)}")
    if color_depth is None and cloud.color_depth == 8 and len(cloud):
        note(
            f"{name}: no colour exceeds 255: they are read as 8-bit colours "
            "(liftmesh triangulate has --color-depth)"
        )
    return cloud


def read_ground(
    path: Path,
    file_format: str | None,
    max_bytes: int | None = None,
    table: Mapping[str, Any] = MappingProxyType({}),
    color_depth: int | None = None,
    selection: Mapping[str, Any] = MappingProxyType({}),
) -> Cloud:
    """Read the rows of a surface: of lidar the ground, and none that are withheld, unless asked."""
    from liftmesh.io.surface_rows import for_surface  # noqa: PLC0415 - help does without

    selection = for_surface(path, selection, file_format)
    return read(path, file_format, max_bytes, table, color_depth, selection)


def counts_of(cloud: Cloud) -> dict[str, int] | None:
    """Return the counts of rows that were selected and left out; None if all were read."""
    if "selection" not in cloud.metadata:
        return None
    from liftmesh.io.selection import found_selection  # noqa: PLC0415 - most files are read whole

    return found_selection(cloud.metadata) or None


def _read_quietly(source: Any, **choices: Any) -> Cloud:
    """Read without warnings: they are among the notes."""
    from liftmesh.crs.comparison import adds_heights  # noqa: PLC0415 - as above
    from liftmesh.crs.description import check_system  # noqa: PLC0415 - help and --version do without
    from liftmesh.io import read as io_files  # noqa: PLC0415 - as above

    with without_warnings():
        if CRS_OF_OTHERS not in choices:
            return io_files.read(source, **choices)
        crs, target = choices.pop(CRS_OF_OTHERS), choices.pop("to_crs", None)
        check_system(crs)
        cloud = io_files.read(source, **choices)
        return io_files.placed(cloud, crs if adds_heights(cloud.crs, crs) else None, target)


@contextmanager
def without_warnings() -> Iterator[None]:
    """Leave out warnings about data, which are among the notes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)
        yield


def notes(cloud: Cloud, *, is_transformed: bool = False) -> tuple[str, ...]:
    """Return what is worth knowing about how a file was read."""
    from liftmesh.io.metadata import found_columns  # noqa: PLC0415 - as above

    first = (*_about_rows(cloud), *systems.notes(cloud, is_transformed=is_transformed))
    names = found_columns(cloud.metadata)
    if not names:
        is_told = not {"raster", "e57"}.isdisjoint(cloud.metadata)
        said = cloud.metadata.get("notes") if is_told else ()
        return (*first, *said) if isinstance(said, tuple) else first
    from liftmesh.io.formats.text.columns import coordinates_sentence  # noqa: PLC0415 - few files are tables

    said = coordinates_sentence(names)
    told = map(as_on_command_line, cloud.metadata.get("notes", ()))
    return (*first, *([said] if said else []), *told)


def _about_rows(cloud: Cloud) -> tuple[str, ...]:
    """Say which rows were selected, and which of lidar are among them."""
    counts = counts_of(cloud)
    if counts is None:
        return ()
    from liftmesh.cli.lidar import flagged  # noqa: PLC0415 - most files are read whole
    from liftmesh.io.selection import selection_sentence  # noqa: PLC0415 - as above

    said = selection_sentence(counts).replace("by every=", "by --every")
    return tuple(filter(None, (said, flagged(cloud))))


def parts_not_read(cloud: Cloud) -> tuple[str, ...]:
    """Return the parts of a file that its reader named as not read, with their counts."""
    skipped = cloud.metadata.get("skipped")
    return skipped if isinstance(skipped, tuple) else ()


def listed(names: Sequence[str]) -> str:
    """List names for a message; a file can hold any number of them."""
    from liftmesh.io.text_tables import shortened  # noqa: PLC0415 - help does without

    shown = ", ".join(shortened(each, _LONGEST) for each in names[:_MOST_LISTED])
    rest = len(names) - _MOST_LISTED
    return f"{shown} and {rest:,} more" if rest > 0 else shown


@contextmanager
def _about_reading(name: str) -> Iterator[None]:
    """Add the file's name to an error: streams do not know it."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            error.filename = name
        raise


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Add the file's name to errors about its rows and its values."""
    try:
        yield
    except InputError as error:
        if is_about_rows(error):
            name = "stdin" if is_stream(path) else path
            error.args = (f"{name}: {error}", *error.args[1:])
        raise


def is_about_rows(error: InputError) -> bool:
    """Whether an error is about the rows of a file."""
    return isinstance(error, _OF_ROWS) or str(error).startswith(_ABOUT_A_FILE)


def is_stream(path: Path) -> bool:
    """Whether a path denotes a standard stream."""
    return str(path) == "-"


def check_target(path: Path | None, file_format: str | None = None) -> None:
    """Raise before the work starts if a file cannot be written."""
    from liftmesh.io.registry import find_written  # noqa: PLC0415 - as above
    from liftmesh.io.streams import suffix_of  # noqa: PLC0415 - as above

    if path is None:
        return
    if is_stream(path):
        check_stdout()
    if not (file_format or path.suffix):
        raise typer.BadParameter(f"{path} has no suffix: give its format with --format")
    found = find_written(file_format or suffix_of(path.name), str(path))
    if found.write is None:
        raise FormatError(f"{path}: {found.name} files can be read, not written")
    check_place(path)


def check_content(
    path: Path, file_format: str | None, cloud: Cloud, writing: Mapping[str, Any]
) -> None:
    """Raise before the work starts if a file cannot hold what a mesh of these rows would have."""
    from liftmesh.crs.units import system_of  # noqa: PLC0415 - as above
    from liftmesh.io.format import check_before  # noqa: PLC0415 - as above
    from liftmesh.io.registry import find_format  # noqa: PLC0415 - as above

    found = find_format(file_format or path.suffix, str(path))
    check_before(replace(found, check=None) if "unit" in writing else found, cloud)
    if "unit" in writing or found.name not in _TAKEN_UNITS:
        return
    system = system_of(cloud)
    if cloud.crs is None:
        unit = _TAKEN_UNITS[found.name]
        note(f"{path}: no coordinate system says the unit: {found.name} states {unit}")
    elif system is not None and system.units[2] is None and system.units[0] is not None:
        unit = system.units[0].name
        note(f"{path}: nothing says the unit of heights: {found.name} states {unit} for them, too")


def check_place(path: Path | None) -> None:
    """Raise before the work starts if nothing can be written at a path."""
    from liftmesh.io.atomic import check_writable  # noqa: PLC0415 - as above

    if path is not None and not is_stream(path):
        check_writable(path)
