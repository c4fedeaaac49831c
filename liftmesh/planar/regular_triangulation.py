"""`RegularTriangulation`: a `Triangulation` of weighted points, with what the weights hide."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from liftmesh._typing import Floats, ParaboloidVertex, Reals, Rows
from liftmesh.base.arrays import read_only, widened
from liftmesh.base.frozen import cached_property
from liftmesh.planar.heights import Heights
from liftmesh.planar.power_cells import rows_without_area
from liftmesh.planar.triangulation import Triangulation

if TYPE_CHECKING:
    from liftmesh.planar.lifting import LowerHull


class RegularTriangulation(Triangulation):
    """A regular triangulation of weighted points, as returned by `regular`.

    A `Triangulation`, with the same attributes and methods; what the weights add stands here.
    Hidden rows have no neighbours, and -1 in ``vertex_to_simplex``. Arrays are read-only.

    Parameters
    ----------
    points, simplices, neighbors, hull, duplicates, skipped
        As for `Triangulation`.
    hidden : (h,) ndarray of int32
        See the attribute.
    weights, radii : (n,) ndarray of float64 or float32, optional
        See the attributes.

    Attributes
    ----------
    weights : (n,) ndarray of float64 or None
        The weight of each row; None if radii were given.
    radii : (n,) ndarray of float64 or None
        The radius of each row, as it was given; None if weights were.
    hidden : (h,) ndarray of int32
        The rows whose lifted point is strictly above the lower hull, in ascending order: also those
        at the position of a heavier row, and every copy of a hidden row.
    duplicates : (k, 2) ndarray of int32
        Rows of the same position and weight as a vertex, each with that vertex, which is the first
        of them.
    skipped : (j,) ndarray of int32
        Rows skipped because a coordinate or the weight is not finite.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0], [4, 0], [0, 4], [4, 4], [1, 1], [3, 2]]
    >>> tri = liftmesh.regular(points, weights=[8, 0, 0, 0, -1, 0])
    >>> tri.hidden, tri.simplices[tri.hidden_to_simplex].tolist()
    (array([4], dtype=int32), [[0, 5, 2]])
    """

    def __init__(  # noqa: PLR0913 - as many as there are arrays
        self,
        points: Reals,
        simplices: Rows,
        neighbors: Rows,
        hull: Rows,
        duplicates: Rows,
        skipped: Rows,
        hidden: Rows,
        *,
        weights: Reals | None = None,
        radii: Reals | None = None,
    ) -> None:
        super().__init__(points, simplices, neighbors, hull, duplicates, skipped)
        self.hidden = read_only(hidden)
        self.weights = None if weights is None else read_only(widened(weights))
        self.radii = None if radii is None else read_only(widened(radii))

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}, {len(self.hidden):,} hidden>"

    @cached_property
    def hidden_to_simplex(self) -> Rows:
        """For each hidden row the triangle below it, (h,) int32.

        It contains the row's position; on an edge or a vertex it is the first that does. The lifted
        row is strictly above the plane of each of these.
        """
        return self._kept(self.find_simplex(self.points[self.hidden]))

    @cached_property
    def degenerate(self) -> Rows:
        """The vertices whose power cell has area zero, (d,) int32, in ascending order.

        Their lifted points are exactly on an edge or a facet that other rows span: the cell is a
        segment, a ray or a line, or a point. They are vertices by the rule for ties.
        """
        return self._kept(rows_without_area(self))

    @property
    def _heights(self) -> Heights:
        return Heights(weights=self.weights, radii=self.radii)

    @cached_property
    def equations(self) -> Floats:
        """The planes of the lifted triangles, (m, 4) float64: downward unit normal and offset.

        The height of a corner is that of the paraboloid less its weight.
        """
        return self._kept(self._heights.planes(self.points, self.simplices))

    def lift_points(self, x: ArrayLike) -> Floats:
        """Lift planar points without weight to the paraboloid: weights lower the rows only.

        Parameters
        ----------
        x : array_like of shape (..., 2)
            Planar points.

        Returns
        -------
        (..., 3) ndarray of float64
            The points with z = x^2 + y^2; for those of rows see `lifted`.

        Raises
        ------
        InputError
            The last axis is not of length two.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.regular([[0, 0], [1, 0], [0, 1]], weights=[5, 5, 5])
        >>> tri.lift_points([3, 4])
        array([ 3.,  4., 25.])
        """
        return super().lift_points(x)

    def plane_distance(self, xi: ArrayLike) -> Floats:
        """Compute the distances of lifted points without weight from the plane of each triangle.

        The plane cuts the paraboloid in the circle that is orthogonal to the circles of the three
        corners, whose squared radii are the weights: below the plane, a point is inside of it.

        Parameters
        ----------
        xi : array_like of shape (..., 2)
            Planar points.

        Returns
        -------
        (..., m) ndarray of float64
            Signed distances, positive below the plane. A point of weight w is lower by w than
            this takes it to be. Rounded.

        Raises
        ------
        InputError
            The last axis is not of length two.

        Examples
        --------
        >>> import liftmesh
        >>> points = [[0, 0], [2, 0], [0, 2]]
        >>> liftmesh.regular(points, weights=[1, 1, 1]).plane_distance([[1, 1], [0, 0]]) > 0
        array([[ True],
               [False]])
        """
        return super().plane_distance(xi)

    def lifted(self, q: ParaboloidVertex = "origin") -> LowerHull:
        """Return the lower hull of the lifted rows; its projection is this triangulation.

        Parameters
        ----------
        q : {"origin", "median"} or (2,) array_like, default "origin"
            The vertex of the paraboloid.

        Returns
        -------
        LowerHull
            A mesh in space: each row at z = |p - q|^2 - w, rounded, the triangles as lower facets.
            Hidden rows are above it.

        Raises
        ------
        InputError
            q is not one of these.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.regular([[0, 0], [4, 0], [0, 4], [1, 1]], radii=[5, 0, 0, 0])
        >>> hull = tri.lifted()
        >>> hull.vertices[:, 2], hull.above
        (array([-25.,  16.,  16.,   2.]), array([3], dtype=int32))
        """
        return super().lifted(q)
