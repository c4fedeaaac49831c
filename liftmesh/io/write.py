"""write(): clouds and meshes to files or streams, each written whole or not at all."""

from __future__ import annotations

import inspect
import io
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from liftmesh.base.display import card_of
from liftmesh.base.interruption import preserve_signals
from liftmesh.base.options import as_switch, counted
from liftmesh.errors import FormatError
from liftmesh.io.atomic import replacing
from liftmesh.io.columns import checked_edges, checked_faces, with_used_rows
from liftmesh.io.format import Format, Found, Origin, Writer, check_needs, dropped, renamed
from liftmesh.io.registry import as_cloud, find_written
from liftmesh.io.streams import (
    PathOrStream,
    at_home,
    check_stream,
    format_of,
    name_of,
    suffix_of,
    watched,
    written_whole,
)

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


_KEPT = frozenset({"las"})  # formats of what was measured: such files are replaced if asked only


@dataclass(frozen=True, slots=True)
class WriteResult:
    """What :func:`write`, and every ``save``, has written.

    Attributes
    ----------
    path : pathlib.Path or None
        The file; None for a stream.
    format : str
        Name of the format; of shapes and rasters, "geojson", "geopackage", "geotiff" or
        "heightmap".
    bytes : int
        Number of bytes written.
    origin : tuple of float, or None
        x, y, z that were subtracted from every vertex because the format holds single precision
        only; the file records it too. None: coordinates are written as they are.
    dropped : tuple of str
        What the mesh has and the file does not keep: edges, colors, alpha, normals, attributes and
        metadata by name, the crs, rows in no face, double precision, colors beyond 8 bits; and what
        a cloud does not hold of an object of another library, such as texture.
    renamed : tuple of (str, str)
        Attributes whose names the format cannot hold, and their names in the file. Reading the
        file gives the old names back.
    scaling : (float, float), or None
        Of a heightmap, scale and offset: height = scale * value + offset.

    See Also
    --------
    write : Returns it.

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
    scaling: tuple[float, float] | None = None
    _repr_html_ = card_of


def written_file(
    path: Path,
    kind: str,
    dropped: tuple[str, ...] = (),
    scaling: tuple[float, float] | None = None,
) -> WriteResult:
    """Describe a file that has been written and is no mesh."""
    return WriteResult(path, kind, path.stat().st_size, None, dropped, scaling=scaling)


def write(
    target: PathOrStream,
    mesh: object,
    *,
    format: str | None = None,  # noqa: A002
    overwrite: bool | None = None,
    compact: bool = False,
    **options: Any,
) -> WriteResult:
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
    overwrite : bool, optional
        Whether a file that exists, and is not empty, is replaced; by default not by LAS and LAZ,
        which may be what was measured, and by all other formats.
    compact : bool, default False
        Whether rows in no face are left out of a mesh, as those of a trimmed surface;
        `WriteResult.dropped` has their number.
    **options
        Options of the format: ``encoding``, ``colors`` and ``comments`` for PLY, ``colors`` and
        ``comments`` for OBJ, ``compressed`` for NPZ, ``delimiter`` for text; ``compressed``,
        ``scale`` and ``point_format`` for LAS; ``name`` for LandXML, ``unit`` for 3MF; ``up``, "y"
        or "z", and ``origin`` for GLB, glTF and OBJ: the place that becomes zero in the file, as
        engines need it near the model, or "center". Reading the file undoes both. ``texture`` for
        GLB and glTF: a GeoTIFF, as an orthophoto, that is put over the faces in place of colours.

    Returns
    -------
    WriteResult
        The format, the number of bytes, the origin that was subtracted, if any, and what the format
        did not keep.

    Raises
    ------
    FormatError
        The format or an option is unknown, or the format cannot hold this mesh.
    InputError
        An option has an unknown value, or colours or other arrays are invalid.
    FileExistsError
        The file exists, and is not to be replaced.
    UnsupportedTypeError
        ``mesh`` cannot be converted to a cloud, or is a path: `read` it first.
    OSError
        The file cannot be written; the message gives the reason.

    See Also
    --------
    read : Reads such a file.
    Surface.save : The method of a surface.

    Examples
    --------
    >>> import io
    >>> import numpy as np
    >>> from liftmesh import Cloud
    >>> stream = io.BytesIO()
    >>> write(stream, Cloud(np.array([[0.1, 2.0, 1e300]])), format="obj").bytes
    28
    >>> stream.getvalue()
    b'# liftmesh\nv 0.1 2.0 1e+300\n'

    Surfaces have it as a method:

    >>> import liftmesh
    >>> file = io.BytesIO()
    >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
    >>> written = surface.save(file, format="ply")
    >>> file.getvalue()[:3]
    b'ply'
    """
    target = at_home(target)
    name = name_of(target)
    file_format, writer, options = _chosen(target, name, format, options)
    cloud = as_cloud(mesh)
    if cloud.faces is not None:
        checked_faces(cloud.faces, len(cloud), name)
    if cloud.edges is not None:
        checked_edges(cloud.edges, len(cloud), name)
    unused = 0
    if as_switch("compact", compact) and cloud.faces is not None:
        rows = len(cloud)
        cloud, used = with_used_rows(cloud)
        unused = rows - len(used)
    check_needs(file_format, cloud)
    if not isinstance(target, str | os.PathLike):
        check_stream(target, "write")
        found, size = _write(target, cloud, writer, options)
        return _result(None, file_format, cloud, options, found, size, unused)
    is_replaced = file_format.name not in _KEPT if overwrite is None else overwrite
    with replacing(target, overwrite=is_replaced) as stream:  # an error leaves the old file
        with watched(stream):
            found, size = _write(stream, cloud, writer, options)
        return _result(Path(target), file_format, cloud, options, found, size, unused)


