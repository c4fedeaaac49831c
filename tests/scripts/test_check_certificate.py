"""The checker that does without liftmesh: it agrees with `verify`, and finds what is not so."""

from __future__ import annotations

import ast
import copy
import json
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import check_certificate as checker
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh

SCRIPT = Path(checker.__file__)
HEXAGON = [(4, 0), (3, 4), (-2, 4), (-5, 0), (-2, -4), (3, -4)]
EARS = [(2, 3), (-3.5, 0), (2, -3)]

# Meshes whose boundary visits points more than once.
PINCHED = {
    "five parts": (
        [(-3, 4), (4, -3), (-5, 0), (-4, -3), (3, 4), (0, -5), (5, 0)],
        [(2, 3, 4), (0, 3, 5), (5, 1, 4), (4, 0, 2), (6, 4, 1)],
    ),
    "an overlap": (
        [(2, 0), (1, 2), (-1, 2), (-2, 0), (-1, -2), (1, -2), (0, 0)],
        [(0, 2, 4), *((6, i, (i + 1) % 6) for i in range(6))],
    ),
    "a hole": (
        [*HEXAGON, *EARS],
        [
            *((c, a, ear) for a, c, ear in ((0, 2, 6), (2, 4, 7), (4, 0, 8))),
            *((a, b, ear) for a, b, ear in ((0, 1, 6), (2, 3, 7), (4, 5, 8))),
            *((b, c, ear) for b, c, ear in ((1, 2, 6), (3, 4, 7), (5, 0, 8))),
        ],
    ),
}


def said_of(points: Any, triangles: Any) -> dict[str, Any]:
    return liftmesh.verify(np.array(points, float), triangles, nonfinite="skip").as_dict()


def hold(said: dict[str, Any], points: Any, triangles: Any) -> int:
    corners = [tuple(map(int, triangle)) for triangle in triangles]
    return checker.check(said, [tuple(map(float, point)) for point in points], corners)


def obj(points: Any, triangles: Any) -> bytes:
    vertices = [f"v {float(x)!r} {float(y)!r} 0\n" for x, y in points]
    return "".join(
        vertices + ["f {} {} {}\n".format(*(i + 1 for i in t)) for t in triangles]
    ).encode()


def ply(
    *lines: str, body: bytes = b"", form: str = "binary_little_endian", end: str = "\n"
) -> bytes:
    return end.join(("ply", f"format {form} 1.0", *lines, "end_header", "")).encode() + body


def ended(tmp_path: Path, said: Any, mesh: bytes) -> int:
    (tmp_path / "said.json").write_text(said if isinstance(said, str) else json.dumps(said))
    (tmp_path / "mesh").write_bytes(mesh)
    return checker.main(str(tmp_path / "said.json"), str(tmp_path / "mesh"))


def test_it_needs_nothing_but_the_standard_library() -> None:
    own = ("check_certificate", "check_constraints", "check_sphere", "check_tetrahedra")
    trees = [ast.parse((SCRIPT.parent / f"{name}.py").read_text("utf-8")) for name in own]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    names = [node.module for node in nodes if isinstance(node, ast.ImportFrom)]
    names += [a.name for node in nodes if isinstance(node, ast.Import) for a in node.names]
    assert {str(name).partition(".")[0] for name in names} <= {*sys.stdlib_module_names, *own}


@pytest.mark.parametrize("name", PINCHED)
@pytest.mark.parametrize("canonical", [True, False])
def test_a_boundary_that_visits_a_point_twice_is_seen(
    name: str, canonical: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    points, triangles = PINCHED[name]
    honest = said_of(points, triangles)
    assert next(flaw["kind"] for flaw in honest["flaws"]) == "non_manifold_vertices"
    assert hold(honest, points, triangles) == 0
    for hull in range(3, 10):
        lie = copy.deepcopy(honest) | {"valid": True, "canonical": canonical, "flaws": []}
        edges = (3 * len(triangles) + hull) // 2
        lie["counts"] |= {"n_vertices": len(points), "n_hull_edges": hull, "n_edges": edges}
        lie["euler_characteristic"] = len(points) - edges + len(triangles)
        capsys.readouterr()
        assert hold(lie, points, triangles) == 1
        assert "the boundary visits a point more than once" in capsys.readouterr().out


SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 1), (0, 0), (np.nan, 0)]
FAN = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
OTHERWISE = [(0, 1, 2), (0, 2, 3)]  # not the canonical choice; without the point in the middle
LIES = [
    *(("valid", value) for value in (False, 1, 1.0, "no", None, [], {})),
    *(
        (name, value)
        for name in ("canonical", "planar", "delaunay")
        for value in (False, 1, "yes", None)
    ),
    *(("euler_characteristic", value) for value in (0, True, 1.0, None)),
    *(("flaws", value) for value in (None, {}, [{}], [{"kind": "not_canonical", "count": 1}], [3])),
    *(("counts", value) for value in (None, [], {}, 3)),
    *((name, "0" * 64) for name in ("points_sha256", "simplices_sha256")),
]


