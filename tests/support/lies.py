"""Small files that promise what they do not hold, and where the error must find the lie."""

from __future__ import annotations

import json
import struct
import zipfile
from typing import Any

import numpy as np
from files.archives import zipped
from files.gltf import glb
from files.las import encoded, patched, record, tile, with_records
from gltf_models import TRIANGLE, Model

_EVLR = struct.Struct("<H16sHQ32s")
HUGE = (2**31, 2**32 - 1, 2**62 // 10, 10**18 - 1)


def ply(encoding: str, *lines: str, body: bytes = b"") -> bytes:
    return "\n".join(["ply", f"format {encoding} 1.0", *lines, "end_header", ""]).encode() + body


def ply_lies() -> dict[str, tuple[bytes, str]]:
    point = ("property double x", "property double y", "property double z")
    square = ("element vertex 4", *point)
    rows = np.zeros((4, 3)).tobytes()
    binary, text = "binary_little_endian", "ascii"
    found: dict[str, tuple[bytes, str]] = {}
    for count in HUGE:
        lines = (f"element vertex {count}", *point)
        found[f"{count} vertices"] = ply(binary, *lines, body=bytes(700)), "byte .* promises"
        found[f"{count} lines"] = ply(text, *lines, body=b"0 0 0\n" * 99), "line .* promises"
        faces = (*square, f"element face {count}", "property list uchar int vertex_indices")
        found[f"{count} faces"] = ply(binary, *faces, body=rows + bytes(99)), "byte .* promises"
        others = (f"element other {count}", "property uchar k", *square)
        found[f"{count} others"] = ply(binary, *others, body=rows), "byte .* promises"
        lists = (f"element other {count}", "property list uint uint k", *square)
        found[f"{count} lists"] = ply(text, *lists, body=b"0\n" * 99), "line .* promises"
    for kind, form, sizes in (("uint", "<I", (2**31, 2**32 - 1)), ("int", "<i", (2**31 - 1, -1))):
        for size in sizes:
            lines = (*square, "element face 1", f"property list {kind} int vertex_indices")
            body = rows + struct.pack(form, size) + bytes(12)
            found[f"a list of {size} {kind}"] = ply(binary, *lines, body=body), f"row 0 .* {size} "
    for size in (2**63, 2**63 - 1):
        lines = (*square, "element face 1", "property list uint64 int vertex_indices")
        body = rows + struct.pack("<Q", size) + bytes(12)
        found[f"a list of {size}"] = ply(binary, *lines, body=body), f"row 0 .* {size} "
        body = b"0 0 0\n" * 4 + f"{size} 0 1 2\n".encode()
        found[f"a line of {size}"] = ply(text, *lines, body=body), "line 14"
    found["more digits than there are"] = ply(text, f"element vertex {2**63}", *point), "line 3"
    found["a negative count"] = ply(text, "element vertex -1", *point), "line 3"
    found["rows of nothing"] = ply(text, *square, "element q 999999999999999999"), "line 8"
    return found


def npy(descr: Any, shape: tuple[Any, ...], body: bytes = bytes(96)) -> bytes:
    header = repr({"descr": descr, "fortran_order": False, "shape": shape}).encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + body


def npy_lies() -> dict[str, tuple[bytes, str]]:
    shapes = {
        "rows": ("<f8", (2**31, 3)),
        "endless rows": ("<f8", (2**63, 3)),
        "no rows of endless ones": ("<f8", (0, 2**62, 3)),
        "rows of nothing": ("|V0", (2**40, 3)),
        "words of no letters": ("<U0", (2**40, 3)),
        "axes": ("<f8", (1,) * 3000),
        "an axis below zero": ("<f8", (-4, -3)),
        "an axis that is true": ("<f8", (True, 3)),
        "fields of endless rows": ([("x", "<f8"), ("y", "<f8")], (2**40,)),
    }
    found = {name: (npy(*each), "shape") for name, each in shapes.items()}
    wide = [("x", "<f8", (2**27,)), ("y", "<f8")]
    return found | {"a field that is wide": (npy(wide, (1,)), "header is invalid|should take")}


def npz_lies() -> dict[str, tuple[bytes, str]]:
    found = {
        f"packed: {name}": (zipped({"points.npy": data}), f"points.npy.*(?:{cause})")
        for name, (data, cause) in npy_lies().items()
    }
    content = npy("<f8", (4, 3))
    plain = zipped({"points.npy": content})
    size = struct.pack("<L", len(content))
    for lie in (2**31, 2**32 - 2):
        found[f"{lie} bytes"] = plain.replace(size, struct.pack("<L", lie)), "cannot decompress to"
    for method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        bomb = zipped({"points.npy": content}, method).replace(size, struct.pack("<L", 2**31))
        found[f"a bomb of method {method}"] = bomb, "compressed with"
    return found | {"members that overlap": (overlapping(content), "larger than the file")}


def overlapping(content: bytes) -> bytes:
    """Zip one member, and list it in the directory under forty names."""
    data = zipped({"0000.npy": content}, zipfile.ZIP_STORED)
    at = data.index(b"PK\x01\x02")
    end = data.index(b"PK\x05\x06")
    entry = data[at:end]
    entries = b"".join(entry.replace(b"0000", b"%04d" % k) for k in range(40))
    tail = bytearray(data[end:])
    struct.pack_into("<HHL", tail, 8, 40, 40, len(entries))
    return data[:at] + entries + bytes(tail)


def other_lies() -> dict[str, tuple[bytes, str]]:
    """Files whose first word is their format."""
    found: dict[str, tuple[bytes, str]] = {}
    for count in (*HUGE, -1, -3):
        square = b"0 0 0\n1 0 0\n1 1 0\n"
        off = b"OFF\n%d 1 0\n%s3 0 1 2\n" % (count, square)
        found[f"off {count} vertices"] = off, "promises|line 2|line 6"
        found[f"off {count} faces"] = b"OFF\n3 %d 0\n%s3 0 1 2\n" % (count, square), "line"
        found[f"off a face of {count}"] = b"OFF\n3 1 0\n%s%d 0 1 2\n" % (square, count), "line 6"
    for corner in (2**31, 2**63, 10**30, 4, -4, 0, -(2**63), -(10**30)):
        obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 %d\n" % corner
        found[f"obj corner {corner}"] = obj, "line 4"
        obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//%d\n" % (corner or 5)
        found[f"obj normal {corner}"] = obj, "line 5"
    for count in (0, 1, 3, 2**31, 2**32 - 1):
        found[f"stl {count} triangles"] = (
            bytes(80) + struct.pack("<I", count) + bytes(100),
            "stl|no",
        )
    return found


def gltf_tree(**changes: Any) -> dict[str, Any]:
    """Make a whole tree of one triangle, with some of its parts changed."""
    model = Model()
    model.node(mesh=model.mesh({"attributes": {"POSITION": model.accessor(TRIANGLE)}}))
    tree: dict[str, Any] = json.loads(model.gltf())
    for path, value in changes.items():
        *parents, last = path.split("__")
        part: Any = tree
        for key in parents:
            part = part[int(key) if isinstance(part, list) else key]
        part[int(last) if isinstance(part, list) else last] = value
    return tree


def gltf_lies() -> dict[str, tuple[bytes, str]]:
    accessor = {"componentType": 5126, "count": 3, "type": "VEC3"}
    sparse = accessor | {"bufferView": 0, "sparse": {"count": 1}}
    position = "meshes__0__primitives__0__attributes__POSITION"
    changes: dict[str, dict[str, Any]] = {
        "a count of 4": {"accessors__0__count": 4},
        "2^31 of nothing": {"accessors__0": accessor | {"count": 2**31}},
        "zeros out of nothing": {"accessors__0": accessor},
        "differences": {"accessors__0": sparse},
        "a view of 2^62 bytes": {"bufferViews__0__byteLength": 2**62},
        "a view of 40 bytes": {"bufferViews__0__byteLength": 40},
        "a hundred views of one buffer": {
            "bufferViews": [{"buffer": 0, "byteLength": 2**20} for _ in range(100)]
        },
        "a type of its own": {"accessors__0__type": "VEC9"},
        "a face beyond": {"meshes__0__primitives__0__indices": 1},
        "a circle": {"nodes__0": {"children": [0]}},
        "children that are none": {"nodes__0__children": 3},
        "meshes that are none": {"meshes": [3]},
        "a name that is none": {"buffers__0__uri": 3},
    }
    for number in (-1, 1.5, True, "0", None, 7):
        for path in ("accessors__0__bufferView", "bufferViews__0__buffer", "nodes__0__mesh"):
            changes[f"{path} {number!r}"] = {path: number}
        changes[f"position {number!r}"] = {position: number}
        changes[f"child {number!r}"] = {"nodes__0__children": [number]}
        changes[f"root {number!r}"] = {"scenes__0__nodes": [number]}
    for number in (-1, 1.5, True, "3", None, 2**31, 2**63):
        changes[f"count {number!r}"] = {"accessors__0__count": number}
        changes[f"offset {number!r}"] = {"accessors__0__byteOffset": number}
        changes[f"start {number!r}"] = {"bufferViews__0__byteOffset": number}
        changes[f"stride {number!r}"] = {"bufferViews__0__byteStride": number}
    cause = "not a valid|no vertices"
    found = {
        name: (json.dumps(gltf_tree(**change)).encode(), cause) for name, change in changes.items()
    }
    tree = glb(gltf_tree(), size=2**32 - 1)
    nested = b'{"a":' * 100_000
    return found | {"endless JSON": (tree, cause), "deep JSON": (nested, cause)}


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


def all_lies() -> list[tuple[str, bytes, str]]:
    """Format, content and the place of every lie."""
    found = [("ply", *each) for each in ply_lies().values()]
    found += [("npy", *each) for each in npy_lies().values()]
    found += [("npz", *each) for each in npz_lies().values()]
    found += [(name.split()[0], *each) for name, each in other_lies().items()]
    found += [("las", *each) for each in (*las_lies().values(), *laz_lies().values())]
    for data, cause in gltf_lies().values():
        found.append(("glb" if data.startswith(b"glTF") else "gltf", data, cause))
    return found
