"""Frame of a projection plane: planar coordinates and heights of points in space.

For ``"xy"`` the planar coordinates are x and y themselves: a view, no arithmetic. Every other plane
is a rigid frame, an origin and three right-handed unit axes u, v and normal: a row p has the planar
coordinates (p - origin).u and (p - origin).v and the height (p - origin).normal, each rounded. The
triangulation is exact for those rounded coordinates.

The origin, unless a matrix determines it, is in the middle of the rows, which keeps rounding errors
small far from zero; if the axes are parallel to the coordinate axes it is zero, and the coordinates
are the caller's own numbers.
Products are summed column by column, not by a matrix product, so that equal rows have equal
coordinates at any place in the array, and on every machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.arrays import as_coordinates, as_reals
from liftmesh.errors import DegenerateInputError, InputError

_ROWS = 1 << 14  # rows projected at a time: intermediate results fit in the cache
_DECOMPOSED_AT_ONCE = 1 << 19
_RIGID = 1e-9
_NOISE = 2.0**-46  # components of a fitted unit normal below this are rounding, not tilt


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A projection plane with its axes: converts points to planar coordinates and heights.

    Parameters
    ----------
    name : str
        ``"xy"``, ``"fit"``, ``"normal"`` or ``"matrix"``: how the plane was specified.
    origin : (3,) ndarray of float64
        The point in space with planar coordinates (0, 0) and height 0.
    axes : (3, 3) ndarray of float64
        The rows u, v and normal: unit vectors, right-handed.

    Examples
    --------
    >>> frame = resolve_plane((0, -2, 0), np.zeros((1, 3)))
    >>> frame.planar(np.array([[1.0, 2.0, 3.0]])), frame.heights(np.array([[1.0, 2.0, 3.0]]))
    (array([[1., 3.]]), array([-2.]))
    """

    name: str
    origin: Floats
    axes: Floats

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
            For ``"xy"`` a view of the first two columns; rounded products otherwise.

        Raises
        ------
        InputError
            The rows are not in space.

        Examples
        --------
        >>> resolve_plane("xy", np.zeros((0, 3))).planar(np.array([[1.0, 2.0, 3.0]]))
        array([[1., 2.]])
        """
        points = _rows(points)
        if self.name == "xy":
            return points[:, :2]
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
            For ``"xy"`` a view of the third column; rounded products otherwise.

        Raises
        ------
        InputError
            The rows are not in space.

        Examples
        --------
        >>> resolve_plane("xy", np.zeros((0, 3))).heights(np.array([[1.0, 2.0, 3.0]]))
        array([3.])
        """
        points = _rows(points)
        if self.name == "xy":
            return points[:, 2]
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
            New rows. For ``"xy"`` z is ``new``, and x and y are the same bit for bit.

        Raises
        ------
        InputError
            The rows are not in space, or there is not one height of each kind for each.

        Examples
        --------
        >>> frame = resolve_plane("xy", np.zeros((0, 3)))
        >>> frame.raised(np.array([[1.0, 2.0, 3.0]]), np.array([3.0]), np.array([9.0]))
        array([[1., 2., 9.]])
        """
        points = _rows(points)
        shapes = [getattr(heights, "shape", None) for heights in (old, new)]
        if shapes != [(len(points),)] * 2:
            raise InputError(f"{len(points)} rows need arrays of as many heights, not {shapes}")
        if self.name == "xy":
            return np.column_stack([points[:, :2], new])
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


def _rows(points: Floats) -> Floats:
    """Check rows in space; an array of float64 is returned itself."""
    rows = as_coordinates(points)
    if rows.shape[1] != 3:
        raise InputError("points have two columns: a projection needs x, y and z")
    return rows.astype(np.float64, copy=False)


def resolve_plane(plane: str | ArrayLike, points: Floats) -> Frame:
    """Convert the option ``plane`` to a frame.

    Parameters
    ----------
    plane : "xy", "fit", (3,) or (4, 4) array-like
        ``"xy"``: x and y as they are. ``"fit"``: the least squares plane of the finite rows; its
        normal has n_z > 0, or n_z = 0 and n_y > 0, or both zero and n_x > 0. It is computed in
        floating point and may differ by rounding for another order of the rows. A vector: the
        normal, of any length but zero. A matrix: the rigid transformation from space to plane
        coordinates, as ``trimesh.geometry.plane_transform`` returns it.
    points : (n, 3) ndarray of float64
        The rows to be projected; non-finite ones are ignored.

    Returns
    -------
    Frame
        The plane with its axes.

    Raises
    ------
    InputError
        The option is not one of these, the normal is zero, or the matrix is not rigid.
    DegenerateInputError
        The plane is to be fitted to fewer than three finite rows, or to collinear rows.

    Notes
    -----
    For every plane except ``"xy"`` the planar coordinates are rounded, and the triangulation is
    exact for the rounded coordinates.

    Examples
    --------
    >>> roof = np.array([[0.0, 0.0, 5.0], [4.0, 0.0, 5.0], [0.0, 3.0, 9.0], [4.0, 3.0, 9.0]])
    >>> resolve_plane("fit", roof).normal.round(6)
    array([ 0. , -0.8,  0.6])
    """
    if isinstance(plane, str):
        return _named(plane, points)
    values = _numbers(plane)
    if values.shape == (3,):
        return _around("normal", _normalized(values), _centre(points))
    return _from_matrix(values)


def _named(plane: str, points: Floats) -> Frame:
    if plane == "xy":
        return Frame("xy", np.zeros(3), np.eye(3))
    if plane == "fit":
        normal, centroid = _fit(points)
        return _around("fit", normal, centroid)
    raise InputError(f"plane {plane!r} is unknown: give 'xy', 'fit', a normal or a 4x4 matrix")


def _numbers(plane: ArrayLike) -> Floats:
    """Convert a normal or a matrix to an array of finite numbers."""
    remedy = "give 'xy', 'fit', a normal of three numbers or a rigid 4x4 matrix"
    try:
        with np.errstate(all="ignore"):
            values = as_reals(plane)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"plane cannot be read as numbers ({error}): {remedy}") from error
    if values.shape not in ((3,), (4, 4)):
        raise InputError(f"plane has the shape {values.shape}: {remedy}")
    if not np.isfinite(values).all():
        raise InputError(
            f"plane holds values that are not finite as float64, {values.tolist()}: {remedy}"
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


def _around(name: str, normal: Floats, centre: Floats) -> Frame:
    """Make the frame of a unit normal; its origin is zero if it has the coordinate axes."""
    axes = _axes(normal + 0.0)  # the sum turns -0.0 into 0.0: the axes must not depend on it
    exact = bool(np.isin(axes, (-1.0, 0.0, 1.0)).all())
    return Frame(name, np.zeros(3) if exact else centre, axes)


def _axes(normal: Floats) -> Floats:
    """Right-handed unit axes (u, v, normal) without branches or cancellation.

    T. Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6 (1), 2017: u and v are x and y
    for the normal z, and depend continuously on the normal in each hemisphere.
    """
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
    """Fit the least squares plane of the finite rows: its normal and the centroid.

    The rows are taken relative to one of them before any sum, so that a large offset costs no
    digits, and scaled by a power of two, so that nothing overflows. The normal is the last right
    singular vector; the rows have the same one as the triangular factor of their QR decomposition.
    """
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
