"""read(), read_chunks() and write(): conversion between files or streams and clouds."""

from __future__ import annotations

import inspect
import io
import os
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeVar

from liftmesh.choices import as_count
from liftmesh.color_depth import check_depth
from liftmesh.errors import FormatError, InputError
from liftmesh.interruption import kept
from liftmesh.io.atomic import replacing
from liftmesh.io.chunks import of_one_depth, split
from liftmesh.io.faces import checked_faces
from liftmesh.io.format import check_needs, configured, dropped, renamed
from liftmesh.io.places import PathOrStream, at_home, check_stream, folder, name_of, opened
from liftmesh.io.registry import as_cloud, find_format, find_written, suffix_of
from liftmesh.io.streams import written_whole

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud
    from liftmesh.io.format import Format, Origin, Reader

CHUNK_ROWS = 1_000_000
_NO_MORE: Any = object()

Read = TypeVar("Read")


@dataclass(frozen=True, slots=True)
class Written:
    """The result of :func:`write`.

    Attributes
    ----------
    path : pathlib.Path or None
        The file; None for a stream.
    format : str
        Name of the format.
    bytes : int
        Number of bytes written.
    origin : tuple of float, or None
        x, y, z that were subtracted from every vertex because the format holds single precision
        only; the file records it too. None: coordinates are written as they are.
    dropped : tuple of str
        What the mesh has and the file does not keep: colors, alpha, normals, attributes and
        metadata by name, the crs, rows in no face, double precision, colors beyond 8 bits; and what
        a cloud does not hold of an object of another library, such as texture.
    renamed : tuple of (str, str)
        Attributes whose names the format cannot hold, and their names in the file. Reading the
        file gives the old names back.

    Examples
    --------
    >>> import io
    >>> import numpy as np
    >>> written = write(io.BytesIO(), np.eye(3), format="ply")
    >>> written.format, written.path, written.origin
    ('ply', None, None)
    """

    path: Path | None
    format: str
    bytes: int
    origin: Origin | None
    dropped: tuple[str, ...] = ()
    renamed: tuple[tuple[str, str], ...] = ()


def read(
    source: PathOrStream,
    *,
    format: str | None = None,  # noqa: A002
    max_bytes: int | None = None,
    color_depth: int | None = None,
    **options: Any,
) -> Cloud:
    r"""Read a point cloud or a mesh.

    Parameters
    ----------
    source : str, path, or binary stream
        PLY, OBJ, XYZ/CSV/TXT/ASC/TSV, NPY, NPZ, STL, OFF, GLB, glTF, PCD, PTS, XYZRGB, XYZN,
        .node, .ele (with the .node file beside it), or a format of a plugin; those of text also
        compressed with gzip, as ``points.csv.gz``. ``~`` at the beginning of a path is the home
        folder.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name.
    max_bytes : int, optional
        Maximum number of bytes in memory of what a file may expand to. Of a GLB or glTF file, the
        meshes count, each as often as it is used; by default 256 MiB or 20 times the file. Of an
        NPZ file, the arrays; by default 256 MiB or 1,100 times their compressed bytes, which only
        bz2 and LZMA exceed. Of PLY and text, each column, property and element counts 2,000 bytes;
        by default 20,000,000, for 10,000 of them. Of a file compressed with gzip, the text; by
        default 256 MiB or 20 times the file. Other formats do not expand.
    color_depth : int, optional
        Bits per channel that the numbers of integer colours mean: 8, 16, 32 or 64. By default the
        values of the whole file decide, and ``Cloud.color_depth`` says what: LAS keeps colours in
        16 bits, and most programs put 8-bit values there.
    **options
        Options of the format. Tables as text take:

        - ``columns``: what the columns are, as ``"x=East,y=North,z=H"`` or a mapping; or the names
          of all columns in order, as ``"id,x,y,z"`` or a sequence, where ``-`` leaves one out.
          ``z=-Depth`` turns depths into heights.
        - ``flat=True``: heights do not matter; z is 0.
        - ``delimiter``: a character, or ``"space"`` for blanks; by default it is detected.
        - ``decimal``: ``"."`` or ``","``.
        - ``skip_rows``: the number of lines to skip at the top.
        - ``header=False``: the first line is a row, whatever it holds.
        - ``nodata``: the number or text that stands for a missing value, which becomes NaN;
          ``"none"`` if even -9999 is a value.
        - ``end``: the line that ends the table.
        - ``encoding``: of the text, as ``"cp1252"``; by default UTF-8, or UTF-16 with its mark.

    Returns
    -------
    Cloud
        The rows in the file's order, with colours, normals, attributes, faces and coordinate system
        if the file has them. ``metadata["source"]`` is the file's name, ``metadata["format"]`` the
        format's. Of a table, ``metadata["columns"]`` says which columns are what.

    Raises
    ------
    FormatError
        The format is unknown, the file is invalid, or it expands to more than the limit: the
        message gives the file, the line or byte, and the cause.
    InputError
        `max_bytes` is not a positive whole number, `color_depth` is no depth, or too small, or an
        option is invalid.
    OSError
        The file does not exist or cannot be opened.

    Warns
    -----
    DataWarning
        Coordinates are degrees, or have different units.

    Examples
    --------
    >>> import io
    >>> cloud = read(io.BytesIO(b"x,y,z,class\n0,0,5,2\n1,0,6,2\n"), format="csv")
    >>> cloud.points.tolist(), cloud.attributes["class"].tolist()
    ([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0]], [2.0, 2.0])
    """
    check_depth(color_depth)
    limit = None if max_bytes is None else as_count("max_bytes", max_bytes, 1)
    source = at_home(source)
    name = name_of(source)
    found = _find(source, format, name)
    read_whole = _reader(found, name, limit, options)
    with opened(source, found, name, limit) as stream, kept():
        cloud = _labelled(read_whole(stream, name), found, name)
    return _of_depth(cloud, color_depth, name)


