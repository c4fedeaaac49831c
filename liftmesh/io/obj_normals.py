"""Normals of an OBJ file: it gives one to each corner, a Cloud has one for each vertex."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.io.obj_corners import Corners


def vertex_normals(
    normals: Floats, corners: Corners | None, vertices: int, name: str
) -> Floats | None:
    """Give every vertex the normal that its corners name, if they agree.

    Where corners use the numbers of their vertices, or there are no faces, and there are as many
    normals as vertices, the two lists belong together row by row. Otherwise a vertex without any
    corner gets the normal (0, 0, 0). None if corners of a vertex differ, or have no normal.

    Raises
    ------
    FormatError
        A corner refers to a normal that is not there; the message names its line.
    """
    if corners is None:
        return normals if len(normals) == vertices else None
    _check(corners, len(normals), name)
    named = corners.normals
    if len(normals) == vertices and np.array_equal(named, corners.vertices.values):
        return normals
    if not len(named) or (named == -1).any():
        return None
    return _gathered(normals, corners, vertices)


def _gathered(normals: Floats, corners: Corners, vertices: int) -> Floats | None:
    at = corners.vertices.values
    found = np.zeros((vertices, 3))
    found[at] = normals[corners.normals]
    agree = np.array_equal(found[at], normals[corners.normals], equal_nan=True)
    return found if agree else None


def _check(corners: Corners, count: int, name: str) -> None:
    wrong = np.flatnonzero((corners.normals < -1) | (corners.normals >= count))
    if len(wrong):
        line = corners.lines[corners.vertices.row_of(wrong[0])]
        raise FormatError(
            f"{name}: line {line}: a corner refers to normal {corners.normals[wrong[0]]} "
            f"(counted from 0), but there are {count} normals"
        )
