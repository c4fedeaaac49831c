"""GeoKeys: the coordinate system as numbers of EPSG and units, as LAS has it from GeoTIFF.

The key of the model says which of the others count: the geographic system that a projected one is
made of is not the system of the coordinates. Systems that are made up of parameters have no number;
the WKT that other programs write besides counts, or GDAL reads them (`io.las.parameters`). Heights
have a number or a unit of their own, which may be another than that of the plane.

Source: OGC 19-008r4, GeoTIFF; GeoTIFF 1.0, section 6.3.4, for the old numbers of heights.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

from liftmesh.crs import FOOT, METRE, SURVEY_FOOT, as_wkt, described

_ENTRY = struct.Struct("<4H")
_MODEL, _GEOGRAPHIC, _PROJECTED, _LENGTH = 1024, 2048, 3072, 3076
_VERTICAL, _HEIGHT = 4096, 4099  # the system of heights, and their unit
_OF_PROJECTED = range(3072, 3097)
_METHODS = (3074, 3075)  # of projection, by a number of EPSG or of GeoTIFF
_IS_PROJECTED, _IS_GEOCENTRIC = 1, 3
_NUMBERS = range(1024, 32767)  # of EPSG; 32767 is user-defined
_OLD = range(5001, 5107)  # of GeoTIFF 1.0, which EPSG does not know
_UNITS = {9001: METRE, 9002: FOOT, 9003: SURVEY_FOOT}
_HEIGHTS = {  # systems of heights by an old number, or that of metres, and the unit
    (5101, 0): 5701, (5101, 9001): 5701, (5102, 9001): 7968, (5102, 9003): 5702,
    (5103, 0): 5703, (5103, 9001): 5703, (5103, 9002): 8228, (5103, 9003): 6360,
    (5703, 9002): 8228, (5703, 9003): 6360, (5104, 0): 5736, (5104, 9001): 5736,
    (5105, 0): 5705, (5105, 9001): 5705,
}  # fmt: skip
_GEOCENTRIC_OF = {4326: 4978, 4978: 4978, 4979: 4978, 4258: 4936, 4936: 4936, 4937: 4936}


def system_of(data: bytes | None) -> tuple[str | None, str]:
    """Return the coordinate system that GeoKeys state."""
    keys = _entries(data or b"")
    if keys.get(_MODEL) == _IS_GEOCENTRIC:
        return _geocentric(keys.get(_GEOGRAPHIC, 0)), ""
    is_projected = keys.get(_MODEL, 0) == _IS_PROJECTED or (
        _MODEL not in keys and any(each in keys for each in _OF_PROJECTED)
    )
    number = keys.get(_PROJECTED if is_projected else _GEOGRAPHIC, 0)
    if number not in _NUMBERS:
        return None, ""
    base, unit = f"EPSG:{number}", _UNITS.get(keys.get(_LENGTH, 0))
    known = described(base)
    plane = known.units[0] if known else None
    if is_projected and unit and plane and plane.metres != unit.metres:
        return None, f"GeoKeys ({base} has the unit {plane.name}, but they state {unit.name})"
    return _with_heights(base, keys), ""


def has_parameters(data: bytes | None) -> bool:
    """Whether GeoKeys make up a projected system of parameters, rather than name one."""
    keys = _entries(data or b"")
    is_named = keys.get(_PROJECTED, 0) in _NUMBERS
    is_projected = keys.get(_MODEL, _IS_PROJECTED) == _IS_PROJECTED
    return is_projected and not is_named and any(each in keys for each in _METHODS)


def _geocentric(number: int) -> str:
    """Name a geocentric system, by which programs refuse it, if by nothing else."""
    known = _GEOCENTRIC_OF.get(number)
    return f"EPSG:{known}" if known else f'GEOCCS["geocentric, {number}",UNIT["metre",1]]'


def _with_heights(base: str, keys: Mapping[int, int]) -> str:
    """Add the system of heights, or a unit where there is no such, or it has another."""
    code = keys.get(_HEIGHT, 0)
    number, unit = keys.get(_VERTICAL, 0), _UNITS.get(code)
    number = _HEIGHTS.get((number, code), number)
    if number in _NUMBERS and number not in _OLD:
        both = f"{base}+{number}"
        if described(base) is None:
            return both
        known = described(both)
        if known and (unit is None or known.units[2] == unit):
            return both
    text = as_wkt(base) if unit and described(base) else None
    if unit is None or text is None or not text.startswith(("PROJCS", "GEOGCS")):
        return base
    return (
        f'COMPD_CS["{base} + heights in {unit.name}",{text},VERT_CS["unknown",'
        f'VERT_DATUM["unknown",2005],UNIT["{unit.name}",{unit.metres!r}],'
        'AXIS["Gravity-related height",UP]]]'
    )


def _entries(data: bytes) -> dict[int, int]:
    """Return the keys whose value stands in the directory itself, as all numbers of EPSG do."""
    if len(data) < _ENTRY.size:
        return {}
    count = min(_ENTRY.unpack_from(data)[3], len(data) // _ENTRY.size - 1)
    rows = (_ENTRY.unpack_from(data, _ENTRY.size * (k + 1)) for k in range(count))
    return {key: value for key, place, _, value in rows if place == 0}
