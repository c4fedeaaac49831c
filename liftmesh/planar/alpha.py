"""Alpha complexes and alpha shapes: what balls of one radius around points have in common.

A simplex of a Delaunay triangulation enters the complex with the radius of its smallest sphere if
no point is strictly inside of that, otherwise with the first simplex that it is a side of. All
radii are decided exactly and rounded up. So of one triangulation the complex for every double
``alpha`` is known, as ``radii <= alpha``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Mask, Rows
from liftmesh.base.arrays import read_only, used_rows
from liftmesh.base.frozen import FrozenResult, check_numbers
from liftmesh.base.options import as_count, as_number
from liftmesh.errors import InputError
from liftmesh.planar.lifting import HullMesh

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


@dataclass(frozen=True, eq=False, repr=False)
class AlphaComplex(FrozenResult):
    """The simplices of an alpha complex, and the radii with which they enter. Read-only.

    Parameters
    ----------
    points : (n, d) ndarray of float64
        The points, in the plane or in space.
    alpha : float
        The radius up to which simplices are listed.
    vertices : (v,) ndarray of int32
        The rows that are vertices, which enter with radius 0.
    edges : (e, 2) ndarray of int32
        Rows of the edges, ascending, as those of triangles and tetrahedra.
    triangles : (f, 3) ndarray of int32
        Rows of the triangles.
    tetrahedra : (t, 4) ndarray of int32
        Rows of the tetrahedra; none in the plane.
    edge_radii : (e,) ndarray of float64
        The radius with which each edge enters: the least double that is not less than the exact
        one, as all radii here.
    triangle_radii : (f,) ndarray of float64
        The same of triangles.
    tetrahedron_radii : (t,) ndarray of float64
        The same of tetrahedra.

    See Also
    --------
    Triangulation.alpha_complex, Tetrahedralization.alpha_complex : Make it.
    AlphaShape : The surface of what it fills.

    Examples
    --------
    >>> import liftmesh
    >>> found = liftmesh.delaunay([[0, 0], [4, 0], [0, 3], [8, 8]]).alpha_complex()
    >>> found.edges.tolist(), found.edge_radii.round(3).tolist()
    ([[2, 3], [1, 2], [1, 3], [0, 2], [0, 1]], [4.717, 2.5, 4.472, 1.5, 2.0])
    """

    points: Floats
    alpha: float
    vertices: Rows
    edges: Rows
    triangles: Rows
    tetrahedra: Rows
    edge_radii: Floats
    triangle_radii: Floats
    tetrahedron_radii: Floats

    def _check_copy(self) -> None:
        parts = self.vertices, self.edges, self.triangles, self.tetrahedra
        check_numbers(0, len(self.points), *parts)

    def __repr__(self) -> str:
        counts = [f"{len(self.vertices):,} vertices", f"{len(self.edges):,} edges"]
        counts.append(f"{len(self.triangles):,} triangles")
        if self.points.shape[1] == 3:
            counts.append(f"{len(self.tetrahedra):,} tetrahedra")
        return f"<AlphaComplex of alpha {self.alpha!r}: {', '.join(counts)}>"

    def at(self, alpha: float) -> AlphaComplex:
        """Return the part for a smaller radius.

        Parameters
        ----------
        alpha : float
            The radius.

        Returns
        -------
        AlphaComplex
            The simplices whose radius is at most `alpha`, in the same order.

        Raises
        ------
        InputError
            `alpha` is negative, no number, or larger than that of this complex.

        See Also
        --------
        Triangulation.alpha_complex, Tetrahedralization.alpha_complex : The whole.

        Examples
        --------
        >>> import liftmesh
        >>> whole = liftmesh.delaunay([[0, 0], [4, 0], [0, 3], [8, 8]]).alpha_complex()
        >>> whole.at(2.25)
        <AlphaComplex of alpha 2.25: 4 vertices, 2 edges, 0 triangles>
        """
        alpha = as_alpha(alpha)
        if alpha > self.alpha:
            raise InputError(
                f"this complex has the simplices up to alpha {self.alpha!r}, not up to {alpha!r}: "
                "make another one of the triangulation"
            )
        edges, triangles, tetrahedra = (
            radii <= alpha
            for radii in (self.edge_radii, self.triangle_radii, self.tetrahedron_radii)
        )
        return replace(
            self,
            alpha=alpha,
            edges=self.edges[edges],
            triangles=self.triangles[triangles],
            tetrahedra=self.tetrahedra[tetrahedra],
            edge_radii=self.edge_radii[edges],
            triangle_radii=self.triangle_radii[triangles],
            tetrahedron_radii=self.tetrahedron_radii[tetrahedra],
        )


@dataclass(frozen=True, eq=False, repr=False)
class AlphaShape(HullMesh):
    """An alpha shape: the simplices of an alpha complex, and their boundary. Read-only.

    Meshes and files have the boundary in space, and the triangles of the shape in the plane, at
    z = 0, with the vertices of ``vertices``.

    Parameters
    ----------
    points : (n, d) ndarray of float64
        The points, in the plane or in space.
    alpha : float
        The radius.
    simplices : (i, d + 1) ndarray of int32
        The triangles or tetrahedra of the shape, as the triangulation has them.
    mask : (m,) ndarray of bool
        Which of the triangulation's simplices these are.
    faces : (f, d) ndarray of int32
        The boundary: facets between the simplices and the outside. Triangles turn counter-clockwise
        seen from outside; edges in the plane have the shape on their left.
    singular : (s, d) ndarray of int32
        Triangles, in the plane edges, that belong to the complex, but to no simplex of the shape;
        they are not part of ``faces``, meshes and files.
    rings : tuple of (k,) ndarray of int32
        In the plane the edges of ``faces`` as closed rings, as `Surface.boundary` has them: outer
        ones turn counter-clockwise, those around gaps clockwise. None in space.

    See Also
    --------
    alpha_shape : Makes it.
    AlphaComplex : All simplices, with their radii.

    Examples
    --------
    >>> import liftmesh
    >>> shape = liftmesh.alpha_shape([[0, 0], [4, 0], [0, 3], [8, 8]], 3)
    >>> shape
    <AlphaShape of alpha 3.0: 1 triangle inside 3 edges>
    >>> shape.simplices.tolist(), shape.faces.tolist(), shape.singular.tolist()
    ([[0, 1, 2]], [[1, 2], [2, 0], [0, 1]], [])
    """

    points: Floats
    alpha: float
    simplices: Rows
    mask: Mask
    faces: Rows
    singular: Rows
    rings: tuple[Rows, ...] = ()

    def _check_copy(self) -> None:
        check_numbers(0, len(self.points), self.simplices, self.faces, self.singular)

    def __repr__(self) -> str:
        if self.points.shape[1] == 2:
            names = ("triangle", "triangles"), ("edge", "edges")
        else:
            names = ("tetrahedron", "tetrahedra"), ("triangle", "triangles")
        parts = [
            f"{len(found):,} {name[len(found) != 1]}"
            for found, name in zip((self.simplices, self.faces), names, strict=True)
        ]
        return f"<AlphaShape of alpha {self.alpha!r}: {parts[0]} inside {parts[1]}>"

    @property
    def vertices(self) -> Rows:
        """The rows of the vertices of meshes and files, in ascending order.

        Returns
        -------
        (v,) ndarray of int32
            In space those on the boundary, in the plane those of the triangles.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.alpha_shape([[8, 8], [0, 0], [4, 0], [0, 3]], 3).vertices
        array([1, 2, 3], dtype=int32)
        """
        found = self.faces if self.points.shape[1] == 3 else self.simplices
        return used_rows(len(self.points), found)

    @property
    def nonmanifold(self) -> Rows:
        """Where more than two faces meet: edges in space, vertices in the plane.

        Returns
        -------
        (q, d - 1) ndarray of int32
            Their rows, ascending. Four faces of a shape meet in an edge, or more, where solid parts
            touch there; programs that want a manifold refuse such edges.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.alpha_shape([[0, 0], [2, 1], [2, -1], [-2, 1], [-2, -1]], 1.3).nonmanifold
        array([[0]], dtype=int32)
        """
        size = self.faces.shape[1]
        sides = np.concatenate([np.delete(self.faces, k, axis=1) for k in range(size)])
        found, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
        return read_only(found[counts > 2])

    def to_cloud(self) -> Cloud:
        """Convert the shape to a cloud with faces, of its vertices alone.

        Returns
        -------
        Cloud
            Vertex i is row ``vertices[i]``. The faces are the boundary in space, and the triangles
            of the shape in the plane.

        See Also
        --------
        AlphaShape.to_trimesh : As a mesh of trimesh.
        AlphaShape.save : As a file.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.alpha_shape([[0, 0], [4, 0], [0, 3], [8, 8]], 3).to_cloud()
        <Cloud of 3 points, 1 face>
        """
        from liftmesh.base.cloud import Cloud  # noqa: PLC0415 - a first triangulation does without

        rows = self.vertices
        faces = self.faces if self.points.shape[1] == 3 else self.simplices
        place = np.zeros(len(self.points), dtype=np.int32)
        place[rows] = np.arange(len(rows), dtype=np.int32)
        return Cloud(in_space(self.points[rows]), faces=place.take(faces, axis=0))


class Simplicial(Protocol):
    """What of a triangulation tells whether its circles or spheres are empty."""

    simplices: Rows
    neighbors: Rows
    _has_empty_circles: bool

    @property
    def points(self) -> Floats:
        """An attribute, or computed."""


class AlphaMethods:
    """What triangulations in the plane and in space have of this, one line each."""

    simplices: Rows
    neighbors: Rows
    _has_empty_circles = True  # by the points alone

    if TYPE_CHECKING:

        @property
        def points(self) -> Floats:
            """An attribute, or computed."""

    def circumradii(self) -> Floats:
        """Compute the radii of the circles or spheres through the corners of each simplex.

        In full: `liftmesh.planar.alpha.circumradii`.
        """
        return circumradii(self)

    def alpha_complex(self, alpha: float = np.inf) -> AlphaComplex:
        """Find the simplices of the alpha complex, with the radii at which they enter.

        In full: `liftmesh.planar.alpha.alpha_complex`.

        Parameters
        ----------
        alpha : float, default infinity
        """
        return alpha_complex(self, alpha)

    def alpha_shape(self, alpha: float | None = None) -> AlphaShape:
        """Find what the alpha complex fills, and its boundary.

        In full: `liftmesh.planar.alpha.alpha_shape`.

        Parameters
        ----------
        alpha : float, by default ``optimal_alpha()``
        """
        return alpha_shape(self, alpha)

    def optimal_alpha(self, components: int = 1) -> float:
        """Find the least alpha whose shape holds all points in few parts.

        In full: `liftmesh.planar.alpha.optimal_alpha`.

        Parameters
        ----------
        components : int, default 1
        """
        return optimal_alpha(self, components)


def circumradii(found: AlphaMethods) -> Floats:
    """Compute the radii of the circles or spheres through the corners of each simplex.

    Parameters
    ----------
    found : Triangulation or Tetrahedralization
        With constraints or weights, too.

    Returns
    -------
    (m,) ndarray of float64
        Correctly rounded; infinity where the nearest double would be.

    See Also
    --------
    Triangulation.alpha_complex, Tetrahedralization.alpha_complex : The radii of all faces.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.delaunay([[0, 0], [4, 0], [0, 3]]).circumradii()
    array([2.5])
    """
    return radii_of(found, is_up=False)


def as_alpha(alpha: Any) -> float:
    """Convert the option alpha."""
    return as_number("alpha", alpha, "0 or a positive radius", lambda number: number >= 0)


def in_space(points: Floats) -> Floats:
    """Return points of the plane at z = 0, and those in space as they are."""
    if points.shape[1] == 3:
        return np.ascontiguousarray(points)
    placed = np.zeros((len(points), 3))
    placed[:, :2] = points
    return placed


def radii_of(found: AlphaMethods, is_up: bool) -> Floats:
    """Compute circumradii, to the nearest doubles or up."""
    simplices = np.ascontiguousarray(_as_computed(found)[0])
    radii = np.empty(len(simplices))
    _kernel.circumradii(in_space(found.points), simplices, is_up, radii)
    return radii


def _as_computed(found: Simplicial) -> tuple[Rows, Rows]:
    """Return simplices and neighbours, which callers of SciPy's class may have rewritten."""
    arrays: tuple[Rows, Rows] = getattr(found, "_exact", (found.simplices, found.neighbors))
    return arrays