def read_chunks(
    source: PathOrStream,
    *,
    rows: int = CHUNK_ROWS,
    format: str | None = None,  # noqa: A002
    max_bytes: int | None = None,
    color_depth: int | None = None,
    **options: Any,
) -> Iterator[Cloud]:
    r"""Read a point cloud in chunks, in bounded memory if its format allows it.

    PLY, text, NPY and NPZ are read in chunks. Text is parsed twice, to determine the types of the
    columns first, and a file with integer colours of more than 8 bits is read once more, to decide
    their depth. Other formats, and pipes, are read whole, then split. Of files that are read in
    chunks, only what the rows need is read: damage to the faces, which `read` reports, is not
    noticed.

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
    color_depth, **options
        As for `read`.

    Yields
    ------
    Cloud
        Consecutive rows, at most `rows` of them: together the rows of ``read(source)``, with the
        same types, colours, normals, attributes and coordinate system, without faces.

    Raises
    ------
    InputError
        `rows` or `max_bytes` is not a positive whole number, or `color_depth` is no depth, or too
        small.
    FormatError
        As for `read`, apart from faces: before the first chunk, or at the invalid chunk.
    OSError
        The file does not exist or cannot be opened.

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
    source = at_home(source)
    name = name_of(source)
    found = _find(source, format, name)
    if found.read_chunks is None:
        chunks = split(_reader(found, name, limit, options))
    else:
        chunks = _limited(configured(found.read_chunks, found, name, options), found, limit)
        chunks = of_one_depth(chunks, color_depth)
    place = opened(source, found, name, limit)
    return _chunks(place, found, partial(chunks, name=name, rows=rows), name, color_depth)


def read_cloud(source: object, *, max_bytes: int | None = None, **options: Any) -> Cloud:
    """Read a file, or convert any object that holds points to a cloud.

    Parameters
    ----------
    source : path or object
        A path, as for `read`, or any object that `as_cloud` accepts.
    max_bytes : int, optional
        As for `read`.
    **options
        Options of tables, as for `read`.

    Returns
    -------
    Cloud
        The points.

    Raises
    ------
    InputError
        Arrays have the wrong shape or type, or `max_bytes` is invalid.
    UnsupportedTypeError
        No adapter accepts the object.
    FormatError
        As for `read`.

    Examples
    --------
    >>> len(read_cloud([[0, 0, 5], [1, 0, 6]]))
    2
    """
    if isinstance(source, str | os.PathLike):
        return read(source, max_bytes=max_bytes, **options)
    return as_cloud(source, **options)


def write(
    target: PathOrStream,
    mesh: object,
    *,
    format: str | None = None,  # noqa: A002
    **options: Any,
) -> Written:
    r"""Write a point cloud or a mesh; a file is written completely or not at all.

    Parameters
    ----------
    target : str, path, or binary stream
        Where to write; ``~`` at the beginning of a path is the home folder. A file is written under
        a temporary name in the same folder and then renamed, so that an error leaves an existing
        file as it was.
    mesh : object
        Anything that `as_cloud` accepts, except a path. Colours, normals, attributes and the
        coordinate system are written if the format supports them.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name.
    **options
        Options of the format: ``encoding``, ``colors`` and ``comments`` for PLY, ``colors`` and
        ``comments`` for OBJ, ``compressed`` for NPZ, ``delimiter`` for text.

    Returns
    -------
    Written
        The format, the number of bytes, the origin that was subtracted, if any, and what the format
        did not keep.

    Raises
    ------
    FormatError
        The format or an option is unknown, or the format cannot hold this mesh.
    InputError
        An option has an unknown value, or colours or other arrays are invalid.
    UnsupportedTypeError
        ``mesh`` cannot be converted to a cloud, or is a path: `read` it first.
    OSError
        The file cannot be written; the message gives the reason.

    Examples
    --------
    >>> import io
    >>> import numpy as np
    >>> from liftmesh.cloud import Cloud
    >>> stream = io.BytesIO()
    >>> write(stream, Cloud(np.array([[0.1, 2.0, 1e300]])), format="obj").bytes
    28
    >>> stream.getvalue()
    b'# liftmesh\nv 0.1 2.0 1e+300\n'
    """
    target = at_home(target)
    name = name_of(target)
    found = _find(target, format, name, find_written)
    suffix = "." + (format or suffix_of(name)).lower().removeprefix(".")
    options = {**found.suffix_options.get(suffix, {}), **options}
    writer = _writer(found, name, options)
    cloud = as_cloud(mesh)
    if cloud.faces is not None:
        checked_faces(cloud.faces, len(cloud), name)
    check_needs(found, cloud)
    if not isinstance(target, str | os.PathLike):
        check_stream(target, "write")
        origin, size = _write(target, cloud, writer, options)
        lost = dropped(found, cloud, options, origin)
        return Written(None, found.name, size, origin, lost, renamed(found, cloud))
    with replacing(target) as stream:  # an error up to its end leaves the old file
        origin, size = _write(stream, cloud, writer, options)
        lost, names = dropped(found, cloud, options, origin), renamed(found, cloud)
    return Written(Path(target), found.name, size, origin, lost, names)


def _chunks(
    place: AbstractContextManager[BinaryIO],
    found: Format,
    chunks: Callable[[BinaryIO], Iterator[Cloud]],
    name: str,
    color_depth: int | None,
) -> Iterator[Cloud]:
    with place as stream:
        with kept():
            pieces = iter(chunks(stream))
            chunk = next(pieces, _NO_MORE)
        while chunk is not _NO_MORE:
            yield _of_depth(_labelled(chunk, found, name), color_depth, name)
            with kept():  # not around the yield: the caller's code is none of ours
                chunk = next(pieces, _NO_MORE)


def _of_depth(cloud: Cloud, depth: int | None, name: str) -> Cloud:
    """Set the depth of colours, if one is given; an error names the file."""
    try:
        return cloud if depth is None else cloud.with_color_depth(depth)
    except InputError as error:
        raise InputError(f"{name}: {error}") from error


def _labelled(cloud: Cloud, found: Format, name: str) -> Cloud:
    return replace(cloud, metadata={**cloud.metadata, "source": name, "format": found.name})


def _find(
    place: object,
    wanted: str | None,
    name: str,
    find: Callable[[str, str], Format] = find_format,
) -> Format:
    if wanted is None and isinstance(place, str | os.PathLike) and os.path.isdir(place):  # noqa: PTH112
        raise folder(name)
    return find(suffix_of(name) if wanted is None else wanted, name)


def _reader(found: Format, name: str, limit: int | None, options: dict[str, Any]) -> Reader:
    if found.read is None:
        raise FormatError(f"{name}: {found.name} files cannot be read: {found.description}")
    return _limited(configured(found.read, found, name, options), found, limit)


def _limited(reader: Callable[..., Read], found: Format, limit: int | None) -> Callable[..., Read]:
    """Set the limit of a reader, if its format expands; others take none."""
    return partial(reader, max_bytes=limit) if found.expands else reader


def _writer(found: Format, name: str, options: dict[str, Any]) -> Callable[..., Origin | None]:
    if found.write is None:
        raise FormatError(
            f"{name}: {found.name} files cannot be written ({found.description}): "
            "write PLY, OBJ or NPZ"
        )
    signature = inspect.signature(found.write)
    try:
        signature.bind(None, None, **options)
    except TypeError as error:
        taken = [*signature.parameters][2:]
        raise FormatError(
            f"{name}: {error}: {found.name} takes {', '.join(taken) or 'no options'}"
        ) from error
    return found.write


def _write(
    stream: BinaryIO, cloud: Cloud, writer: Callable[..., Origin | None], options: dict[str, Any]
) -> tuple[Origin | None, int]:
    if isinstance(stream, io.RawIOBase):
        return _write(written_whole(stream), cloud, writer, options)
    if not stream.seekable():
        held = io.BytesIO()
        origin, size = _write(held, cloud, writer, options)
        stream.write(held.getbuffer())
        return origin, size
    begin = stream.tell()
    with kept():
        origin = writer(stream, cloud, **options)
    return origin, stream.tell() - begin
