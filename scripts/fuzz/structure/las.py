"""LAS, made of the parts of its header, records and points; LAZ, made by laspy, and its bytes."""

from __future__ import annotations

import io
import struct

import laspy
import numpy as np
from files.las import encoded, records
from fuzz.structure.case import Case, Points, in_order, quarters, told
from fuzz.structure.parts import Chance, Part
from growth.files.lidar import nodes_of_one_point

LAS_WORDS = [b"LASF", b"LASF_Spec", b"LASF_Projection", b"laszip encoded", b"copc", b"x", b"red"]
_STEP = 0.25
_SIZES = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
TRACED = 2 << 20
"""Where lazrs meets damage that it did not foresee, Rust may look up the names of functions: that
takes 30 MB, whatever the file."""
_INFO = 375 + 54  # the place of what COPC says of its index
_COUNT_FORMS = ("<H", "<I", "<B", "<Q", "<d", "<q")


def las(chance: Chance) -> Case:
    """Make a LAS file of any version and point format, with records of several kinds."""
    points = quarters(chance, chance.randint(0, 6))
    kind = chance.randrange(11)
    minor = 4 if kind > 5 else 3 if kind > 3 else chance.choice((0, 1, 2, 3, 4))
    extra = chance.choice((0, 0, 4, 7))
    records = [_record(*each) for each in _records(chance, extra)]
    size = (227, 227, 227, 235, 375)[minor]
    start = size + sum(54 + len(data) for _, _, data in (_content(each) for each in records))
    parts = _header(points, (kind, minor, _SIZES[kind] + extra), (size, start, len(records)))
    for each in records:
        parts += each
    for row in points:
        parts += [Part(int(value / _STEP), "<i") for value in row]
        rest = _SIZES[kind] + extra - 12
        parts += [Part(chance.randrange(256), "<B") for _ in range(4)]
        parts.append(Part(bytes(chance.randrange(256) for _ in range(rest - 4))))
    return told("las", parts, LAS_WORDS, points, chance)


def _header(points: Points, kind: tuple[int, int, int], sizes: tuple[int, int, int]) -> list[Part]:
    """The public header; zeros where readers take nothing from."""
    point_format, minor, point_size = kind
    parts = [Part(b"LASF"), Part(0, "<H"), Part(0, "<H"), Part(bytes(16)), Part(1, "<B")]
    parts += [Part(minor, "<B"), Part(bytes(64)), Part(1, "<H"), Part(2024, "<H")]
    parts += [Part(sizes[0], "<H"), Part(sizes[1], "<I"), Part(sizes[2], "<I")]
    parts += [Part(point_format, "<B"), Part(point_size, "<H"), Part(len(points), "<I")]
    parts += [
        Part(bytes(20)),
        *(Part(_STEP, "<d") for _ in "xyz"),
        *(Part(0.0, "<d") for _ in "xyz"),
    ]
    parts += [Part(0.0, "<d") for _ in range(6)]
    if minor >= 3:
        parts.append(Part(0, "<Q"))
    if minor >= 4:
        parts += [Part(0, "<Q"), Part(0, "<I"), Part(len(points), "<Q"), Part(bytes(120))]
    return parts


def _records(chance: Chance, extra: int) -> list[tuple[bytes, int, bytes]]:
    keys = struct.pack("<8H", 1, 1, 0, 1, 3072, 0, 1, 25832)
    found = [(b"LASF_Projection", 34735, keys), (b"LASF_Projection", 2112, b'PROJCS["a"]\0')]
    found += [(b"LASF_Spec", 0, b"\x02ground".ljust(16, b"\0")), (b"someone", 7, bytes(5))]
    described = struct.pack("<HBB32s", 0, 9, 0, b"width").ljust(192, b"\0")
    return chance.some(found) + [(b"LASF_Spec", 4, described)] * (extra == 4)


def _record(user: bytes, number: int, data: bytes) -> list[Part]:
    head = [Part(0, "<H"), Part(user.ljust(16, b"\0")), Part(number, "<H"), Part(len(data), "<H")]
    return [*head, Part(bytes(32)), Part(data)]


def _content(parts: list[Part]) -> tuple[bytes, int, bytes]:
    user, number, data = parts[1].value, parts[2].value, parts[-1].value
    assert isinstance(user, bytes)
    assert isinstance(data, bytes)
    return user, int(number), data


def laz(chance: Chance) -> Case:
    """Make a LAZ file; in three of four some numbers in it are others, or its end is missing."""
    points = quarters(chance, chance.randint(1, 40))
    data = _compressed(points, chance.randrange(11))
    if chance.one_in(4):
        return Case("laz", data, in_order(points))
    damaged = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        form = chance.choice(_COUNT_FORMS)
        value = chance.whole() if form != "<d" else chance.real()
        part = Part(value, form).encode()
        place = chance.randrange(len(damaged) - len(part))
        damaged[place : place + len(part)] = part
    end = chance.randrange(len(damaged)) if chance.one_in(6) else len(damaged)
    return Case("laz", bytes(damaged[:end]), content=TRACED)


def copc(chance: Chance) -> Case:
    """Make a COPC file with a point in each node; its index lies in three of four."""
    count = chance.randint(1, 12)
    data = bytearray(nodes_of_one_point(count))
    data[8:24] = bytes(chance.randrange(256) for _ in range(16))  # the GUID of a project
    index = len(data) - 32 * (count + count // 2)
    options = chance.choice(
        ({"bounds": (0, 0, 400, 400)}, {"copc_resolution": 3.0}, {"z_range": (0, 9)})
    )
    if chance.one_in(4):
        points = np.array(laspy.read(io.BytesIO(data)).xyz)
        return Case("laz", bytes(data), in_order(points), options=options)
    for _ in range(chance.randint(1, 4)):
        form = chance.choice(("<i", "<Q", "<d"))
        value = chance.whole() if form != "<d" else chance.real()
        part = Part(value, form).encode()
        places = (range(_INFO, _INFO + 72, 8), range(index, len(data) - 8, 4))
        place = chance.choice(chance.choice(places))
        data[place : place + len(part)] = part
    return Case("laz", bytes(data), content=TRACED, options=options)


def _compressed(points: Points, point_format: int) -> bytes:
    version = "1.4" if point_format > 5 else "1.3"
    tile = records(points, point_format, version=version, scale=_STEP, offset=np.zeros(3))
    return encoded(tile, compressed=True)
