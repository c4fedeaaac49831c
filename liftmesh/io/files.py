"""read() and write(): a path or a stream in, the right format, a path or a stream out."""

from __future__ import annotations

import inspect
import io
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

from liftmesh.errors import FormatError
from liftmesh.io.atomic import replacing
from liftmesh.io.meshes import as_mesh
from liftmesh.io.registry import find_format
from liftmesh.io.streams import remaining, seekable

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud
    from liftmesh.io.format import Format, Origin

PathOrStream: TypeAlias = str | os.PathLike[str] | BinaryIO


@dataclass(frozen=True, slots=True)
class Written:
    """What :func:`write` wrote.

    Attributes
    ----------
    path : pathlib.Path or None
        The file; None for a stream.
    format : str
        Name of the format.
    bytes : int
        How many bytes were written.
    origin : tuple of float, or None
        x, y, z that were subtracted from every vertex because the format holds single precision
        only; the file states it too. None: coordinates are written as they are.
    dropped : tuple of str
        Colours, normals and attributes of the mesh that the format has no place for.

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


def read(source: PathOrStream, *, format: str | None = None) -> Cloud:  # noqa: A002
    r"""Read a point cloud or a mesh.

    Parameters
    ----------
    source : str, path, or binary stream
        What to read: PLY, OBJ, XYZ/CSV/TXT/ASC/TSV, NPY, NPZ, STL, OFF, GLB, glTF, and what plugins
        add.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name tells.

    Returns
    -------
    Cloud
        The rows in the file's order, with colours, normals, attributes and faces if it has them.
        ``metadata["source"]`` is the file's name, ``metadata["format"]`` the format's.

    Raises
    ------
    FormatError
        The format is not known, or the file is broken: the message names the file, the line or
        byte, and the cause.
    OSError
        The file is not there or cannot be opened.

    Examples
    --------
    >>> import io
    >>> cloud = read(io.BytesIO(b"x,y,z,class\n0,0,5,2\n1,0,6,2\n"), format="csv")
    >>> cloud.points.tolist(), cloud.attributes["class"].tolist()
    ([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0]], [2.0, 2.0])
    """
    name = _name(source)
    found = _find(source, format, name)
    if found.read is None:
        raise FormatError(f"{name}: {found.name} files cannot be read: {found.description}")
    if isinstance(source, str | os.PathLike):
        with _opened(source) as stream:
            cloud = _read(seekable(stream), found.read, name)
    else:
        _check_stream(source, "read")
        cloud = _read(seekable(source), found.read, name)
    return replace(cloud, metadata={**cloud.metadata, "source": name, "format": found.name})


def write(
    target: PathOrStream,
    mesh: object,
    *,
    format: str | None = None,  # noqa: A002
    **options: Any,
) -> Written:
    r"""Write a point cloud or a mesh; of a file, either the whole or nothing.

    Parameters
    ----------
    target : str, path, or binary stream
        Where to write. A file is written beside its place and then renamed, so that an error
        leaves an old file as it was.
    mesh : Cloud, (n, 3) array, or object with vertices and faces
        What to write; colours, normals and attributes go along if the format has a place for them.
    format : str, optional
        Name or suffix of the format; by default the suffix of the file's name tells.
    **options
        What the format's writer takes: ``encoding``, ``colors`` and ``comments`` for PLY,
        ``comments`` for OBJ, ``compressed`` for NPZ.

    Returns
    -------
    Written
        The format, the number of bytes, and the origin that was subtracted, if any.

    Raises
    ------
    FormatError
        The format or an option is not known, or the format cannot hold this mesh.
    UnsupportedTypeError
        ``mesh`` is nothing that can be written.
    OSError
        The file cannot be written; the message names what is in the way.

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
    writer = _writer(found, name, options)
    cloud = as_mesh(mesh, name)
    if isinstance(target, str | os.PathLike):
        with replacing(target) as stream:
            origin, size = _write(stream, cloud, writer, options)
        return Written(Path(target), found.name, size, origin, _dropped(cloud, found))
    _check_stream(target, "write")
    origin, size = _write(target, cloud, writer, options)
    return Written(None, found.name, size, origin, _dropped(cloud, found))


def _dropped(cloud: Cloud, found: Format) -> tuple[str, ...]:
    """Name what the mesh has and the format does not keep."""
    whole = [name for name in ("colors", "normals") if getattr(cloud, name) is not None]
    dropped = [name for name in whole if name not in found.keeps]
    return (*dropped, *(() if "attributes" in found.keeps else sorted(cloud.attributes)))


def _name(place: object) -> str:
    if isinstance(place, str | os.PathLike):
        return os.fspath(place)
    name = getattr(place, "name", None)
    return name if isinstance(name, str) else "<stream>"


def _find(place: object, wanted: str | None, name: str) -> Format:
    if wanted is not None:
        return find_format(wanted, name)
    if isinstance(place, str | os.PathLike) and Path(place).is_dir():
        raise FormatError(f"{name}: this is a folder, not a file")
    return find_format(Path(name).suffix, name)


def _opened(path: str | os.PathLike[str]) -> BinaryIO:
    if Path(path).is_dir():
        raise FormatError(f"{os.fspath(path)}: this is a folder, not a file")
    return Path(path).open("rb")


def _check_stream(stream: object, method: str) -> None:
    if not hasattr(stream, method) or isinstance(stream, io.TextIOBase):
        raise FormatError(
            f"a {type(stream).__name__} is neither a path nor a binary stream: "
            "open files with mode 'rb' or 'wb'"
        )


def _read(stream: BinaryIO, reader: Callable[[BinaryIO, str], Cloud], name: str) -> Cloud:
    if not remaining(stream):
        raise FormatError(f"{name}: the file is empty (0 bytes)")
    return reader(stream, name)


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
    if not stream.seekable():
        held = io.BytesIO()
        origin, size = _write(held, cloud, writer, options)
        stream.write(held.getbuffer())
        return origin, size
    begin = stream.tell()
    origin = writer(stream, cloud, **options)
    return origin, stream.tell() - begin
