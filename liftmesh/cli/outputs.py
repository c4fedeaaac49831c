"""Files that commands write: what they do not replace, options of formats, and the report after.

What is not replaced: the inputs, and without ``--overwrite`` any file with content. An output that
is an input, by whatever name, option or link, is refused always, also where it would be read wholly
before: the output may hold less. So is a file in a folder that is an input, one that is read beside
an input, and a buffer or an image of a glTF file that is an input.
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from dataclasses import dataclass, field, replace
from functools import wraps
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import click

from liftmesh.base.interruption import check
from liftmesh.base.options import Unit3MF, Up
from liftmesh.cli import options, terminal
from liftmesh.cli.options import argument, flag, is_stream, option, positive, whole
from liftmesh.cli.signals import Closed
from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.format import Format
    from liftmesh.io.write import WriteResult

_TAKEN_UNITS = {"landxml": "metres", "3mf": "millimetres"}
_BESIDE = {
    ".shp": (".dbf", ".prj", ".cpg"), ".ele": (".node",), ".poly": (".node",),
    ".asc": (".prj",),
    ".tif": (".prj", ".tfw", ".wld"), ".tiff": (".prj", ".tfw", ".wld"),
}  # fmt: skip
_OVERWRITE = options.parameter(
    "overwrite", bool, flag("Replace a file that exists; never an input.", panel="Output"), False
)


def guards(
    *outputs: str,  # parameters that are files to write: all others that name a file are inputs
    inside: Sequence[str] = ("",),  # files, if these are folders
    prints: bool = False,  # what is not in the files, also without --json
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a decorator that gives a command ``--overwrite``, and checks its outputs."""

    def decorate(run: Callable[..., Any]) -> Callable[..., Any]:
        run = options.with_single_options(run)  # each may name a file

        @wraps(run)
        def command(*, overwrite: bool = False, **given: Any) -> Any:
            targets = [given[each] for each in outputs if given.get(each) is not None]
            targets = [each / name for each in targets for name in inside]
            check_lost(targets, _inputs(given, outputs), overwrite=overwrite)
            if prints or given["json"]:
                check_stdout()
            return run(**given)

        parameters = inspect.signature(run, eval_str=True).parameters.values()
        return options.with_parameters(command, [*parameters, _OVERWRITE])

    return decorate


def check_lost(targets: Sequence[Path], inputs: Iterable[Path], *, overwrite: bool = True) -> None:
    """Raise before the work starts if a file would be lost."""
    files = [each for each in targets if not is_stream(each)]
    for one, other in combinations(files, 2):
        if os.path.realpath(one) == os.path.realpath(other):
            raise _same(one, other)
    from liftmesh.io.atomic import holds_data

    read = [*inputs]
    for target in files:
        for each in read:
            if _is_part(target, each):
                raise _same(each, target)
            if _is_named(target, each):
                raise click.BadParameter(
                    f"{target} is a part of {each}, and would be lost: give another name"
                )
        if not overwrite and holds_data(target):
            raise click.BadParameter(
                f"{target} exists, and would be lost: give another name for what is written, or "
                "--overwrite to replace it"
            )


def _inputs(given: Mapping[str, Any], outputs: Sequence[str]) -> Iterator[Path]:
    """List whatever may name a file among the values of a command."""
    for key, value in given.items():
        for each in [] if key in outputs else value if isinstance(value, list | tuple) else [value]:
            if isinstance(each, Path) or (isinstance(each, str) and _is_name(each)):
                yield Path(each)
                yield from _beside(Path(each))


def _beside(path: Path) -> Iterator[Path]:
    """List the files that are read beside one."""
    named = (path.with_suffix(each) for each in _BESIDE.get(path.suffix.lower(), ()))
    yield from (each for each in named if each.is_file())


def _is_name(text: str) -> bool:
    return os.path.isfile(text) or bool(os.path.splitext(text)[1])  # noqa: PTH113, PTH122 - any text


def _is_part(target: Path, source: Path) -> bool:
    """Whether a file is an input, by whatever name, or one of a folder that is an input."""
    place, where = Path(os.path.realpath(target)), Path(os.path.realpath(source))
    if where in place.parents:
        return place.is_file() and where.is_dir()
    with suppress(OSError, ValueError):  # missing, or a stdin that is no file
        status = os.fstat(sys.stdin.fileno()) if is_stream(source) else where.stat()
        return os.path.samestat(status, place.stat()) and place.is_file()
    return place == where


