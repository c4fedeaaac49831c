"""read(), read_chunks() and read_cloud(): from files, streams and objects to clouds.

Formats that have no reader of chunks are read whole, then split. The depth of colours is decided
once, from all chunks of a file.

`for_surface` is the one rule which rows of a file a surface takes: of lidar (LAS, LAZ, COPC) the
ground and no withheld rows, unless the caller says otherwise. `read_for_surface` applies it to one
file, `for_chunks` to files that are read in chunks, and the command line asks it in
`cli/inputs.py`. Whether there is ground is decided over all files of a surface: trees of the one
tile without classes would stand among the ground of the others.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.colors import check_depth
from liftmesh.base.interruption import preserve_signals
from liftmesh.base.options import ClassChoice, Returns, as_count, refused
from liftmesh.crs.comparison import as_system, is_same
from liftmesh.crs.description import parse_crs
from liftmesh.crs.transformation import Operation, transform, with_heights
from liftmesh.crs.units import SAYING_UNITS, height_factors, steps_in
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.columns import POSITION
from liftmesh.io.format import ChunkReader, Format, Reader, configured
from liftmesh.io.formats.text.columns import DEGREES
from liftmesh.io.metadata import Label, Provenance, noted
from liftmesh.io.registry import as_cloud, find_format
from liftmesh.io.selection import (
    GROUND,
    MOST_CLASSES,
    Selection,
    Selector,
    class_column,
    selected,
    validate_selection,
)
from liftmesh.io.streams import PathOrStream, at_home, format_of, name_of, opened, suffix_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.options import FormatOptions, ReadOptions

CHUNK_ROWS = 1_000_000
_NO_MORE: Any = object()

Read = TypeVar("Read")


def read(  # noqa: PLR0913 - options are keywords
    source: PathOrStream,
    *,
    format: str | None = None,  # noqa: A002
    max_bytes: int | None = None,
    color_depth: int | None = None,
    classes: ClassChoice = None,
    returns: Returns | None = None,
    bounds: Iterable[float] | None = None,
    z_range: Iterable[float] | None = None,
    every: int = 1,
    withheld: bool = True,
    copc_resolution: float | None = None,
    src_crs: Any = None,
    dst_crs: Any = None,
    **options: Unpack[FormatOptions],
) -> Cloud:
    r"""Read a point cloud or a mesh.

    Parameters
    ----------
    source : str, path, or binary stream
        PLY, OBJ, XYZ/CSV/TXT/ASC/TSV, NPY, NPZ, STL, OFF, GLB, glTF, PCD, PTS, XYZRGB, XYZN, E57,
        LandXML, DXF, 2DM, .node, .poly, .ele (with the .node file beside it), LAS, LAZ and COPC,
        points and TIN of GeoJSON, GeoPackage and shapefiles (.shp, with what is beside it),
        GeoTIFF and ASCII grids (.agr, or ``format="raster"``), or a format of a plugin; those of
        text also compressed with gzip, as ``points.csv.gz``. ``~`` at the beginning of a path is
        the home folder.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name.
    max_bytes : int, optional
        Maximum number of bytes in memory of what a file may expand to. Of a GLB or glTF file, the
        meshes count, each as often as it is used; by default 256 MiB or 20 times the file. Of an
        NPZ file, the arrays; by default 256 MiB or 1,100 times their compressed bytes, which none
        exceeds. Of PLY and text, each column, property and element counts 2,000 bytes;
        by default 20,000,000, for 10,000 of them. Of a file compressed with gzip, the text; by
        default 256 MiB or 20 times the file. Of GeoJSON, what its text describes; by default 16 MiB
        or 18 times the text. Other formats do not expand.
    color_depth : int, optional
        Bits per channel that the numbers of integer colours mean: 8, 16, 32 or 64. By default the
        values of the whole file decide, and ``Cloud.color_depth`` says what: LAS keeps colours in
        16 bits, and most programs put 8-bit values there.
    classes : int, iterable of int, "ground" or "all", optional
        The classes of the rows to read, by the column ``classification`` or ``class``. "ground" is
        class 2 if any row has it, else all rows. By default all.
    returns : {"last", "first", "only"}, optional
        The returns to read: the last ones, whose ``return_number`` is their ``number_of_returns``;
        the first ones; or those that are both.
    bounds : (4,) iterable of float, optional
        xmin, ymin, xmax, ymax of the rectangle to read, in the units of the file, with its border.
    z_range : (2,) iterable of float, optional
        Lowest and highest z to read.
    every : int, default 1
        Read every k-th of the rows that meet all other conditions, the first one among them.
    withheld : bool, default True
        Whether to read rows that the file flags as withheld.
    copc_resolution : float, optional
        Of a COPC file, read no more points than it takes for this distance between them. Of COPC,
        `bounds` and `z_range` read the parts of the file that may have any.
    src_crs : str, int or CRS, optional
        The coordinate system of the file, in place of what it states: WKT, ``EPSG:n``, or whatever
        ``pyproj.CRS.from_user_input`` takes, but texts that may name files.
    dst_crs : str, int or CRS, optional
        Another coordinate system, given as `src_crs`, that coordinates are transformed to, by
        pyproj; conditions on rows are in the units of the file. Heights keep their unit, and their
        system is added to the other one, unless that says what heights are; then the file has to
        say it, too, or `src_crs`. Of the operations for the first row the most accurate one that is
        installed transforms all; ``metadata["transformation"]`` has the "operation", its "accuracy"
        in metres, and a "better" one with its "grid", if that is missing.
    **options
        Options of the format. Tables as text take:

        - ``columns``: what the columns are, as ``"x=East,y=North,z=H"`` or a mapping; or the names
          of all columns in order, as ``"id,x,y,z"`` or a sequence, where ``-`` leaves one out.
          ``z=-Depth`` turns depths into heights.
        - ``flat=True``: heights do not matter; z is 0. ``flat=None``: only if no column is known as
          the height.
        - ``delimiter``: a character, or ``"space"`` for blanks; by default it is detected.
        - ``decimal``: ``"."`` or ``","``.
        - ``skip_rows``: the number of lines to skip at the top.
        - ``header=False``: the first line is a row, whatever it holds.
        - ``nodata``: the number or text that stands for a missing value, which becomes NaN;
          ``"none"`` if even -9999 is a value.
        - ``end``: the line that ends the table.
        - ``encoding``: of the text, as ``"cp1252"``; by default UTF-8, or UTF-16 with its mark.

        Rasters take ``band``, from 1, and ``nodata``: a number, besides what the file says.
        LandXML takes ``landxml_surface``: the name of one of several, or ``"CgPoints"`` for the
        points of the survey. GeoJSON, GeoPackage and shapefiles take ``columns``, ``flat`` and
        ``nodata`` as tables do, and ``layer``: the name of one of several in a GeoPackage. GLB,
        glTF and OBJ take ``up``, "y" or "z", and ``origin``, the place of their zero, in place of
        what the file says; without it y is up in glTF, as its standard says, and z in OBJ.

    Returns
    -------
    Cloud
        The rows in the file's order, with colours, normals, attributes, faces and coordinate system
        if the file has them. ``metadata["source"]`` is the file's name, ``metadata["format"]`` the
        format's. Of a table, ``metadata["columns"]`` says which columns are what. If rows were
        selected, ``metadata["selection"]`` counts those left out, by condition, and faces are left
        out.

    Raises
    ------
    FormatError
        The format is unknown, the file is invalid, it expands to more than the limit, or rows are
        selected by values that it does not have: the message gives the file, the line or byte, and
        the cause.
    InputError
        `max_bytes` is not a positive whole number, `color_depth` is no depth, or too small, an
        option is invalid, `src_crs` is unknown, or the coordinates cannot be transformed.
    MissingDependencyError
        The format, or `dst_crs`, needs a package that is not installed; the message names it.
    OSError
        The file does not exist or cannot be opened.

    Warns
    -----
    DataWarning
        Coordinates are degrees, or have different units.

    See Also
    --------
    read_chunks : Files that memory does not hold.
    as_cloud : Objects of other libraries.
    write : Write a file.

    Examples
    --------
    >>> import io
    >>> cloud = read(io.BytesIO(b"x,y,z,class\n0,0,5,2\n1,0,6,2\n"), format="csv")
    >>> cloud.points.tolist(), cloud.attributes["class"].tolist()
    ([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0]], [2.0, 2.0])
    """
    check_depth(color_depth)
    limit = None if max_bytes is None else as_count("max_bytes", max_bytes, 1)
    chosen = validate_selection(
        classes=classes,
        returns=returns,
        bounds=bounds,
        z_range=z_range,
        every=every,
        withheld=withheld,
        copc_resolution=copc_resolution,
    )
    if src_crs is not None:
        src_crs = as_system("src_crs", src_crs)
    source = at_home(source)
    name = name_of(source)
    file_format = format_of(source, format, name, find_format)
    read_whole = _selecting(_reader(file_format, name, limit, {**options}), file_format, chosen)
    with (
        opened(source, name, limit, may_be_compressed=file_format.gzip) as stream,
        preserve_signals(),
    ):
        cloud = _labelled(read_whole(stream, name), file_format, name)
    return _changed(cloud, color_depth, src_crs, dst_crs, name)


def read_chunks(  # noqa: PLR0913 - options are keywords
    source: PathOrStream,
    *,
    rows: int = CHUNK_ROWS,
    format: str | None = None,  # noqa: A002
    max_bytes: int | None = None,
    color_depth: int | None = None,
    classes: ClassChoice = None,
    returns: Returns | None = None,
    bounds: Iterable[float] | None = None,
    z_range: Iterable[float] | None = None,
    every: int = 1,
    withheld: bool = True,
    src_crs: Any = None,
    dst_crs: Any = None,
    **options: Unpack[FormatOptions],
) -> Iterator[Cloud]:
    r"""Read a point cloud in chunks, in bounded memory if its format allows it.

    PLY, text, LAS, LAZ, NPY and NPZ are read in chunks. Text is parsed twice, to determine the
    types of the columns first, and a file with integer colours of more than 8 bits is read once
    more, to decide their depth. Other formats, and pipes, are read whole, then split. Of files that
    are read in chunks, only what the rows need is read: damage to the faces, which `read` reports,
    is not noticed.

    Parameters
    ----------
    source : str, path, or binary stream
        What to read, as for `read`.
    rows : int, default 1,000,000
        Maximum number of rows of a chunk.
    format : str, optional
        As for `read`.
    max_bytes : int, optional
        As for `read`; of the arrays of an NPZ file, only those in use count.
    color_depth, classes, returns, bounds, z_range, every, withheld, src_crs, dst_crs, **options
        As for `read`, but `classes` cannot be "ground".

    Yields
    ------
    Cloud
        Consecutive rows, at most `rows` of them: together the rows of ``read(source)``, with the
        same types, colours, normals, attributes and coordinate system, without faces. If rows are
        selected, chunks have fewer, or none.

    Raises
    ------
    InputError
        `rows` or `max_bytes` is not a positive whole number, or `color_depth` is no depth, or too
        small.
    FormatError
        As for `read`, apart from faces: before the first chunk, or at the invalid chunk.
    OSError
        The file does not exist or cannot be opened.

    See Also
    --------
    read : A file at once.
    tile : Triangulate such files.

    Examples
    --------
    >>> import io
    >>> table = io.BytesIO(b"0 0 5\n1 0 6\n0 1 7\n")
    >>> [len(chunk) for chunk in read_chunks(table, rows=2, format="xyz")]
    [2, 1]
    """
    rows = as_count("rows", rows, 1)
    check_depth(color_depth)
    limit = None if max_bytes is None else as_count("max_bytes", max_bytes, 1)
    chosen = validate_selection(
        classes=classes,
        returns=returns,
        bounds=bounds,
        z_range=z_range,
        every=every,
        withheld=withheld,
    )
    if chosen is not None and chosen.classes == "ground":
        reason = f"which the whole file decides: give {Option('classes', 2)}"
        raise refused("classes", classes, reason, mark=", ")
    if src_crs is not None:
        src_crs = as_system("src_crs", src_crs)
    source = at_home(source)
    name = name_of(source)
    file_format = format_of(source, format, name, find_format)
    if file_format.read_chunks is None:
        whole = _reader(file_format, name, limit, {**options})
        chunks = split(_selecting(whole, file_format, chosen if file_format.selects else None))
        chosen = None if file_format.selects else chosen
    else:
        chunks = _limited(
            configured(file_format.read_chunks, file_format, name, {**options}), file_format, limit
        )
        chunks = of_one_depth(chunks, color_depth)
    place = opened(source, name, limit, may_be_compressed=file_format.gzip)
    pieces = _chunks(place, file_format, partial(chunks, name=name, rows=rows), name)
    if chosen is not None:
        pieces = _selected_chunks(pieces, Selector(chosen, name))
    known: dict[str, Operation] = {}
    return (_changed(each, color_depth, src_crs, dst_crs, name, known) for each in pieces)


def read_cloud(source: object) -> Cloud:
    """Read a file, or convert any object that holds points to a cloud."""
    return read(source) if isinstance(source, str | os.PathLike) else as_cloud(source)


def split(reader: Reader) -> ChunkReader:
    """Make a chunk reader from a reader of whole files."""

    def chunks(stream: BinaryIO, name: str, rows: int) -> Iterator[Cloud]:
        cloud = replace(reader(stream, name), edges=None)
        for start in range(0, len(cloud), rows):
            yield cloud.select(slice(start, start + rows))

    return chunks


def of_one_depth(chunks: ChunkReader, known: int | None) -> ChunkReader:
    """Make a chunk reader that decides the depth of colours once, from all chunks of a file."""

    def uniform(stream: BinaryIO, name: str, rows: int) -> Iterator[Cloud]:
        begin = stream.tell()
        pieces = chunks(stream, name, rows)
        first = next(pieces, None)
        if first is None:
            return
        if known is not None or first.color_depth is None:
            yield first
            yield from pieces
            return
        depths = [first.color_depth, *map(_depth, pieces)]
        depth = None if None in depths else max(filter(None, depths))
        stream.seek(begin)
        for piece in chunks(stream, name, rows):
            yield piece if depth is None else piece.with_color_depth(depth)

    return uniform


def _depth(piece: Cloud) -> int | None:
    is_narrow = piece.colors is not None and piece.colors.dtype == np.uint8
    return 8 if is_narrow else piece.color_depth


def _chunks(
    place: AbstractContextManager[BinaryIO],
    file_format: Format,
    chunks: Callable[[BinaryIO], Iterator[Cloud]],
    name: str,
) -> Iterator[Cloud]:
    with place as stream:
        with preserve_signals():
            pieces = iter(chunks(stream))
            chunk = next(pieces, _NO_MORE)
        while chunk is not _NO_MORE:
            yield _labelled(chunk, file_format, name)
            with preserve_signals():  # not around the yield: the caller's code is none of ours
                chunk = next(pieces, _NO_MORE)


def _selected_chunks(pieces: Iterator[Cloud], selector: Selector) -> Iterator[Cloud]:
    for piece in pieces:
        with preserve_signals():
            chosen = selected(piece, selector)
        yield chosen


def _selecting(reader: Reader, file_format: Format, chosen: Selection | None) -> Reader:
    """Let a reader leave out rows: as it reads, or afterwards."""
    if chosen is None:
        return reader
    if file_format.selects:
        return partial(reader, selection=chosen)

    def read_selected(stream: BinaryIO, name: str) -> Cloud:
        whole = _labelled(reader(stream, name), file_format, name)
        return selected(whole, Selector(chosen, name))

    return read_selected


def _reader(
    file_format: Format, name: str, limit: int | None, options: Mapping[str, Any]
) -> Reader:
    if file_format.read is None:
        raise FormatError(
            f"{name}: {file_format.name} files are written, not read: keep the mesh as PLY, too"
        )
    return _limited(configured(file_format.read, file_format, name, options), file_format, limit)


def _limited(
    reader: Callable[..., Read], file_format: Format, limit: int | None
) -> Callable[..., Read]:
    """Set the limit of a reader, if its format expands; others take none."""
    return partial(reader, max_bytes=limit) if file_format.expands else reader


def _labelled(cloud: Cloud, file_format: Format, name: str) -> Cloud:
    metadata = noted(cloud.metadata, source=Label(name), format=Label(file_format.name))
    return replace(cloud, metadata=metadata)


def _changed(
    cloud: Cloud,
    depth: int | None,
    crs: str | None,
    target: str | None,
    name: str,
    chosen: dict[str, Operation] | None = None,
) -> Cloud:
    """Set the depth of colours and the system of coordinates, if given; errors name the file."""
    try:
        cloud = cloud if depth is None else cloud.with_color_depth(depth)
        return placed(cloud, crs, target, chosen)
    except InputError as error:
        error.within(name)
        raise


def placed(
    cloud: Cloud,
    crs: str | None,
    target: str | None,
    chosen: dict[str, Operation] | None = None,
) -> Cloud:
    """Set the coordinate system of a cloud in place of what its file states, or transform it."""
    if crs is not None:
        is_other = cloud.crs is not None and not is_same(cloud.crs, crs)
        metadata = noted(cloud.metadata, stated_crs=cloud.crs if is_other else None)
        cloud = replace(cloud, crs=crs, metadata=metadata)
    if target is None:
        return cloud
    target = as_system("dst_crs", target)
    target = with_heights(cloud.crs, target)
    before, after = height_factors(cloud, target)
    found, told = transform(_raised(cloud.points, before), cloud.crs, target, chosen)
    metadata = noted(_moved(cloud, target), transformation=told)
    return replace(cloud, points=_raised(found, after), crs=target, metadata=metadata)


def _raised(points: Floats, factor: float) -> Floats:
    return points if factor == 1 else points * (1, 1, factor)


def _moved(cloud: Cloud, target: str) -> dict[str, Any]:
    """Return what still holds of coordinates in another system."""
    entries = dict(cloud.metadata)
    known = Provenance(entries)
    if las := known.las:
        kept = {key: each for key, each in las.items() if key not in ("scale", "offset")}
        scale = steps_in(las.get("scale"), cloud.crs, target)
        entries["las"] = kept | ({} if scale is None else {"scale": scale})
    if notes := known.notes:
        entries["notes"] = tuple(each for each in notes if each != DEGREES)
    system = parse_crs(target)
    has_unit = system is not None and system.units[2] is not None  # then heights are in that unit
    for said in SAYING_UNITS if has_unit else ():
        if isinstance(entry := entries.get(said), Mapping):
            entries[said] = {key: each for key, each in entry.items() if key != "unit"}
    return entries


_BLOCK = 1 << 20  # rows: NumPy counts bytes as words of 64 bits
_NAMED = 3  # files in a message
_CONDITIONS = [each.name for each in fields(Selection)]
_UNSAID = {"flat": False}  # and None of all others
_SYSTEMS = ("src_crs", "dst_crs", "color_depth")  # of what is read, not of which rows are


def for_surface(
    name: str | os.PathLike[str], choices: Mapping[str, Any], file_format: str | None = None
) -> dict[str, Any]:
    """Return the conditions on the rows of a file that a surface is made of."""
    name = os.fspath(name)
    kind = file_format or suffix_of(name)
    if not kind or find_format(kind, name).name != "las":
        return {**choices}
    return {"classes": "ground", "withheld": False, **choices}


def read_for_surface(source: object, **options: Unpack[ReadOptions]) -> Cloud:
    """Read the rows of a surface, or convert an object, of which all rows count."""
    given: dict[str, Any] = {**options}  # but for what says nothing, which all objects take
    given = {key: each for key, each in given.items() if each is not _UNSAID.get(key)}
    if isinstance(source, str | os.PathLike):
        chosen = for_surface(source, given, options.get("format"))
        return check_some(read(source, **chosen), source)
    if "classes" in given:
        raise InputError(
            f"{Option('classes', ...)} is for files: select the rows of a cloud, as "
            'cloud.select(cloud.attributes["classification"] == 2)'
        )
    return as_cloud(source, **given)


def for_chunks(
    names: Sequence[str | os.PathLike[str]], choices: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return the conditions on the rows of files that are read in chunks."""
    conditions = [for_surface(name, choices, choices.get("format")) for name in names]
    asked = {k: each for k, each in enumerate(conditions) if each.get("classes") == "ground"}
    counts = {k: _ground_of(os.fspath(names[k]), each) for k, each in asked.items()}
    check_grounds((os.fspath(names[k]), each) for k, each in counts.items())
    for k, each in asked.items():
        each["classes"] = GROUND if counts[k]["ground"] else "all"
    return conditions


