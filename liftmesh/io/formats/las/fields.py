"""The fields of a point: where each value of a cloud goes in the bytes of a LAS file.

Values of the point format have their fields, some of a few bits; what does not fit there is refused
rather than changed. Normals and all other values become extra bytes, each described in 192 bytes.
What a file described stays as it was where the values still fit: type, scale, offset, text. Others
are described anew, in the type that they have.

Source: ASPRS, LAS Specification 1.4-R15, section 3.3.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.colors import as_float, check_colors, stated_depth
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, Option
from liftmesh.io.columns import COLOR, NORMAL, PARTS
from liftmesh.io.format import dropped_values
from liftmesh.io.formats.las.header import DEPTH
from liftmesh.io.metadata import Provenance
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


_MOST = 65535  # bytes of a point
_RANK, _ANGLE, _DEGREES = "scan_angle_rank", "scan_angle", 0.006  # formats 0-5; later ones; a step
_STEEPEST = 127
_WITH_COLORS = {0: 2, 1: 3, 4: 5, 6: 7, 9: 10}
_RESERVED = {*PARTS, "X", "Y", "Z", "bit_fields", "raw_classification", "classification_flags"}

# By number: 1 to 10, and twice and three times as many of each.
_TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
_NAME = slice(4, 36)
_SIZE = 192
_HAS_SCALE, _HAS_OFFSET = 0b1000, 0b10000
_SCALES, _OFFSETS = 112, 136  # places of three doubles each
UNDESCRIBED = "ExtraBytes"  # the name that laspy gives to bytes that nothing describes
_LONGEST = 32  # bytes of a name


@dataclass(frozen=True, slots=True)
class Field:
    """A field: its column of the record, the bits that it takes of it, and its values by rows."""

    column: str
    mask: int | None
    values: Callable[[slice], Array]


@dataclass(frozen=True, slots=True)
class Fields:
    """How a cloud fills points: the type of a point, its fields, extra bytes, and what is lost."""

    kind: np.dtype
    fields: tuple[Field, ...]
    extras: tuple[Extra, ...]
    lost: tuple[str, ...]

    def fill(self, points: Array, rows: slice) -> None:
        """Set the values of some rows in an array of points, which is zero."""
        for each in self.fields:
            values = each.values(rows)
            if each.mask is None:
                points[each.column] = values
            else:
                points[each.column] |= values.astype(np.uint8) << _shift(each.mask)


def fields_of(cloud: Cloud, point_format: int, known: list[Extra]) -> Fields:
    """Find a field for every value of a cloud."""
    standard = _Standard(point_format)
    values, lost = _named(cloud)
    fields = [*_of_colors(cloud), *standard.taken_from(values | _angles(values, standard.types))]
    values = {name: each for name, each in values.items() if name not in standard.names}
    columns: dict[str, np.dtype] = {}
    extras: list[Extra] = []
    left = _MOST - np.dtype([*standard.types.items()]).itemsize
    for name, before in _ordered(values, known):
        extra, numbers = _extra(name, values[name], before)
        if extra is None or extra.kind.itemsize > left:
            lost.append("normals" if name in NORMAL else dropped_values(name))
            continue
        left -= extra.kind.itemsize
        column = f"extra {len(extras)}"
        extras.append(extra)
        columns[column] = extra.kind
        fields.append(Field(column, None, _rows_of(numbers)))
    kind = np.dtype([*standard.types.items(), *columns.items()])
    return Fields(kind, tuple(fields), tuple(extras), tuple(dict.fromkeys(lost)))


def with_colors(point_format: int, cloud: Cloud) -> int:
    """Return the point format that has colours besides, if the cloud has any."""
    return point_format if cloud.colors is None else _WITH_COLORS.get(point_format, point_format)


def depth_of(cloud: Cloud) -> int | None:
    """Return the depth of colours: also of those that came from LAS by way of something else."""
    depth = Provenance(cloud.metadata).las.get(DEPTH)
    return cloud.color_depth or (depth if isinstance(depth, int) else None)


def depth_to_state(cloud: Cloud) -> int | None:
    """Return the bits of colours that a file must state, as its values alone would tell others."""
    if cloud.colors is None:
        return None
    colors = cloud.colors[:, :3]
    if colors.dtype in (np.uint8, np.uint16):
        return stated_depth(colors)
    held = levels(colors, depth_of(cloud))
    return stated_depth(held) if held.any() else None


def levels(colors: Array, depth: int | None) -> Array:
    """Convert colours to 16 bits; those of 8 bits that stood in 16 keep their numbers."""
    colors = colors[:, :3]
    if colors.dtype == np.uint16 or (colors.dtype == np.uint8 and depth == 8):
        return colors.astype(np.uint16)
    return np.rint(as_float(colors) * 65535.0).astype(np.uint16)


def _named(cloud: Cloud) -> tuple[dict[str, Array], list[str]]:
    """Return the values of a cloud by name, and the names that the file has for others."""
    lost = [dropped_values(name) for name in cloud.attributes if name in _RESERVED]
    values = {name: each for name, each in cloud.attributes.items() if name not in _RESERVED}
    if cloud.normals is not None:
        values |= dict(zip(NORMAL, cloud.normals.T, strict=True))
    return values, lost


def _angles(values: Mapping[str, Array], types: Mapping[str, str]) -> dict[str, Array]:
    """Convert the angle of the scanner, if the file has it in other steps than the cloud."""
    rank, fine = values.get(_RANK), values.get(_ANGLE)
    with np.errstate(invalid="ignore"):
        if _ANGLE in types and fine is None and _is_angle(rank):
            return {_ANGLE: np.rint(rank / _DEGREES).astype(np.int16)}  # type: ignore[operator]
        if _RANK in types and rank is None and _is_angle(fine, _DEGREES):
            return {_RANK: np.rint(fine * _DEGREES).astype(np.int8)}  # type: ignore[operator]
    return {}


def _is_angle(values: Array | None, step: float = 1.0) -> bool:
    """Whether there are numbers from -127 to 127 degrees."""
    if values is None or values.ndim != 1 or values.dtype.kind not in "iuf":
        return False
    return bool((np.abs(values.astype(np.float64)) * step <= _STEEPEST).all())


def _ordered(values: Mapping[str, Array], known: list[Extra]) -> Iterator[tuple[str, Extra | None]]:
    """Yield the names in the order of the file before; what nothing describes comes last."""
    before = {each.name: each for each in known if each.name in values}
    last = {UNDESCRIBED: before.pop(UNDESCRIBED)} if UNDESCRIBED in before else {}
    yield from before.items()
    yield from ((name, None) for name in values if name not in before and name not in last)
    yield from last.items()


def _extra(name: str, values: Array, known: Extra | None) -> tuple[Extra | None, Array]:
    """Describe extra bytes: as before if the values still fit, else anew."""
    numbers = None if known is None else known.numbers(values)
    if known is not None and numbers is not None:
        return known, numbers
    return new_extra(name, values), values


def _of_colors(cloud: Cloud) -> Iterator[Field]:
    """Yield the fields of colours."""
    colors, depth = cloud.colors, depth_of(cloud)
    if colors is None:
        return
    check_colors(colors)
    for k, name in enumerate(COLOR):
        yield Field(name, None, partial(_channel, colors, depth, k))


def _channel(colors: Array, depth: int | None, channel: int, rows: slice) -> Array:
    values: Array = levels(colors[rows], depth)[:, channel]
    return values


def _rows_of(values: Array) -> Callable[[slice], Array]:
    return lambda rows: values[rows]


class _Standard:
    """The values that every point of a format has."""

    def __init__(self, point_format: int) -> None:
        laspy = load("laspy", extra="las")
        self._point_format = point_format
        self.types: dict[str, str] = dict(laspy.PointFormat(point_format).dtype().descr)
        composed = laspy.point.dims.COMPOSED_FIELDS[point_format]
        self._bits = {each.name: (key, each.mask) for key in composed for each in composed[key]}

    @property
    def names(self) -> set[str]:
        """The names of the values."""
        return {*self._bits, *self.types}

    def taken_from(self, values: Mapping[str, Array]) -> Iterator[Field]:
        """Yield the fields of the values that have some."""
        yield from (self._field(name, values[name]) for name in values if name in self.names)

    def _field(self, name: str, values: Array) -> Field:
        if name in self._bits:
            column, mask = self._bits[name]
            self._check_whole(name, values, 0, mask >> _shift(mask))
            return Field(column, mask, _rows_of(values))
        kind = np.dtype(self.types[name])
        if kind.kind in "iu":
            limits = np.iinfo(kind)
            self._check_whole(name, values, int(limits.min), int(limits.max))
        else:
            self._check_float(name, values, kind)
        return Field(name, None, _rows_of(values))

    def _check_whole(self, name: str, values: Array, low: int, high: int) -> None:
        wanted = f"whole numbers from {low:,} to {high:,}"
        self._check_numbers(name, values, wanted)
        is_float = values.dtype.kind == "f"
        with np.errstate(invalid="ignore"):
            numbers = values.astype(np.float64) if is_float else values
            good = (numbers >= low) & (numbers <= high)
            if is_float:
                good &= (numbers == np.rint(numbers)) & ~((numbers == 0) & np.signbit(numbers))
        if not good.all():
            raise self._unfit(name, values, wanted, int(np.argmin(good)))

    def _check_float(self, name: str, values: Array, kind: np.dtype) -> None:
        wanted = f"floats of {8 * kind.itemsize} bits"
        self._check_numbers(name, values, wanted)
        with np.errstate(over="ignore", invalid="ignore"):
            converted = values.astype(kind)
            if values.dtype.kind == "f":
                good = (converted == values) | np.isnan(values)
            else:
                good = np.abs(converted) <= 2.0 ** (53 if kind.itemsize == 8 else 24)
        if not good.all():
            raise self._unfit(name, values, wanted, int(np.argmin(good)))

    def _check_numbers(self, name: str, values: Array, wanted: str) -> None:
        if values.ndim != 1 or values.dtype.kind not in "biuf":
            raise self._unfit(name, values, wanted, None)

    def _unfit(self, name: str, values: Array, wanted: str, row: int | None) -> FormatError:
        what = f"{values.dtype} of shape {values.shape}"
        what = what if row is None else f"{shown(values[row].item())} in row {row}"
        return FormatError(
            f"{name} is {what}, but point format {self._point_format} of LAS holds {wanted}: give "
            f"it another name or {Option('point_format', ...)}, or write PLY or NPZ"
        )


def _shift(mask: int) -> int:
    """Return the place of the lowest bit of a mask."""
    return (mask & -mask).bit_length() - 1


@dataclass(frozen=True, slots=True)
class Extra:
    """A value of a point: its name, the type and number of its elements, and its description."""

    name: str
    kind: np.dtype
    described: bytes
    scale: tuple[float, ...] | None = None  # of each element; None if its numbers are what is read
    offset: tuple[float, ...] = (0.0,)

    def numbers(self, values: Array) -> Array | None:
        """Convert values to those of the file; None if they would not come back as they are."""
        base, shape = self.kind.subdtype or (self.kind, ())
        if values.shape[1:] != shape:
            return None
        if self.scale is None:
            return values if values.dtype == base else None
        if values.dtype != np.float64:
            return None
        return _stored(values, base, np.array(self.scale), np.array(self.offset))


def described_extras(data: bytes, rest: int) -> list[Extra]:
    """Return the extra bytes that a record describes, as laspy takes them."""
    parts = [data[place : place + _SIZE] for place in range(0, len(data) - _SIZE + 1, _SIZE)]
    extras = [each for part in parts if (each := _described(part)) is not None]
    left = rest - sum(each.kind.itemsize for each in extras)
    if len(extras) < len(parts) or left < 0:
        return []
    unknown = np.dtype((np.uint8, (left,))) if left > 1 else np.dtype(np.uint8)
    return [*extras, *([Extra(UNDESCRIBED, unknown, b"")] if left else [])]


def new_extra(name: str, values: Array) -> Extra | None:
    """Describe values by a type that holds them; None if there is none."""
    kind: np.dtype = values.dtype.newbyteorder("=")
    if kind.kind == "b" or kind.str[1:] == "f2":
        kind = np.dtype(np.uint8 if kind.kind == "b" else np.float32)
    encoded = _encoded(name)
    width = 1 if values.ndim == 1 else values.shape[1] if values.ndim == 2 else 0
    is_vector = values.ndim == 2 and width in (2, 3)
    if kind.str[1:] not in _TYPES or not encoded or not (values.ndim == 1 or is_vector):
        return None
    number = _TYPES.index(kind.str[1:]) + 1 + len(_TYPES) * (width - 1)
    text = bytes([0, 0, number, 0]) + encoded.ljust(_LONGEST, b"\0")
    shaped = np.dtype((kind, (width,))) if is_vector else kind
    return Extra(name, shaped, text.ljust(_SIZE, b"\0"))


def _stored(values: Array, base: np.dtype, scale: Array, offset: Array) -> Array | None:
    """Return the numbers of a type that become these values, bit for bit; None if some do not."""
    with np.errstate(all="ignore"):
        found = (values - offset) / scale
        if base.kind in "iu":
            found, limits = np.rint(found), np.iinfo(base)
            if not ((found >= float(limits.min)) & (found <= float(limits.max))).all():
                return None
        numbers = found.astype(base)
        again = numbers * scale + offset
    same = again.view(np.int64) == np.ascontiguousarray(values).view(np.int64)
    return numbers if same.all() else None


def _described(part: bytes) -> Extra | None:
    number, options = part[2], part[3]
    name = part[_NAME].rstrip(b"\0").decode("utf-8", "replace")
    if number == 0:
        kind = np.dtype((np.uint8, (options,))) if options > 1 else np.dtype(np.uint8)
        return Extra(name, kind, part)
    if number > 3 * len(_TYPES):
        return None
    count, base = (number - 1) // len(_TYPES) + 1, np.dtype(_TYPES[(number - 1) % len(_TYPES)])
    kind = np.dtype((base, (count,))) if count > 1 else base
    if not options & (_HAS_SCALE | _HAS_OFFSET):
        return Extra(name, kind, part)
    ones, zeros = (1.0,) * 3, (0.0,) * 3
    scale = struct.unpack_from("<3d", part, _SCALES) if options & _HAS_SCALE else ones
    offset = struct.unpack_from("<3d", part, _OFFSETS) if options & _HAS_OFFSET else zeros
    return Extra(name, kind, part, scale[:count], offset[:count]) if all(scale[:count]) else None


def _encoded(name: str) -> bytes:
    """Encode a name; nothing if a file could not give it back."""
    try:
        data = name.encode()
    except UnicodeEncodeError:
        return b""
    return data if len(data) <= _LONGEST and b"\0" not in data else b""
