"""Clouds that commands read, from one or several files; which file a faulty row came from."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import click

from liftmesh.base.options import Returns, Up, counted
from liftmesh.cli import notes, options, terminal
from liftmesh.cli.options import flag, is_stream, option, positive, whole
from liftmesh.cli.terminal import note
from liftmesh.cli.wording import worded
from liftmesh.errors import CrossingError, DataWarning, FormatError, InputError, Message, Option

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_CRS_OF_OTHERS = "crs_of_others"  # the option for files that state no system
_OF_LINES = (  # warnings that are not among the notes
    "the points have .* edges?, not used|.* lie beyond all points|the cloud is no height field"
    "|.*: layer .* is read, and|.*: its coordinate system is not known"
)
_LINE = re.compile(  # that a message is about: its option begins so
    r"(?:a ring of polygon \d+ of )?(boundary|holes|edge|polyline|polygon|(?:soft )?breakline)\b"
)
_ROW = re.compile(r"\b(rows?) ([0-9]+)( and ([0-9]+))?")


def table(
    columns: Annotated[
        str | None,
        option(
            "NAMES",
            "Tables: the columns, as x=East,y=North,z=H (z=-Depth for depths), or the names "
            "of all in order, as id,x,y,z; - leaves one out.",
        ),
    ] = None,
    flat: Annotated[bool, flag("Tables: heights do not matter; z is 0.")] = False,
    delimiter: Annotated[
        str | None, option("MARK", "Tables: what separates values, as ';', tab or space.")
    ] = None,
    decimal: Annotated[str | None, option("MARK", "Tables: the decimal mark, . or ,")] = None,
    skip_rows: Annotated[int, option("N", "Tables: skip the first N lines.", whole(0))] = 0,
    no_header: Annotated[bool, flag("Tables: the first line is a row.")] = False,
    nodata: Annotated[
        str | None,
        option(
            "VALUE",
            "Tables and rasters: what stands for a missing value, as -9999; none if nothing does.",
        ),
    ] = None,
    end: Annotated[str | None, option("LINE", "Tables: the line that ends them, as END.")] = None,
    encoding: Annotated[
        str | None, option("NAME", "Tables: the encoding of the text, as cp1252, if not UTF.")
    ] = None,
) -> dict[str, Any]:
    """Check the options of tables, and return those given, as `liftmesh.read` has them."""
    given = options.given(columns=columns, delimiter=delimiter, decimal=decimal, nodata=nodata)
    given |= options.given(end=end, encoding=encoding, flat=flat)
    given |= {"header": False} if no_header else {}
    given |= options.given(skip_rows=skip_rows or None)
    if given:
        from liftmesh.io.options import validate_table_options

        with options.as_usage():
            validate_table_options(**given)
    return given


def _selection(
    classes: Annotated[
        Any,
        option(
            "CLASSES",
            "Rows of these classes, as 2,9; or ground: class 2 if there is any, as by default of "
            "LAS and LAZ.",
            options.classes,
        ),
    ] = None,
    all_classes: Annotated[bool, flag("Rows of every class.")] = False,
    returns: Annotated[
        Returns | None,
        flag("Rows of the last or the first return, or of those that are both."),
    ] = None,
    bounds: Annotated[
        Any,
        option("XMIN,YMIN,XMAX,YMAX", "Rows inside a rectangle, or on its border.", options.ends),
    ] = None,
    z_range: Annotated[Any, option("Z0,Z1", "Rows of these heights.", options.ends)] = None,
    every: Annotated[int, option("N", "Every n-th of the rows that are left.", whole(1))] = 1,
    withheld: Annotated[bool, flag("Rows flagged as withheld, too.")] = False,
    copc_resolution: Annotated[
        float | None, option("D", "Of a COPC file, points at about this distance.", positive)
    ] = None,
    band: Annotated[
        int | None,
        option(
            "N",
            "Rasters: the band that holds the heights; the first is 1.",
            whole(1),
            panel="Input",
        ),
    ] = None,
    landxml_surface: Annotated[
        str | None,
        option("NAME", "LandXML: the surface to read, or CgPoints.", panel="Input"),
    ] = None,
    layer: Annotated[
        str | None, option("NAME", "GeoPackage: the layer to read, of several.", panel="Input")
    ] = None,
    src_crs: Annotated[
        str | None,
        option(
            "CRS",
            "The coordinate system of the file, as EPSG:25832, in place of what it states; of "
            "several, of those that state none, or the same without heights.",
            panel="Input",
        ),
    ] = None,
    dst_crs: Annotated[
        str | None,
        option("CRS", "Transform the coordinates to this system, as EPSG:25832.", panel="Input"),
    ] = None,
) -> dict[str, Any]:
    """Check the conditions on rows, and return those given, with where the rows are read to."""
    if classes is not None and all_classes:
        raise click.BadParameter("--classes and --all-classes exclude each other: leave one out")
    chosen = "all" if all_classes else classes
    conditions = options.given(classes=chosen, returns=returns, bounds=bounds, z_range=z_range)
    conditions |= options.given(
        every=every if every > 1 else None, withheld=withheld, copc_resolution=copc_resolution
    )
    if conditions:
        from liftmesh.io.selection import validate_selection

        with options.as_usage():
            validate_selection(**conditions)
    return conditions | options.given(
        dst_crs=dst_crs,
        src_crs=src_crs,
        band=band,
        landxml_surface=landxml_surface,
        layer=layer,
    )


Table: TypeAlias = Annotated[dict[str, Any], options.Group(table, "Input")]
Selection: TypeAlias = Annotated[dict[str, Any], options.Group(_selection, "Selection")]


def _rows(*, table: Table, selection: Selection) -> dict[str, Any]:
    return {**table, **selection}


Rows: TypeAlias = Annotated[dict[str, Any], options.Group(_rows)]


def _file(
    input_format: Annotated[
        str | None, option("FORMAT", "Format of the input, instead of its suffix.", panel="Input")
    ] = None,
    max_bytes: Annotated[
        int | None,
        option(
            "SIZE",
            "Limit of what a compressed, instanced or very wide file may expand to in memory, as "
            "500M or 4G.",
            options.size,
            panel="Advanced",
        ),
    ] = None,
    input_up: Annotated[
        Up | None,
        flag(
            "GLB, glTF, OBJ: the axis that is up, in place of what the file says; without either "
            "it is y in glTF, z in OBJ.",
            panel="Input",
        ),
    ] = None,
) -> dict[str, Any]:
    return options.given(format=input_format, max_bytes=max_bytes, up=input_up)


File: TypeAlias = Annotated[dict[str, Any], options.Group(_file)]


def _reading(*, file: File, rows: Rows) -> dict[str, Any]:
    return {**file, **rows}


Reading: TypeAlias = Annotated[dict[str, Any], options.Group(_reading)]


def _colored(
    *,
    reading: Reading,
    color_depth: Annotated[
        int | None,
        option(
            "BITS",
            "Bits per channel of integer colours, 8 or 16; by default their values decide.",
            options.color_depth,
            panel="Input",
        ),
    ] = None,
) -> dict[str, Any]:
    return reading | options.given(color_depth=color_depth)


ColoredReading: TypeAlias = Annotated[dict[str, Any], options.Group(_colored)]

_OF_ALL_ROWS = {
    "classes": "Rows of these classes, as 2,9; or ground: class 2 if there is any. By default all.",
    "all_classes": "Rows of every class, as by default.",
    "withheld": "Rows flagged as withheld, too, as by default.",
}
AllRows: TypeAlias = Annotated[dict[str, Any], options.Group(_reading, texts=_OF_ALL_ROWS)]
AllColoredRows: TypeAlias = Annotated[dict[str, Any], options.Group(_colored, texts=_OF_ALL_ROWS)]


def read(path: Path, reading: Mapping[str, Any]) -> Cloud:
    """Read a cloud, or stdin if the path is ``-``; say on stderr how, and what is not read.

    What a command reads by are options of `liftmesh.read`, here and below.
    """
    if is_stream(path) and "format" not in reading:
        given = Option("format", ...)
        raise click.BadParameter(Message(f"stdin has no suffix: give its format with {given}"))
    name = "stdin" if is_stream(path) else path
    _check_file(path)
    from liftmesh.io.streams import progress

    text = f"reading {name if is_stream(path) else path.name}"
    place = terminal.stage(text) if is_stream(path) else terminal.reading(text, progress)
    with _about_reading(str(name)), place:
        cloud = _read_quietly(sys.stdin.buffer if is_stream(path) else path, reading)
    _say(str(name), cloud, reading)
    return cloud


def read_chunks(path: Path, reading: Mapping[str, Any]) -> Iterator[Cloud]:
    """Read a cloud in chunks; say on stderr how, and what is not read."""
    from liftmesh.io import read as io

    _check_file(path)
    pieces, is_first = io.read_chunks(path, **reading), True
    while True:
        with _about_reading(str(path)), without_warnings():
            cloud = next(pieces, None)
        if cloud is None:
            return
        if is_first:
            _say(str(path), cloud, reading)
        is_first = False
        yield cloud


def _say(name: str, cloud: Cloud, reading: Mapping[str, Any]) -> None:
    for each in notes.cloud_notes(cloud, is_transformed="dst_crs" in reading):
        note(f"{name}: {each}")
    if not_read := notes.parts_not_read(cloud):
        note(f"{name}: not read: {notes.listed(not_read)}")
    if "color_depth" not in reading and cloud.color_depth == 8 and len(cloud):
        context = click.get_current_context(silent=True)
        options_here = () if context is None else context.command.params
        is_here = any("--color-depth" in each.opts for each in options_here)
        how = "--color-depth says another" if is_here else "liftmesh triangulate has --color-depth"
        note(f"{name}: no colour exceeds 255: they are read as 8-bit colours ({how})")


def _check_file(path: Path) -> None:
    """Raise if a folder of triangles in tiles is given."""
    if not path.is_dir():
        return
    from liftmesh.tiles.store import MANIFEST

    if (path / MANIFEST).is_file():
        raise FormatError(
            f"{path}: this is a folder of tiles, not a file: of the commands, raster, contour, "
            "sample, clip, tileset and verify take it, and height as --ground"
        )


@contextmanager
def _about_reading(name: str) -> Iterator[None]:
    """Add the file's name to an error: streams do not know it."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            error.filename = name  # pragma: no cover - a device that fails while it is read
        raise