def _arrays(found: AlphaMethods) -> tuple[Floats, Rows, Rows]:
    return in_space(found.points), *empty_circles(found, "alpha shapes need")


def empty_circles(found: Simplicial, need: str) -> tuple[Rows, Rows]:
    """Return simplices and neighbours of a triangulation that is Delaunay by its points alone."""
    other = getattr(found, "metric", None) is not None or getattr(found, "furthest_site", False)
    if other or not found._has_empty_circles:  # noqa: SLF001 - of this class
        raise InputError(
            f"{need} triangles with empty circles, which constraints, weights, metrics "
            "and farthest points do not leave: triangulate the points alone, with liftmesh.delaunay"
        )
    simplices, neighbors = map(np.ascontiguousarray, _as_computed(found))
    return simplices, neighbors


def alpha_complex(found: AlphaMethods, alpha: float = np.inf) -> AlphaComplex:
    """Find the simplices of the alpha complex, with the radii at which they enter.

    Parameters
    ----------
    found : Triangulation or Tetrahedralization
        Of points alone: with neither constraints nor weights nor a metric.
    alpha : float, default infinity
        The radius of the balls, not negative. Other programs take its square (CGAL, GUDHI) or
        its reciprocal (the package alphashape); Open3D, PyVista and MATLAB take the radius.

    Returns
    -------
    AlphaComplex
        All simplices whose radius is at most `alpha`, by exact comparison; by default all. Radii
        are rounded up, not to the nearest double as `circumradii` are: so comparing them with a
        double decides as comparing the exact ones does.

    Raises
    ------
    InputError
        `alpha` is negative or no number, or the triangulation is of weighted points, by a
        metric or constrained, so that circles of its triangles are not empty.

    See Also
    --------
    AlphaComplex.at : The part for a smaller radius.
    alpha_shape : What the complex fills, and its boundary.

    Notes
    -----
    H. Edelsbrunner and E. P. Mücke, "Three-dimensional alpha shapes", ACM Transactions on
    Graphics 13, 1994.

    Examples
    --------
    >>> import liftmesh, numpy as np
    >>> cube = np.indices((2, 2, 2)).reshape(3, -1).T
    >>> liftmesh.tetrahedralize(cube).alpha_complex(0.5)
    <AlphaComplex of alpha 0.5: 8 vertices, 12 edges, 0 triangles, 0 tetrahedra>
    """
    alpha = as_alpha(alpha)
    arrays = _arrays(found)
    radii = radii_of(found, is_up=True)
    (facets, facet_radii), (edges, edge_radii) = _kernel.alpha_filtration(*arrays, radii)
    simplices: Array = np.sort(arrays[1], axis=1)
    vertices = used_rows(len(found.points), simplices)
    rows, values = [edges, facets, simplices], [edge_radii, facet_radii, radii]
    if simplices.shape[1] == 3:
        rows = [facets, simplices, np.empty((0, 4), dtype=np.int32)]
        values = [facet_radii, radii, np.empty(0)]
    whole = AlphaComplex(found.points, np.inf, vertices, *rows, *values)
    return whole if alpha == np.inf else whole.at(alpha)


