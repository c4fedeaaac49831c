"""Formats of text: tables of points, OBJ, OFF and STL."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from fuzz.mutator import vocabulary
from fuzz.structure.case import Case, Points, quarters, told
from fuzz.structure.parts import Chance, Part, encoded

OBJ_WORDS = vocabulary("obj")
TABLE_WORDS = vocabulary("xyz")
POSITION_NAMES = (
    ("x", "y", "z"), ("X[m]", "Y[m]", "Z[m]"), ("POINT_X", "POINT_Y", "Elev."), ("E", "N", "Höhe"),
)  # fmt: skip
TEXTS = ("oak", "2019-05-01", "low", "a.b")
OFF_WORDS = [b"OFF", b"COFF", b"NOFF", b"STOFF", b"4OFF", b"# a\n", b"OFF 1 1 1\n"]
MESH_WORDS = [b"MESH2D", b"ND", b"E3T", b"E4Q", b"NS", b"NS 1 2\n", b"E6T 1 2 3\n", b"-1"]
DXF_WORDS = [
    b"0\nSEQEND\n",
    b"0\nVERTEX\n",
    b"0\nLWPOLYLINE\n",
    b"70\n64\n",
    b"70\n128\n",
    b"71\n1\n",
    b"0\nENDSEC\n",
    b"0\nEOF\n",
    b"AutoCAD Binary DXF",
    b"42\n1\n",
]
STL_WORDS = [b"solid", b"endsolid", b"facet", b"endfacet", b"outer", b"loop", b"endloop", b"normal",
             b"vertex", b"solid a\n", b"endsolid\n", b"solid liftmesh origin 1 2 3\n", b"end ",
             b"color 1 0 0\n", b"# a\n", b"; a\n", b"\0", b"\x1a", b"-nan(ind)"]  # fmt: skip


def line(*values: object, between: bytes = b" ") -> list[Part]:
    """Make the parts of a line: its values, what separates them, and its end."""
    parts: list[Part] = []
    for value in values:
        is_real = isinstance(value, float)
        parts.append(Part(value if is_real or isinstance(value, int) else str(value).encode()))
        parts.append(Part(between))
    return [*parts[:-1], Part(b"\n")]


def table(chance: Chance) -> Case:
    """Make a table of points, with or without a header."""
    rows, more = chance.randint(1, 6), chance.choice((0, 0, 1, 3, 4))
    points, rest = quarters(chance, rows), quarters(chance, rows, more)
    between = chance.choice((b" ", b",", b";", b"\t", b"  "))
    parts: list[Part] = []
    if chance.one_in(3):
        parts += line("# a remark")
    names = {0: (), 1: ("class",), 3: ("red", "green", "blue"), 4: ("nx", "ny", "nz", "alpha")}
    words: tuple[str, ...] = ()
    if chance.one_in(2):
        words = chance.choice(((), ("name",))) if between != b"  " else ()
        parts += line(*chance.choice(POSITION_NAMES), *names[more], *words, between=between)
    else:
        points[0, 0] = np.floor(points[0, 0]) + 0.25  # else it might be an id
    for point, values in zip(points.tolist(), rest.tolist(), strict=True):
        texts = [chance.choice(TEXTS) for _ in words]
        parts += line(*point, *values, *texts, between=between)
    return told(chance.choice(("xyz", "csv")), parts, TABLE_WORDS, points, chance)


def obj(chance: Chance) -> Case:
    """Make an OBJ file with colours, normals, groups and faces in all forms."""
    rows = chance.randint(1, 6)
    points, more = quarters(chance, rows), chance.choice((0, 0, 1, 3, 4))
    rest = [[chance.randint(0, 255) / 255 for _ in range(more)] for _ in range(rows)]
    parts = line('# crs "EPSG:25832"') if chance.one_in(4) else []
    for point, values in zip(points.tolist(), rest, strict=True):
        parts += line("v", *point, *values)
    form = chance.choice(("{0}", "{0}//{0}", "{0}/{0}", "{0}/{0}/{0}", "-{0}"))
    if form.count("{0}") > 1:
        for _ in range(rows):
            parts += [*line("vn", 0.0, 0.0, 1.0), *line("vt", 0.5, 0.5)]
    for _ in range(chance.randint(0, 6)):
        parts += line(chance.choice(("g a", "o b", "usemtl c", "s off", "# d"))) * chance.one_in(3)
        size = chance.choice((3, 3, 4, 1, 7))
        parts += line("f", *(form.format(chance.randint(1, rows)) for _ in range(size)))
    return told("obj", parts, OBJ_WORDS, points, chance)


def off(chance: Chance) -> Case:
    """Make an OFF file."""
    rows, faces = chance.randint(1, 6), chance.randint(0, 6)
    points = quarters(chance, rows)
    head = chance.choice(("OFF", "COFF", "NOFF"))
    parts = line(head, rows, faces, 0) if chance.one_in(4) else [
        *line(head), *line(rows, faces, 0)]  # fmt: skip
    for point in points.tolist():
        parts += line(*point, *([0.5, 0.5, 0.5, 1.0] if head != "OFF" else []))
    size = chance.choice((3, 3, 4, 0))  # 0: faces of different sizes
    for _ in range(faces):
        corners = [chance.randrange(rows) for _ in range(size or chance.randint(0, 6))]
        parts += line(len(corners), *corners)
    return told("off", parts, OFF_WORDS, points, chance)


def mesh2d(chance: Chance) -> Case:
    """Make a 2DM file, whose nodes may be in any order."""
    rows, first = chance.randint(1, 6), chance.choice((1, 1, 7))
    points = quarters(chance, rows)
    parts = [*line("MESH2D"), *line("MESHNAME", '"a"') * chance.one_in(2)]
    for k in range(chance.randint(0, 5)):
        size = chance.choice((3, 3, 4))
        nodes = [chance.randrange(rows) + first for _ in range(size)]
        material = [chance.randint(1, 3)] * chance.randint(0, 1)
        parts += line("E3T" if size == 3 else "E4Q", k + 1, *nodes, *material)
    for k in chance.sample(range(rows), rows):
        parts += line("ND", k + first, *points[k].tolist())
    for _ in range(chance.randint(0, 2)):
        nodes = [chance.randrange(rows) + first for _ in range(chance.randint(1, 4))]
        parts += line("NS", *nodes[:-1], -nodes[-1], *[9] * chance.randint(0, 1))
    return told("2dm", parts, MESH_WORDS, points, chance)


def dxf(chance: Chance) -> Case:
    """Make a drawing of points, faces and lines, of which equal corners are one row."""
    points = quarters(chance, chance.randint(0, 3))
    parts = [*_pairs(0, "SECTION", 2, "HEADER", 0, "ENDSEC") * chance.one_in(2)]
    parts += _pairs(0, "SECTION", 2, "ENTITIES")
    for point in points.tolist():
        parts += [*_pairs(0, "POINT", 8, "a"), *_place(10, point)]
    others = quarters(chance, 0)
    for _ in range(chance.randint(0, 4)):
        kind, count = chance.choice((("3DFACE", 4), ("3DFACE", 3), ("LINE", 2), ("POLYLINE", 3)))
        corners = quarters(chance, count)
        parts += _pairs(0, kind, 8, "a", *((70, 8) if kind == "POLYLINE" else ()))
        for k, corner in enumerate(corners.tolist()):
            if kind == "POLYLINE":
                parts += [*_pairs(0, "VERTEX"), *_place(10, corner)]
            else:
                parts += _place(10 + k, corner)
        parts += _pairs(0, "SEQEND") * (kind == "POLYLINE")
        others = np.vstack([others, corners])
    parts += [*_pairs(0, "TEXT", 1, "b") * chance.one_in(3), *_pairs(0, "ENDSEC", 0, "EOF")]
    rows = np.vstack([points, welded(others)]) if len(others) else points
    if not len(rows):
        return Case("dxf", encoded(parts))
    return told("dxf", parts, DXF_WORDS, rows, chance)


def _pairs(*values: object) -> list[Part]:
    """Make the lines of codes and values."""
    return [part for value in values for part in line(value)]


def _place(code: int, point: Sequence[float]) -> list[Part]:
    return [part for k, value in enumerate(point) for part in _pairs(code + 10 * k, value)]


def ascii_stl(chance: Chance) -> Case:
    """Make an STL file as text."""
    corners = _corners(chance)
    parts = line("# a") if chance.one_in(4) else []
    parts += line("solid", chance.choice(("a", "liftmesh origin 0.0 0.0 0.0")))
    end = chance.choice(("end", "end", "end "))
    normal = chance.choice(((0.0, 0.0, 1.0), ("-nan(ind)",) * 3, ("1.#QNAN", 0.0, 0.0), ()))
    for facet in corners.tolist():
        parts += line("color", 1.0, 0.0, 0.0) * chance.one_in(4)
        parts += [*line("facet", "normal", *normal), *line("outer", "loop")]
        for corner in facet:
            parts += line("vertex", *corner)
        parts += [*line(f"{end}loop"), *line(f"{end}facet")]
        parts += line("solid", "b") * chance.one_in(8)
    parts += [*line(f"{end}solid", "a"), Part(chance.choice((b"", b"", b"\x1a", bytes(9))))]
    return told("stl", parts, STL_WORDS, welded(corners), chance)


def binary_stl(chance: Chance) -> Case:
    """Make a binary STL file."""
    corners = _corners(chance)
    head = chance.choice((b"liftmesh", b"solid a", b"liftmesh origin 0.0 0.0 0.0", b""))
    parts = [Part(head), Part(bytes(80 - len(head))), Part(len(corners), "<I")]
    for facet in corners.reshape(-1, 9).tolist():
        parts += [Part(value, "<f") for value in (0.0, 0.0, 1.0, *facet)]
        parts.append(Part(chance.choice((0, 0, 0, 31)), "<H"))
    return told("stl", parts, STL_WORDS, welded(corners), chance)


def _corners(chance: Chance) -> Points:
    return quarters(chance, 3 * chance.randint(1, 5)).reshape(-1, 3, 3)


def welded(corners: Points) -> Points:
    """Merge equal corners."""
    rows: Sequence[Sequence[float]] = sorted({*map(tuple, corners.reshape(-1, 3).tolist())})
    return np.array(rows)
