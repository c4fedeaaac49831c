"""Graphs of disks by CGAL's `Apollonius_graph_hierarchy_2`, with its filtered traits."""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from benchmark import cgal

if TYPE_CHECKING:
    from disks.families import Disks

ROOT = Path(__file__).resolve().parents[2]
SOURCE = Path(__file__).with_name("apollonius.cpp")


def build() -> Path:
    """Compile the program, or raise `cgal.UnavailableError`."""
    return cgal.build(ROOT / "out" / "programs", SOURCE)


def by_cgal(program: Path, disks: Disks) -> tuple[np.ndarray, float, int]:
    """Return triangles of distinct disks, seconds, and the number of vertices."""
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder, "disks"), Path(folder, "triangles")
        disks.tofile(given)
        done = subprocess.run([program, given, made], capture_output=True, text=True, check=True)
        said = json.loads(done.stdout)
        return np.fromfile(made, np.int32).reshape(-1, 3), said["seconds"], said["vertices"]
