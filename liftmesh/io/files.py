"""read(), read_chunks() and write(): conversion between files or streams and clouds."""

from __future__ import annotations

import inspect
import io
import operator
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias, TypeVar

from liftmesh.errors import FormatError, InputError
from liftmesh.io.atomic import replacing
from liftmesh.io.faces import checked_faces
from liftmesh.io.format import check_needs, dropped
from liftmesh.io.links import check_links
from liftmesh.io.registry import as_cloud, find_format
from liftmesh.io.streams import add_name, remaining, seekable, written_whole

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud
    from liftmesh.io.format import ChunkReader, Format, Origin, Reader

PathOrStream: TypeAlias = str | os.PathLike[str] | BinaryIO

CHUNK_ROWS = 1_000_000

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
        What the mesh has and the file does not keep: colors, alpha, normals, attributes by name,
        the crs, rows in no face, double precision, colors beyond 8 bits.

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


def read(
    source: PathOrStream,
    *,
    format: str | None = None,  # noqa: A002
    max_bytes: int | None = None,
) -> Cloud:
    r"""Read a point cloud or a mesh.

    Parameters
    ----------
    source : str, path, or binary stream
        PLY, OBJ, XYZ/CSV/TXT/ASC/TSV, NPY, NPZ, STL, OFF, GLB, glTF, or a format of a plugin.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name.
    max_bytes : int, optional
        Maximum number of bytes in memory of what a file may expand to. Of a GLB or glTF file, the
        meshes count, each as often as it is used; by default 256 MiB or 20 times the file. Of an
        NPZ file, the arrays; by default 256 MiB or 1,100 times their compressed bytes, which only
        bz2 and LZMA exceed. Of PLY and text, each column, property and element counts 2,000 bytes;
        by default 20,000,000, for 10,000 of them. Other formats do not expand.

    Returns
    -------
    Cloud
        The rows in the file's order, with colours, normals, attributes, faces and coordinate system
        if the file has them. ``metadata["source"]`` is the file's name, ``metadata["format"]`` the
        format's.

    Raises
    ------
    FormatError
        The format is unknown, the file is invalid, or it expands to more than the limit: the
        message gives the file, the line or byte, and the cause.
    InputError
        `max_bytes` is not a positive whole number.
    OSError
        The file does not exist or cannot be opened.

    Examples
    --------
    >>> import io
    >>> cloud = read(io.BytesIO(b"x,y,z,class\n0,0,5,2\n1,0,6,2\n"), format="csv")
    >>> cloud.points.tolist(), cloud.attributes["class"].tolist()
    ([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0]], [2.0, 2.0])
    """
    name = _name(source)
    found = _find(source, format, name)
    read_whole = _reader(found, name, max_bytes)
    with _opened(source, name) as stream:
        return _labelled(read_whole(stream, name), found, name)


def read_chunks(
    source: PathOrStream,
    *,
    rows: int = CHUNK_ROWS,
    format: str | None = None,  # noqa: A002
    max_bytes: int | None = None,
) -> Iterator[Cloud]:
    r"""Read a point cloud in chunks, in bounded memory if its format allows it.

    PLY, text, NPY and NPZ are read in chunks; text is parsed twice, to determine the types of the
    columns first. Other formats, and pipes, are read whole, then split. Of files that are read in
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

    Yields
    ------
    Cloud
        Consecutive rows, at most `rows` of them: together the rows of ``read(source)``, with the
        same types, colours, normals, attributes and coordinate system, without faces.

    Raises
    ------
    InputError
        `rows` or `max_bytes` is not a positive whole number.
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
    rows = _positive(rows, "rows")
    name = _name(source)
    found = _find(source, format, name)
    if found.read_chunks is None:
        chunks = _split(_reader(found, name, max_bytes))
    else:
        chunks = _limited(found.read_chunks, found, max_bytes)
    return _chunks(source, found, chunks, name, rows)


def read_cloud(source: object, *, max_bytes: int | None = None) -> Cloud:
    """Read a file, or convert any object that holds points to a cloud.

    Parameters
    ----------
    source : path or object
        A path, as for `read`, or any object that `as_cloud` accepts.
    max_bytes : int, optional
        As for `read`.

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
        return read(source, max_bytes=max_bytes)
    return as_cloud(source)


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
        Where to write. A file is written under a temporary name in the same folder and then
        renamed, so that an error leaves an existing file as it was.
    mesh : object
        Anything that `as_cloud` accepts, except a path. Colours, normals, attributes and the
        coordinate system are written if the format supports them.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name.
    **options
        Options of the format: ``encoding``, ``colors`` and ``comments`` for PLY, ``comments`` for
        OBJ, ``compressed`` for NPZ, ``delimiter`` for text.

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
    name = _name(target)
    found = _find(target, format, name)
    suffix = "." + (format or Path(name).suffix).lower().removeprefix(".")
    options = {**found.suffix_options.get(suffix, {}), **options}
    writer = _writer(found, name, options)
    cloud = as_cloud(mesh)
    if cloud.faces is not None:
        checked_faces(cloud.faces, len(cloud), name)
    check_needs(found, cloud)
    if not isinstance(target, str | os.PathLike):
        _check_stream(target, "write")
        origin, size = _write(target, cloud, writer, options)
        return Written(None, found.name, size, origin, dropped(found, cloud, options, origin))
    with replacing(target) as stream:  # an error up to its end leaves the old file
        origin, size = _write(stream, cloud, writer, options)
        lost = dropped(found, cloud, options, origin)
    return Written(Path(target), found.name, size, origin, lost)


