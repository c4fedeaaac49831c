"""The points of a cloud in space, with all three coordinates."""

from __future__ import annotations

import os
from typing import Any

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_coordinates, widened
from liftmesh.errors import InputError
from liftmesh.planar.points import rows_of


def space_rows(cloud: Any, need: str) -> Floats:
    """Return rows x, y, z as float64; `need` says who needs z, and what does without."""
    if isinstance(cloud, str | os.PathLike):
        from liftmesh.io.read import read  # noqa: PLC0415 - arrays do without

        cloud = read(cloud)
    rows = as_coordinates(rows_of(cloud, has_heights=True))
    if rows.shape[1] != 3:
        raise InputError(f"points have two columns: {need}")
    return widened(rows)
