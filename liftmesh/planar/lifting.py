"""Lifting of planar points to a paraboloid, and the lower hull of the lifted points.

A planar point p is lifted to z = (x - qx)^2 + (y - qy)^2, where q is the vertex of the paraboloid.
The lower facets of the convex hull of the lifted points project to the Delaunay triangles. q
changes the heights, never the triangles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, ParaboloidVertex, Reals, Rows
from liftmesh.arrays import as_coordinates, as_reals, as_rows3, read_only
from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.frozen import check_numbers, constructed_from, freeze
from liftmesh.planar.meshes import rows_of

if TYPE_CHECKING:
    import trimesh

    from liftmesh.cloud import Cloud
    from liftmesh.io.writing import Written
    from liftmesh.planar.counters import Counters


def resolve_q(q: ParaboloidVertex, points: Reals) -> tuple[float, float]:
    """Convert the option q to the coordinates of the paraboloid's vertex.

    Parameters
    ----------
    q : {"origin", "median"} or (2,) array_like
        The origin, the coordinate-wise median of the finite points, or any finite point.
    points : (n, 2) ndarray
        The planar points.

    Returns
    -------
    tuple of float
        qx and qy.

    Raises
    ------
    InputError
        q is not one of these.

    Examples
    --------
    >>> resolve_q("median", np.array([[0.0, 5.0], [1.0, 7.0], [9.0, 6.0]]))
    (1.0, 6.0)
    """
    vertex = given_vertex(q)
    if vertex is not None:
        return vertex
    return (0.0, 0.0) if isinstance(q, str) and q == "origin" else _median(points)


def given_vertex(q: ParaboloidVertex) -> tuple[float, float] | None:
    """Validate the option q, and return the point if it is one.

    Parameters
    ----------
    q : {"origin", "median"} or (2,) array_like
        The vertex of the paraboloid.

    Returns
    -------
    tuple of float, or None
        qx and qy; None for "origin" and "median".

    Raises
    ------
    InputError
        q is not one of these.

    Examples
    --------
    >>> given_vertex((1, 2)), given_vertex("median")
    ((1.0, 2.0), None)
    """
    if isinstance(q, str):
        if q in ("origin", "median"):
            return None
        raise InputError(f"q is {shown(q)}: give 'origin', 'median' or a point (qx, qy)")
    try:
        with np.errstate(all="ignore"):
            pair = as_reals(q)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"q is {shown(q)}: give 'origin', 'median' or a point (qx, qy)") from error
    if pair.shape != (2,) or not np.isfinite(pair).all():
        raise InputError(f"q is {shown(q)}: give 'origin', 'median' or a finite point (qx, qy)")
    return float(pair[0]), float(pair[1])


def _median(points: Reals) -> tuple[float, float]:
    """Coordinate-wise median of the finite rows, computed at half scale if it would overflow."""
    finite = points[np.isfinite(points).all(axis=1)].astype(np.float64)
    if len(finite) == 0:
        return 0.0, 0.0
    scale = 0.5 if np.abs(finite).max() > 2.0**1022 else 1.0
    x, y = np.median(finite * scale, axis=0) / scale
    return float(x), float(y)


def lift(points: ArrayLike, q: ParaboloidVertex = "origin") -> Floats:
    """Lift planar points to the paraboloid z = (x - qx)^2 + (y - qy)^2.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, or a cloud or mesh as for `delaunay`; a third coordinate is ignored.
    q : {"origin", "median"} or (2,) array_like, default "origin"
        The vertex of the paraboloid.

    Returns
    -------
    (n, 3) ndarray of float64
        x and y as given; z computed in float64, with rounding (infinite if it overflows).

    Raises
    ------
    InputError
        Points or q are invalid.

    Examples
    --------
    >>> lift([[3, 4], [1, 0]])
    array([[ 3.,  4., 25.],
           [ 1.,  0.,  1.]])
    """
    rows = as_coordinates(rows_of(points))[:, :2]
    qx, qy = resolve_q(q, rows)
    lifted = np.empty((len(rows), 3))
    lifted[:, :2] = rows
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        lifted[:, 2] = (lifted[:, 0] - qx) ** 2 + (lifted[:, 1] - qy) ** 2
    return lifted


def project(points: ArrayLike) -> Floats:
    """Project lifted points back onto the plane: the inverse of `lift`.

    Parameters
    ----------
    points : array_like of shape (n, 3)
        Points in space, or a cloud or mesh as for `delaunay`.

    Returns
    -------
    (n, 2) ndarray of float64
        Their x and y: a read-only view if the points are float64.

    Raises
    ------
    InputError
        Points are invalid.

    Examples
    --------
    >>> project(lift([[3, 4]], q=(1, 1)))
    array([[3., 4.]])
    """
    return read_only(as_rows3(rows_of(points))[:, :2])


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LowerHull:
    """The lower convex hull of points in space, as a mesh. Its arrays are read-only.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float64
        All points, in the order of the caller's rows.
    faces : (m, 3) ndarray of int32
        The lower facets, counter-clockwise seen from above. Those of lifted points project to the
        Delaunay triangles.
    q : tuple of float, optional
        The vertex of the paraboloid, if the points were lifted to one.
    neighbors : (m, 3) ndarray of int32, optional
        The facet across the edge opposite vertex k; -1 at the boundary.
    counters : Counters, optional
        Work counters, if the hull was computed by the paper's procedure.

    Examples
    --------
    >>> import liftmesh
    >>> hull = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted(q=(1, 1))
    >>> hull.vertices[:, 2]
    array([2., 1., 1.])
    """

    vertices: Floats
    faces: Rows
    q: tuple[float, float] | None = None
    neighbors: Rows | None = None
    counters: Counters | None = None

    def __post_init__(self) -> None:
        freeze(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return *constructed_from(self), True

    def __setstate__(self, _: bool) -> None:
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

        Examples
        --------
        >>> import liftmesh
        >>> len(liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted().to_cloud())
        3
        """
        from liftmesh.cloud import Cloud  # noqa: PLC0415 - a first triangulation does without

        metadata = {} if self.q is None else {"q": self.q}
        return Cloud(self.vertices, faces=self.faces, metadata=metadata)

    def to_trimesh(self) -> trimesh.Trimesh:
        """Convert the hull to a trimesh mesh with the same vertices and faces.

        Returns
        -------
        trimesh.Trimesh
            The mesh.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted().to_trimesh().faces.shape
        (1, 3)
        """
        from liftmesh.io.objects.trimesh import to_mesh  # noqa: PLC0415

        return to_mesh(self.to_cloud())

    def save(self, path: Any, **options: Any) -> Written:
        """Write the hull to a mesh file.

        Parameters
        ----------
        path : path or binary file
            Where to write; the suffix determines the format.
        **options
            As for `liftmesh.write`.

        Returns
        -------
        Written
            Summary of what was written.

        Raises
        ------
        FormatError
            The format is unknown, or the file cannot be written.

        Examples
        --------
        >>> import io, liftmesh
        >>> hull = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted()
        >>> hull.save(io.BytesIO(), format="ply").format
        'ply'
        """
        from liftmesh.io.writing import write  # noqa: PLC0415

        return write(path, self.to_cloud(), **options)
