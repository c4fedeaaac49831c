"""Filled contours: the parts of the plane where heights are between two levels, as polygons.

The border of a band is made of the contours of its lower level, those of the upper one backwards,
and the sides of the domain between them: all with the bits of `contours.py`, so that neighbouring
bands share their borders. What goes there and back, as the line along a ridge at the level, bounds
no area and is left out. At a point where parts touch, the border turns into the same part, which is
decided exactly; a ring that comes to a point twice is then cut there, which makes rings simple and
the interior of each polygon connected. A hole that touches no other ring of its polygon is that of
the smallest ring around it.

Points of contours are rounded. Where vertices are about as near to each other as doubles are, lines
may cross: so polygons are checked by GEOS. If one is invalid, it snaps all lines to a grid (J. D.
Hobby, "Practical segment intersection with finite precision output", 1999) of some distances of
doubles, and the heights inside say which band the parts are of.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Integers, Mask, Progress
from liftmesh.base.arrays import starts_of_runs
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import check_progress, counted, part_of
from liftmesh.cells.overlay import cycles
from liftmesh.errors import InputError
from liftmesh.io.streams import at_home
from liftmesh.optional import load
from liftmesh.predicates import orient2d
from liftmesh.terrain.boundary import mask_of
from liftmesh.terrain.contours import Contours, contour_lines, wanted_levels
from liftmesh.terrain.crossings import crossings
from liftmesh.terrain.sampling import heights_at
from liftmesh.terrain.values import Values, over_known
from liftmesh.vector.files import check_written, write_areas

if TYPE_CHECKING:
    from liftmesh.io.write import WriteResult
    from liftmesh.terrain.surface_data import SurfaceData


Ends: TypeAlias = tuple[Fraction, Fraction]
_LINES, _SIDES, _RINGS = 0.3, 0.2, 0.6  # of the time; the others of what is left
_BITS = 48  # of the largest coordinate, that snapped corners have


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FilledContours(FrozenResult):
    """Bands between levels, as `Surface.filled_contours` returns them; read-only.

    Parameters
    ----------
    points : (n, 2) ndarray of float64
        The corners of all rings, each ring with its first corner at its end, too. The band is on
        the left.
    rings : (r + 1,) ndarray of int64
        Where each ring begins in ``points``, and where the last ends.
    polygons : (p + 1,) ndarray of int64
        Where each polygon begins in ``rings``: with its outer ring, which its holes follow.
    bands : (k + 1,) ndarray of int64
        Where each band begins in ``polygons``.
    lower, upper : (k,) ndarray of float64
        The levels of each band: its heights are at least the lower one, and below the upper one.
        Below the first level and above the last, the lowest and the highest height stand for them.
    crs : str, optional
        The coordinate reference system.

    See Also
    --------
    Surface.filled_contours : Computes them.
    Contours : The lines between them.

    Examples
    --------
    >>> import liftmesh
    >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
    >>> found = hill.filled_contours([4])
    >>> found, found.lower, found.upper, found.areas
    (<FilledContours: 2 bands of 2 polygons>, array([0., 4.]), array([4., 8.]), array([12.,  4.]))
    """

    points: Floats
    rings: Array
    polygons: Array
    bands: Array
    lower: Floats
    upper: Floats
    crs: str | None = None

    def __repr__(self) -> str:
        bands, polygons = len(self.bands) - 1, len(self.polygons) - 1
        return f"<FilledContours: {counted(bands, 'band')} of {counted(polygons, 'polygon')}>"

    def __len__(self) -> int:
        return len(self.lower)

    @property
    def areas(self) -> Floats:
        """The area of each band in the plane, (k,) float64."""
        return _areas(self)

    def to_shapely(self) -> Array:
        """Convert the bands to geometries of shapely.

        Returns
        -------
        (k,) ndarray of object
            A ``MultiPolygon`` for each band.

        Raises
        ------
        MissingDependencyError
            shapely is not installed: ``pip install 'liftmesh[shapes]'``.

        See Also
        --------
        FilledContours.save : Write them to a file.

        Examples
        --------
        >>> import liftmesh
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
        >>> hill.filled_contours([4]).to_shapely()[1]
        <MULTIPOLYGON (((1 1, 3 1, 3 3, 1 3, 1 1)))>
        """
        shapely = load("shapely", extra="shapes")
        rings, polygons, bands = map(_numbers, (self.rings, self.polygons, self.bands))
        lines = shapely.linearrings(self.points, indices=rings)
        return np.asarray(
            shapely.multipolygons(shapely.polygons(lines, indices=polygons), indices=bands)
        )

    def save(self, path: str | os.PathLike[str]) -> WriteResult:
        """Write the bands as polygons with the properties lower and upper.

        Parameters
        ----------
        path : path
            As for `Contours.save`.

        Returns
        -------
        WriteResult
            The file, its format and its size.

        Raises
        ------
        FormatError, InputError, MissingDependencyError, OSError
            As for `Contours.save`.

        See Also
        --------
        Contours.save : The same for lines.

        Examples
        --------
        >>> import liftmesh, tempfile
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 8]])
        >>> hill.filled_contours([4]).save(Path(tempfile.mkdtemp()) / "bands.geojson").format
        'geojson'
        """
        target = Path(at_home(path))
        check_written(target, "bands")
        columns = {"lower": self.lower, "upper": self.upper}
        return write_areas(target, self.to_shapely(), columns, self.crs, "bands")


def _numbers(starts: Array) -> Integers:
    return np.repeat(np.arange(len(starts) - 1), np.diff(starts))


def _areas(filled: FilledContours) -> Floats:
    rings, exponent = _numbers(filled.rings), _exponent(filled.points)
    points = np.ldexp(filled.points, -exponent)
    x, y = (points - points[filled.rings[:-1]][rings]).T
    halves = np.zeros(len(x))
    halves[1:] = (x[:-1] * y[1:] - x[1:] * y[:-1]) / 2
    begins = filled.rings[filled.polygons[filled.bands]]
    scaled = [math.fsum(halves[a:b]) for a, b in pairwise(begins.tolist())]
    with np.errstate(over="ignore"):  # to infinity
        areas: Floats = np.ldexp(scaled, 2 * exponent)
    return areas


def _exponent(points: Floats) -> int:
    """Return the power of two by which coordinates are divided, so that squares are doubles."""
    return int(np.frexp(np.abs(points).max(initial=0))[1])


def filled_contours(
    surface: SurfaceData,
    levels: ArrayLike | None = None,
    *,
    values: Values | None = None,
    interval: float | None = None,
    contour_base: float = 0.0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> FilledContours:
    """Compute the parts of the plane between levels.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    levels, values, interval, contour_base, threads
        As for `contour_lines`.
    progress : callable, optional
        As for `triangulate`.

    Returns
    -------
    FilledContours
        The bands that have an area, by ascending level. Each is a valid polygon, or several;
        together they cover the faces without gaps, and neighbours share their borders bit for bit.
        They do not depend on the order of the rows.

    Raises
    ------
    InputError
        As for `contour_lines`; a height of a face is not finite.
    MissingDependencyError
        shapely is not installed: ``pip install 'liftmesh[shapes]'``.

    See Also
    --------
    Surface.contours : The lines between them.
    FilledContours.save : Write them to a file.

    Notes
    -----
    What is at a level is above it, as for contours: a plateau at the level is in the band above.
    Borders are contours, and the boundary of the faces with a corner where one ends, which is
    rounded; so areas are right to rounding. Where lines cross by rounding, as between vertices that
    are nearer to each other than 2**-40 of their coordinates, corners of all bands are rounded to
    2**-48 of the largest coordinate.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]])
    >>> slope.filled_contours(interval=2).areas
    array([4., 4., 4., 4.])
    """
    check_progress(progress)
    surface = surface if values is None else over_known(surface, values)
    low, high = _range(surface)
    wanted, _ = wanted_levels(levels, interval, contour_base, 1, lambda: (low, high))
    lines, rim = contour_lines(surface, wanted, threads=threads), _rim(surface)
    exponent = _exponent(rim[..., :2])  # for GEOS
    lines = replace(lines, points=np.ldexp(lines.points, -exponent))
    rim[..., :2] = np.ldexp(rim[..., :2], -exponent)
    rest = part_of(progress, _LINES, 1.0)
    if rest is not None:
        rest(0.0)
    try:
        found = fill(lines, rim, wanted, (low, high), rest)
    except TangledError:
        found = _snapped(
            lines, rim, wanted, (low, high), lambda at: heights_at(surface, np.ldexp(at, exponent))
        )
    return replace(found, points=np.ldexp(found.points, exponent))


class TangledError(InputError):
    """Contours that cross, as they are nearer to each other than doubles tell."""

    def __init__(self, place: str) -> None:
        super().__init__(
            f"contours are nearer to each other than doubles tell, at {place}: subtract an offset "
            "from x and y, or leave out levels"
        )


def _range(surface: SurfaceData) -> tuple[Fraction, Fraction]:
    """Return the lowest and the highest height of a face; raise if one is not finite."""
    heights = surface.frame.heights(surface.vertices).take(surface.faces, axis=0)
    if (face := np.flatnonzero(~np.isfinite(heights).all(axis=1))).size:
        rows = surface.faces[face[0]]
        row = rows[~np.isfinite(heights[face[0]])][0]
        raise InputError(f"the height of vertex {row} is not finite: the array was written since")
    return Fraction(heights.min()), Fraction(heights.max())


def _rim(surface: SurfaceData) -> Floats:
    """Return the sides that bound the faces, (m, 2, 3), with the faces on the left."""
    solved, left_out = surface.triangulation, mask_of(surface)
    beyond = (solved.neighbors < 0) | left_out[solved.neighbors]
    face, k = np.nonzero(beyond & ~left_out[:, None])
    rows = solved.simplices[face[:, None], (k[:, None] + [1, 2]) % 3]
    heights = surface.frame.heights(surface.vertices)
    return np.concatenate([solved.points[rows], heights[rows][..., None]], axis=2) + 0.0


def fill(
    lines: Contours,
    rim: Floats,  # its sides, (m, 2, 3), with what is filled on the left
    levels: Floats,
    ends: Ends,  # the lowest and the highest height
    progress: Progress | None = None,
) -> FilledContours:
    """Make the bands between all contours of some levels inside a boundary."""
    said = progress or (lambda _: None)
    (one, of_one), (other, of_other) = _of_lines(lines, levels), _of_rim(rim, levels)
    sides = _without_returns(np.concatenate([one, other]), np.concatenate([of_one, of_other]))
    said(_SIDES)
    rings = _turned(_simple(sides, cycles(_followers(sides))), sides)
    said(_RINGS)
    found = _assembled(sides, rings, levels, ends, lines.crs)
    said(1.0)
    return found


def _of_lines(lines: Contours, levels: Floats) -> tuple[Floats, Integers]:
    """Return the pieces of contours, each in the band above it, and backwards in that below."""
    line = _numbers(lines.starts)
    inside = np.flatnonzero(line[1:] == line[:-1])
    pieces = np.stack([lines.points[inside], lines.points[inside + 1]], axis=1)
    above = np.searchsorted(levels, lines.levels[line[inside]]) + 1
    return np.concatenate([pieces, pieces[:, ::-1]]), np.concatenate([above, above - 1])


def _of_rim(rim: Floats, levels: Floats) -> tuple[Floats, Integers]:
    """Return the pieces of the boundary between levels, each in its band."""
    first, last = np.searchsorted(levels, rim[:, :, 2], side="right").T
    counts = np.abs(last - first)
    side = np.repeat(np.arange(len(rim)), counts)
    number = np.arange(len(side)) - np.repeat(np.cumsum(counts) - counts, counts)
    rises = (last > first)[side]
    level = np.where(rises, first[side] + number, first[side] - 1 - number)
    met = crossings(rim[side], levels[level])
    # Each crossing ends a piece, and begins the next one; the last piece ends where the side does.
    begins = np.insert(met, np.cumsum(counts) - counts, rim[:, 0, :2], axis=0)
    ends = np.insert(met, np.cumsum(counts), rim[:, 1, :2], axis=0)
    step = np.insert(np.where(rises, 1, -1), np.cumsum(counts) - counts, 0)
    starts = np.cumsum(counts + 1) - counts - 1
    band = np.cumsum(step)
    band += np.repeat(first - band[starts], counts + 1)
    return np.stack([begins, ends], axis=1), band


class _Sides(NamedTuple):
    """The sides of all bands, by band, tail and head."""

    places: Floats  # in lexicographic order
    tails: Integers
    heads: Integers
    bands: Integers

    def key(self, places: Integers) -> Integers:
        """Tell places of one band from those of another."""
        return self.bands * len(self.places) + places


def _without_returns(pieces: Floats, bands: Integers) -> _Sides:
    """Number the places, and leave out what goes there and back in one band."""
    places, number = np.unique(pieces.view(np.complex128), return_inverse=True)
    one, other = number.reshape(-1, 2).T
    least, most = np.minimum(one, other), np.maximum(one, other)
    order = np.lexsort([most, least, bands])
    order = order[least[order] < most[order]]
    keys = np.stack([bands[order], least[order], most[order]], axis=1)
    begins = np.flatnonzero(starts_of_runs(keys))
    if len(order):
        times = np.add.reduceat(np.where(one[order] < other[order], 1, -1), begins)
        band, a, b = np.repeat(keys[begins], np.abs(times), axis=0).T
        swap = np.repeat(times < 0, np.abs(times))
        a, b = np.where(swap, b, a), np.where(swap, a, b)
    else:
        band = a = b = np.empty(0, np.int64)
    order = np.lexsort([b, a, band])
    return _Sides(places.view(np.float64).reshape(-1, 2), a[order], b[order], band[order])


def _followers(sides: _Sides) -> Integers:
    """Return the side after each: of several, the first one clockwise from the way back."""
    tails, heads = sides.key(sides.tails), sides.key(sides.heads)
    first = np.searchsorted(tails, heads)
    counts = np.searchsorted(tails, heads, side="right") - first
    if (counts == 0).any():
        raise TangledError(str(sides.places[sides.heads[counts == 0][0]]))
    several = np.flatnonzero(counts > 1)
    back, at = sides.places[sides.tails[several]], sides.places[sides.heads[several]]
    best = first[several]
    for number in range(1, counts.max(initial=1)):
        other = first[several] + np.minimum(number, counts[several] - 1)
        ways = (sides.places[sides.heads[each]] for each in (best, other))
        best = np.where(_is_second_first(at, back, *ways), other, best)
    first[several] = best
    if (wrong := np.flatnonzero(np.bincount(first, minlength=len(first)) != 1)).size:
        raise TangledError(str(sides.places[sides.tails[wrong[0]]]))
    return first


def _is_second_first(at: Floats, back: Floats, one: Floats, other: Floats) -> Mask:
    """Whether a turn clockwise from a direction meets the second of two first."""
    classes = []
    for way in (one, other):
        turn = orient2d(at, back, way)
        is_back = (np.sign(way - at) == np.sign(back - at)).all(axis=1)
        classes.append(np.where(turn < 0, 0, np.where(turn > 0, 2, np.where(is_back, 3, 1))))
    left_of = orient2d(at, one, other) > 0
    result: Mask = (classes[1] < classes[0]) | ((classes[1] == classes[0]) & left_of)
    return result


class _Rings(NamedTuple):
    """Rings of sides, and the walk along a border that each is a part of."""

    sides: Integers
    starts: Integers
    walks: Integers
    turns: Array  # 1 counter-clockwise, -1 clockwise


def _simple(sides: _Sides, walks: tuple[Integers, Integers]) -> _Rings:
    """Cut walks that come to a place twice into rings that do not."""
    order, lengths = walks
    starts = np.concatenate([[0], np.cumsum(lengths)])
    tails = sides.key(sides.tails)
    is_met_again = np.zeros(len(tails), np.bool_)
    is_met_again[1:] = tails[1:] == tails[:-1]
    is_met_again[:-1] |= is_met_again[1:]
    again = is_met_again[order]
    many = set(_numbers(starts)[again].tolist())
    rings: list[Integers] = []
    owners: list[int] = []
    for number, (a, b) in enumerate(pairwise(starts.tolist())):
        walk = order[a:b]
        parts = list(_loops(walk, sides.tails, again[a:b])) if number in many else [walk]
        rings += parts
        owners += [number] * len(parts)
    bounds = np.concatenate([[0], np.cumsum([len(each) for each in rings])]).astype(np.int64)
    joined = np.concatenate([np.empty(0, np.int64), *rings])
    return _Rings(joined, bounds, np.array(owners, np.int64), np.empty(0))


def _loops(walk: Integers, tails: Integers, again: Mask) -> Iterator[Integers]:
    """Yield the simple rings of a walk, which may come again to some places."""
    walk, again = np.roll(walk, -int(again.argmax())), np.roll(again, -int(again.argmax()))
    path: list[Integers] = []
    seen: dict[int, int] = {}
    for stretch in np.split(walk, np.flatnonzero(again)[1:]):
        tail = int(tails[stretch[0]])
        if tail in seen:
            begin = seen[tail]
            yield np.concatenate(path[begin:])
            for each in path[begin:]:
                del seen[int(tails[each[0]])]
            del path[begin:]
        seen[tail] = len(path)
        path.append(stretch)
    yield np.concatenate(path)


def _turned(rings: _Rings, sides: _Sides) -> _Rings:
    """Let each ring begin at its least corner, where which way it turns is decided."""
    tails, counts = sides.tails[rings.sides], np.diff(rings.starts)
    ring = _numbers(rings.starts)
    least = np.minimum.reduceat(tails, rings.starts[:-1]) if len(counts) else tails
    shift = np.flatnonzero(tails == least[ring]) - rings.starts[:-1]
    place = np.arange(len(tails)) - rings.starts[ring]
    turned = rings.sides[(place + shift[ring]) % counts[ring] + rings.starts[ring]]
    before, at, after = (
        sides.places[sides.tails[turned[rings.starts[:-1] + step]]]
        for step in (counts - 1, np.zeros_like(counts), np.ones_like(counts))
    )
    turns = np.sign(orient2d(before, at, after))
    if (turns == 0).any():
        raise TangledError(str(at[turns == 0][0]))
    return rings._replace(sides=turned, turns=turns)


def _assembled(
    sides: _Sides, rings: _Rings, levels: Floats, ends: Ends, crs: str | None
) -> FilledContours:
    """Put holes to their outer rings, and these into their bands; check the polygons."""
    begins = rings.sides[rings.starts[:-1]]
    corner, second, band = sides.tails[begins], sides.heads[begins], sides.bands[begins]
    is_hole = rings.turns < 0
    owner = _owners(sides, rings, band)
    order = np.lexsort([second, corner, is_hole, second[owner], corner[owner], band])
    counts = np.diff(rings.starts)[order] + 1
    starts = np.concatenate([[0], np.cumsum(counts)])
    ring = _numbers(starts)
    place = (np.arange(starts[-1]) - starts[ring]) % (counts - 1)[ring]
    points = sides.places[sides.tails[rings.sides[place + rings.starts[:-1][order][ring]]]]
    outer = np.flatnonzero(~is_hole[order])
    of_polygon = band[order][outer]
    begin = np.flatnonzero(np.diff(of_polygon, prepend=-1))
    limits = _limits(levels, ends)
    kept = of_polygon[begin]
    polygons = np.append(outer, len(order))
    bands = np.append(begin, len(outer))
    lower, upper = limits[kept], limits[kept + 1]
    found = FilledContours(points, starts, polygons, bands, lower, upper, crs)
    _check_valid(found.to_shapely())
    return found


def _owners(sides: _Sides, rings: _Rings, band: Integers) -> Integers:
    """Return the outer ring of each ring: that of its walk, or the smallest around it."""
    shapely = load("shapely", extra="shapes")
    is_hole = rings.turns < 0
    of_walk = np.full(rings.walks.max(initial=-1) + 1, -1)
    of_walk[rings.walks[~is_hole]] = np.flatnonzero(~is_hole)
    owner = np.where(is_hole, of_walk[rings.walks], np.arange(len(is_hole)))
    alone = np.flatnonzero(owner < 0)
    if not len(alone):
        return owner
    outer = np.flatnonzero(~is_hole)
    corners = sides.places[sides.tails[rings.sides]]
    lines = shapely.linearrings(corners, indices=_numbers(rings.starts))
    areas = shapely.polygons(lines[outer])
    corner = sides.places[sides.tails[rings.sides[rings.starts[:-1][alone]]]]
    around, hole = shapely.STRtree(shapely.points(corner)).query(areas, predicate="contains")
    same = band[alone[hole]] == band[outer[around]]
    hole, around = hole[same], around[same]
    order = np.argsort(-shapely.area(areas[around]), kind="stable")
    owner[alone[hole[order]]] = outer[around[order]]  # the smallest one last
    if (owner < 0).any():
        raise TangledError(str(corner[owner[alone] < 0][0]))
    return owner


def _snapped(
    lines: Contours,
    rim: Floats,
    levels: Floats,
    ends: Ends,
    heights_of: Callable[[Floats], Floats],
) -> FilledContours:
    """Make the bands of lines that GEOS snaps to a grid, by the heights inside what they bound."""
    shapely = load("shapely", extra="shapes")
    sides = shapely.linestrings(_of_rim(rim, levels)[0])
    contours = shapely.linestrings(lines.points, indices=_numbers(lines.starts))
    noded = shapely.unary_union(np.concatenate([contours, sides]), grid_size=2.0**-_BITS)
    faces = shapely.get_parts(shapely.polygonize([noded]))
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    heights = heights_of(inside)
    band = np.searchsorted(levels, heights, side="right")
    kept = np.unique(band[~np.isnan(heights)])
    joined = [shapely.coverage_union_all(faces[band == each]) for each in kept]
    shapes = shapely.orient_polygons(shapely.normalize(joined))
    _check_valid(shapes)
    polygons, of_band = shapely.get_parts(shapes, return_index=True)
    rings, of_polygon = shapely.get_rings(polygons, return_index=True)
    points, of_ring = shapely.get_coordinates(rings, return_index=True)
    starts, outer, bands = (
        np.cumsum(np.bincount(each + 1)) for each in (of_ring, of_polygon, of_band)
    )
    limits = _limits(levels, ends)
    lower, upper = limits[kept], limits[kept + 1]
    return FilledContours(points, starts, outer, bands, lower, upper, lines.crs)


def _limits(levels: Floats, ends: Ends) -> Floats:
    """Return the levels, and the lowest and the highest height around them."""
    return np.concatenate([[float(ends[0])], levels, [float(ends[1])]])


def _check_valid(shapes: Array) -> None:
    shapely = load("shapely", extra="shapes")
    if not (is_valid := shapely.is_valid(shapes)).all():
        raise TangledError(str(shapely.is_valid_reason(shapes[~is_valid][0])))
