"""`Cells`: Voronoi or power cells inside a domain, as arrays, with their measures."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Rows
from liftmesh.arrays import read_only
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.clipping import clip
from liftmesh.cells.unclipped import Unclipped
from liftmesh.frozen import check_adjacent, check_copied, check_numbers

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain
    from liftmesh.cells.dual import Dual


class Cells(ClippedCells):
    """Voronoi or power cells inside a domain, as returned by `voronoi` and `power_diagram`.

    Row i has the parts from ``parts[i]`` to ``parts[i + 1]``: none if its cell lies outside the
    domain, and several if the domain cuts it apart. Part j has the rings from ``rings[j]`` to
    ``rings[j + 1]``, of which the first turns counter-clockwise, and the others are holes and turn
    clockwise. Ring k has the corners from ``ring_corners[k]`` to ``ring_corners[k + 1]``. The
    arrays are read-only.

    Which corners there are is exact, and each coordinate is the double nearest to the exact one.

    Parameters
    ----------
    dual : Dual
        The sites.
    domain : Domain
        What the cells are clipped to.

    Attributes
    ----------
    points : (n, 2) ndarray of float64
        The sites.
    domain : Domain
        The domain: its ``corners``, the ``starts`` of its rings, and what it is as ``text``.
    parts, rings, ring_corners : ndarray of int64
        Where the parts of rows, the rings of parts and the corners of rings start, and the end.
    corners : (k, 2) ndarray of float64
        The corners of all rings.
    beyond : (k,) ndarray of int32
        The row on the other side of the side from each corner to the next; -1 at the boundary of
        the domain.
    duplicates : (d, 2) ndarray of int32
        Rows of the same position and weight as another, each with the first of these, which has
        the cell.
    hidden : (h,) ndarray of int32
        Rows that have no cell anywhere, because others are heavier.
    degenerate : (d,) ndarray of int32
        Rows whose cell has no area anywhere, but is a segment, a ray, a line or a point: what is as
        near to them is as near to others.

    Examples
    --------
    >>> import liftmesh
    >>> cells = liftmesh.voronoi([[0, 0], [2, 0], [1, 2]], domain=(-1, -1, 3, 3))
    >>> cells
    <Cells: 3 of 3 rows have an area in the box (-1.0, -1.0, 3.0, 3.0)>
    >>> cells.areas
    array([4.5, 4.5, 7. ])
    >>> cells.neighbors
    array([[0, 1],
           [0, 2],
           [1, 2]], dtype=int32)
    """

    def __init__(self, dual: Dual, domain: Domain) -> None:
        super().__init__(dual.points, domain, *clip(dual, domain))
        self.duplicates, self.hidden = read_only(dual.duplicates), read_only(dual.hidden)
        self.degenerate = read_only(dual.degenerate)
        self._dual = dual

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        dual = self._dual
        check_copied(len(self.points), dual.simplices, dual.neighbors, dual.chain)
        check_adjacent(dual.simplices, dual.neighbors)
        check_numbers(0, len(dual.vertices), dual.simplex_to_vertex)

    @cached_property
    def corner_kinds(self) -> NDArray[np.uint8]:
        """Where each corner comes from, (k,) uint8.

        0 is a vertex of the diagram, 1 a crossing of an edge of the domain with a ridge, 2 a corner
        of the domain.
        """
        edge, other, _ = self._sources.T
        return read_only(np.where(edge < 0, 0, np.where(other >= 0, 1, 2)).astype(np.uint8))

    @cached_property
    def corner_sources(self) -> Rows:
        """What each corner is made of, (k, 3) int32, so that it can be computed exactly.

        A vertex: three rows of equal power. A crossing: the two rows of the ridge, and the edge of
        the domain, which has the number of the corner it leaves. A corner of the domain: its
        number, and -1 twice.
        """
        edge, other, _ = self._sources.T
        found = np.stack([edge, other, np.full_like(edge, -1)], axis=1)
        is_vertex, is_crossing = self.corner_kinds == 0, self.corner_kinds == 1
        found[is_vertex] = self._dual.simplices[other[is_vertex]]
        own = self._cell_of_corner[is_crossing].astype(np.int32)
        found[is_crossing] = np.stack([own, other[is_crossing], edge[is_crossing]], axis=1)
        return read_only(found)

    @cached_property
    def unclipped(self) -> Unclipped:
        """The diagram in the whole plane, with rays, whatever the domain; made at first use."""
        return Unclipped(self._dual)
