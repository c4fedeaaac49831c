"""Cut and fill: the volumes between two surfaces, where both have faces.

The kernel lays the triangulations over each other (`_core/surface/overlay.hpp`); it begins with a
face of each that touch, which are found here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import InputError
from liftmesh.io.selection import found_selection
from liftmesh.io.surface_rows import check_grounds
from liftmesh.predicates import orient2d
from liftmesh.same_crs import are_different
from liftmesh.terrain.measures import cubic_metres_of
from liftmesh.terrain.sampling import relief_of
from liftmesh.terrain.within import between_within, check_measured, in_all, in_each

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.surface import Surface


@dataclass(frozen=True, slots=True)
class Earthwork:
    """The volumes between two surfaces, as `Surface.cut_and_fill` returns them.

    Attributes
    ----------
    cut : float
        Where the second surface is below the first.
    fill : float
        Where it is above.
    area : float
        The area in the plane on which both have faces.
    cubic_metres : float or None
        As in `Volume`.

    Examples
    --------
    >>> import liftmesh
    >>> level = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
    >>> slope = liftmesh.triangulate([[0, 0, -1], [4, 0, 3], [0, 4, -1], [4, 4, 3]])
    >>> found = level.cut_and_fill(slope)
    >>> found.cut, found.fill, found.net
    (2.0, 18.0, 16.0)
    """

    cut: float
    fill: float
    area: float
    cubic_metres: float | None = None

    @property
    def net(self) -> float:
        """The fill less the cut."""
        return self.fill - self.cut


class Comparing:
    """The method of a `Surface` that measures the way to another one."""

    __slots__ = ()

    def cut_and_fill(self: Any, other: Surface, *, polygon: object = None) -> Earthwork:
        """Compute the volumes between this surface and another one.

        Parameters
        ----------
        other : Surface
            What this one becomes, over the same plane. The surfaces need not have the same points,
            nor cover the same area.
        polygon : object, optional
            Measure inside of it alone, cut at its border: as for `trim`, and valid. Of several,
            what they cover together; it needs ``pip install 'liftmesh[shapes]'``.

        Returns
        -------
        Earthwork
            What is to be cut, and to be filled; only where both have faces.

        Raises
        ------
        InputError
            The surfaces are over different planes or in different coordinate systems, have no area
            in common, or are one of ground and one of a file without any, of which all rows were
            read; the polygon is invalid; or a volume is beyond the largest double.
        FormatError
            A file of a polygon is invalid.
        MissingDependencyError
            shapely is not installed.
        OSError
            A file of a polygon cannot be opened.

        Notes
        -----
        Which faces overlap, and how, is decided exactly. Volumes have an error of at most 1e-12 of
        the area times the largest distance of the surfaces; only where all that they have in common
        is below 1e-16 of the squares of the sides of its faces may it be larger.
        Where both surfaces are exchanged, so are cut and fill, to the bit; neither the order of the
        points changes a bit, nor a shift or a power of two that rounds no coordinate.

        A polygon that reaches beyond the hull of either surface is cut there, and its new corners
        are rounded to doubles. That error comes on top, and a shift changes bits: at an offset of
        4.5e5 it is about 1e-10 of an area of some units. Subtract the offset where this matters.

        Examples
        --------
        >>> import liftmesh
        >>> flat = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 6]])
        >>> round(flat.cut_and_fill(hill).fill, 9), round(hill.cut_and_fill(flat).cut, 9)
        (32.0, 32.0)
        """
        _check(self, other)
        if polygon is not None:
            fill, cut, area = in_all(self, polygon, partial(between_within, self, other))
            return Earthwork(cut, fill, area, cubic_metres_of(self))
        pair = _touching(self.triangulation, other.triangulation)
        fill, cut, area = 0.0, 0.0, 0.0
        if pair is not None:
            fill, cut, area = relief_of(self).between(relief_of(other), *pair)
            check_measured(("volume", fill), ("volume", cut), ("area", area))
        if not area > 0:
            raise InputError("the surfaces have no area in common")
        return Earthwork(cut, fill, area, cubic_metres_of(self))

    def cut_and_fill_by_polygon(
        self: Any, other: Surface, polygon: object, *, by: str = "name"
    ) -> dict[str | int, Earthwork]:
        """Compute the volumes between this surface and another one in each of several polygons.

        Parameters
        ----------
        other : Surface
            As for `cut_and_fill`.
        polygon : object
            As for `cut_and_fill`. Each feature of GeoJSON and each row of a table is measured by
            itself, whatever others cover.
        by : str, default "name"
            The property or column that has the names of polygons.

        Returns
        -------
        dict of str or int to Earthwork
            By the property or column `by` where it is a text, or any number if it is not ``name``,
            as text; else by the number of the polygon, from 0; zeros for a polygon that has no area
            in common with the faces.

        Raises
        ------
        InputError
            The surfaces are over different planes or in different coordinate systems, a polygon is
            invalid, two have one name, none has the property, or a volume is beyond the largest
            double.
        FormatError, MissingDependencyError, OSError
            As for `cut_and_fill`.

        Examples
        --------
        >>> import liftmesh
        >>> flat = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
        >>> lot = {"type": "Polygon", "coordinates": [[[0, 0], [2, 0], [2, 2], [0, 2]]]}
        >>> lots = [{"type": "Feature", "properties": {"name": "A 7"}, "geometry": lot}]
        >>> found = flat.cut_and_fill_by_polygon(
        ...     slope, {"type": "FeatureCollection", "features": lots}
        ... )
        >>> round(found["A 7"].fill, 9)
        4.0
        """
        _check(self, other)
        unit = cubic_metres_of(self)
        found = in_each(self, polygon, partial(between_within, self, other), by)
        return {name: Earthwork(cut, fill, area, unit) for name, (fill, cut, area) in found}


def _check(surface: Surface, other: Surface) -> None:
    if not hasattr(other, "triangulation") or not hasattr(other, "frame"):
        raise InputError(f"a {type(other).__name__} is no surface: triangulate it, or as_surface")
    one, two = surface.frame, other.frame
    if not (np.array_equal(one.axes, two.axes) and np.array_equal(one.origin, two.origin)):
        raise InputError("the surfaces are over different planes: give both the same")
    if are_different(surface.crs, other.crs):
        raise InputError(
            "the surfaces have different coordinate systems: read one with to_crs= that of the "
            "other, or replace(crs=None) if they are the same"
        )
    files = ("the file of this surface", surface), ("the file of the other surface", other)
    check_grounds((name, found_selection(each.metadata)) for name, each in files)


def _touching(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Return a face of each triangulation that touch; None if none do."""
    if (one.max_bound < two.min_bound).any() or (two.max_bound < one.min_bound).any():
        return None
    found = _of_a_vertex(one, two)
    if found is None:
        turned = _of_a_vertex(two, one)
        found = None if turned is None else (turned[1], turned[0])
    return found or _of_crossing_sides(one, two)


