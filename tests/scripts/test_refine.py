"""The campaign of refined domains, rehearsed: it holds, and notices what does not."""

from __future__ import annotations

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


@pytest.mark.parametrize("gap", [1e-3, 1e-6])
def test_narrowness_is_length_by_gap(gap: float) -> None:
    demand = refine.Demand(20, None, conforming=False, carved=False, most=9)
    edges = np.array([[0, 1], [2, 3]], dtype=np.int32)
    mesh = refine.refined(STRIP * [1, 1e3 * gap], edges, demand)
    assert refine.narrowness(mesh) == pytest.approx(1 / gap, rel=1e-2)
