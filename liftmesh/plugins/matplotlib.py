"""Triangulations of matplotlib, whose triangles and locations come from liftmesh.

>>> from liftmesh.plugins.matplotlib import Triangulation
>>> triangulation = Triangulation([0, 1, 0, 1], [0, 0, 1, 1])
>>> triangulation.get_trifinder()([0.25, 0.75, 2], [0.25, 0.75, 0])
array([ 1,  0, -1], dtype=int32)

Every function and class of matplotlib that takes a `matplotlib.tri.Triangulation` takes this one:
``tricontour``, ``tricontourf``, ``tripcolor``, ``triplot``, ``plot_trisurf``,
``LinearTriInterpolator``, ``CubicTriInterpolator``, ``TriAnalyzer``, ``UniformTriRefiner``.
What differs from matplotlib's own:

- Triangles are exact for every finite double, also far from the origin, where matplotlib loses
  points, and of cocircular points the same ones on every machine.
- Locations are exact: on a shared edge the first triangle in order, and never none.
- A coordinate that is not finite, and triangles that overlap or are flat, are errors that name
  them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import as_pairs, triangles_of_faces, used_rows
from liftmesh.base.options import as_threads
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.planar.constrained_triangulation import in_order
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.own_faces import check_faces, kept_rows, with_faces

if TYPE_CHECKING:
    import matplotlib.tri as host

    from liftmesh.planar.triangulation import Triangulation as Solved
else:
    host = load("matplotlib.tri", extra="plot")

_REMEDY = "mask it (set_mask)"


class Triangulation(host.Triangulation):
    """A `matplotlib.tri.Triangulation` whose triangles and locations come from liftmesh.

    Parameters
    ----------
    x, y : (n,) array_like
        Coordinates, which need not be different.
    triangles : (m, 3) array_like of int, optional
        Triangles as rows of them, in any orientation; by default the Delaunay triangulation.
    mask : (m,) array_like of bool, optional
        Which triangles are left out.

    Raises
    ------
    InputError
        A coordinate is not finite, or all points are on a line; a ``ValueError`` as matplotlib's.
    ValueError
        Arrays of other shapes, or rows that do not exist, in matplotlib's words.
    MissingDependencyError
        matplotlib is not installed: as this module is imported.

    See Also
    --------
    liftmesh.Surface.to_matplotlib : A surface as such a triangulation.
    liftmesh.delaunay : The triangulation by itself.

    Notes
    -----
    Rows at a position that an earlier row has are in no triangle. Give ``CubicTriInterpolator`` a
    copy of the values then: it writes to them.

    Examples
    --------
    >>> from matplotlib.tri import LinearTriInterpolator
    >>> from liftmesh.plugins.matplotlib import Triangulation
    >>> triangulation = Triangulation([0, 1, 0, 1], [0, 0, 1, 1])
    >>> float(LinearTriInterpolator(triangulation, [0, 1, 2, 3])(0.5, 0.25))
    1.0
    """

    def __init__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        triangles: ArrayLike | None = None,
        mask: ArrayLike | None = None,
    ) -> None:
        self._solved: Solved | None = None
        self._trifinder: TriFinder | None
        if triangles is None:
            self._solved = delaunay(_pairs(x, y))
            triangles = self._solved.simplices
        super().__init__(x, y, triangles, mask)
        self.is_delaunay = self._solved is not None

    def get_trifinder(self) -> TriFinder:
        """Return the default finder of this triangulation, which is made once.

        Returns
        -------
        TriFinder
            Follows the mask.

        See Also
        --------
        TriFinder : What it finds.

        Examples
        --------
        >>> from liftmesh.plugins.matplotlib import Triangulation
        >>> finder = Triangulation([0, 1, 0], [0, 0, 1]).get_trifinder()
        >>> int(finder(0.2, 0.2))
        0
        """
        if self._trifinder is None:  # set_mask prepares it again
            self._trifinder = TriFinder(self)
        return self._trifinder


class TriFinder(host.TriFinder):
    """Finds the triangles that contain points, exactly; of any `matplotlib.tri.Triangulation`.

    Parameters
    ----------
    triangulation : matplotlib.tri.Triangulation
        This one, or matplotlib's own, for its interpolators' parameter ``trifinder``.

    Raises
    ------
    InputError
        Triangles that are not masked overlap, are flat, or do not meet along whole sides.

    See Also
    --------
    Triangulation.get_trifinder : The finder that is used by default.

    Examples
    --------
    >>> import matplotlib.tri
    >>> from liftmesh.plugins.matplotlib import TriFinder
    >>> theirs = matplotlib.tri.Triangulation([0, 1, 0], [0, 0, 1], [[0, 1, 2]])
    >>> TriFinder(theirs)([0.2, 0.7], [0.2, 0.7])
    array([ 0, -1], dtype=int32)
    """

    def __init__(self, triangulation: host.Triangulation) -> None:
        super().__init__(triangulation)
        self._initialize()

    def _initialize(self) -> None:
        """Prepare; matplotlib calls it when there is another mask."""
        triangulation: Any = vars(self)["_triangulation"]
        self._number: Rows | None = None
        solved = getattr(triangulation, "_solved", None)
        if solved is not None and triangulation.mask is None:
            self._locator = solved._locator  # noqa: SLF001 - of the same package
            self._left = solved.nsimplex
            return
        faces = triangulation.get_masked_triangles()
        if triangulation.mask is not None:
            self._number = np.flatnonzero(~triangulation.mask).astype(np.int32)
        self._left = len(faces)
        self._locator = _locator_of(_pairs(triangulation.x, triangulation.y), faces)

    def __call__(self, x: ArrayLike, y: ArrayLike) -> Rows:
        """Find the triangles that contain points.

        Parameters
        ----------
        x, y : array_like
            Coordinates, of one shape.

        Returns
        -------
        ndarray of int32
            Of that shape: the first triangle that contains each point; -1 where there is none, and
            for points that are not finite.

        Raises
        ------
        ValueError
            x and y have different shapes.

        See Also
        --------
        liftmesh.Triangulation.find_simplex : The same without matplotlib.

        Examples
        --------
        >>> from liftmesh.plugins.matplotlib import Triangulation
        >>> int(Triangulation([0, 1, 0], [0, 0, 1]).get_trifinder()(1, 1))
        -1
        """
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        if x.shape != y.shape:
            raise ValueError("x and y must be array-like with the same shape")
        found = np.empty(x.shape, dtype=np.int32)
        if self._locator is None:
            found[...] = -1
            return found
        pairs = np.stack([x.ravel(), y.ravel()], axis=1)
        self._locator.find(pairs, found.reshape(-1), *as_threads(None, found.size))
        found[found >= self._left] = -1
        if self._number is not None:
            np.copyto(found, self._number[found], where=found >= 0)
        return found


def _pairs(x: ArrayLike, y: ArrayLike) -> Floats:
    """Put coordinates side by side; raise in matplotlib's words where shapes differ."""
    xs, ys = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if xs.shape != ys.shape or xs.ndim != 1:
        raise ValueError(
            f"x and y must be equal-length 1D arrays, but found shapes {xs.shape} and {ys.shape}"
        )
    return as_pairs(np.stack([xs, ys], axis=1))


def _locator_of(points: Floats, faces: Rows) -> _kernel.Locator | None:
    """Prepare locations among faces, whose numbers are the first; None if there are none."""
    if not len(faces):
        return None
    planar = np.full_like(points, np.nan)
    used = used_rows(len(points), faces)
    planar[used] = points[used]
    if not (finite := np.isfinite(planar[used]).all(axis=1)).all():
        row = int(used[np.argmin(finite)])
        raise InputError(f"row {row} of a triangle is not finite: {points[row].tolist()}")
    faces = check_faces(planar, faces, _REMEDY)
    solved = delaunay(planar, nonfinite="skip", order="canonical")
    no_edges = np.empty((0, 2), dtype=np.int32)
    whole, _ = with_faces(solved, faces, np.zeros(len(points)), no_edges, _REMEDY)
    corners = kept_rows(solved)[faces]
    is_face = np.zeros(whole.nsimplex, dtype=np.bool_)
    place = triangles_of_faces(whole.simplices, corners, len(points))
    is_face[place] = True
    order = np.concatenate([place, np.flatnonzero(~is_face)])
    simplices, neighbors = in_order(order, whole.simplices, whole.neighbors)
    return _kernel.Locator(planar, simplices, neighbors)
