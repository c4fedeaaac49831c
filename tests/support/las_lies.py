"""LAS and LAZ files that promise what they do not hold, and what the error must say of it."""

from __future__ import annotations

import struct

from lidar import encoded, patched, record, tile, with_records

_EVLR = struct.Struct("<H16sHQ32s")


def las_lies() -> dict[str, tuple[bytes, str]]:
    """Lies of the header and its records."""
    plain, late = encoded(tile(20)), encoded(tile(20, point_format=6, version="1.4"))
    start = struct.unpack_from("<I", plain, 96)[0]
    found = {
        "not lidar": (b"LASG" + plain[4:], "not a LAS file"),
        "nothing but a name": (plain[:200], "not a LAS file"),
        "version 1.9": (patched(plain, "<B", 25, 9), "byte 24: LAS 1.9"),
        "version 2.0": (patched(plain, "<BB", 24, 2, 0), "byte 24: LAS 2.0"),
        "a short header": (patched(plain, "<H", 94, 100), "byte 94: the header states 100 bytes"),
        "points beyond the end": (patched(plain, "<I", 96, 2**32 - 1), "byte 96: the points"),
        "points in the header": (patched(plain, "<I", 96, 100), "byte 96: the points"),
        "format 11": (patched(plain, "<B", 104, 11), "byte 104: point format 11"),
        "points of 5 bytes": (patched(plain, "<H", 105, 5), "byte 105: a point has 5 bytes"),
        "points of 65,535 bytes": (patched(plain, "<H", 105, 65535), "20 points of 65535 bytes"),
        "no scale": (patched(plain, "<d", 131, 0.0), "byte 131: the coordinates have the scales"),
        "a scale of NaN": (patched(plain, "<d", 139, float("nan")), "byte 131: the coord"),
        "endless offsets": (patched(plain, "<d", 155, float("inf")), "byte 131: the coord"),
        "cut in the points": (plain[:-1], f"byte {start}: .* 20 points .* holds 19: .*truncated"),
        "points of old": (patched(late, "<Q", 247, 0, )[:107] + struct.pack("<I", 20)
                          + patched(late, "<Q", 247, 0)[111:], "byte 247: .* 0 points, and 20"),
    }  # fmt: skip
    for count in (21, 2**31, 2**32 - 1):
        found[f"{count} points"] = patched(plain, "<I", 107, count), f"{count:,} points of 34"
        found[f"{count} records"] = patched(plain, "<I", 100, count), "byte 100: the header states"
    for count in (21, 2**62, 2**64 - 1):
        found[f"{count} points of 1.4"] = patched(late, "<Q", 247, count), f"{count:,} points of 30"
    for count in (1, 2**31, 2**32 - 1):
        lie = patched(late, "<QI", 235, len(late), count)
        found[f"{count} extended records"] = lie, "byte 243: the header states"
    far = with_records(plain, patched(record(b"a", 1, b"abc"), "<H", 20, 65535))
    found["a long record"] = far, "byte 227: record 0 states 65,535 bytes"
    for size in (1, 2**62, 2**64 - 1):
        lie = patched(late, "<QI", 235, len(late), 1) + _EVLR.pack(
            0, b"LASF_Projection", 2112, size, b""
        )
        found[f"an extended record of {size}"] = lie, "record 0 states"
    twice = bytearray(384)
    for place in (2, 194):
        twice[place : place + 4] = b"\x01\x00qq"
    rows = plain[:start] + b"".join(
        plain[start + 34 * k : start + 34 * (k + 1)] + b"ab" for k in range(20)
    )
    lie = with_records(patched(rows, "<H", 105, 36), record(b"LASF_Spec", 4, bytes(twice)))
    found["two columns of one name"] = lie, "cannot be decoded"
    return found


def laz_lies() -> dict[str, tuple[bytes, str]]:
    """Lies of the compression."""
    found: dict[str, tuple[bytes, str]] = {}
    for kind, version in ((3, "1.2"), (6, "1.4")):
        data = encoded(tile(2000, point_format=kind, version=version), compressed=True)
        start = struct.unpack_from("<I", data, 96)[0]
        place = data.index(b"laszip encoded") + 52
        table = struct.unpack_from("<q", data, start)[0]
        count = ("<I", 107) if kind == 3 else ("<Q", 247)
        for points in (50_001, 2**31):
            lie = patched(data, *count, points)
            found[f"{kind}: {points} points"] = lie, "1 chunks of 50,000 hold|expands to"
        for at in (0, -2, table + 10**6, 2**62):
            lie = patched(data, "<q", start, at)
            found[f"{kind}: a table at {at}"] = lie, "LAZ: the table of chunks should begin"
        for chunks in (2**16, 2**32 - 1):
            lie = patched(data, "<I", table + 4, chunks)
            found[f"{kind}: {chunks} chunks"] = lie, "LAZ: the table of chunks states"
        found[f"{kind}: no chunks"] = patched(data, "<I", table + 4, 0), "0 chunks of 50,000 hold"
        found[f"{kind}: chunks of nothing"] = patched(data, "<I", place + 12, 0), "have 0 points"
        found[f"{kind}: chunks of two"] = patched(data, "<I", place + 12, 2), "hold 2: it is trunc"
        found[f"{kind}: items"] = patched(data, "<H", place + 32, 999), "states 999 items, and ends"
        found[f"{kind}: a wide item"] = patched(data, "<H", place + 36, 999), "its compressed items"
        found[f"{kind}: no record"] = data.replace(b"laszip enc", b"laszip ENC"), "is missing"
        found[f"{kind}: cut off"] = data[: len(data) // 2], "LAZ: the table of chunks should begin"
    size = 30 + 4  # the first point, and the count
    for layer in range(9):
        lie = patched(data, "<I", start + 8 + size + 4 * layer, 2**32 - 1)
        found[f"6: a layer {layer} of 4 GiB"] = lie, "LAZ: chunk 0 has .* bytes, and states"
    return found
