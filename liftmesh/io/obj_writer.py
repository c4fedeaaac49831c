"""Cloud to OBJ: the shortest digits that bring every coordinate back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.digits import write_rows
from liftmesh.io.file_colors import unit
from liftmesh.io.needs import check_points

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud


# k/255 in the digits of single precision: readers that hold floats get the very same number.
_EIGHT_BITS = np.array([str(np.float32(k / 255)) for k in range(256)], dtype=object)


def write_obj(stream: BinaryIO, cloud: Cloud, *, comments: Sequence[str] = ()) -> None:
    """Write a cloud, or a mesh, as OBJ.

    Vertices are ``v x y z``, with colours ``v x y z r g b`` (the common extension, floats from 0 to
    1); normals are ``vn`` lines, one a vertex, and faces ``f a b c`` or ``f a//a b//b c//c``. OBJ
    has no place for alpha and attributes.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        What to write.
    comments : sequence of str
        Lines for the top of the file.

    Raises
    ------
    FormatError
        There are no points, a colour is not between 0 and 1, or a comment is not one line.
    """
    check_points(cloud, "OBJ")
    for comment in ["liftmesh", *([comments] if isinstance(comments, str) else comments)]:
        if not comment.isprintable():
            raise FormatError(f"comment {comment!r} cannot stand in an OBJ file: give single lines")
        stream.write(f"# {comment}\n".encode())
    write_rows(stream, [cloud.points, *_colors(cloud)], prefix="v ")
    if cloud.normals is not None:
        write_rows(stream, [cloud.normals], prefix="vn ")
    if cloud.faces is not None:
        _write_faces(stream, cloud.faces, normals=cloud.normals is not None)


def _colors(cloud: Cloud) -> list[Array]:
    if cloud.colors is None:
        return []
    rgb = cloud.colors[:, :3]
    return [np.take(_EIGHT_BITS, rgb) if rgb.dtype == np.uint8 else unit(rgb)]


def _write_faces(stream: BinaryIO, faces: Array, *, normals: bool) -> None:
    counted = faces.astype(np.int64) + 1
    if normals:
        a, b, c = counted.T
        write_rows(stream, [a, a, b, b, c, c], template="f %d//%d %d//%d %d//%d\n")
    else:
        write_rows(stream, [counted], prefix="f ")
