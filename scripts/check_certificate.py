"""Check a certificate of `liftmesh verify` independently, without liftmesh.

    python scripts/check_certificate.py mesh.json mesh.obj
    python scripts/check_certificate.py mesh.json mesh.obj weights.txt
    python scripts/check_certificate.py mesh.json mesh.obj constraints.txt
    python scripts/check_certificate.py mesh.json tetrahedra.vtu
    python scripts/check_certificate.py mesh.json sphere.ply

It uses the standard library only, and check_constraints.py, check_tetrahedra.py and check_sphere.py
beside it. Every
coordinate becomes a `fractions.Fraction`, which is exact, and each predicate is its textbook
formula; nothing is filtered, scaled or approximated.

Exit code 0: the certificate is true. 1: it is false, or belongs to another mesh. 2: it cannot be
checked, and a message says why. The mesh may have some ten thousand vertices; its faces are
triangles, projected along z (no other --plane). Its file is OBJ, or PLY in binary_little_endian
with the vertices first and then faces of one list each, as liftmesh writes it. For a mesh that is
not valid, the certificate must say so, name a flaw, and count rows and triangles correctly; its
list of flaws is not checked further, nor whether it is "planar". That a valid mesh is, and whether
it is "delaunay", is checked if the certificate says so: those of older versions do not.

Certificates of regular triangulations speak of weights or radii, by their SHA-256 sum. These are
the column of the PLY file that has this sum, or stand in a file of their own, one number a line.
Those of constrained triangulations speak of constraints, by theirs: the edges of the PLY file, the
lines (l) of the OBJ file, or a file of their own with two rows a line, counted from 0.

Tetrahedra are in VTU files of one piece, in base64. Triangles on the sphere are in OBJ or PLY, as
those in the plane, with z.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
import struct
import sys
from collections.abc import Iterable
from fractions import Fraction
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

from check_constraints import HalfEdge, Point, follow, problem_of_carved, turn
from check_sphere import judge_sphere
from check_tetrahedra import judge_tetrahedra, read_vtu

Row = tuple[float, float]
Triangle = tuple[int, int, int]
Columns = list[tuple[float, ...]]
Pair = tuple[int, int]
Mesh = tuple[list[tuple[float, ...]], list[Triangle], Columns, list[Pair]]  # with z, if it is there
Heights = dict[Point, Fraction]  # of the vertices, lifted
Four = tuple[Point, Point, Point, Point]
INTEGERS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}
INTEGERS |= {"int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I"}
NUMBERS = INTEGERS | {"float": "f", "float32": "f", "double": "d", "float64": "d"}
FORMAT = {"format": "liftmesh certificate"}
MEMBERS = {1: ("delaunay",), 2: ("weights", "radii", "metric", "farthest"), 3: ("constrained",)}
MEMBERS |= {4: ("delaunay",), 5: ("spherical",)}
OF_TETRAHEDRA = 4
NAMES = {"delaunay": "Delaunay", "metric": "Delaunay in the metric", "farthest": "farthest-point"}
NAMES |= {"weights": "regular by weights", "radii": "regular by radii"}
NAMES |= {"constrained": "constrained Delaunay", "spherical": "Delaunay on the sphere"}
HIDING = ("weights", "radii", "farthest")
HEIGHTS = (*HIDING, "metric")  # lifted otherwise than by x^2 + y^2
LATER = ("planar", "delaunay")  # what older certificates do not say
INDICES = ("vertex_indices", "vertex_index")


def require(condition: object, why_not: str) -> None:
    """Raise an error if the input is beyond this program."""
    if not condition:
        raise ValueError(why_not)


def read_obj(data: bytes) -> Mesh:
    rows: list[tuple[float, ...]] = []
    triangles = []
    edges: list[Pair] = []
    for number, line in enumerate(data.splitlines(), 1):
        word, *rest = line.partition(b"#")[0].split() or [b""]
        if word == b"v":
            require(len(rest) >= 2, f"line {number} is a vertex without x and y")
            rows.append(tuple(map(float, rest[:3])))
        elif word == b"f":
            require(len(rest) == 3, f"line {number} is a face of {len(rest)} vertices, not three")
            a, b, c = (row_of(text, len(rows)) for text in rest)
            triangles.append((a, b, c))
        elif word == b"l":
            edges += pairwise(row_of(text, len(rows)) for text in rest)
    require(rows, "it is no PLY file, nor an OBJ file with vertices")
    return rows, triangles, [], edges


def row_of(text: bytes, rows: int) -> int:
    """Return the row of a face's vertex: OBJ counts from 1, or back from the latest vertex."""
    number = int(text.split(b"/")[0])
    return rows + number if number < 0 else number - 1


