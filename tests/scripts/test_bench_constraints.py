"""The script that times constrained triangulations: its inputs, its checks and its table."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest
from benchmark.tasks import constraints
from constrained import peers
from constrained.families import FAMILIES, Edges
from oracles.second_opinion import flaw

import liftmesh
from liftmesh import _kernel


@pytest.mark.parametrize("name", FAMILIES)
def test_edges_of_a_family_do_not_cross(name: str) -> None:
    points, edges = FAMILIES[name](500, np.random.default_rng(1))
    found = _kernel.constrained(points, edges, False, 1, False, None)
    assert len(found[0][6]) == len(found[-1]) == 0
    assert len(found[2]) == len(edges)
    assert name.endswith("coast") or len(edges) in {1, 484, 500}


def test_flips_leave_edges_that_are_not_delaunay() -> None:
    points, edges = FAMILIES["uniform"](3000, np.random.default_rng(2))
    delaunay = liftmesh.delaunay(points).edges
    among = {*map(tuple, np.sort(delaunay, axis=1).tolist())}
    share = np.mean([tuple(each) not in among for each in np.sort(edges, axis=1).tolist()])
    assert 0.2 < share < 0.4


def options(*cases: str) -> Namespace:
    return Namespace(cases=cases, quick=True, rounds=1, limit=60)


@pytest.mark.campaign
def test_a_table_is_printed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    made = {
        "carved": constraints.Case("coast", 20_000, {}, ("CDT", "triangle"), is_carved=True),
        "star": constraints.Case("star", 4000, {"tame edges": 5}, ("CDT", "tame edges")),
        "strip": constraints.Case("strip", 4000, {}, ("delaunay",)),
    }
    monkeypatch.setattr(constraints, "CASES", made)
    constraints.run(options(*made))
    rows = [line.split("|")[1:-1] for line in capsys.readouterr().out.splitlines()]
    assert [row[3].strip() for row in rows[2:7]] == [
        *("CDT", "triangle", "CDT", "tame edges", "delaunay"),
    ]
    for row in rows[2:7]:  # the wheels of CDT and triangle are in the extra `bench` alone
        is_told = row[3].strip() in {"CDT", "triangle"} and "not installed: " in row[4]
        assert is_told or (float(row[4]) > 0 and float(row[6]) > 0)


def test_a_wrong_answer_is_told_and_no_time(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answers: dict[str, tuple[float, Edges]] = {}

    def ask(name: str, folder: Path, *_: object, **__: object) -> tuple[float, Edges]:
        points = np.fromfile(folder / "points").reshape(-1, 2)
        edges = np.fromfile(folder / "edges", np.int32).reshape(-1, 2)
        right = peers.liftmesh(points, edges, carve=False)()
        answers[name] = 1.0, right if name != "CDT" else peers.delaunay(points)()
        return answers[name]

    monkeypatch.setattr(constraints, "ask", ask)
    constraints.measure("star", constraints.Case("star", 800, {}, ("CDT", "CGAL")), options())
    first, second = capsys.readouterr().out.splitlines()
    assert "| CDT | wrong: " in first
    assert "pieces missing | 1 | - |" in first
    assert "| CGAL | 1 | 1 | 1.00 |" in second


def test_what_gives_no_answer(tmp_path: Path) -> None:
    peers.write(tmp_path, FAMILIES["tiling"](100, np.random.default_rng(3)))
    with pytest.raises(peers.NoAnswerError, match=r"> 0\.001 s"):
        peers.ask("CDT", tmp_path, 0.001)
    with pytest.raises(peers.NoAnswerError, match="KeyError"):
        peers.ask("nobody", tmp_path, 60)


def test_pieces_must_be_there_and_need_not_be_delaunay() -> None:
    points = np.array([(0, 0), (3, 1), (6, 0), (3, -1)], dtype=float)
    triangles = np.array([(0, 3, 2), (0, 2, 1)], dtype=np.int32)
    assert flaw(points, triangles) == "1 edges not Delaunay"
    assert flaw(points, triangles, pieces=np.array([(2, 0)])) == ""
    assert flaw(points, triangles, pieces=np.array([(2, 0), (1, 3)])) == "1 pieces missing"
