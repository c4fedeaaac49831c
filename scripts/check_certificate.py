"""Check a certificate of `liftmesh verify` independently, without liftmesh.

    python scripts/check_certificate.py mesh.json mesh.obj

It uses the standard library only. Every coordinate becomes a `fractions.Fraction`, which is exact,
and each predicate is its textbook formula; nothing is filtered, scaled or approximated.

Exit code 0: the certificate is true. 1: it is false, or belongs to another mesh. 2: it cannot be
checked, and a message says why. The mesh may have some ten thousand vertices; its faces are
triangles, projected along z (no other --plane). Its file is OBJ, or PLY in binary_little_endian
with the vertices first and then faces of one list each, as liftmesh writes it. For a mesh that is
not valid, the certificate must say so, name a flaw, and count rows and triangles correctly; its
list of flaws is not checked further.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
import struct
import sys
from fractions import Fraction
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

Row = tuple[float, float]
Triangle = tuple[int, int, int]
Mesh = tuple[list[Row], list[Triangle]]
Point = tuple[Fraction, Fraction]
HalfEdge = tuple[Point, Point]  # its triangle lies on its left
Four = tuple[Point, Point, Point, Point]
INTEGERS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}
INTEGERS |= {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"}
NUMBERS = INTEGERS | {"float": "f", "float32": "f", "double": "d", "float64": "d"}
FORMAT = {"format": "liftmesh certificate", "format_version": 1}
INDICES = ("vertex_indices", "vertex_index")


def require(condition: object, why_not: str) -> None:
    """Raise an error if the input is beyond this program."""
    if not condition:
        raise ValueError(why_not)


def read_obj(data: bytes) -> Mesh:
    rows: list[Row] = []
    triangles = []
    for number, line in enumerate(data.splitlines(), 1):
        word, *rest = line.partition(b"#")[0].split() or [b""]
        if word == b"v":
            require(len(rest) >= 2, f"line {number} is a vertex without x and y")
            rows.append((float(rest[0]), float(rest[1])))
        elif word == b"f":
            require(len(rest) == 3, f"line {number} is a face of {len(rest)} vertices, not three")
            a, b, c = (row_of(text, len(rows)) for text in rest)
            triangles.append((a, b, c))
    require(rows, "it is no PLY file, nor an OBJ file with vertices")
    return rows, triangles


def row_of(text: bytes, rows: int) -> int:
    """Return the row of a face's vertex: OBJ counts from 1, or back from the latest vertex."""
    number = int(text.split(b"/")[0])
    return rows + number if number < 0 else number - 1


def read_ply(data: bytes) -> Mesh:
    (vertices, faces), body = read_header(data)
    x, y, row = layout_of_vertices(vertices[1:])
    rows, body = take(body, row, int(vertices[0][2]))
    found, _ = take(body, layout_of_a_face(faces[1:]), int(faces[0][2]))
    require(all(count == 3 for count, *_ in found), "the PLY file has faces that are no triangles")
    return [(values[x], values[y]) for values in rows], [(a, b, c) for _, a, b, c in found]


def read_header(data: bytes) -> tuple[list[list[list[str]]], bytes]:
    """Return the lines of the first two elements, and the bytes after the header."""
    found = re.match(rb"ply\r?\n(.*?\n)end_header\r?\n", data, re.DOTALL)
    require(found, "the PLY header does not end")
    lines = [line.decode("latin-1").split() for line in found[1].splitlines()]
    form = ["format", "binary_little_endian", "1.0"]
    require(form in lines, "the PLY file is not binary_little_endian: write it so, or as OBJ")
    lines = [line for line in lines if line[:1] in (["element"], ["property"])]
    at = [i for i, line in enumerate(lines) if line[0] == "element"] + [len(lines)]
    elements = [lines[i:j] for i, j in pairwise(at)][:2]
    named = [element[0][1] for element in elements]
    require(named == ["vertex", "face"], "the PLY file does not begin with vertices, then faces")
    return elements, data[found.end() :]


def take(body: bytes, row: struct.Struct, count: int) -> tuple[list[tuple[Any, ...]], bytes]:
    """Unpack that many rows; return them and the bytes after them."""
    end = count * row.size
    require(len(body) >= end, "the PLY file is cut short, or has faces that are no triangles")
    return list(row.iter_unpack(body[:end])), body[end:]


def layout_of_vertices(properties: list[list[str]]) -> tuple[int, int, struct.Struct]:
    names, types = [line[-1] for line in properties], [line[1] for line in properties]
    require({"x", "y"} <= {*names}, "the PLY file's vertices have no x and y")
    require({*types} <= NUMBERS.keys(), f"the PLY file's vertices hold {', '.join({*types})}")
    row = struct.Struct("<" + "".join(NUMBERS[name] for name in types))
    return names.index("x"), names.index("y"), row