def _of_a_vertex(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Find a vertex of one in the other: a face at it, and the face that contains it."""
    rows = np.flatnonzero(one.vertex_to_simplex >= 0)
    place = two.find_simplex(one.points[rows])
    inside = np.flatnonzero(place >= 0)
    if not len(inside):
        return None
    return int(one.vertex_to_simplex[rows[inside[0]]]), int(place[inside[0]])


def _of_crossing_sides(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Find sides of the hulls that cross, where no vertex of one is in the other."""
    for (faces, tails, heads), (others, starts, ends) in product(_chains(one), _chains(two)):
        near, far = _overlapping(tails, heads, starts, ends)
        (tail, head), (start, end) = (
            [each.view(np.float64).reshape(-1, 2)[chosen] for each in sides]
            for sides, chosen in (((tails, heads), near), ((starts, ends), far))
        )
        apart = orient2d(tail, head, start) * orient2d(tail, head, end) > 0
        apart |= orient2d(start, end, tail) * orient2d(start, end, head) > 0
        if not apart.all():
            pair = int(np.argmin(apart))
            return int(faces[near[pair]]), int(others[far[pair]])
    return None


def _overlapping(tails: Array, heads: Array, starts: Array, ends: Array) -> tuple[Array, Array]:
    """Pair the sides of two chains that overlap in lexicographic order, as those do that touch.

    Sides of a chain follow each other, so there are little more pairs than sides.
    """
    first = np.searchsorted(ends, tails)
    counts = np.searchsorted(starts, heads, side="right") - first
    before = np.cumsum(counts) - counts
    sides = np.repeat(np.arange(len(tails)), counts)
    return sides, np.arange(len(sides)) + np.repeat(first - before, counts)


def _chains(tri: Triangulation) -> Iterator[tuple[Array, Array, Array]]:
    """Yield the lower and the upper hull: faces at their sides, and lesser and greater ends.

    Ends are complex numbers, which have a lexicographic order, and the sides are in this order.
    """
    faces, corner = np.nonzero(tri.neighbors < 0)
    tails, heads = (
        np.ascontiguousarray(tri.points[tri.simplices[faces, (corner + step) % 3]])
        .view(np.complex128)
        .ravel()
        for step in (1, 2)
    )
    for low, high in ((tails, heads), (heads, tails)):
        chosen = np.flatnonzero(low < high)
        chosen = chosen[np.argsort(low[chosen])]
        yield faces[chosen], low[chosen], high[chosen]