def read_ply(data: bytes) -> Mesh:
    (vertices, faces, *more), body = read_header(data)
    x, y, row = layout_of(vertices[1:], "x", "y")
    rows, body = take(body, row, int(vertices[0][2]))
    found, body = take(body, layout_of_a_face(faces[1:]), int(faces[0][2]))
    require(all(count == 3 for count, *_ in found), "the PLY file has faces that are no triangles")
    edges = []
    if more and more[0][0][1] == "edge":
        tail, head, row = layout_of(more[0][1:], "vertex1", "vertex2", "edges")
        edges = [(each[tail], each[head]) for each in take(body, row, int(more[0][0][2]))[0]]
    names = [line[-1] for line in vertices[1:]]
    kept = (x, y, names.index("z")) if "z" in names else (x, y)
    placed = [tuple(values[i] for i in kept) for values in rows]
    return placed, [(a, b, c) for _, a, b, c in found], [*zip(*rows, strict=True)], edges


def read_header(data: bytes) -> tuple[list[list[list[str]]], bytes]:
    """Return the lines of the first three elements, and the bytes after the header."""
    found = re.match(rb"ply\r?\n(.*?\n)end_header\r?\n", data, re.DOTALL)
    require(found, "the PLY header does not end")
    lines = [line.decode("latin-1").split() for line in found[1].splitlines()]
    form = ["format", "binary_little_endian", "1.0"]
    require(form in lines, "the PLY file is not binary_little_endian: write it so, or as OBJ")
    lines = [line for line in lines if line[:1] in (["element"], ["property"])]
    at = [i for i, line in enumerate(lines) if line[0] == "element"] + [len(lines)]
    elements = [lines[i:j] for i, j in pairwise(at)][:3]
    named = [element[0][1] for element in elements[:2]]
    require(named == ["vertex", "face"], "the PLY file does not begin with vertices, then faces")
    return elements, data[found.end() :]


def take(body: bytes, row: struct.Struct, count: int) -> tuple[list[tuple[Any, ...]], bytes]:
    """Unpack that many rows; return them and the bytes after them."""
    end = count * row.size
    require(len(body) >= end, "the PLY file is cut short, or has faces that are no triangles")
    return list(row.iter_unpack(body[:end])), body[end:]


def layout_of(
    properties: list[list[str]], first: str, second: str, what: str = "vertices"
) -> tuple[int, int, struct.Struct]:
    """Return the places of two columns of vertices or edges, and the layout of a row."""
    names, types = [line[-1] for line in properties], [line[1] for line in properties]
    require({first, second} <= {*names}, f"the PLY file's {what} have no {first} and {second}")
    require({*types} <= NUMBERS.keys(), f"the PLY file's {what} hold {', '.join({*types})}")
    row = struct.Struct("<" + "".join(NUMBERS[name] for name in types))
    return names.index(first), names.index(second), row


def layout_of_a_face(properties: list[list[str]]) -> struct.Struct:
    require(
        len(properties) == 1
        and properties[0][1] == "list"
        and properties[0][-1] in INDICES
        and {*properties[0][2:4]} <= INTEGERS.keys(),
        "the PLY file's faces hold other things than one list of whole numbers, vertex_indices",
    )
    return struct.Struct("<" + INTEGERS[properties[0][2]] + 3 * INTEGERS[properties[0][3]])


def cofactors(a: Point, b: Point, c: Point, d: Point) -> dict[Point, Fraction]:
    """What the height of each point counts in the determinant of the four lifted ones.

    It is positive if the lift of d is below the plane of the other three, which are
    counter-clockwise; of points lifted to x^2 + y^2, if d is inside their circle.
    """
    return {a: turn(b, c, d), b: -turn(a, c, d), c: turn(a, b, d), d: -turn(a, b, c)}


def below(height: Heights, *four: Point) -> Fraction:
    """Positive if the lift of the fourth point is below the plane of the other three."""
    return sum((height[p] * value for p, value in cofactors(*four).items()), Fraction(0))


def below_by_perturbation(*four: Point) -> bool:
    """Whether the fourth is below if lexicographically larger points are lifted a little more.

    By an infinitesimal: the determinant is linear in each height, so the largest point whose
    cofactor is not zero decides. That of the last is not zero, as the others are counter-clockwise.
    """
    return next(value > 0 for _, value in sorted(cofactors(*four).items(), reverse=True) if value)


