"""Extra bytes: values of a point beyond those of its format, each described in 192 bytes.

What a file described stays as it was where the values still fit: type, scale, offset, text. Others
are described anew, in the type that they have.

Source: ASPRS, LAS Specification 1.4-R15, section 3.3.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Array

# By number: 1 to 10, and twice and three times as many of each.
_TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
_NAME = slice(4, 36)
_SIZE = 192
_HAS_LIMITS, _HAS_SCALE, _HAS_OFFSET = 0b110, 0b1000, 0b10000
_SCALES, _OFFSETS = 112, 136  # places of three doubles each
UNDESCRIBED = "ExtraBytes"  # the name that laspy gives to bytes that nothing describes
_LONGEST = 32  # bytes of a name


@dataclass(frozen=True, slots=True)
class Extra:
    """A value of a point: its name, the type and number of its elements, and its description."""

    name: str
    kind: np.dtype
    described: bytes
    scale: tuple[float, ...] | None = None
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


def described(data: bytes, rest: int) -> list[Extra]:
    """Return the extra bytes that a record describes, as laspy takes them."""
    parts = [data[place : place + _SIZE] for place in range(0, len(data) - _SIZE + 1, _SIZE)]
    found = [each for part in parts if (each := _described(part)) is not None]
    left = rest - sum(each.kind.itemsize for each in found)
    if len(found) < len(parts) or left < 0:
        return []
    unknown = np.dtype((np.uint8, (left,))) if left > 1 else np.dtype(np.uint8)
    return [*found, *([Extra(UNDESCRIBED, unknown, b"")] if left else [])]


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


def new(name: str, values: Array) -> Extra | None:
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


def _encoded(name: str) -> bytes:
    """Encode a name; nothing if a file could not give it back."""
    try:
        data = name.encode()
    except UnicodeEncodeError:
        return b""
    return data if len(data) <= _LONGEST and b"\0" not in data else b""


def without_limits(extra: Extra) -> bytes:
    """Return the description without the smallest and largest value, which may be others now."""
    part = bytearray(extra.described)
    if len(part) == _SIZE and part[2]:
        part[3] &= ~_HAS_LIMITS & 0xFF
    return bytes(part)
