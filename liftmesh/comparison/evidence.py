"""Selection of the really different triangles to prove: some of each result, in order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Rows
from liftmesh.comparison.cells import Cells, opposite_rows
from liftmesh.comparison.proofs import Proof, broken_cell, confirm, refute

if TYPE_CHECKING:
    from liftmesh.comparison.differences import Differences
    from liftmesh.planar.triangulation import Triangulation


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """The data for proofs."""

    triangulation: Triangulation
    rows: Rows
    lower: Rows
    cells: Cells
    differences: Differences

    def proofs(self, limit: int) -> list[Proof]:
        """Prove the first differences: liftmesh's errors if any, then half of each kind."""
        faults = list(islice(self._faults(), limit))
        limit -= len(faults)
        for_wrong = limit - min(limit // 2, len(self.differences.missing))
        wrong = list(islice(self._wrong(), for_wrong))
        return [*faults, *wrong, *islice(self._missing(), limit - len(wrong))]

    def _faults(self) -> Iterator[Proof]:
        """Refute triangles of liftmesh that are not Delaunay."""
        simplices, points = self.triangulation.simplices, self.triangulation.points
        for index, _ in self.cells.violations:
            proof = refute(points, self.rows, simplices[index], claim="wrong triangle")
            if proof is not None:  # pragma: no branch - there is always one
                yield proof

    def _wrong(self) -> Iterator[Proof]:
        """Refute facets of trimesh: by a point inside their circle, or by their cell."""
        facets = self.lower[self.differences.wrong]
        for facet, cell in zip(facets, self.differences.wrong_cell, strict=True):
            proof = refute(self.triangulation.points, self.rows, facet) if cell < 0 else None
            yield proof or broken_cell(facet)

    def _missing(self) -> Iterator[Proof]:
        """Confirm triangles of liftmesh that trimesh lacks."""
        simplices, points = self.triangulation.simplices, self.triangulation.points
        for index in self.differences.missing:
            proof = confirm(points, self.rows, simplices[index], self._apexes(int(index)))
            if proof is not None:
                yield proof

    def _apexes(self, index: int) -> list[int]:
        """Return the rows opposite the edges of a triangle that have a neighbour."""
        neighbors = self.triangulation.neighbors[index]
        edge = np.flatnonzero(neighbors >= 0)
        triangle = np.full(len(edge), index, dtype=np.intp)
        apexes = opposite_rows(self.triangulation.simplices, triangle, edge, neighbors[edge])
        return [int(row) for row in apexes]
