"""Point families in space that are hard on lower hulls, and some in general position.

A family takes a size and a random generator and returns an (n, 3) float64 array. `SPACE` holds the
families in which coincidences are the rule; `LARGER` adds some that are made for a thousand points
and more; in `GENERAL` no four points are coplanar, nor nearly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from clouds import FAMILIES
from numpy.random import Generator
from numpy.typing import NDArray

import liftmesh

Points = NDArray[np.float64]
Generate = Callable[[int, Generator], Points]

MOST = np.finfo(np.float64).max
LEAST = 2.0**-1074


def integers(n: int, rng: Generator) -> Points:
    return rng.integers(-2, 3, (n, 3)).astype(np.float64)


def cube(n: int, rng: Generator) -> Points:
    return rng.permutation(np.indices((3, 3, 3)).reshape(3, -1).T)[:n] * 1.0


def flat(n: int, rng: Generator) -> Points:
    return np.column_stack((rng.integers(-2, 3, (n, 2)), np.full(n, rng.choice([0.0, -7.5]))))


def with_heights(xy: NDArray[Any], z: NDArray[Any]) -> Points:
    return np.column_stack((xy, z)).astype(np.float64)


def tilted(n: int, rng: Generator) -> Points:
    xy = rng.integers(-3, 4, (n, 2))
    return with_heights(xy, xy @ rng.integers(-4, 5, 2) + 0.25)


def roof(n: int, rng: Generator) -> Points:
    xy = rng.integers(-3, 4, (n, 2))
    return with_heights(xy, np.abs(xy[:, 0]) * rng.choice([1, -1]))


def paraboloid(n: int, rng: Generator) -> Points:
    xy = rng.integers(-3, 4, (n, 2))
    return with_heights(xy, (xy**2).sum(axis=1))


def cap(n: int, rng: Generator) -> Points:
    return paraboloid(n, rng) * (1, 1, -1)


def saddle(n: int, rng: Generator) -> Points:
    xy = rng.integers(-3, 4, (n, 2))
    return with_heights(xy, xy[:, 0] * xy[:, 1])


def walls(n: int, rng: Generator) -> Points:
    """Few planar positions with many heights each."""
    return with_heights(rng.integers(0, 2, (n, 2)) * (1, 3), rng.integers(-3, 4, n))


def hidden(n: int, rng: Generator) -> Points:
    """A deep triangle and points above its plane, some of them over its sides."""
    corners = [[-4, -4, -9], [4, -4, -9], [-4, 4, -9]]
    return rng.permutation(np.vstack((corners, integers(n, rng)))) * 1.0


def rim_on_lines(n: int, rng: Generator) -> Points:
    """Positions on the sides of a square alone."""
    along, side = rng.integers(0, 4, n), rng.integers(0, 4, n)
    xy = np.select(
        [(side == k)[:, None] for k in range(4)],
        [np.column_stack(pair) for pair in ((along, 0 * along), (along, 0 * along + 3))]
        + [np.column_stack(pair) for pair in ((0 * along, along), (0 * along + 3, along))],
    )
    return with_heights(xy, rng.integers(0, 2, n))


def ulps_off_a_plane(n: int, rng: Generator) -> Points:
    points = tilted(n, rng) / 3 + 1
    return points + rng.integers(-1, 2, points.shape) * np.spacing(points)


def at_map_coordinates(n: int, rng: Generator) -> Points:
    return tilted(n, rng) * 0.1 + (450_000, 5_200_000, 100)


def any_magnitude(n: int, rng: Generator) -> Points:
    mantissa = rng.uniform(-1, 1, (n, 3))
    return np.ldexp(mantissa, rng.integers(-1074, 1025, (n, 3)))


def scaled_integers(n: int, rng: Generator) -> Points:
    """Small integers, a power of two for each axis."""
    return np.ldexp(integers(n, rng), rng.choice([-1074, -1000, -500, 0, 500, 1000, 1022], 3))


def extremes(n: int, rng: Generator) -> Points:
    return rng.choice([-MOST, -1.0, -LEAST, -0.0, 0.0, LEAST, 1.0, MOST], (n, 3))


def one_magnitude_in_z(n: int, rng: Generator) -> Points:
    """An even spread of positions with heights of any size."""
    z = np.ldexp(rng.choice([-1.0, 0.0, 0.5, 0.75], n), rng.integers(-1072, 1024, n))
    return with_heights(rng.random((n, 2)), z)


def steps_beside_a_tower(n: int, rng: Generator) -> Points:
    """Heights of a few denormal steps, but one: the others have no room for a rounded product."""
    z = rng.integers(-3, 4, n) * LEAST
    z[rng.integers(0, n)] = 2.0**1000
    return with_heights(rng.random((n, 2)), z)


SPACE: dict[str, Generate] = {
    generate.__name__: generate
    for generate in (
        integers,
        cube,
        flat,
        tilted,
        roof,
        paraboloid,
        cap,
        saddle,
        walls,
        hidden,
        rim_on_lines,
        ulps_off_a_plane,
        at_map_coordinates,
        any_magnitude,
        scaled_integers,
        extremes,
        one_magnitude_in_z,
        steps_beside_a_tower,
    )
}


def random_heights(family: str) -> Generate:
    def generate(n: int, rng: Generator) -> Points:
        xy = FAMILIES[family](n, rng)
        return with_heights(xy, rng.integers(0, 3, len(xy)))

    return generate


def apex(n: int, rng: Generator) -> Points:
    """A tip below all others, joined to most that come before it: a vertex of many spokes."""
    radius, angle = 1 + rng.random(n), rng.random(n) * 2 * np.pi
    points = with_heights(np.column_stack((radius * np.cos(angle), radius * np.sin(angle))), radius)
    points[rng.integers(0, n)] = 0
    return points


LARGER = {
    **SPACE,
    "lattice on few levels": random_heights("lattice"),
    "circle on few levels": random_heights("circle"),
    "two columns": random_heights("two-columns"),
    "clusters": random_heights("clusters"),
    "denormal": random_heights("denormal"),
    "huge": random_heights("huge"),
    "far lattice": random_heights("far-lattice"),
    "flat raster": lambda n, rng: FAMILIES["lattice"](n, rng) @ np.eye(2, 3),
    "flat strip": lambda n, rng: with_heights(rng.random((n, 2)) * (1e6, 1), np.zeros(n)),
    "apex": apex,
    "dome": lambda n, rng: cap_of(FAMILIES["uniform"](n, rng)),
    "bowl": lambda n, rng: liftmesh.lift(FAMILIES["uniform"](n, rng), apex="median"),
}


def cap_of(xy: Points) -> Points:
    return with_heights(xy, -(xy**2).sum(axis=1))


def ball(n: int, rng: Generator) -> Points:
    direction = rng.standard_normal((n, 3))
    return direction / np.linalg.norm(direction, axis=1)[:, None] * rng.random((n, 1))


def sphere(n: int, rng: Generator) -> Points:
    direction = rng.standard_normal((n, 3))
    return direction / np.linalg.norm(direction, axis=1)[:, None]


def cone(n: int, rng: Generator) -> Points:
    """Near a cone with its tip below, rough enough for Qhull's rounding."""
    xy = rng.standard_normal((n, 2))
    return with_heights(xy, np.hypot(*xy.T) + rng.random(n) * 1e-3)


def bowl(n: int, rng: Generator) -> Points:
    return liftmesh.lift(rng.random((n, 2)) * 200, apex=(100, 100))


def elongated(n: int, rng: Generator) -> Points:
    return rng.standard_normal((n, 3)) * (1e3, 1, 1e-2)


GENERAL = {
    "sphere": (sphere, 20_000),
    "ball": (ball, 20_000),
    "bowl": (bowl, 10_000),
    "gaussian": (lambda n, rng: rng.standard_normal((n, 3)), 20_000),
    "cone": (cone, 5000),
    "cube": (lambda n, rng: rng.random((n, 3)), 5000),
    "elongated": (elongated, 2000),
}
