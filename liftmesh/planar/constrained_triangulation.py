"""`ConstrainedTriangulation`: triangles with edges that were asked for.

Where regions were removed, the triangles of the whole convex hull are still there for point
location, whose walks must not meet holes: first the triangles that are left, in their order, then
those that were removed. So the first triangle at a point is one that is left if any is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Apex, Integers, Mask, Reals, Rows
from liftmesh.base.arrays import as_rows3, ends_of, pair_keys, read_only
from liftmesh.base.frozen import cached_property, check_numbers, check_starts
from liftmesh.base.options import refused
from liftmesh.errors import InputError
from liftmesh.planar.triangulation import Triangulation

if TYPE_CHECKING:
    import scipy.spatial

    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.lifting import LowerHull

Bits = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """What constraints have become."""

    rows: Rows  # (p, 2)
    indptr: Rows
    members: Rows  # input edges
    edges: Rows  # (k, 2): the input edges
    polyline: Rows
    polygon: Rows
    zero_length: Rows
    added: int  # rows after those of the caller
    crossings: int  # rows after these
    displacement: float
    steiner: int = 0  # rows after these


class ConstrainedTriangulation(Triangulation):
    """A triangulation with edges that were asked for, as returned by `constrained_delaunay`.

    A `Triangulation`, with the same attributes and methods; what the constraints add stands here.
    ``convex_hull``, ``min_bound`` and ``max_bound`` are those of all rows, also where regions were
    removed; ``neighbors``, ``edges``, ``vertex_to_simplex`` and ``vertex_neighbor_vertices`` are
    those of the triangles that are left; `find_simplex` returns -1 where none is. Read-only.

    Parameters
    ----------
    points, simplices, neighbors, convex_hull, duplicates, skipped
        As for `Triangulation`, of the whole convex hull.
    constrained : (m,) ndarray of uint8
        For each triangle, bit k tells whether the edge opposite vertex k is a constraint.
    pieces, left : object, and int
        The constraints and where they come from; how many triangles, the first ones, are left.

    Attributes
    ----------
    constraints : (p, 2) ndarray of int32
        The edges that are constraints, ascending, the lesser row first; of an input edge several.
    constraint_inputs : tuple of ndarray of int32
        The input edges of each constraint: indptr, (p + 1,), and indices. Those of constraint i are
        ``indices[indptr[i]:indptr[i + 1]]``, in ascending order; see also `inputs_of`.
    input_edges : (k, 2) ndarray of int32
        The input edges as rows: those given as edges, then of polylines, then of polygons.
    input_polylines, input_polygons : (k,) ndarray of int32
        The polyline, and the polygon, of each input edge; -1 for other edges. The parts of a
        MultiLineString or MultiPolygon, and the rows of a table, count one by one.
    zero_length : (z,) ndarray of int32
        Input edges whose ends are at one position, which are no constraints.
    added, crossing_rows : (a,) and (c,) ndarray of int32
        After the caller's rows, those of coordinates of polylines and polygons; then those where
        edges cross.
    displacement : float
        The largest distance of a crossing row from an input edge that it is on.

    See Also
    --------
    constrained_delaunay, Triangulation

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0], [4, -1], [8, 0], [4, 1]]
    >>> tri = liftmesh.constrained_delaunay(points, [[0, 2]])
    >>> tri
    <ConstrainedTriangulation: 2 triangles over 4 rows, 0 duplicates, 0 skipped, 1 constraint>
    >>> tri.is_constrained.sum(axis=1), tri.regions
    (array([1, 1]), array([0, 1], dtype=int32))
    """

    _has_empty_circles = False

    def __init__(  # noqa: PLR0913, PLR0917 - as many as there are arrays
        self,
        points: Reals,
        simplices: Rows,
        neighbors: Rows,
        convex_hull: Rows,
        duplicates: Rows,
        skipped: Rows,
        constrained: Bits,
        pieces: Pieces,
        left: int,
    ) -> None:
        super().__init__(points, simplices, neighbors, convex_hull, duplicates, skipped)
        self.constraints = read_only(pieces.rows)
        self.constraint_inputs = read_only(pieces.indptr), read_only(pieces.members)
        self.input_edges = read_only(pieces.edges)
        self.input_polylines = read_only(pieces.polyline)
        self.input_polygons = read_only(pieces.polygon)
        self.zero_length = read_only(pieces.zero_length)
        self._steiner = pieces.steiner
        end = len(points) - pieces.steiner
        own = end - pieces.added - pieces.crossings
        rows = read_only(np.arange(own, end, dtype=np.int32))
        self.added, self.crossing_rows = rows[: pieces.added], rows[pieces.added :]
        self.displacement = pieces.displacement
        self._whole = self.simplices, self.neighbors
        self._constrained = read_only(constrained)
        self._cut(left)

    def _cut(self, left: int) -> None:
        """Leave the first triangles, and outside instead of others."""
        simplices, neighbors = self._whole
        if left < len(simplices):
            cut = np.where(neighbors[:left] < left, neighbors[:left], np.int32(-1))
            self.simplices, self.neighbors = simplices[:left], read_only(cut)

    def _given(self) -> tuple[Rows, ...]:
        whole = getattr(self, "_whole", (self.simplices, self.neighbors))
        return *whole, self._hull, self.duplicates, self.skipped

    def __getstate__(self) -> dict[str, Any]:
        state = super().__getstate__()
        del state["neighbors"]
        state["simplices"] = self.nsimplex  # both are cut from all again
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        left = state.pop("simplices")
        self.simplices, self.neighbors = state["_whole"]
        super().__setstate__(state)
        rows, (indptr, members) = len(self._rows), self.constraint_inputs
        check_numbers(0, rows, self.constraints, self.input_edges)
        check_starts(indptr, len(self.constraints), len(members))
        check_numbers(0, len(self.input_edges), members)
        check_numbers(0, len(self.simplices) + 1, np.array([left, len(self._constrained)]))
        for array in (*self._whole, indptr, members):
            array.setflags(write=False)
        self._cut(left)

    def __repr__(self) -> str:
        count = len(self.constraints)
        return f"{super().__repr__()[:-1]}, {count} constraint{'s' * (count != 1)}>"

    @property
    def carved(self) -> bool:
        """Whether regions were removed."""
        return self.nsimplex < len(self._constrained)

    @cached_property
    def is_constrained(self) -> Mask:
        """Whether the edge opposite vertex k of each triangle is a constraint, (m, 3) bool."""
        bits = self._constrained[: self.nsimplex, None] >> np.arange(3, dtype=np.uint8)
        return self._kept((bits & 1).astype(np.bool_))

    @cached_property
    def regions(self) -> Rows:
        """The region of each triangle, (m,) int32: what constraints separate, from 0 on."""
        bits = self._constrained[: self.nsimplex]
        return self._kept(_kernel.label_regions(np.ascontiguousarray(self.neighbors), bits))

    @cached_property
    def repeated(self) -> Rows:
        """Input edges from and to the same positions as an earlier one, (r, 2) int32.

        Each with the first such edge, in either direction; those in `zero_length` are left out.
        """
        kept = np.arange(self.npoints)
        row, first = self.duplicates.T
        kept[row] = first
        ends = np.sort(kept[self.input_edges], axis=1)
        edges = np.flatnonzero(ends[:, 0] != ends[:, 1])
        _, start, group = np.unique(
            pair_keys(*ends[edges].T), return_index=True, return_inverse=True
        )
        earliest = start[group]
        is_later = earliest != np.arange(len(edges))
        pairs = np.stack([edges[is_later], edges[earliest[is_later]]], axis=1)
        return self._kept(pairs.astype(np.int32))

    def inputs_of(self, constraint: int) -> Rows:
        """Return the input edges that a constraint belongs to.

        Parameters
        ----------
        constraint : int
            Which row of ``constraints``.

        Returns
        -------
        (e,) ndarray of int32
            Rows of ``input_edges``, in ascending order.

        Raises
        ------
        IndexError
            There is no such constraint.

        See Also
        --------
        ConstrainedTriangulation : Its ``constraint_inputs`` are those of all constraints.

        Examples
        --------
        >>> import liftmesh
        >>> points = [[0, 0], [1, 0], [2, 0], [1, 1]]
        >>> tri = liftmesh.constrained_delaunay(points, [[0, 2], [2, 1]])
        >>> tri.constraints.tolist(), tri.inputs_of(1)
        ([[0, 1], [1, 2]], array([0, 1], dtype=int32))
        """
        indptr, members = self.constraint_inputs
        number = range(len(self.constraints))[constraint]
        return members[indptr[number] : indptr[number + 1]]

    def to_cloud(self, *, markers: ArrayLike | None = None) -> Cloud:
        """Convert the triangulation to a cloud with faces and edges, as files have them.

        Returns a Cloud with z = 0.
        In full: `liftmesh.planar.constrained_triangulation.as_cloud`.

        Parameters
        ----------
        markers : (k,) array_like of int, optional, a number for each of `input_edges`
        """
        return as_cloud(self, markers)

    def _left(self, found: Rows) -> Rows:
        found[found >= self.nsimplex] = -1
        return found

    @cached_property
    def _locator(self) -> _kernel.Locator:
        return _kernel.Locator(self._rows, *map(np.ascontiguousarray, self._whole))

    def lifted(self, apex: Apex = "median") -> LowerHull:  # noqa: ARG002 - no apex helps
        """Raise an InputError: the lift of constrained triangles is no lower hull.

        In full: `liftmesh.Triangulation.lifted`.

        Parameters
        ----------
        apex : as of `Triangulation`
        """
        raise InputError(
            "triangles with constraints are no lower hull of lifted points: liftmesh.lift(points) "
            "and simplices are the vertices and faces of their lift"
        )

    def to_scipy(self) -> scipy.spatial.Delaunay:
        """Convert to ``scipy.spatial.Delaunay``; an InputError if regions were removed.

        In full: `liftmesh.Triangulation.to_scipy`.
        """
        if self.nsimplex < len(self._whole[0]):
            raise InputError(
                "regions were removed, and SciPy's point location would end at them: convert the "
                "triangulation without carve, and mask what find_simplex tells to be outside"
            )
        return super().to_scipy()


def with_rows(
    tri: ConstrainedTriangulation,
    points: Reals,
    names: Rows,
    duplicates: Rows,
    hull: Rows,
    skipped: Rows | None = None,
) -> ConstrainedTriangulation:
    """Make the same triangles of other rows, of which there are as many."""
    simplices, neighbors = tri._whole  # noqa: SLF001 - of this module
    pieces = _in_order(np.sort(names[tri.constraints], axis=1), *tri.constraint_inputs)
    return ConstrainedTriangulation(
        points,
        names.take(simplices, axis=0),
        neighbors,
        names[hull],
        duplicates,
        tri.skipped if skipped is None else skipped,
        tri._constrained,  # noqa: SLF001 - of this module
        pieces_of(tri, *pieces),
        tri.nsimplex,
    )


def with_sides(tri: ConstrainedTriangulation, sides: Mask) -> ConstrainedTriangulation:
    """Make the same triangles with some sides of them, if any, as further input edges."""
    if not sides.any():
        return tri
    simplices, neighbors = tri._whole  # noqa: SLF001 - of this module
    face, k = np.nonzero(sides)
    ends = ends_of(simplices, face, k)
    beyond = neighbors[face, k]
    face, beyond = face[beyond >= 0], beyond[beyond >= 0]
    across = (neighbors[beyond] == face[:, None]).argmax(axis=1)
    constrained = tri._constrained.copy()  # noqa: SLF001 - of this module
    constrained[: len(sides)] |= bits_of(sides)
    np.bitwise_or.at(constrained, beyond, (1 << across).astype(np.uint8))
    (indptr, members), added = tri.constraint_inputs, np.arange(len(ends), dtype=np.int32)
    pieces = _in_order(
        np.concatenate([tri.constraints, ends]),
        np.concatenate([indptr, indptr[-1:] + 1 + added]),
        np.concatenate([members, len(tri.input_edges) + added]),
    )
    none = np.full_like(added, -1)
    inputs = replace(
        pieces_of(tri, *pieces),
        edges=np.concatenate([tri.input_edges, ends]),
        polyline=np.concatenate([tri.input_polylines, none]),
        polygon=np.concatenate([tri.input_polygons, none]),
    )
    whole = simplices, neighbors, tri.convex_hull, tri.duplicates, tri.skipped
    return ConstrainedTriangulation(tri.points, *whole, constrained, inputs, tri.nsimplex)


def with_left(tri: ConstrainedTriangulation, keep: Mask) -> ConstrainedTriangulation:
    """Leave other triangles of the whole convex hull."""
    order, simplices, neighbors = left_first(keep, *tri._whole)  # noqa: SLF001 - of this module
    bits = tri._constrained[order]  # noqa: SLF001 - of this module
    pieces = pieces_of(tri, tri.constraints, *tri.constraint_inputs)
    whole = simplices, neighbors, tri.convex_hull, tri.duplicates, tri.skipped
    left = int(np.count_nonzero(keep))
    return ConstrainedTriangulation(tri.points, *whole, bits, pieces, left)


def pieces_of(tri: ConstrainedTriangulation, rows: Rows, indptr: Rows, members: Rows) -> Pieces:
    """Describe other pieces of the same input edges."""
    return Pieces(
        rows,
        indptr,
        members,
        tri.input_edges,
        tri.input_polylines,
        tri.input_polygons,
        tri.zero_length,
        len(tri.added),
        len(tri.crossing_rows),
        tri.displacement,
        tri._steiner,  # noqa: SLF001 - of this module
    )


def as_cloud(tri: ConstrainedTriangulation, markers: ArrayLike | None = None) -> Cloud:
    """Convert a triangulation to a cloud with faces and edges, as files have them.

    Parameters
    ----------
    tri : ConstrainedTriangulation
        What is converted.
    markers : array_like of int of shape (k,), optional
        A number for each of `input_edges`, or for the first of them; 0 stands for none. Those of
        the constraints, each that of its first input edge that has one, are "markers" of the
        metadata, which MSH, SU2, VTU and .poly hold.

    Returns
    -------
    Cloud
        The rows with z = 0, the triangles that are left as faces, and the constraints as edges.

    Raises
    ------
    InputError
        `markers` are no whole numbers of 32 bits, or more than there are input edges.

    See Also
    --------
    liftmesh.write : Takes the triangulation itself, too.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0]]
    >>> tri = liftmesh.constrained_delaunay(points, [[0, 1], [3, 0], [1, 2]])
    >>> cloud = tri.to_cloud(markers=[7, 8])
    >>> cloud.edges.tolist(), cloud.metadata["markers"]
    ([[0, 3], [0, 4], [1, 2], [1, 4]], array([8, 7, 0, 7], dtype=int32))
    """
    from liftmesh.base.cloud import Cloud  # noqa: PLC0415 - a first triangulation does without
    from liftmesh.io.metadata import with_carved  # noqa: PLC0415

    entries = {} if markers is None else {"markers": _markers_of(tri, markers)}
    return Cloud(
        as_rows3(tri.points),
        faces=tri.simplices,
        edges=tri.constraints,
        metadata=with_carved(entries, tri.carved),
    )


def _markers_of(tri: ConstrainedTriangulation, given: ArrayLike) -> Rows:
    """Return the markers of constraints: that of the first input edge with one."""
    from liftmesh.io.tags import whole_numbers  # noqa: PLC0415 - as above

    numbers, (indptr, members) = whole_numbers(given), tri.constraint_inputs
    if numbers is None or numbers.ndim != 1 or len(numbers) > len(tri.input_edges):
        wanted = f"whole numbers of 32 bits, at most {len(tri.input_edges):,}"
        raise refused("markers", given, f"give one for each input edge: {wanted}")
    found = np.zeros(len(tri.input_edges) + 1, np.int32)
    found[: len(numbers)] = numbers
    found = np.append(found[members], np.int32(0))
    places = np.where(found != 0, np.arange(len(found)), len(members))
    return found[np.minimum.reduceat(places, indptr[:-1]) if len(indptr) > 1 else []]


def bits_of(sides: Mask) -> Bits:
    """Pack which sides of each triangle are meant."""
    return (sides @ np.array([1, 2, 4], dtype=np.uint8)).astype(np.uint8)


def left_first(keep: Mask, simplices: Rows, neighbors: Rows) -> tuple[Integers, Rows, Rows]:
    """Put the triangles that are left before the others; return that order, too."""
    order = np.concatenate([np.flatnonzero(keep), np.flatnonzero(~keep)])
    return order, *in_order(order, simplices, neighbors)


def in_order(order: Integers, simplices: Rows, neighbors: Rows) -> tuple[Rows, Rows]:
    """Put triangles, and their names in the lists of their neighbours, in another order."""
    name = np.empty(len(order) + 1, dtype=np.int32)
    name[order], name[-1] = np.arange(len(order), dtype=np.int32), -1
    return simplices.take(order, axis=0), name.take(neighbors.take(order, axis=0))


def _in_order(rows: Rows, indptr: Rows, members: Rows) -> tuple[Rows, Rows, Rows]:
    """Put constraints in ascending order, each with its input edges."""
    order = np.argsort(pair_keys(*rows.T), kind="stable")
    return rows[order], *members_of(order, indptr, members)


def members_of(groups: Integers, indptr: Rows, members: Rows) -> tuple[Rows, Rows]:
    """Return the members of some groups, in their order, with the starts of each."""
    counts = np.diff(indptr)[groups]
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    place = np.arange(starts[-1]) + np.repeat(indptr[:-1][groups] - starts[:-1], counts)
    return starts, members[place]
