"""The same points in the forms in which callers hold them, to count what a triangulation takes."""

from __future__ import annotations

import numpy as np
from growth.counting import Work
from numpy.typing import NDArray

import liftmesh

POINTS = np.random.default_rng(11).integers(-(10**6), 10**6, (20_000, 2)).astype(np.float64)


def in_a_table(points: NDArray[np.float64]) -> NDArray[np.float64]:
    table = np.zeros((len(points), 7))
    table[:, 2:4] = points
    return table[:, 2:4]


FORMS = {
    "float64": lambda: POINTS,
    "float32": lambda: POINTS.astype(np.float32),
    "int32": lambda: POINTS.astype(np.int32),
    "int64": lambda: POINTS.astype(np.int64),
    "big endian": lambda: POINTS.astype(">f8"),
    "column-major": lambda: np.asfortranarray(POINTS),
    "columns of a table": lambda: in_a_table(POINTS),
    "every second row": lambda: np.repeat(POINTS, 2, axis=0)[::2],
    "n x 3": lambda: np.column_stack([POINTS, POINTS[:, 0]]),
    "n x 3 of int64": lambda: np.column_stack([POINTS, POINTS[:, 0]]).astype(np.int64),
}


def prepare(form: str) -> Work:
    """Make a call on the points in one form."""
    points = FORMS[form]()
    return Work(lambda: liftmesh.delaunay(points, threads=1), len(points))
