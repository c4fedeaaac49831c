"""Rows of a cloud as those of tetrahedra, which no cloud has: into a file and back."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from conversions.comparing import ChangedError

from liftmesh.io.tetrahedra import FORMATS, read_tetrahedra, write_tetrahedra

if TYPE_CHECKING:
    from liftmesh import Cloud


def _went_through(kind: str, cloud: Cloud) -> None:
    """Every row must come back in its place, bit for bit, and every corner."""
    if not len(cloud):
        return
    rows = np.arange(2 * len(cloud) + 2)[:, None] * [1, 3, 5, 7]
    cells = (rows % len(cloud)).astype(np.int32)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"a.{kind}")
        write_tetrahedra(path, cloud.points, cells)
        points, tetrahedra = read_tetrahedra(path)
    if points.tobytes() != np.ascontiguousarray(cloud.points, dtype=np.float64).tobytes():
        raise ChangedError(f"{kind} changes rows of tetrahedra")
    if not np.array_equal(tetrahedra, cells):
        raise ChangedError(f"{kind} changes tetrahedra")


TRIPS = [partial(_went_through, kind) for kind in FORMATS]
