"""Well-known text: keywords with brackets, which hold names, numbers and further keywords.

Only the brackets are read here, those of both versions; `crs` knows what the keywords mean. pyproj
would read them as well, but units are to be known where it is not installed. Texts come from files,
so they are read without recursion, and very long ones not at all.

PROJ and GDAL find more in a text than its definition: strings of PROJ, in extensions, remarks and
names of methods and geoid models, and names of files. They are given `plain`, which is written
from what was read here, and has keywords of definitions alone. Its first one is that of a system:
what begins with a keyword that PROJ does not take for WKT is searched for "+init=" as a whole.

Source: OGC 01-009 (WKT 1), OGC 18-010r7 (WKT 2).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

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


def tree(text: str) -> Node | None:
    """Read a text; None if its brackets do not match, or it is too long."""
    top = _read(text)
    if top is None:
        return None
    if len(top.parts) == 1:
        return top.parts[0]
    return Node("COMPOUNDCRS", top.parts[0].values, top.parts)


def plain(text: str) -> str | None:
    """Return a text of the same definition that names no files, for PROJ and GDAL."""
    top = _read(text)
    if top is None or not all(each.keyword in _SYSTEMS for each in top.parts):
        return None
    return _written(top) if all(map(_is_plain, _all(top))) else None


def has_grids(text: str) -> bool:
    """Whether a text names files of grids for its heights, which `plain` leaves out."""
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
    found: list[str] = []
    left: list[Node | str] = [*reversed(_between(top))]
    while left:
        each = left.pop()
        if isinstance(each, str):
            found.append(each)
        else:
            left += ["]", *reversed(_between(each)), f"{each.keyword}["]
    return "".join(found)


def _between(node: Node) -> list[Node | str]:
    """Return values and parts with commas between."""
    kept: list[Node | str] = [
        *node.values,
        *(each for each in node.parts if not _is_left_out(each)),
    ]
    return [word for each in kept for word in (",", each)][1:]


def _read(text: str) -> Node | None:
    """Read a text; None if it is no text of nodes alone, or too long."""
    top = Node("")
    is_read = len(text) <= _LONGEST and _fill(top, text)
    return top if is_read and top.parts and not top.values else None


def _fill(top: Node, text: str) -> bool:
    """Add what a text holds to a node; False if it is anything but nodes, values and commas."""
    open_nodes, is_due, place = (
        [top],
        True,
        0,
    )  # whether a value or node is due, rather than a comma
    while (found := _WORD.match(text, place)) and open_nodes:
        node, kind, place = open_nodes[-1], found.lastgroup, found.end()
        if kind in {"begin", "value"} and not is_due:
            return False
        if kind == "begin":
            node.parts.append(Node(found["begin"].upper()))
            open_nodes.append(node.parts[-1])
        elif kind == "end":
            open_nodes.pop()
        elif kind == "value" and node.parts:
            return False
        elif kind == "value":
            node.values.append(found["value"])
        is_due = kind in {"begin", "comma"}
    return len(open_nodes) == 1 and place == len(text)
