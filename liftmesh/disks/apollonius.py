"""apollonius(): the Delaunay graph of disks, the dual of the additively weighted Voronoi diagram.

The distance of a point from a disk is that from its centre less the radius. Where radii differ, the
cells meet in arcs of hyperbolas. Disks are not lifted points: the lifted disks are circles on the
paraboloid, and a plane that touches three of them from below is a circle that touches three disks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import as_numbers, of_one_array
from liftmesh.base.options import (
    NonFinite,
    as_count,
    as_positive,
    check_option,
    check_progress,
    refused,
    shown,
)
from liftmesh.disks.graph import DiskGraph, are_finite, as_disks
from liftmesh.disks.sides import pieces_in, trace_sides
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.planar.certificate import Certificate


_FINEST = 2.0**-46  # least distance from arcs, of the coordinates: 64 times their rounding


@of_one_array
def apollonius(
    points: ArrayLike,
    radii: ArrayLike,
    *,
    nonfinite: NonFinite = "error",
    progress: Progress | None = None,
) -> ApolloniusGraph:
    """Compute the Delaunay graph of disks, exact where all numbers span at most 256 binary digits.

    A point of the plane belongs to the disk of least distance |x - c| - r, and disks whose cells
    share a side share an edge. So every triangle has a circle that touches its three disks from
    outside and that no disk enters. A disk within another has no cell: it is hidden.

    The result is unique. Where four or more disks touch one circle, it is as if each was
    infinitesimally smaller: the smallest by the most, and of equal ones the last by x, then y. With
    equal radii, the triangles are those of `delaunay`.

    Parameters
    ----------
    points : array_like of shape (n, 2)
        The centre of each disk. Disks may overlap.
    radii : (n,) array_like
        The radius of each disk, not negative: 0 for a point.
    nonfinite : {"error", "skip"}, default "error"
        Rows whose centre or radius is NaN or infinite raise, or are skipped and listed.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    ApolloniusGraph
        Indices are rows of `points`. Fewer than three disks, or disks in a row, may have no
        triangle; they have neighbours.

    Raises
    ------
    InputError
        The shape or the type of the values is wrong, a radius is negative, or there is not one for
        each row; or the lowest binary digit of a number is 2^256 times as small as the highest one
        of another, so that the differences of both have more digits than the exact signs have room
        for. The message names both rows.
    NonFiniteError
        A coordinate or a radius is not finite and `nonfinite` is "error".
    UnsupportedTypeError
        `points` is a path, or a column for each axis was given.

    See Also
    --------
    apollonius_diagram : The dual cells, inside a domain.
    regular : Disks by their power, with straight cells.
    verify : An exact check of the result.

    Notes
    -----
    M. Karavelas and M. Yvinec, "Dynamic additively weighted Voronoi diagrams in 2D", ESA 2002, for
    the insertion of disks. Its order is random in rounds, so O(log n) expected steps for a disk on
    most inputs; it changes nothing of the result. Signs are decided in floating point where that
    is proved, else in integers; ARCHITECTURE.md derives them.

    Examples
    --------
    >>> graph = apollonius([[0, 0], [6, 0], [0, 6], [6, 6], [1, 0]], [2, 1, 1, 1, 0.5])
    >>> graph
    <ApolloniusGraph: 2 triangles over 5 disks, 1 hidden, 0 duplicates>
    >>> graph.simplices.tolist(), graph.hidden.tolist()
    ([[0, 1, 3], [0, 3, 2]], [4])
    >>> apollonius([[0, 0], [1, 1]], [1, -1])
    Traceback (most recent call last):
    liftmesh.errors.InputError: row 1 has the radius -1.0: radii are not negative
    """
    check_option("nonfinite", nonfinite, NonFinite)
    check_progress(progress)
    disks = as_disks(points, radii, nonfinite)
    rows = np.flatnonzero(are_finite(disks)).astype(np.int32)
    names = ("simplices", "neighbors", "circles", "convex_hull", "hidden", "duplicates")
    run = _kernel.apollonius(disks[rows], progress)
    arrays: dict[str, Any] = dict(zip(names, run, strict=True))
    arrays["convex_hull"] = arrays["convex_hull"][:, 0].copy()
    if len(rows) < len(disks):
        of_rows = {
            name: rows[arrays[name]] for name in names if name not in ("neighbors", "circles")
        }
        skipped = np.flatnonzero(~are_finite(disks)).astype(np.int32)
        arrays |= of_rows | {"skipped": skipped}
    if progress is not None:
        progress(1.0)
    return ApolloniusGraph(disks[:, :2], disks[:, 2], **arrays)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ApolloniusGraph(DiskGraph):
    """The Delaunay graph of disks, as returned by `apollonius`.

    Every index is a row of the caller's arrays. It is no triangulation of the centres: triangles
    may be degenerate or turned over as triangles of these, and two may have the same corners, one
    for each order. A disk may have two neighbours only, and share two edges with one of them. All
    arrays are read-only.

    Parameters
    ----------
    centers : (n, 2) ndarray of float64
        The centres.
    radii : (n,) ndarray of float64
        The radii.
    simplices : (m, 3) ndarray of int32
        The triangles, in ascending order, each from its lowest row on: the order in which a circle
        that no disk enters touches its three disks, counter-clockwise about the circle's centre.
    neighbors : (m, 3) ndarray of int32
        The triangle across the edge opposite corner k; -1 outside. If two triangles share two
        edges, each names the other twice.
    circles : (m, 3) ndarray of float64
        Centre and radius of these circles, rounded. The radius is negative if the circle is
        touched from its inside, in the overlap of three disks.
    convex_hull : (h,) ndarray of int32
        The rows on the convex hull of the disks, counter-clockwise: each has a common tangent with
        the next that no disk crosses. A large disk may occur several times. Disks that touch one
        such tangent from the same side follow each other.
    hidden : (k, ) ndarray of int32
        Rows within a disk of another row, in ascending order: also those that touch its boundary
        from inside. They have no cell.
    duplicates : (j, 2) ndarray of int32
        Rows equal to a row before, unless hidden, each with the first such row, which stands for
        them.
    skipped : (i,) ndarray of int32
        Rows skipped because they are not finite.

    See Also
    --------
    apollonius : Computes it.
    ApolloniusCells : The dual cells, inside a domain.

    Examples
    --------
    >>> import liftmesh
    >>> graph = liftmesh.apollonius([[-4, 0], [4, 0], [0, 0]], [3, 3, 0.5])
    >>> graph.simplices.tolist()  # the circles above and below
    [[0, 1, 2], [0, 2, 1]]
    >>> graph.circles[0].round(6).tolist()
    [0.0, -1.95, 1.45]
    >>> graph.edges.tolist()
    [[0, 1], [0, 1], [0, 2], [1, 2]]
    """

    def __repr__(self) -> str:
        skipped = f", {len(self.skipped):,} skipped" if len(self.skipped) else ""
        return (
            f"<ApolloniusGraph: {len(self.simplices):,} triangles over {len(self.radii):,} disks, "
            f"{len(self.hidden):,} hidden, {len(self.duplicates):,} duplicates{skipped}>"
        )

    @property
    def edges(self) -> Rows:
        """Pairs of disks whose cells share a side, (e, 2) int32, in ascending order.

        A pair stands there once for each side: disks between which another stands may share two.
        """
        # Of its two sides, of triangles or of the hull, one is in ascending order.
        sides = self.simplices[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2)
        pairs = np.concatenate([sides, self.hull_pairs[:, ::-1]])
        pairs = pairs[pairs[:, 0] < pairs[:, 1]]
        return pairs[np.lexsort(pairs.T[::-1])]

    def verify(
        self, *, threads: int | None = None, progress: Progress | None = None
    ) -> Certificate:
        """Verify exactly that this is the Delaunay graph of its disks.

        The same as ``liftmesh.verify(graph)``. Nothing is taken for granted: the arrays may come
        from any program. The checks are: in each triangle no disk is within another, and a circle
        touches its disks in their order; every side is the reverse of one other; what separates two
        cells leads from the circle on one side of their edge to that on the other, forward; the
        hull winds around once; and every other row is within another disk, or equal to a row with
        triangles. That suffices: the cells are then star-shaped about their centres, tile the
        plane, and are the true ones. Ties are checked too, and `circles`, which have to be those of
        `apollonius`, bit for bit: circles that another program has rounded are a flaw of the kind
        "other_circles", and the only one if all else is right.

        Parameters
        ----------
        threads : int, optional
            As for `delaunay`. The certificate is the same for any number.
        progress : callable, optional
            As for `delaunay`.

        Returns
        -------
        Certificate
            True if this is a Delaunay graph of the disks; ``canonical`` is whether it is also the
            one that `apollonius` returns, in whatever order its triangles are and wherever its hull
            begins. Its member is "apollonius".

        Raises
        ------
        InputError
            An array has another shape or type, or the disks are none that `apollonius` takes.
        NonFiniteError
            A coordinate or a radius is not finite, and no row is said to be skipped.

        See Also
        --------
        verify : The same for any triangulation.

        Notes
        -----
        O(n) on n disks of which none is hidden, and O(n log n) on the hull. If there are hidden
        rows, a disk that contains each is looked for as `apollonius` does it, and takes as long;
        whether it contains the row is decided apart from that.

        Examples
        --------
        >>> from dataclasses import replace
        >>> import liftmesh
        >>> graph = liftmesh.apollonius([[0, 0], [6, 0], [0, 6], [6, 6]], [2, 1, 1, 1])
        >>> print(graph.verify())
        valid: these 2 triangles are the canonical Delaunay graph of disks of 4 rows
        >>> print(replace(graph, simplices=graph.simplices[:, ::-1]).verify().flaws[0].text)
        2 triangles have no circle that touches their disks in their order
        """
        # Only those who ask need it.
        from liftmesh.disks.verification import verify_graph  # noqa: PLC0415

        return verify_graph(self, threads=threads, progress=progress)

    def neighbors_of(self, row: int) -> Rows:
        """Return the disks whose cells meet that of a disk.

        Parameters
        ----------
        row : int
            A row.

        Returns
        -------
        (k,) ndarray of int32
            In ascending order, each once; empty for a row that is hidden, a duplicate or skipped.

        Raises
        ------
        InputError
            It is no number of a row, or there is no such row.

        See Also
        --------
        Triangulation.vertex_neighbor_vertices : The same of points.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.apollonius([[0, 0], [5, 0], [0, 5]], [1, 1, 1]).neighbors_of(2)
        array([0, 1], dtype=int32)
        """
        if as_count("row", row, 0) >= len(self.radii):
            raise InputError(f"there is no row {row} among {len(self.radii):,} disks")
        edges = self.edges
        return np.unique(edges[:, ::-1][edges == row])

    def cell_sides(
        self, bounds: ArrayLike, max_deviation: float
    ) -> list[tuple[tuple[int, int], Floats]]:
        """Return the sides of all cells within bounds, as polylines.

        A side is an arc of a hyperbola, or a segment between equal disks. The points are rounded;
        between them, chords are at most `max_deviation` off the arc.

        Parameters
        ----------
        bounds : (4,) array_like
            xmin, ymin, xmax, ymax. Sides are cut off there.
        max_deviation : float
            Positive, in the unit of the coordinates; 2^-46 of the bounds at least. No more
            than their longer side counts.

        Returns
        -------
        list of tuple
            For each piece the two disks whose cells share it, the lower row first, and its points,
            (k, 2) float64.

        Raises
        ------
        InputError
            They are no numbers, `bounds` are not finite or have no area, or `max_deviation` is not
            positive or not finite, near the rounding of coordinates, or so small that there are too
            many points to hold.

        See Also
        --------
        apollonius_diagram : Whole cells, as polygons.

        Examples
        --------
        >>> import liftmesh
        >>> graph = liftmesh.apollonius([[0, 0], [4, 0]], [1, 1])
        >>> [(disks, line)] = graph.cell_sides((0, -1, 4, 1), 0.1)
        >>> disks, line.round(9).tolist()
        ((0, 1), [[2.0, -1.0], [2.0, 1.0]])
        """
        limits, length = _as_limits(bounds), as_max_deviation(max_deviation, bounds)
        return list(pieces_in(trace_sides(self, limits, length)))


def _as_limits(bounds: ArrayLike) -> tuple[float, float, float, float]:
    values = as_numbers("bounds", bounds, "give real numbers", verb="are")
    if values.shape != (4,) or not np.isfinite(values).all():
        raise refused("bounds", bounds, "give four finite numbers", verb="are")
    x, y, right, upper = values.tolist()
    if not (x < right and y < upper):
        raise refused("bounds", bounds, "give xmin, ymin, xmax, ymax", verb="are")
    return x, y, right, upper


def as_max_deviation(max_deviation: float, bounds: ArrayLike) -> float:
    """Convert how far polylines may be from their arcs."""
    value = as_positive("max_deviation", max_deviation, "a positive, finite number")
    limits = np.asarray(bounds, dtype=np.float64)
    least = float(np.abs(limits).max()) * _FINEST
    if value < least:
        raise InputError(
            f"max_deviation is {shown(max_deviation)}, near the rounding of coordinates there: "
            f"give {least:.2g} at least"
        )
    longer = 2 * float((limits[2:] / 2 - limits[:2] / 2).max())
    return min(value, longer)
