"""The campaign of random edges, rehearsed: it holds, and notices what does not."""

from __future__ import annotations

from typing import Any

import constraints
import numpy as np
import pytest
from numpy.typing import NDArray

from liftmesh import _kernel


def some_sets(kind: str) -> None:
    rng = np.random.default_rng(51)
    for _ in range(12):
        constraints.holds(kind, rng)


def without_the_last(found: tuple[Any, ...]) -> tuple[Any, ...]:
    """Without the last triangle."""
    outcome, marks, *rest = found
    return ((*outcome[:3], outcome[3][:-1], *outcome[4:]), marks[:-1], *rest)


def unmarked(found: tuple[Any, ...]) -> tuple[Any, ...]:
    return (found[0], found[1] * np.uint8(0), *found[2:])


def of_other_edges(found: tuple[Any, ...]) -> tuple[Any, ...]:
    return (*found[:4], found[4] + 1, *found[5:])


@pytest.mark.parametrize("spoil", [without_the_last, unmarked, of_other_edges])
def test_what_is_wrong_is_noticed(
    spoil: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = _kernel.constrained

    def wrong(points: NDArray[Any], edges: NDArray[Any], *rest: Any) -> tuple[Any, ...]:
        return spoil(right(points, edges, *rest))

    some_sets("lattice")
    monkeypatch.setattr(constraints._kernel, "constrained", wrong)
    with pytest.raises(SystemExit):
        some_sets("lattice")
    assert "edges [[" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["carve", "label_regions"])
def test_wrong_regions_are_noticed(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = getattr(_kernel, name)
    monkeypatch.setattr(constraints._kernel, name, lambda *given: 1 - right(*given))
    with pytest.raises(SystemExit):
        some_sets("lattice")
    assert "edges Given(edges=" in capsys.readouterr().err


def test_crossings_are_left_out() -> None:
    points = np.array([(0, 0), (2, 2), (0, 2), (2, 0), (1, 3)], dtype=float)
    edges = np.array([(0, 1), (2, 3), (3, 4), (0, 4)], dtype=np.int32)
    assert constraints.without_crossings(points, edges).tolist() == [[0, 1], [0, 4]]
