"""Coordinate reference systems: what kind of coordinates, and which unit each axis has.

`Cloud.crs` is a text that is passed on. This module reads as much of it as matters to a surface:
whether the coordinates are projected, degrees or geocentric, and the units of x, y and z, which may
all differ: files with metres in the plane and US survey feet in height exist, and the two kinds of
feet differ by 2 parts per million. Numbers of EPSG say it in a database, for which pyproj is asked
if it is installed.

Well-known text (WKT) of both versions says it in keywords with brackets, which hold names, numbers
and further keywords. pyproj would read them as well, but units are to be known where it is not
installed. Texts come from files, so they are read without recursion, and very long ones not at all.

PROJ and GDAL find more in a text than its definition: strings of PROJ, in extensions, remarks and
names of methods and geoid models, and names of files. They are given `plain_wkt`, which is written
from what was read here, and has keywords of definitions alone. Its first one is that of a system:
what begins with a keyword that PROJ does not take for WKT is searched for "+init=" as a whole.

Source: OGC 01-009 (WKT 1), OGC 18-010r7 (WKT 2).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Literal, TypeAlias

from liftmesh.base.options import refused, shown
from liftmesh.errors import InputError, MissingDependencyError
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
def parse_crs(crs: str | None) -> System | None:
    """Read what a coordinate system says of its coordinates."""
    if crs is None:
        return None
    if is_number(crs):
        crs = _wkt_of(crs)
    root = None if crs is None else parse_wkt(crs)
    return None if root is None else _system(root)


def is_system(crs: object) -> bool:
    """Whether a value is a number, or WKT that defines a system and names no files."""
    return isinstance(crs, str) and without_files(crs) is not None


def without_files(crs: str) -> str | None:
    """Return a text as PROJ and GDAL may see it, which open no files for it; None if it is none."""
    return crs if is_number(crs) else plain_wkt(crs)


def is_number(crs: str) -> bool:
    """Whether a text is the number of a system, as EPSG:n, ESRI:n, IAU_2015:n, or its URN."""
    return bool(_NUMBER.fullmatch(crs))


def urn_of(crs: str) -> str:
    """Name a system by a URN, if the text is a number or names its own; else by the text."""
    if number := _NUMBER.fullmatch(crs.strip()):
        authority, code = number["authority"].upper(), number["code"]
        return f"{authority}:{code}" if "+" in code else f"urn:ogc:def:crs:{authority}::{code}"
    root = parse_wkt(crs)
    stated = next(root.of({"AUTHORITY", "ID"}), None) if root is not None else None
    if stated is None or len(stated.values) < 2:
        return crs
    authority, code = (each.strip('"') for each in stated.values[:2])
    return f"urn:ogc:def:crs:{authority}::{code}"


def crs_name(crs: str | None) -> str:
    """Name a system for a message."""
    system = parse_crs(crs)
    return shown(crs) if system is None else system.name


def look_up(crs: str, *, extra: str = "terrain") -> Any:
    """Look a system up by pyproj; PROJ's own strings, which can name files, are none."""
    pyproj = load("pyproj", extra=extra)
    unknown = InputError(f"the coordinate system {shown(crs)} is unknown: give WKT or EPSG:n")
    text = without_files(crs) if isinstance(crs, str) else None
    if text is None:
        raise unknown
    try:
        return pyproj.CRS.from_user_input(text)
    except (pyproj.exceptions.CRSError, UnicodeError) as error:
        raise unknown from error


def check_system(name: str, crs: object) -> None:
    """Raise for what an option gives as a coordinate system, and is none."""
    unknown = refused(name, crs, "which is unknown: give WKT or EPSG:n", mark=", ")
    if not isinstance(crs, str) or not is_system(crs):
        raise unknown
    if parse_crs(crs) is None:
        try:
            look_up(crs)
        except InputError as error:
            raise unknown from error
        except MissingDependencyError:
            pass


def as_wkt(crs: str) -> str | None:
    """Write a number of EPSG as WKT, of version 1 if that can hold it; None if it is unknown."""
    if not is_number(crs):
        return crs
    try:
        return oldest_wkt(look_up(crs))
    except InputError:
        return None


