"""The script that times weighted points, metrics and farthest points."""

from __future__ import annotations

import math
import os
from argparse import Namespace

import numpy as np
import pytest
from benchmark.tasks import weighted as bench_weighted
from benchmark.tasks.weighted import CASES, Case, lines, row, shown

import liftmesh

OPTIONS = Namespace(n=600, limit=60.0)


class Quick:
    """A peer that takes no time."""

    def regular(self, points: np.ndarray, weights: np.ndarray) -> tuple[None, float]:
        assert len(points) == len(weights)
        return None, 4.0


@pytest.fixture(autouse=True)
def _threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LIFTMESH_NUM_THREADS", "1")  # which a case sets


@pytest.mark.parametrize("name", CASES)
def test_each_case_is_timed_beside_what_it_is_compared_with(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench_weighted, "scipy", lambda points, limit: limit / len(points))
    others = {"CGAL": Quick(), "filtered": Quick()}
    case = CASES[name](OPTIONS, others)
    found = list(lines(name, case, 1))
    assert len(found) == len(case.others)
    for line, other in zip(found, case.others, strict=True):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        assert (cells[0], cells[3]) == (name, other)
        assert float(cells[1]) > 0
        assert float(cells[2]) > 0
        assert cells[-1] == (f"{case.targets[other]:g}" if other in case.targets else "")


def test_cases_hide_what_they_say() -> None:
    others = {"CGAL": Quick()}
    for name, low, high in (
        ("half hidden", 0.4, 0.6),
        ("all hidden but the hull", 0.9, 1.0),
        ("equal weights", 0.0, 0.0),
        ("weights that hide no row", 0.0, 0.0),
    ):
        found = CASES[name](OPTIONS, others).ours(1)
        assert isinstance(found, liftmesh.RegularTriangulation)
        assert low <= len(found.hidden) / 600 <= high


def test_a_wrong_result_is_not_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(liftmesh, "verify", lambda _: Namespace(canonical=False))
    with pytest.raises(SystemExit, match="metric: verify finds flaws"):
        list(lines("metric", CASES["metric"](OPTIONS, {}), 1))


def test_a_peer_that_is_slow_is_stopped() -> None:
    points = np.random.default_rng(1).random((50, 2))
    assert bench_weighted.scipy(points, 60.0) < 60
    assert bench_weighted.scipy(points, 0.01) == math.inf


def test_rows_of_the_table() -> None:
    assert [shown(x) for x in (12.345, 0.1234, 0.0123)] == ["12.35", "0.123", "0.012"]
    least = {"1": 1.0, "2": 0.5, "CGAL": 2.0}
    assert row("half", "CGAL", least, 0.55) == (
        "| half | 1.00 | 0.500 | CGAL | 2.00 | 0.500 | 0.250 | 0.55 |"
    )
    calls: list[int] = []
    once = Case(lambda _: liftmesh.delaunay(np.eye(3)[:, :2]), {"SciPy": lambda: len(calls) + 1.0})
    assert len(list(lines("any", once, 3))) == 1
    assert os.environ["LIFTMESH_NUM_THREADS"] == "1"
