"""Calls of which tests count the instructions: no matter what else the machine does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from clouds import FAMILIES
from growth.counting import Work, count
from growth.functions import centroids, near_the_middle
from growth.planar import PLANAR
from numpy.typing import NDArray
from worst_points import SCALES, insertion_order

import liftmesh
from liftmesh import _kernel
from liftmesh.base.options import VARIABLE
from liftmesh.cli.info import summarise

MANY = 10_000  # queries


def instructions(*jobs: list[Any]) -> list[int]:
    """Count the instructions of calls, each given by a function below and what it takes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(Path(__file__).parent))
        patch.setenv(VARIABLE, "1")
        found = count("counted_calls:prepare", [*jobs])
    assert not any(each.error for each in found)
    return [each.instructions for each in found]


def first_raster(n: int) -> Work:
    tri, raster = raster_of(n)
    return Work(lambda: tri.find_simplex(raster), len(raster), warm=False)


def second_raster(n: int) -> Work:
    tri, raster = raster_of(n)
    tri.find_simplex(raster)
    return Work(lambda: tri.find_simplex(raster), len(raster))


def raster_of(n: int) -> tuple[liftmesh.Triangulation, Any]:
    tri = liftmesh.delaunay(np.random.default_rng(8).random((n, 2)), threads=1)
    return tri, (np.indices((180, 180)).reshape(2, -1).T + 0.5) / 180


def around_the_middle(n: int, family: str) -> Work:
    tri = liftmesh.delaunay(PLANAR[family](n), threads=1)
    asked = near_the_middle(tri)[-MANY:]
    asked[::2] = tri.points[-1]
    return located(tri, asked)


def inside_of_thin(n: int, family: str) -> Work:
    tri = liftmesh.delaunay(PLANAR[family](n), threads=1)
    return located(tri, centroids(tri)[:MANY])


def in_parts(n: int, parts: int) -> Work:
    tri = liftmesh.delaunay(PLANAR["circle and centre"](n), threads=1)
    asked = near_the_middle(tri)
    some = np.array_split(asked, parts)
    return Work(lambda: [tri.find_simplex(each) for each in some], len(asked))


def located(tri: liftmesh.Triangulation, asked: Any) -> Work:
    return Work(lambda: tri.find_simplex(asked), len(asked))


def known_order(n: int) -> Work:
    points = insertion_order(n, np.random.default_rng(0))
    return Work(lambda: _kernel.lower_hull(points, "auto", 0), n)


def unknown_order(n: int) -> Work:
    points = insertion_order(n, np.random.default_rng(0))
    return Work(lambda: liftmesh.lower_hull(points), n)


def shuffled(n: int) -> Work:
    points = insertion_order(n, np.random.default_rng(0))
    apexes = np.flatnonzero(points[:, 2])
    points[apexes, 2] = np.random.default_rng(1).permutation(points[apexes, 2])
    return Work(lambda: liftmesh.lower_hull(points), n)


CLOUDS: dict[str, Callable[[int, np.random.Generator], NDArray[np.float64]]] = {
    "uniform": lambda n, rng: rng.random((n, 2)),
    "grid": FAMILIES["lattice"],
    "pairs": lambda n, rng: np.repeat(rng.random((n // 2, 2)), 2, axis=0),
    **SCALES,
}


def cloud_of(n: int, family: str) -> liftmesh.Cloud:
    rng = np.random.default_rng(0)
    xy = CLOUDS[family](n, rng)
    return liftmesh.Cloud(np.column_stack((xy, rng.random(len(xy)))))


def summary(n: int, family: str) -> Work:
    cloud = cloud_of(n, family)
    return Work(lambda: summarise(cloud), n)


def triangulation(n: int, family: str) -> Work:
    cloud = cloud_of(n, family)
    return Work(lambda: liftmesh.triangulate(cloud, threads=1), n)


def prepare(job: list[Any]) -> Work:
    """Make the call of a function above, with what it takes."""
    name, *words = job
    return globals()[name](*words)
