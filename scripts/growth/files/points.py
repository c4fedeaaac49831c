"""Families of PCD, PTS, XYZRGB, XYZN, files of Triangle, 2DM, DXF, and text packed with gzip.

Work grows where a header names very many fields, where scans or members are many and empty, where a
copy of LZF reaches into itself, and where decompression begins anew to go back a little.
"""

from __future__ import annotations

import gzip
import struct

import numpy as np
from growth.families import named, random
from growth.files.text import positions, table


class Compressed(bytes):
    """A file that expands to ``content`` bytes."""

    content = 0


def pcd(fields: dict[str, str], points: int, data: str, body: bytes) -> bytes:
    """Write a PCD file; each field has a type and size such as F4."""
    lines = [
        "VERSION 0.7",
        f"FIELDS {' '.join(fields)}",
        f"SIZE {' '.join(each[1:] for each in fields.values())}",
        f"TYPE {' '.join(each[0] for each in fields.values())}",
        f"WIDTH {points}",
        "HEIGHT 1",
        f"POINTS {points}",
        f"DATA {data}",
    ]
    return "\n".join([*lines, ""]).encode() + body


XYZ = {"x": "F4", "y": "F4", "z": "F4"}


def rows_of_floats(n: int) -> bytes:
    """The ordinary binary cloud."""
    return pcd(XYZ, n, "binary", random().random((n, 3)).astype("<f4").tobytes())


def pcd_as_text(n: int) -> bytes:
    """The ordinary cloud as text."""
    return pcd(XYZ, n, "ascii", positions(n).encode())


def colours_as_text(n: int) -> bytes:
    """Colours in the digits of floats."""
    return pcd({**XYZ, "rgb": "F4"}, n, "ascii", positions(n, "{} {} {} 4.2108e-38\n").encode())


def very_many_fields(n: int) -> bytes:
    """Fields of a byte each: names must not be compared with all others."""
    fields = {"x": "U1", "y": "U1", **{f"f{k}": "U1" for k in range(n)}}
    return pcd(fields, 1, "binary", bytes(n + 2))


def bytes_of_points(n: int) -> bytes:
    """Points of two bytes."""
    return pcd({"x": "U1", "y": "U1"}, n, "binary", bytes(2 * n))


def packed(data: bytes, size: int, n: int) -> bytes:
    """Compress points of two bytes to some data."""
    made = Compressed(
        pcd({"x": "U1", "y": "U1"}, n, "binary_compressed", struct.pack("<II", len(data), size))
        + data
    )
    made.content = max(size, len(made))
    return made


def literal_runs(n: int) -> bytes:
    """Bytes copied as they are, two at a time."""
    return packed(b"\x01ab" * n, 2 * n, n)


