"""Coordinate reference systems: what kind of coordinates, and which unit each axis has.

`Cloud.crs` is a text that is passed on. This module reads as much of it as matters to a surface:
whether the coordinates are projected, degrees or geocentric, and the units of x, y and z, which may
all differ: files with metres in the plane and US survey feet in height exist, and the two kinds of
feet differ by 2 parts per million. WKT of both versions says it in brackets, which are read here;
numbers of EPSG say it in a database, for which pyproj is asked if it is installed.

Source: OGC 01-009 (WKT 1), OGC 18-010r7 (WKT 2).
"""

from __future__ import annotations

import importlib.util
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, TypeAlias

from liftmesh.base.options import shown
from liftmesh.crs.wkt import Node, plain, tree
from liftmesh.errors import FormatError, InputError, MissingDependencyError
from liftmesh.optional import load

Kind: TypeAlias = Literal["projected", "geographic", "geocentric", "local"]

_NUMBER = re.compile(
    r"(urn:ogc:def:crs:)?(?P<authority>EPSG|ESRI|IAU_2015)::?(?P<code>[0-9]{1,9}(\+[0-9]{1,9})?)",
    re.ASCII | re.IGNORECASE,
)
_KINDS: dict[str, Kind] = {
    "PROJCS": "projected", "PROJCRS": "projected", "PROJECTEDCRS": "projected",
    "GEOGCS": "geographic", "GEOGCRS": "geographic", "GEOGRAPHICCRS": "geographic",
    "GEODCRS": "geographic", "GEODETICCRS": "geographic", "GEOCCS": "geocentric",
    "LOCAL_CS": "local", "ENGCRS": "local", "ENGINEERINGCRS": "local",
}  # fmt: skip
_COMPOUND = {"COMPD_CS", "COMPOUNDCRS"}
_VERTICAL = {"VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"}
_BOUND, _SOURCE = "BOUNDCRS", "SOURCECRS"
_UNITS = {"UNIT", "LENGTHUNIT", "ANGLEUNIT"}
_DEGREE = 0.017453


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: its name, and how many metres it has; None for angles."""

    name: str
    metres: float | None


METRE, FOOT = Unit("metre", 1.0), Unit("foot", 0.3048)
SURVEY_FOOT = Unit("US survey foot", 1200 / 3937)
_NAMES = ((METRE, 1e-12), (FOOT, 1e-9), (SURVEY_FOOT, 1e-9))  # as exact as files state them


@dataclass(frozen=True, slots=True)
class System:
    """What a text says of coordinates: their kind, and the units of x, y and z, None if unsaid."""

    kind: Kind
    name: str
    units: tuple[Unit | None, Unit | None, Unit | None]

    @property
    def is_mixed(self) -> bool:
        """Whether heights are known to have another unit than lengths in the plane."""
        x, y, z = ((each and each.metres) for each in self.units)
        return x is not None and ((z is not None and z != x) or (y is not None and y != x))


@lru_cache(maxsize=64)
def described(crs: str | None) -> System | None:
    """Read what a coordinate system says of its coordinates."""
    if crs is None:
        return None
    if is_number(crs):
        crs = _wkt_of(crs)
    root = None if crs is None else tree(crs)
    return None if root is None else _system(root)


def is_system(crs: object) -> bool:
    """Whether a value is a number, or WKT that defines a system and names no files."""
    return isinstance(crs, str) and without_files(crs) is not None


def without_files(crs: str) -> str | None:
    """Return a text as PROJ and GDAL may see it, which open no files for it; None if it is none."""
    return crs if is_number(crs) else plain(crs)


def is_number(crs: str) -> bool:
    """Whether a text is the number of a system."""
    return bool(_NUMBER.fullmatch(crs))


def urn_of(crs: str) -> str:
    """Name a system as other programs know it."""
    if found := _NUMBER.fullmatch(crs.strip()):
        authority, code = found["authority"].upper(), found["code"]
        return f"{authority}:{code}" if "+" in code else f"urn:ogc:def:crs:{authority}::{code}"
    root = tree(crs)
    named = next(root.of({"AUTHORITY", "ID"}), None) if root is not None else None
    if named is None or len(named.values) < 2:
        return crs
    authority, code = (each.strip('"') for each in named.values[:2])
    return f"urn:ogc:def:crs:{authority}::{code}"


def named(crs: str | None) -> str:
    """Name a system for a message."""
    system = described(crs)
    return shown(crs) if system is None else system.name


def warnings_of(system: System | None) -> tuple[str, ...]:
    """Say what most users do not want of coordinates."""
    if system is None:
        return ()
    if system.kind == "geographic":
        what = f"x and y are degrees ({system.name}), which are no lengths"
        return (f"{what}: transform them with to_crs=",)
    if system.kind == "geocentric":
        return (f"the coordinates are geocentric ({system.name}): transform them with to_crs=",)
    if system.is_mixed:
        x, y, z = (each.name if each else "?" for each in system.units)
        return (f"the units differ: x is in {x}, y in {y}, z in {z}",)
    return ()


def length_unit(crs: str | None, what: str, heights: Unit | None = None) -> str | None:
    """Return the unit that all coordinates have, for a format that has one for all."""
    system = described(crs)
    if crs is None and heights is not None and heights != METRE:
        raise FormatError(
            f"z is in {heights.name}, and the unit of x and y is not known, but {what} has one for "
            "all: state their system with crs="
        )
    if crs is None:
        return None
    if system is None or system.units[0] is None:
        is_lookup = is_number(crs) and importlib.util.find_spec("pyproj") is None
        remedy = "install liftmesh[terrain], or " if is_lookup else ""
        raise FormatError(
            f"the unit of {shown(crs)} is not known, but {what} states one: {remedy}state another "
            "system with crs="
        )
    if system.kind in {"geographic", "geocentric"}:
        raise FormatError(
            f"the coordinates are {system.kind} ({system.name}), but {what} holds lengths: "
            "transform them with to_crs="
        )
    units = (*system.units, heights)
    found = dict.fromkeys(each.name for each in units if each is not None)
    if len(found) > 1:
        raise FormatError(
            f"the units of x, y and z are {' and '.join(found)}, but {what} has one for all: "
            "transform them with to_crs="
        )
    return next(iter(found), None)


def looked_up(pyproj: Any, crs: str) -> Any:
    """Look a system up; PROJ's own strings, which can name files, are none."""
    unknown = InputError(f"the coordinate system {shown(crs)} is unknown: give WKT or EPSG:n")
    text = without_files(crs) if isinstance(crs, str) else None
    if text is None:
        raise unknown
    try:
        return pyproj.CRS.from_user_input(text)
    except (pyproj.exceptions.CRSError, UnicodeError) as error:
        raise unknown from error


