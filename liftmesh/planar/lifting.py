"""Lifting of planar points, and the lower hull of the lifted points.

A planar point is lifted to z = (x - ax)^2 + (y - ay)^2; (ax, ay) is the apex of the paraboloid (the
paper's q). The lower facets of the convex hull of the lifted points project to the Delaunay
triangles. The apex changes the heights, never the triangles.

A metric lifts to another quadratic form, and weights lower the rows. All these heights are rounded,
and shown to those who ask for the lifted points: no triangle depends on them, for the kernel
decides by exact signs of the coordinates, the weights, the radii and the metric themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Apex, Floats, Reals, Rows
from liftmesh.base.arrays import (
    as_any_columns,
    as_coordinates,
    as_numbers,
    as_rows3,
    read_only,
)
from liftmesh.base.frozen import FrozenResult, check_numbers
from liftmesh.base.options import refused
from liftmesh.errors import InputError
from liftmesh.planar.points import as_complex, rows_of

if TYPE_CHECKING:
    import open3d as o3d
    import trimesh

    from liftmesh import _kernel
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult


def lift(points: ArrayLike, apex: Apex = "median", *, dimension: Literal[2, 3] = 2) -> Floats:
    """Lift planar points to the paraboloid z = (x - ax)^2 + (y - ay)^2 with the apex (ax, ay).

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, or a cloud or mesh as for `delaunay`; a third coordinate is ignored.
    apex : {"median", "origin"} or (dimension,) array_like, default "median"
        The apex of the paraboloid: the coordinate-wise median of the distinct points that are
        finite, about which rounded heights are the most accurate; the origin, which gives
        z = x^2 + y^2; or any finite point.
    dimension : {2, 3}, default 2
        With 3 points in space are lifted, by the sum of the squares of all three coordinates.

    Returns
    -------
    (n, dimension + 1) ndarray of float64
        Coordinates as given; the last computed in float64, with rounding (infinite if it
        overflows).

    Raises
    ------
    InputError
        Points or the apex are invalid.

    See Also
    --------
    project : The way back.
    Triangulation.lifted : The lower hull of lifted points.
    lower_hull : The lower hull of any points in space.

    Examples
    --------
    >>> lift([[3, 4], [1, 0]], apex="origin")
    array([[ 3.,  4., 25.],
           [ 1.,  0.,  1.]])
    >>> lift([[0, 0], [2, 0], [2, 0], [3, 1]])[:, 2]
    array([4., 0., 0., 2.])
    >>> lift([[1, 2, 3]], apex="origin", dimension=3)
    array([[ 1.,  2.,  3., 14.]])
    """
    if not (isinstance(dimension, int | np.integer) and dimension in (2, 3)):
        raise refused("dimension", dimension, "give 2 or 3")
    rows = as_coordinates(rows_of(points))[:, :dimension]
    if rows.shape[1] < dimension:
        raise InputError("points have two columns: give z as a third, or lift them as planar ones")
    place = _apex_in_space(apex, rows) if dimension == 3 else resolve_apex(apex, rows)
    lifted = np.zeros((len(rows), dimension + 1))
    lifted[:, :dimension] = rows
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        for axis, value in enumerate(place):
            lifted[:, dimension] += (lifted[:, axis] - value) ** 2
    return lifted


def project(points: ArrayLike) -> Floats:
    """Project lifted points back onto the plane: the inverse of `lift`.

    Parameters
    ----------
    points : array_like of shape (n, 3) or (n, 4)
        Points in space, or a cloud or mesh as for `delaunay`; or points in space that were lifted.

    Returns
    -------
    (n, 2) or (n, 3) ndarray of float64
        All columns but the last: a read-only view if the points are float64.

    Raises
    ------
    InputError
        Points are invalid.

    See Also
    --------
    lift : The way there.

    Examples
    --------
    >>> project(lift([[3, 4]]))
    array([[3., 4.]])
    """
    if isinstance(points, np.ndarray) and points.shape[1:] == (4,):
        return read_only(as_any_columns(points)[:, :3])
    return read_only(as_rows3(rows_of(points))[:, :2])


def resolve_apex(apex: Apex, points: Reals) -> tuple[float, float]:
    """Convert the option apex to coordinates."""
    place = given_apex(apex)
    if place is not None:
        return place
    return (0.0, 0.0) if isinstance(apex, str) and apex == "origin" else _median(points)


def given_apex(apex: Apex) -> tuple[float, float] | None:
    """Validate the option apex, and return the point if it is one."""
    place = _given(apex, "(x, y)", 2)
    return None if place is None else (place[0], place[1])


def _given(apex: Apex, shown: str, length: int) -> list[float] | None:
    if isinstance(apex, str):
        if apex in ("median", "origin"):
            return None
        raise refused("apex", apex, f"give 'median', 'origin' or a point {shown}")
    with np.errstate(all="ignore"):
        place = as_numbers("apex", apex, f"give 'median', 'origin' or a point {shown}")
    if place.shape != (length,) or not np.isfinite(place).all():
        raise refused("apex", apex, f"give 'median', 'origin' or a finite point {shown}")
    values: list[float] = place.tolist()
    return values


def _apex_in_space(apex: Apex, points: Reals) -> list[float]:
    """Convert the option apex to three coordinates."""
    place = _given(apex, "(x, y, z)", 3)
    finite = points[np.isfinite(points).all(axis=1)]
    if place is None and (apex == "origin" or not len(finite)):
        place = [0.0] * 3
    if place is None:
        place = _middle(np.unique(finite.astype(np.float64) + 0.0, axis=0).T)
    return place


def _middle(columns: Floats) -> list[float]:
    """Return the median of each column, at half scale if it would overflow."""
    scale = 0.5 if np.abs(columns).max() > 2.0**1022 else 1.0
    values: list[float] = (np.median(columns * scale, axis=1) / scale).tolist()
    return values


def _median(points: Reals) -> tuple[float, float]:
    """Coordinate-wise median of the distinct finite points."""
    finite = points[np.isfinite(points).all(axis=1)]
    if len(finite) == 0:
        return 0.0, 0.0
    distinct = np.unique(as_complex(finite + 0.0))  # 0.0 is -0.0
    x, y = _middle(np.stack([distinct.real, distinct.imag]))
    return x, y


@dataclass(frozen=True, slots=True, eq=False)
class Heights:
    """The heights of points: those of a paraboloid or a metric, less the weights."""

    metric: Floats | None = None
    weights: Floats | None = None
    radii: Floats | None = None

    def lifted(self, points: Floats, apex: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Lift points without weight."""
        if self.metric is None:
            return lift(points, apex)
        placed = np.empty((len(points), 3))
        placed[:, :2] = points
        with np.errstate(all="ignore"):
            placed[:, 2] = self._product(points - apex, points - apex)
        return placed

    def lifted_rows(self, points: Floats, apex: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Lift the rows, each lowered by its weight."""
        lifted = self.lifted(points, apex)
        with np.errstate(all="ignore"):
            if self.weights is not None:
                lifted[:, 2] -= self.weights
            elif self.radii is not None:
                lifted[:, 2] -= self.radii * self.radii
        return lifted

    def planes(self, points: Floats, simplices: Rows) -> Floats:
        """Compute the planes of lifted triangles."""
        a, b, c = (points[corner] for corner in simplices.T)
        u, v = b - a, c - a
        with np.errstate(all="ignore"):
            rise_u = self._product(u, a + b) - self._lowering(*simplices[:, :2].T)
            rise_v = self._product(v, a + c) - self._lowering(*simplices[:, ::2].T)
            area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
            slope_x = (rise_u * v[:, 1] - rise_v * u[:, 1]) / area
            slope_y = (rise_v * u[:, 0] - rise_u * v[:, 0]) / area
            at_a = self._product(a, a) - self._lowering(None, simplices[:, 0])
            height = at_a - slope_x * a[:, 0] - slope_y * a[:, 1]
            planes = np.stack([slope_x, slope_y, np.full_like(area, -1.0), height], axis=1)
            unit: Floats = planes / np.sqrt(slope_x**2 + slope_y**2 + 1)[:, None]
        return unit

    def _product(self, u: Floats, v: Floats) -> Floats:
        """Inner products of vectors, row by row."""
        product: Floats = (u * (v if self.metric is None else v @ self.metric)).sum(axis=1)
        return product

    def _lowering(self, start: Rows | None, end: Rows) -> Floats | float:
        """By how much rows are lowered more than others, or than points without weight."""
        if self.weights is not None:
            return self.weights[end] - (0.0 if start is None else self.weights[start])
        if self.radii is None:
            return 0.0
        first = 0.0 if start is None else self.radii[start]
        return (self.radii[end] - first) * (self.radii[end] + first)


class HullMesh(FrozenResult):
    """What hulls and surfaces are converted to, all by way of a cloud with faces."""

    __slots__ = ()

    def to_cloud(self) -> Cloud:
        """Convert the hull to a cloud with faces."""
        raise NotImplementedError

    def to_trimesh(self) -> trimesh.Trimesh:
        """Convert it to a trimesh mesh with the vertices and faces of ``to_cloud``.

        Returns
        -------
        trimesh.Trimesh
            The mesh.

        See Also
        --------
        LowerHull.to_cloud, ConvexHull.to_cloud, AlphaShape.to_cloud : As a cloud with faces.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted().to_trimesh().faces.shape
        (1, 3)
        """
        from liftmesh.io.objects.trimesh import to_mesh  # noqa: PLC0415

        return to_mesh(self.to_cloud())

    def to_open3d(self) -> o3d.geometry.TriangleMesh:
        """Convert it to an Open3D mesh with the vertices and faces of ``to_cloud``.

        Returns
        -------
        open3d.geometry.TriangleMesh
            The mesh.

        See Also
        --------
        LowerHull.to_cloud, ConvexHull.to_cloud, AlphaShape.to_cloud : As a cloud with faces.

        Examples
        --------
        >>> import liftmesh
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> liftmesh.convex_hull(corners).to_open3d().is_watertight()
        True
        """
        from liftmesh.io.objects.open3d import to_legacy  # noqa: PLC0415

        return to_legacy(self.to_cloud())

    def save(self, path: Any, **options: Any) -> WriteResult:
        """Write it to a mesh file.

        Parameters
        ----------
        path : path or binary file
            Where to write; the suffix determines the format.
        **options
            As for `liftmesh.write`.

        Returns
        -------
        WriteResult
            Summary of what was written.

        Raises
        ------
        FormatError
            The format is unknown, or the file cannot be written.

        See Also
        --------
        write : Writes any cloud or mesh.

        Examples
        --------
        >>> import io, liftmesh
        >>> hull = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted()
        >>> hull.save(io.BytesIO(), format="ply").format
        'ply'
        """
        from liftmesh.io.write import write  # noqa: PLC0415

        return write(path, self.to_cloud(), **options)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LowerHull(HullMesh):
    """The lower convex hull of points in space, as a mesh. Its arrays are read-only.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float64
        All points, in the order of the caller's rows.
    faces : (m, 3) ndarray of int32
        The lower facets, counter-clockwise seen from above. Those of lifted points project to the
        Delaunay triangles.
    apex : tuple of float, optional
        The apex of the paraboloid, if the points were lifted to one.
    neighbors : (m, 3) ndarray of int32, optional
        The facet across the edge opposite vertex k; -1 at the boundary.
    counters : Counters, optional
        Work counters, if the hull was computed by the paper's procedure.

    See Also
    --------
    Triangulation.lifted : The hull of lifted points.
    lower_hull : The hull of any points in space.

    Examples
    --------
    >>> import liftmesh
    >>> hull = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted(apex=(1, 1))
    >>> hull.vertices[:, 2]
    array([2., 1., 1.])
    """

    vertices: Floats
    faces: Rows
    apex: tuple[float, float] | None = None
    neighbors: Rows | None = None
    counters: Counters | None = None

    def _check_copy(self) -> None:
        check_numbers(0, len(self.vertices), self.faces)
        if self.neighbors is not None:
            check_numbers(-1, len(self.faces), self.neighbors)

    def __repr__(self) -> str:
        return f"<LowerHull of {len(self.faces):,} facets over {len(self.vertices):,} points>"

    @property
    def above(self) -> Rows:
        """Rows that are not a vertex of any facet, in ascending order.

        Returns
        -------
        (k,) ndarray of int32
            Rows above the lower hull, and rows equal to a vertex.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.lower_hull([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 9]]).above
        array([3], dtype=int32)
        """
        unused = np.ones(len(self.vertices), dtype=bool)
        unused[self.faces] = False
        return np.flatnonzero(unused).astype(np.int32)

    def to_cloud(self) -> Cloud:
        """Convert the hull to a cloud with faces.

        Returns
        -------
        Cloud
            Vertices and faces.

        See Also
        --------
        LowerHull.to_trimesh : As a mesh of trimesh.
        LowerHull.save : As a file.

        Examples
        --------
        >>> import liftmesh
        >>> len(liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted().to_cloud())
        3
        """
        from liftmesh.base.cloud import Cloud  # noqa: PLC0415 - a first triangulation does without

        metadata = {} if self.apex is None else {"apex": self.apex}
        return Cloud(self.vertices, faces=self.faces, metadata=metadata)


REJECTIONS = ("4.3 (i)", "4.3 (ii)", "4.3 (iii)", "4.3 (iv)", "4.3 (v)", "4.4")


@dataclass(frozen=True, slots=True)
class Counters:
    """The work of a gift wrapping run, in the paper's terms.

    Parameters
    ----------
    calls : int
        Calls of the procedure, one for each edge processed.
    candidate_planes : int
        Planes (a, b, p) with a downward normal that were tried.
    evaluations : int
        Points compared with a plane by a dot product, not counting a, b and p themselves; for
        "lfres-indexed" every point of the grid cells searched.
    rejected : dict of str to int
        Points classified by comparing coordinates alone, by proposition: above the plane for
        ``"4.3 (i)"`` to ``"4.3 (v)"``, below it for ``"4.4"``.
    undecided : int
        Evaluations whose sign was uncertain due to rounding, decided by the exact predicate.

    See Also
    --------
    delaunay : Counts with ``algorithm="lf"`` and its like.
    lower_hull : Counts with ``algorithm="lf"``.

    Examples
    --------
    >>> import liftmesh
    >>> counters = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], algorithm="lf").counters
    >>> counters.candidate_planes
    1
    """

    calls: int
    candidate_planes: int
    evaluations: int
    rejected: dict[str, int]
    undecided: int

    @classmethod
    def from_kernel(cls, counts: _kernel.Counts) -> Counters:
        """Convert the numbers that the kernel returns.

        Parameters
        ----------
        counts : tuple
            Calls, candidate planes, evaluations, the six rejections, undecided.

        Returns
        -------
        Counters
            The same numbers by name.

        Examples
        --------
        >>> Counters.from_kernel((1, 1, 9, (4, 0, 0, 0, 0, 2), 0)).rejected["4.4"]
        2
        """
        calls, planes, evaluations, rejected, undecided = counts
        by_name = dict(zip(REJECTIONS, rejected, strict=True))
        return cls(calls, planes, evaluations, by_name, undecided)

    @property
    def points(self) -> int:
        """Number of points examined, by a dot product or by their coordinates alone.

        Returns
        -------
        int
            The sum of evaluations and rejections.

        Examples
        --------
        >>> Counters(1, 1, 5, {"4.3 (i)": 3}, 0).points
        8
        """
        return self.evaluations + sum(self.rejected.values())