def short_copies(n: int) -> bytes:
    """Copies of three bytes, each from as far back as may be."""
    count = max(n, 1) * 2 // 3 * 2
    start = b"\x1f" + bytes(32)
    copies = b"\x20\x1f" * ((count - 32) // 3 if count > 32 else 0)
    size = 32 + 3 * (len(copies) // 2)
    return packed(start + copies + b"\x00a" * (size % 2), size + size % 2, (size + 1) // 2)


def long_copies_of_one(n: int) -> bytes:
    """Copies of 264 bytes that repeat one byte: what expands the most."""
    count = n // 132 + 1
    size = 2 + 264 * count
    return packed(b"\x01aa" + b"\xe0\xff\x00" * count, size, size // 2)


PCD = named(
    rows_of_floats,
    pcd_as_text,
    colours_as_text,
    very_many_fields,
    bytes_of_points,
    literal_runs,
    short_copies,
    long_copies_of_one,
)


def one_scan(n: int) -> bytes:
    """The ordinary scan."""
    return f"{n}\n{positions(n, '{} {} {} -5 1 2 3' + chr(10))}".encode()


def scans_of_nothing(n: int) -> bytes:
    """Scans without points, and one."""
    return b"0\n" * n + b"1\n1 2 3\n"


def scans_of_one_point(n: int) -> bytes:
    """Scans of a point each: numbers are parsed line by line."""
    return b"1\n1 2 3\n" * n


def points_without_a_count(n: int) -> bytes:
    """Points whose number no line states."""
    return positions(n).encode()


PTS = named(one_scan, scans_of_nothing, scans_of_one_point, points_without_a_count)


def coloured_points(n: int) -> bytes:
    """The ordinary cloud with colours."""
    return positions(n, "{} {} {} 0.4745098039 0.5 1\n").encode()


def digits(n: int) -> bytes:
    """Rows of twelve bytes, and comments behind them."""
    return b"1 1 1 1 1 1\n" * n + b"# a\n" * n


XYZRGB = named(coloured_points, digits)


def points_with_normals(n: int) -> bytes:
    """The ordinary cloud with normals."""
    return positions(n, "{} {} {} 0.0 0.6 0.8\n").encode()


XYZN = named(points_with_normals, digits)


def nodes(n: int) -> bytes:
    """The ordinary points, with an attribute and a marker."""
    rows = np.round(random().random((n, 2)) * 1000, 5).tolist()
    return f"{n} 2 1 1\n".encode() + b"".join(
        f"{k} {x} {y} 7.5 1\n".encode() for k, (x, y) in enumerate(rows, 1)
    )


def nodes_of_few_digits(n: int) -> bytes:
    """Rows of few bytes, and comments."""
    rows = b"".join(b"%d 0 0\n# a\n" % k for k in range(n))
    return b"%d 2 0 0\n" % n + rows


def node_attributes(n: int) -> bytes:
    """One point of very many attributes."""
    return b"1 2 %d 0\n1 0 0" % n + b" 5" * n + b"\n"


def node_blank(n: int) -> bytes:
    """Lines of nothing before the only point."""
    return b"1 2 0 0\n" + b"\n" * n + b"1 5 5\n"


NODE = named(nodes, nodes_of_few_digits, node_attributes, node_blank)


def triangles_of_nodes(n: int) -> bytes:
    """The ordinary triangles, all of the few points beside."""
    rows = b"".join(b"%d %d %d %d\n" % (k, k % 8, (k + 1) % 8, (k + 3) % 8) for k in range(n))
    return b"%d 3 0\n" % n + rows


def triangles_with_midpoints(n: int) -> bytes:
    """Triangles of six nodes, half of which are not kept."""
    return b"%d 6 0\n" % n + b"".join(b"%d 0 1 2 0 0 0\n" % k for k in range(n))


def triangle_attributes(n: int) -> bytes:
    """One triangle of very many attributes."""
    return b"1 3 %d\n0 0 1 2" % n + b" 5" * n + b"\n"


def triangle_blank(n: int) -> bytes:
    """Lines of nothing before the only triangle."""
    return b"1 3 0\n" + b"\n" * n + b"0 0 1 2\n"


ELE = named(triangles_of_nodes, triangles_with_midpoints, triangle_attributes, triangle_blank)


def segments_of_nodes(n: int) -> bytes:
    """The ordinary points, and a ring of segments around a hole."""
    ring = b"".join(b"%d %d %d 1\n" % (k, k, k % n + 1) for k in range(1, n + 1))
    return nodes(n) + b"%d 1\n" % n + ring + b"1\n1 0.5 0.5\n"


def holes_and_regions(n: int) -> bytes:
    """Very many of them, around one point."""
    rows = b"0 1 1\n" * n
    return b"1 2 0 0\n0 5 5\n0\n%d\n" % n + rows + b"%d\n" % n + b"0 1 1 1\n" * n


def stated_names(n: int) -> bytes:
    """Very many comments at the top, which would name values."""
    return b'# attribute "ab"\n' * n + b"1 2 0 0\n0 5 5\n0\n0\n"


def points_beside(n: int) -> bytes:
    """Segments between the few points beside."""
    return b"0 2 0 0\n%d 0\n" % n + b"".join(b"%d 0 1\n" % k for k in range(n)) + b"0\n"


POLY = named(segments_of_nodes, holes_and_regions, stated_names, points_beside)


def mesh_of_sms(n: int) -> bytes:
    """The ordinary mesh: a strip, with a nodestring along it."""
    places = positions(n).splitlines()
    nodes = "".join(f"ND {k} {place}\n" for k, place in enumerate(places, 1)).encode()
    faces = b"".join(
        b"E3T %d %d %d %d 1\n" % (k, k, k % n + 1, (k + 1) % n + 1) for k in range(1, n)
    )
    string = b"".join(b"NS %d\n" % k for k in range(1, n))
    return b"MESH2D\n" + faces + nodes + string + b"NS -%d\n" % n


def short_cards(n: int) -> bytes:
    """Elements and strings of one node."""
    return b"MESH2D\nND 1 1 1 1\n" + b"E3T 1 1 1 1\n" * n + b"NS -1 2\n" * n


def other_cards(n: int) -> bytes:
    """Cards that are all different, which are counted."""
    return b"MESH2D\nND 1 1 1 1\n" + b"".join(b"A%x 1\n" % k for k in range(n))


def long_string(n: int) -> bytes:
    """One line with all the nodes of a string."""
    return b"MESH2D\nND 1 1 1 1\nNS" + b" 1" * n + b" -1\n"


MESH2D = named(mesh_of_sms, short_cards, other_cards, long_string)


def _drawing(entities: bytes) -> bytes:
    return b"0\nSECTION\n2\nENTITIES\n" + entities + b"0\nENDSEC\n0\nEOF\n"


def drawn_faces(n: int) -> bytes:
    """The ordinary drawing: faces."""
    corner = "{0}{1}\n{{}}\n{2}{1}\n{{}}\n{3}{1}\n{{}}\n"
    face = "".join(corner.format(1, k, 2, 3) for k in range(4))
    rows = np.round(random().random((n, 12)) * 1000, 2).tolist()
    return _drawing("".join(f"0\n3DFACE\n{face.format(*row)}" for row in rows).encode())


def drawn_points(n: int) -> bytes:
    """Points of few bytes."""
    return _drawing(b"0\nPOINT\n10\n1\n20\n1\n" * n)


def long_polyline(n: int) -> bytes:
    """One line with very many corners, and arcs between them."""
    return _drawing(b"0\nLWPOLYLINE\n" + b"10\n1\n20\n1\n42\n1\n" * n)


def other_entities(n: int) -> bytes:
    """Entities of very many kinds, which are counted."""
    return _drawing(b"0\nPOINT\n10\n1\n20\n1\n" + b"".join(b"0\nA%x\n" % k for k in range(n)))


def endless_line(n: int) -> bytes:
    """A value that does not end: refused beyond a length."""
    return _drawing(b"0\nPOINT\n10\n1\n20\n1\n1\n" + b"a" * 30 * n + b"\n")


DXF = named(drawn_faces, drawn_points, long_polyline, other_entities, endless_line)


def zipped(data: bytes) -> bytes:
    """Compress a text."""
    made = Compressed(gzip.compress(data, mtime=0))
    made.content = max(len(data), len(made))
    return made


def gzip_table(n: int) -> bytes:
    """The ordinary table, compressed."""
    return zipped(table(n))


def gzip_members(n: int) -> bytes:
    """Very many members of nothing, and one of a point."""
    return gzip.compress(b"", mtime=0) * n + gzip.compress(b"1 2 3\n", mtime=0)


def gzip_long_lines(n: int) -> bytes:
    """Comments as long as what a reader takes at a time: it goes back by nearly as much."""
    return zipped((b"# " + b"a" * 40 * n + b"\n1 2 3\n") * 16)


GZIP = named(gzip_table, gzip_members, gzip_long_lines)
