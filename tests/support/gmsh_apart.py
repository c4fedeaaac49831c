"""Gmsh in a process of its own.

`gmsh.initialize` gives SIGPIPE its default back: a later write to a closed socket ends the process.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


def apart(function: Callable[..., T], *values: object) -> T:
    """Call a function of a module in a process of its own."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(function, *values).result()


def read(path: str) -> tuple[Any, dict[tuple[int, int], Any]]:
    """Return the points of a file, and the corners of each physical group by dimension and tag."""
    gmsh = import_module("gmsh")
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    numbers, places, _ = gmsh.model.mesh.getNodes()
    found: dict[tuple[int, int], Any] = {}
    for kind, tag in gmsh.model.getPhysicalGroups():
        (entity,) = gmsh.model.getEntitiesForPhysicalGroup(kind, tag)
        corners = gmsh.model.mesh.getElements(kind, entity)[2][0]
        found[kind, tag] = corners.reshape(-1, kind + 1).astype(int) - 1
    gmsh.finalize()
    return places.reshape(-1, 3)[np.argsort(numbers)], found