def lifts(claimed: dict[str, Any], rows: list[Row], values: list[float]) -> list[Any]:
    """Return the point and the height of each row; None where a number is not finite."""
    member = claimed.get("member", "delaunay")
    require(member != "radii" or not any(value < 0 for value in values), "a radius is negative")
    sign = -1 if member == "farthest" else 1
    form = [sign * entry for entry in metric_of(claimed)]
    lifted: list[tuple[Point, Fraction] | None] = []
    for (x, y), value in zip(rows, values or [0.0] * len(rows), strict=True):
        if not all(map(math.isfinite, (x, y, value))):
            lifted.append(None)
            continue
        p, q, lowered = Fraction(x), Fraction(y), Fraction(value)
        lowered = lowered**2 if member == "radii" else lowered
        lifted.append(((p, q), form[0] * p * p + 2 * form[1] * p * q + form[2] * q * q - lowered))
    return lifted


def metric_of(claimed: dict[str, Any]) -> tuple[Fraction, Fraction, Fraction]:
    """Return a, b and c of the metric a x^2 + 2 b x y + c y^2; without one, that of the plane."""
    if claimed.get("member") != "metric":
        require("metric" not in claimed, "it holds a metric, and its member is another")
        return Fraction(1), Fraction(0), Fraction(1)
    try:
        rows = claimed["metric"]
        entries = [*chain(*rows)]
        is_matrix = [*map(len, rows)] == [2, 2] and all(type(k) in (int, float) for k in entries)
        a, b, other, c = map(Fraction, entries if is_matrix else "")
    except (KeyError, TypeError, ValueError, OverflowError):
        raise ValueError("its metric is no matrix of two rows of two numbers") from None
    require(b == other, "its metric is not symmetric")
    require(a > 0 and a * c > b * b, "its metric is not positive definite")
    return a, b, c


def judge(
    lifted: list[Any],
    triangles: list[Triangle],
    member: str,
    constraints: Iterable[Pair] = (),
    carved: bool = False,
) -> tuple[str, dict[str, Any]]:
    """Return what is wrong with a mesh, and what its certificate must say."""
    points = [None if row is None else row[0] for row in lifted]
    counts = {"n_rows": len(lifted), "n_skipped": points.count(None)}
    counts["n_triangles"] = len(triangles)
    wrong, apex = half_edges_of(points, triangles)
    boundary = [(a, b) for a, b in apex if (b, a) not in apex]
    segments = [(a, b) for a, b in (sorted((points[i], points[j])) for i, j in constraints)]
    along, left = follow(segments, apex)
    others = {*points} - {None} - {*chain(*apex)} if carved else set()
    if carved:
        wrong = wrong or problem_of_carved(apex, boundary, {*points} - {None}, others, along, left)
    else:
        wrong = wrong or problem_of(boundary)
        wrong = wrong or ("a constraint is no union of edges" if left else "")
    height = {} if wrong else dict(lifted[row] for row in chain(*triangles))
    if any(lifted[row][1] != height[points[row]] for row in chain(*triangles) if height):
        wrong = "corners at one position are lifted to several heights"
    if not wrong and member not in HIDING and {*height} | others != {*points} - {None}:
        wrong = "a point is not a vertex"
    sides = [] if wrong else across(apex, height, along)
    if any(sign > 0 for sign, _ in sides):
        wrong = "a circumcircle contains the apex of a neighbour"
        wrong = (
            wrong
            if member in ("delaunay", "constrained")
            else "the lifted triangles are not convex"
        )
    hidden = 0
    if not wrong and member in HIDING:
        wrong, hidden = judge_others(lifted, triangles, apex, height)
    if wrong:
        return wrong, {"valid": False, "canonical": False, "counts": counts, "delaunay": False}
    vertices, corners = len(height), len({*chain(*triangles)})
    counts |= {"n_vertices": vertices, "n_merged": corners - vertices}
    counts["n_hull_edges"] = len(boundary)
    counts |= {} if member in ("delaunay", "constrained") else {"n_hidden": hidden}
    if member == "constrained":
        counts["n_outside"] = sum(point in others for point in points)
    ties = sum(below_by_perturbation(*four) for sign, four in sides if sign == 0)
    everywhere = across(apex, height, set())
    shape = {"planar": True, "delaunay": not any(sign > 0 for sign, _ in everywhere)}
    return "", valid(counts, ties) | shape


