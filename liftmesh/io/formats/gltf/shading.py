"""What viewers need to shade a mesh: colours as linear light, and normals of vertices.

*Colours.* ``COLOR_0`` holds amounts of light, while 8-bit colours are steps of sRGB, which are
finer in the dark (IEC 61966-2-1). 16 bits tell all of these steps apart, so that each of the 256
values comes back; alpha is an amount in both.

*Normals.* That of a vertex is the sum of the normals of its faces, each as long as twice its area.
The result must not depend on how faces are ordered and where their corners begin: each face is
computed from its lexicographically least corner on, and the terms of a vertex are added in
ascending order.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats
from liftmesh.base.colors import as_uint8, fits_eight_bits, with_alpha

COMPUTED = "computed"  # of normals that a mesh had none of: a file says it, and none come back

_TOP = 65535
_ALPHA = 257  # steps of 16 bits in one of 8 bits
_SINGLE = 1e-6  # what single precision may change in a share of one


def _light(levels: Floats) -> Floats:
    """Convert sRGB in [0, 1] to light."""
    return np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)


_LIGHT = _light(np.arange(256) / 255.0)
_STEPS = np.rint(_LIGHT * _TOP).astype(np.uint16)


def as_light(colors: Array) -> NDArray[np.uint16]:
    """Convert colours to light and alpha in 16 bits."""
    bytes_ = with_alpha(as_uint8(colors))
    return np.column_stack([_STEPS[bytes_[:, :3]], bytes_[:, 3].astype(np.uint16) * _ALPHA])


def of_light(light: Array) -> tuple[NDArray[np.uint8], bool]:
    """Convert light, and alpha if there is any, to 8-bit colours; say whether that rounds."""
    levels, is_rounded = _levels(light[:, :3])
    if light.shape[1] == 3:
        return with_alpha(levels), is_rounded
    alpha = light[:, [3, 3, 3]]
    rounded = is_rounded or not fits_eight_bits(alpha)
    return np.column_stack([levels, as_uint8(alpha)[:, 0]]), rounded


def _levels(light: Array) -> tuple[NDArray[np.uint8], bool]:
    """Find the nearest levels of sRGB; whole numbers are looked up."""
    if light.dtype.kind == "f":
        levels = _nearest(light.astype(np.float64))
        return levels, bool((np.abs(_LIGHT[levels] - light) > _SINGLE).any())
    top = np.iinfo(light.dtype).max
    table = _nearest(np.arange(top + 1) / top)
    is_exact = np.rint(_LIGHT[table] * top) == np.arange(top + 1)
    return table[light], not is_exact[light].all()


def _nearest(light: Floats) -> NDArray[np.uint8]:
    levels = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(levels * 255.0).astype(np.uint8)


def vertex_normals(points: Floats, faces: Array) -> Floats:
    """Compute unit normals of the vertices, weighted by area; where there are none, z is up."""
    normals = np.zeros_like(points)
    terms = _of_faces(points, faces)
    at = faces.T.ravel()
    for axis in range(3):
        values = np.tile(terms[:, axis], 3)
        order = np.lexsort([values, at])
        normals[:, axis] = np.bincount(at[order], values[order], minlength=len(points))
    lengths = _lengths(normals)
    is_known = lengths > 0
    normals[~is_known] = [0.0, 0.0, 1.0]
    normals[is_known] /= lengths[is_known, None]
    return normals


def _of_faces(points: Floats, faces: Array) -> Floats:
    """Compute the normals of faces, as long as twice their areas in some unit."""
    rank = np.empty(len(points), np.int64)
    rank[np.lexsort(points.T[::-1])] = np.arange(len(points))
    first = rank.take(faces, axis=0).argmin(axis=1)[:, None]
    a, b, c = (points[np.take_along_axis(faces, (first + k) % 3, axis=1)[:, 0]] for k in range(3))
    sides = np.concatenate([b - a, c - a])
    exponent = np.frexp(np.abs(sides).max(initial=0.0))[1]  # so that no product overflows
    sides = np.ldexp(sides, -exponent)
    product: Floats = np.cross(sides[: len(faces)], sides[len(faces) :])
    return product


def _lengths(rows: Floats) -> Floats:
    lengths: Floats = np.sqrt((rows * rows).sum(axis=1))
    return lengths
