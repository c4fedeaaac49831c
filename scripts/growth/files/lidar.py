"""Families of LAS and LAZ files.

Work grows where records are many and hold nothing, where chunks are many and hold a point each, and
where a point compresses to nearly nothing.
"""

from __future__ import annotations

import io
import struct

import laspy
import lazrs
import numpy as np
from files.las import encoded, records
from growth.families import families_in, random
from growth.files.points import Compressed

_RECORD = struct.Struct("<H16sHH32s")
_LONG_RECORD = struct.Struct("<H16sHQ32s")
_AT_RECORDS = 96  # place of the first point, and number of records
_AT_LONG_RECORDS = 235


def _tile(n: int, point_format: int = 3, version: str = "1.2") -> laspy.LasData:
    values = {
        "intensity": random().integers(0, 65535, n).astype(np.uint16),
        "classification": np.full(n, 2, np.uint8),
    }
    places = random().random((n, 3)) * 1000
    return records(places, point_format, version=version, offset=np.zeros(3), **values)


def _written(tile: laspy.LasData, *, compressed: bool = False) -> bytes:
    made = Compressed(encoded(tile, compressed=compressed))
    made.content = max(len(made), len(tile.points) * tile.point_format.size)
    return made


def rows(n: int) -> bytes:
    """The ordinary tile."""
    return _written(_tile(n))


def compressed_rows(n: int) -> bytes:
    """The ordinary tile, compressed."""
    return _written(_tile(n), compressed=True)


def compressed_in_layers(n: int) -> bytes:
    """The ordinary tile of LAS 1.4, whose values are compressed in layers."""
    return _written(_tile(n, 6, "1.4"), compressed=True)


def equal_points(n: int) -> bytes:
    """One point again and again: what expands the most."""
    tile = _tile(64 * n, 6, "1.4")
    tile.points.array[:] = tile.points.array[0]
    return _written(tile, compressed=True)


def chunks_of_one_point(n: int) -> bytes:
    """Chunks of a point each: they are found, checked and decoded one by one."""
    return _chunks(n, b"")


def nodes_of_one_point(n: int) -> bytes:
    """The octree of COPC with a point in each node, and a page for each of half of them."""
    empty = _RECORD.pack(0, b"copc", 1, 160, b"") + bytes(160)
    data = bytearray(_chunks(n, empty))
    start = struct.unpack_from("<I", data, _AT_RECORDS)[0]
    vlr = lazrs.LazVlr.new_for_compression(6, 0, True)
    stream = io.BytesIO(bytes(data))
    stream.seek(start)
    table = lazrs.read_chunk_table(stream, vlr)
    nodes, place = [], start + 8
    for k, (points, size) in enumerate(table):
        if points:
            nodes.append(struct.pack("<4iQ2i", 20, k, 0, 0, place, size, points))
        place += size
    half, root = len(nodes) // 2, len(data)
    below = root + 32 * len(nodes)
    pages = [struct.pack("<4iQ2i", 20, k, 0, 0, below + 32 * k, 32, -1) for k in range(half)]
    data += b"".join([*pages, *nodes[half:], *nodes[:half]])
    info = struct.pack("<5d2Q", 500, 500, 500, 501, 10, root, 32 * len(nodes))
    data[429 : 429 + len(info)] = info
    return bytes(data)


def _chunks(n: int, before: bytes) -> bytes:
    tile = _tile(n, 6, "1.4")
    head = _written(_tile(0, 6, "1.4"))
    vlr = lazrs.LazVlr.new_for_compression(6, 0, True)
    record = vlr.record_data()
    start = len(head) + len(before) + _RECORD.size + len(record)
    made = bytearray(head)
    struct.pack_into("<II", made, _AT_RECORDS, start, 2 if before else 1)
    struct.pack_into("<B", made, 104, 6 | 128)
    struct.pack_into("<Q", made, 247, n)
    made += before + _RECORD.pack(0, b"laszip encoded", 22204, len(record), b"") + record
    stream = io.BytesIO()
    stream.write(made)
    compressor = lazrs.LasZipCompressor(stream, vlr)
    for row in tile.points.array:
        compressor.compress_many(np.frombuffer(row.tobytes(), np.uint8))
        compressor.finish_current_chunk()
    compressor.done()
    return stream.getvalue()


def records_of_nothing(n: int) -> bytes:
    """Very many records without content, and one point."""
    data = _written(_tile(1))
    start = struct.unpack_from("<I", data, _AT_RECORDS)[0]
    made = bytearray(data[:start]) + _RECORD.pack(0, b"a", 1, 0, b"") * n + data[start:]
    struct.pack_into("<II", made, _AT_RECORDS, start + n * _RECORD.size, n)
    return bytes(made)


def extended_records(n: int) -> bytes:
    """Very many records behind the points, all of coordinate systems."""
    data = bytearray(_written(_tile(1, 6, "1.4")))
    struct.pack_into("<QI", data, _AT_LONG_RECORDS, len(data), n)
    return bytes(data) + _LONG_RECORD.pack(0, b"LASF_Projection", 2112, 0, b"") * n


def long_system(n: int) -> bytes:
    """A coordinate system of very many brackets."""
    data = bytearray(_written(_tile(1, 6, "1.4")))
    struct.pack_into("<QI", data, _AT_LONG_RECORDS, len(data), 1)
    text = b'PROJCS["a",' + b"A[" * 20 * n + b"]" * 20 * n + b"]"
    return bytes(data) + _LONG_RECORD.pack(0, b"LASF_Projection", 2112, len(text), b"") + text


LAS = families_in(globals(), "bytes")
