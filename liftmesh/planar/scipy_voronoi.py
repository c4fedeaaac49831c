"""`Voronoi`: Voronoi diagrams of planar points, as ``scipy.spatial.Voronoi`` has them.

The class inherits from SciPy's, so that code which asks for an instance of it takes this one, and
has its attributes; but it never runs Qhull. The vertices come from the exact triangulation. Ridges
and regions are found when one of them is first asked for; lists, which take longer than everything
else, when they are.

SciPy is imported with this module, which is when ``liftmesh.Voronoi`` is first asked for.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import read_only
from liftmesh.base.frozen import check_adjacent, check_copied, check_numbers
from liftmesh.base.options import as_switch
from liftmesh.optional import load
from liftmesh.planar.diagram import Regions, diagram_of, regions_of, ridges_by_rows
from liftmesh.planar.scipy_class import Growing, check_qhull_options, planar_rows, solved

if TYPE_CHECKING:
    from scipy import spatial
else:
    spatial = load("scipy.spatial")


class Voronoi(Growing, spatial.Voronoi):  # type: ignore[misc]
    """Drop-in replacement for ``scipy.spatial.Voronoi``, and an instance of it.

    The topology is exact: sites on one circle share one vertex, and no region is lost at any
    offset. Each coordinate of a vertex is the double nearest to the exact one. Further differences
    from SciPy: points are planar only; the corners of a region are counter-clockwise, those of an
    unbounded one begin with -1, and unbounded regions come first. As with SciPy, ``vertices``,
    ``ridge_points``, ``point_region`` and the lists may be written to; other arrays are read-only.

    Parameters
    ----------
    points : array_like of shape (n, 2)
        Planar points.
    furthest_site : bool, default False
        Whether to compute the farthest-site diagram: a region holds what is farther from its site
        than from all others.
    incremental : bool, default False
        Whether points can be added, by `add_points`, until `close` is called.
    qhull_options : str, optional
        Options of Qhull, by default "Qbb Qc Qz", or "Qbb Qc" if `incremental`. "Qz" adds an empty
        region, which is the first. Others that serve Qhull's rounding or its output have no effect;
        those that would change the diagram raise an error.
    copy : bool, default False
        Whether to copy the points first, as for `delaunay`; `incremental` always does.

    Attributes
    ----------
    points : (n, 2) ndarray of float64
        The sites.
    vertices : (v, 2) ndarray of float64
        The Voronoi vertices. Beyond the greatest double, a coordinate is infinite.
    overflowed : int
        How many vertices have an infinite coordinate.
    ridge_points : (r, 2) ndarray of int32
        The rows of the two sites between which each ridge lies. The second site of a ray follows
        the first on the hull, counter-clockwise: the ray runs to the right of the line from one to
        the other, or to its left with `furthest_site`.
    ridge_ends : (r, 2) ndarray of int32
        The vertices at both ends of each ridge, the lesser first; the first of a ray is -1.
    ridge_vertices : list of list of int
        The same as lists.
    ridge_dict : dict
        `ridge_vertices` by the two rows of `ridge_points`.
    point_region : (n,) ndarray of intp
        The region of each row. Duplicates share one. With `furthest_site`, rows that are no corners
        of the convex hull have the empty region, or -1 if there is none; SciPy makes an empty
        region for each.
    simplices : (m, 3) ndarray of int32
        The Delaunay triangles.
    simplex_to_vertex : (m,) ndarray of int32
        The vertex that is the centre of each triangle's circle.
    duplicates : (k, 2) ndarray of int32
        Rows at the position of another, each with the first row there.
    ndim, npoints, min_bound, max_bound, furthest_site
        As for `Delaunay`.

    Raises
    ------
    InputError
        As for `delaunay`, or an option is set that liftmesh does not support.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line. The error is a
        ``scipy.spatial.QhullError`` too.

    Examples
    --------
    >>> diagram = Voronoi([[0, 0], [2, 0], [2, 2], [0, 2], [5, 1]])
    >>> diagram.vertices
    array([[1.        , 1.        ],
           [3.33333333, 1.        ]])
    >>> diagram.regions[diagram.point_region[4]]
    [-1, 1]
    """

    _kind = "diagram"

    def __init__(
        self,
        points: ArrayLike,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        copy: bool = False,
    ) -> None:
        rows = planar_rows(points, "Voronoi")
        self.furthest_site = as_switch("furthest_site", furthest_site)
        check_qhull_options(qhull_options, "Voronoi")
        is_growing = as_switch("incremental", incremental)
        default = "Qbb Qc" if is_growing else "Qbb Qc Qz"
        options = default if qhull_options is None else qhull_options
        self._empty_regions = int("Qz" in options.split())
        self._compute(rows, copy=as_switch("copy", copy) or is_growing)
        self._can_grow = is_growing

    def _compute(self, rows: Floats, *, copy: bool) -> None:
        solution = solved(rows, furthest_site=self.furthest_site, copy=copy)
        for name in ("regions", "ridge_vertices", "ridge_dict", "point_region", "region_vertices",
                     "ridge_points", "_found"):  # fmt: skip
            self.__dict__.pop(name, None)
        points, simplices = read_only(solution["points"]), read_only(solution["simplices"])
        diagram = diagram_of(points, simplices, solution["neighbors"])
        self._points = points
        self.npoints, self.ndim = points.shape
        on_hull = points[solution["hull"]]
        self.min_bound, self.max_bound = on_hull.min(axis=0), on_hull.max(axis=0)
        self.simplices, self.duplicates = simplices, solution["duplicates"]
        self.vertices = diagram.vertices.copy()  # SciPy's users write to it, as to ridge_points
        self.simplex_to_vertex = read_only(diagram.simplex_to_vertex)
        self.overflowed = diagram.overflowed
        self._neighbors = solution["neighbors"]

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        check_copied(len(self._points), self.simplices, self._neighbors, self.duplicates)
        check_adjacent(self.simplices, self._neighbors)
        check_numbers(0, len(self.vertices), self.simplex_to_vertex)

    @cached_property
    def _found(self) -> Regions:
        return regions_of(self.npoints, self.simplices, self._neighbors, self.simplex_to_vertex)

    @cached_property
    def ridge_points(self) -> Rows:
        """The rows of the two sites of each ridge, (r, 2) int32."""
        rows: Rows = self._found.ridge_points.copy()
        return rows

    @property
    def ridge_ends(self) -> Rows:
        """The vertices at both ends of each ridge, (r, 2) int32; the first of a ray is -1."""
        return self._found.ridge_ends

    @cached_property
    def point_region(self) -> NDArray[np.intp]:
        """The region of each row, (n,) intp."""
        region = np.add(self._found.region_of, self._empty_regions, dtype=np.intp)
        row, kept = self.duplicates.T
        region[row] = region[kept]
        return region

    @property
    def points(self) -> Floats:
        """The sites, (n, 2) float64, read-only."""
        return self._points

    @cached_property
    def region_vertices(self) -> tuple[Rows, Rows]:
        """The vertices around each region as arrays: indptr, (regions + 1,), and indices, int32.

        Those of region i are ``indices[indptr[i]:indptr[i + 1]]``, counter-clockwise; those of an
        unbounded region begin with -1.
        """
        empty = np.zeros(self._empty_regions, dtype=np.int32)
        return np.concatenate([empty, self._found.starts]), self._found.corners

    @cached_property
    def regions(self) -> list[list[int]]:
        """The vertices around each region as lists, as SciPy has them."""
        starts, corners = (part.tolist() for part in self.region_vertices)
        return [corners[start:end] for start, end in pairwise(starts)]

    @cached_property
    def ridge_vertices(self) -> list[list[int]]:
        """The vertices at both ends of each ridge as lists; -1 is at infinity."""
        ends: list[list[int]] = self.ridge_ends.tolist()
        return ends

    @cached_property
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """The vertices of each ridge by the rows of its two sites."""
        return ridges_by_rows(self.ridge_points, self.ridge_vertices)
