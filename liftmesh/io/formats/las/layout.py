"""The layout in which a cloud is written as LAS: version, point format, scales, fields, records.

A cloud that was read from LAS brings its header and records along (`io.formats.las.vlrs`), and
becomes such a file again: only what the points themselves decide is set anew. Others become LAS
1.4.

A file of LAS holds a coordinate as ``number * scale + offset`` with a number of 32 bits. Scales and
offsets of the file that was read come first: they give its numbers back. Else the scale is the
coarsest power of ten that loses no decimal of any coordinate, or, if none does, the finest that 32
bits allow.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.options import as_positive, refused
from liftmesh.crs.description import as_wkt
from liftmesh.errors import FormatError, Option
from liftmesh.io.formats.las.fields import (
    Extra,
    Fields,
    depth_to_state,
    described_extras,
    fields_of,
    with_colors,
)
from liftmesh.io.formats.las.header import (
    EXTRA_BYTES,
    LAYOUT,
    LIBLAS,
    LIFTMESH_VLR,
    POINT_SIZES,
    PROJECTION,
    SIZES,
    WKT,
    LiftmeshVlr,
    Record,
    Vlrs,
    crs_of,
    is_layout,
    kept_vlrs,
    liftmesh_record,
    make_record,
    replace_records,
)
from liftmesh.io.metadata import Provenance

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
    entry = Provenance(cloud.metadata).las
    said = entry if is_layout(LAYOUT, entry) else {}
    kept = kept_vlrs(cloud.metadata)
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
            raise refused("point_format", given, "give a whole number from 0 to 10")
        if with_colors(given, cloud) != given:
            reason = f"which has no colours: give {with_colors(given, cloud)}"
            raise refused("point_format", given, reason, mark=", ")
        return given
    stated = said.get("point_format")
    is_known = isinstance(stated, int) and 0 <= stated < len(POINT_SIZES)
    return with_colors(stated if is_known else _POINT_FORMAT, cloud)  # type: ignore[arg-type]


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
    step = as_positive("scale", scale, "a positive number, as 0.001")
    found = []
    for each, pair in zip(columns, pairs, strict=True):
        steps = steps_of(each, (step, pair[1] if pair else 0.0))
        if steps.scale != step:  # the coordinates are no decimals of that scale
            steps = _rounding(each, step)
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
    scales = said.get("scale")
    if not isinstance(scales, list) or len(scales) != 3 or "offset" in said:
        return [None] * 3
    return [each if isinstance(each, float) and 0 < each < math.inf else None for each in scales]


def _rounding(values: Any, scale: float) -> ScaleOffset:
    low, high = float(values.min()), float(values.max())
    near = max(-low, high) <= scale * _MOST
    steps = ScaleOffset(
        scale, 0.0 if near else float(round(low / 2 + high / 2)), exact=False, near=False
    )
    if not (abs(steps.numbers(values)) <= _MOST).all():
        raise FormatError(
            f"coordinates from {low:.10g} to {high:.10g} have more than 32 bits in steps of "
            f"{Option('scale', scale)}: give a larger one"
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
    described = kept.of(*EXTRA_BYTES)
    return described_extras(described[0].data if described else b"", rest) if rest > 0 else []


def _records(
    cloud: Cloud, kept: Vlrs, fields: Fields, point_format: int
) -> tuple[list[Record], bool]:
    """Return the records of the file: those that are kept, and those that are made anew."""
    records = [*kept.records]
    data = b"".join(each.described for each in fields.extras)
    before = kept.of(*EXTRA_BYTES)
    if data != (before[0].data if before else b""):
        new = make_record(*EXTRA_BYTES, data, b"extra bytes") if data else None
        records = replace_records(records, new, *before)
    needs = point_format >= _FIRST_OF_WKT
    is_new = needs and (not kept.header or kept.header[104] & 0x3F < _FIRST_OF_WKT)
    is_wkt, said = kept.is_wkt or is_new, crs_of(kept.records, is_wkt=kept.is_wkt)
    if (is_new and cloud.crs is not None) or LiftmeshVlr(records).crs(said) != cloud.crs:
        records, has_text = _with_crs(records, cloud.crs)
        is_wkt = has_text or needs
        said = crs_of(records, is_wkt=is_wkt)
    return replace_records(
        records, liftmesh_record(cloud, said, depth_to_state(cloud)), *kept.of(*LIFTMESH_VLR)
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
    new = None if data is None else make_record(PROJECTION, WKT, data, b"WKT")
    return replace_records(records, new, *old), new is not None


_MOST = 2**31 - 1
_ROWS = 1 << 18  # converted at a time
_SAMPLE = 512
_FINEST = -9  # decimals that are tried
_SMALLEST = 5e-324
_ULPS = 8  # by which a decimal and number * scale may differ


@dataclass(frozen=True, slots=True)
class ScaleOffset:
    """Scale and offset of a coordinate, and whether they give back every bit of it."""

    scale: float
    offset: float
    exact: bool = True  # whether they give back every bit
    near: bool = True  # if not, whether the decimals are the same

    def numbers(self, values: Floats) -> Array:
        """Convert coordinates to whole numbers."""
        with np.errstate(over="ignore", invalid="ignore", under="ignore", divide="ignore"):
            return np.rint((values - self.offset) / self.scale)

    def coordinates(self, numbers: Array) -> Floats:
        """Convert whole numbers to coordinates, as readers do."""
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            values: Floats = numbers * self.scale + self.offset
            return values


def steps_of(values: Floats, known: tuple[float, float] | None) -> ScaleOffset:
    """Choose scale and offset of a coordinate."""
    if known is not None and (found := _tried(values, ScaleOffset(*known))):
        return found
    if not len(values):
        return ScaleOffset(0.01, 0.0)
    low, high = float(values.min()), float(values.max())
    middle = low if low == high else low / 2 + high / 2
    for decimals in range(0, _FINEST - 1, -1):
        scale = float(f"1e{decimals}")
        offset = 0.0 if max(-low, high) <= scale * _MOST else float(np.rint(middle))
        if found := _tried(values, ScaleOffset(scale, offset)):
            return found
    half = 0.0 if low == high else max(high / 2 - low / 2, _SMALLEST)
    return _finest(values, middle, half)


def _tried(values: Floats, steps: ScaleOffset) -> ScaleOffset | None:
    """Return the steps if they lose no decimal, or nothing."""
    exact = True
    size = float(values.max() / 2 - values.min() / 2) if len(values) else 0.0
    for part in _parts(values):
        numbers = steps.numbers(part)
        if not (np.abs(numbers) <= _MOST).all():
            return None
        again = steps.coordinates(numbers)
        if (again.view(np.int64) == part.view(np.int64)).all():
            continue
        exact = False
        if not _near(again, part, steps, size):
            return None
    return ScaleOffset(steps.scale, steps.offset, exact)


def _near(again: Floats, values: Floats, steps: ScaleOffset, size: float) -> bool:
    """Whether two decimals are the same but for the rounding of binary numbers."""
    with np.errstate(over="ignore", invalid="ignore"):
        ulps = _ULPS * np.spacing(np.abs(values) + abs(steps.offset))
        allowed = np.minimum(ulps, min(abs(steps.scale) / 1000, size / 1e7))
        return bool((np.abs(again - values) <= allowed).all())


def _parts(values: Floats) -> Iterator[Floats]:
    """Yield a few values first, by which most scales are refused, then all in blocks."""
    yield np.ascontiguousarray(values[:: max(len(values) // _SAMPLE, 1)])
    for start in range(0, len(values), _ROWS):
        yield np.ascontiguousarray(values[start : start + _ROWS])


def _finest(values: Floats, middle: float, half: float) -> ScaleOffset:
    """Return the finest power of ten that reaches from the middle to both ends."""
    if half == 0.0:
        is_exact = _is_exact(values, ScaleOffset(0.01, middle))
        return ScaleOffset(0.01, middle, is_exact, is_exact)
    exponent = math.ceil(math.log10(half) - math.log10(_MOST))
    for power in (exponent, exponent + 1):  # the offset is rounded
        steps = ScaleOffset(max(float(f"1e{power}"), _SMALLEST), middle)
        if all((np.abs(steps.numbers(part)) <= _MOST).all() for part in _parts(values)):
            break
    exact = _is_exact(values, steps)
    return ScaleOffset(steps.scale, steps.offset, exact, exact)


def _is_exact(values: Floats, steps: ScaleOffset) -> bool:
    return all(
        (steps.coordinates(steps.numbers(part)).view(np.int64) == part.view(np.int64)).all()
        for part in _parts(values)
    )