def oldest_wkt(system: Any) -> str:
    """Write a system of pyproj as WKT, of version 1 if that can hold it."""
    try:
        return str(system.to_wkt("WKT1_GDAL"))
    except load("pyproj", extra="terrain").exceptions.CRSError:
        return str(system.to_wkt("WKT2_2019"))


def _wkt_of(crs: str) -> str | None:
    """Ask pyproj for the text of a number; None if it is missing, or does not know it."""
    try:
        return str(look_up(crs).to_wkt("WKT2_2019"))
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


_LONGEST = 1 << 16  # characters
_WORD = re.compile(
    r"""
    \s*(?:
    (?P<begin>[A-Za-z_][A-Za-z0-9_]*)\s*[\[(]
    | (?P<value>"(?:[^"]|"")*" | [A-Za-z_][A-Za-z0-9_]* | [-+]?[0-9.][0-9.eE+-]*)
    | (?P<end>[\])])
    | (?P<comma>,)
    )\s*
    """,
    re.ASCII | re.VERBOSE,
)
_DEFINING = frozenset(
    re.findall(
        r"\w+",
        """
    ABRIDGEDTRANSFORMATION ANCHOR ANCHOREPOCH ANGLEUNIT AREA AUTHORITY AXIS AXISMAXVALUE
    AXISMINVALUE BASEENGCRS BASEGEODCRS BASEGEOGCRS BASEPROJCRS BASEVERTCRS BBOX BEARING BOUNDCRS
    CITATION COMPD_CS COMPOUNDCRS CONVERSION CS DATUM DERIVEDPROJCRS DERIVINGCONVERSION DYNAMIC
    EDATUM ELLIPSOID ENGCRS ENGINEERINGCRS ENGINEERINGDATUM ENSEMBLE ENSEMBLEACCURACY EPOCH
    EXTENSION FRAMEEPOCH GEOCCS GEODCRS GEODETICCRS GEODETICDATUM GEOGCRS GEOGCS GEOGRAPHICCRS
    GEOIDMODEL ID LENGTHUNIT LINUNIT LOCAL_CS LOCAL_DATUM MEMBER MERIDIAN METADATA METHOD MODEL
    OPERATIONACCURACY ORDER PARAMETER PRIMEM PRIMEMERIDIAN PROJCRS PROJCS PROJECTEDCRS PROJECTION
    RANGEMEANING REMARK SCALEUNIT SCOPE SOURCECRS SPHEROID TARGETCRS TIMEEXTENT TIMEUNIT TOWGS84
    TRF UNIT URI USAGE VDATUM VERSION VERTCRS VERTCS VERTICALCRS VERTICALDATUM VERTICALEXTENT
    VERT_CS VERT_DATUM VRF
    """,
    )
)
_SYSTEMS = frozenset(
    re.findall(
        r"\w+",
        """
    BOUNDCRS COMPD_CS COMPOUNDCRS DERIVEDPROJCRS ENGCRS ENGINEERINGCRS GEOCCS GEODCRS GEODETICCRS
    GEOGCRS GEOGCS GEOGRAPHICCRS LOCAL_CS PROJCRS PROJCS PROJECTEDCRS VERTCRS VERTCS VERTICALCRS
    VERT_CS
    """,
    )
)
_REMARK = "REMARK"
_SEARCHED = {"GEOIDMODEL", "METHOD", "MODEL", "PROJECTION", _REMARK}  # by PROJ for its own strings
_OWN = re.compile(r"PROJ\b|[+=]")
_GRIDS = '"PROJ4_GRIDS"'
_MERCATOR = (
    "+proj=merc +a=6378137 +b=6378137 +lat_ts=0 +lon_0=0 +x_0=0 +y_0=0 +k=1 +units=m "
    "+nadgrids=@null +wktext +no_defs"
)
_MILLER = "+proj=mill +datum=WGS84 +wktext +no_defs"
_KNOWN = (frozenset(_MERCATOR.split()), frozenset(_MILLER.split()))  # PROJ writes them itself


