"""Surfaces whose rows other threads write meanwhile: nothing is read or written beyond its array.

Vertices are views of the caller's array, and the interpreter is free during long calls. What comes
out then is of no use, but it comes.
"""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest

import liftmesh
from liftmesh.terrain.measures import touching
from liftmesh.terrain.surface_data import kernel_surface

RNG = np.random.default_rng(4)
SOUND = RNG.random((8000, 3)) * (1000, 1000, 50)
QUERIES = RNG.uniform(-10, 1010, (3000, 2))

SPOILT = {
    "swapped": SOUND[:, ::-1],
    "turned": SOUND[RNG.permutation(len(SOUND))],
    "NaN": np.full_like(SOUND, np.nan),
    "infinite": SOUND * (np.inf, -np.inf, np.inf),
    "one place": np.full_like(SOUND, 25),
}

CALLS: dict[str, Callable[[liftmesh.Surface, int], np.ndarray]] = {
    "heights": lambda surface, n: surface.raster(10, bounds=(0, 0, 1000, 1000), threads=n).values,
    "slopes": lambda surface, n: (
        surface.raster(10, bounds=(0, 0, 1000, 1000), quantity="slope", threads=n).values
    ),
    "contours": lambda surface, n: surface.contours(np.arange(50.0), threads=n).points,
    "boundary": lambda surface, _: np.concatenate(surface.boundary()),
    "linear": lambda surface, n: surface.sample(QUERIES, threads=n),
    "nearest": lambda surface, n: surface.sample(QUERIES, "nearest", threads=n),
    "sibson": lambda surface, n: surface.sample(QUERIES, "sibson", threads=n),
    "gradient": lambda surface, n: surface.gradient(QUERIES, threads=n),
}


@contextmanager
def written_meanwhile(rows: np.ndarray, spoilt: np.ndarray) -> Iterator[None]:
    """Let a thread write rows all the time; in the end they are as they were."""
    done = threading.Event()

    def write() -> None:
        for first in itertools.cycle(range(7)):
            rows[first::7] = spoilt[first::7]
            rows[first::3] = SOUND[first::3]
            if done.is_set():
                break

    writer = threading.Thread(target=write)
    writer.start()
    try:
        yield
    finally:
        done.set()
        writer.join()
        rows[:] = SOUND


@pytest.mark.parametrize(("kind", "threads"), [("swapped", 1), *((each, 2) for each in SPOILT)])
def test_rows_that_a_thread_writes_all_the_time(kind: str, threads: int) -> None:
    rows = SOUND.copy()
    whole = liftmesh.triangulate(rows)
    assert np.shares_memory(whole.vertices, rows)
    surface = whole.trim(max_edge=45)  # with many gaps
    with written_meanwhile(rows, SPOILT[kind]):
        found = {name: call(surface, threads) for name, call in CALLS.items()}
        assert found["heights"].shape == (100, 100)
        assert not np.isnan(found["contours"]).any()
        assert found["boundary"].min() >= 0
        assert found["boundary"].max() < len(rows)


def test_cut_and_fill_of_rows_that_a_thread_writes() -> None:
    rows = SOUND.copy()
    surface, other = liftmesh.triangulate(rows), liftmesh.triangulate(SOUND[::-1] * (1, 1, 2))
    message = "the surfaces have no area in common"  # where it looks, faces may be elsewhere
    refused = ""
    with written_meanwhile(rows, SPOILT["swapped"]):
        try:
            surface.cut_and_fill(other)
        except liftmesh.InputError as error:
            refused = str(error)
    assert refused in {"", message}
    assert surface.cut_and_fill(other).fill > 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", SPOILT)
def test_the_overlay_of_rows_that_a_thread_writes(kind: str) -> None:
    rows = SOUND.copy()
    surface, other = liftmesh.triangulate(rows), liftmesh.triangulate(np.add(SOUND[::2], 3))
    pair = touching(surface.triangulation, other.triangulation)
    arguments = kernel_surface(other), *pair, 2, False, None
    with written_meanwhile(rows, SPOILT[kind]):
        found = [kernel_surface(surface).overlay(*arguments) for _ in range(2)]
    for each in found:
        assert each is None or np.isfinite(each[0]).all()


def overwrite(held: np.ndarray, values: np.ndarray) -> None:
    """Write what is read-only."""
    base = held
    while isinstance(base.base, np.ndarray):
        base = base.base
    base.setflags(write=True)
    held.setflags(write=True)
    held[:] = values


@pytest.mark.parametrize("lines", [None, [[100.0, 100, 3], [900, 880, 7]]])
@pytest.mark.parametrize("kind", SPOILT)
def test_a_mesh_that_is_none_any_more_is_refused(kind: str, lines: object) -> None:
    rows = SOUND.copy()
    surface = liftmesh.triangulate(rows, breaklines=lines)
    overwrite(surface.vertices, np.resize(SPOILT[kind], surface.vertices.shape))
    overwrite(surface.triangulation.points, surface.vertices[:, :2])
    told = r"rows \[\d+, \d+, \d+\] are at .* now, and .*: triangulate them again, or a copy"
    for call in (liftmesh.refine, lambda each: liftmesh.simplify(each, max_points=500)):
        with pytest.raises(liftmesh.InputError, match=told):
            call(surface)
    with pytest.raises(liftmesh.InputError, match=told):
        liftmesh.refine(surface.triangulation)


def test_heights_that_are_none_any_more_are_refused() -> None:
    rows = SOUND.copy()
    surface = liftmesh.triangulate(rows)
    rows[7, 2] = np.nan
    with pytest.raises(liftmesh.NonFiniteError, match=r"row 7 is not finite: .*; remove such rows"):
        liftmesh.simplify(surface, max_points=500)


def test_a_hull_that_is_not_convex_any_more_is_refused() -> None:
    rows = np.array([[0.0, 0, 0], [4, 0, 0], [8, 0, 0], [8, 8, 0], [0, 8, 0], [4, 4, 0]])
    surface = liftmesh.triangulate(rows)
    rows[1, 1] = 1
    with pytest.raises(liftmesh.InputError, match=r"rows \[0, 1, 2\] are at .* now"):
        liftmesh.simplify(surface, max_error=1)
