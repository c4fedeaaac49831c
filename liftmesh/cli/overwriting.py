"""What commands do not replace: their inputs, and without ``--overwrite`` any file with content.

An output that is an input, by whatever name, option or link, is refused always, also where it would
be read wholly before: the output may hold less. So is a file in a folder that is an input, and one
that is read beside an input.
"""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import wraps
from itertools import combinations
from pathlib import Path
from typing import Annotated, Any

import typer

from liftmesh.cli.files import is_stream

_OPTION = inspect.Parameter(
    "overwrite",
    inspect.Parameter.KEYWORD_ONLY,
    default=False,
    annotation=Annotated[
        bool, typer.Option("--overwrite", help="Replace a file that exists; never an input.")
    ],
)
_BESIDE = {
    ".shp": (".dbf", ".prj", ".cpg"), ".ele": (".node",), ".asc": (".prj",),
    ".tif": (".prj", ".tfw", ".wld"), ".tiff": (".prj", ".tfw", ".wld"),
}  # fmt: skip


def guards(*outputs: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a decorator that gives a command ``--overwrite``, and checks what it would replace.

    Parameters
    ----------
    *outputs : str
        The parameters that are files to write. All others that name a file are inputs.

    Returns
    -------
    callable
        The outermost decorator of a command, whose check precedes all others.

    Examples
    --------
    >>> @guards("target")
    ... def run(source: Path, target: Path) -> None:
    ...     print(source, target)
    >>> run(source=Path("a.ply"), target=Path("b.ply"))
    a.ply b.ply
    """

    def decorate(run: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(run)
        def command(*, overwrite: bool = False, **values: Any) -> Any:
            targets = [values[each] for each in outputs if values.get(each) is not None]
            check(targets, _inputs(values, outputs), overwrite=overwrite)
            return run(**values)

        signature = inspect.signature(run, eval_str=True)
        parameters = [each.replace(kind=_OPTION.kind) for each in signature.parameters.values()]
        parameters.append(_OPTION)
        command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        command.__annotations__ = {each.name: each.annotation for each in parameters}
        return command

    return decorate


def check(targets: Sequence[Path], inputs: Iterable[Path], *, overwrite: bool = True) -> None:
    """Raise before the work starts if a file would be lost.

    Parameters
    ----------
    targets : sequence of Path
        The files to write; standard streams, pipes and devices hold nothing that can be lost.
    inputs : iterable of Path
        The files and folders that are read.
    overwrite : bool
        Whether other files are replaced.

    Raises
    ------
    typer.BadParameter
        Two outputs are one file, an output is an input, or a file exists and may not be replaced.
    """
    files = [each for each in targets if not is_stream(each)]
    for one, other in combinations(files, 2):
        if os.path.realpath(one) == os.path.realpath(other):
            raise _same(one, other)
    from liftmesh.io.atomic import holds_data  # noqa: PLC0415 - help and --version do without

    read = [*inputs]
    for target in files:
        for each in read:
            if _is_part(target, each):
                raise _same(each, target)
            if _is_named(target, each):
                raise typer.BadParameter(
                    f"{target} is a part of {each}, and would be lost: give another name"
                )
        if not overwrite and holds_data(target):
            raise typer.BadParameter(
                f"{target} exists, and would be lost: give another name for what is written, or "
                "--overwrite to replace it"
            )


def _inputs(values: Mapping[str, Any], outputs: Sequence[str]) -> Iterator[Path]:
    """List whatever may name a file among the values of a command."""
    for key, value in values.items():
        for each in [] if key in outputs else value if isinstance(value, list) else [value]:
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
        found = os.fstat(sys.stdin.fileno()) if is_stream(source) else where.stat()
        return os.path.samestat(found, place.stat()) and place.is_file()
    return place == where


def _is_named(target: Path, source: Path) -> bool:
    """Whether a file is a buffer or an image of a glTF file that is an input."""
    is_model = source.suffix.lower() in (".gltf", ".glb") and source.is_file()
    if not is_model or not target.is_file():
        return False
    from liftmesh.io.gltf.beside import named_in  # noqa: PLC0415 - help and --version do without

    return any(_is_part(target, each) for each in named_in(source))


def _same(one: Path, other: Path) -> typer.BadParameter:
    if is_stream(one) or Path(one).is_dir():
        return typer.BadParameter(f"{other} is read as {one}, and would be lost: give another name")
    return typer.BadParameter(
        f"{one} and {other} are the same file, and one would overwrite the other: give another name"
    )
