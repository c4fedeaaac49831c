"""The units of a cloud's coordinates: what its system says, and the unit that a raster's band says.

A GeoTIFF may say of its band that heights are in feet, where its coordinate system has metres in
the plane and says nothing of heights.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from liftmesh.crs import FOOT, METRE, SURVEY_FOOT, System, Unit, described

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud

_NAMES = {
    METRE: ("m", "metre", "meter", "metres", "meters"),
    FOOT: ("ft", "foot", "feet", "international foot", "international feet"),
    SURVEY_FOOT: ("us survey foot", "us survey feet", "us-ft", "ftus", "us_ft", "foot_us", "sft"),
}


def system_of(cloud: Cloud) -> System | None:
    """Read what a cloud's coordinate system says, with the unit of a raster's band as that of z.

    Parameters
    ----------
    cloud : Cloud
        The rows.

    Returns
    -------
    System or None
        None if the cloud has no system, or it cannot be understood.

    Examples
    --------
    >>> import liftmesh
    >>> band = {"raster": {"unit": "ft"}}
    >>> cloud = replace(liftmesh.as_cloud([[0, 0, 1]]), crs="EPSG:25832", metadata=band)
    >>> system_of(cloud).units[2].name
    'foot'
    """
    system, unit = described(cloud.crs), band_unit(cloud)
    if system is None or unit is None:
        return system
    return replace(system, units=(*system.units[:2], unit))


def band_unit(cloud: Cloud) -> Unit | None:
    """Return the unit that the band of a raster says of its heights.

    Parameters
    ----------
    cloud : Cloud
        The rows.

    Returns
    -------
    Unit or None
        None if they are of no raster, or its band says nothing.

    Examples
    --------
    >>> import liftmesh
    >>> band = {"raster": {"unit": "US survey foot"}}
    >>> band_unit(replace(liftmesh.as_cloud([[0, 0, 1]]), metadata=band)).name
    'US survey foot'
    """
    raster = cloud.metadata.get("raster")
    text = raster.get("unit") if isinstance(raster, Mapping) else None
    if not isinstance(text, str) or not text.strip():
        return None
    name = text.strip()
    return next((unit for unit, names in _NAMES.items() if name.lower() in names), Unit(name, None))
