"""Whether coordinates are in one system: of clouds, surfaces, domains, polygons and files.

`Cloud.crs` is a text; objects of geopandas hold systems of pyproj. Texts may differ where the
systems are the same, so pyproj is asked. Nothing is known to differ without it but numbers.
"""

from __future__ import annotations

import re
from typing import Any

from liftmesh.base.options import refused, shown
from liftmesh.crs.description import (
    check_system,
    is_number,
    is_system,
    look_up,
    parse_crs,
    urn_of,
)
from liftmesh.errors import InputError, MissingDependencyError
from liftmesh.optional import load


def crs_of(held: Any) -> str | None:
    """Return the coordinate system that an object says it is in."""
    crs = getattr(held, "crs", None)
    if crs is None or isinstance(crs, str):
        return crs
    return text_of(crs) if hasattr(crs, "to_authority") else None


def text_of(crs: Any) -> str:
    """Convert a coordinate system of pyproj to text."""
    authority = crs.to_authority(min_confidence=100)
    return ":".join(authority) if authority and authority[0] == "EPSG" else str(crs.to_wkt())


_OF_FILES = re.compile(r"init\s*=|grids|file|json|pipeline|[@\\{]|\.\.|(?<! )/", re.IGNORECASE)


def as_system(name: str, crs: Any) -> str:
    """Return the text of what a caller gives as a system: what pyproj takes, but texts with files.

    Only what callers give may come here: texts of files are WKT or numbers (`check_system`).
    """
    if isinstance(crs, str) and (is_system(crs) or _OF_FILES.search(crs)):
        check_system(name, crs)
        return crs
    pyproj = load("pyproj", extra="terrain")
    try:
        text = text_of(pyproj.CRS.from_user_input(crs))
    except (pyproj.exceptions.CRSError, TypeError, ValueError, AttributeError) as error:
        unknown = "which is unknown: give WKT or EPSG:n, or what pyproj takes"
        raise refused(name, crs, unknown, mark=", ") from error
    check_system(name, text)
    return text


def given_text(crs: Any) -> Any:
    """Return the text of a system for a cloud; texts that are unknown stay, as in files."""
    if crs is None or (isinstance(crs, str) and is_system(crs)):
        return crs
    try:
        return as_system("crs", crs)
    except (InputError, MissingDependencyError):
        if isinstance(crs, str):
            return crs
        raise


def are_different(one: str | None, other: str | None) -> bool:
    """Whether two texts are known to mean different systems of the plane."""
    if one is None or other is None or urn_of(one) == urn_of(other):
        return False
    try:
        planes = _plane(one), _plane(other)
    except (MissingDependencyError, InputError):
        return is_number(one) and is_number(other)
    return not planes[0].equals(planes[1], ignore_axis_order=True)


def plane_of(crs: str | None) -> str | None:
    """Return the system of x and y alone: what has no height is in none of heights."""
    system = parse_crs(crs)
    if crs is None or system is None or system.units[2] is None:
        return crs
    return text_of(_plane(crs))


def _plane(crs: str) -> Any:
    """Return the system of x and y alone, of pyproj."""
    plane = look_up(crs).to_2d()
    return plane.sub_crs_list[0] if plane.is_compound else plane


def adds_heights(one: str | None, other: str) -> bool:
    """Whether a system is another one of the plane, which says nothing of heights, with heights."""
    if one is None:
        return True
    before, after = parse_crs(one), parse_crs(other)
    if before is None or after is None or are_different(one, other):
        return False
    return before.units[2] is None and after.units[2] is not None


def is_same(one: str | None, other: str | None) -> bool:
    """Whether two texts are of one coordinate system, as pyproj judges it if it is installed."""
    if one == other:
        return True
    if one is None or other is None:
        return False
    try:
        first, second = (look_up(each) for each in (one, other))
    except (MissingDependencyError, InputError):
        return False
    return bool(first.equals(second, ignore_axis_order=True))


def common_system(
    one: str | None, other: str | None, names: tuple[str, str] = ("the points", "the domain")
) -> str | None:
    """Return the coordinate system of two things that are used together."""
    if not are_different(one, other):
        return other if one is None else one
    raise InputError(
        f"{names[0]} are in {_name(one)}, and {names[1]} in {_name(other)}: transform one of them "
        "to the system of the other"
    )


def _name(crs: str | None) -> str:
    system = parse_crs(crs)
    return shown(crs if system is None else system.name)