@pytest.mark.parametrize(("key", "value"), LIES)
def test_a_lie_of_a_canonical_mesh_is_found(key: str, value: Any) -> None:
    honest = said_of(SQUARE, FAN)
    assert (honest["counts"]["n_duplicates"], honest["counts"]["n_skipped"]) == (1, 1)
    assert hold(honest, SQUARE, FAN) == 0
    assert hold(honest | {key: value}, SQUARE, FAN) == 1


@pytest.mark.parametrize("change", [1, -1, 0.5, None])
def test_every_count_of_a_valid_mesh_is_looked_at(change: float | None) -> None:
    honest = said_of(SQUARE, FAN)
    for name, count in honest["counts"].items():
        lie = copy.deepcopy(honest)
        lie["counts"][name] = None if change is None else count + change
        assert hold(lie, SQUARE, FAN) == 1, name
        del lie["counts"][name]
        assert hold(lie, SQUARE, FAN) == 1, name


def test_lies_of_a_mesh_with_other_choices_are_found(capsys: pytest.CaptureFixture[str]) -> None:
    points = SQUARE[:4]
    honest = said_of(points, OTHERWISE)
    assert hold(honest, points, OTHERWISE) == 0
    assert (
        capsys.readouterr().out
        == "The certificate holds: 2 triangles, Delaunay, valid, not canonical.\n"
    )
    for lie in ({"flaws": []}, {"canonical": True}, {"canonical": True, "flaws": []}):
        assert hold(honest | lie, points, OTHERWISE) == 1
    for lie in ({"kind": "degenerate"}, {"count": 2}):
        assert hold(honest | {"flaws": [honest["flaws"][0] | lie]}, points, OTHERWISE) == 1


def test_lies_of_a_mesh_that_is_not_valid_are_found() -> None:
    honest = said_of(SQUARE, FAN[1:])
    assert hold(honest, SQUARE, FAN[1:]) == 0
    assert honest["valid"] is False
    only = [{"kind": "not_canonical", "count": 1}]
    lies = [{"valid": v} for v in (True, 0, None)] + [{"flaws": v} for v in ([], only, None)]
    lies.append({"delaunay": True})
    lies += [{"counts": honest["counts"] | {n: 99}} for n in ("n_rows", "n_triangles", "n_skipped")]
    for lie in lies:
        assert hold(honest | lie, SQUARE, FAN[1:]) == 1, lie


@pytest.mark.parametrize(
    ("points", "triangles"),
    [
        ([(0, 0), (1, 0), (1, 1), (2, 0), (2, 1)], [(0, 2, 0)]),
        ([(0, 0), (1, 0), (2, 0), (3, 0), (0, 1)], [(0, 1, 2), (1, 0, 3)]),
        ([(0, 0), (1, 0), (0, 1)], []),
        ([(0, 0), (1, 0), (0, 1), (np.inf, 0)], [(0, 1, 2), (1, 3, 2)]),
        ([(0, 0), (1, 0), (0, 1)], [(0, 1, -1)]),
        ([(0, 0), (1, 0), (0, 1)], [(0, 1, 3)]),
        ([(0, 0), (1, 0), (0, 1)], [(0, 1, 2**31)]),
        ([(0, 0), (1, 0), (0, 1)], np.array([(0, 1, 2**63)], dtype=np.uint64)),
    ],
)
def test_meshes_that_make_no_sense_are_told_as_such(points: Any, triangles: Any) -> None:
    honest = said_of(points, triangles)
    assert honest["valid"] is False
    assert hold(honest, points, triangles) == 0
    assert hold(honest | {"valid": True, "flaws": []}, points, triangles) == 1


