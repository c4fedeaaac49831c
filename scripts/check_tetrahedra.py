"""What `check_certificate.py` checks of tetrahedra, and how it reads them.

It uses the standard library only. Coordinates are fractions, so each sign is exact. The boundary is
one convex surface if its facets meet in twos, the inner point is strictly inside each of them, none
is beyond its neighbour, and a ray from the inner point leaves through one facet. Then tetrahedra
that share their other facets fill it once.

Files are VTU, with all numbers in base64, compressed or not, as liftmesh, meshio and VTK write it.
"""

from __future__ import annotations

import math
import struct
import zlib
from base64 import b64decode
from fractions import Fraction
from itertools import chain
from xml.etree import ElementTree as ET

Point = tuple[Fraction, Fraction, Fraction]
Facet = tuple[Point, Point, Point]
Row = tuple[float, ...]
Cell = tuple[int, ...]
TETRAHEDRON = 10  # in VTK
CODES = {"Int32": "i", "Int64": "q", "UInt8": "B", "UInt32": "I", "UInt64": "Q", "Int8": "b"}
CODES |= {"Float32": "f", "Float64": "d"}


def read_vtu(data: bytes) -> tuple[list[Row], list[Cell]]:
    """Return the points and the tetrahedra of a VTU file of one piece."""
    tree = ET.fromstring(data)
    pieces = tree.findall("UnstructuredGrid/Piece")
    if tree.tag != "VTKFile" or len(pieces) != 1:
        raise ValueError("the file is no VTU file of one piece")
    values = [numbers(tree, each) for each in pieces[0].findall("Points/DataArray")[:1]]
    named = {each.get("Name"): each for each in pieces[0].findall("Cells/DataArray")}
    corners, ends, kinds = (numbers(tree, named[k]) for k in ("connectivity", "offsets", "types"))
    if {*kinds} - {TETRAHEDRON} or [*ends] != [*range(4, 4 * len(kinds) + 1, 4)]:
        raise ValueError("the VTU file holds other cells than tetrahedra")
    flat = values[0]
    cells = [tuple(corners[i : i + 4]) for i in range(0, len(corners), 4)]
    return [tuple(flat[i : i + 3]) for i in range(0, len(flat), 3)], cells


def numbers(tree: ET.Element, array: ET.Element) -> tuple[float, ...]:
    """Decode an array of a VTU file."""
    order = "<" if tree.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    size = struct.Struct(order + CODES[tree.get("header_type", "UInt32")])
    text = (array.text or "").strip()
    appended = tree.find("AppendedData")
    if array.get("format") == "appended" and appended is not None:
        text = (appended.text or "").strip()[1 + int(array.get("offset", "0")) :]
    elif array.get("format") != "binary":
        raise ValueError("the VTU file holds numbers as text: write them in base64")
    body = (inflated if tree.get("compressor") else plain)(text, size)
    code = CODES[array.get("type", "")]
    return struct.unpack(f"{order}{len(body) // struct.calcsize(code)}{code}", body)