def alpha_shape(found: AlphaMethods, alpha: float | None = None) -> AlphaShape:
    """Find what the alpha complex fills, and its boundary.

    Parameters
    ----------
    found : Triangulation or Tetrahedralization
        Of points alone: with neither constraints nor weights nor a metric.
    alpha : float, optional
        The radius, as for ``alpha_complex``; by default ``optimal_alpha()``.

    Returns
    -------
    AlphaShape
        The triangles or tetrahedra whose circle or sphere has at most this radius.

    Raises
    ------
    InputError
        As for ``alpha_complex``.

    See Also
    --------
    alpha_shape : The same of a cloud.

    Examples
    --------
    >>> import liftmesh, numpy as np
    >>> grid = np.indices((5, 5)).reshape(2, -1).T
    >>> liftmesh.delaunay(grid).alpha_shape(0.8)
    <AlphaShape of alpha 0.8: 32 triangles inside 16 edges>
    """
    alpha = optimal_alpha(found) if alpha is None else as_alpha(alpha)
    arrays = _arrays(found)
    mask = np.empty(len(arrays[1]), dtype=np.bool_)
    faces, singular = _kernel.alpha_surface(*arrays, alpha, mask.view(np.uint8))
    simplices = arrays[1][mask]
    rings: list[Rows] = []
    if simplices.shape[1] == 3:
        rows, starts = _kernel.rings(found.points, *arrays[1:], (~mask).view(np.uint8))
        rings = np.split(rows, starts[1:-1]) if len(rows) else []
    closed = tuple(map(read_only, rings))
    return AlphaShape(found.points, alpha, simplices, mask, faces, singular, closed)


