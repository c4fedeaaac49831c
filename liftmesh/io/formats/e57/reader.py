"""E57, files of terrestrial laser scanners (ASTM E2807): the points of all scans, one by one.

Coordinates are float64, whatever the file stores. Those given by range and angles are converted to
x, y and z, and each scan is moved by its pose into the coordinates that all share. Points whose
position is not valid are left out and counted. Red, green and blue become colours if they are whole
numbers; all other fields keep their names, and those that some scans do not have are named. The
attribute ``scan`` says which scan a point is of, if there are several.

Each scan states the depth of its colours: its limits are what its scanner can produce. Scans of 8
and 16 bits may stand in one file: the former are scaled. Where a scan states no limits, a type of 8
bits says it; else, and where a colour is beyond the limits, the values decide, of all such scans
together. Limits of other numbers of bits, such as 1023, are scaled as well; what is no such number
is taken for 8 or 16 bits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.errors import FormatError
from liftmesh.io.columns import COLOR, POSITION, CloudBuilder
from liftmesh.io.formats.e57.decoding import Decoder, Limits, Scan, decoded
from liftmesh.io.formats.e57.header import check_header
from liftmesh.io.metadata import noted
from liftmesh.io.options import check_columns, check_expanded, limit_of

_CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
_SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
_INVALID = ("cartesianInvalidState", "sphericalInvalidState")
_COLORS = dict(zip(("colorRed", "colorGreen", "colorBlue"), COLOR, strict=True))
_SCAN = "scan"
_DENSEST = 200  # bytes in memory that a byte of the file is allowed


def read_e57(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read the points of an E57 file."""
    size = check_header(stream, name)
    limit = limit_of(max_bytes, _DENSEST * size)
    with decoded(stream, name, Limits.of(size, limit)) as decoder:
        return _Reader(decoder, name).cloud(limit, max_bytes)


class _Reader:
    """What is read of a file."""

    def __init__(self, decoder: Decoder, name: str) -> None:
        self._decoder = decoder
        self._name = name
        self._scans = decoder.scans
        self._types, self._lost = _common(self._scans, name)
        self._invalid = 0
        self._notes = _other_intensities(self._scans) if "intensity" in self._types else []

    def cloud(self, limit: int, max_bytes: int | None) -> Cloud:
        """Read all scans."""
        rows = sum(each.rows for each in self._scans)
        width = sum(each.itemsize for each in self._types.values())
        check_columns(len(self._types), max_bytes, self._name, "its description")
        check_expanded(rows * width, limit, self._name, f"{rows:,} points")
        builder, filled = CloudBuilder(self._types, rows), 0
        counts = [0] * len(self._scans)
        for number, block in self._blocks():
            count = len(block["x"])
            builder.fill(slice(filled, filled + count), block)
            filled += count
            counts[number] += count
        builder.shorten(filled)
        depth = None
        if builder.colors is not None:
            depth, note = at_one_depth(builder.colors, self._scans, counts)
            self._notes += [note] if note else []
        crs = self._decoder.crs.strip()
        crs_or_none = crs if is_crs(crs) else None
        return builder.cloud(metadata=self._entries(), crs=crs_or_none, color_depth=depth)

    def _blocks(self) -> Iterator[tuple[int, dict[str, Array]]]:
        for number, scan in enumerate(self._scans):
            for columns in self._decoder.columns(scan):
                valid = _is_valid(columns)
                self._invalid += len(valid) - int(np.count_nonzero(valid))
                points = _moved(_positions(columns), scan.pose)
                columns_of_scan = {**columns, _SCAN: np.full(len(valid), number)}
                columns_of_scan |= {_COLORS[key]: columns[key] for key in _COLORS if key in columns}
                columns_of_scan |= dict(zip(POSITION, points, strict=True))
                yield number, {key: columns_of_scan[key][valid] for key in self._types}

    def _entries(self) -> dict[str, Any]:
        scans = tuple({"name": each.name, "points": each.rows} for each in self._scans)
        skipped = [*self._lost]
        if self._invalid:
            skipped.append(f"{self._invalid:,} points without a valid position")
        if images := self._decoder.images:
            skipped.append(f"{images:,} images")
        return noted({"e57": {"scans": scans}}, not_read=tuple(skipped), notes=tuple(self._notes))