def take(text: str, count: int) -> tuple[bytes, str]:
    """Decode so many bytes in base64; return them and the text after them."""
    end = -(-count // 3) * 4
    return b64decode(text[:end])[:count], text[end:]


def plain(text: str, size: struct.Struct) -> bytes:
    (length,) = size.unpack(take(text, size.size)[0])
    return take(text, size.size + length)[0][size.size :]


def inflated(text: str, size: struct.Struct) -> bytes:
    (blocks,) = size.unpack(take(text, size.size)[0])
    head, rest = take(text, (3 + blocks) * size.size)
    lengths = [length for (length,) in size.iter_unpack(head)][3:]
    packed = take(rest, sum(lengths))[0]
    parts = []
    for length in lengths:
        parts.append(zlib.decompress(packed[:length]))
        packed = packed[length:]
    return b"".join(parts)


def volume(a: Point, b: Point, c: Point, d: Point) -> Fraction:
    """Six times the signed volume: the determinant of the edges at a."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        (p[0] - a[0], p[1] - a[1], p[2] - a[2]) for p in (b, c, d)
    )
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


def judge_tetrahedra(rows: list[Row], cells: list[Cell]) -> tuple[str, dict[str, object]]:
    """Return what is wrong with tetrahedra, and what their certificate must say."""
    points = [point_of(row) for row in rows]
    counts = {"n_rows": len(rows), "n_skipped": points.count(None), "n_tetrahedra": len(cells)}
    wrong, apex = facets_of(points, cells)
    boundary = [facet for facet in apex if turned(facet) not in apex]
    wrong = wrong or problem_of_boundary(boundary, apex)
    vertices = {*chain(*apex)}
    if not wrong and vertices != {*points} - {None}:
        wrong = "a point is not a vertex"
    sides = [] if wrong else across(apex)
    if any(sign > 0 for sign, _ in sides):
        wrong = "a circumsphere contains the apex of a neighbour"
    if wrong:
        return wrong, {"valid": False, "canonical": False, "counts": counts}
    ties = sum(below_by_perturbation(weights) for sign, weights in sides if sign == 0)
    others = counts["n_skipped"] + len(vertices)
    counts |= {"n_vertices": len(vertices), "n_duplicates": len(rows) - others}
    counts |= {"n_merged": len({*chain(*cells)}) - len(vertices), "n_hull_facets": len(boundary)}
    counts["n_facets"] = (4 * len(cells) + len(boundary)) // 2
    flaws = [("not_canonical", ties)] if ties else []
    truth = {"valid": True, "canonical": not ties, "counts": counts, "flaws": flaws}
    return "", truth | {"euler_characteristic": None}


def point_of(row: Row) -> Point | None:
    x, y, z = row
    return (Fraction(x), Fraction(y), Fraction(z)) if all(map(math.isfinite, row)) else None


def facets_of(points: list[Point | None], cells: list[Cell]) -> tuple[str, dict[Facet, Point]]:
    """Return what is wrong with the tetrahedra, and the apex to the inside of each facet."""
    if not cells:
        return "there are no tetrahedra", {}
    if not all(0 <= row < len(points) for row in chain(*cells)):
        return "a corner is not a row", {}
    if any(points[row] is None for row in chain(*cells)):
        return "a corner is not finite", {}
    corners = [tuple(points[row] for row in cell) for cell in cells]
    if any(volume(*four) <= 0 for four in corners):
        return "a tetrahedron is flat or negative", {}
    apex = {least_first(facet): opposite for a, b, c, d in corners
            for facet, opposite in (((b, d, c), a), ((a, c, d), b), ((a, d, b), c), ((a, b, c), d))
            }  # fmt: skip
    single = len(apex) == 4 * len(cells)
    return "" if single else "two tetrahedra lie on the same side of a facet", apex


def least_first(facet: Facet) -> Facet:
    a, b, c = facet
    return min((a, b, c), (b, c, a), (c, a, b))


def turned(facet: Facet) -> Facet:
    a, b, c = facet
    return least_first((a, c, b))


def problem_of_boundary(boundary: list[Facet], apex: dict[Facet, Point]) -> str:
    """Check that facets, of which the inside is on the positive side, are one convex surface."""
    if not boundary:
        return "there is no boundary"
    beyond = {edge: c for a, b, c in boundary for edge, c in (((a, b), c), ((b, c), a), ((c, a), b))
              }  # fmt: skip
    if len(beyond) != 3 * len(boundary) or any((b, a) not in beyond for a, b in beyond):
        return "the facets of the boundary do not meet in twos"
    facet, fourth = next(iter(apex.items()))
    middle = tuple(sum(axis) / 4 for axis in zip(*facet, fourth, strict=True))
    if any(volume(*facet, middle) <= 0 for facet in boundary):
        return "the boundary is not convex"
    if any(volume(a, b, c, beyond[b, a]) < 0 for (a, b), c in beyond.items()):
        return "the boundary is not convex"
    target = tuple(sum(axis) / 3 for axis in zip(*boundary[0], strict=True))
    left = [  # each side of the cone has its inside there
        all(volume(middle, *side, target) >= 0 for side in ((b, a), (c, b), (a, c)))
        for a, b, c in boundary
    ]
    return "" if sum(left) == 1 else "the boundary winds around more than once"


def across(apex: dict[Facet, Point]) -> list[tuple[Fraction, dict[Point, Fraction]]]:
    """Return the side of the apex beyond each inner facet, and what the height of each counts."""
    found = []
    for (a, b, c), d in apex.items():
        e = apex.get(turned((a, b, c)))
        if e is None or (b, c) > (c, b):
            continue  # at the boundary, or seen from the other side
        weights = {a: volume(e, b, c, d), b: volume(a, e, c, d), c: volume(a, b, e, d)}
        weights |= {d: volume(a, b, c, e), e: -volume(a, b, c, d)}
        height = sum(value * sum(x * x for x in p) for p, value in weights.items())
        found.append((Fraction(height), weights))
    return found


def below_by_perturbation(weights: dict[Point, Fraction]) -> bool:
    """Whether the apex is below if lexicographically larger points are lifted a little more."""
    return next(value > 0 for _, value in sorted(weights.items(), reverse=True) if value)
