"""The campaign of refined domains, rehearsed: it holds, and notices what does not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import refine
from oracles.refined import Refined


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
