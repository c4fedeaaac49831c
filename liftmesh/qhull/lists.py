"""What SciPy's diagrams share, in the plane and in space: options, and lists that are made late."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows
from liftmesh.base.frozen import cached_property
from liftmesh.planar.diagram import ridges_by_rows
from liftmesh.qhull.common import Growing

_LATER = ("regions", "ridge_vertices", "ridge_dict", "point_region", "region_vertices",
          "ridge_points", "_found")  # fmt: skip


class Lists(Growing):
    """A diagram whose regions are numbered by `_found`."""

    _kind = "diagram"
    _peer = "Voronoi"
    _points: Floats
    duplicates: Rows

    if TYPE_CHECKING:  # what the classes have

        @property
        def _found(self) -> Any: ...

        @property
        def ridge_points(self) -> Rows:
            """The two sites of each ridge."""

        @property
        def ridge_vertices(self) -> list[list[int]]:
            """The vertices of each ridge."""

    def _heed(self, options: str | None, *, is_growing: bool) -> None:
        default = "Qbb Qc" if is_growing else "Qbb Qc Qz"
        self._empty_regions = int("Qz" in (default if options is None else options).split())

    def _forget(self) -> None:
        """Forget what was computed of other points."""
        for name in _LATER:
            self.__dict__.pop(name, None)

    @cached_property
    def point_region(self) -> NDArray[np.intp]:
        """The region of each row, (n,) intp."""
        region: NDArray[np.intp] = np.add(self._found.region_of, self._empty_regions, dtype=np.intp)
        row, kept = self.duplicates.T
        region[row] = region[kept]
        return region

    @property
    def points(self) -> Floats:
        """The sites, (n, d) float64, read-only."""
        return self._points

    @cached_property
    def region_vertices(self) -> tuple[Rows, Rows]:
        """The vertices around each region as arrays: indptr, (regions + 1,), and indices, int32.

        Those of region i are ``indices[indptr[i]:indptr[i + 1]]``, in the plane counter-clockwise,
        in space ascending; those of an unbounded region begin with -1.
        """
        empty = np.zeros(self._empty_regions, dtype=np.int32)
        return np.concatenate([empty, self._found.starts]), self._found.corners

    @cached_property
    def regions(self) -> list[list[int]]:
        """The vertices around each region as lists, as SciPy has them."""
        starts, corners = (part.tolist() for part in self.region_vertices)
        return [corners[start:end] for start, end in pairwise(starts)]

    @cached_property
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """The vertices of each ridge by the rows of its two sites."""
        return ridges_by_rows(self.ridge_points, self.ridge_vertices)