def judge_others(
    lifted: list[Any], triangles: list[Triangle], apex: dict[HalfEdge, Point], height: Heights
) -> tuple[str, int]:
    """Return what is wrong with rows that are no corners, and how many are hidden."""
    corners = {*chain(*triangles)}
    rest = [row for i, row in enumerate(lifted) if row is not None and i not in corners]
    hidden = 0
    at = next(iter(apex))  # a half-edge of the triangle where the last row was
    for p, z in sorted(rest):
        if p in height:
            above = z - height[p]
        else:
            at = walk(apex, at, p)
            if at not in apex:
                return "a row is outside of all triangles", 0
            above = -below({**height, p: z}, *at, apex[at], p)
        if above < 0 or (above == 0 and p not in height):
            return "a row without a vertex is not above the triangles", 0
        hidden += above > 0
    return "", hidden


def walk(apex: dict[HalfEdge, Point], at: HalfEdge, p: Point) -> HalfEdge:
    """Go on across edges that have the point on their right; past the boundary if it is outside."""
    for _ in apex:
        (a, b), c = at, apex[at]
        sides = [edge for edge in ((a, b), (b, c), (c, a)) if turn(*edge, p) < 0]
        if not sides:
            return at
        at = sides[0][::-1]
        if at not in apex:
            return at
    cells = (edge for edge, c in apex.items() if turn(*edge, c) > 0)  # ties may lead in a circle
    inside = (e for e in cells
              if all(turn(*f, p) >= 0 for f in (e, (e[1], apex[e]), (apex[e], e[0]))))  # fmt: skip
    return next(inside, (p, p))


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


def across(
    apex: dict[HalfEdge, Point], height: Heights, along: set[HalfEdge]
) -> list[tuple[Fraction, Four]]:
    """For each interior edge off constraints, return the side of a triangle and an apex."""
    inner = [(a, b) for a, b in apex if a < b and (b, a) in apex and (a, b) not in along]
    fours = [(a, b, apex[a, b], apex[b, a]) for a, b in inner]
    return [(below(height, *four), four) for four in fours]


def valid(counts: dict[str, int], ties: int) -> dict[str, Any]:
    """Return the certificate of a valid mesh in which `ties` edges are not canonical."""
    edges = (3 * counts["n_triangles"] + counts["n_hull_edges"]) // 2
    others = counts["n_skipped"] + counts["n_vertices"]
    others += counts.get("n_hidden", 0) + counts.get("n_outside", 0)
    return {
        "valid": True,
        "canonical": not ties,
        "counts": counts | {"n_edges": edges, "n_duplicates": counts["n_rows"] - others},
        "euler_characteristic": counts["n_vertices"] - edges + counts["n_triangles"],
        "flaws": [("not_canonical", ties)] if ties else [],
    }