@dataclass(slots=True)
class Node:
    """A keyword, in upper case, with the names and numbers in its brackets, and the keywords."""

    keyword: str
    values: list[str] = field(default_factory=list)
    parts: list[Node] = field(default_factory=list)

    def of(self, keywords: Collection[str]) -> Iterator[Node]:
        """Find the parts of these keywords."""
        return (each for each in self.parts if each.keyword in keywords)

    @property
    def title(self) -> str:
        """The name that comes first, without its quotes."""
        return self.values[0].strip('"') if self.values else ""


def parse_wkt(text: str) -> Node | None:
    """Read a text; None if its brackets do not match, or it is too long."""
    top = _read(text)
    if top is None:
        return None
    if len(top.parts) == 1:
        return top.parts[0]
    return Node("COMPOUNDCRS", top.parts[0].values, top.parts)


def plain_wkt(text: str) -> str | None:
    """Return a text of the same definition that names no files, for PROJ and GDAL."""
    top = _read(text)
    if top is None or not all(each.keyword in _SYSTEMS for each in top.parts):
        return None
    return _written(top) if all(map(_is_plain, _all(top))) else None


def has_grids(text: str) -> bool:
    """Whether a text names files of grids for its heights, which `plain_wkt` leaves out."""
    top = _read(text)
    return top is not None and any(map(_is_grids, _all(top)))


def _all(top: Node) -> Iterator[Node]:
    """Find all nodes below one."""
    left = [*top.parts]
    while left:
        node = left.pop()
        yield node
        left += node.parts


def _is_plain(node: Node) -> bool:
    if _is_left_out(node):
        return True
    if node.keyword == "EXTENSION":
        is_proj = len(node.values) == 2 and node.values[0].upper() == '"PROJ4"'
        return is_proj and not node.parts and _numbered(node.values[1]) in _KNOWN
    return node.keyword in _DEFINING and not _is_of_proj(node)


def _is_left_out(node: Node) -> bool:
    return _is_grids(node) or (node.keyword == _REMARK and _is_of_proj(node))


def _is_of_proj(node: Node) -> bool:
    return node.keyword in _SEARCHED and any(map(_OWN.search, node.values))


def _is_grids(node: Node) -> bool:
    return node.keyword == "EXTENSION" and node.values[:1] == [_GRIDS]


def _numbered(text: str) -> frozenset[str]:
    """Return the words of a string of PROJ; 0.0 is 0."""
    return frozenset(re.sub(r"\.0+$", "", each) for each in text.strip('"').split())


def _written(top: Node) -> str:
    """Write what was read; the parts of a node come after its values."""
    words: list[str] = []
    left: list[Node | str] = [*reversed(_between(top))]
    while left:
        each = left.pop()
        if isinstance(each, str):
            words.append(each)
        else:
            left += ["]", *reversed(_between(each)), f"{each.keyword}["]
    return "".join(words)


def _between(node: Node) -> list[Node | str]:
    """Return values and parts with commas between."""
    kept: list[Node | str] = [*node.values]
    kept += [each for each in node.parts if not _is_left_out(each)]
    return [word for each in kept for word in (",", each)][1:]


def _read(text: str) -> Node | None:
    """Read a text; None if it is no text of nodes alone, or too long."""
    top = Node("")
    is_read = len(text) <= _LONGEST and _fill(top, text)
    return top if is_read and top.parts and not top.values else None


def _fill(top: Node, text: str) -> bool:
    """Add what a text holds to a node; False if it is anything but nodes, values and commas."""
    open_nodes, place = [top], 0
    is_due = True  # a value or node, rather than a comma
    while (word := _WORD.match(text, place)) and open_nodes:
        node, kind, place = open_nodes[-1], word.lastgroup, word.end()
        if kind in {"begin", "value"} and not is_due:
            return False
        if kind == "begin":
            node.parts.append(Node(word["begin"].upper()))
            open_nodes.append(node.parts[-1])
        elif kind == "end":
            open_nodes.pop()
        elif kind == "value" and node.parts:
            return False
        elif kind == "value":
            node.values.append(word["value"])
        is_due = kind in {"begin", "comma"}
    return len(open_nodes) == 1 and place == len(text)
