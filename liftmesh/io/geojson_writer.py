"""GeoJSON of lines, which are written one by one.

GeoJSON by itself is in degrees (RFC 7946). Coordinates of another system have its name in the
member ``crs``, as GeoJSON had it before, and as GDAL writes and reads it: the number of the system
if it has one, or else its whole text.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, BinaryIO

from liftmesh._typing import Floats
from liftmesh.crs import urn_of


def write(
    stream: BinaryIO, lines: Iterable[tuple[Mapping[str, Any], Floats]], crs: str | None
) -> None:
    """Write a collection of features."""
    stream.writelines(each.encode() for each in _texts(lines, crs))


def crs_member(crs: str | None) -> str:
    """Return the member that names a coordinate system, with the comma and line end after it."""
    if crs is None:
        return ""
    system = {"type": "name", "properties": {"name": urn_of(crs)}}
    return f'"crs": {json.dumps(system)},\n'


def _texts(lines: Iterable[tuple[Mapping[str, Any], Floats]], crs: str | None) -> Iterator[str]:
    yield f'{{"type": "FeatureCollection",\n{crs_member(crs)}"features": ['
    for number, (properties, points) in enumerate(lines):
        geometry = {"type": "LineString", "coordinates": points.tolist()}
        feature = {"type": "Feature", "properties": properties, "geometry": geometry}
        yield ("," if number else "") + "\n" + json.dumps(feature)
    yield "\n]}\n"
