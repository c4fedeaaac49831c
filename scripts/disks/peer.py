"""Graphs of disks by CGAL's `Apollonius_graph_hierarchy_2`, with its filtered traits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from benchmark import cgal
from benchmark.cgal.beside import PROGRAMS, answer

if TYPE_CHECKING:
    from disks.families import Disks

SOURCE = Path(__file__).with_name("apollonius.cpp")


def build() -> Path:
    """Compile the program, or raise `cgal.UnavailableError`."""
    return cgal.build(PROGRAMS, SOURCE)


def by_cgal(program: Path, disks: Disks) -> tuple[np.ndarray, float, int]:
    """Return triangles of distinct disks, seconds, and the number of vertices."""
    triangles, said = answer(program, disks)
    return triangles, said["seconds"], said["vertices"]