def _read_quietly(source: Any, reading: Mapping[str, Any]) -> Cloud:
    """Read without warnings: they are among the notes."""
    from liftmesh.crs.comparison import adds_heights, as_system
    from liftmesh.io import read as io

    with without_warnings():
        if _CRS_OF_OTHERS not in reading:
            return io.read(source, **reading)
        rest = {**reading}
        crs, target = rest.pop(_CRS_OF_OTHERS), rest.pop("dst_crs", None)
        crs = as_system("src_crs", crs)
        cloud = io.read(source, **rest)
        return io.placed(cloud, crs if adds_heights(cloud.crs, crs) else None, target)


@contextmanager
def without_warnings() -> Iterator[list[str]]:
    """Leave out warnings about data that are among the notes; yield a list of those shown."""
    told: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)
        warnings.filterwarnings("always", _OF_LINES, DataWarning)
        other = warnings.showwarning

        def show(message: Any, *rest: Any) -> None:
            told.append(worded(message.args[0]))
            other(message, *rest)

        warnings.showwarning = show  # type: ignore[assignment]
        yield told


def read_rows(
    sources: Sequence[Path], reading: Mapping[str, Any], *, of_surface: bool = True
) -> Cloud:
    """Read files and merge them; say on stderr how many rows each adds.

    Of lidar a surface takes the ground, and no rows that are withheld, unless options say so.
    """
    from liftmesh.io.read import check_some, for_surface

    def read_one(path: Path) -> Cloud:
        file_format = reading.get("format")
        return read(path, for_surface(path, reading, file_format) if of_surface else reading)

    if len(sources) == 1:
        return check_some(read_one(sources[0]), sources[0])
    for path in sources:
        if not is_stream(path):
            path.open("rb").close()  # one that is missing is told before the others are read
    if "src_crs" in reading:
        rest = {key: each for key, each in reading.items() if key != "src_crs"}
        reading = {**rest, _CRS_OF_OTHERS: reading["src_crs"]}
    with terminal.few_of_a_kind():
        clouds = [read_one(each) for each in sources]
    cloud = _merged(sources, clouds)
    return check_some(cloud, notes.listed([str(each) for each in sources]))


