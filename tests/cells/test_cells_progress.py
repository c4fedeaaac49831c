"""What a caller hears of cells that are made, and that threads change nothing of them."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from distributions import uniform

import liftmesh
from liftmesh.errors import DegenerateInputError, InputError, NonFiniteError

UNIT = (0, 0, 1, 1)
DISK = (np.hypot(*(np.mgrid[0:40, 0:40] - 20.0)) < 9).astype(float)


def power_diagram(points: np.ndarray, **options: Any) -> liftmesh.Cells:
    weights = np.random.default_rng(1).random(len(points)) / len(points)
    return liftmesh.power_diagram(points, weights=weights, **options)


def lloyd(points: np.ndarray, **options: Any) -> liftmesh.Cells:
    return liftmesh.lloyd(points, domain=UNIT, max_iter=4, **options).cells


def transport(points: np.ndarray, **options: Any) -> liftmesh.Cells:
    return liftmesh.transport(points, np.ones(len(points)), domain=UNIT, **options).cells


def by_density(points: np.ndarray, **options: Any) -> liftmesh.Cells:
    """Start anew several times, where a step does not help."""
    masses, box = np.ones(20), (-0.5, -0.5, 1.5, 1.5)
    return liftmesh.transport(points[:20], masses, domain=box, density=DISK, **options).cells


def from_afar(points: np.ndarray, **options: Any) -> liftmesh.Cells:
    return liftmesh.transport(points[:50] + 9, np.ones(50), domain=UNIT, **options).cells


def disks(points: np.ndarray, **options: Any) -> liftmesh.ApolloniusCells:
    return liftmesh.apollonius_diagram(points, points[:, 0] / 1000, **options)


def graph(points: np.ndarray, **options: Any) -> object:
    return liftmesh.apollonius(points, points[:, 0] / 1000, **options)


def equal_disks(points: np.ndarray, **options: Any) -> liftmesh.ApolloniusCells:
    return liftmesh.apollonius_diagram(points, np.full(len(points), 0.1), **options)


OF_POINTS = [liftmesh.voronoi, power_diagram, lloyd, transport, by_density, from_afar]
RUNS = [*OF_POINTS, disks, equal_disks, graph]


@pytest.mark.parametrize("run", RUNS)
def test_shares_rise_to_one(run: Callable[..., Any]) -> None:
    told: list[float] = []
    threads = set()

    def progress(share: float) -> None:
        told.append(share)
        threads.add(threading.get_ident())

    run(uniform(300, np.random.default_rng(0)), progress=progress)
    assert len(told) >= (3 if run in OF_POINTS else 1)
    assert all(type(share) is float and 0 <= share <= 1 for share in told)
    assert told == sorted(told)
    assert told[-1] == 1.0 not in told[:-1]
    assert threads == {threading.get_ident()}


@pytest.mark.parametrize("points", [np.ones((1, 2)), np.arange(8.0).reshape(4, 2)])
def test_rows_on_a_line_too(points: np.ndarray) -> None:
    told: list[float] = []
    liftmesh.voronoi(points, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1.0 not in told[:-1]


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("after", [0.0, 0.02, 0.3, 1.0])
@pytest.mark.parametrize("error", [NonFiniteError("enough", row=0), DegenerateInputError("enough")])
def test_what_it_raises_comes_out_as_it_is(
    run: Callable[..., Any], after: float, error: Exception
) -> None:
    def progress(share: float) -> None:
        if share >= after:
            raise error

    with pytest.raises(type(error)) as caught:
        run(uniform(300, np.random.default_rng(0)), progress=progress)
    assert caught.value is error


@pytest.mark.parametrize("run", [liftmesh.voronoi, lloyd, disks])
def test_a_run_that_fails_never_says_that_it_is_done(run: Callable[..., Any]) -> None:
    told: list[float] = []
    points = uniform(300, np.random.default_rng(0))
    points[7] = np.nan
    with pytest.raises(NonFiniteError, match="row 7"):
        run(points, progress=told.append)
    assert 1.0 not in told
    with pytest.raises(InputError, match="progress is 'print': give a function"):
        run(points, progress="print")


@pytest.mark.parametrize("run", OF_POINTS)
def test_threads_change_nothing(run: Callable[..., Any]) -> None:
    points = uniform(4000, np.random.default_rng(0))
    one, three = (run(points, threads=threads) for threads in (1, 3))
    for name in ("corners", "parts", "rings", "ring_corners", "beyond", "areas"):
        assert getattr(one, name).tobytes() == getattr(three, name).tobytes()
    with pytest.raises(InputError, match="threads is 0: give a whole number from 1"):
        run(points, threads=0)


def test_threads_change_no_weights() -> None:
    points = uniform(4000, np.random.default_rng(0))
    one, three = (liftmesh.natural_neighbors(points, points / 2, threads=n) for n in (1, 3))
    assert one.data.tobytes() == three.data.tobytes()
    with pytest.raises(InputError, match="threads is 0"):
        liftmesh.natural_neighbors(liftmesh.delaunay(points), points, threads=0)
