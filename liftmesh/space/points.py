"""The points of a cloud in space, with all three coordinates."""

from __future__ import annotations

import os
from typing import Any

from liftmesh._typing import Floats, Reals
from liftmesh.base.arrays import as_coordinates, widened
from liftmesh.errors import InputError
from liftmesh.planar.points import rows_of


def coordinates_of(cloud: Any) -> Reals:
    """Return rows of all coordinates that a cloud has, two or three."""
    if isinstance(cloud, str | os.PathLike):
        from liftmesh.io.read import read  # noqa: PLC0415 - arrays do without

        cloud = read(cloud)
    return as_coordinates(rows_of(cloud, has_heights=True))


def space_rows(cloud: Any, need: str) -> Floats:
    """Return rows x, y, z as float64; `need` says who needs z, and what does without."""
    rows = coordinates_of(cloud)
    if rows.shape[1] != 3:
        raise InputError(f"points have two columns: {need}")
    return widened(rows)
