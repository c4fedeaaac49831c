"""Worst known inputs of what works on tetrahedra.

On two lines or a curve n points have n^2 tetrahedra, which nothing can find in less: those are left
out. What is left is a vertex of very many tetrahedra, ties, coordinates of wide exponents, and rows
that are at one place of the curve.
"""

from __future__ import annotations

import numpy as np
from distributions import Points
from growth.families import families_in, random
from growth.spatial import random_heights, towers

TILT = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def cubic_lattice(n: int) -> Points:
    """Eight rows on each sphere, and as many planes as there are of all kinds."""
    side = round(n ** (1 / 3))
    return random().permutation(np.indices((side, side, side)).reshape(3, -1).T.astype(np.float64))


def tilted_cubes(n: int) -> Points:
    """A rounded lattice: no filter decides, and small integers do not."""
    return cubic_lattice(n) @ TILT


def sphere(n: int) -> Points:
    """Rows on the hull, all nearly on one sphere."""
    direction = random().standard_normal((n, 3))
    return direction / np.linalg.norm(direction, axis=1)[:, None]


def sphere_and_centre(n: int) -> Points:
    """One vertex, the last row, has all tetrahedra."""
    return np.vstack([sphere(n - 1), [[0.0, 0.0, 0.0]]])


def nested_balls(n: int) -> Points:
    """Clusters of clusters, five levels deep."""
    rng = random()
    centres = sum(1e-2**level * rng.random((10, 3))[rng.integers(0, 10, n)] for level in range(5))
    return centres + 1e-10 * rng.random((n, 3))


def tube_and_outlier(n: int) -> Points:
    """A row so far that all others are at one place of the curve; walks in a tube are long."""
    tube = random().random((n - 1, 3)) * (n, 1.0, 1.0)
    return np.vstack([tube, [[1e12, 2e12, 3e12]]])


def exponents(n: int) -> Points:
    """Exponents over the whole range: every predicate needs the widest integers."""
    rng = random()
    size = np.ldexp(rng.random((n, 3)) + 0.5, rng.integers(-1000, 1000, (n, 3)))
    return size * rng.choice([-1.0, 1.0], (n, 3))


def levels(n: int) -> Points:
    """In four planes: the hull has facets of very many coplanar rows."""
    rng = random()
    return np.column_stack([rng.random((n, 2)), rng.integers(0, 4, n)])


def five_positions(n: int) -> Points:
    """All rows but four are one position."""
    others = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    return np.vstack([np.full((n - 4, 3), 0.25), others])


SOLID = {
    "random heights": random_heights,
    "towers": towers,
    **families_in(globals(), "Points"),
}
