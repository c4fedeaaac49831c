"""Points made to be slow, each family named after what it aims at.

Each function takes a size and a random generator, like those of `distributions`, and returns rows
in the order that does the most harm: do not shuffle them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from distributions import Points, polar
from numpy.random import Generator
from numpy.typing import NDArray

Family = Callable[[int, Generator], Points]


def splitmix(count: int, secret: int = 0) -> NDArray[np.uint64]:
    """The first numbers of splitmix64, by which the incremental lower hull orders its points."""
    with np.errstate(over="ignore"):
        bits = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        bits += np.uint64(secret)
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return bits ^ (bits >> np.uint64(31))


def insertion_order(n: int, rng: Generator) -> Points:
    """In space: for lower hulls that insert points in the order of the secret 0.

    A thin rim, and in the middle of it as many apexes, each lower than those inserted before: each
    replaces a fan over the whole rim. Points of such a narrow strip are in kd order if they are
    sorted by y, so the number of a row is its place in the order of insertion.
    """
    half = n // 2
    y = -np.cos(np.pi * (np.arange(half) + 0.5) / half)
    x = np.where(np.arange(half) % 2 == 0, 1, -1) * np.sqrt(1 - y * y) * 1e-9
    middle = (rng.random((half, 2)) - 0.5) * (1e-16, 1e-7)
    points = np.vstack((np.column_stack((x, y)), middle))
    by_y = np.argsort(points[:, 1])
    is_apex = by_y >= half
    bits = splitmix(2 * half)
    first_to_last = np.argsort(-(bits & -bits).astype(np.float64), kind="stable")
    apexes = first_to_last[is_apex[first_to_last]]
    z = np.zeros(2 * half)
    z[apexes] = -1 - np.arange(half) * 1e-6
    return np.column_stack((points[by_y], z))


def circle_and_centre(n: int, rng: Generator) -> Points:  # noqa: ARG001 - as for all families
    """For point location: one vertex has all triangles, so a walk may pass through all of them."""
    angle = 2 * np.pi * np.arange(n - 1) / (n - 1)
    return np.vstack((polar(1.0, angle), [[0.0, 0.0]]))


def polar_scan(n: int, rng: Generator) -> Points:
    """For point location: what a scanner sees at even angles in a round room, and its place."""
    angle = rng.random() + 2 * np.pi * np.arange(n - 1) / (n - 1)
    away = 0.5  # from the centre of the room, whose radius is 1
    radius = -away * np.cos(angle) + np.sqrt(1 - (away * np.sin(angle)) ** 2)
    return np.vstack((polar(radius, angle), [[0.0, 0.0]]))


def apex_far_away(n: int, rng: Generator) -> Points:
    """For point location: a column, and a point far from it to which all triangles lead."""
    return np.vstack((np.column_stack((np.zeros(n - 1), rng.random(n - 1))), [[1000.0, 0.5]]))


def tiny_and_far_cluster(n: int, rng: Generator) -> Points:
    """For nearest neighbours: half of the points become one when those of the other half count."""
    tiny = rng.random((n // 2, 2)) * 1e-20
    return np.vstack((tiny, 1 + rng.random((n - n // 2, 2)) * 1e-3))


def tiny_sides(n: int, rng: Generator) -> Points:
    """For nearest neighbours: two columns of tiny steps far apart, and a cloud aside from them."""
    side = 2 * n // 5
    columns = [np.column_stack((np.full(side, x), rng.random(side) * 1e-20)) for x in (-1.0, 1.0)]
    return np.vstack((*columns, rng.random((n - 2 * side, 2)) * (0.1, 1) + (0, 0.5)))


def beside_the_sample(n: int, rng: Generator) -> Points:
    """For the cuts: only rows that are sampled lie apart, all others fall into one cell."""
    sampled = 4 << min(13, max(0, (n // 96).bit_length() - 1))
    turned = np.arange(1, sampled + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    places = (turned >> np.uint64(32)) * np.uint64(n) >> np.uint64(32)
    points = 1000 + rng.random((n, 2)) * 1e-6
    points[places.astype(np.intp)] = rng.random((sampled, 2))
    return points


FANS: dict[str, Family] = {
    "circle-and-centre": circle_and_centre,
    "polar-scan": polar_scan,
    "apex-far-away": apex_far_away,
}
SCALES: dict[str, Family] = {
    "tiny-and-far-cluster": tiny_and_far_cluster,
    "tiny-sides": tiny_sides,
}
