"""Several input files as one cloud, and whose row an error is about."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from liftmesh.base.options import counted
from liftmesh.cli import files
from liftmesh.cli.terminal import few_of_a_kind, note, stage
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_ROW = re.compile(r"\b(rows?) ([0-9]+)( and ([0-9]+))?")


def check_once(sources: Sequence[Path]) -> None:
    """Raise if a file is given twice."""
    known: dict[object, Path] = {}
    for each in sources:
        before = known.setdefault(_identity(each), each)
        if before is not each:
            other = "" if str(before) == str(each) else f", as {before}"
            raise typer.BadParameter(f"{each} is given twice{other}")


def _identity(path: Path) -> object:
    """Return what two names of one file have in common."""
    try:
        found = None if files.is_stream(path) else path.stat()
    except OSError:
        found = None
    return path if found is None or not found.st_ino else (found.st_dev, found.st_ino)


def merged(
    sources: Sequence[Path], read: Callable[..., Cloud], selection: Mapping[str, Any]
) -> Cloud:
    """Read files and merge them; say on stderr how many rows each adds."""
    from liftmesh.io.surface_rows import check_some  # noqa: PLC0415 - help does without

    if len(sources) == 1:
        return check_some(read(sources[0], selection=selection), sources[0])
    for path in sources:
        if not files.is_stream(path):
            path.open("rb").close()  # one that is missing is told before the others are read
    from liftmesh.terrain.merging import merge  # noqa: PLC0415 - help does without

    if "crs" in selection:
        rest = {key: each for key, each in selection.items() if key != "crs"}
        selection = {**rest, files.CRS_OF_OTHERS: selection["crs"]}
    with few_of_a_kind():
        clouds = [read(each, selection=selection) for each in sources]
    lacking = [str(path) for path, each in zip(sources, clouds, strict=True) if each.crs is None]
    before = {name for each in clouds for name in files.parts_not_read(each)}
    with stage(f"merging {len(sources)} files"), files.without_warnings():
        cloud = merge(clouds.pop(0) for _ in sources)
    if cloud.crs is not None and lacking:
        note(f"{', '.join(lacking)}: no coordinate system: taken to be that of the others")
    with few_of_a_kind():
        _say_parts(cloud)
    new = [name for name in files.parts_not_read(cloud) if name not in before]
    if new:
        note(f"merged without {files.listed([each.partition(' (')[0] for each in new])}")
    return check_some(cloud, files.listed([str(each) for each in sources]))


def _say_parts(cloud: Cloud) -> None:
    """Say on stderr how many rows each file adds, and where they overlap."""
    from liftmesh.terrain.merging import parts_of  # noqa: PLC0415 - help does without

    far = (
        ", {:.4g} away from all earlier files, and none states a coordinate system: they may be in "
        "different ones; --from-crs says which"
    )
    for each in parts_of(cloud):
        inside = f", {each['overlap']:,} of them where an earlier file has some"
        note(
            f"{each['source']}: {counted(each['rows'], 'row')}"
            + (inside if each["overlap"] else "")
            + (far.format(each["distance"]) if "distance" in each else "")
        )
    flown = cloud.metadata.get("flight_lines")
    if flown and flown["lines"] > 1:
        where = f"in cells of size {flown['cell']:.3g} where several lines have some"
        note(f"{flown['lines']:,} flight lines; {flown['overlap']:,} rows are {where}")


@contextmanager
def about(sources: Sequence[Path], cloud: Cloud) -> Iterator[None]:
    """Add the file's name to errors about rows, and count the row in that file."""
    if len(sources) == 1:
        with files.about(sources[0]):
            yield
        return
    from liftmesh.terrain.merging import parts_of  # noqa: PLC0415 - help does without

    starts = [(each["source"], each["rows"]) for each in parts_of(cloud)]
    try:
        yield
    except InputError as error:
        if files.is_about_rows(error) and "thinning" not in cloud.metadata:
            error.args = (_ROW.sub(lambda found: _placed(found, starts), str(error)),)
        raise


def _placed(found: re.Match[str], starts: Sequence[tuple[str, int]]) -> str:
    numbers = [int(each) for each in (found[2], found[4]) if each is not None]
    return " and ".join(_of_file(each, starts) for each in numbers)


def _of_file(row: int, starts: Sequence[tuple[str, int]]) -> str:
    """Say which row of which file a row of all is."""
    for name, count in starts:
        if row < count:
            return f"row {row} of {name}"
        row -= count
    return f"row {row}"