def _ground_of(name: str, choices: Mapping[str, Any]) -> dict[str, int]:
    """Say whether a file has ground, and whether rows would be selected without."""
    conditions = {key: each for key, each in choices.items() if key in _CONDITIONS}
    others = {key: each for key, each in choices.items() if key not in (*_CONDITIONS, *_SYSTEMS)}
    selector = Selector(validate_selection(**conditions) or Selection(), name)
    for cloud in read_chunks(name, **others):
        places = dict(zip(POSITION, cloud.points.T, strict=True))
        selector.rows(len(cloud), {**cloud.attributes, **places})
        if selector.counts()["ground"]:
            break
    return selector.counts()


def check_grounds(files: Iterable[tuple[str, Mapping[str, int]]]) -> None:
    """Raise if some files have ground and others have none, of which all rows would be taken."""
    asked = [(name, counts) for name, counts in files if "ground" in counts]
    lacking = [name for name, each in asked if each["selected"] and not each["ground"]]
    if not lacking or not any(each["ground"] for _, each in asked):
        return
    rest = f" and {len(lacking) - _NAMED} more" if len(lacking) > _NAMED else ""
    raise InputError(
        f"{', '.join(lacking[:_NAMED])}{rest}: no ground (class 2), while other files have some: "
        f"give {Option('classes', 'all')} for all rows of each file, {Option('classes', 2)} for "
        f"none of these, or find the ground with {Option('classify_ground')}"
    )


def check_some(cloud: Cloud, name: str | os.PathLike[str]) -> Cloud:
    """Return a cloud; raise if conditions on rows have left none."""
    rows = Provenance(cloud.metadata).selection.get("rows")
    if rows and not len(cloud):
        raise InputError(f"{os.fspath(name)}: none of {rows:,} rows meets the conditions")
    return cloud


def classes_of(attributes: Mapping[str, Array]) -> dict[int, int]:
    """Count the rows of each class."""
    name = class_column(attributes)
    return {} if name is None else bytes_of(attributes[name])


def bytes_of(values: Array) -> dict[int, int]:
    """Count whole numbers from 0 to 255; empty if there are others."""
    total = np.zeros(MOST_CLASSES, np.int64)
    if values.ndim != 1 or values.dtype.kind not in "iuf":
        return {}
    for first in range(0, len(values), _BLOCK):
        block = values[first : first + _BLOCK]
        if block.dtype != np.uint8:
            if not ((block >= 0) & (block < MOST_CLASSES) & (block == np.floor(block))).all():
                return {}
            block = block.astype(np.uint8)
        total += np.bincount(block, minlength=MOST_CLASSES)
    return {number: int(total[number]) for number in np.flatnonzero(total).tolist()}
