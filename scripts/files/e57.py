"""E57 files, written by libE57, and damaged ones whose checksums are right."""

from __future__ import annotations

import struct
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pye57 import libe57

PAGE = 1024
_TABLE: list[int] = []


@dataclass
class Scan:
    """Values by field; those of "scaled" are stored as whole numbers of steps and an offset.

    A third number bounds these whole numbers on both sides. Limits are those of groups of fields.
    """

    values: Mapping[str, Any]
    name: str = "a scan"
    pose: tuple[Sequence[float], Sequence[float]] | None = None
    scaled: Mapping[str, Sequence[float]] = field(default_factory=dict)
    limits: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def e57(*scans: Scan, crs: str = "") -> bytes:
    """Write a file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "made.e57")
        file = libe57.ImageFile(str(path), "w")
        file.extensionsAdd("", libe57.E57_V1_0_URI)
        root = file.root()
        root.set("formatName", libe57.StringNode(file, "ASTM E57 3D Imaging Data File"))
        root.set("guid", libe57.StringNode(file, "{1}"))
        root.set("versionMajor", libe57.IntegerNode(file, 1))
        root.set("versionMinor", libe57.IntegerNode(file, 0))
        root.set("coordinateMetadata", libe57.StringNode(file, crs))
        group = libe57.VectorNode(file, True)
        root.set("data3D", group)
        for each in scans:
            _write(file, group, each)
        file.close()
        return path.read_bytes()


def _write(file: Any, group: Any, scan: Scan) -> None:
    node, prototype = libe57.StructureNode(file), libe57.StructureNode(file)
    node.set("guid", libe57.StringNode(file, "{2}"))
    node.set("name", libe57.StringNode(file, scan.name))
    if scan.pose is not None:
        node.set("pose", _pose(file, *scan.pose))
    for group_name, bounds in scan.limits.items():
        limits = libe57.StructureNode(file)
        for key, bound in bounds.items():
            limits.set(key, libe57.FloatNode(file, bound))
        node.set(group_name, limits)
    arrays = {key: np.ascontiguousarray(each) for key, each in scan.values.items()}
    for key, each in arrays.items():
        prototype.set(key, _kind(file, each.dtype, scan.scaled.get(key)))
    points = libe57.CompressedVectorNode(file, prototype, libe57.VectorNode(file, True))
    node.set("points", points)
    group.append(node)
    rows = len(next(iter(arrays.values())))
    buffers = libe57.VectorSourceDestBuffer()
    for key, each in arrays.items():
        buffers.append(libe57.SourceDestBuffer(file, key, each, max(rows, 1), True, True))
    writer = points.writer(buffers)
    if rows:
        writer.write(rows)
    writer.close()


def _pose(file: Any, rotation: Sequence[float], translation: Sequence[float]) -> Any:
    pose = libe57.StructureNode(file)
    for name, keys, values in (("rotation", "wxyz", rotation), ("translation", "xyz", translation)):
        part = libe57.StructureNode(file)
        for key, value in zip(keys, values, strict=True):
            part.set(key, libe57.FloatNode(file, float(value)))
        pose.set(name, part)
    return pose


def _kind(file: Any, dtype: np.dtype, scale: Sequence[float] | None) -> Any:
    if scale is not None:
        most = int(scale[2]) if len(scale) > 2 else 2**31 - 1
        return libe57.ScaledIntegerNode(file, 0, -most, most, *scale[:2])
    if dtype.kind == "f":
        precision = libe57.E57_SINGLE if dtype.itemsize == 4 else libe57.E57_DOUBLE
        return libe57.FloatNode(file, 0.0, precision)
    bounds = np.iinfo(dtype)
    return libe57.IntegerNode(file, 0, int(bounds.min), int(bounds.max))


def with_xml(data: bytes, before: str, after: str) -> bytes:
    """Replace a part of the description, which is at the end, by one of any length."""
    place, length = struct.unpack_from("<2Q", data, 24)
    plain = b"".join(data[k : k + PAGE - 4] for k in range(0, len(data), PAGE))
    start = place - place // PAGE * 4
    xml = plain[start : start + length].decode()
    assert before in xml
    text = xml.replace(before, after, 1).encode()
    whole = bytearray(plain[:start] + text)
    whole += bytes(-len(whole) % (PAGE - 4))
    struct.pack_into("<Q", whole, 16, len(whole) // (PAGE - 4) * PAGE)
    struct.pack_into("<Q", whole, 32, len(text))
    pages = (whole[k : k + PAGE - 4] + bytes(4) for k in range(0, len(whole), PAGE - 4))
    return with_checksums(b"".join(pages))


def with_checksums(data: bytes) -> bytes:
    """Compute the checksums of all pages anew."""
    pages = (data[k : k + PAGE - 4] for k in range(0, len(data), PAGE))
    return b"".join(page + _crc(page).to_bytes(4, "big") for page in pages)


def _crc(data: bytes) -> int:
    """CRC-32C."""
    if not _TABLE:
        for k in range(256):
            value = k
            for _ in range(8):
                value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
            _TABLE.append(value)
    found = 0xFFFFFFFF
    for byte in data:
        found = found >> 8 ^ _TABLE[(found ^ byte) & 255]
    return found ^ 0xFFFFFFFF
