"""`Rings`: closed chains of corners, each with where it comes from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows


@dataclass(slots=True, eq=False)
class Rings:
    """Closed chains of corners."""

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
        """Return some rings, in ascending order."""
        count = np.diff(self.starts)[chosen]
        starts = np.concatenate([[0], np.cumsum(count)])
        corners = np.repeat(self.starts[chosen] - starts[:-1], count) + np.arange(starts[-1])
        cut = int(np.count_nonzero(chosen < self.cut))
        return Rings(self.sources[corners], self.points[corners], starts, self.cells[chosen], cut)

    @staticmethod
    def joined(*several: Rings) -> Rings:
        """Return all of several rings, of which those that are cut come first."""
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
