"""Which file of LAS a cloud becomes: version, point format, steps, fields and records.

A cloud that was read from LAS brings its header and records along (`io.las.carried`), and becomes
such a file again: only what the points themselves decide is set anew. Others become LAS 1.4.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from liftmesh.base.options import shown
from liftmesh.crs.description import as_wkt
from liftmesh.errors import FormatError, InputError
from liftmesh.io.formats.las.carried import EXTRA_BYTES, Vlrs, carried, made, replaced
from liftmesh.io.formats.las.crs import LIBLAS, PROJECTION, WKT, crs_of
from liftmesh.io.formats.las.extra_bytes import Extra, described
from liftmesh.io.formats.las.fields import Fields, depth_to_state, fields_of, with_colors
from liftmesh.io.formats.las.header import POINT_SIZES, SIZES, Record
from liftmesh.io.formats.las.own import LAYOUT, LIFTMESH_VLR, LiftmeshVlr, is_layout, record_of
from liftmesh.io.formats.las.steps import _MOST, ScaleOffset, steps_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_NEWEST = (1, 4)
_POINT_FORMAT = 6  # of clouds that come from elsewhere
_FIRST_OF_WKT = 6  # the first point format that has its coordinate system as WKT


@dataclass(frozen=True, slots=True)
class Layout:
    """A file to be written; ``is_wkt`` says that its coordinate system is WKT."""

    version: tuple[int, int]
    point_format: int
    steps: tuple[ScaleOffset, ...]
    fields: Fields
    header: bytes
    gap: bytes
    records: tuple[Record, ...]
    is_wkt: bool


def layout_of(cloud: Cloud, scale: float | None, point_format: int | None) -> Layout:
    """Choose a layout."""
    found = cloud.metadata.get(LAYOUT)
    said = found if isinstance(found, Mapping) and is_layout(LAYOUT, found) else {}
    kept = carried(cloud.metadata)
    number = _point_format(cloud, said, point_format)
    known = _known_extras(kept)
    fields = fields_of(cloud, number, known)
    records, is_wkt = _records(cloud, kept, fields, number)
    version = _version(said.get("version"), number)
    if any(each.extended for each in records) or (is_wkt and not kept.is_wkt):
        version = max(version, _NEWEST)
    return Layout(
        version=version,
        point_format=number,
        steps=_steps(cloud, said, scale),
        fields=fields,
        header=kept.header,
        gap=kept.gap,
        records=tuple(records),
        is_wkt=is_wkt,
    )


def _point_format(cloud: Cloud, said: Mapping[str, Any], given: int | None) -> int:
    if given is not None:
        if not isinstance(given, int) or not 0 <= given < len(POINT_SIZES):
            raise InputError(f"point_format is {shown(given)}: give a whole number from 0 to 10")
        if with_colors(given, cloud) != given:
            raise InputError(
                f"point_format is {given}, which has no colours: give {with_colors(given, cloud)}"
            )
        return given
    found = said.get("point_format")
    is_known = isinstance(found, int) and 0 <= found < len(POINT_SIZES)
    return with_colors(found if is_known else _POINT_FORMAT, cloud)  # type: ignore[arg-type]


def _version(said: object, point_format: int) -> tuple[int, int]:
    """Return the version that a file had, or a later one that has the point format."""
    least = 4 if point_format > 5 else 3 if point_format > 3 else 2
    minor = next((each for each in SIZES if said == f"1.{each}"), _NEWEST[1])
    if said in ("1.0", "1.1"):
        least = 0 if point_format < 2 else least
    return 1, max(minor, least)


def _steps(cloud: Cloud, said: Mapping[str, Any], scale: float | None) -> tuple[ScaleOffset, ...]:
    pairs = _known_steps(said)
    columns = cloud.points.astype("f8", copy=False).T
    if scale is None:
        coarsest = _coarsest(said)
        return tuple(map(_steps_at, columns, pairs, coarsest))
    if isinstance(scale, bool) or not isinstance(scale, float | int) or not 0 < scale < math.inf:
        raise InputError(f"scale is {shown(scale)}: give a positive number, as 0.001")
    found = []
    for each, pair in zip(columns, pairs, strict=True):
        steps = steps_of(each, (float(scale), pair[1] if pair else 0.0))
        if steps.scale != scale:  # the coordinates are no decimals of that scale
            steps = _rounding(each, float(scale))
        found.append(steps)
    return tuple(found)


def _steps_at(
    values: Any, known: tuple[float, float] | None, coarsest: float | None
) -> ScaleOffset:
    """Choose steps; coordinates that have other digits are rounded to the coarsest, if there is."""
    if coarsest is None:
        return steps_of(values, known)
    steps = steps_of(values, (coarsest, 0.0))
    try:
        return steps if steps.scale >= coarsest else _rounding(values, coarsest)
    except FormatError:  # of more than 32 bits
        return steps


def _coarsest(said: Mapping[str, Any]) -> list[float | None]:
    """Return the scales of coordinates that were transformed, which have no offset any longer."""
    found = said.get("scale")
    if not isinstance(found, list) or len(found) != 3 or "offset" in said:
        return [None] * 3
    return [each if isinstance(each, float) and 0 < each < math.inf else None for each in found]


def _rounding(values: Any, scale: float) -> ScaleOffset:
    low, high = float(values.min()), float(values.max())
    near = max(-low, high) <= scale * _MOST
    steps = ScaleOffset(
        scale, 0.0 if near else float(round(low / 2 + high / 2)), exact=False, near=False
    )
    if not (abs(steps.numbers(values)) <= _MOST).all():
        raise FormatError(
            f"coordinates from {low:.10g} to {high:.10g} have more than 32 bits in steps of "
            f"scale={scale:g}: give a larger one"
        )
    return steps


def _known_steps(said: Mapping[str, Any]) -> list[tuple[float, float] | None]:
    columns = [said.get("scale"), said.get("offset")]
    if not all(isinstance(each, list | tuple) and len(each) == 3 for each in columns):
        return [None] * 3
    pairs = [*zip(*columns, strict=True)]
    is_good = all(isinstance(x, float) and math.isfinite(x) for pair in pairs for x in pair)
    return pairs if is_good and all(scale for scale, _ in pairs) else [None] * 3


def _known_extras(kept: Vlrs) -> list[Extra]:
    if not kept.header:
        return []
    number, size = kept.header[104] & 0x3F, int.from_bytes(kept.header[105:107], "little")
    rest = size - POINT_SIZES[number] if number < len(POINT_SIZES) else 0
    found = kept.of(*EXTRA_BYTES)
    return described(found[0].data if found else b"", rest) if rest > 0 else []


def _records(
    cloud: Cloud, kept: Vlrs, fields: Fields, point_format: int
) -> tuple[list[Record], bool]:
    """Return the records of the file: those that are kept, and those that are made anew."""
    records = [*kept.records]
    data = b"".join(each.described for each in fields.extras)
    before = kept.of(*EXTRA_BYTES)
    if data != (before[0].data if before else b""):
        new = made(*EXTRA_BYTES, data, b"extra bytes") if data else None
        records = replaced(records, new, *before)
    needs = point_format >= _FIRST_OF_WKT
    is_new = needs and (not kept.header or kept.header[104] & 0x3F < _FIRST_OF_WKT)
    is_wkt, said = kept.is_wkt or is_new, crs_of(kept.records, is_wkt=kept.is_wkt)
    if (is_new and cloud.crs is not None) or LiftmeshVlr(records).crs(said) != cloud.crs:
        records, has_text = _with_crs(records, cloud.crs)
        is_wkt = has_text or needs
        said = crs_of(records, is_wkt=is_wkt)
    return replaced(
        records, record_of(cloud, said, depth_to_state(cloud)), *kept.of(*LIFTMESH_VLR)
    ), is_wkt


def _with_crs(records: list[Record], crs: str | None) -> tuple[list[Record], bool]:
    """Put the text of a coordinate system in the place of another."""
    old = [
        each
        for each in records
        if each.user == PROJECTION or (each.user, each.number) == (LIBLAS, WKT)
    ]
    text = None if crs is None else as_wkt(crs)
    try:
        data = None if text is None else text.encode() + b"\0"
    except UnicodeEncodeError:
        data = None
    new = None if data is None else made(PROJECTION, WKT, data, b"WKT")
    return replaced(records, new, *old), new is not None
