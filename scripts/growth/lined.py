"""Surfaces that follow lines, as subjects to watch."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from distributions import Points
from growth.counting import Prepare, Work
from growth.families import random
from growth.planar import PLANAR
from growth.surfaces import surface_over

import liftmesh
from liftmesh import Surface

REFINED = {
    name: PLANAR[name]
    for name in ("uniform", "clusters", "circle", "polar scan", "line singularity")
}
"""Whose edges cross those of the refined surface in about as many places as it has triangles."""


def ring_in(points: Points, corners: int) -> Points:
    """Make a ring in the middle of points."""
    low, high = points.min(axis=0), points.max(axis=0)
    turns = np.arange(corners) * (2 * np.pi / corners)
    around = np.column_stack([np.cos(turns), np.sin(turns)])
    return low / 2 + high / 2 + (high / 2 - low / 2) * around * 0.7


def whole(points: Points) -> list[Points]:
    """Make one ring of a corner for every four points, which ends where it begins."""
    ring = ring_in(points, max(len(points) // 4, 3))
    return [np.vstack([ring, ring[:1]])]


def apart(points: Points) -> list[Points]:
    """Make a line for each of the pieces of that ring."""
    (ring,) = whole(points)
    return list(np.stack([ring[:-1], ring[1:]], axis=1))


def raised(lines: list[Points]) -> list[Points]:
    """Give lines heights."""
    return [np.column_stack([each, np.ones(len(each))]) for each in lines]


def followed(option: str, lines: Callable[[Points], list[Points]]) -> Prepare:
    """Prepare a surface over random heights that follows lines."""

    def prepare(points: Points) -> Work:
        cloud = np.column_stack([points, random().random(len(points))])
        given = {option: lines(points)}

        def call() -> None:
            with suppress(liftmesh.InputError):  # where a ring leaves the faces, or hides all
                liftmesh.triangulate(cloud, threads=1, **given)

        return Work(call, len(points))

    return prepare


def profiled(points: Points) -> Work:
    """Prepare a profile along a ring of many corners."""
    found, (line,) = surface_over(points), whole(points)
    found.profile(line)
    return Work(lambda: Surface.profile(found, line), len(points))


def refined(points: Points) -> Work:
    """Prepare the refinement of a surface, whose work is by what it makes."""
    found = surface_over(points)
    made = liftmesh.refine(found).triangulation.nsimplex
    return Work(lambda: liftmesh.refine(found), len(points) + made)


def lined_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families."""
    for option in ("soft_breaklines", "breaklines", "boundary", "holes"):
        counted = ("uniform",) if option == "soft_breaklines" else ()
        yield f"triangulate with {option}", PLANAR, followed(option, whole), counted
    hard = followed("breaklines", lambda points: raised(whole(points)))
    yield "triangulate with heights of lines", PLANAR, hard, ("uniform",)
    many = followed("soft_breaklines", apart)
    yield "triangulate with many lines", PLANAR, many, ("uniform",)
    yield "refine a surface", REFINED, refined, ("uniform",)
    yield "Surface.profile along many corners", PLANAR, profiled, ("uniform",)


FUNCTIONS = tuple(lined_functions())
