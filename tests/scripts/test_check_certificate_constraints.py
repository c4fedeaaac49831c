"""The checker that does without liftmesh, on constrained triangulations, whole and carved."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import check_certificate as checker
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import _kernel

SQUARE = [(0, 0), (6, 0), (6, 6), (0, 6)]
HOLE = [(2, 2), (4, 2), (4, 4), (2, 4)]
POINTS = [*SQUARE, *HOLE, (2.5, 3.5), (9, 9), (6, 6)]
CARVED = liftmesh.constrained_delaunay(POINTS, polygons=[[SQUARE, HOLE]], carve="holes")
EDGES = [*map(tuple, CARVED.constraints.tolist())]
TRIANGLES = [tuple(triangle) for triangle in CARVED.simplices.tolist()]


def said_of(points: Any, triangles: Any, edges: Any, carved: bool) -> dict[str, Any]:
    constraints = np.array(edges, dtype=np.int32).reshape(-1, 2)
    corners = np.array(triangles, dtype=np.int32).reshape(-1, 3)
    rows = np.array(points, dtype=np.float64)
    return liftmesh.verify(rows, corners, constraints=constraints, carved=carved).as_dict()


def hold(said: dict[str, Any], points: Any, triangles: Any, edges: Any) -> int:
    rows = [tuple(map(float, point)) for point in points]
    return checker.check(said, rows, [*triangles], (), [*edges])


CORNERS = st.tuples(st.integers(0, 4), st.integers(0, 4))


@pytest.mark.slow
@settings(max_examples=60)
@given(st.data())
def test_it_agrees_with_verify(data: st.DataObject) -> None:
    points = data.draw(st.lists(CORNERS, min_size=3, max_size=9))
    row = st.integers(0, len(points) - 1)
    edges = data.draw(st.lists(st.tuples(row, row), max_size=5))
    rows, pairs = np.array(points, float), np.array(edges, np.int32).reshape(-1, 2)
    outcome, marks, *_ = _kernel.constrained(rows, pairs, False, 1, False, None)
    regions = _kernel.label_regions(outcome[4], marks)
    left = data.draw(st.sets(st.sampled_from([*range(regions.max(initial=0) + 1)])))
    corners = outcome[3][np.isin(regions, [*left])]
    triangles = [tuple(map(int, triangle)) for triangle in corners]
    for carved in (False, True):
        for constraints in (edges, edges[1:]):
            said = said_of(points, triangles, constraints, carved)
            assert hold(said, points, triangles, constraints) == 0, said


def test_what_is_carved_holds_and_lies_are_found(capsys: pytest.CaptureFixture[str]) -> None:
    said = said_of(POINTS, TRIANGLES, EDGES, carved=True)
    assert said["canonical"]
    assert hold(said, POINTS, TRIANGLES, EDGES) == 0
    assert "constrained Delaunay, canonical" in capsys.readouterr().out
    lies = [said | {"carved": False}, said | {"valid": False}, said | {"euler_characteristic": 1}]
    for name in ("n_outside", "n_constraints", "n_duplicates", "n_hull_edges"):
        counts = said["counts"]
        lies.append(said | {"counts": counts | {name: counts[name] + 1}})
    for lie in lies:
        assert hold(lie, POINTS, TRIANGLES, EDGES) == 1


def test_what_is_planar_or_delaunay_is_looked_at() -> None:
    kite, faces = [(0, 0), (4, -1), (8, 0), (4, 1)], [(0, 1, 2), (0, 2, 3)]
    for points, triangles, edges, is_delaunay in (
        (POINTS, TRIANGLES, EDGES, True),
        (kite, faces, [(0, 2)], False),
    ):
        said = said_of(points, triangles, edges, carved=points is POINTS)
        assert (said["planar"], said["delaunay"]) == (True, is_delaunay)
        assert hold(said, points, triangles, edges) == 0
        for lie in ({"planar": False}, {"delaunay": not is_delaunay}):
            assert hold(said | lie, points, triangles, edges) == 1, lie
        older = {key: value for key, value in said.items() if key not in ("planar", "delaunay")}
        assert hold(older, points, triangles, edges) == 0


WRONG = {
    "a triangle less": (TRIANGLES[1:], EDGES),
    "an edge of the boundary off all constraints": (TRIANGLES, [e for e in EDGES if e != (1, 2)]),
    "a constraint through triangles": (TRIANGLES, [*EDGES, (0, 8)]),
    "an overlap": ([*TRIANGLES, (0, 1, 8)], [*EDGES, (1, 8), (0, 8)]),
    "a triangle twice": ([*TRIANGLES, TRIANGLES[0]], EDGES),
    "nothing": ([], EDGES),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_found_if_the_certificate_denies_it(name: str) -> None:
    triangles, edges = WRONG[name]
    said = said_of(POINTS, triangles, edges, carved=True)
    assert not said["valid"]
    assert hold(said, POINTS, triangles, edges) == 0
    right = said_of(POINTS, TRIANGLES, EDGES, carved=True)
    sums = {key: said[key] for key in said if key.endswith("sha256")}
    assert hold(right | sums, POINTS, triangles, edges) == 1


def files() -> dict[str, bytes]:
    """The carved square, with its constraints, in the forms that are read."""
    vertices = "".join(f"v {x} {y} 0\n" for x, y in POINTS)
    faces = "".join("f {} {} {}\n".format(*(i + 1 for i in t)) for t in TRIANGLES)
    lines = "".join(f"l {a + 1} {b + 1}\n" for a, b in EDGES)
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(POINTS)}\n"
        "property double x\nproperty double y\n"
        f"element face {len(TRIANGLES)}\nproperty list uchar int vertex_indices\n"
        f"element edge {len(EDGES)}\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    )
    body = [struct.pack("<2d", *point) for point in POINTS]
    body += [struct.pack("<B3i", 3, *triangle) for triangle in TRIANGLES]
    body += [struct.pack("<2i", *edge) for edge in EDGES]
    return {
        "obj": (vertices + faces + lines).encode(),
        "ply": header.encode() + b"".join(body),
        "bare": (vertices + faces).encode(),
        "edges": "\n".join(f"{a} {b}" for a, b in EDGES).encode(),
        "others": "\n".join(f"{a} {b + 0.5}" for a, b in EDGES).encode(),
        "beyond": b"0 99",
    }


@pytest.mark.parametrize(
    ("given", "code"),
    [
        (["obj"], 0),
        (["ply"], 0),
        (["bare"], 2),
        (["bare", "edges"], 0),
        (["bare", "others"], 2),
        (["bare", "beyond"], 2),
    ],
)
def test_constraints_are_found_in_files(tmp_path: Path, given: list[str], code: int) -> None:
    for name, content in files().items():
        (tmp_path / name).write_bytes(content)
    said = said_of(POINTS, TRIANGLES, EDGES, carved=True)
    (tmp_path / "said.json").write_text(json.dumps(said))
    assert (
        checker.main(str(tmp_path / "said.json"), *(str(tmp_path / name) for name in given)) == code
    )


def test_what_is_not_a_certificate_of_constraints_is_said(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "obj").write_bytes(files()["obj"])
    said = said_of(POINTS, TRIANGLES, EDGES, carved=True)
    for lie, text in (
        ({"carved": 1}, "it does not say whether regions were carved"),
        ({"format_version": 2}, "version 1 or 4, or 2, 3 or 5 with its member"),
    ):
        (tmp_path / "said.json").write_text(json.dumps(said | lie))
        assert checker.main(str(tmp_path / "said.json"), str(tmp_path / "obj")) == 2
        assert text in capsys.readouterr().err
