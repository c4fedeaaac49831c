"""LAS and LAZ files, made by laspy, and damaged by hand."""

from __future__ import annotations

import io
import struct
from typing import Any

import laspy
import lazrs
import numpy as np

UTM = (500000.0, 5400000.0, 0.0)
RETURNS = np.array([1, 1, 2, 1, 2, 3], dtype=np.uint8)
COUNTS = np.array([1, 2, 2, 3, 3, 3], dtype=np.uint8)
CLASSES = np.array([2, 2, 5, 2, 9, 7], dtype=np.uint8)


def records(
    points: Any,
    point_format: int = 3,
    *,
    version: str = "1.2",
    scale: float = 0.01,
    offset: Any = UTM,
    **values: Any,
) -> laspy.LasData:
    """Make points of a format with the values that are given."""
    header = laspy.LasHeader(point_format=point_format, version=version)
    header.offsets, header.scales = offset, [scale] * 3
    las = laspy.LasData(header)
    las.x, las.y, las.z = np.asarray(points, dtype=np.float64).T
    for name, each in values.items():
        las[name] = each
    return las


def encoded(las: laspy.LasData, *, compressed: bool = False) -> bytes:
    """Write to memory."""
    stream = io.BytesIO()
    las.write(stream, do_compress=compressed)
    return stream.getvalue()


def tile(count: int = 6, *, point_format: int = 3, version: str = "1.2") -> laspy.LasData:
    """Make a tile with every value of its format, in repeated rows of six returns."""
    rng = np.random.default_rng(count)
    points = np.column_stack([rng.random((count, 2)) * 1000, rng.random(count) * 50]) + UTM
    las = records(points, point_format, version=version)
    for each in las.point_format.dimensions:
        if each.name in ("X", "Y", "Z"):
            continue
        if each.dtype is None:
            las[each.name] = rng.integers(0, 2**each.num_bits, count).astype(np.uint8)
        elif each.dtype.kind == "f":
            las[each.name] = rng.random(count).astype(each.dtype)
        else:
            top = np.iinfo(each.dtype).max
            las[each.name] = rng.integers(0, top, count, endpoint=True, dtype=each.dtype)
    for name, values in (
        ("return_number", RETURNS),
        ("number_of_returns", COUNTS),
        ("classification", CLASSES),
    ):
        las[name] = np.resize(values, count)
    las.withheld = np.zeros(count, np.uint8)
    return las


def patched(data: bytes, form: str, place: int, *values: Any) -> bytes:
    """Replace numbers in a file."""
    found = bytearray(data)
    struct.pack_into(form, found, place, *values)
    return bytes(found)


def record(user: bytes, number: int, data: bytes) -> bytes:
    """Make a variable length record."""
    return struct.pack("<H16sHH32s", 0, user, number, len(data), b"") + data


def with_records(data: bytes, *made: bytes, wkt: bool = False) -> bytes:
    """Put records before the points of a LAS file that has none."""
    header_size, start, count = struct.unpack_from("<HII", data, 94)
    assert count == 0
    head = patched(data[:header_size], "<II", 96, start + sum(map(len, made)), len(made))
    if wkt:
        head = patched(head, "<H", 6, struct.unpack_from("<H", head, 6)[0] | 16)
    return head + b"".join(made) + data[start:]


def geo_keys(**keys: int) -> bytes:
    """Make the directory of GeoKeys, each named k1024 and so on."""
    rows = [(int(name[1:]), 0, 1, value) for name, value in keys.items()]
    return struct.pack(f"<{4 * (len(rows) + 1)}H", 1, 1, 0, len(rows), *np.ravel(rows).astype(int))


def copc(las: laspy.LasData, spacing: float = 16.0, levels: int = 3) -> bytes:
    """Make a COPC file: an octree whose nodes are chunks, in the order of their levels."""
    xyz = np.asarray(las.xyz)
    low = xyz.min(axis=0)
    half = float(np.ptp(xyz, axis=0).max()) / 2 + 0.5
    depth = np.arange(len(xyz)) % levels  # any points of the file may be those of a level
    keys = np.floor((xyz - low) / (2 * half / 2.0 ** depth[:, None])).astype(int)
    nodes = sorted({(int(d), *map(int, key)) for d, key in zip(depth, keys, strict=True)})
    empty = encoded(laspy.LasData(las.header), compressed=False)
    head_size, old = struct.unpack_from("<HI", empty, 94)
    vlr = lazrs.LazVlr.new_for_compression(las.point_format.id, 0, True)
    packing = record(b"laszip encoded", 22204, bytes(vlr.record_data()))
    start = head_size + 54 + 160 + len(packing) + old - head_size
    stream = io.BytesIO(bytes(start))
    stream.seek(start)
    packer = lazrs.LasZipCompressor(stream, vlr)
    entries, place = [], start + 8
    for node in nodes:
        rows = (depth == node[0]) & (keys == node[1:]).all(axis=1)
        packer.compress_many(np.frombuffer(las.points.array[rows].tobytes(), np.uint8))
        packer.finish_current_chunk()
        size = stream.tell() - place
        entries.append((*node, place, size, int(rows.sum())))
        place += size
    packer.done()
    return _with_pages(stream, empty, entries, packing, (*(low + half), half, spacing))


def _with_pages(
    stream: io.BytesIO, empty: bytes, entries: list[Any], packing: bytes, cube: Any
) -> bytes:
    """Add the pages, the second of which holds a subtree, and the header."""
    stream.seek(0, io.SEEK_END)
    end = stream.tell() + 60
    top = next((each[:4] for each in entries if each[0] == 1), None)
    below = [each for each in entries if top and _ancestor(each) == top]
    root = [each for each in entries if each not in below]
    if top:
        root.append((*top, end + 32 * (len(root) + 1), 32 * len(below), -1))
    page = b"".join(struct.pack("<4iQ2i", *each) for each in [*root, *below])
    stream.write(struct.pack("<H16sHQ32s", 0, b"copc", 1000, len(page), b"") + page)
    head_size, old, count = struct.unpack_from("<HII", empty, 94)
    info = struct.pack("<5d2Q104x", *cube, end, 32 * len(root))
    rest = record(b"copc", 1, info) + empty[head_size:old] + packing
    points = sum(each[-1] for each in entries)
    head = patched(empty[:head_size], "<II", 96, head_size + len(rest), count + 2)
    head = patched(head, "<B", 104, empty[104] | 128)
    head = patched(head, "<QIQ", 235, end - 60, 1, points)
    stream.seek(0)
    stream.write(head + rest)
    return stream.getvalue()


def _ancestor(entry: Any) -> tuple[int, ...]:
    """Return the node of level 1 that a node is, or is below of."""
    level = max(entry[0] - 1, 0)
    return (min(entry[0], 1), *(each >> level for each in entry[1:4]))
