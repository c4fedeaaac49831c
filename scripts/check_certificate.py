"""Check a certificate of `liftmesh verify` without liftmesh: for whoever does not take our word.

    python scripts/check_certificate.py mesh.json mesh.obj

Standard library only. Every coordinate becomes a `fractions.Fraction`, which is exact, and each
question is answered by its textbook formula; nothing is filtered, scaled or approximated. Takes
meshes of some ten thousand vertices, OBJ or PLY with coordinates x and y in double precision (what
liftmesh writes), seen from above. Exit code 0: the certificate says what is so; 1: it does not, or
it speaks of another mesh.
"""

from __future__ import annotations

import hashlib
import json
import struct
import sys
from collections import Counter
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

Point = tuple[Fraction, Fraction]
Triangle = tuple[int, int, int]
TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}
TYPES |= {"float": "f", "double": "d"}


def read_obj(data: bytes) -> tuple[list[tuple[float, float]], list[Triangle]]:
    points, triangles = [], []
    for line in data.decode().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append((float(rest[0]), float(rest[1])))
        elif word == "f":
            a, b, c = (int(corner.split("/")[0]) - 1 for corner in rest)
            triangles.append((a, b, c))
    return points, triangles


def read_ply(data: bytes) -> tuple[list[tuple[float, float]], list[Triangle]]:
    head, _, body = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    if ["format", "binary_little_endian", "1.0"] not in lines:
        sys.exit("only PLY files that are binary_little_endian; or write the mesh as OBJ")
    at = [i for i, line in enumerate(lines) if line[0] == "element"] + [len(lines)]
    vertices, faces = (lines[i:j] for i, j in pairwise(at))
    names = [line[2] for line in vertices[1:] if line[0] == "property"]
    row = struct.Struct("<" + "".join(TYPES[line[1]] for line in vertices[1:] if len(line) == 3))
    x, y = names.index("x"), names.index("y")
    end = int(vertices[0][2]) * row.size
    points = [(values[x], values[y]) for values in row.iter_unpack(body[:end])]
    corner = struct.Struct("<" + TYPES[faces[1][2]] + 3 * TYPES[faces[1][3]])
    body = body[end : end + int(faces[0][2]) * corner.size]
    return points, [(a, b, c) for _, a, b, c in corner.iter_unpack(body)]


def turn(a: Point, b: Point, c: Point) -> Fraction:
    """Positive where a, b, c turn counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def inside(a: Point, b: Point, c: Point, d: Point) -> Fraction:
    """Positive where d is inside the circle of a, b, c, which turn counter-clockwise."""
    (ax, ay), (bx, by), (cx, cy) = ((p[0] - d[0], p[1] - d[1]) for p in (a, b, c))
    return (
        (ax * ax + ay * ay) * (bx * cy - cx * by)
        + (bx * bx + by * by) * (cx * ay - ax * cy)
        + (cx * cx + cy * cy) * (ax * by - bx * ay)
    )


def inside_by_the_rule(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether d is inside once lexicographically larger points are lifted infinitely little more.

    The determinant of the lifted points is linear in each height: the largest point whose cofactor
    is not zero decides.
    """
    cofactors = {a: turn(b, c, d), b: -turn(a, c, d), c: turn(a, b, d), d: -turn(a, b, c)}
    return next(value > 0 for _, value in sorted(cofactors.items(), reverse=True) if value)


def problems(points: list[Point], triangles: list[Triangle]) -> tuple[list[str], bool, int]:
    """What is wrong, whether it is the canonical choice, and how many hull edges there are."""
    wrong = []
    if any(turn(*(points[row] for row in triangle)) <= 0 for triangle in triangles):
        wrong.append("a triangle is flat or turns clockwise")
    apex: dict[tuple[Point, Point], Point] = {}
    for triangle in triangles:
        a, b, c = (points[row] for row in triangle)
        for side, opposite in (((a, b), c), ((b, c), a), ((c, a), b)):
            if side in apex:
                wrong.append("two triangles lie on one side of an edge")
            apex[side] = opposite
    border = {a: b for a, b in apex if (b, a) not in apex}
    if border_problem := problem_of(border):
        wrong.append(border_problem)
    if {*points} != {vertex for side in apex for vertex in side}:
        wrong.append("a point is no vertex")
    signs = [(inside(a, b, c, apex[b, a]), (a, b, c, apex[b, a]))
             for (a, b), c in apex.items() if (b, a) in apex and a < b]  # fmt: skip
    if any(sign > 0 for sign, _ in signs):
        wrong.append("a circle holds the apex of a neighbour")
    canonical = not any(inside_by_the_rule(*four) for sign, four in signs if sign == 0)
    return wrong, canonical and not wrong, len(border)


def problem_of(border: dict[Point, Point]) -> str:
    """Follow the border: one curve, no turn inward or back, once round."""
    if not border:
        return "there is no border"
    curve = [start := min(border)]
    while len(curve) <= len(border) and border.get(curve[-1], start) != start:
        curve.append(border[curve[-1]])
    if len(curve) != len(border):
        return "the border is not one closed curve"
    before, after = curve[-1:] + curve[:-1], curve[1:] + curve[:1]
    turns = list(zip(before, curve, after, strict=True))
    if any(turn(a, b, c) < 0 or (turn(a, b, c) == 0 and (a < b) != (b < c)) for a, b, c in turns):
        return "the border turns inward"
    return "" if sum(a > b < c for a, b, c in turns) == 1 else "the border goes round twice"


def main(certificate_path: str, mesh_path: str) -> int:
    certificate = json.loads(Path(certificate_path).read_text("utf-8"))
    data = Path(mesh_path).read_bytes()
    floats, triangles = (read_ply if data[:3] == b"ply" else read_obj)(data)
    sums = {
        "points_sha256": b"".join(struct.pack("<dd", *point) for point in floats),
        "simplices_sha256": b"".join(struct.pack("<iii", *triangle) for triangle in triangles),
    }
    for name, content in sums.items():
        if hashlib.sha256(content).hexdigest() != certificate[name]:
            print(f"The certificate speaks of another mesh: {name} differs.")
            return 1
    points = [(Fraction(x), Fraction(y)) for x, y in floats]
    wrong, canonical, border = problems(points, triangles)
    for text, count in Counter(wrong).items():
        print(f"{text} ({count:,} times)")
    edges = (3 * len(triangles) + border) // 2
    found = {"triangles": len(triangles), "rows": len(points), "vertices": len({*points})}
    found |= {"edges": edges, "hull_edges": border}
    said = {name: certificate["counts"][name] for name in found}
    agrees = certificate["valid"] is not bool(wrong) and certificate["canonical"] is canonical
    if not agrees or (not wrong and said != found):
        print(f"The certificate is wrong: it says {said}, here it is {found}.")
        return 1
    kind = "canonical" if canonical else "valid, not canonical" if not wrong else "not valid"
    print(f"The certificate holds: {len(triangles):,} triangles, {kind}.")
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