def layout_of_a_face(properties: list[list[str]]) -> struct.Struct:
    require(
        len(properties) == 1
        and properties[0][1] == "list"
        and properties[0][-1] in INDICES
        and {*properties[0][2:4]} <= INTEGERS.keys(),
        "the PLY file's faces hold other things than one list of whole numbers, vertex_indices",
    )
    return struct.Struct("<" + INTEGERS[properties[0][2]] + 3 * INTEGERS[properties[0][3]])


def turn(a: Point, b: Point, c: Point) -> Fraction:
    """Positive if a, b, c are counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def inside(a: Point, b: Point, c: Point, d: Point) -> Fraction:
    """Positive if d is inside the circumcircle of a, b, c, which are counter-clockwise."""
    (ax, ay), (bx, by), (cx, cy) = ((p[0] - d[0], p[1] - d[1]) for p in (a, b, c))
    return (
        (ax * ax + ay * ay) * (bx * cy - cx * by)
        + (bx * bx + by * by) * (cx * ay - ax * cy)
        + (cx * cx + cy * cy) * (ax * by - bx * ay)
    )


def inside_by_perturbation(a: Point, b: Point, c: Point, d: Point) -> bool:
    """Whether d is inside if lexicographically larger points are lifted by an infinitesimal more.

    The determinant of the lifted points is linear in each height: the largest point whose cofactor
    is not zero decides. That of d is not zero, as a, b, c are counter-clockwise.
    """
    cofactors = {a: turn(b, c, d), b: -turn(a, c, d), c: turn(a, b, d), d: -turn(a, b, c)}
    return next(value > 0 for _, value in sorted(cofactors.items(), reverse=True) if value)


def judge(rows: list[Row], triangles: list[Triangle]) -> tuple[str, dict[str, Any]]:
    """Return what is wrong with a mesh, and what its certificate must say."""
    points = [(Fraction(x), Fraction(y)) if math.isfinite(x) and math.isfinite(y) else None
              for x, y in rows]  # fmt: skip
    counts = {"rows": len(rows), "skipped": points.count(None), "triangles": len(triangles)}
    wrong, apex = half_edges_of(points, triangles)
    boundary = [(a, b) for a, b in apex if (b, a) not in apex]
    wrong = wrong or problem_of(boundary)
    if not wrong and {a for a, _ in apex} != {*points} - {None}:
        wrong = "a point is not a vertex"
    circles = [] if wrong else across(apex)
    if any(sign > 0 for sign, _ in circles):
        wrong = "a circumcircle contains the apex of a neighbour"
    if wrong:
        return wrong, {"valid": False, "canonical": False, "counts": counts}
    vertices, corners = len({*points} - {None}), len({*chain(*triangles)})
    counts |= {"vertices": vertices, "merged": corners - vertices, "hull_edges": len(boundary)}
    return "", valid(
        counts, sum(inside_by_perturbation(*four) for sign, four in circles if sign == 0)
    )


def half_edges_of(
    points: list[Point | None], triangles: list[Triangle]
) -> tuple[str, dict[HalfEdge, Point]]:
    """Return what is wrong with the triangles, and the apex to the left of each half-edge."""
    if not all(0 <= row < len(points) for row in chain(*triangles)):
        return "a corner is not a row", {}
    if any(points[row] is None for row in chain(*triangles)):
        return "a corner is not finite", {}
    cells = [tuple(points[row] for row in triangle) for triangle in triangles]
    if any(turn(*cell) <= 0 for cell in cells):
        return "a triangle is degenerate or clockwise", {}
    apex = {edge: opposite for a, b, c in cells
            for edge, opposite in (((a, b), c), ((b, c), a), ((c, a), b))}  # fmt: skip
    single = len(apex) == 3 * len(cells)
    return "" if single else "two triangles lie on the same side of an edge", apex


def problem_of(edges: list[HalfEdge]) -> str:
    """Check that the boundary is one convex curve that winds around once."""
    boundary = dict(edges)
    if not boundary:
        return "there is no boundary"
    if len(boundary) != len(edges):
        return "the boundary visits a point more than once"
    curve = [start := min(boundary)]
    while len(curve) <= len(boundary) and boundary.get(curve[-1], start) != start:
        curve.append(boundary[curve[-1]])
    if len(curve) != len(boundary):
        return "the boundary is not one closed curve"
    before, after = curve[-1:] + curve[:-1], curve[1:] + curve[:1]
    turns = list(zip(before, curve, after, strict=True))
    if any(turn(a, b, c) < 0 or (turn(a, b, c) == 0 and (a < b) != (b < c)) for a, b, c in turns):
        return "the boundary is not convex"
    windings = sum(a > b < c for a, b, c in turns)
    return "" if windings == 1 else "the boundary winds around more than once"


def across(apex: dict[HalfEdge, Point]) -> list[tuple[Fraction, Four]]:
    """For each interior edge, return the in-circle sign and its points: a triangle and an apex."""
    fours = [(a, b, c, apex[b, a]) for (a, b), c in apex.items() if a < b and (b, a) in apex]
    return [(inside(*four), four) for four in fours]


def valid(counts: dict[str, int], ties: int) -> dict[str, Any]:
    """Return the certificate of a valid mesh in which `ties` edges are not canonical."""
    edges = (3 * counts["triangles"] + counts["hull_edges"]) // 2
    duplicates = counts["rows"] - counts["skipped"] - counts["vertices"]
    return {
        "valid": True,
        "canonical": not ties,
        "counts": counts | {"edges": edges, "duplicates": duplicates},
        "euler_characteristic": counts["vertices"] - edges + counts["triangles"],
        "flaws": [("not_canonical", ties)] if ties else [],
    }


def sums(rows: list[Row], triangles: list[Triangle]) -> dict[str, str]:
    corners = [*chain(*triangles)]
    small = all(-(2**31) <= corner < 2**31 for corner in corners)
    code = "i" if small else "q" if max(corners) < 2**63 else "Q"
    contents = {
        "points_sha256": struct.pack(f"<{2 * len(rows)}d", *chain(*rows)),
        "simplices_sha256": struct.pack(f"<{len(corners)}{code}", *corners),
    }
    return {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}


def differences(claimed: Any, truth: Any, name: str = "it") -> list[str]:
    """Compare a certificate with the truth, strictly: 1 is not true, and 1.0 is not 1."""
    if isinstance(truth, dict) and isinstance(claimed, dict):
        return [
            found
            for key, value in truth.items()
            for found in differences(claimed.get(key), value, key)
        ]
    one, other = json.dumps(claimed), json.dumps(truth)
    return [] if one == other else [f"{name} is {one[:80]}, and should be {other}"]


def flaws_of(claimed: dict[str, Any]) -> list[tuple[Any, Any]] | None:
    """Return kinds and counts of flaws, or None if there is no list of flaws."""
    flaws = claimed.get("flaws")
    if not isinstance(flaws, list) or not all(isinstance(flaw, dict) for flaw in flaws):
        return None
    return [(flaw.get("kind"), flaw.get("count")) for flaw in flaws]


def check(claimed: dict[str, Any], rows: list[Row], triangles: list[Triangle]) -> int:
    """Check a certificate against a mesh and print the verdict."""
    for name, value in sums(rows, triangles).items():
        if claimed.get(name) != value:
            print(f"The certificate speaks of another mesh: {name} differs (or --plane did).")
            return 1
    wrong, truth = judge(rows, triangles)
    flaws = flaws_of(claimed)
    found = differences(claimed | {"flaws": flaws}, truth)
    if wrong and all(kind == "not_canonical" for kind, _ in flaws or []):
        found.append("flaws should name what is wrong")
    if found:
        print(f"The certificate is wrong: {'; '.join(found)}{wrong and f' ({wrong})'}.")
        return 1
    kind = "canonical" if truth["canonical"] else "valid, not canonical"
    count = f"{len(triangles):,} triangle{'' if len(triangles) == 1 else 's'}"
    print(f"The certificate holds: {count}, {f'not valid: {wrong}' if wrong else kind}.")
    return 0


def read_certificate(path: str) -> dict[str, Any]:
    claimed = json.loads(Path(path).read_bytes())
    known = isinstance(claimed, dict) and not differences(claimed, FORMAT)
    require(known, f"the certificate is not of the format {json.dumps(FORMAT)}")
    return dict(claimed)


def main(certificate: str, mesh: str) -> int:
    try:
        claimed, data = read_certificate(certificate), Path(mesh).read_bytes()
        return check(claimed, *(read_ply if data[:3] == b"ply" else read_obj)(data))
    except Exception as error:  # noqa: BLE001 - no error here makes the certificate false
        text = f"{certificate} cannot be checked against {mesh}: {str(error) or repr(error)}"
        print(text, file=sys.stderr)
        return 2


if __name__ == "__main__":
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.stdout.reconfigure(errors="backslashreplace")  # as stderr does by default
    sys.exit(main(*sys.argv[1:]))
