"""The campaign of random domains, rehearsed: it holds, and notices what does not."""

from __future__ import annotations

import domains
import numpy as np
import pytest

import liftmesh


@pytest.mark.parametrize("kind", domains.DOMAINS)
def test_random_domains_hold(kind: str) -> None:
    rng = np.random.default_rng(18)
    for _ in range(12):
        domains.holds(kind, rng)


def test_other_weights_are_noticed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = liftmesh.power_diagram
    monkeypatch.setattr(
        domains.liftmesh, "power_diagram", lambda sites, domain, **_: right(
            sites, weights=np.arange(len(sites)) / 8, domain=domain
        )
    )  # fmt: skip
    with pytest.raises(SystemExit):
        test_random_domains_hold("boxes")
    assert "POLYGON ((" in capsys.readouterr().err
