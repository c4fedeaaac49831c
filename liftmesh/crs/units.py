"""The units of coordinates, as the coordinate system or, of heights, the band of a raster says.

A GeoTIFF may say of its band that heights are in feet, where its coordinate system has metres in
the plane and says nothing of heights.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Protocol

from liftmesh.base.options import shown
from liftmesh.crs.description import FOOT, METRE, SURVEY_FOOT, System, Unit, is_number, parse_crs
from liftmesh.errors import FormatError, InputError, Option

SAYING_UNITS = ("raster", "landxml")
"""Entries of the metadata whose "unit" is that of heights."""

DEGREE = 111_320.0  # metres of a degree on the equator


class Placed(Protocol):
    """What has coordinates in a system: a cloud, or a surface."""

    @property
    def crs(self) -> str | None:
        """WKT or a number."""

    @property
    def metadata(self) -> Mapping[str, Any]:
        """What a file says besides."""


_NAMES = {
    METRE: ("m", "metre", "meter", "metres", "meters"),
    FOOT: ("ft", "foot", "feet", "international foot", "international feet"),
    SURVEY_FOOT: ("us survey foot", "us survey feet", "us-ft", "ftus", "us_ft", "foot_us", "sft"),
}


def planar_unit(crs: str | None) -> str | None:
    """Return the name of the unit of x."""
    system = parse_crs(crs)
    return system.units[0].name if system and system.units[0] else None


def stated_unit(crs: str | None) -> str:
    """Say the unit of x and y in what is told of a result, if it is known."""
    unit = planar_unit(crs)
    return f", x and y in {unit}" if unit else ""


def system_of(cloud: Placed) -> System | None:
    """Read what a coordinate system says, with the unit of a raster's band as that of z."""
    system, unit = parse_crs(cloud.crs), band_unit(cloud)
    if system is None or unit is None:
        return system
    return replace(system, units=(*system.units[:2], unit))


def band_unit(cloud: Placed) -> Unit | None:
    """Return the unit of heights that the band of a raster says, or a file of LandXML."""
    entries = (cloud.metadata.get(key) for key in SAYING_UNITS)
    texts = (each.get("unit") for each in entries if isinstance(each, Mapping))
    name = next((each.strip() for each in texts if isinstance(each, str) and each.strip()), None)
    if name is None:
        return None
    return next((unit for unit, names in _NAMES.items() if name.lower() in names), Unit(name, None))


def height_factors(cloud: Placed, target: str) -> tuple[float, float]:
    """Return what heights are multiplied by before and after a transformation to another system."""
    # A transformation takes heights for those that the systems state. Where a band says another
    # unit than its system, they are converted to that before; where its system states none, they
    # pass as they are, and are converted afterwards to the unit that the target states, if any.
    band = band_unit(cloud)
    stated, wanted = (_unit_of_heights(crs) for crs in (cloud.crs, target))
    if wanted is not None and stated is None and band is None and cloud.crs is not None:
        raise InputError(
            f"{Option('dst_crs')} is {shown(target)}, which states what heights are, but nothing "
            f"says their unit in the file: name their system, too, with {Option('src_crs', ...)}, "
            f"as 'EPSG:2263+6360' (US survey feet), or give {Option('dst_crs', ...)} without "
            "heights"
        )
    if band is None or (stated is None and wanted is None):
        return 1.0, 1.0
    if band.metres is None:
        raise InputError(
            f"{Option('dst_crs')} is {shown(target)}: the band says that heights are in "
            f"{shown(band.name)}, which cannot be converted: give a system without heights"
        )
    if stated is not None:
        return band.metres / stated, 1.0
    return 1.0, 1.0 if wanted is None else band.metres / wanted


def steps_in(scale: object, crs: str | None, target: str) -> list[float] | None:
    """Return steps of coordinates in another system that are as fine on the ground."""
    # Of an axis whose unit stays they are the same, of others powers of ten.
    one, other = parse_crs(crs), parse_crs(target)
    if not isinstance(scale, list) or len(scale) != 3 or one is None or other is None:
        return None
    if not all(isinstance(each, float) and 0 < each < math.inf for each in scale):
        return None
    return [*map(_step_in, scale, one.units, other.units)]


def _step_in(step: float, before: Unit | None, after: Unit | None) -> float:
    if before == after or (before is None) != (after is None):  # what is not said stays
        return step
    metres = [DEGREE if each.metres is None else each.metres for each in (before, after) if each]
    exponent = math.floor(math.log10(step * metres[0] / metres[1]) + 1e-9)
    return float(f"1e{exponent}")


def _unit_of_heights(crs: str | None) -> float | None:
    """Return how many metres the unit of z has that a system states."""
    system = parse_crs(crs)
    unit = None if system is None else system.units[2]
    return None if unit is None else unit.metres


def coordinate_warnings(system: System | None, *, is_transformed: bool = False) -> tuple[str, ...]:
    """Say what most users do not want of coordinates."""
    if system is None:
        return ()
    verb = "name a projected system with" if is_transformed else "transform them with"
    change = f"{verb} {Option('dst_crs', ...)}"
    if system.kind == "geographic":
        what = f"x and y are degrees ({system.name}), which are no lengths"
        return (f"{what}: {change}",)
    if system.kind == "geocentric":
        return (f"the coordinates are geocentric ({system.name}): {change}",)
    if system.is_mixed:
        x, y, z = (each.name if each else "?" for each in system.units)
        return (f"the units differ: x is in {x}, y in {y}, z in {z}",)
    return ()


def length_unit(crs: str | None, what: str, heights: Unit | None = None) -> str | None:
    """Return the unit that all coordinates have, for a format that has one for all."""
    system = parse_crs(crs)
    if crs is None and heights is not None and heights != METRE:
        raise FormatError(
            f"z is in {heights.name}, and the unit of x and y is not known, but {what} has one for "
            f"all: state their system with {Option('src_crs', ...)}"
        )
    if crs is None:
        return None
    if system is None or system.units[0] is None:
        is_lookup = is_number(crs) and importlib.util.find_spec("pyproj") is None
        remedy = "install liftmesh[terrain], or " if is_lookup else ""
        raise FormatError(
            f"the unit of {shown(crs)} is not known, but {what} states one: {remedy}state another "
            f"system with {Option('src_crs', ...)}"
        )
    if system.kind in {"geographic", "geocentric"}:
        raise FormatError(
            f"the coordinates are {system.kind} ({system.name}), but {what} holds lengths: "
            f"transform them with {Option('dst_crs', ...)}"
        )
    units = (*system.units, heights)
    names = dict.fromkeys(each.name for each in units if each is not None)
    if len(names) > 1:
        raise FormatError(
            f"the units of x, y and z are {' and '.join(names)}, but {what} has one for all: "
            f"transform them with {Option('dst_crs', ...)}"
        )
    return next(iter(names), None)
