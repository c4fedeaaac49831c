"""Frame of a projection plane: planar coordinates and heights of points in space.

For ``"xy"``, ``"xz"`` and ``"yz"`` the planar coordinates are two columns of the caller's: a view,
no arithmetic. Every other plane is a rigid frame, an origin and three right-handed unit axes u, v
and normal: a row p has the planar coordinates (p - origin).u and (p - origin).v and the height
(p - origin).normal, each rounded. The triangulation is exact for those rounded coordinates.

Products are summed column by column, not by a matrix product, so that equal rows have equal
coordinates at any place in the array, and on every machine.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_coordinates, read_only
from liftmesh.base.frozen import constructed_from, freeze
from liftmesh.base.options import counted, shown
from liftmesh.errors import InputError

_ROWS = 1 << 14  # rows projected at a time: intermediate results fit in the cache

# The planar coordinates of named planes are two columns, as they are.
_COLUMNS = {"xy": slice(0, 2), "xz": slice(0, 3, 2), "yz": slice(1, 3)}
NAMED: dict[str, tuple[tuple[float, float, float], ...]] = {  # their axes u, v and normal
    "xy": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "xz": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "yz": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
}


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
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

    def __post_init__(self) -> None:
        freeze(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

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

        Examples
        --------
        >>> frame = Frame("xy", np.zeros(3), np.eye(3))
        >>> frame.raised(np.array([[1.0, 2.0, 3.0]]), np.array([3.0]), np.array([9.0]))
        array([[1., 2., 9.]])
        """
        points = _rows(points)
        for heights in (old, new):
            if not isinstance(heights, np.ndarray) or heights.dtype.kind not in "iuf":
                raise InputError(f"heights are {shown(heights)}: give arrays of numbers")
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


def _rows(points: Floats) -> Floats:
    """Check rows in space; an array of float64 is returned itself."""
    rows = as_coordinates(points)
    if rows.shape[1] != 3:
        raise InputError("points have two columns: a projection needs x, y and z")
    return rows.astype(np.float64, copy=False)