def check_system(crs: object) -> None:
    """Raise for what is given as a coordinate system, and is none."""
    if not isinstance(crs, str) or not is_system(crs):
        raise InputError(f"the coordinate system {shown(crs)} is unknown: give WKT or EPSG:n")
    if described(crs) is not None:
        return
    try:
        pyproj = load("pyproj", extra="terrain")
    except MissingDependencyError:
        return
    looked_up(pyproj, crs)


def as_wkt(crs: str) -> str | None:
    """Write a number of EPSG as WKT, of version 1 if that can hold it."""
    if not is_number(crs):
        return crs
    pyproj = load("pyproj", extra="terrain")
    try:
        system = looked_up(pyproj, crs)
    except InputError:
        return None
    try:
        return str(system.to_wkt("WKT1_GDAL"))
    except pyproj.exceptions.CRSError:
        return str(system.to_wkt("WKT2_2019"))


def _wkt_of(crs: str) -> str | None:
    """Ask pyproj for the text of a number; None if it is missing, or does not know it."""
    try:
        pyproj = load("pyproj", extra="terrain")
        return str(looked_up(pyproj, crs).to_wkt("WKT2_2019"))
    except (MissingDependencyError, InputError):
        return None


def _system(root: Node) -> System | None:
    """Find the parts of a system that say what its coordinates are."""
    whole = _unbound(root)
    is_compound = whole.keyword in _COMPOUND
    plane = _unbound(next(whole.of({*_KINDS, _BOUND}), whole)) if is_compound else whole
    if plane.keyword not in _KINDS:
        return None
    x, y, z = _axes(plane)
    vertical = next(whole.of(_VERTICAL), None) if is_compound else None
    kind = _KINDS[plane.keyword]
    if kind == "geographic" and _is_cartesian(plane):
        kind = "geocentric"
    if kind == "geocentric":
        z = x
    elif vertical is not None:
        z = _axes(vertical)[0]
    return System(kind, whole.title, (x, y, z))


def _unbound(node: Node) -> Node:
    """Return the system that a system with a transformation beside it is made of."""
    sources = node.of({_SOURCE}) if node.keyword == _BOUND else ()
    return next((each.parts[0] for each in sources if each.parts), node)


def _is_cartesian(node: Node) -> bool:
    return any(
        each.values[:1] and each.values[0].lower() == "cartesian" for each in node.of({"CS"})
    )


def _axes(node: Node) -> tuple[Unit | None, Unit | None, Unit | None]:
    """Return the units of the axes: their own, or that of the whole for the first two."""
    common = next((_unit(each) for each in node.of(_UNITS)), None)
    own = [next((_unit(each) for each in axis.of(_UNITS)), None) for axis in node.of({"AXIS"})]
    own += [None] * (3 - len(own))
    return own[0] or common, own[1] or common, own[2]


def _unit(node: Node) -> Unit | None:
    """Return a unit with the name of its length, whatever the file calls it."""
    try:
        name, factor = node.values[0].strip('"'), float(node.values[1])
    except (IndexError, ValueError):
        return None
    is_angle = node.keyword == "ANGLEUNIT" or "deg" in name.lower() or "grad" in name.lower()
    if is_angle or abs(factor - _DEGREE) < 1e-5:
        return Unit(name, None)
    known = (each for each, error in _NAMES if abs(factor - (each.metres or 0.0)) <= error)
    is_taken = any(name == each.name for each, _ in _NAMES)
    return next(known, Unit(f"{name} of {factor:.10g} m" if is_taken else name, factor))
