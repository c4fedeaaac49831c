"""The campaign of changing triangulations, rehearsed: it holds, and notices what does not."""

from __future__ import annotations

from argparse import Namespace

import changes
import pytest

import liftmesh
from liftmesh._typing import Floats, Rows

OPTIONS = Namespace(changes=600, checkpoints=12)


@pytest.mark.parametrize("kind", ["lattice", "circle", "denormal"])
def test_every_checkpoint_holds(kind: str) -> None:
    assert changes.holds(kind, OPTIONS)


def test_another_triangulation_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    fresh = liftmesh.constrained_delaunay

    def without_one(points: Floats, edges: Rows) -> liftmesh.Triangulation:
        return fresh(points, edges[:-1])

    monkeypatch.setattr(changes.liftmesh, "constrained_delaunay", without_one)
    assert not changes.holds("uniform", OPTIONS)
