"""Units of x, y and heights: what they are in metres, and how steep that makes a gradient.

Surveys with metres in the plane and feet in height exist, and in feet of two kinds. Angles and
areas in space compare heights with lengths, so heights are converted first, as far as the
coordinate system and the band of a raster say the units; where they do not, the caller may.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from liftmesh.arrays import as_reals
from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.height_units import band_unit, system_of

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface

_AXES = {"xy": (0, 1, 2), "xz": (0, 2, 1), "yz": (1, 2, 0)}


def metres_of(surface: Surface) -> tuple[float, float, float] | None:
    """Return how many metres the units of both planar coordinates and of heights have.

    Parameters
    ----------
    surface : Surface
        Its coordinate system says the units of x, y and z, or does not; the band of a raster may
        say that of z.

    Returns
    -------
    tuple of three float, or None
        None if a unit is not known, or if a turned plane mixes different ones.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> metres_of(liftmesh.triangulate(points, crs="EPSG:7415"))
    (1.0, 1.0, 1.0)
    """
    system = system_of(surface)
    units = () if system is None else system.units
    metres = [each.metres for each in units if each is not None and each.metres is not None]
    if len(metres) != 3:
        return None
    axes = _AXES.get(surface.frame.name)
    if axes is None:
        return (metres[0],) * 3 if len({*metres}) == 1 else None
    x, y, z = (metres[axis] for axis in axes)
    return x, y, z


def names_of(surface: Surface) -> tuple[str | None, str | None]:
    """Return the names of the unit in the plane and of that of heights.

    Parameters
    ----------
    surface : Surface
        As for `metres_of`.

    Returns
    -------
    tuple of two str or None
        None where a unit is not known, or where the plane has two.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    >>> names_of(liftmesh.triangulate(points, crs="EPSG:7415"))
    ('metre', 'metre')
    """
    system = system_of(surface)
    axes = _AXES.get(surface.frame.name)
    if axes is None:
        return None, None
    if system is None:
        band = band_unit(surface) if axes[2] == 2 else None
        return None, None if band is None else band.name
    x, y, z = (None if unit is None else unit.name for unit in (system.units[k] for k in axes))
    return (x if x == y else None), z


def rise_of(surface: Surface, z_factor: float | None) -> tuple[float, float]:
    """Return what gradients are multiplied by before they become angles.

    Parameters
    ----------
    surface : Surface
        The surface.
    z_factor : float, optional
        As in `Surface.slope`.

    Returns
    -------
    (float, float)
        For dz/dx and for dz/dy; both are 1 if nothing is known or given.

    Raises
    ------
    InputError
        The factor is not positive.

    Examples
    --------
    >>> import liftmesh
    >>> rise_of(liftmesh.triangulate([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), 0.5)
    (0.5, 0.5)
    """
    if z_factor is not None:
        factor = _positive(z_factor)
        return factor, factor
    x, y, z = metres_of(surface) or (1.0, 1.0, 1.0)
    return z / x, z / y


def steepness_of(surface: Surface, z_factor: float | None) -> tuple[float, float]:
    """Return what `rise_of` does, for slopes and their directions, which degrees do not have.

    Parameters
    ----------
    surface : Surface
        The surface.
    z_factor : float, optional
        As in `Surface.slope`.

    Returns
    -------
    (float, float)
        For dz/dx and for dz/dy.

    Raises
    ------
    InputError
        The factor is not positive, or none is given and the plane has angles.

    Examples
    --------
    >>> import liftmesh
    >>> steepness_of(liftmesh.triangulate([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), None)
    (1.0, 1.0)
    """
    system = system_of(surface)
    axes = _AXES.get(surface.frame.name, (0, 1))[:2]
    units = [] if system is None else [system.units[axis] for axis in axes]
    if z_factor is None and any(each is not None and each.metres is None for each in units):
        raise InputError(
            "x and y are degrees, which are no lengths, so slopes and aspects are wrong: read the "
            "points with to_crs= a projected system, or give z_factor="
        )
    return rise_of(surface, z_factor)


def _positive(value: Any) -> float:
    try:
        factor = float(as_reals(value))
    except (TypeError, ValueError, OverflowError):
        factor = math.nan
    if not 0 < factor < math.inf:
        raise InputError(f"z_factor is {shown(value)}: give a positive number")
    return factor
