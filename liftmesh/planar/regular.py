"""regular(): planar regular triangulations of weighted points, the duals of power diagrams.

A point p of weight w is lifted to z = |p|^2 - w. The lower hull of the lifted points projects to
the regular triangulation; rows above it are hidden.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Apex, Floats, Progress, Reals, Rows
from liftmesh.base.arrays import as_coordinates, of_one_array, read_only, widened
from liftmesh.base.frozen import cached_property
from liftmesh.base.options import NonFinite, RowOrder, as_switch, as_threads
from liftmesh.planar.delaunay import Solution, check_options, solution_of
from liftmesh.planar.diagram import LiftedTriangles, rows_without_area
from liftmesh.planar.kinds import TriangulationKind, as_weights, named_values, weights_or_radii
from liftmesh.planar.lifting import Heights, LowerHull
from liftmesh.planar.points import rows_of
from liftmesh.planar.triangulation import Triangulation


@of_one_array
def regular(
    points: ArrayLike,
    *,
    weights: ArrayLike | str | None = None,
    radii: ArrayLike | str | None = None,
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
    copy: bool = False,
) -> RegularTriangulation:
    """Compute the regular triangulation of weighted points, exact for every finite double.

    It is the dual of the power diagram: a point x belongs to the row p of least power
    |x - p|^2 - w, and two rows whose cells share a side share an edge. With equal weights, it is
    the Delaunay triangulation. A row whose lifted point is strictly above the lower hull has no
    cell: it is hidden. The result is unique: where four or more lifted points lie in a plane, it is
    that of the symbolic perturbation of `delaunay`.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `delaunay`.
    weights : (n,) array_like or str, optional
        The weight of each row, positive or not: numbers as for `points`, read in place where they
        are floats. Or the name of them: of named values of a `Cloud`, of a tensor cloud of Open3D,
        of a column of a table, or "weights" for those of a ``trimesh.PointCloud``.
    radii : (n,) array_like or str, optional
        Instead of weights, the radius of a circle around each row, not negative: its weight is the
        square of the radius, which is never rounded.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity, in the coordinates or as weight, raise an error, or are
        skipped and listed in ``skipped``.
    order, threads, progress
        As for `delaunay`.
    copy : bool, default False
        Whether to copy points and weights first, as for `delaunay`.

    Returns
    -------
    RegularTriangulation
        Indices are rows of `points`; nothing is reordered or dropped. Of rows at one position the
        heaviest is the vertex, and the others are in ``hidden``; of several that weigh as much it
        is the first, and the others are in ``duplicates``. If it is hidden, so are they all. A row
        that is exactly on a facet of the lower hull is a vertex; ``degenerate`` lists it.

    Raises
    ------
    InputError
        As for `delaunay`; or both or neither of weights and radii are given, there is not one for
        each row, a radius is negative, or the points have no values of that name.
    NonFiniteError
        A coordinate, a weight or a radius is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    UnsupportedTypeError
        `points` is a path, or a column for each axis was given.

    See Also
    --------
    delaunay : Points without weights.
    power_diagram : The dual cells, inside a domain.
    apollonius : The graph of disks by the distance from their boundaries.
    verify : An exact check of the result.

    Notes
    -----
    F. Aurenhammer, "Power diagrams: properties, algorithms and applications", SIAM J. Comput. 16
    (1987), for the diagram and the lift. The triangles come from divide and conquer on the lifted
    lower hull, as for `delaunay`, whose merges also remove what becomes hidden (see
    ARCHITECTURE.md): O(n log n) on every input. Peak memory is about 90 bytes per point beyond the
    points and the weights, of which the result is up to 48.

    Examples
    --------
    >>> corners = [[0, 0], [4, 0], [4, 4], [0, 4], [2, 1]]
    >>> tri = regular(corners, weights=[0, 0, 0, 0, 1])
    >>> tri
    <RegularTriangulation: 4 triangles over 5 rows, 0 duplicates, 0 skipped, 0 hidden>
    >>> regular(corners, weights=[9, 0, 0, 0, -9]).hidden
    array([4], dtype=int32)
    >>> regular(corners, radii=[6, 0, 0, 0, 0]).simplices.shape
    (2, 3)
    """
    kind, given = weights_or_radii(weights, radii)
    if isinstance(given, str):
        points, given = _named(points, kind, given)
    options = (nonfinite, order, threads, progress, copy)
    return regular_triangulation_of(solve(rows_of(points), kind, given, *options))


def _named(points: Any, kind: str, name: str) -> tuple[ArrayLike, ArrayLike]:
    """Return the points of a cloud or table and its values of a name."""
    from liftmesh.io.registry import as_cloud  # noqa: PLC0415 - arrays do without

    cloud = as_cloud(points)
    return cloud.points, named_values(cloud, kind, name)


def solve(
    points: ArrayLike,
    kind: str,
    given: Any,
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
    copy: bool = False,
) -> Solution:
    """Compute what a `RegularTriangulation` is made of."""
    check_options(nonfinite, order, progress)
    is_copied = as_switch("copy", copy)
    rows = as_coordinates(points)
    values = as_weights(kind, given, len(rows))
    planar = rows if rows.shape[1] == 2 else rows[:, :2]
    if is_copied:
        planar, values = planar.copy(), replace(values, values=values.values.copy())
    is_skipping = nonfinite == "skip"
    outcome, hidden = _kernel.regular(
        _without_skipped(planar, values, skipping=is_skipping),
        values.values,
        kind == "radii",
        is_skipping,
        *as_threads(threads, len(rows)),
        progress,
    )
    solution = solution_of(outcome, rows, planar, order, progress, threads)
    return solution._replace(hidden=hidden, weights=values)


def _without_skipped(planar: Reals, values: TriangulationKind, *, skipping: bool) -> Reals:
    """Return the points, or a copy that marks rows whose weight is not finite."""
    finite = values.finite(skipping=skipping)
    if finite is None:
        return planar
    marked: Reals = planar.copy()
    marked[~finite] = np.nan
    return marked


def regular_triangulation_of(solution: Solution) -> RegularTriangulation:
    """Make a triangulation of weighted points."""
    kind = solution.weights or TriangulationKind()
    return RegularTriangulation(
        *solution[:6],
        solution.hidden,
        weights=kind.values if kind.name == "weights" else None,
        radii=kind.values if kind.name == "radii" else None,
    )


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

    See Also
    --------
    regular : Computes it.
    Triangulation : Without weights.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0], [4, 0], [0, 4], [4, 4], [1, 1], [3, 2]]
    >>> tri = liftmesh.regular(points, weights=[8, 0, 0, 0, -1, 0])
    >>> tri.hidden, tri.simplices[tri.hidden_to_simplex].tolist()
    (array([4], dtype=int32), [[0, 5, 2]])
    """

    _has_empty_circles = False

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
        name = "weights" if self.radii is None else "radii"
        triangles = self.points, self.simplices, self.neighbors, self._hull
        kind = TriangulationKind(name, getattr(self, name))
        return self._kept(rows_without_area(LiftedTriangles(*triangles, kind)))

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

        See Also
        --------
        lift : Any apex.
        RegularTriangulation.plane_distance : How far points are from the lifted triangles.

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

        See Also
        --------
        RegularTriangulation.lift_points : The lift of points.

        Examples
        --------
        >>> import liftmesh
        >>> points = [[0, 0], [2, 0], [0, 2]]
        >>> liftmesh.regular(points, weights=[1, 1, 1]).plane_distance([[1, 1], [0, 0]]) > 0
        array([[ True],
               [False]])
        """
        return super().plane_distance(xi)

    def lifted(self, apex: Apex = "median") -> LowerHull:
        """Return the lower hull of the lifted rows; its projection is this triangulation.

        Parameters
        ----------
        apex : {"median", "origin"} or (2,) array_like, default "median"
            The apex of the paraboloid, as for `lift`.

        Returns
        -------
        LowerHull
            A mesh in space: each row at z = |p - a|^2 - w, rounded, the triangles as lower facets.
            Hidden rows are above it.

        Raises
        ------
        InputError
            The apex is not one of these.

        See Also
        --------
        lift : The lift without weights.
        lower_hull : The lower hull of any points in space.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.regular([[0, 0], [4, 0], [0, 4], [1, 1]], radii=[5, 0, 0, 0])
        >>> hull = tri.lifted("origin")
        >>> hull.vertices[:, 2], hull.above
        (array([-25.,  16.,  16.,   2.]), array([3], dtype=int32))
        """
        return super().lifted(apex)
