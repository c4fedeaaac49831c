"""Stars of points in metrics of their own, as subjects to watch."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from distributions import Points
from growth.counting import Work, on
from growth.families import FEW
from growth.planar import PLANAR

import liftmesh

SPREAD = {name: PLANAR[name] for name in ("uniform", "gaussian", "kuzmin", "clusters", "lattice")}
"""Where a star takes few steps. On convex curves it takes all rows: the ellipses inside follow the
curve, and meet the boxes along it. So it is on the innermost circle of a polar scan; and where no
filter decides, each step is long."""


def metrics_of(points: Points) -> np.ndarray:
    """Ask for triangles up to eight times as long as wide, in directions that turn slowly."""
    extent = max(np.ptp(points / 2, axis=0).max(), 1e-300)
    x, y = ((points / 2 - points.min(0) / 2) / extent).T
    along = np.column_stack([np.cos(x + 2 * y), np.sin(x + 2 * y)])
    stretch = 1 + 63 * x
    found = np.eye(2) + stretch[:, None, None] * along[:, :, None] * along[:, None, :]
    return (found + found.transpose(0, 2, 1)) / 2


def prepare(points: Points) -> Work:
    """Prepare all stars."""
    metrics = metrics_of(points)
    return Work(lambda: liftmesh.anisotropic_stars(points, metrics), len(points))


on_stars = on(lambda points: liftmesh.anisotropic_stars(points, metrics_of(points)))
"""Prepare a call on stars."""


def star_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families of what takes metrics."""
    yield "anisotropic_stars", SPREAD, prepare, ("uniform", "lattice"), FEW
    yield "AnisotropicStars.star", SPREAD, on_stars(lambda stars: stars.star(0)), ()
    yield (
        "AnisotropicStars.simplices",
        PLANAR,
        on_stars(lambda stars: stars.simplices),
        ("uniform",),
    )


FUNCTIONS = tuple(star_functions())
