"""The campaign of refined domains, rehearsed: it holds, and notices what does not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import refine
from oracles.refined import Refined

STRIP = np.array([[0.0, 0], [1, 0], [1, 1e-3], [0, 1e-3]])


def some_domains(kind: str) -> None:
    rng = np.random.default_rng(36)
    for _ in range(3):
        refine.holds(kind, rng)


@pytest.mark.parametrize("kind", ["boxes", "stars", "two-columns"])
def test_random_domains_hold(kind: str) -> None:
    some_domains(kind)


def without_causes(mesh: Refined) -> Refined:
    return Refined(mesh.result, mesh.before, np.full_like(mesh.causes, "input angle"), mesh.cosine)


def of_another_angle(mesh: Refined) -> Refined:
    return Refined(mesh.result, mesh.before, mesh.causes, 0.6)


@pytest.mark.parametrize("spoil", [without_causes, of_another_angle])
def test_what_is_wrong_is_noticed(
    spoil: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = refine.refined
    monkeypatch.setattr(refine, "refined", lambda *given: spoil(right(*given)))
    with pytest.raises(SystemExit):
        some_domains("boxes")
    assert "edges [[" in capsys.readouterr().err


def test_only_few_digits_excuse_a_triangle(monkeypatch: pytest.MonkeyPatch) -> None:
    right = refine.refined

    def for_want_of_digits(*given: Any) -> Refined:
        mesh = right(*given)
        causes = np.where(mesh.causes == "input angle", "precision", mesh.causes)
        return Refined(mesh.result, mesh.before, causes, mesh.cosine)

    monkeypatch.setattr(refine, "refined", for_want_of_digits)
    with pytest.raises(SystemExit):
        some_domains("fans")


def test_only_narrow_strips_excuse_the_cap(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(refine, "MOST", 2)
    some_domains("boxes")  # end with more points
    assert "at the cap" in capsys.readouterr().out
    monkeypatch.setattr(refine, "MANY", 4)
    with pytest.raises(SystemExit):
        some_domains("boxes")


@pytest.mark.parametrize("by_length", [False, True])
def test_sizes_are_compared(by_length: bool) -> None:
    demand = refine.Demand(20, 0.02, conforming=False, carved=False, by_length=by_length)
    mesh = refine.refined(STRIP * [1, 500], np.array([[0, 2]], dtype=np.int32), demand)
    refine.check_sizes(mesh, demand)
    assert len(mesh.simplices) > 50
    for share, listed in ((0.002, []), (0.02, [3]), (None, [3])):
        result = replace(mesh.result, too_large=np.array(listed, dtype=np.int32))
        other = Refined(result, mesh.before, mesh.causes, mesh.cosine)
        with pytest.raises(AssertionError, match="others are listed"):
            refine.check_sizes(other, replace(demand, share=share))


def test_what_is_beside_few_digits_may_be_left() -> None:
    """A chain whose corners are up to the last digits on a line, which hides other places."""
    points = np.array([
        [-0.8880552409434754, -0.9109810339847131], [-0.8427241473266485, -0.8620542727831363],
        [-0.6567716427373573, -0.6613519940386829], [-0.010327156842911188, 0.7496613995985723],
        [-0.0022856669563313284, 0.7697663337571684], [0.0066633877404711495, 0.7867471610142212],
    ])  # fmt: skip
    edges = np.array([[2, 3], [3, 5], [5, 4], [4, 0], [0, 1], [1, 2]], dtype=np.int32)
    demand = refine.Demand(33, 0.0566, conforming=False, carved=False)
    mesh = refine.refined(points, edges, demand)
    assert "1 triangle stayed larger than asked for" in mesh.told
    refine.check(mesh, (points, edges), demand, np.random.default_rng(1))
    refine.check_causes(mesh, (points, edges), demand)


@pytest.mark.parametrize("gap", [1e-3, 1e-6])
def test_narrowness_is_length_by_gap(gap: float) -> None:
    demand = refine.Demand(20, None, conforming=False, carved=False, most=9)
    edges = np.array([[0, 1], [2, 3]], dtype=np.int32)
    mesh = refine.refined(STRIP * [1, 1e3 * gap], edges, demand)
    assert refine.narrowness(mesh) == pytest.approx(1 / gap, rel=1e-2)
