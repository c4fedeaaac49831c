"""The calls of a soak test: every kind of work, including errors and aborted calls."""

from __future__ import annotations

import copy
import io
import pickle
import signal
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from distributions import DISTRIBUTIONS
from jobs import CALLS
from numpy.random import Generator

import liftmesh

Call: TypeAlias = Callable[[np.ndarray, Generator], object]

FAMILIES = ("uniform", "lattice", "tilted-lattice", "circle", "two-columns", "denormal")
SMALLEST, LARGEST = 3, 400
FOR_TWO_THREADS = 20_000
POLICIES = ("first", "last", "lowest", "highest", "mean")


class Aborted(Exception):  # noqa: N818 - it is no error
    """Aborts a call, from a signal handler or from `progress`."""


def cloud(rng: Generator) -> np.ndarray:
    """Draw points in space from some distribution, sometimes with duplicates."""
    rows = int(rng.integers(SMALLEST, LARGEST))
    planar = DISTRIBUTIONS[FAMILIES[rng.integers(len(FAMILIES))]](rows, rng)
    if rng.random() < 0.3:
        planar = np.concatenate([planar, planar[: len(planar) // 3]])
    return np.column_stack([planar, rng.random(len(planar))])


def _triangulation(rows: np.ndarray) -> liftmesh.Triangulation:
    return liftmesh.delaunay(rows[:, :2])


def _delaunay(rows: np.ndarray, rng: Generator) -> object:
    algorithm = ("auto", "lfres-indexed")[rng.integers(2)]
    return liftmesh.delaunay(
        rows[:, :2], algorithm=algorithm, order=("engine", "canonical")[rng.integers(2)]
    )


def _regular(rows: np.ndarray, rng: Generator) -> object:
    values = rng.random(len(rows)) * 10.0 ** rng.integers(-4, 2)
    found = liftmesh.regular(rows[:, :2], **{("weights", "radii")[rng.integers(2)]: values})
    return found.hidden_to_simplex, found.degenerate


def _of_two_threads(_: np.ndarray, rng: Generator) -> object:
    return liftmesh.delaunay(rng.random((FOR_TWO_THREADS, 2)), threads=2)


def _triangulate(rows: np.ndarray, rng: Generator) -> object:
    plane = ("xy", "fit", (1, 2, 3))[rng.integers(3)]
    return liftmesh.triangulate(
        rows, plane=plane, on_duplicate=POLICIES[rng.integers(len(POLICIES))]
    )


def _verify(rows: np.ndarray, rng: Generator) -> object:
    simplices = np.array(_triangulation(rows).simplices)
    if rng.random() < 0.5:
        simplices[rng.integers(len(simplices))] = rng.integers(-1, len(rows) + 1, 3)
    return liftmesh.verify(rows, simplices).to_json()


def _disks(rows: np.ndarray, rng: Generator) -> object:
    radii = rng.random(len(rows)) * 10.0 ** rng.integers(-4, 1)
    planar = np.where(np.abs(rows[:, :2]) < 1e-30, 0, rows[:, :2])
    graph = liftmesh.apollonius(planar, radii.round(6))
    if rng.random() < 0.5:
        graph = replace(graph, hidden=rng.integers(-1, len(rows) + 1, 3))
    return graph.verify().to_json(), graph.cell_sides((0, 0, 1, 1), 0.01)


def _sample(rows: np.ndarray, rng: Generator) -> object:
    surface = liftmesh.triangulate(rows)
    asked = rng.random((100, 2))
    return surface.sample(asked), surface.aspect(asked)


def _lower_hull(rows: np.ndarray, _: Generator) -> object:
    return liftmesh.lower_hull(rows).faces


def _predicates(rows: np.ndarray, _: Generator) -> object:
    a = np.ascontiguousarray(rows[:, :2])
    return liftmesh.orient2d(a, a[::-1], a[0]), liftmesh.incircle(a, a[::-1], a[0], a[-1])


def _files(*kinds: str) -> Call:
    def round_trip(rows: np.ndarray, rng: Generator) -> object:
        stream = io.BytesIO()
        kind = kinds[rng.integers(len(kinds))]
        liftmesh.write(stream, liftmesh.triangulate(rows), format=kind)
        return liftmesh.read(io.BytesIO(stream.getvalue()), format=kind)

    return round_trip


def _broken_file(rows: np.ndarray, rng: Generator) -> object:
    stream = io.BytesIO()
    kind = ("ply", "obj", "npz")[rng.integers(3)]
    liftmesh.write(stream, rows, format=kind)
    data = bytearray(stream.getvalue())
    data[rng.integers(len(data))] ^= 1 << rng.integers(8)
    return liftmesh.read(io.BytesIO(data[: rng.integers(len(data))]), format=kind)


def _copies(rows: np.ndarray, _: Generator) -> object:
    surface = liftmesh.triangulate(rows)
    return copy.deepcopy(surface), pickle.loads(pickle.dumps(surface.triangulation.verify()))


def _wrong(rows: np.ndarray, rng: Generator) -> object:
    broken = rows.copy()
    broken[rng.integers(len(rows))] = np.nan
    wrong: list[Callable[[], object]] = [
        lambda: liftmesh.delaunay(broken),
        lambda: liftmesh.verify(broken, np.zeros((1, 3), np.int32)),
        lambda: liftmesh.delaunay(rows[:, :1]),
        lambda: liftmesh.delaunay(rows[:2]),
        lambda: liftmesh.triangulate(rows, on_duplicate="error"),
        lambda: liftmesh.triangulate(object()),
        lambda: liftmesh.read(io.BytesIO(), format="ply"),
        lambda: liftmesh.read("nowhere.ply"),
    ]
    return wrong[rng.integers(len(wrong))]()


def _of_list(name: str) -> Call:
    return lambda rows, rng: CALLS[name](rows, rng)(lambda _: None)


def _with_progress(rows: np.ndarray, rng: Generator) -> object:
    limit = rng.random()

    def stop(share: float) -> None:
        if share >= limit:
            raise Aborted

    return liftmesh.triangulate(rows, progress=stop)


def _signalled(rows: np.ndarray, rng: Generator) -> object:
    call = SMALL[rng.integers(len(SMALL) - 1)]
    previous = signal.signal(signal.SIGALRM, _stop)
    try:
        with suppress(Aborted):
            try:
                signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-5, 2e-3))
                return call(rows, rng)
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
    finally:
        signal.signal(signal.SIGALRM, previous)
    raise Aborted


def _stop(*_: Any) -> None:
    raise Aborted


# The last one interrupts one of the others. Formats that trimesh reads and writes take many times
# as long as the rest.
SMALL: tuple[Call, ...] = (
    _delaunay, _regular, _triangulate, _verify, _sample, _lower_hull, _predicates, _copies, _wrong,
    _with_progress, _broken_file, _files("ply", "obj", "npz"), _disks, *map(_of_list, CALLS),
    _signalled,
)  # fmt: skip
RARE: tuple[Call, ...] = (_of_two_threads, _files("off", "stl", "glb"))
RARELY = 0.01


def small_call(rng: Generator) -> str:
    """Make one small call; return the name of the exception, or an empty string."""
    calls = RARE if rng.random() < RARELY else SMALL
    try:
        calls[rng.integers(len(calls))](cloud(rng), rng)
    except (liftmesh.LiftmeshError, FileNotFoundError, Aborted) as error:
        return type(error).__name__
    return ""


def load_libraries() -> None:
    """Make a call that loads trimesh: a rare one would, at any time, and take it for a leak."""
    _files("glb")(np.eye(3), np.random.default_rng())


def large_call(number: int, rows: int, rng: Generator) -> None:
    """Triangulate, verify, locate, write and read many points; abort every third such call."""
    points = DISTRIBUTIONS[FAMILIES[number % len(FAMILIES)]](rows, rng)
    points = np.column_stack([points, np.zeros(len(points))])
    stop_at = rng.random() if number % 3 == 2 else 2.0

    def stop(share: float) -> None:
        if share >= stop_at:
            raise Aborted

    with suppress(Aborted):
        surface = liftmesh.triangulate(points, progress=stop)
        surface.triangulation.find_simplex(points[:1000, :2])
        if not liftmesh.verify(surface.vertices, surface.faces, progress=stop):
            raise SystemExit(f"large call {number} is not valid")
        stream = io.BytesIO()
        liftmesh.write(stream, surface, format="ply")
        liftmesh.read(io.BytesIO(stream.getbuffer()), format="ply")