def _positive(value: Any, what: str) -> int:
    try:
        count = 0 if isinstance(value, bool) else operator.index(value)
    except TypeError:
        count = 0
    if count < 1:
        raise InputError(f"{what} is {value!r}: give a whole number from 1")
    return count


def _chunks(
    source: PathOrStream, found: Format, chunks: ChunkReader, name: str, rows: int
) -> Iterator[Cloud]:
    with _opened(source, name) as stream:
        for chunk in chunks(stream, name, rows):
            yield _labelled(chunk, found, name)


def _split(reader: Reader) -> ChunkReader:
    """Make a chunk reader from a reader of whole files."""

    def chunks(stream: BinaryIO, name: str, rows: int) -> Iterator[Cloud]:
        cloud = reader(stream, name)
        for start in range(0, len(cloud), rows):
            yield cloud.select(slice(start, start + rows))

    return chunks


def _labelled(cloud: Cloud, found: Format, name: str) -> Cloud:
    return replace(cloud, metadata={**cloud.metadata, "source": name, "format": found.name})


def _name(place: object) -> str:
    if isinstance(place, str | os.PathLike):
        return os.fspath(place)
    name = getattr(place, "name", None)
    return name if isinstance(name, str) else "<stream>"


def _find(place: object, wanted: str | None, name: str) -> Format:
    if wanted is not None:
        return find_format(wanted, name)
    if isinstance(place, str | os.PathLike) and os.path.isdir(place):  # noqa: PTH112
        raise _folder(name)
    return find_format(Path(name).suffix, name)


def _folder(name: str) -> FormatError:
    return FormatError(f"{name}: this is a folder, not a file")


def _reader(found: Format, name: str, max_bytes: int | None) -> Reader:
    if found.read is None:
        raise FormatError(f"{name}: {found.name} files cannot be read: {found.description}")
    return _limited(found.read, found, max_bytes)


def _limited(
    reader: Callable[..., Read], found: Format, max_bytes: int | None
) -> Callable[..., Read]:
    """Set the limit of a reader, if its format expands; others take none."""
    limit = None if max_bytes is None else _positive(max_bytes, "max_bytes")
    return partial(reader, max_bytes=limit) if found.expands else reader


@contextmanager
def _opened(source: PathOrStream, name: str) -> Iterator[BinaryIO]:
    """Open a path, or use a stream; yield it as a seekable stream that is not empty."""
    if not isinstance(source, str | os.PathLike):
        _check_stream(source, "read")
        yield _filled(seekable(source), name)
        return
    try:
        with open(source, "rb") as stream:  # noqa: PTH123
            yield _filled(seekable(stream), name)
    except IsADirectoryError as error:
        raise _folder(name) from error
    except OSError as error:  # of the stream, which knows no name
        check_links(source)
        add_name(error, name)
        raise


def _filled(stream: BinaryIO, name: str) -> BinaryIO:
    if not remaining(stream):
        raise FormatError(f"{name}: the file is empty (0 bytes)")
    return stream


def _check_stream(stream: object, method: str) -> None:
    if not hasattr(stream, method) or isinstance(stream, io.TextIOBase):
        raise FormatError(
            f"a {type(stream).__name__} is neither a path nor a binary stream: "
            "open files with mode 'rb' or 'wb'"
        )


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
    origin = writer(stream, cloud, **options)
    return origin, stream.tell() - begin
