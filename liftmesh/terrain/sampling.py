"""Heights and slopes of a surface at points of its plane.

The kernel locates each point and interpolates in its face, or between the ends of an edge, by rules
that name coordinates only: no bit of a height depends on the order of the rows or of the points, on
the triangle by which an edge was reached, or on threads (`_core/surface/facet.hpp`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats
from liftmesh.arrays import as_pairs
from liftmesh.choices import SampleMethod, check_option
from liftmesh.errors import InputError
from liftmesh.terrain.units import steepness_of
from liftmesh.threads import as_threads

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


def relief_of(surface: Surface) -> _kernel.Relief:
    """Hand a surface over to the kernel.

    Parameters
    ----------
    surface : Surface
        The surface.

    Returns
    -------
    Relief
        Shares the surface's arrays.
    """
    solved = surface.triangulation
    return _kernel.Relief(
        solved.points,
        np.ascontiguousarray(solved.simplices),
        np.ascontiguousarray(solved.neighbors),
        surface.frame.heights(surface.vertices),
        None if surface.mask is None else surface.mask.view(np.uint8),
    )


class Sampling:
    """The methods of a `Surface` that take points of its plane."""

    __slots__ = ()

    def sample(
        self: Any, points: ArrayLike, method: SampleMethod = "linear", *, threads: int | None = None
    ) -> Floats:
        """Interpolate heights at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            Coordinates in the plane of the surface: x and y, unless it was triangulated on another.
        method : {"linear", "nearest", "laplace", "sibson"}, default "linear"
            Linear in each face; the height of the nearest vertex, of several the lexicographically
            least; or, smooth but for the vertices, from natural neighbours: by the lengths of the
            sides that Voronoi cells would share ("laplace"), or by the areas that a cell would take
            from others ("sibson"). At a vertex the height is the vertex's own; on an edge, linear,
            and on the hull by all but the nearest, it comes from the two ends.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (...) ndarray of float64
            Heights above the plane; NaN where no face contains the point, and for points that are
            not finite. The same bits for any order of the rows and of the points.

        Raises
        ------
        InputError
            The last axis is not of length two, an option is unknown, or other methods than "linear"
            are asked of a surface with weights, radii or a metric.

        Notes
        -----
        A linear height is never beyond those of the corners of its face. In faces that fill less
        than a thousandth of their bounding box the weights come from exact determinants.

        Which vertices are natural neighbours is decided exactly; vertices of faces that are left
        out are among them. Weights are right to 1e-12 of the largest. By them a point takes time
        for each of its neighbours: many, near the centre of a circle of vertices. The nearest
        vertex takes longer where many vertices are about as near, as in the middle of a circle.
        Slopes and aspects are those of faces, whatever the method.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
        >>> surface.sample([[1, 1], [2, 2], [0, 4], [3, 3]])
        array([ 5.,  5.,  1., nan])
        """
        check_option("method", method, SampleMethod)
        solved = self.triangulation
        if method != "linear" and (solved.metric is not None or hasattr(solved, "hidden")):
            raise InputError(
                f"method {method!r} needs a Delaunay triangulation, and the surface has weights, "
                "radii or a metric: give method='linear'"
            )
        pairs = as_pairs(points)
        heights = np.empty(pairs.shape[:-1])
        relief_of(self).sample(
            self.triangulation._locator,  # noqa: SLF001 - made once for all that is asked of it
            pairs.reshape(-1, 2),
            heights.reshape(-1),
            method,
            *as_threads(threads, heights.size),
        )
        return heights[()]

    def gradient(self: Any, points: ArrayLike, *, threads: int | None = None) -> Floats:
        """Compute the gradient of the face at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            As for `sample`.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (..., 2) ndarray of float64
            dz/dx and dz/dy, in heights per length; NaN where no face contains the point. On an edge
            or at a vertex they are those of one face: the first counter-clockwise, from the
            direction just above that of x on.

        Raises
        ------
        InputError
            As for `sample`.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
        >>> surface.gradient([1, 1])
        array([ 1., -1.])
        """
        pairs = as_pairs(points)
        gradients = np.empty(pairs.shape)
        relief_of(self).gradients(
            self.triangulation._locator,  # noqa: SLF001 - as in `sample`
            pairs.reshape(-1, 2),
            gradients.reshape(-1, 2),
            *as_threads(threads, gradients.size // 2),
        )
        return gradients

    def slope(
        self: Any, points: ArrayLike, *, z_factor: float | None = None, threads: int | None = None
    ) -> Floats:
        """Compute how steep the face is at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            As for `sample`.
        z_factor : float, optional
            What heights are multiplied by; by default what gives them the unit of x and y, if the
            coordinate system says the units of all three.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (...) ndarray of float64
            Degrees from the plane, 0 to 90; NaN where no face contains the point. On edges as
            `gradient`.

        Raises
        ------
        InputError
            As for `sample`, the factor is not positive, or x and y are degrees and it is not given.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 5]])
        >>> surface.slope([1, 1]).round(9)
        np.float64(45.0)
        """
        return slope_of(self.gradient(points, threads=threads) * steepness_of(self, z_factor))

    def aspect(self: Any, points: ArrayLike, *, threads: int | None = None) -> Floats:
        """Compute which way the face descends at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            As for `sample`.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (...) ndarray of float64
            Degrees clockwise from the direction of y, which is north on maps, from 0 up to 360; NaN
            on level faces and where no face contains the point. On edges as `gradient`.

        Raises
        ------
        InputError
            As for `sample`, or x and y are degrees.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 5]])
        >>> surface.aspect([1, 1])  # down to the west
        np.float64(270.0)
        """
        return aspect_of(self.gradient(points, threads=threads) * steepness_of(self, None))


def slope_of(gradients: Floats) -> Floats:
    """Convert gradients to degrees from the plane.

    Parameters
    ----------
    gradients : (..., 2) ndarray of float64
        As from `Sampling.gradient`.

    Returns
    -------
    (...) ndarray of float64
        As from `Sampling.slope`.

    Examples
    --------
    >>> slope_of(np.array([0.0, -1.0])).round(9)
    np.float64(45.0)
    """
    slopes: Floats = np.degrees(np.arctan(np.hypot(gradients[..., 0], gradients[..., 1])))
    return slopes


def aspect_of(gradients: Floats) -> Floats:
    """Convert gradients to directions of descent.

    Parameters
    ----------
    gradients : (..., 2) ndarray of float64
        As from `Sampling.gradient`.

    Returns
    -------
    (...) ndarray of float64
        As from `Sampling.aspect`.

    Examples
    --------
    >>> aspect_of(np.array([[0.0, -1.0], [0.0, 1.0], [0.0, 0.0]]))
    array([  0., 180.,  nan])
    """
    east, north = -gradients[..., 0], -gradients[..., 1]
    turned = np.degrees(np.arctan2(east, north)) % 360
    is_level = (east == 0) & (north == 0)
    aspects: Floats = np.where(is_level, np.nan, np.where(turned == 360, 0.0, turned))
    return aspects[()]
