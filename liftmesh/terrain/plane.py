"""The option ``plane``: from a name, a normal, a plane equation or a matrix to a `Frame`.

The origin, unless the plane determines it, is in the middle of the rows, which keeps rounding
errors small far from zero; if the axes are parallel to the coordinate axes it is on the normal
through zero, and the planar coordinates are the caller's own numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_reals
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.terrain.frame import NAMED, Frame

_DECOMPOSED_AT_ONCE = 1 << 19
_RIGID = 1e-9
_NOISE = 2.0**-46  # components of a fitted unit normal below this are rounding, not tilt
_REMEDY = (
    "give 'xy', 'xz', 'yz', 'fit', a normal of three numbers, (a, b, c, d) of a plane "
    "ax + by + cz + d = 0, a point and a normal, or a rigid 4x4 matrix"
)


def resolve_plane(plane: str | ArrayLike, points: Floats) -> Frame:
    """Convert the option ``plane`` to a frame."""
    if isinstance(plane, str):
        return _named(plane, points)
    values = _numbers(plane)
    if values.shape == (4, 4):
        return _from_matrix(values)
    if values.shape == (4,):
        return _from_equation(values, _centre(points))
    if values.shape == (2, 3):
        return _around("normal", _normalized(values[1]), values[0], through=values[0])
    return _around("normal", _normalized(values), _centre(points))


def _named(plane: str, points: Floats) -> Frame:
    if plane in NAMED:
        return Frame(plane, np.zeros(3), np.array(NAMED[plane], dtype=np.float64))
    if plane == "fit":
        normal, centroid = _fit(points)
        return _around("fit", normal, centroid)
    raise InputError(f"plane {plane!r} is unknown: {_REMEDY}")


def _numbers(plane: ArrayLike) -> Floats:
    """Convert what determines a plane to an array of finite numbers."""
    try:
        with np.errstate(all="ignore"):
            values = as_reals(plane)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"plane cannot be read as numbers ({error}): {_REMEDY}") from error
    if values.shape not in ((3,), (4,), (2, 3), (4, 4)):
        raise InputError(f"plane has the shape {values.shape}: {_REMEDY}")
    if not np.isfinite(values).all():
        raise InputError(
            f"plane holds values that are not finite as float64, {values.tolist()}: {_REMEDY}"
        )
    return values


def _normalized(vector: Floats) -> Floats:
    """Scale a vector to length one, by a power of two first, so that no square overflows."""
    largest = np.abs(vector).max()
    if largest == 0:
        raise InputError("the plane's normal is (0, 0, 0): give an upward vector")
    scaled = np.ldexp(vector, -np.frexp(largest)[1])
    unit: Floats = scaled / np.sqrt((scaled * scaled).sum())
    return unit


def _around(name: str, normal: Floats, centre: Floats, through: Floats | None = None) -> Frame:
    """Make the frame of a unit normal, through a point if the height of the plane matters."""
    axes = _axes(normal + 0.0)  # the sum turns -0.0 into 0.0: the axes must not depend on it
    exact = bool(np.isin(axes, (-1.0, 0.0, 1.0)).all())
    if not exact:
        return Frame(name, centre, axes)
    return Frame(name, np.zeros(3) if through is None else np.where(normal, through, 0.0), axes)


def _from_equation(equation: Floats, centre: Floats) -> Frame:
    """Make the frame of the plane ax + by + cz + d = 0 near the middle of the rows."""
    normal = _normalized(equation[:3])
    largest = int(np.abs(equation[:3]).argmax())
    with np.errstate(over="ignore", invalid="ignore"):
        foot = -(equation[3] / equation[largest]) * normal[largest] * normal
        middle = centre - (normal * (centre - foot)).sum() * normal
    if not np.isfinite(foot).all():
        raise InputError(f"plane {equation.tolist()} overflows: {_REMEDY}")
    return _around("normal", normal, middle, through=foot)


def _axes(normal: Floats) -> Floats:
    """Right-handed unit axes (u, v, normal) without branches or cancellation."""
    x, y, z = normal
    sign = np.copysign(1.0, z)
    factor = -1.0 / (sign + z)
    shear = x * y * factor
    u = [1.0 + sign * x * x * factor, sign * shear, -sign * x]
    v = [shear, sign + y * y * factor, -y]
    return np.array([u, v, normal])


def _finite(points: Floats) -> Floats:
    """Select the finite rows; return the array itself if all are finite."""
    finite = np.isfinite(points)
    return points if finite.all() else points[finite.all(axis=1)]


def _centre(points: Floats) -> Floats:
    """Compute the centre of the finite rows' bounding box, independent of their order."""
    rows = _finite(points)
    if len(rows) == 0:
        return np.zeros(3)
    # Column by column: reductions along axis 0 take ten times as long.
    return np.array([column.min() / 2 + column.max() / 2 for column in rows.T])


