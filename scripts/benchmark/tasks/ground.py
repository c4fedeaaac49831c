"""Errors of ground filters on scenes whose ground is known, and on lidar with classes.

The scenes are generated: a terrain, buildings with slanting roofs, trees whose crowns let a fourth
of the pulses through, low vegetation, noise of 3 cm, and with --low rows far below the ground,
which are removed first. An error of type I is ground that is lost, of type II another row that is
taken for ground; both and the sum are percentages of such rows. A file is taken in metres, and its
class 2 for the truth. "smrf" is the morphological filter of Pingel et al. (2013) by pysmrf, which
must be installed, with the defaults of PDAL's.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from time import perf_counter
from typing import Any

import numpy as np

import liftmesh

Truth = np.ndarray[Any, np.dtype[np.bool_]]
SIDE = 250.0  # metres
TERRAINS: dict[str, Callable[[Any, Any], Any]] = {
    "flat": lambda x, y: 0.5 * np.sin(x / 40) + 0.3 * np.cos(y / 30),
    "hills": lambda x, y: 12 * np.sin(x / 45) * np.cos(y / 55) + 2 * np.sin(x / 13 + y / 17),
    "slope": lambda x, y: 0.6 * x + 4 * np.sin(y / 20) + 2 * np.sin(x / 9),
    "terraces": lambda x, _: 3 * np.floor(x / 30) + 1.5 * np.clip(x % 30 - 28, 0, 2),
}
FILTERS: dict[str, dict[str, Any]] = {
    "tin": {"algorithm": "tin"},
    "tin, 25 degrees": {"algorithm": "tin", "tin_angle": 25},
    "csf": {"algorithm": "csf"},
    "csf, rigidness 1": {"algorithm": "csf", "cloth_rigidness": 1},
}
SMRF = "smrf"


def scene(name: str, rows: int, low: int, seed: int) -> tuple[Any, Truth]:
    """Make a scene, and tell which rows are ground."""
    rng = np.random.default_rng(seed)
    plane = rng.random((rows, 2)) * SIDE
    ground = TERRAINS[name](*plane.T) + rng.normal(0, 0.03, rows)
    heights, is_ground = ground.copy(), np.ones(rows, bool)
    for _ in range(25):
        place, turn = rng.random(2) * SIDE, rng.uniform(0, np.pi)
        axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        along, across = ((plane - place) @ axes).T
        roof = (np.abs(along) < rng.uniform(4, 15)) & (np.abs(across) < rng.uniform(4, 15))
        height = TERRAINS[name](*place) + rng.uniform(3, 15)
        heights[roof] = height + 0.1 * np.abs(along[roof]) + rng.normal(0, 0.03, roof.sum())
        is_ground &= ~roof
    for _ in range(300):
        radius, height = rng.uniform(1.5, 5), rng.uniform(4, 20)
        away = np.hypot(*(plane - rng.random(2) * SIDE).T) / radius
        crown = np.flatnonzero((away < 1) & is_ground & (rng.random(rows) < 0.75))
        dome = height * np.sqrt(1 - away[crown] ** 2)
        heights[crown] = ground[crown] + 0.3 + dome * rng.uniform(0.3, 1, len(crown))
        is_ground[crown] = False
    meadow = np.sin(plane[:, 0] / 15) * np.cos(plane[:, 1] / 21) > 0.2
    shrubs = is_ground & meadow & (rng.random(rows) < 0.1)
    heights[shrubs] = ground[shrubs] + rng.uniform(0.3, 1.5, shrubs.sum())
    is_ground &= ~shrubs
    deep = rng.choice(rows, low, replace=False)
    heights[deep] = ground[deep] - rng.uniform(4, 12, low)
    is_ground[deep] = False
    return np.column_stack([plane, heights]), is_ground


def scenes(options: Namespace) -> Iterator[tuple[str, Any, Truth]]:
    """Yield names, points and truths."""
    for name in TERRAINS:
        yield (name, *scene(name, options.rows, options.low, options.seed))
    for path in options.files:
        cloud = liftmesh.read(path, classes="all")
        yield path, cloud, cloud.attributes["classification"] == 2


def errors(found: Truth, truth: Truth) -> tuple[float, float, float]:
    """Return errors of type I and II, and all, in percent."""
    lost, taken = truth & ~found, found & ~truth
    shares = lost.sum() / truth.sum(), taken.sum() / (~truth).sum(), (found != truth).mean()
    return tuple(100 * float(each) for each in shares)  # type: ignore[return-value]


def ground_of(points: Any, kind: str, noise: dict[str, float]) -> Truth:
    """Filter, and tell which rows are ground."""
    if kind == SMRF:
        from pysmrf import classify  # noqa: PLC0415 - another program

        rows = points if isinstance(points, np.ndarray) else points.points
        return np.asarray(classify(*rows.T.copy(), cellsize=1.0, windows=18).is_ground)
    classes = liftmesh.classify_ground(points, **FILTERS[kind], **noise).attributes
    return np.asarray(classes["classification"] == 2)


def add_options(parser: ArgumentParser) -> None:
    """Add the options of this benchmark."""
    parser.add_argument("--rows", type=int, default=200_000)
    parser.add_argument("--low", type=int, default=0, help="rows far below the ground")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--filters", nargs="+", choices=[*FILTERS, SMRF], default=[*FILTERS])
    parser.add_argument("--files", nargs="*", default=[], help="LAS or LAZ with classes")


def run(options: Namespace) -> None:
    """Print a table."""
    print("| scene | filter | type I % | type II % | all % | seconds |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    noise = {"noise_depth": 2.0} if options.low else {}
    for name, points, truth in scenes(options):
        for kind in options.filters:
            start = perf_counter()
            found = ground_of(points, kind, noise)
            seconds = perf_counter() - start
            one, two, both = errors(found, truth)
            told = f"{one:.2f} | {two:.2f} | {both:.2f} | {seconds:.1f}"
            print(f"| {name} | {kind} | {told} |", flush=True)
