"""`thin`: fewer rows of a cloud, spread as the caller wants.

Which rows stay depends on the rows and the options alone, never on the machine or on a version of
NumPy. One per cell: cells are squares whose borders are multiples of their size, so that tiles of a
survey agree about them. A minimum distance: rounds, in each of which every row stays that comes
first within the distance, in an order as random as a hash of the coordinates; those that are too
near are left out. So the rows that stay do not depend on the order of the rows either.

Adaptive thinning keeps the rows without which linear interpolation loses most: the point is removed
next without which the sum of the squares of the distances of all that were removed, from the
surface of those that are left, grows least. Each step looks at the star of a point only: L. Demaret
and A. Iske, "Adaptive image approximation by linear splines over locally optimal Delaunay
triangulations", 2006. Points gather where the surface bends, and along an edge the triangles become
long and thin.

*Without spikes*, as of canopies and roofs, by a freeze distance. A pulse that slips between leaves
returns from deep inside a crown, and makes a spike in a surface of first returns. So layers of rows
come from above: each is triangulated with what is kept of those above it. Where all three sides of
a triangle are shorter than the freeze distance, it is *frozen*: rows further down that lie in it,
or on its sides, are left out. What a lower row does to the circles of the triangulation may still
turn the side of a frozen triangle; no row comes into it.

The result depends on the set of positions alone: layers count from the highest row, and of rows at
one planar position the highest counts.

Source: A. Khosravipour, A. K. Skidmore and M. Isenburg, Generating spike-free digital surface
models using LiDAR raw point clouds: a new approach for forestry applications, International Journal
of Applied Earth Observation and Geoinformation 52 (2016), 104-114. There rows come one by one, a
triangle is frozen as soon as it appears (or some height later, the insertion buffer), and stays.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask, Progress, Rows
from liftmesh.base.arrays import check_finite, starts_of_runs
from liftmesh.base.options import (
    CellRow,
    as_count,
    as_positive,
    check_option,
    check_progress,
    part_of,
    refused,
)
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.io.read import read_cloud
from liftmesh.io.selection import only
from liftmesh.planar.delaunay import delaunay
from liftmesh.predicates import orient2d
from liftmesh.terrain.surface_data import positions_of
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.triangulation import Triangulation

_LENGTH = "a positive number, in the cloud's units"
_MOST_CELLS = float(2**52)  # from the origin: beyond, doubles do not tell cells apart
# Of a cell of the distance / sqrt(2): all others that can have a point within the distance; those
# at the corners by no more than rounding.
_NEAR = [(i, j) for i in range(-2, 3) for j in range(-2, 3) if i or j]
_SEEDS = 2**63
_OWNERS = {"seed": "random", "keep": "cell", "spike_buffer": "spike_free"}
_TRIANGULATED = 0.1  # of adaptive thinning


def thin(  # noqa: PLR0913 - options are keywords
    cloud: object,
    *,
    every: int | None = None,
    random: int | None = None,
    seed: int | None = None,
    cell: float | None = None,
    keep: CellRow | None = None,
    min_distance: float | None = None,
    adaptive: int | None = None,
    spike_free: float | None = None,
    spike_buffer: float | None = None,
    progress: Progress | None = None,
) -> Cloud:
    """Thin a cloud by one of six ways.

    Parameters
    ----------
    cloud : path, Cloud or object
        Anything that `triangulate` takes.
    every : int, optional
        Keep every k-th row, the first one among them.
    random : int, optional
        Keep so many rows, chosen at random.
    seed : int, optional
        Of the choice at random, which is the same on every machine; 0 by default.
    cell : float, optional
        Keep one row of each square of this size in the plane.
    keep : {"lowest", "highest", "center"}, optional
        Which row of a cell: by its height, or the nearest to the centre of the cell; the lowest by
        default.
    min_distance : float, optional
        Keep rows so that no two are nearer to each other in the plane, and no other fits between;
        of rows at one planar position the lowest counts.
    adaptive : int, optional
        Keep so many rows: those without which a surface would lose most (adaptive thinning, L.
        Demaret and A. Iske, 2006). The next to go is always the one without which the squares of
        the vertical distances of all that are gone grow least; of several, as on level ground, one
        that a hash of the coordinates chooses. Corners of the hull stay; of rows at one planar
        position the first counts, and each row must be finite.
    spike_free : float, optional
        Keep the rows of a surface of tops without spikes, as of first returns over trees: rows come
        in layers from above, and those in a triangle all sides of which are shorter than this
        freeze distance are left out (A. Khosravipour, A. K. Skidmore and M. Isenburg, 2016). About
        three times the distance of pulses is usual. Of rows at one planar position the highest
        counts.
    spike_buffer : float, optional
        Of `spike_free`: the height of a layer, whose rows do not leave each other out; half of the
        freeze distance by default.
    progress : callable, optional
        As for `triangulate`; of `every`, `random` and `cell` it hears of the end alone.

    Returns
    -------
    Cloud
        The rows that stay, in their order, and the edges between them, without faces. Rows that
        are not finite stay where a cell or a distance decides. ``metadata["thinning"]`` has
        "n_rows", "n_kept", and how.

    Raises
    ------
    InputError
        None or several of the six are given, a value is invalid, `seed` is given without `random`,
        `keep` without `cell` or `spike_buffer` without `spike_free`, or `adaptive` is less than the
        number of corners of the hull, or by `spike_buffer` rows are in more than 10,000 layers.
    NonFiniteError, DegenerateInputError
        Of `adaptive`: as for `triangulate`.
    FormatError, UnsupportedTypeError
        As for `read` and `as_cloud`.

    See Also
    --------
    simplify : A surface with fewer vertices, within a bound.
    merge : Several clouds in one.

    Notes
    -----
    A layer of `spike_free` triangulates what is kept so far, and locates what is left: 10^6 first
    returns over trees of 25 m and the ground take 30 s with a buffer of 0.5 m. In mountains
    give a larger buffer.

    Examples
    --------
    >>> found = thin([[0.2, 0.2, 5], [0.7, 0.1, 4], [1.5, 0, 6]], cell=1.0)
    >>> found.points[:, 2].tolist(), found.metadata["thinning"]
    ([4.0, 6.0], {'n_rows': 3, 'n_kept': 2, 'cell': 1.0, 'keep': 'lowest'})
    """
    given = {"every": every, "random": random, "cell": cell, "min_distance": min_distance}
    given |= {"adaptive": adaptive, "spike_free": spike_free}
    way, value = _one_of(given)
    _check_owners(way, seed=seed, keep=keep, spike_buffer=spike_buffer)
    seed = 0 if seed is None else as_count("seed", seed, 0)
    keep = "lowest" if keep is None else keep
    check_option("keep", keep, CellRow)
    check_progress(progress)
    source = read_cloud(cloud)
    how: dict[str, object] = {way: value}
    rows: Array
    if way == "every":
        rows = np.arange(0, len(source), min(as_count("every", value, 1), max(len(source), 1)))
    elif way == "random":
        rows = _at_random(len(source), as_count("random", value, 1), seed)
        how["seed"] = seed
    elif way == "cell":
        rows = _of_cells(source.points, as_positive("cell", value, _LENGTH), keep)
        how["keep"] = keep
    elif way == "spike_free":
        distance = as_positive("spike_free", value, _LENGTH)
        buffer = distance / 2 if spike_buffer is None else spike_buffer
        rows = _tops(
            source.points, distance, as_positive("spike_buffer", buffer, _LENGTH), progress
        )
        how["spike_buffer"] = buffer
    elif way == "adaptive":
        rows = _most_significant(source, as_count("adaptive", value, 3), progress)
    else:
        rows = _apart(source.points, as_positive("min_distance", value, _LENGTH), progress)
    if progress is not None:
        progress(1.0)
    counts = {"n_rows": len(source), "n_kept": len(rows), **how}
    return only(source, rows, thinning=counts)


def rows_apart(planar: Floats, distance: float) -> Array:
    """Choose rows so that no two are nearer to each other in the plane; a distance of 0: all."""
    return _apart(planar, distance, None) if distance else np.arange(len(planar))


def _one_of(given: dict[str, float | int | None]) -> tuple[str, float | int]:
    ways = {key: value for key, value in given.items() if value is not None}
    if len(ways) != 1:
        several = " and ".join(f"{Option(key)}" for key in ways) or "none"
        *most, last = (f"{Option(key)}" for key in given)
        raise InputError(f"{several} of {', '.join(most)} and {last} are given: give one")
    return next(iter(ways.items()))


def _check_owners(way: str, **given: object) -> None:
    """Raise for an option of another way."""
    for name, value in given.items():
        owner = _OWNERS[name]
        if value is not None and owner != way:
            raise InputError(f"{Option(name)} is of {Option(owner)} only: give both, or neither")


def _most_significant(cloud: Cloud, wanted: int, progress: Progress | None) -> Rows:
    """Choose the rows that adaptive thinning keeps."""
    check_finite(cloud.points, skippable=False)
    surface = triangulate(cloud, progress=part_of(progress, 0.0, _TRIANGULATED))
    used, plane, hull = positions_of(surface)
    heights = np.ascontiguousarray(surface.vertices[used, 2], np.float64) + 0.0
    rest = part_of(progress, _TRIANGULATED, 1.0)
    rows, _, _ = _kernel.thin(plane, heights, hull, min(wanted, _kernel.MOST_ROWS), rest)
    if len(rows) > wanted:
        raise refused("adaptive", wanted, f"the hull alone has {len(rows)} corners, which stay")
    return np.sort(used[rows])


def _tops(points: Floats, distance: float, buffer: float, progress: Progress | None) -> Array:
    """Keep the rows of a surface without spikes."""
    is_finite = np.isfinite(points).all(axis=1)
    rows = np.flatnonzero(is_finite)
    kept = spike_free_rows(points[rows].astype(np.float64, copy=False), distance, buffer, progress)
    return np.sort(np.concatenate([rows[kept], np.flatnonzero(~is_finite)]))


def _at_random(count: int, wanted: int, seed: int) -> Array:
    if wanted >= count:
        return np.arange(count)
    order = _mixed(np.arange(count, dtype=np.uint64), seed % _SEEDS)
    return np.sort(np.argpartition(order, wanted)[:wanted])


def _mixed(values: Array, seed: int) -> Array:
    """Hash 64 bits as splitmix64 does, which maps no two values to one."""
    with np.errstate(over="ignore"):
        bits = values + np.uint64(0x9E3779B97F4A7C15) * np.uint64(seed + 1)
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        mixed: Array = bits ^ (bits >> np.uint64(31))
    return mixed


def _of_cells(points: Floats, size: float, keep: CellRow) -> Array:
    """Keep one row of each cell; of equal ones the lexicographically least, then the first."""
    is_finite = np.isfinite(points).all(axis=1)
    rows = np.flatnonzero(is_finite)
    finite = points[rows].astype(np.float64, copy=False)
    cells = _cells(finite, size, "cell", size)
    if keep == "center":
        rank = np.square(finite[:, :2] - (cells + 0.5) * size).sum(axis=1)
    else:
        rank = finite[:, 2] if keep == "lowest" else -finite[:, 2]
    order = np.lexsort((*finite.T[::-1], rank, cells[:, 1], cells[:, 0]))
    is_first = starts_of_runs(cells[order])
    return np.sort(np.concatenate([rows[order[is_first]], np.flatnonzero(~is_finite)]))


def _apart(points: Floats, distance: float, progress: Progress | None) -> Array:
    """Keep rows that are a distance apart, and as many that no other fits between."""
    is_finite = np.isfinite(points).all(axis=1)
    rows = np.flatnonzero(is_finite)
    finite = points[rows].astype(np.float64) + 0.0  # -0.0 becomes 0.0
    plane = np.ascontiguousarray(finite[:, :2])
    cells = _cells(plane, distance / math.sqrt(2) * (1 - 1e-9), "min_distance", distance)
    grid = _Grid(cells)
    bits = plane.view(np.uint64)
    order = _mixed(bits[:, 0] ^ _mixed(bits[:, 1], 1), 0)
    # By the hash, then by coordinates: of rows at one position the lowest counts.
    order = np.lexsort((*finite.T[::-1], order))
    kept = _Rounds(plane, order, grid, distance).kept(progress)
    return np.sort(np.concatenate([rows[kept], np.flatnonzero(~is_finite)]))


def _cells(points: Floats, size: float, option: str, value: float) -> Array:
    """Return the cells of points, two whole numbers each; refuse an option by which are none."""
    with np.errstate(over="ignore"):
        cells = np.floor(points[:, :2] / size)
    if len(cells) and not np.abs(cells).max() <= _MOST_CELLS:
        row = int(np.abs(cells).max(axis=1).argmax())
        reason = f"too small for coordinates such as {points[row, :2].tolist()}"
        raise refused(option, value, reason, mark=", ")
    return cells.astype(np.int64)


class _Grid:
    """The cells that have points: numbered, with the numbers of those around."""

    def __init__(self, cells: Array) -> None:
        order = np.lexsort((cells[:, 1], cells[:, 0]))
        ordered = cells[order]
        is_first = starts_of_runs(ordered)
        self._cells = ordered[is_first]
        self.of_point = np.empty(len(cells), np.int64)
        self.of_point[order] = np.cumsum(is_first) - 1
        self.count = len(self._cells)

    def around(self) -> Iterator[Array]:
        """Yield for each cell the number of one near it, in each direction; -1 if it is empty."""
        columns, first = np.unique(self._cells[:, 0], return_index=True)
        last = np.append(first[1:], self.count)
        for i, j in _NEAR:
            place = np.searchsorted(columns, self._cells[:, 0] + i)
            there = np.minimum(place, len(columns) - 1)
            is_there = columns[there] == self._cells[:, 0] + i
            yield self._found(first[there], last[there], is_there, self._cells[:, 1] + j)

    def _found(self, low: Array, high: Array, is_there: Array, wanted: Array) -> Array:
        """Search a row in each column by halves, all at once."""
        low, end = low.copy(), high
        high = high.copy()
        while (low < high).any():
            middle = (low + high) // 2
            is_less = (low < high) & (self._cells[np.minimum(middle, self.count - 1), 1] < wanted)
            low, high = np.where(is_less, middle + 1, low), np.where(is_less, high, middle)
        good = is_there & (low < end) & (self._cells[np.minimum(low, self.count - 1), 1] == wanted)
        return np.where(good, low, -1)


class _Rounds:
    """The choice of rows that are a distance apart."""

    def __init__(self, plane: Floats, order: Array, grid: _Grid, distance: float) -> None:
        self._plane, self._grid, self._distance = plane, grid, distance
        self._near = [*grid.around()] if grid.count else []
        self._sorted = order
        self._rank = np.empty(len(plane), np.int64)
        self._rank[self._sorted] = np.arange(len(plane))

    def kept(self, progress: Progress | None) -> Array:
        """Return the points that stay."""
        count = self._grid.count
        chosen = np.full(count, -1)  # the point that stays in a cell: no two have room in one
        left = self._sorted
        while len(left):
            first = np.full(count, -1)
            first[self._grid.of_point[left[::-1]]] = left[::-1]  # the last to be set comes first
            new = self._first_around(first)
            chosen[self._grid.of_point[new]] = new
            left = left[~self._is_near(left, chosen)]
            if progress is not None:
                progress(1 - len(left) / len(self._sorted))
        return chosen[chosen >= 0]

    def _first_around(self, first: Array) -> Array:
        """Return the first points of cells that come before those around within the distance."""
        cells = np.flatnonzero(first >= 0)
        mine = first[cells]
        is_first = np.ones(len(cells), np.bool_)
        for near in self._near:
            other = self._points_of(near[cells], first)
            comes = (other >= 0) & (self._rank[other] < self._rank[mine])
            is_first &= ~(comes & self._are_near(mine, other))
        return mine[is_first]

    def _is_near(self, points: Array, chosen: Array) -> Array:
        """Whether points are in the cell of one that stays, or too near to one around."""
        cells = self._grid.of_point[points]
        is_near = np.asarray(chosen[cells] >= 0)
        for near in self._near:
            other = self._points_of(near[cells], chosen)
            is_near |= (other >= 0) & self._are_near(points, other)
        return is_near

    def _points_of(self, cells: Array, points: Array) -> Array:
        return np.where(cells >= 0, points[cells], -1)

    def _are_near(self, one: Array, other: Array) -> Array:
        change = self._plane[one] - self._plane[other]
        return np.asarray(np.hypot(*change.T) < self._distance)


_MOST_LAYERS = 10_000
_DEEPEST = float(2**52)  # beyond, doubles do not tell layers apart


def spike_free_rows(
    points: Floats, distance: float, buffer: float, progress: Progress | None
) -> Integers:
    """Choose the rows of finite points that are kept, by a freeze distance and a layer's height."""
    plane = points[:, :2] + 0.0
    order = np.lexsort((-points[:, 2], plane[:, 1], plane[:, 0]))
    left = order[starts_of_runs(plane[order])]
    layers = _layers(points[left, 2], buffer)
    order = np.argsort(layers, kind="stable")
    left, layers = left[order], layers[order]
    _check_number(layers)
    kept, count = left[:0], len(left)
    while len(left):
        end = int(np.searchsorted(layers, layers[0], side="right"))
        kept = np.concatenate([kept, left[:end]])
        left, layers = left[end:], layers[end:]
        is_left = ~_are_frozen(plane[kept], plane[left], distance)
        left, layers = left[is_left], layers[is_left]
        if progress is not None:
            progress(1 - len(left) / count)
    return np.sort(kept)


