"""Projection planes: planar coordinates and heights of points in space.

For ``"xy"``, ``"xz"`` and ``"yz"`` the planar coordinates are two columns of the caller's: a view,
no arithmetic. Every other plane is a rigid frame, an origin and three right-handed unit axes u, v
and normal: a row p has the planar coordinates (p - origin).u and (p - origin).v and the height
(p - origin).normal, each rounded. The triangulation is exact for those rounded coordinates.

Products are summed column by column, not by a matrix product, so that equal rows have equal
coordinates at any place in the array, and on every machine.

The option ``plane`` is a name, a normal, an equation or a matrix (`resolve_plane`). The origin,
unless the plane determines it, is in the middle of the rows, which keeps rounding errors small far
from zero; if the axes are parallel to the coordinate axes it is on the normal through zero, and the
planar coordinates are the caller's own numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_coordinates, as_reals, read_only
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import counted, refused
from liftmesh.errors import DegenerateInputError, InputError, Option

_ROWS = 1 << 14  # rows projected at a time: intermediate results fit in the cache
# The planar coordinates of named planes are two columns, as they are.
_COLUMNS = {"xy": slice(0, 2), "xz": slice(0, 3, 2), "yz": slice(1, 3)}
_NAMED: dict[str, tuple[tuple[float, float, float], ...]] = {  # their axes u, v and normal
    "xy": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "xz": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "yz": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
}
_DECOMPOSED_AT_ONCE = 1 << 19
_RIGID = 1e-9
_NOISE = 2.0**-46  # components of a fitted unit normal below this are rounding, not tilt
_REMEDY = (
    "give 'xy', 'xz', 'yz', 'fit', a normal of three numbers, (a, b, c, d) of a plane "
    "ax + by + cz + d = 0, a point and a normal, or a rigid 4x4 matrix"
)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Frame(FrozenResult):
    """A projection plane with its axes, read-only: converts points to coordinates and heights.

    Parameters
    ----------
    name : str
        ``"xy"``, ``"xz"``, ``"yz"``, ``"fit"``, ``"normal"`` or ``"matrix"``: how the plane was
        specified.
    origin : (3,) ndarray of float64
        The point in space with planar coordinates (0, 0) and height 0.
    axes : (3, 3) ndarray of float64
        The rows u, v and normal: unit vectors, right-handed.

    See Also
    --------
    triangulate : Its option ``plane`` makes a frame.
    Surface.frame : The frame of a surface.

    Examples
    --------
    >>> import liftmesh
    >>> frame = liftmesh.triangulate(np.eye(3), plane="xz").frame
    >>> frame.planar(np.array([[1.0, 2.0, 3.0]])), frame.heights(np.array([[1.0, 2.0, 3.0]]))
    (array([[1., 3.]]), array([-2.]))
    """

    name: str
    origin: Floats
    axes: Floats

    def __repr__(self) -> str:
        origin, normal = (", ".join(f"{x:g}" for x in each) for each in (self.origin, self.normal))
        return f"<Frame: {self.name}, normal ({normal}) at ({origin})>"

    @property
    def normal(self) -> Floats:
        """(3,) ndarray of float64: the upward unit normal of the plane."""
        normal: Floats = self.axes[2]
        return normal

    @property
    def matrix(self) -> Floats:
        """(4, 4) ndarray of float64: the rigid transformation from space to plane coordinates."""
        matrix: Floats = np.eye(4)
        matrix[:3, :3] = self.axes
        matrix[:3, 3] = -self.axes @ self.origin
        return matrix

    def planar(self, points: Floats) -> Floats:
        """Project points to planar coordinates.

        Parameters
        ----------
        points : (n, 3) ndarray of float64
            Rows in space.

        Returns
        -------
        (n, 2) ndarray of float64
            For ``"xy"``, ``"xz"`` and ``"yz"`` a read-only view of these columns; rounded products
            otherwise.

        Raises
        ------
        InputError
            The rows are not in space.

        See Also
        --------
        heights : The third coordinate.

        Examples
        --------
        >>> Frame("xy", np.zeros(3), np.eye(3)).planar(np.array([[1.0, 2.0, 3.0]]))
        array([[1., 2.]])
        """
        points = _rows(points)
        if self.name in _COLUMNS:
            return read_only(points[:, _COLUMNS[self.name]])
        planar = np.empty((len(points), 2))
        self._project(points, 0, planar[:, 0])
        self._project(points, 1, planar[:, 1])
        return planar

    def heights(self, points: Floats) -> Floats:
        """Compute the heights of points above the plane.

        Parameters
        ----------
        points : (n, 3) ndarray of float64
            Rows in space.

        Returns
        -------
        (n,) ndarray of float64
            For ``"xy"`` a read-only view of z, for ``"yz"`` of x; for ``"xz"`` -y; rounded products
            for other planes.

        Raises
        ------
        InputError
            The rows are not in space.

        See Also
        --------
        planar : The other two coordinates.
        raised : Points with other heights.

        Examples
        --------
        >>> Frame("xy", np.zeros(3), np.eye(3)).heights(np.array([[1.0, 2.0, 3.0]]))
        array([3.])
        """
        points = _rows(points)
        if self.name in _COLUMNS and self.normal.max() == 1:
            return read_only(points[:, int(self.normal.argmax())])
        heights = np.empty(len(points))
        self._project(points, 2, heights)
        return heights

    def raised(self, points: Floats, old: Floats, new: Floats) -> Floats:
        """Move points along the normal from one height to another.

        Parameters
        ----------
        points : (n, 3) ndarray of float64
            Rows in space.
        old, new : (n,) ndarray of float64
            Their present heights and their new heights.

        Returns
        -------
        (n, 3) ndarray of float64
            New rows. If the normal is an axis through zero, as of ``"xy"``, the height is ``new``,
            and the other coordinates are the same bit for bit.

        Raises
        ------
        InputError
            The rows are not in space, or there is not one height of each kind for each.

        See Also
        --------
        heights : The present heights.

        Examples
        --------
        >>> frame = Frame("xy", np.zeros(3), np.eye(3))
        >>> frame.raised(np.array([[1.0, 2.0, 3.0]]), np.array([3.0]), np.array([9.0]))
        array([[1., 2., 9.]])
        """
        points = _rows(points)
        for heights in (old, new):
            if not isinstance(heights, np.ndarray) or heights.dtype.kind not in "iuf":
                raise refused("heights", heights, "give arrays of numbers", verb="are")
            if heights.shape != (len(points),):
                raise InputError(
                    f"heights have the shape {heights.shape} for {counted(len(points), 'row')}: "
                    "give one for each"
                )
        along = np.flatnonzero(self.normal)
        if len(along) == 1 and not self.origin.any():
            moved: Floats = points.copy()
            moved[:, along[0]] = new * self.normal[along[0]]
            return moved
        return points + (new - old)[:, None] * self.normal

    def _project(self, points: Floats, axis: int, along: Floats) -> None:
        """Compute coordinates along one axis, rounded; NaN and infinity raise no warning."""
        with np.errstate(invalid="ignore", over="ignore"):
            for start in range(0, len(points), _ROWS):
                rows = slice(start, start + _ROWS)
                along[rows] = self._along(points[rows], axis)

    def _along(self, points: Floats, axis: int) -> Floats:
        total: Any = None
        for column in np.flatnonzero(self.axes[axis]):
            part = (points[:, column] - self.origin[column]) * self.axes[axis, column]
            total = part if total is None else total + part
        result: Floats = total
        return result


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
    if plane in _NAMED:
        return Frame(plane, np.zeros(3), np.array(_NAMED[plane], dtype=np.float64))
    if plane == "fit":
        normal, centroid = _fit(points)
        return _around("fit", normal, centroid)
    raise InputError(f"{Option('plane')} {plane!r} is unknown: {_REMEDY}")


def _numbers(plane: ArrayLike) -> Floats:
    """Convert what determines a plane to an array of finite numbers."""
    try:
        with np.errstate(all="ignore"):
            values = as_reals(plane)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(
            f"{Option('plane')} cannot be read as numbers ({error}): {_REMEDY}"
        ) from error
    if values.shape not in ((3,), (4,), (2, 3), (4, 4)):
        raise InputError(f"{Option('plane')} has the shape {values.shape}: {_REMEDY}")
    if not np.isfinite(values).all():
        raise InputError(
            f"{Option('plane')} holds values that are not finite as float64, {values.tolist()}: "
            f"{_REMEDY}"
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


def _axes(normal: Floats) -> Floats:
    """Right-handed unit axes (u, v, normal) without branches or cancellation."""
    x, y, z = normal
    sign = np.copysign(1.0, z)
    factor = -1.0 / (sign + z)
    shear = x * y * factor
    u = [1.0 + sign * x * x * factor, sign * shear, -sign * x]
    v = [shear, sign + y * y * factor, -y]
    return np.array([u, v, normal])


def _from_equation(equation: Floats, centre: Floats) -> Frame:
    """Make the frame of the plane ax + by + cz + d = 0 near the middle of the rows."""
    normal = _normalized(equation[:3])
    largest = int(np.abs(equation[:3]).argmax())
    with np.errstate(over="ignore", invalid="ignore"):
        foot = -(equation[3] / equation[largest]) * normal[largest] * normal
        middle = centre - (normal * (centre - foot)).sum() * normal
    if not np.isfinite(foot).all():
        raise InputError(f"{Option('plane')} {equation.tolist()} overflows: {_REMEDY}")
    return _around("normal", normal, middle, through=foot)


def _centre(points: Floats) -> Floats:
    """Compute the centre of the finite rows' bounding box, independent of their order."""
    rows = _finite(points)
    if len(rows) == 0:
        return np.zeros(3)
    # Column by column: reductions along axis 0 take ten times as long.
    return np.array([column.min() / 2 + column.max() / 2 for column in rows.T])


def _finite(points: Floats) -> Floats:
    """Select the finite rows; return the array itself if all are finite."""
    finite = np.isfinite(points)
    return points if finite.all() else points[finite.all(axis=1)]


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
            f"give {Option('plane', 'xy')}, a normal or a matrix"
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


def _rows(points: Floats) -> Floats:
    """Check rows in space; an array of float64 is returned itself."""
    rows = as_coordinates(points)
    if rows.shape[1] != 3:
        raise InputError("points have two columns: a projection needs x, y and z")
    return rows.astype(np.float64, copy=False)
