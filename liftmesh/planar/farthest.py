"""Farthest-point Delaunay triangulations: every point lies in the circle of every triangle.

They are the upper hull of the lifted points, seen from above. Their vertices are the corners of the
convex hull; all other rows are hidden.
"""

from __future__ import annotations

from typing import Any

from liftmesh import _kernel
from liftmesh._typing import Floats
from liftmesh.base.threads import as_threads
from liftmesh.planar.delaunay import solution_of


def solve_farthest(rows: Floats, *, copy: bool = False) -> dict[str, Any]:
    """Compute what a farthest-point `Delaunay` is made of."""
    planar = rows.copy() if copy else rows
    outcome, hidden = _kernel.farthest(planar, False, *as_threads(None, len(rows)), None)
    return solution_of(outcome, rows, planar, "engine", None, {"hidden": hidden})
