"""The comparison with CGAL's regular triangulations: its weighted points, its sets, its end."""

from __future__ import annotations

import subprocess
import sys
from argparse import Namespace
from pathlib import Path

import numpy as np
import pytest
from benchmark import cgal
from weighted import __main__ as campaign
from weighted.families import FAMILIES, hidden_share, under_the_hull, with_share

import liftmesh

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", FAMILIES)
def test_weights_hide_the_share_that_is_asked_for(name: str) -> None:
    points, weights = FAMILIES[name](2000, np.random.default_rng(1))
    assert len(points) == len(weights)
    assert (with_share(points, weights, 0) == 0).all()
    if name != "circle":  # whose rows are all on the hull
        assert abs(hidden_share(points, with_share(points, weights, 0.5)) - 0.5) < 0.1
    seen = np.unique(liftmesh.regular(points, weights=under_the_hull(points)).simplices)
    assert set(seen) == set(liftmesh.delaunay(points).convex_hull)


def test_triangles_are_compared_as_sets_of_positions() -> None:
    points = np.array([(0, 1), (-0.0, 0), (0, 0), (1, 0), (0, 1)])
    assert campaign.positions(points).tolist() == [1, 0, 0, 2, 1]
    one, other = np.array([(2, 0, 1), (5, 4, 3)]), np.array([(3, 4, 5), (0, 1, 2)])
    np.testing.assert_array_equal(campaign.as_set(one), campaign.as_set(other))
    assert not np.array_equal(campaign.as_set(one), campaign.as_set(one + 1))


class Answer:
    """A peer that has its answer."""

    def __init__(self, triangles: np.ndarray, seconds: float) -> None:
        self.answer = triangles, seconds

    def regular(self, *_: np.ndarray) -> tuple[np.ndarray, float]:
        return self.answer


def test_a_difference_is_told_and_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    points, weights = FAMILIES["uniform"](50, np.random.default_rng(1))
    found = campaign.positions(points)[liftmesh.regular(points, weights=weights).simplices]
    answers = {"right": found, "wrong": found[1:]}
    monkeypatch.setattr(campaign, "KEPT", tmp_path / "out" / "kept.npz")
    for name, triangles in answers.items():
        others = {"CGAL": Answer(found, 4.0), "filtered": Answer(triangles, 1e9)}
        case = (name, "any", points, weights)
        assert campaign.compare(others, Namespace(rounds=2), *case) == (name == "right")
        line = capsys.readouterr().out
        assert ("DIFFERENT" in line) == (name == "wrong")
        assert " 4.0000 " in line
        assert " 0.00" in line  # of the second peer
    np.testing.assert_array_equal(np.load(campaign.KEPT)["weights"], weights)


def test_without_headers_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cgal, "HEADERS", "CGAL/no_such_header.h")
    monkeypatch.setattr(sys, "argv", ["weighted"])
    with pytest.raises(SystemExit, match=r"CGAL is not here: .*install libcgal-dev"):
        campaign.main()


@pytest.mark.parametrize("layout", [".", "include", "Kernel_23/include"])
def test_headers_of_another_cgal_come_first(tmp_path: Path, layout: str) -> None:
    (tmp_path / layout / "CGAL").mkdir(parents=True)
    assert cgal.include_folders(tmp_path) == [(tmp_path / layout).resolve()]
    with pytest.raises(cgal.UnavailableError, match="no_such holds no headers"):
        cgal.include_folders(tmp_path / "no_such")


def test_the_command_describes_itself() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "scripts" / "weighted", "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "Regular_triangulation_2" in done.stdout