def write_chunks(
    target: str | os.PathLike[str],
    chunks: Iterable[Cloud],
    *,
    format: str | None = None,  # noqa: A002 - as of `write`
    **options: Any,
) -> WriteResult:
    """Write a cloud that comes in chunks, of which there is at least one; replace a file."""
    file_format, _, options = _chosen(target, name_of(target), format, options)
    if file_format.write_chunks is None:
        raise FormatError(f"{target}: {file_format.name} files are not written in chunks")
    pieces = iter(chunks)
    first = next(pieces)
    with replacing(target) as stream, watched(stream), preserve_signals():
        whole = _complete(file_format, chain([first], pieces))
        file_format.write_chunks(stream, whole, **options)
        size = stream.tell()
    return _result(Path(target), file_format, first, options, None, size, 0)


def _complete(file_format: Format, chunks: Iterable[Cloud]) -> Iterator[Cloud]:
    """Yield chunks that have what a format needs."""
    for cloud in chunks:
        check_needs(file_format, cloud)
        yield cloud


def _chosen(
    target: PathOrStream, name: str, given: str | None, options: dict[str, Any]
) -> tuple[Format, Writer, dict[str, Any]]:
    """Return the format, its writer, and all options of that."""
    file_format = format_of(target, given, name, find_written)
    suffix = "." + (given or suffix_of(name)).lower().removeprefix(".")
    options = {**file_format.suffix_options.get(suffix, {}), **options}
    return file_format, writer_of(file_format, name, options), options


def _result(
    path: Path | None,
    file_format: Format,
    cloud: Cloud,
    options: Mapping[str, Any],
    found: Found,
    size: int,
    unused: int,
) -> WriteResult:
    origin = found if isinstance(found, tuple) else None
    lost = dropped(file_format, cloud, options, found)
    lost = (f"{counted(unused, 'row')} in no face", *lost) if unused else lost
    return WriteResult(path, file_format.name, size, origin, lost, renamed(file_format, cloud))


def writer_of(file_format: Format, name: str, options: Mapping[str, Any]) -> Writer:
    """Return the writer of a format."""
    if file_format.write is None:
        raise FormatError(
            f"{name}: {file_format.name} files cannot be written ({file_format.description}): "
            "write PLY, OBJ or NPZ"
        )
    signature = inspect.signature(file_format.write)
    try:
        signature.bind(None, None, **options)
    except TypeError as error:
        taken = [*signature.parameters][2:]
        raise FormatError(
            f"{name}: {error}: {file_format.name} takes {', '.join(taken) or 'no options'}"
        ) from error
    return file_format.write


def _write(
    stream: BinaryIO, cloud: Cloud, writer: Writer, options: dict[str, Any]
) -> tuple[Found, int]:
    if isinstance(stream, io.RawIOBase):
        return _write(written_whole(stream), cloud, writer, options)
    if not stream.seekable():
        held = io.BytesIO()
        found, size = _write(held, cloud, writer, options)
        stream.write(held.getbuffer())
        return found, size
    begin = stream.tell()
    with preserve_signals():
        found = writer(stream, cloud, **options)
    return found, stream.tell() - begin