def _layers(heights: Floats, buffer: float) -> Floats:
    """Number the layers of heights, from the highest on."""
    with np.errstate(over="ignore"):
        depths = (heights.max(initial=-np.inf) - heights) / buffer
    layers: Floats = np.minimum(np.floor(depths), _DEEPEST)
    return layers


def _check_number(layers: Floats) -> None:
    count = 1 + np.count_nonzero(np.diff(layers))
    if count > _MOST_LAYERS:
        raise InputError(
            f"rows are in {count:,} layers, each of which is triangulated, and at most "
            f"{_MOST_LAYERS:,} are: give a larger {Option('spike_buffer', ...)}"
        )


def _are_frozen(plane: Floats, places: Floats, distance: float) -> Mask:
    """Tell which places lie in triangles, or on sides of some, whose sides are all shorter."""
    none = np.zeros(len(places), np.bool_)
    if not len(places):
        return none
    try:
        solved = delaunay(plane)
    except DegenerateInputError:
        return none
    corners = plane.take(solved.simplices, axis=0)
    sides = corners - np.roll(corners, 1, axis=1)
    is_frozen = np.append((np.hypot(*sides.T) < distance).all(axis=0), False)  # none beyond
    found = solved.find_simplex(places)
    are_frozen: Mask = is_frozen[found]
    _add_sides(solved, is_frozen, places, found, are_frozen)
    return are_frozen


def _add_sides(
    solved: Triangulation, is_frozen: Mask, places: Floats, found: Array, are_frozen: Mask
) -> None:
    """Add the places on sides that the triangle found shares with a frozen one."""
    beyond = is_frozen[solved.neighbors]
    asked = np.flatnonzero((found >= 0) & ~are_frozen & beyond[found].any(axis=1))
    corners = solved.points.take(solved.simplices[found[asked]], axis=0)
    for k in range(3):
        start, end = corners[:, (k + 1) % 3], corners[:, (k + 2) % 3]
        is_on = orient2d(start, end, places[asked]) == 0
        are_frozen[asked] |= is_on & beyond[found[asked], k]