RING = [(0, 0), (9, 0), (0, 9), (2, 2), (4, 2), (2, 4)]
PENTAGON = [(0, 0), (5, 0), (2, 5), (-4, 3), (-4, -3), (2, -5)]
SLIT = [(0, 0), (1, 0), (0, 3), (-3, 0), (0, -3), (2, 0)]

# Each is wrong in one way only.
WRONG = {
    "two triangles lie on the same side of an edge": (SQUARE[:5], [*FAN, *FAN]),
    "the boundary is not one closed curve": (
        RING,
        [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)],
    ),
    "the boundary winds around more than once": (
        PENTAGON,
        [(0, 1 + i, 1 + (i + 2) % 5) for i in range(5)],
    ),
    "the boundary is not convex": (SLIT, [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]),
    "a point is not a vertex": (SQUARE[:5], [(0, 1, 2), (0, 2, 3)]),
    "a circumcircle contains the apex of a neighbour": (
        [(0, 0), (2, 0), (0, 2), (1, 1.5)],
        [(0, 1, 2), (1, 3, 2)],
    ),
}


@pytest.mark.parametrize("reason", WRONG)
def test_each_kind_of_damage_is_told_by_its_name(reason: str) -> None:
    points, triangles = WRONG[reason]
    lifted = checker.lifts({}, [*points], [])
    assert checker.judge(lifted, [*triangles], "delaunay")[0] == reason
    assert hold(said_of(points, triangles), points, triangles) == 0


def test_triangles_that_share_no_rows() -> None:
    corners = [SQUARE[row] for triangle in FAN for row in triangle]
    triangles = [(row, row + 1, row + 2) for row in range(0, 12, 3)]
    honest = said_of(corners, triangles)
    assert (honest["canonical"], honest["counts"]["n_merged"]) == (True, 7)
    assert hold(honest, corners, triangles) == 0


def test_a_corner_counted_from_the_end_of_a_ply_is_no_row(tmp_path: Path) -> None:
    points, right = [(0, 0), (1, 0), (0, 1)], [(0, 1, 2)]
    lines = ("element vertex 3", "property double x", "property double y", "element face 1")
    body = struct.pack("<6dBiii", *(v for p in points for v in p), 3, 0, 1, -1)
    mesh = ply(*lines, "property list uchar int vertex_indices", body=body)
    honest = said_of(points, [(0, 1, -1)])
    assert ended(tmp_path, honest, mesh) == 0
    lie = said_of(points, right) | {"simplices_sha256": honest["simplices_sha256"]}
    assert ended(tmp_path, lie, mesh) == 1