def _common(scans: list[Scan], name: str) -> tuple[dict[str, np.dtype], list[str]]:
    """Return the types of the columns that all scans have, and the names of others."""
    for each in scans:
        if each.rows < 0:
            raise FormatError(f"{name}: the scan {each.name!r} states {each.rows:,} points")
        if not any(set(group) <= each.fields.keys() for group in (_CARTESIAN, _SPHERICAL)):
            raise FormatError(
                f"{name}: the scan {each.name!r} has neither cartesianX, cartesianY and cartesianZ "
                "nor range, azimuth and elevation"
            )
    places = {*_CARTESIAN, *_SPHERICAL, *_INVALID}
    own = [{k: v for k, v in each.fields.items() if k not in places} for each in scans]
    keys = [key for key in (own[0] if own else {}) if all(key in each for each in own)]
    types: dict[str, np.dtype] = dict.fromkeys(POSITION, np.dtype("f8"))
    stored = {key: np.result_type(*(each[key] for each in own)) for key in keys}
    is_color = all(key in stored and stored[key].kind == "u" for key in _COLORS)
    types |= {_COLORS.get(key, key) if is_color else key: each for key, each in stored.items()}
    if len(scans) > 1:
        types[_SCAN] = np.dtype("u4")
    names = {key for each in own for key in each} - {*keys}
    lost = [f"{key} (of some scans)" for key in sorted(names)]
    return types, [*lost, *sorted({key for each in scans for key in each.skipped})]


def _other_intensities(scans: list[Scan]) -> list[str]:
    """Say that intensities of scans are not of one scale."""
    keys = ("intensityMinimum", "intensityMaximum")
    ranges = {tuple(each.limits.get(key) for key in keys) for each in scans}
    return ["intensities of scans have different limits"] if len(ranges) > 1 else []


def _is_valid(columns: dict[str, Array]) -> Array:
    """Whether points have a position: the states are 0, direction only, and none."""
    first = next(iter(columns.values()))
    key = next((each for each in _INVALID if each in columns), None)
    return np.ones(len(first), np.bool_) if key is None else np.asarray(columns[key] == 0)


def _positions(columns: dict[str, Array]) -> tuple[Floats, Floats, Floats]:
    if set(_CARTESIAN) <= columns.keys():
        x, y, z = (columns[each] for each in _CARTESIAN)
        return x, y, z
    length, azimuth, elevation = (columns[each] for each in _SPHERICAL)
    across = length * np.cos(elevation)
    return across * np.cos(azimuth), across * np.sin(azimuth), length * np.sin(elevation)


def _moved(
    points: tuple[Floats, Floats, Floats], pose: tuple[list[float], list[float]] | None
) -> tuple[Floats, ...]:
    """Rotate and translate; coordinates stay bit for bit where a pose does neither."""
    if pose is None:
        return points
    (w, x, y, z), translation = pose
    if (w, x, y, z) != (1, 0, 0, 0):
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            points = _rotated(points, np.array([w, x, y, z]))
    pairs = zip(points, translation, strict=True)
    return tuple(each + shift if shift else each for each, shift in pairs)


def _rotated(points: tuple[Floats, ...], quaternion: Floats) -> tuple[Floats, Floats, Floats]:
    """Rotate by a quaternion of any length but zero."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    matrix = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    rows = [a * points[0] + b * points[1] + c * points[2] for a, b, c in matrix]
    return rows[0], rows[1], rows[2]


_EIGHT, _SIXTEEN = 255, 65535
_KEYS = ("colorRedMaximum", "colorGreenMaximum", "colorBlueMaximum")
_FIELD = "colorRed"


def at_one_depth(colors: Array, scans: list[Scan], counts: list[int]) -> tuple[int | None, str]:
    """Scale colours of scans to the deepest, in place; return its bits, and what is beyond."""
    parts = np.split(colors, np.cumsum(counts)[:-1]) if counts else []
    largest = [int(each.max(initial=0)) for each in parts]
    stated = [_stated(each) for each in scans]
    over = [k for k, top in enumerate(stated) if top is not None and largest[k] > top]
    tops = [None if k in over else top for k, top in enumerate(stated)]
    if not any(tops):
        return None, _note(scans, over)
    judged = max((high for high, top in zip(largest, tops, strict=True) if top is None), default=0)
    unsaid = _EIGHT if judged <= _EIGHT else _SIXTEEN
    full = _EIGHT if max(top or unsaid for top in tops) == _EIGHT else _SIXTEEN
    for part, top in zip(parts, tops, strict=True):
        if (own := top or unsaid) != full:
            part[:] = (part.astype(np.uint32) * full + own // 2) // own
    return full.bit_length(), _note(scans, over)


def _stated(scan: Scan) -> int | None:
    """Return the largest colour that a scan can have; None if it does not say it."""
    most = _EIGHT if scan.fields.get(_FIELD) == "u1" else _SIXTEEN
    said = [scan.limits.get(key, math.nan) for key in _KEYS]
    if not all(1 <= each <= _SIXTEEN for each in said):
        return None if most == _SIXTEEN else _EIGHT
    top = max(_EIGHT, min(int(max(said)), most))
    return top if not top & (top + 1) else _SIXTEEN


def _note(scans: list[Scan], over: list[int]) -> str:
    names = ", ".join(repr(scans[k].name) for k in over[:3])
    return f"colours beyond the limits that scans state: {names}" if over else ""
