"""Formats of points: PCD, PTS, XYZRGB, XYZN, .node, .ele and .poly."""

from __future__ import annotations

import gzip

import numpy as np
from files import PLACE
from fuzz.structure.case import Case, in_order, quarters, told
from fuzz.structure.parts import Chance, Part
from fuzz.structure.text import line

from liftmesh import read

PCD_WORDS = [b"VERSION .5\n", b"FIELDS", b"SIZE", b"TYPE", b"COUNT", b"HEIGHT 2\n", b"POINTS",
             b"DATA ascii\n", b"DATA binary\n", b"DATA binary_compressed\n", b"rgb", b"rgba", b"_",
             b"VIEWPOINT 1 2 3 1 0 0 0\n", b"F", b"U", b"I", b"normal_x"]  # fmt: skip
COUNTED_WORDS = [b"0\n", b"1\n1 2 3\n", b"# a\n", b"-5", b"255 255 255"]


def pcd(chance: Chance) -> Case:
    """Make a PCD file: text, binary, or compressed in runs of bytes."""
    points = quarters(chance, chance.randint(1, 6))
    kind = chance.choice(("ascii", "binary", "binary_compressed"))
    more = chance.choice(((), ("rgb",), ("rgba",), ("normal_x", "normal_y", "normal_z"), ("_",)))
    names = ("x", "y", "z", *more)
    sizes = [chance.choice((4, 8)) for _ in "xyz"] + [4] * len(more)
    parts = [Part(b"# .PCD v0.7\n"), *line("VERSION", "0.7"), *line("FIELDS", *names)]
    parts += [*line("SIZE", *sizes), *line("TYPE", *("F" * len(names)))]
    parts += line("COUNT", *(1 for _ in names)) * chance.one_in(2)
    parts += [*line("WIDTH", len(points)), *line("HEIGHT", 1)]
    parts += line("VIEWPOINT", *(0, 0, 0, 1, 0, 0, 0)) * chance.one_in(2)
    parts += [*line("POINTS", len(points)), *line("DATA", kind)]
    rows = [[*point, *(0.5 for _ in more)] for point in points.tolist()]
    if kind == "ascii":
        for row in rows:
            parts += line(*row)
    elif kind == "binary":
        forms = [f"<{'f' if size == 4 else 'd'}" for size in sizes]
        parts += [Part(v, form) for row in rows for v, form in zip(row, forms, strict=True)]
    else:
        parts += _compressed(np.array(rows), sizes)
    return told("pcd", parts, PCD_WORDS, points, chance)


def _compressed(rows: np.ndarray, sizes: list[int]) -> list[Part]:
    columns = zip(rows.T, sizes, strict=True)
    data = b"".join(column.astype(f"<f{size}").tobytes() for column, size in columns)
    runs = [data[k : k + 32] for k in range(0, len(data), 32)]
    size = len(data) + len(runs)
    parts = [Part(size, "<I"), Part(len(data), "<I")]
    for run in runs:
        parts += [Part(len(run) - 1, "<B"), Part(run)]
    return parts


def pts(chance: Chance) -> Case:
    """Make a PTS file of one scan or two."""
    more = chance.choice((0, 1, 3, 4))
    parts: list[Part] = []
    points = quarters(chance, 0)
    for _ in range(chance.randint(1, 2)):
        some = quarters(chance, chance.randint(1, 5))
        parts += line(len(some))
        for point in some.tolist():
            parts += line(*point, *(chance.randint(0, 255) for _ in range(more)))
        points = np.vstack([points, some])
    return told("pts", parts, COUNTED_WORDS, points, chance)


def xyzrgb(chance: Chance) -> Case:
    """Make an XYZRGB file, or an XYZN file."""
    points = quarters(chance, chance.randint(1, 6))
    parts = line("# a") * chance.one_in(4)
    for point in points.tolist():
        parts += line(*point, *(chance.randint(0, 255) / 255 for _ in range(3)))
    return told(chance.choice(("xyzrgb", "xyzn")), parts, COUNTED_WORDS, points, chance)


def node(chance: Chance) -> Case:
    """Make a .node file."""
    points, first = quarters(chance, chance.randint(1, 6)), chance.randint(0, 1)
    more, markers = chance.choice((0, 0, 1, 2)), chance.randint(0, 1)
    parts = line("# a") * chance.one_in(4) + line(len(points), 3, more, markers)
    for k, point in enumerate(points.tolist()):
        parts += line(k + first, *point, *(0.5 for _ in range(more)), *(1 for _ in range(markers)))
    return told("node", parts, COUNTED_WORDS, points, chance)


def ele(chance: Chance) -> Case:
    """Make an .ele file, of which the points are always the same."""
    points = read(PLACE.with_suffix(".node")).points
    count, more = chance.randint(0, 6), chance.choice((0, 0, 1, 2))
    corners = chance.choice((3, 3, 6))
    parts = line("# a") * chance.one_in(4) + line(count, corners, more)
    for k in range(count):
        nodes = chance.sample(range(len(points)), corners)
        parts += line(k, *nodes, *(0.5 for _ in range(more)))
    return told("ele", parts, COUNTED_WORDS, points, chance)


def poly(chance: Chance) -> Case:
    """Make a .poly file, whose points may be beside it."""
    points, first = quarters(chance, chance.randint(1, 6)), chance.randint(0, 1)
    points[:, 2] = 0
    more, markers = chance.choice((0, 0, 1, 2)), chance.randint(0, 1)
    own = 0 if chance.one_in(4) else len(points)
    parts = line('# attribute "a"') * chance.one_in(4) + line(own, 2, more, markers)
    for k, point in enumerate(points[:own, :2].tolist()):
        parts += line(k + first, *point, *(0.5 for _ in range(more)), *(1 for _ in range(markers)))
    if not own:
        points, first = read(PLACE.with_suffix(".node")).points, 0
    segments = chance.randint(0, 4)
    parts += line(segments, markers)
    for k in range(segments):
        ends = (chance.randrange(len(points)) + first for _ in range(2))
        parts += line(k, *ends, *(1 for _ in range(markers)))
    for width in (2, chance.choice((3, 4))):
        count = chance.randint(0, 2)
        parts += line(count)
        for k in range(count):
            parts += line(k, *(0.25 for _ in range(width)))
    words = [*COUNTED_WORDS, b"# heights\n", b'# attribute "b"\n']
    return told("poly", parts, words, points, chance)


def compressed(chance: Chance) -> Case:
    """Compress a table, damage some of it, and cut it off or repeat it."""
    points = quarters(chance, chance.randint(1, 40))
    text = b"".join(b"%r %r %r\n" % tuple(point) for point in points.tolist())
    data = gzip.compress(text, mtime=0)
    if chance.one_in(4):
        return Case("xyz", data, in_order(points), content=len(text))
    place = chance.randrange(len(data))
    damaged = data[:place] + bytes([chance.randrange(256)]) + data[place + 1 :]
    return Case("xyz", chance.choice((data[:place], damaged, data + data[:place], damaged * 2)))
