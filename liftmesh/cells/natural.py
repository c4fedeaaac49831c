"""natural_neighbors(): what a new point's Voronoi cell would take from the cells of the others.

The triangles whose circle has the point inside form a cavity around it (Bowyer 1981, Watson 1981);
the rows on its border are its natural neighbours, and exact in-circle tests find them. Sibson's
weight of a row ("A brief description of natural neighbour interpolation", 1981) is the share that
the new cell takes of the row's. Along the boundary of that share stand the new cell's corners and
the centres of triangles of the cavity; its area is a sum over edges, each of which counts for the
rows at both ends. So all points are treated at once, an array for each kind of edge.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh._typing import Array, Floats, Mask, Rows
from liftmesh.arrays import as_pairs, as_reals, check_finite, read_only
from liftmesh.cells.sites import sites_of
from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.member import options_of
from liftmesh.planar.triangulation import Triangulation
from liftmesh.predicates import incircle, orient2d


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class NaturalNeighbors:
    """The natural neighbours of points, as returned by `natural_neighbors`.

    Parameters
    ----------
    indptr : (m + 1,) ndarray of int64
        Point i has the neighbours from ``indptr[i]`` to ``indptr[i + 1]``; none outside of the
        convex hull.
    rows : (k,) ndarray of int32
        The neighbours, in ascending order.
    weights : (k,) ndarray of float64
        The share of each in the point's cell: those of a point add up to 1.
    rows_in_all : int
        How many rows there are, neighbours or not.

    Examples
    --------
    >>> import liftmesh
    >>> square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    >>> found = liftmesh.natural_neighbors(square, [[1, 1], [5, 5]])
    >>> found.rows, found.weights, found.indptr
    (array([0, 1, 2, 3], dtype=int32), array([0.25, 0.25, 0.25, 0.25]), array([0, 4, 4]))
    """

    indptr: NDArray[np.int64]
    rows: Rows
    weights: Floats
    rows_in_all: int

    def __repr__(self) -> str:
        count = len(self.indptr) - 1
        return f"<NaturalNeighbors: {len(self.rows):,} of {count:,} points>"

    def interpolate(self, values: ArrayLike) -> Floats:
        """Interpolate values of the rows.

        Parameters
        ----------
        values : (n, ...) array_like
            A value for each row, or several.

        Returns
        -------
        (m, ...) ndarray of float64
            Their means by the weights; NaN for points without neighbours.

        Raises
        ------
        InputError
            There are more or fewer values than rows.

        Examples
        --------
        >>> import liftmesh
        >>> found = liftmesh.natural_neighbors([[0, 0], [4, 0], [0, 4]], [[1, 1], [9, 9]])
        >>> found.interpolate([0, 10, 20])
        array([7.5, nan])
        """
        try:
            held = as_reals(values)
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"values are {shown(values)}: give a number for each row") from error
        if held.ndim == 0 or len(held) != self.rows_in_all:
            raise InputError(
                f"values have the shape {held.shape}: give one for each of the "
                f"{self.rows_in_all:,} rows"
            )
        count = np.diff(self.indptr)
        found = np.full((len(count), *held.shape[1:]), np.nan)
        if len(self.rows):
            products = held[self.rows] * self.weights.reshape(-1, *(1,) * (held.ndim - 1))
            found[count > 0] = np.add.reduceat(products, self.indptr[:-1][count > 0])
        return found


def natural_neighbors(points: ArrayLike | Triangulation, queries: ArrayLike) -> NaturalNeighbors:
    """Find the natural neighbours of points, and Sibson's weights.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3), or Triangulation
        Planar points, as for `voronoi`, or what `delaunay` returns of them.
    queries : array_like of shape (m, 2)
        Where neighbours are asked for; or a cloud, a table or points of GeoPandas.

    Returns
    -------
    NaturalNeighbors
        Rows and weights. At a row this alone has a weight, on the convex hull the two rows of the
        edge; outside there are none. Of rows at one position the first counts.

    Raises
    ------
    InputError
        As for `delaunay`; the triangulation is by weights, a metric or the farthest point; or its
        points have changed since.
    NonFiniteError
        A point or a query is not finite.
    DegenerateInputError
        All points lie on one line.

    Notes
    -----
    Which rows are neighbours is exact; weights are rounded. So near to the hull that areas exceed
    float64, they are those of the triangle around the query, linearly. A query takes time in
    proportion to the triangles that it would replace.

    Examples
    --------
    >>> rng = np.random.default_rng(3)
    >>> points, queries = rng.random((100, 2)), rng.random((5, 2)) / 2 + 0.25
    >>> found = natural_neighbors(points, queries)
    >>> bool(np.allclose(found.interpolate(points), queries))  # linear functions are reproduced
    True
    """
    tri = (
        points
        if isinstance(points, Triangulation)
        else delaunay(sites_of(points, queries), copy=True)
    )
    if other := options_of(tri):
        raise InputError(
            f"points are triangulated by {', '.join(other)}, and natural neighbours are those of a "
            "Delaunay triangulation: give the points"
        )
    rows = sites_of(queries)
    at = as_pairs(rows if rows is queries else np.asarray(rows)[:, :2]).reshape(-1, 2)
    check_finite(at, skippable=False)
    simplex = tri.find_simplex(at)
    inside = np.flatnonzero(simplex >= 0)
    cavity = _Cavities(tri, at, inside, simplex[inside])
    return _gathered(cavity.weights(), len(at), len(tri.points))


def _gathered(found: tuple[Array, Array, Array], count: int, rows: int) -> NaturalNeighbors:
    query, row, weight = found
    order = np.lexsort((row, query))
    query, row, weight = query[order], row[order], weight[order]
    total = np.bincount(query, weight, minlength=count)
    number = np.bincount(query, minlength=count)
    return NaturalNeighbors(
        read_only(np.concatenate([[0], np.cumsum(number)])),
        read_only(row.astype(np.int32)),
        read_only(weight / total[query]),
        rows,
    )


class _Cavities:
    """The triangles that each query would replace."""

    def __init__(
        self, tri: Triangulation, at: Floats, query: NDArray[np.intp], simplex: Rows
    ) -> None:
        self._points = np.asarray(tri.points[:, :2], dtype=np.float64)
        self._simplices, self._neighbors = tri.simplices, tri.neighbors
        self._at, self._query, self._simplex = at, query, simplex

    def weights(self) -> tuple[Array, Array, Array]:
        """Query, row and weight of each pair."""
        corners = self._simplices[self._simplex]
        is_row = (self._points[corners] == self._at[self._query, None]).all(axis=2)
        own = is_row.any(axis=1)
        alone = self._query[own], corners[is_row], np.ones(int(own.sum()))
        inner, border = self._edges(self._query[~own], self._simplex[~own])
        query, start, end, _, across = border.T
        flat = (across < 0) & self._is_between(query, start, end)
        on_hull = np.zeros(len(self._at), dtype=np.bool_)
        on_hull[query[flat]] = True
        areas = self._areas(inner[~on_hull[inner[:, 0]]], border[~on_hull[query]])
        known = self._known(areas)
        beyond = np.unique(areas[0][~known])
        pieces = [alone, *self._linear(border[flat]), *self._barycentric(beyond)]
        pieces.append((areas[0][known], areas[1][known], areas[2][known]))
        joined = (np.concatenate(each) for each in zip(*pieces, strict=True))
        return next(joined), next(joined), next(joined)

    def _known(self, areas: tuple[Array, Array, Array]) -> Mask:
        """Which belong to a query whose areas float64 holds."""
        with np.errstate(all="ignore"):
            total = np.bincount(areas[0], areas[2], minlength=len(self._at))
        is_known: Mask = np.isfinite(total) & (total > 0)
        return is_known[areas[0]]

    def _edges(self, query: Array, simplex: Array) -> tuple[Array, Array]:
        """Edges inside and around cavities: query, start, end, triangle to the left, and across."""
        query, simplex, side = (
            np.repeat(query, 3),
            np.repeat(simplex, 3),
            np.tile([0, 1, 2], len(query)),
        )
        inner, border = [], []
        taken = np.ones(len(self._at), dtype=np.int64)  # triangles of each cavity
        while len(query):
            across = self._neighbors[simplex, side]
            start = self._simplices[simplex, (side + 1) % 3]
            end = self._simplices[simplex, (side + 2) % 3]
            edges = np.stack([query, start, end, simplex, across], axis=1).astype(np.int64)
            is_inner = self._is_in_circle(across, query)
            border.append(edges[~is_inner])
            inner.append(edges[is_inner])
            self._check_cavities(inner[-1], taken)
            query, simplex, side = self._beyond(inner[-1])
        return np.concatenate([*inner, np.empty((0, 5), int)]), np.concatenate(
            [*border, np.empty((0, 5), int)]
        )

    def _check_cavities(self, edges: Array, taken: NDArray[np.int64]) -> None:
        """Raise if the triangles across edges are turned over, or met again and again.

        Neither happens in a Delaunay triangulation, and a search in anything else might not end.
        """
        query, _, _, _, across = edges.T
        np.add.at(taken, query, 1)
        a, b, c = (self._points[rows] for rows in self._simplices[across].T)
        is_turned = bool((orient2d(a, b, c) <= 0).any())
        if is_turned or taken[query].max(initial=0) > len(self._simplices):
            raise _changed()

    def _is_in_circle(self, simplex: Array, query: Array) -> Mask:
        found = np.zeros(len(simplex), dtype=np.bool_)
        there = simplex >= 0
        a, b, c = (self._points[rows] for rows in self._simplices[simplex[there]].T)
        found[there] = incircle(a, b, c, self._at[query[there]]) > 0
        return found

    def _beyond(self, edges: Array) -> tuple[Array, Array, Array]:
        """The other two sides of the triangles across edges."""
        query, _, _, simplex, across = edges.T
        back = (self._neighbors[across] == simplex[:, None]).argmax(axis=1)
        sides = np.stack([(back + 1) % 3, (back + 2) % 3], axis=1).reshape(-1)
        return np.repeat(query, 2), np.repeat(across, 2), sides

    def _is_between(self, query: Array, start: Array, end: Array) -> Mask:
        turns = orient2d(self._points[start], self._points[end], self._at[query])
        return np.equal(turns, 0)

    def _linear(self, edges: Array) -> Iterator[tuple[Array, Array, Array]]:
        """On an edge of the hull the cell has no end: in the limit, it is divided linearly."""
        query, start, end, _, _ = edges.T
        for row, other in ((start, end), (end, start)):
            away = self._points[other] - self._at[query]
            yield query, row, np.abs(away).max(axis=1, initial=0.0)

    def _barycentric(self, query: Array) -> Iterator[tuple[Array, Array, Array]]:
        place = np.searchsorted(self._query, query)
        corners = self._simplices[self._simplex[place]]
        a, b, c = (self._points[rows] - self._at[query] for rows in corners.T)
        for rows, p, q in zip(corners.T, (b, c, a), (c, a, b), strict=True):
            yield query, rows, np.maximum(_cross(p, q), 0)

    @np.errstate(all="ignore")
    def _areas(self, inner: Array, border: Array) -> tuple[Array, Array, Array]:
        scale = self._scales(border)
        corner = self._corner(border, scale)
        sums = _Sums(border)
        centre = self._centre(border[:, 3], border[:, 0], scale)
        sums.add(border[:, 0], border[:, 1], border[:, 2], _cross(corner, centre))
        left, right = (self._centre(inner[:, k], inner[:, 0], scale) for k in (3, 4))
        sums.add(inner[:, 0], inner[:, 1], inner[:, 2], _cross(right, left))
        before = sums.edge_into
        sums.total += _cross(corner[before], corner)
        row = border[:, 1]
        a, b, c = (self._points[rows] for rows in (border[before, 1], row, border[:, 2]))
        is_neighbor = incircle(a, b, c, self._at[border[:, 0]]) != 0
        return border[is_neighbor, 0], row[is_neighbor], np.maximum(sums.total[is_neighbor], 0)

    def _scales(self, border: Array) -> NDArray[np.int64]:
        """For each query, the exponent that brings its neighbours to a distance of about 1."""
        away = np.abs(self._points[border[:, 1]] - self._at[border[:, 0]]).max(axis=1, initial=0.0)
        farthest = np.zeros(len(self._at))
        np.maximum.at(farthest, border[:, 0], away)
        return np.frexp(farthest)[1].astype(np.int64)

    def _from_query(self, rows: Array, query: Array, scale: NDArray[np.int64]) -> Floats:
        return np.ldexp(self._points[rows] - self._at[query], -scale[query, None])

    def _corner(self, border: Array, scale: NDArray[np.int64]) -> Floats:
        """The corners of new cells: centres of circles through the query and an edge."""
        query, start, end, _, _ = border.T
        return _centre(self._from_query(start, query, scale), self._from_query(end, query, scale))

    def _centre(self, simplex: Array, query: Array, scale: NDArray[np.int64]) -> Floats:
        """The centres of circles of triangles, from the query."""
        a, b, c = (self._from_query(rows, query, scale) for rows in self._simplices[simplex].T)
        return a + _centre(b - a, c - a)


class _Sums:
    """Twice the area that each edge of a border adds to the row at its start."""

    def __init__(self, border: Array) -> None:
        query, start, end, _, _ = border.T
        self._span = int(border[:, 1:3].max(initial=0)) + 1
        names = query * self._span + start
        self._order = np.argsort(names)
        self._names = names[self._order]
        self.edge_into = np.full(len(border), -1, dtype=np.intp)
        self.edge_into[self._places(query, end)] = np.arange(len(border))
        if (self.edge_into < 0).any():
            raise _changed()
        self.total = np.zeros(len(border))

    def _places(self, query: Array, row: Array) -> NDArray[np.intp]:
        names = query * self._span + row
        found = np.searchsorted(self._names, names)
        if (np.append(self._names, -1)[found] != names).any():
            raise _changed()
        places: NDArray[np.intp] = self._order[found]
        return places

    def add(self, query: Array, start: Array, end: Array, doubled: Floats) -> None:
        """Add to the row at the start of an edge, and subtract from that at its end."""
        for row, sign in ((start, 1), (end, -1)):
            place = self._places(query, row)
            self.total += np.bincount(place, sign * doubled, minlength=len(self.total))


def _changed() -> InputError:
    return InputError(
        "the points are not those that were triangulated: their array has changed since; "
        "triangulate them again, by delaunay(points, copy=True)"
    )


def _cross(p: Floats, q: Floats) -> Any:
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]


def _centre(p: Floats, q: Floats) -> Floats:
    """The centres of circles through two points and the origin."""
    square_p, square_q = (p * p).sum(axis=1), (q * q).sum(axis=1)
    doubled = np.stack(
        [square_p * q[:, 1] - square_q * p[:, 1], square_q * p[:, 0] - square_p * q[:, 0]], axis=1
    )
    centre: Floats = doubled / (2 * _cross(p, q))[:, None]
    return centre