def _merged(sources: Sequence[Path], clouds: list[Cloud]) -> Cloud:
    """Merge clouds, and say what each adds; their list is empty then."""
    from liftmesh.terrain.merging import merge

    lacking = [str(path) for path, each in zip(sources, clouds, strict=True) if each.crs is None]
    before = {name for each in clouds for name in notes.parts_not_read(each)}
    with terminal.stage(f"merging {len(sources)} files"), without_warnings():
        cloud = merge(clouds.pop(0) for _ in sources)
    if cloud.crs is not None and lacking:
        note(f"{', '.join(lacking)}: no coordinate system: taken to be that of the others")
    with terminal.few_of_a_kind():
        _say_parts(cloud)
    new = [name for name in notes.parts_not_read(cloud) if name not in before]
    if new:
        note(f"merged without {notes.listed([each.partition(' (')[0] for each in new])}")
    return cloud


def _say_parts(cloud: Cloud) -> None:
    """Say on stderr how many rows each file adds, and where they overlap."""
    far = (
        ", {:.4g} away from all earlier files, and none states a coordinate system: they may be in "
        "different ones; --src-crs says which"
    )
    for each in notes.provenance_of(cloud).merged:
        inside = f", {each['overlap']:,} of them where an earlier file has some"
        note(
            f"{each['source']}: {counted(each['rows'], 'row')}"
            + (inside if each["overlap"] else "")
            + (far.format(each["distance"]) if "distance" in each else "")
        )
    flown = notes.provenance_of(cloud).flight_lines
    if flown and flown["lines"] > 1:
        where = f"in cells of size {flown['cell']:.3g} where several lines have some"
        note(f"{flown['lines']:,} flight lines; {flown['overlap']:,} rows are {where}")