def _is_named(target: Path, source: Path) -> bool:
    """Whether a file is a buffer or an image of a glTF file that is an input."""
    is_model = source.suffix.lower() in (".gltf", ".glb") and source.is_file()
    if not is_model or not target.is_file():
        return False
    from liftmesh.io.formats.gltf.validation import named_in

    return any(_is_part(target, each) for each in named_in(source))


def _same(one: Path, other: Path) -> click.BadParameter:
    if is_stream(one) or Path(one).is_dir():
        return click.BadParameter(f"{other} is read as {one}, and would be lost: give another name")
    return click.BadParameter(
        f"{one} and {other} are the same file, and one would overwrite the other: give another name"
    )


@dataclass(frozen=True)
class Target:
    """A file to write, or stdout if the path is ``-``, by options of its format."""

    path: Path
    file_format: str | None = None
    writing: Mapping[str, Any] = field(default_factory=dict)

    def check(self) -> None:
        """Raise before the work starts if the file cannot be written, or has no such options."""
        from liftmesh.io.write import writer_of

        if is_stream(self.path):
            check_stdout()
        kind = self._kind()
        if kind.write is None:
            raise FormatError(f"{self.path}: {kind.name} files can be read, not written")
        check_place(self.path)
        try:
            for each in self.writing.keys() - {"compact"}:  # of all formats
                writer_of(kind, str(self.path), {each: self.writing[each]})
        except FormatError as error:
            name = each.replace("_", "-")
            raise click.BadParameter(f"--{name}: {kind.name} files have none") from error

    def check_content(self, cloud: Cloud) -> None:
        """Raise before the work starts if the file cannot hold what a mesh of these rows has."""
        from liftmesh.crs.units import system_of
        from liftmesh.io.format import check_before

        kind, has_unit = self._kind(), "unit" in self.writing
        check_before(replace(kind, check=None) if has_unit else kind, cloud)
        if has_unit or kind.name not in _TAKEN_UNITS:
            return
        system = system_of(cloud)
        if cloud.crs is None:
            said = f"no coordinate system says the unit: {kind.name} states "
            terminal.note(f"{self.path}: {said}{_TAKEN_UNITS[kind.name]}")
        elif system is not None and system.units[2] is None and system.units[0] is not None:
            said = f"nothing says the unit of heights: {kind.name} states {system.units[0].name}"
            terminal.note(f"{self.path}: {said} for them, too")

    def _kind(self) -> Format:
        from liftmesh.io.registry import find_written
        from liftmesh.io.streams import suffix_of

        if not (self.file_format or self.path.suffix):
            raise click.BadParameter(
                f"{self.path} has no suffix: give its format with --output-format"
            )
        return find_written(self.file_format or suffix_of(self.path.name), str(self.path))

    def write(self, mesh: Any) -> WriteResult:
        """Write a mesh."""
        from liftmesh.io import streams, write as io

        if not is_stream(self.path):
            with terminal.writing(f"writing {self.path.name}", streams.written):
                # The command's guard has looked before the work started.
                return io.write(
                    self.path, mesh, format=self.file_format, overwrite=True, **self.writing
                )
        with opened(self.path) as stream:
            return io.write(stream, mesh, format=self.file_format, **self.writing)

    def takes_chunks_of(self, source: str) -> bool:
        """Whether the file can be written in chunks, as a file of another format is read."""
        kind = self._kind()
        return not is_stream(self.path) and kind.name == source and kind.write_chunks is not None

    def write_chunks(self, chunks: Iterable[Cloud]) -> WriteResult:
        """Write the chunks of a cloud."""
        from liftmesh.io.write import write_chunks

        return write_chunks(self.path, chunks, format=self.file_format, **self.writing)


def target(text: str, *, has_writing: bool = True) -> options.Group:
    """Make the group of a file to write, of which this is said, and of options of its format."""

    def parse(target: Path, output_format: str | None = None, **writing: Any) -> Target:
        return Target(target, output_format, options.given(**writing))

    out = argument("OUT", text)
    parameters = [options.parameter("target", Path, out, inspect.Parameter.empty), _FORMAT]
    return options.Group(
        options.with_parameters(parse, parameters + _WRITING * has_writing), "Output"
    )


