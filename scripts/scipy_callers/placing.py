"""Puts a class in the place of ``scipy.spatial.Delaunay``, as changing one import line would.

Libraries hold SciPy's class under names of their own (``from scipy.spatial import Delaunay``) or
look it up when they need it (``spatial.Delaunay``). Both are served: the name is replaced in
``scipy.spatial``, in its compiled module, where SciPy's interpolators look it up, and in every
module that has imported it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import numpy as np
import scipy.spatial

import liftmesh

SCIPYS = scipy.spatial.Delaunay


def counting(kind: type) -> type:
    """Derive a class that counts how many instances were made, and how often points were added."""

    class Counting(kind):
        made = 0
        grown = 0

        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            Counting.made += 1

        def add_points(self, *args: Any, **options: Any) -> None:
            super().add_points(*args, **options)
            Counting.grown += 1

    return Counting


def turned(kind: type) -> type:
    """Derive a class whose triangles begin at their lowest row, wherever `kind` begins them."""

    class Turned(kind):
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            self._turn()

        def add_points(self, *args: Any, **options: Any) -> None:
            super().add_points(*args, **options)
            self._turn()

        def _turn(self) -> None:
            order = (self.simplices.argmin(axis=1)[:, None] + np.arange(3)) % 3
            self.simplices[:] = np.take_along_axis(self.simplices, order, axis=1)
            self.neighbors[:] = np.take_along_axis(self.neighbors, order, axis=1)

    return Turned


def holders() -> Iterator[tuple[ModuleType, str]]:
    """List the loaded modules that hold SciPy's class, each with its name for it."""
    for name, module in list(sys.modules.items()):
        if isinstance(module, ModuleType) and name.partition(".")[0] != "liftmesh":
            for key, value in list(vars(module).items()):
                if value is SCIPYS and module.__name__ != __name__:
                    yield module, key


@contextmanager
def placed(kind: type) -> Iterator[type]:
    """Put a class that counts its instances in the place of SciPy's, for a block."""
    places = list(holders())
    counted = counting(kind)
    try:
        for module, name in places:
            setattr(module, name, counted)
        yield counted
    finally:
        for module, name in places:
            setattr(module, name, SCIPYS)


KINDS = {"SciPy": SCIPYS, "liftmesh": liftmesh.scipy.Delaunay}
