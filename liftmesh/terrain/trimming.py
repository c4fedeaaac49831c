"""Trimming: faces left out of a surface, which keeps its triangulation.

A trimmed surface is a mask over the same triangles: nothing is triangulated again, and masks
compose. Long thin triangles along the hull, and those across bays, go without opening the gaps in
the middle if trimming begins at the boundary.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import as_reals
from liftmesh.base.options import as_switch, shown
from liftmesh.errors import InputError
from liftmesh.terrain.corners import ordered
from liftmesh.vector.polygons import contains, polygons_in

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


class Trimming:
    """The methods of a `Surface` that leave out faces, and that show what is left."""

    __slots__ = ()

    def trim(
        self: Any,
        *,
        max_edge: float | None = None,
        boundary_only: bool = False,
        max_radius: float | None = None,
        polygon: object = None,
    ) -> Surface:
        """Make a copy without some of the faces; vertices and triangulation stay as they are.

        Parameters
        ----------
        max_edge : float, optional
            Leave out faces with a side that is longer in the plane.
        boundary_only : bool, default False
            Leave out only those that such a side connects with the outside: faces whose long side
            is on the boundary, then those whose long side has become part of it, and so on. Gaps
            inside stay closed.
        max_radius : float, optional
            Leave out faces whose circumcircle has a larger radius: what is left is the alpha shape
            of the points for this alpha.
        polygon : object, optional
            Leave out faces whose centroid is outside: a polygon with holes, or several, which may
            overlap, as GeoJSON (a dict or a file), a GeoPackage or a shapefile, any object with
            ``__geo_interface__`` as those of shapely, or an array of shape (k, 2). Coordinates are
            those of the plane.

        Returns
        -------
        Surface
            Shares everything with this one but ``faces`` and ``mask``. Faces that were left out
            before stay so.

        Raises
        ------
        InputError
            A length is not positive, the polygon is none or known to be in another coordinate
            system, nothing is asked for, or no face is left.
        FormatError
            A file of a polygon is invalid.
        MissingDependencyError
            Polygons of a shapefile that have several rings need shapely.
        OSError
            It cannot be opened.

        Examples
        --------
        >>> import liftmesh
        >>> points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
        >>> surface = liftmesh.triangulate(points)
        >>> surface.trim(max_edge=2), surface.trim(max_radius=1).mask.tolist()
        (<Surface of 2 triangles over 5 vertices>, [False, False, True, True])
        """
        left_out = mask_of(self).copy()
        corners = self.triangulation.points[self.triangulation.simplices]
        inwards = as_switch("boundary_only", boundary_only)
        if max_edge is None and max_radius is None and polygon is None:
            raise InputError("nothing is asked for: give max_edge, max_radius or a polygon")
        if inwards and max_edge is None:
            raise InputError("boundary_only needs max_edge")
        if max_radius is not None:
            left_out |= _radii(corners) > _length("max_radius", max_radius)
        if polygon is not None:
            left_out |= ~contains(polygons_in(self.crs, polygon), _centroids(corners))
        if max_edge is not None:
            is_long = _sides(corners) > _length("max_edge", max_edge)
            left_out = _from_rim(self, is_long, left_out) if inwards else left_out | is_long.any(1)
        return masked(self, left_out)

    def boundary(self: Any) -> list[Rows]:
        """Return the boundary of the faces as closed rings.

        Returns
        -------
        list of (k,) ndarray of int32
            Rows of the vertices, the first not repeated. Faces are to the left: outer rings turn
            counter-clockwise, those around gaps clockwise. No ring visits a vertex twice; two may
            share some. Each begins at its lexicographically least vertex, and they are in the order
            of these.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.triangulate([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]).boundary()
        [array([0, 1, 3, 2], dtype=int32)]
        """
        solved = self.triangulation
        rows, starts = _kernel.rings(
            solved.points,
            np.ascontiguousarray(solved.simplices),
            np.ascontiguousarray(solved.neighbors),
            None if self.mask is None else self.mask.view(np.uint8),
        )
        return np.split(rows, starts[1:-1])


def mask_of(surface: Surface) -> Array:
    """Return which triangles are left out."""
    if surface.mask is None:
        return np.zeros(surface.triangulation.nsimplex, dtype=np.bool_)
    return surface.mask


def masked(surface: Surface, left_out: Array) -> Surface:
    """Make a copy that leaves out faces; without any, its faces are the triangulation's own."""
    if left_out.all():
        raise InputError("no face is left: give larger limits, or a polygon over the faces")
    simplices = surface.triangulation.simplices
    if not left_out.any():
        return replace(surface, faces=simplices, mask=None)
    return replace(surface, faces=simplices[~left_out], mask=left_out)


def _from_rim(surface: Surface, is_long: Array, left_out: Array) -> Array:
    """Leave out faces with a long side on the boundary, from there inwards."""
    flags = left_out.view(np.uint8)
    neighbors = np.ascontiguousarray(surface.triangulation.neighbors)
    _kernel.leave_out_from_rim(neighbors, is_long.view(np.uint8), flags)
    return flags.view(np.bool_)


def _sides(corners: Floats) -> Floats:
    """Compute the lengths of the sides opposite each corner, (m, 3)."""
    with np.errstate(over="ignore"):
        across = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        lengths: Floats = np.hypot(across[..., 0], across[..., 1])
    return lengths


def _radii(corners: Floats) -> Floats:
    """Compute the radii of circumcircles; the order of the corners changes no bit."""
    lengths = np.sort(_sides(corners), axis=1)
    a, b, c = np.moveaxis(ordered(corners), 1, 0)
    with np.errstate(all="ignore"):
        # By a power of two, so that no square leaves the range of doubles.
        exponents = np.frexp(lengths[:, 2])[1]
        (bx, by), (cx, cy) = (np.ldexp(each - a, -exponents[:, None]).T for each in (b, c))
        short, middle, long = np.ldexp(lengths, -exponents[:, None]).T
        radii: Floats = np.ldexp(
            short * (middle / np.abs(bx * cy - by * cx)) * (long / 2), exponents
        )
    return np.where(np.isnan(radii), np.inf, radii)


def _centroids(corners: Floats) -> Floats:
    """Compute centroids; the order of the corners changes no bit."""
    a, b, c = np.moveaxis(ordered(corners), 1, 0)
    centroids: Floats = a / 3 + b / 3 + c / 3
    return centroids


def _length(name: str, value: Any) -> float:
    try:
        length = float(as_reals(value))
    except (TypeError, ValueError, OverflowError):
        length = 0.0
    if not length > 0:
        raise InputError(f"{name} is {shown(value)}: give a positive length")
    return length