def check_once(sources: Sequence[Path]) -> None:
    """Raise if a file is given twice."""
    known: dict[object, Path] = {}
    for each in sources:
        before = known.setdefault(_identity(each), each)
        if before is not each:
            other = "" if str(before) == str(each) else f", as {before}"
            raise click.BadParameter(f"{each} is given twice{other}")


def _identity(path: Path) -> object:
    """Return what two names of one file have in common."""
    try:
        status = None if is_stream(path) else path.stat()
    except OSError:
        status = None
    return path if status is None or not status.st_ino else (status.st_dev, status.st_ino)


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Add the file's name to errors about its rows and its values."""
    try:
        yield
    except InputError as error:
        if _is_about_data(error):
            error.within("stdin" if is_stream(path) else path)
        raise


@contextmanager
def about_rows(sources: Sequence[Path], cloud: Cloud) -> Iterator[None]:
    """Add the file to errors about rows of several files, merged, and count rows within it."""
    if len(sources) == 1:
        with about(sources[0]):
            yield
        return
    starts = [(each["source"], each["rows"]) for each in notes.provenance_of(cloud).merged]
    try:
        yield
    except InputError as error:
        if _is_about_data(error) and not notes.provenance_of(cloud).thinning:
            placed = _ROW.sub(lambda found: _placed(found, starts), error.message.marked)
            error.args = (Message(placed),)
        raise


@contextmanager
def about_lines(lines: Mapping[str, Any]) -> Iterator[None]:
    """Add the files of lines, if any, to an error about one, or about places where they cross."""
    files = {key: each for key, each in lines.items() if isinstance(each, Path)}
    names = {key: "stdin" if is_stream(each) else str(each) for key, each in files.items()}
    try:
        yield
    except CrossingError as error:
        if names:
            error.within(", ".join(names.values()))
        raise
    except InputError as error:
        word = found[1].replace(" ", "_") if (found := _LINE.match(error.message)) else None
        for key, name in names.items():
            if word is not None and key.startswith(word):
                raise FormatError(f"{name}: {error.message.marked}") from error
        raise


def _is_about_data(error: InputError) -> bool:
    """Whether an error is about what a file of points holds, and not about options or lines."""
    if isinstance(error, CrossingError):
        return False
    parts = error.message.parts
    return not any(isinstance(each, Option) and each.value is None for each in parts)


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