def optimal_alpha(found: AlphaMethods, components: int = 1) -> float:
    """Find the least alpha whose shape holds all points in few parts.

    Parameters
    ----------
    found : Triangulation or Tetrahedralization
        Of points alone: with neither constraints nor weights nor a metric.
    components : int, default 1
        How many solid parts the shape may have: triangles or tetrahedra that are connected
        across their sides.

    Returns
    -------
    float
        The least double for which every vertex is a corner of a triangle or tetrahedron of the
        shape, and these form at most so many parts: a radius of one of them, rounded up.

    Raises
    ------
    InputError
        `components` is not a positive whole number, or as for ``alpha_complex``.

    See Also
    --------
    alpha_shape : The shape, by default for this alpha.

    Examples
    --------
    >>> import liftmesh, numpy as np
    >>> grid = np.indices((5, 5)).reshape(2, -1).T
    >>> two = liftmesh.delaunay(np.vstack([grid, grid + 20]))
    >>> round(two.optimal_alpha(2), 3), round(two.optimal_alpha(), 3)
    (0.707, 16.508)
    """
    count = as_count("components", components, 1)
    radii = radii_of(found, is_up=True)
    _, simplices, neighbors = _arrays(found)
    return _kernel.solid_alpha(simplices, neighbors, len(found.points), radii, count)
