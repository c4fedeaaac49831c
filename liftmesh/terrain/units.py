"""Units of x, y and heights: what they are in metres, and how steep that makes a gradient.

Surveys with metres in the plane and feet in height exist, and in feet of two kinds. Angles and
areas in space compare heights with lengths, so heights are converted first, as far as the
coordinate system and the band of a raster say the units; where they do not, the caller may.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from liftmesh.base.options import as_positive
from liftmesh.crs.units import Placed, band_unit, system_of
from liftmesh.errors import InputError, Option

if TYPE_CHECKING:
    from liftmesh.terrain.frame import Frame


class OverPlane(Placed, Protocol):
    """What is over a plane, in a coordinate system: a surface, in memory or in tiles."""

    @property
    def frame(self) -> Frame:
        """The plane."""


_AXES = {"xy": (0, 1, 2), "xz": (0, 2, 1), "yz": (1, 2, 0)}


def metres_of(surface: OverPlane) -> tuple[float, float, float] | None:
    """Return how many metres the units of both planar coordinates and of heights have."""
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


def unit_names(surface: OverPlane) -> tuple[str | None, str | None]:
    """Return the names of the unit in the plane and of that of heights."""
    system = system_of(surface)
    axes = _AXES.get(surface.frame.name)
    if axes is None:
        return None, None
    if system is None:
        band = band_unit(surface) if axes[2] == 2 else None
        return None, None if band is None else band.name
    x, y, z = (None if unit is None else unit.name for unit in (system.units[k] for k in axes))
    return (x if x == y else None), z


def slope_scale(surface: OverPlane, z_factor: float | None) -> tuple[float, float]:
    """Return what gradients are multiplied by before they become angles."""
    if z_factor is not None:
        factor = as_positive("z_factor", z_factor, "a positive number")
        return factor, factor
    x, y, z = metres_of(surface) or (1.0, 1.0, 1.0)
    return z / x, z / y


def steepness(surface: OverPlane, z_factor: float | None) -> tuple[float, float]:
    """Return `slope_scale` for slopes, which x and y in degrees have only by a factor."""
    system = system_of(surface)
    axes = _AXES.get(surface.frame.name, (0, 1))[:2]
    units = [] if system is None else [system.units[axis] for axis in axes]
    if z_factor is None and any(each is not None and each.metres is None for each in units):
        raise InputError(
            "x and y are degrees, which are no lengths, so slopes and aspects are wrong: read the "
            f"points with {Option('dst_crs', ...)} a projected system, or give "
            f"{Option('z_factor', ...)}"
        )
    return slope_scale(surface, z_factor)