def sums(rows: list[Any], triangles: list[Any]) -> dict[str, str]:
    corners = [*chain(*triangles)]
    small = all(-(2**31) <= corner < 2**31 for corner in corners)
    code = "i" if small else "q" if max(corners) < 2**63 else "Q"
    contents = {
        "points_sha256": struct.pack(f"<{len([*chain(*rows)])}d", *chain(*rows)),
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


def column_of(
    claimed: dict[str, Any], rows: int, columns: Iterable[tuple[float, ...]]
) -> list[float]:
    """Return the weights or radii: the column that has their sum."""
    if claimed.get("member") not in ("weights", "radii"):
        return []
    for column in columns:
        packed = struct.pack(f"<{len(column)}d", *column)
        if hashlib.sha256(packed).hexdigest() == claimed.get("values_sha256"):
            require(len(column) == rows, f"{len(column)} weights are given for {rows} rows")
            return [*column]
    raise ValueError("no column has the sum of the weights: give them in a third file")


def constraints_of(
    claimed: dict[str, Any], rows: list[Row], edges: list[Pair], columns: Columns
) -> list[Pair]:
    """Return the constraints: the edges of the mesh, or of another file, that have their sum."""
    if claimed.get("member") != "constrained":
        return []
    require(type(claimed.get("carved")) is bool, "it does not say whether regions were carved")
    for pairs in (edges, *(zip(column[::2], column[1::2], strict=False) for column in columns)):
        found = [(int(a), int(b)) for a, b in pairs if a == a // 1 and b == b // 1]
        if not all(0 <= row < len(rows) for row in chain(*found)):
            continue
        packed = struct.pack(f"<{2 * len(found)}i", *chain(*found))
        if hashlib.sha256(packed).hexdigest() == claimed.get("constraints_sha256"):
            finite = all(math.isfinite(value) for edge in found for i in edge for value in rows[i])
            require(finite, "a constraint ends at a row that is not finite")
            return found
    raise ValueError("no edges have the sum of the constraints: give them in a third file")


def check(
    claimed: dict[str, Any],
    rows: list[Row],
    triangles: list[Triangle],
    columns: Iterable[tuple[float, ...]] = (),
    edges: Iterable[Pair] = (),
) -> int:
    """Check a certificate against a mesh and print the verdict."""
    if is_other(claimed, rows, triangles):
        return 1
    lifted = lifts(claimed, rows, column_of(claimed, len(rows), columns))
    constraints = constraints_of(claimed, rows, [*edges], [*columns])
    member, carved = claimed.get("member", "delaunay"), claimed.get("carved", False)
    wrong, truth = judge(lifted, triangles, member, constraints, carved)
    truth["counts"] |= {"n_constraints": len(constraints)} if member == "constrained" else {}
    truth = {key: value for key, value in truth.items() if key in claimed or key not in LATER}
    return verdict(claimed, wrong, truth, counted(len(triangles), "triangle", "triangles"))


def check_in_space(claimed: dict[str, Any], rows: list[Any], cells: list[Any]) -> int:
    """The same of tetrahedra, or of triangles on the sphere."""
    if is_other(claimed, rows, cells):
        return 1
    is_flat = claimed.get("member") == "spherical"
    wrong, truth = (judge_sphere if is_flat else judge_tetrahedra)(rows, cells)
    names = ("triangle", "triangles") if is_flat else ("tetrahedron", "tetrahedra")
    return verdict(claimed, wrong, truth, counted(len(cells), *names))


def counted(count: int, one: str, several: str) -> str:
    return f"{count:,} {one if count == 1 else several}"


def is_other(claimed: dict[str, Any], rows: list[Any], simplices: list[Any]) -> bool:
    """Whether a certificate has other sums than the mesh; say which."""
    for name, value in sums(rows, simplices).items():
        if claimed.get(name) != value:
            print(f"The certificate speaks of another mesh: {name} differs (or --plane did).")
            return True
    return False


def verdict(claimed: dict[str, Any], wrong: str, truth: dict[str, Any], count: str) -> int:
    """Compare a certificate with the truth and print the verdict."""
    flaws = flaws_of(claimed)
    found = differences(claimed | {"flaws": flaws}, truth)
    if wrong and all(kind == "not_canonical" for kind, _ in flaws or []):
        found.append("flaws should name what is wrong")
    if found:
        print(f"The certificate is wrong: {'; '.join(found)}{wrong and f' ({wrong})'}.")
        return 1
    kind = "canonical" if truth["canonical"] else "valid, not canonical"
    kind = f"not valid: {wrong}" if wrong else kind
    print(f"The certificate holds: {count}, {name_of(claimed)}, {kind}.")
    return 0


def name_of(claimed: dict[str, Any]) -> str:
    """Return which triangulation a certificate speaks of."""
    member = claimed.get("member", "delaunay")
    return NAMES[member] + (f" {claimed['metric']}" if member == "metric" else "")


def read_certificate(path: str) -> dict[str, Any]:
    claimed = json.loads(Path(path).read_bytes())
    known = isinstance(claimed, dict) and not differences(claimed, FORMAT)
    version = claimed.get("format_version") if known else None
    of_disks = known and claimed.get("member") == "apollonius"
    require(not of_disks, "it is of a graph of disks, which no mesh file holds")
    known = type(version) is int and claimed.get("member", "delaunay") in MEMBERS.get(version, ())
    form = f"{json.dumps(FORMAT)}, version 1 or 4, or 2, 3 or 5 with its member"
    require(known, f"the certificate is not of the format {form}")
    return dict(claimed)


def main(certificate: str, mesh: str, *weights: str) -> int:
    try:
        claimed, data = read_certificate(certificate), Path(mesh).read_bytes()
        is_of_tetrahedra = claimed["format_version"] == OF_TETRAHEDRA
        if is_of_tetrahedra:
            require(b"<VTKFile" in data[:200], "tetrahedra are read from VTU files alone")
            return check_in_space(claimed, *read_vtu(data))
        rows, triangles, columns, edges = (read_ply if data[:3] == b"ply" else read_obj)(data)
        if claimed.get("member") == "spherical":
            require(all(len(row) == 3 for row in rows), "the vertices have no z")
            return check_in_space(claimed, rows, triangles)
        rows = [row[:2] for row in rows]
        for path in weights:
            columns.append(tuple(map(float, Path(path).read_text().split())))
        return check(claimed, rows, triangles, columns, edges)
    except Exception as error:  # noqa: BLE001 - no error here makes the certificate false
        text = f"{certificate} cannot be checked against {mesh}: {str(error) or repr(error)}"
        print(text, file=sys.stderr)
        return 2


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.stdout.reconfigure(errors="backslashreplace")  # as stderr does by default
    sys.exit(main(*sys.argv[1:]))