_FORMAT = options.parameter(
    "output_format", str | None, option("FORMAT", "Format of OUT, instead of its suffix.")
)
_WRITING = [
    options.parameter(
        "compact", bool, flag("Leave out rows in no face, as those of a trimmed surface."), False
    ),
    options.parameter(
        "scale",
        float | None,
        option("STEP", "Of LAS: the step that coordinates are rounded to.", positive),
    ),
    options.parameter(
        "point_format", int | None, option("N", "Of LAS: the point format, 0 to 10.", whole(0))
    ),
    options.parameter("unit", Unit3MF | None, flag("Of 3MF: the unit of coordinates.")),
    options.parameter(
        "up", Up | None, flag("Of GLB, glTF and OBJ: the axis that is up; of OBJ by default z.")
    ),
    options.parameter(
        "origin",
        Any,
        option(
            "X,Y,Z",
            "Of GLB, glTF and OBJ: the place that becomes zero, as engines need it near the "
            "model; center chooses one.",
            options.origin,
        ),
        None,
    ),
    options.parameter(
        "texture",
        Path | None,
        option("FILE", "Of GLB and glTF: an orthophoto (GeoTIFF) to put over the faces."),
    ),
]


def check_place(path: Path | None) -> None:
    """Raise before the work starts if nothing can be written at a path."""
    from liftmesh.io.atomic import check_writable

    if path is not None and not is_stream(path):
        check_writable(path)


@contextmanager
def opened(path: Path) -> Iterator[BinaryIO]:
    """Open a file that is put in place when it is whole, or stdout, unless a signal came."""
    from liftmesh.io.atomic import replacing

    if not is_stream(path):
        with terminal.stage(f"writing {path.name}"), replacing(path) as stream:
            yield stream
        return
    with terminal.stage("writing stdout"):
        check()
        # Of its own: an unbuffered sys.stdout may write a part without an error.
        with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as stream:
            yield stream


def headline(written: WriteResult, content: str) -> str:
    """Say in a line what was written, and how the file differs from the mesh."""
    line = f"{written.path or '-'}: {content}, {terminal.bytes_text(written.bytes)}"
    if written.dropped:
        line += f"; {written.format} does not keep {', '.join(written.dropped)}"
    if written.renamed:
        line += f"; renamed: {', '.join(f'{name!r} to {new}' for name, new in written.renamed)}"
    if written.origin is None:
        return line
    moved = ", ".join(f"{value:.10g}" for value in written.origin)
    why = "" if written.format == "obj" else "float32, so "
    return f"{line}; {why}the origin ({moved}) was subtracted"


def as_values(written: WriteResult) -> dict[str, Any]:
    """Return what `--json` prints of a file that was written."""
    return {
        "path": str(written.path or "-"),
        "format": written.format,
        "bytes": written.bytes,
        "origin": written.origin,
        "dropped": list(written.dropped),
        "renamed": dict(written.renamed),
    }


def report(
    written: WriteResult,
    content: str,
    values: Mapping[str, Any],
    rows: Sequence[tuple[str, str]] = (),
    *,
    as_json: bool,
) -> None:
    """Print what is said of a file that was written: values as JSON, or a line and a table."""
    with report_after(written.path or Path("-")):
        if as_json:
            terminal.as_json({**as_values(written), **values})
            return
        terminal.sentence(headline(written, content), "good")
        if rows:
            terminal.table(rows)


def as_named(counts: Mapping[str, int]) -> dict[str, int]:
    """Return counts as `--json` prints them."""
    return {f"n_{name.replace(' ', '_')}": count for name, count in counts.items()}


def as_rows(counts: Mapping[str, int]) -> list[tuple[str, str]]:
    """Return counts as rows of a table."""
    return [(name.replace("_", " "), f"{count:,}") for name, count in counts.items()]


def check_stdout() -> None:
    """Raise before the work starts if the result could not be printed."""
    if isinstance(sys.stdout, Closed):
        sys.stdout.write("")


@contextmanager
def report_after(target: Path | None) -> Iterator[None]:
    """Print what is said of a file that was written: on stderr if the file itself is stdout."""
    is_stdout = target is not None and is_stream(target)
    place = redirect_stdout(sys.stderr) if is_stdout else dispensable_stdout()
    with place, after_writing(target):
        yield


@contextmanager
def dispensable_stdout() -> Iterator[None]:
    """Drop what is printed if stdout is closed: the results are in files."""
    if not isinstance(sys.stdout, Closed):
        yield
        return
    with open(os.devnull, "w", encoding="utf-8") as null, redirect_stdout(null):  # noqa: PTH123
        yield


@contextmanager
def after_writing(*paths: Path | None) -> Iterator[None]:
    """Add to an error of stdout, such as a full disk, that files were written before."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        names = [str(path) for path in paths if path is not None and not is_stream(path)]
        if names and error.filename is None:
            verb = "was" if len(names) == 1 else "were"
            error.strerror = f"{error.strerror}; {' and '.join(names)} {verb} written"
        raise