def _fit(points: Floats) -> tuple[Floats, Floats]:
    """Fit the least squares plane of the finite rows: its normal and the centroid."""
    rows = _finite(points)
    if len(rows) < 3:
        raise DegenerateInputError(
            f"a plane cannot be fitted to {len(rows)} finite rows: it needs three or more"
        )
    exponent = int(np.frexp(np.abs(rows).max())[1])
    base = np.ldexp(rows[0], -exponent)
    centred = np.ldexp(rows, -exponent)
    centred -= base
    shift = centred.mean(axis=0)
    centred -= shift
    _, spread, directions = np.linalg.svd(_triangle(centred))
    if spread[1] <= len(rows) * np.finfo(np.float64).eps * spread[0]:
        raise DegenerateInputError(
            "a plane cannot be fitted: all finite rows are equal or on one line; "
            "give plane='xy', a normal or a matrix"
        )
    return _upward(directions[2]), np.ldexp(base + shift, exponent)


def _triangle(rows: Floats) -> Floats:
    """Compute the triangular factor of the QR decomposition in parts; Ctrl-C works in between."""
    triangle: Any = rows[:0]
    for start in range(0, len(rows), _DECOMPOSED_AT_ONCE):
        part = rows[start : start + _DECOMPOSED_AT_ONCE]
        triangle = np.linalg.qr(np.concatenate((triangle, part)), mode="r")
    return np.asarray(triangle)


def _upward(normal: Floats) -> Floats:
    """Remove noise from a fitted normal and make its last nonzero component positive."""
    cleaned = _normalized(np.where(np.abs(normal) < _NOISE, 0.0, normal))
    last = cleaned[np.flatnonzero(cleaned)[-1]]
    return cleaned if last > 0 else -cleaned


def _from_matrix(matrix: Floats) -> Frame:
    """Make the frame of a rigid matrix; its origin is the point that is mapped to zero."""
    _check_rigid(matrix)
    axes = matrix[:3, :3].copy()
    origin: Floats = np.linalg.solve(axes, -matrix[:3, 3]).astype(np.float64)
    return Frame("matrix", origin, axes)


def _check_rigid(matrix: Floats) -> None:
    axes = matrix[:3, :3]
    if not np.array_equal(matrix[3], [0.0, 0.0, 0.0, 1.0]):
        raise InputError(
            f"the plane's matrix has the last row {matrix[3].tolist()}: it must be (0, 0, 0, 1); "
            "transpose a matrix that acts on row vectors"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        error = np.abs(axes @ axes.T - np.eye(3)).max()
    if not error <= _RIGID:
        raise InputError(
            f"the plane's matrix is not rigid, its rotation is off by {error:.3g}: "
            "remove scale and shear"
        )
    if np.linalg.det(axes) < 0:
        raise InputError(
            "the plane's matrix is a reflection (determinant -1): negate one row of its rotation"
        )
