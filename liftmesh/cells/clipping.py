"""From sites and a domain to the rings of all cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh import _kernel
from liftmesh.cells.exact import ExactCorners
from liftmesh.cells.rings import Rings
from liftmesh.cells.untying import untied
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain
    from liftmesh.cells.dual import Dual


def clip(dual: Dual, domain: Domain) -> tuple[Rings, ExactCorners]:
    """Clip all cells to a domain."""
    found = _kernel.clip(
        dual.points, dual.values, dual.kind, dual.simplices, dual.neighbors,
        dual.simplex_to_vertex, dual.chain, domain.corners, domain.starts,
    )  # fmt: skip
    if found is None:
        raise InputError("the rings of the domain cross or overlap: give a valid polygon")
    sources, points, certain, starts, cells, cut, ties = found
    vertex_of, k = dual.simplex_to_vertex, len(points)  # corners from k on are vertices
    points = np.concatenate([points, dual.vertices[vertex_of[sources[k:, 1]]]])
    is_vertex = np.flatnonzero(sources[:k, 0] < 0)
    points[is_vertex] = dual.vertices[vertex_of[sources[is_vertex, 1]]]
    rings = Rings(sources, points, starts, cells, cut)
    exact = ExactCorners(domain, dual)
    for i in np.flatnonzero(~certain).tolist():
        ring = int(np.searchsorted(starts, i, side="right")) - 1
        x, y = exact.at(int(cells[ring]), *sources[i, :2].tolist())
        points[i] = float(x), float(y)
    return untied(rings, exact, ties), exact
