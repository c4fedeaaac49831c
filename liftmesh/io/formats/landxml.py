"""LandXML 1.2, the surfaces of civil engineering, the writer.

Points are northing, easting and height, in this order, with digits that round-trip; a face lists
its points counter-clockwise seen from above. Edges are breaklines of two points, which hold their
coordinates. A file has one unit of length for all three, which is
that of the coordinate system, and metres where there is none. The format demands a date: it is that
of no day, since bytes are a function of the mesh.

Source: LandXML-1.2 schema, landxml.org, 2008.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh.crs.description import is_number, urn_of
from liftmesh.crs.units import band_unit, length_unit
from liftmesh.errors import FormatError
from liftmesh.io.columns import edges_of, faces_of
from liftmesh.io.formats.landxml_reader import LANDXML
from liftmesh.io.markup import attribute, is_possible
from liftmesh.io.text_tables import write_rows

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_SPACE = "http://www.landxml.org/schema/LandXML-1.2"
_EPSG = re.compile(r"^urn:ogc:def:crs:EPSG::([0-9]{1,9})$")
_METRIC = (
    '<Metric areaUnit="squareMeter" linearUnit="meter" volumeUnit="cubicMeter" '
    'temperatureUnit="celsius" pressureUnit="milliBars"/>'
)
_IMPERIAL = (
    '<Imperial areaUnit="squareFoot" linearUnit="{}" volumeUnit="cubicFeet" '
    'temperatureUnit="fahrenheit" pressureUnit="inHG"/>'
)
_UNITS = {
    "metre": _METRIC,
    "foot": _IMPERIAL.format("foot"),
    "US survey foot": _IMPERIAL.format("USSurveyFoot"),
}


def write_landxml(stream: BinaryIO, cloud: Cloud, *, name: str | None = None) -> None:
    """Write a mesh as a LandXML surface."""
    name = _stated_name(cloud) if name is None else name
    if not isinstance(name, str) or not is_possible(name):
        raise FormatError(f"name is {name!r}: give a text that XML can hold")
    units = _units(cloud)
    heights = cloud.points[:, 2]
    low, high = float(heights.min()), float(heights.max())
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<LandXML xmlns="{_SPACE}" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
        f'xsi:schemaLocation="{_SPACE} {_SPACE}/LandXML-1.2.xsd" version="1.2" '
        'date="1970-01-01" time="00:00:00">\n'
        f"<Units>{units}</Units>\n{_system(cloud.crs)}"
        '<Application name="liftmesh"/>\n'
        f"<Surfaces>\n<Surface name={attribute(name)}>\n"
    )
    stream.write(head.encode())
    _write_breaklines(stream, cloud)
    definition = f'<Definition surfType="TIN" elevMin="{low!r}" elevMax="{high!r}">\n<Pnts>\n'
    stream.write(definition.encode())
    numbers = np.arange(1, len(cloud) + 1)
    columns = [numbers, cloud.points[:, 1], cloud.points[:, 0], heights]
    write_rows(stream, columns, prefix='<P id="', between=('">', " ", " "), end="</P>\n")
    stream.write(b"</Pnts>\n<Faces>\n")
    write_rows(stream, [faces_of(cloud)], prefix="<F>", plus=1, end="</F>\n")
    stream.write(b"</Faces>\n</Definition>\n</Surface>\n</Surfaces>\n</LandXML>\n")


def _write_breaklines(stream: BinaryIO, cloud: Cloud) -> None:
    if not len(edges := edges_of(cloud)):
        return
    stream.write(b"<SourceData>\n<Breaklines>\n")
    ends = np.hstack([cloud.points[end][:, [1, 0, 2]] for end in edges.T])
    begin, end = '<Breakline brkType="standard"><PntList3D>', "</PntList3D></Breakline>\n"
    write_rows(stream, [ends], prefix=begin, end=end)
    stream.write(b"</Breaklines>\n</SourceData>\n")


def _stated_name(cloud: Cloud) -> str:
    """Return the name that a surface had in its file."""
    entry = cloud.metadata.get(LANDXML)
    name = entry.get("surface") if isinstance(entry, Mapping) else None
    return name if isinstance(name, str) and is_possible(name) else "surface"


def dropped_parts(cloud: Cloud, _: Mapping[str, Any]) -> Collection[str]:
    """Return what is lost of this cloud: a coordinate system that XML cannot hold."""
    return ("crs",) if cloud.crs is not None and not is_possible(cloud.crs) else ()


def check(cloud: Cloud) -> None:
    """Raise if coordinates have no unit of LandXML."""
    _units(cloud)


def _units(cloud: Cloud) -> str:
    name = length_unit(cloud.crs, "LandXML", band_unit(cloud)) or "metre"
    if name not in _UNITS:
        raise FormatError(f"the unit is {name}, but LandXML has {', '.join(_UNITS)}")
    return _UNITS[name]


def _system(crs: str | None) -> str:
    if crs is None or not is_possible(crs):
        return ""
    number = _EPSG.search(urn_of(crs))
    code = "" if number is None else f' epsgCode="{number[1]}"'
    kind = "desc" if is_number(crs) else "ogcWktCode"
    return f"<CoordinateSystem {kind}={attribute(crs)}{code}/>\n"
