"""Areas of a surface, and volumes between it and a level.

Each face is measured from its corners in lexicographic order, and the faces are summed exactly,
rounded once: so no bit depends on the order of the rows. A prism between a face and a level that it
crosses is cut along the line where they meet.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.arrays import as_reals
from liftmesh.choices import as_switch, shown
from liftmesh.errors import InputError
from liftmesh.terrain.corners import ranks
from liftmesh.terrain.units import metres_of, rise_of
from liftmesh.terrain.within import check_measured, in_all, in_each, level_within

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


@dataclass(frozen=True, slots=True)
class Volume:
    """Volumes between a surface and a level, as `Surface.volume` returns them.

    Attributes
    ----------
    above : float
        Of what is under the surface and above the level.
    below : float
        Of what is under the level and above the surface.
    area : float
        The area of the faces in the plane.
    level : float
        The level.
    cubic_metres : float or None
        How many cubic metres a unit of the volumes has; None if the coordinate system does not say
        the units of x, y and z, which may differ.

    Examples
    --------
    >>> import liftmesh
    >>> wedge = liftmesh.triangulate([[0, 0, -2], [2, 0, 2], [0, 3, -2], [2, 3, 2]])
    >>> found = wedge.volume()
    >>> found.above, found.below, found.net
    (3.0, 3.0, 0.0)
    """

    above: float
    below: float
    area: float
    level: float
    cubic_metres: float | None = None

    @property
    def net(self) -> float:
        """What is above less what is below."""
        return self.above - self.below


class Measuring:
    """The methods of a `Surface` that measure it."""

    __slots__ = ()

    def area(self: Any, *, planar: bool = False, z_factor: float | None = None) -> float:
        """Compute the area of the faces.

        Parameters
        ----------
        planar : bool, default False
            Measure their projections to the plane instead.
        z_factor : float, optional
            As for `slope`.

        Returns
        -------
        float
            In square units of x, which y shares.

        Raises
        ------
        InputError
            The area is beyond the largest double, the factor is not positive, or `planar` is
            neither True nor False.

        Examples
        --------
        >>> import liftmesh
        >>> roof = liftmesh.triangulate([[0, 0, 0], [3, 0, 4], [0, 2, 0], [3, 2, 4]])
        >>> roof.area(), roof.area(planar=True)
        (10.0, 6.0)
        """
        is_planar = as_switch("planar", planar)
        corners, heights = _faces(self)
        rise, _ = rise_of(self, z_factor)
        with np.errstate(all="ignore"):
            areas = _planar(corners) if is_planar else _inclined(corners, heights * rise)
            return _total("area", areas)

    def volume(self: Any, level: float = 0.0, *, polygon: object = None) -> Volume:
        """Compute the volumes between the faces and a level.

        Parameters
        ----------
        level : float, default 0
            A height above the plane.
        polygon : object, optional
            As for `cut_and_fill`.

        Returns
        -------
        Volume
            What is above the level, and what is below; only where there are faces.

        Raises
        ------
        InputError
            The level is no finite number, or a volume is beyond the largest double; or the polygon
            is invalid, or has no area in common with the faces.
        FormatError
            A file of a polygon is invalid.
        MissingDependencyError
            shapely is not installed.
        OSError
            A file of a polygon cannot be opened.

        Examples
        --------
        >>> import liftmesh
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 6]])
        >>> hill.volume().above, hill.volume(3).above
        (32.0, 4.0)
        """
        at = _level(level)
        if polygon is not None:
            measure = partial(level_within, self, at)
            return Volume(*in_all(self, polygon, measure), at, cubic_metres_of(self))
        corners, heights = _faces(self)
        with np.errstate(all="ignore"):
            areas = _planar(corners)
            prisms = _prisms(areas, np.sort(heights - at, axis=1))
        above, below = (_total("volume", each) for each in prisms)
        return Volume(above, below, _total("area", areas), at, cubic_metres_of(self))

    def volume_by_polygon(
        self: Any, polygon: object, level: float = 0.0, *, by: str = "name"
    ) -> dict[str | int, Volume]:
        """Compute the volumes between the faces and a level in each of several polygons.

        Parameters
        ----------
        polygon : object
            As for `cut_and_fill_by_polygon`.
        level : float, default 0
            A height above the plane.
        by : str, default "name"
            As for `cut_and_fill_by_polygon`.

        Returns
        -------
        dict of str or int to Volume
            As from `volume`, for each polygon; zeros where it has no area in common with the faces.

        Raises
        ------
        InputError
            As for `volume`, or two polygons have one name, or none has the property.
        FormatError, MissingDependencyError, OSError
            As for `volume`.

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
        >>> found = slope.volume_by_polygon([[1, 1], [3, 1], [3, 3], [1, 3]])
        >>> round(found[0].above, 9)
        8.0
        """
        at, unit = _level(level), cubic_metres_of(self)
        found = in_each(self, polygon, partial(level_within, self, at), by)
        return {name: Volume(*each, at, unit) for name, each in found}


def _total(name: str, parts: Floats) -> float:
    """Sum what faces have, rounded once."""
    try:
        total = math.fsum(parts.tolist())
    except (OverflowError, ValueError):
        total = math.inf
    check_measured((name, total))
    return total


def _faces(surface: Surface) -> tuple[Floats, Floats]:
    """Return the corners of the faces by x, then y, (m, 3, 2), and their heights, (m, 3)."""
    faces = surface.faces
    planar = surface.triangulation.points[faces]
    order = ranks(planar)
    heights = surface.frame.heights(surface.vertices)[np.take_along_axis(faces, order, axis=1)]
    return np.take_along_axis(planar, order[..., None], axis=1), heights


def _turns(corners: Floats) -> Floats:
    """Compute twice the planar areas."""
    (bx, by), (cx, cy) = (np.moveaxis(corners[:, k] - corners[:, 0], -1, 0) for k in (1, 2))
    turns: Floats = np.abs(bx * cy - by * cx)
    return turns


def _planar(corners: Floats) -> Floats:
    return _turns(corners) / 2


def _inclined(corners: Floats, heights: Floats) -> Floats:
    """Compute the areas in space: half the lengths of cross products."""
    (bx, by), (cx, cy) = (np.moveaxis(corners[:, k] - corners[:, 0], -1, 0) for k in (1, 2))
    bz, cz = heights[:, 1] - heights[:, 0], heights[:, 2] - heights[:, 0]
    x, y = by * cz - bz * cy, bz * cx - bx * cz
    normals = np.stack([x, y, _turns(corners)])
    scale = np.frexp(np.abs(normals).max(axis=0))[1]  # squares of larger numbers are no doubles
    x, y, turns = np.ldexp(normals, -scale)
    areas: Floats = np.ldexp(np.sqrt(x * x + y * y + turns**2) / 2, scale)
    return areas


def _prisms(areas: Floats, heights: Floats) -> tuple[Floats, Floats]:
    """Compute the volumes of prisms above and below zero, heights ascending in each row.

    Where a corner alone is on its side, its part is a tetrahedron: its height, and the shares of
    the two sides that it reaches along. The other part is what is missing to the whole prism.
    """
    low, middle, high = heights.T
    whole = areas * ((low + middle + high) / 3)
    with np.errstate(divide="ignore", invalid="ignore"):
        under = areas * (-low / 3) * (low / (low - middle)) * (low / (low - high))
        over = areas * (high / 3) * (high / (high - low)) * (high / (high - middle))
    one_below, one_above = (low < 0) & (middle >= 0), (middle < 0) & (high > 0)
    above = np.select([low >= 0, one_below, one_above], [whole, whole + under, over], 0.0)
    below = np.select([high <= 0, one_above, one_below], [-whole, over - whole, under], 0.0)
    return np.maximum(above, 0), np.maximum(below, 0)


def _level(level: Any) -> float:
    try:
        found = float(as_reals(level))
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not math.isfinite(found):
        raise InputError(f"level is {shown(level)}: give a finite height")
    return found


def cubic_metres_of(surface: Surface) -> float | None:
    """Return how many cubic metres a unit of volume has.

    Parameters
    ----------
    surface : Surface
        Its coordinate system says the units of x, y and z, or does not.

    Returns
    -------
    float or None
        None if a unit is not known.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> cubic_metres_of(liftmesh.triangulate(points, crs="EPSG:7415"))
    1.0
    """
    metres = metres_of(surface)
    return None if metres is None else math.prod(metres)
