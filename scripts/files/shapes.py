"""GeoPackages and shapefiles, written by hand: as little as makes one."""

from __future__ import annotations

import sqlite3
import struct
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

Corners = Sequence[Sequence[float]]
_TABLES = """
PRAGMA page_size = 512;
PRAGMA synchronous = OFF;
PRAGMA journal_mode = OFF;
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER PRIMARY KEY, organization TEXT,
 organization_coordsys_id INTEGER, definition TEXT, description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT, data_type TEXT, srs_id INTEGER);
CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT, geometry_type_name TEXT,
 srs_id INTEGER, z TINYINT, m TINYINT);
INSERT INTO gpkg_spatial_ref_sys VALUES ('', 0, 'NONE', 0, 'undefined', '');
INSERT INTO gpkg_spatial_ref_sys VALUES ('', 25832, 'EPSG', 25832, '', '');
"""
_HEAD = b"GP\0\1" + struct.pack("<i", 0)


def point(*place: float) -> bytes:
    """Return a point as WKB."""
    return struct.pack(f"<BI{len(place)}d", 1, 1 + 1000 * (len(place) == 3), *place)


def multipoint(places: Corners) -> bytes:
    """Return points as one geometry."""
    return struct.pack("<BII", 1, 1004, len(places)) + b"".join(point(*each) for each in places)


def surface(patches: Iterable[Corners], kind: int = 1016) -> bytes:
    """Return polygons, which are not closed yet, as a TIN or a PolyhedralSurface (1015)."""
    parts = []
    for each in patches:
        closed = np.array([*each, each[0]], np.float64)
        head = struct.pack("<BIII", 1, {1016: 1017, 1015: 1003}[kind], 1, len(closed))
        parts.append(head + closed.tobytes())
    return struct.pack("<BII", 1, kind, len(parts)) + b"".join(parts)


def geopackage(
    shapes: Sequence[bytes | None],
    columns: Mapping[str, Sequence[Any]] | None = None,
    *,
    srs: int = 0,
    layers: Sequence[str] = ("a",),
) -> bytes:
    """Make a GeoPackage, whose layers all have these shapes and columns."""
    columns = columns or {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.gpkg")
        with closing(sqlite3.connect(path)) as connection:
            connection.executescript(_TABLES)
            for layer in layers:
                _add(connection, layer, shapes, columns, srs)
            connection.commit()
        return path.read_bytes()


def _add(
    connection: sqlite3.Connection,
    layer: str,
    shapes: Sequence[bytes | None],
    columns: Mapping[str, Sequence[Any]],
    srs: int,
) -> None:
    names = ["geom", *columns]
    quoted = ", ".join('"' + each.replace('"', '""') + '"' for each in names)
    connection.execute(f'CREATE TABLE "{layer}" (fid INTEGER PRIMARY KEY, {quoted})')
    connection.execute("INSERT INTO gpkg_contents VALUES (?, 'features', ?)", (layer, srs))
    values = (layer, "geom", "GEOMETRY", srs, 1, 0)
    connection.execute("INSERT INTO gpkg_geometry_columns VALUES (?, ?, ?, ?, ?, ?)", values)
    held = [None if each is None else _HEAD + each for each in shapes]
    marks = ", ".join("?" for _ in names)
    rows = zip(held, *columns.values(), strict=True)
    connection.executemany(f'INSERT INTO "{layer}" ({quoted}) VALUES ({marks})', rows)


def shp(kind: int, records: Sequence[bytes | None]) -> bytes:
    """Make a shapefile of one type of shapes; None is a record without one."""
    parts = []
    for number, each in enumerate(records, 1):
        content = struct.pack("<i", 0) if each is None else struct.pack("<i", kind) + each
        parts.append(struct.pack(">2i", number, len(content) // 2) + content)
    body = b"".join(parts)
    head = struct.pack(">i20xi", 9994, (100 + len(body)) // 2) + struct.pack("<2i64x", 1000, kind)
    return head + body


def shp_points(places: Corners) -> bytes:
    """Make a shapefile of points with heights."""
    return shp(11, [struct.pack("<4d", *each, 0) for each in places])


def shp_patches(parts: Sequence[tuple[int, Corners]]) -> bytes:
    """Return the record of a surface, of parts of some kinds."""
    corners = np.array([each for _, part in parts for each in part], np.float64).reshape(-1, 3)
    sizes = [len(part) for _, part in parts]
    begins = np.cumsum([0, *sizes[:-1]])
    head = struct.pack("<4d2I", 0, 0, 0, 0, len(parts), len(corners))
    kinds = np.array([kind for kind, _ in parts], "<u4")
    body = begins.astype("<u4").tobytes() + kinds.tobytes() + corners[:, :2].tobytes()
    return head + body + struct.pack("<2d", 0, 0) + corners[:, 2].tobytes()


def dbf(columns: Mapping[str, tuple[str, int, Sequence[str]]], rows: int) -> bytes:
    """Make the values of a shapefile: for each name a kind, a width and texts."""
    fields = b"".join(
        struct.pack("<11sc4xB15x", name.encode(), kind.encode(), width)
        for name, (kind, width, _) in columns.items()
    )
    size = 1 + sum(width for _, width, _ in columns.values())
    head = struct.pack("<4xI2H20x", rows, 33 + len(fields), size)
    texts = (
        b" " + b"".join(held[k].encode().ljust(width) for _, width, held in columns.values())
        for k in range(rows)
    )
    return head + fields + b"\r" + b"".join(texts)