@pytest.mark.slow
@settings(max_examples=300)
@given(
    st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=3, max_size=9),
    st.lists(
        st.tuples(st.integers(-1, 9), st.integers(0, 8), st.integers(0, 8)), min_size=0, max_size=4
    ),
    st.integers(0, 3),
)
def test_it_agrees_with_verify(
    points: list[tuple[int, int]], others: list[tuple[int, int, int]], gone: int
) -> None:
    """On whole meshes, damaged ones and heaps: what `verify` says holds, and its contrary not."""
    try:
        right = [*map(tuple, liftmesh.delaunay(points).simplices.tolist())]
    except liftmesh.DegenerateInputError:
        right = []
    for triangles in (right, right[gone:], right[gone:] + others, right[: len(right) // 2], others):
        said = said_of(points, triangles)
        assert hold(said, points, triangles) == 0
        assert hold(said | {"valid": not said["valid"]}, points, triangles) == 1
        assert hold(said | {"canonical": not said["canonical"]}, points, triangles) == 1


POINTS, TRIANGLE = [(0, 0), (1, 0), (0, 1)], [(0, 1, 2)]
VERTEX = ("element vertex 3", "property double x", "property double y")
FACE = ("element face 1", "property list uchar int vertex_indices")
BODY = struct.pack("<6dBiii", 0, 0, 1, 0, 0, 1, 3, 0, 1, 2)

TAKEN = {
    "OBJ": obj(POINTS, TRIANGLE),
    "OBJ that counts back": obj(POINTS, []) + b"f -3 -2 -1\n",
    "OBJ of more": b"# f 9\n" + obj(POINTS, []) + b"vt 0 0\nf 1/1/1 2//3 3/1 # f\r\n",
    "PLY": ply(*VERTEX, *FACE, body=BODY),
    "PLY with a header of CRLF": ply(*VERTEX, *FACE, body=BODY, end="\r\n"),
    "PLY of other names": ply(
        "comment end_header",
        "element vertex 3",
        "property uint8 red",
        "property float32 y",
        "property float x",
        "element face 1",
        "property list uint8 int32 vertex_index",
        body=struct.pack("<BffBffBffBiii", 9, 0, 0, 9, 0, 1, 9, 1, 0, 3, 0, 1, 2),
    ),
}


@pytest.mark.parametrize("name", TAKEN)
def test_files_that_are_taken(name: str, tmp_path: Path) -> None:
    assert ended(tmp_path, said_of(POINTS, TRIANGLE), TAKEN[name]) == 0


BEYOND = {
    "a quadrilateral": (obj(POINTS, []) + b"f 1 2 3 1\n", "line 4 is a face of 4 vertices"),
    "a face of two": (obj(POINTS, TRIANGLE) + b"f 1 2\n", "line 5 is a face of 2 vertices"),
    "half a vertex": (b"v 1\n", "line 1 is a vertex without x and y"),
    "a word for a number": (b"v 1 one 2\n", "could not convert"),
    "no vertices": (b"solid a\nvertex 0 0 0\n", "no PLY file, nor an OBJ file"),
    "nothing": (b"", "no PLY file, nor an OBJ file"),
    "text": (ply(*VERTEX, *FACE, form="ascii"), "not binary_little_endian"),
    "the other end": (ply(*VERTEX, *FACE, form="binary_big_endian"), "not binary_little_endian"),
    "no end": (b"ply\nformat binary_little_endian 1.0\n", "header does not end"),
    "faces first": (ply(*FACE, *VERTEX, body=BODY), "does not begin with vertices, then faces"),
    "no faces": (ply(*VERTEX, body=BODY), "does not begin with vertices, then faces"),
    "no y": (ply(*VERTEX[:2], *FACE, body=BODY), "no x and y"),
    "a list of vertices": (
        ply(*VERTEX, "property list uchar int n", *FACE, body=BODY),
        "vertices hold",
    ),
    "two lists": (ply(*VERTEX, *FACE, "property list uchar int b", body=BODY), "than one list"),
    "corners of halves": (
        ply(*VERTEX, FACE[0], "property list uchar float vertex_indices", body=BODY),
        "than one list of whole numbers",
    ),
    "lists of one": (
        ply(*VERTEX, *FACE, body=BODY[:48] + b"\1" + BODY[49:]),
        "faces that are no triangles",
    ),
    "cut short": (ply(*VERTEX, *FACE, body=BODY[:-1]), "cut short"),
    "cut between rows": (ply(*VERTEX, *FACE, body=BODY[:32]), "cut short"),
}


@pytest.mark.parametrize("name", BEYOND)
def test_what_cannot_be_checked_is_said(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh, why = BEYOND[name]
    assert ended(tmp_path, said_of(POINTS, TRIANGLE), mesh) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert "cannot be checked against" in told.err
    assert why in told.err
    assert told.err.count("\n") == 1


@pytest.mark.parametrize(
    "said",
    ["", "[]", "3", '{"format": "liftmesh certificate"}', "[" * 100_000],
)
def test_what_is_no_certificate_is_said(said: str, tmp_path: Path) -> None:
    assert ended(tmp_path, said, TAKEN["OBJ"]) == 2


def test_other_formats_and_lost_files_are_said(tmp_path: Path) -> None:
    honest = said_of(POINTS, TRIANGLE)
    for lie in ({"format": "x"}, {"format_version": 2}, {"format_version": True}):
        assert ended(tmp_path, honest | lie, TAKEN["OBJ"]) == 2
    assert ended(tmp_path, honest, TAKEN["OBJ"]) == 0
    assert checker.main(str(tmp_path / "said.json"), str(tmp_path / "none")) == 2
    assert checker.main(str(tmp_path / "none"), str(tmp_path / "mesh")) == 2


def test_a_call_of_another_form_is_told_the_right_one() -> None:
    done = subprocess.run(
        [sys.executable, "-E", "-s", SCRIPT, "one"], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert "check_certificate.py mesh.json mesh.obj" in done.stderr
