"""The coordinate system that a LAS file states: WKT, or the GeoKeys of GeoTIFF.

The header says which of the two counts; the other one is taken where there is none.

Source: ASPRS, LAS Specification 1.4-R15, section 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from liftmesh.base.cloud import is_crs
from liftmesh.crs.geokeys import has_parameters, system_of, wkt_of

if TYPE_CHECKING:
    from liftmesh.io.formats.las.header import Record

PROJECTION, LIBLAS = b"LASF_Projection", b"liblas"
WKT, _KEYS = 2112, 34735
_OF_KEYS = (_KEYS, 34736, 34737)


def crs_of(records: Iterable[Record], *, is_wkt: bool) -> str | None:
    """Return the coordinate system as `Cloud.crs` holds it; None if there is none."""
    found = _first(records)
    wkt = _text(found.get((PROJECTION, WKT)))
    if is_wkt and wkt:
        return wkt
    keys, _ = system_of(found.get((PROJECTION, _KEYS)))
    text = keys or wkt or (None if is_wkt else _text(found.get((LIBLAS, WKT))))
    return text or _made_up(found, is_wkt=is_wkt)[0]


def refused(records: Iterable[Record], *, is_wkt: bool) -> tuple[str, ...]:
    """Name GeoKeys that contradict themselves or are not understood, unless they do not count."""
    records = [*records]
    found = _first(records)
    _, cause = system_of(found.get((PROJECTION, _KEYS)))
    if not cause and crs_of(records, is_wkt=is_wkt) is None:
        cause = _made_up(found, is_wkt=is_wkt)[1]
    return (cause,) if cause and not is_wkt else ()


def _made_up(found: Mapping[tuple[bytes, int], bytes], *, is_wkt: bool) -> tuple[str | None, str]:
    """Return the system that GeoKeys make up of parameters, or why there is none."""
    records = {key: found[PROJECTION, key] for key in _OF_KEYS if (PROJECTION, key) in found}
    return wkt_of(records) if not is_wkt and has_parameters(records.get(_KEYS)) else (None, "")


def _first(records: Iterable[Record]) -> dict[tuple[bytes, int], bytes]:
    found: dict[tuple[bytes, int], bytes] = {}
    for each in records:
        found.setdefault((each.user, each.number), each.data)
    return found


def _text(data: bytes | None) -> str | None:
    text = (data or b"").decode("utf-8", "replace").strip("\0 \r\n\t").partition("\0")[0]
    return text if is_crs(text) else None
