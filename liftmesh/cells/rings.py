"""`Rings`: closed chains of corners, each with where it comes from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows


@dataclass(slots=True, eq=False)
class Rings:
    """Closed chains of corners.

    Parameters
    ----------
    sources : (k, 3) ndarray of int32
        Of each corner: the edge or corner of the domain; the row across the ridge or the triangle;
        the row beyond the side to the next corner. See ``clip.hpp``.
    points : (k, 2) ndarray of float64
        Where it is.
    starts : (r + 1,) ndarray of int64
        Ring i has the corners from ``starts[i]`` to ``starts[i + 1]``.
    cells : (r,) ndarray of int32
        The row whose cell it bounds.
    cut : int
        The first so many rings have corners of the domain, or on its edges; the others are whole
        cells.
    """

    sources: Rows
    points: Floats
    starts: NDArray[np.int64]
    cells: Rows
    cut: int

    def of_the_domain(self) -> Rings:
        """Return the rings that are cut."""
        end = self.starts[self.cut]
        corners = self.sources[:end], self.points[:end]
        return Rings(*corners, self.starts[: self.cut + 1], self.cells[: self.cut], self.cut)

    def taken(self, chosen: NDArray[np.int64]) -> Rings:
        """Return some rings, in ascending order.

        Parameters
        ----------
        chosen : (c,) ndarray of int64
            Their numbers.

        Returns
        -------
        Rings
            Only these.
        """
        count = np.diff(self.starts)[chosen]
        starts = np.concatenate([[0], np.cumsum(count)])
        corners = np.repeat(self.starts[chosen] - starts[:-1], count) + np.arange(starts[-1])
        cut = int(np.count_nonzero(chosen < self.cut))
        return Rings(self.sources[corners], self.points[corners], starts, self.cells[chosen], cut)

    @staticmethod
    def joined(*several: Rings) -> Rings:
        """Return all of several rings, of which those that are cut come first.

        Parameters
        ----------
        *several : Rings
            At least one.

        Returns
        -------
        Rings
            One after the other.
        """
        counts = np.concatenate([np.diff(rings.starts) for rings in several])
        return Rings(
            np.concatenate([rings.sources for rings in several]),
            np.concatenate([rings.points for rings in several]),
            np.concatenate([[0], np.cumsum(counts)]),
            np.concatenate([rings.cells for rings in several]),
            sum(rings.cut for rings in several),
        )

    @property
    def ring_of(self) -> NDArray[np.int64]:
        """The ring of each corner."""
        return np.repeat(np.arange(len(self.cells)), np.diff(self.starts))

    @property
    def following(self) -> NDArray[np.int64]:
        """The corner after each, in its ring."""
        following = np.arange(1, len(self.points) + 1)
        full = np.diff(self.starts) > 0
        following[self.starts[1:][full] - 1] = self.starts[:-1][full]
        return following
