"""Profiles: lines in the plane draped over a surface, with a corner at every side they cross.

The height where a line crosses a side comes from the ends of the side, the lexicographically lesser
first, so it is the one of both faces. Where the line leaves the faces, the profile has a gap.

Which sides a piece of a line crosses, and which vertices it passes, is decided exactly. Products
are of numbers that powers of two have scaled, so they neither overflow nor vanish. Of what is met
at one rounded position, ends of pieces and vertices come before crossings, and the lowest height
first: no bit depends on the order of the rows.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask, Rows
from liftmesh.base.arrays import as_decimal, as_pairs, ends_of, is_after, starts_of_runs
from liftmesh.base.cloud import Cloud
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import as_positive, as_thousands, refused, shown
from liftmesh.crs.units import stated_unit
from liftmesh.errors import InputError
from liftmesh.io.streams import at_home
from liftmesh.io.write import WriteResult, write
from liftmesh.optional import load
from liftmesh.predicates import orient2d
from liftmesh.terrain.sampling import heights_at
from liftmesh.terrain.surface_data import SurfaceData, places_on, plane_system
from liftmesh.terrain.values import Values, over_values
from liftmesh.vector.files import LINE_SUFFIXES, write_lines

_AT_VERTEX, _AT_CROSSING = 0.0, 1.0
_NEXT = [1, 2, 0]
TAILS, HEADS = slice(None, -1), slice(1, None)
_MOST_SECTIONS = 1_000_000
_BATCH = 1 << 16  # pairs of pieces and faces that are looked at together
Wide: TypeAlias = tuple[Floats, Rows]  # numbers, and powers of two to scale them by
Met: TypeAlias = tuple[Floats, Floats, Rows]  # x, y, height; kinds; pieces


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Profile(FrozenResult, Plotted):
    """Lines draped over a surface, as `Surface.profile` returns them; read-only.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        Coordinates in the plane and heights, one part after the other: the corners of the line, and
        where it crosses sides of faces.
    distances : (n,) ndarray of float64
        How far along the line they are, in the plane; of cross sections, how far to the right of
        the line that they cross, and negative to its left.
    starts : (k + 1,) ndarray of int64
        Where each part begins in ``points``, and where the last ends: a line that leaves the faces
        has several, or none.
    lines : (k,) ndarray of int64
        The line that each part is of, from 0.
    crs : str, optional
        The coordinate reference system.
    stations : (k,) ndarray of float64, optional
        Of cross sections: how far along the line each part crosses it.

    See Also
    --------
    Surface.profile, Surface.cross_sections, Contours

    Examples
    --------
    >>> import liftmesh
    >>> ridge = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
    >>> found = ridge.profile([[0, 1], [4, 1]])
    >>> found.distances.tolist(), found.points[:, 2].tolist()
    ([0.0, 1.0, 3.0, 4.0], [0.0, 4.0, 4.0, 0.0])
    """

    points: Floats
    distances: Floats
    starts: Array
    lines: Array
    crs: str | None = None
    stations: Floats | None = None

    def __repr__(self) -> str:
        parts = f"{len(self.starts) - 1:,} parts{stated_unit(self.crs)}"
        return f"<Profile: {len(self.points):,} points in {parts}>"

    @property
    def lengths(self) -> Floats:
        """The length of each part in the plane, (k,) float64."""
        lengths: Floats = self.distances[self.starts[1:] - 1] - self.distances[self.starts[:-1]]
        return lengths

    def to_cloud(self) -> Cloud:
        """Convert the profile to points with named values.

        Returns
        -------
        Cloud
            The points, with the values ``distance``, ``line`` and ``part``: where along the line
            each is, and the numbers of its line and of its part; of cross sections, ``offset`` and
            ``station`` in place of the distance.

        See Also
        --------
        save

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
        >>> slope.profile([[0, 1], [2, 1]]).to_cloud().attributes["distance"]
        array([0., 2.])
        """
        counts = np.diff(self.starts)
        are_across = self.stations is not None
        of_parts = {"line": self.lines, "part": np.arange(len(counts))}
        of_parts |= {"station": self.stations} if self.stations is not None else {}
        values = {"offset" if are_across else "distance": self.distances}
        values |= {name: np.repeat(each, counts) for name, each in of_parts.items()}
        return Cloud(self.points, attributes=values, crs=self.crs)

    def to_dataframe(self) -> Any:
        """Convert the profile to a table of pandas, a row for each point.

        Returns
        -------
        pandas.DataFrame
            With the columns ``x``, ``y`` and ``z``, and the values of `to_cloud`.

        Raises
        ------
        MissingDependencyError
            pandas is not installed: ``pip install 'liftmesh[shapes]'``.

        See Also
        --------
        to_cloud, save

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
        >>> slope.profile([[0, 1], [2, 1]]).to_dataframe()[["distance", "z"]].values.tolist()
        [[0.0, 0.0], [2.0, 4.0]]
        """
        x, y, z = self.points.T
        columns = {"x": x, "y": y, "z": z, **self.to_cloud().attributes}
        return load("pandas", extra="shapes").DataFrame(columns)

    def save(self, path: str | os.PathLike[str] | BinaryIO, **options: Any) -> WriteResult:
        """Write the parts as lines in space, or their points.

        Parameters
        ----------
        path : path or binary file
            Where to write. GeoJSON and GeoPackage (.geojson, .json, .gpkg) have a line for each
            part, with the number of its line, where along it it begins, and its length, as
            ``line``, ``start`` and ``length``, and of cross sections ``station``; other formats
            have the points of `to_cloud`.
        **options
            Of points, as for `write`; lines have none.

        Returns
        -------
        WriteResult
            What was written.

        Raises
        ------
        FormatError
            The format or an option is unknown.
        InputError
            The coordinate system is unknown to GeoPackage.
        MissingDependencyError
            GeoPackage needs geopandas: ``pip install 'liftmesh[shapes]'``.
        OSError
            The file cannot be written.

        See Also
        --------
        to_cloud, write

        Examples
        --------
        >>> import liftmesh, tempfile
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
        >>> found = slope.profile([[0, 1], [2, 1]])
        >>> found.save(Path(tempfile.mkdtemp()) / "line.geojson").format
        'geojson'
        """
        target = Path(at_home(path)) if isinstance(path, str | os.PathLike) else Path()
        if options or target.suffix.lower() not in LINE_SUFFIXES:
            return write(path, self.to_cloud(), **options)
        columns = {
            "line": self.lines,
            "start": self.distances[self.starts[:-1]],
            "length": self.lengths,
        }
        columns |= {"station": self.stations} if self.stations is not None else {}
        return write_lines(target, self.points, self.starts, columns, self.crs, "profiles")


def profile_along(
    surface: SurfaceData, line: ArrayLike, *, values: Values | None = None
) -> Profile:
    """Drape a line over the faces.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    line : (k, 2) array_like
        Its corners in the plane, two at least.
    values : str or array_like of shape (n,), optional
        Values of the vertices in place of heights, or the name of attributes.

    Returns
    -------
    Profile
        Linear between its points, as the faces are.

    Raises
    ------
    InputError
        There are fewer than two corners, or one is not finite; or the line is longer than the
        largest double.

    See Also
    --------
    Surface.sample : Heights at points.
    Surface.contours : Lines of equal height.

    Notes
    -----
    Each piece goes from face to face across the sides that it touches, so it takes time for the
    faces that it meets. Corners are draped by `heights_at`. No bit depends on the order of the
    rows.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
    >>> slope.profile([[-1, 1], [2, 1], [2, 9]]).points.tolist()
    [[0.0, 1.0, 0.0], [2.0, 1.0, 4.0], [2.0, 2.0, 4.0]]
    """
    return _laid(
        surface if values is None else over_values(surface, values), [places_on(surface, line)]
    )


def cross_sections(
    surface: SurfaceData,
    line: ArrayLike,
    *,
    spacing: float,
    half_width: float,
    values: Values | None = None,
) -> Profile:
    """Drape lines across a line over the faces, one every so far.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    line : (k, 2) array_like
        Its corners in the plane, two at least.
    spacing : float
        How far apart the stations are along the line, from 0 on: decimal, as the interval of
        `contour_lines`.
    half_width : float
        How far each cross section reaches to both sides.
    values : str or array_like of shape (n,), optional
        As for `profile_along`.

    Returns
    -------
    Profile
        With ``stations``, and as ``distances`` the offsets from the line: from left to right,
        looking along it. A cross section is at right angles to the piece of the line that it
        crosses, at a corner to the one that begins there.

    Raises
    ------
    InputError
        As for `profile_along`; the line has no length; spacing or width are not positive; there
        are more than a million cross sections, or one leaves the doubles.

    See Also
    --------
    Surface.profile : Along the line.
    Profile.save : Write them to a file.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]])
    >>> found = slope.cross_sections([[2, 0], [2, 4]], spacing=2, half_width=1)
    >>> found.stations, found.distances[:3], found.points[:3, 2]
    (array([0., 2., 4.]), array([-1.,  1., -1.]), array([2., 6., 2.]))
    """
    cuts = sections_across([places_on(surface, line)], spacing, half_width)
    return cuts.of(_laid(surface if values is None else over_values(surface, values), cuts.ends))


class Sections(NamedTuple):
    """Where cross sections are."""

    ends: Floats  # (n, 2, 2), left and right
    stations: Floats
    lines: Integers  # that they cross
    half_width: float

    def of(self, draped: Profile) -> Profile:
        """Say of what was draped where it is."""
        stations, lines = self.stations[draped.lines], self.lines[draped.lines]
        offsets = draped.distances - self.half_width
        return replace(draped, distances=offsets, lines=lines, stations=stations)


def sections_across(lines: Sequence[Any], spacing: float, half_width: float) -> Sections:
    """Place cross sections along lines."""
    half = as_positive("half_width", half_width, "a positive length")
    step = as_decimal(as_positive("spacing", spacing, "a positive length"))
    stations, ends = zip(*(_across(line, step, half) for line in lines), strict=True)
    numbers = np.repeat(np.arange(len(lines)), [len(each) for each in stations])
    return Sections(np.concatenate(ends), np.concatenate(stations), numbers, half)


def _across(line: Any, step: Fraction, half: float) -> tuple[Floats, Floats]:
    """Return the stations of a line, and both ends of the cross sections there."""
    corners = _corners(line)
    corners = corners[starts_of_runs(corners)]
    far = _distances(corners)
    if len(corners) < 2:
        raise InputError("all corners of the line are at one position: it has no length")
    count = math.floor(Fraction(far[-1]) / step) + 1
    if count > _MOST_SECTIONS:
        reason = f"which makes {as_thousands(count)} cross sections: give a larger one"
        raise refused("spacing", float(step), reason, mark=", ")
    stations = np.array([float(step * number) for number in range(count)])
    piece = np.minimum(np.searchsorted(far, stations, side="right") - 1, len(corners) - 2)
    tails, heads = corners[piece], corners[piece + 1]
    lengths = np.hypot(*(heads - tails).T)
    at = between(tails, heads, ((stations - far[piece]) / lengths)[:, None])
    right = (heads - tails)[:, ::-1] / lengths[:, None] * (half, -half)
    with np.errstate(over="ignore"):
        ends = np.stack([at - right, at + right], axis=1)
    if not np.isfinite(ends).all():
        raise refused("half_width", half, "beyond the doubles: give a smaller one")
    return stations, ends


def _laid(surface: SurfaceData, lines: Sequence[Any] | Floats) -> Profile:
    """Drape all lines at once."""
    corners = [_corners(line) for line in lines]
    before = np.concatenate([_distances(each)[:-1] for each in corners])
    p, q = (np.concatenate([each[part] for each in corners]) for part in (TAILS, HEADS))
    points, piece = LineCrossings(surface).of(p, q)
    points[:, 3] += before[piece]
    line = np.repeat(np.arange(len(corners)), [len(each) - 1 for each in corners])[piece]
    joined = _are_joined(surface, points, piece) & (line[1:] == line[:-1])
    return _parts(points, joined, line, plane_system(surface))


def _corners(line: Any) -> Floats:
    corners = as_pairs(line)
    if corners.ndim != 2 or len(corners) < 2:
        raise InputError(f"a line has two corners at least, not the shape {corners.shape}")
    if not np.isfinite(corners).all():
        raise InputError(f"a corner of the line is not finite: {shown(line)}")
    return corners


def _distances(corners: Floats) -> Floats:
    """Return how far along the line its corners are."""
    with np.errstate(over="ignore"):
        distances = np.cumsum(np.hypot(*np.diff(corners, axis=0, prepend=corners[:1]).T))
    if not np.isfinite(distances[-1]):
        raise InputError("the line is longer than the largest double: scale the coordinates")
    return distances


def _are_joined(surface: SurfaceData, points: Floats, piece: Array) -> Mask:
    """Whether points and those after them are one corner of the line, or have a face between."""
    firsts, steps = points[:-1, :2], np.diff(points[:, :2], axis=0)
    one_piece = piece[1:] == piece[:-1]
    joined: Mask = (steps == 0).all(axis=1)
    joined[one_piece] = np.isfinite(heights_at(surface, (firsts + steps / 2)[one_piece]))
    return joined


def _parts(points: Floats, joined: Mask, line: Integers, crs: str | None) -> Profile:
    """Make a profile of the parts that are more than a point."""
    part = np.concatenate([[0], np.cumsum(~joined)])[: len(points)]
    fresh = starts_of_runs(points[:, :2])
    fresh[1:] |= ~joined
    counts = np.bincount(part[fresh])
    kept = fresh & (counts > 1)[part]
    starts = np.concatenate([[0], np.cumsum(counts[counts > 1])])
    return Profile(points[kept, :3], points[kept, 3], starts, line[kept][starts[:-1]], crs)


def drape(surface: SurfaceData, lines: Sequence[Floats] | Floats) -> Profile:
    """Drape lines over the faces of a surface."""
    found = _laid(surface, lines)
    if not len(found.lines):
        if not any(np.ptp(np.asarray(line, float), axis=0).any() for line in lines):
            raise InputError("all corners of a line are at one position: it has no length")
        raise InputError("no part of a line is over faces: are both in the same system?")
    return found


class LineCrossings:
    """What pieces of lines meet of a surface."""

    def __init__(self, surface: SurfaceData) -> None:
        self._surface = surface
        self._points = surface.triangulation.points
        self._heights = surface.frame.heights(surface.vertices)

    def of(self, p: Floats, q: Floats) -> tuple[Floats, Rows]:
        """List x, y, height and distance from p of what pieces meet, and which piece it is of."""
        return _along(*self.met(p, q), p, q)

    def met(self, p: Floats, q: Floats) -> Met:
        """List x, y and height of what pieces meet, in any order, and some of it twice."""
        ends = np.concatenate([p, q])
        heights = heights_at(self._surface, ends)
        number = np.tile(np.arange(len(p), dtype=np.int32), 2)
        met = [(np.column_stack([ends, heights]), np.full(len(ends), _AT_VERTEX), number)]
        piece, face = self.passages(p, q)
        for some in np.array_split(np.arange(len(piece)), len(piece) // _BATCH + 1):
            met += self._met(piece[some], face[some], p, q)
        points, kinds, piece = (np.concatenate(each) for each in zip(*met, strict=True))
        return points, kinds, piece

    def passages(self, p: Floats, q: Floats) -> tuple[Rows, Rows]:
        """Return which pieces touch which faces."""
        tri, mask = self._surface.triangulation, self._surface.mask
        starts = tri.find_simplex(p)
        starts[starts < 0] = tri.find_simplex(q[starts < 0])
        starts[starts < 0] = self._entries(p[starts < 0], q[starts < 0])
        simplices, neighbors = map(np.ascontiguousarray, (tri.simplices, tri.neighbors))
        ends = np.hstack([p, q])
        piece, face = _kernel.passages(tri.points, simplices, neighbors, ends, starts)
        shown = slice(None) if mask is None else ~mask[face]
        return piece[shown], face[shown]

    def _entries(self, p: Floats, q: Floats) -> Rows:
        """Return a face on the hull that each piece with both ends outside touches; -1 for none."""
        tri, entries = self._surface.triangulation, np.full(len(p), -1, dtype=np.int32)
        if not len(p):
            return entries
        face, k = np.nonzero(tri.neighbors < 0)
        a, b = self._points[ends_of(tri.simplices, face, k).T]
        for piece, side in _near(_boxes(p, q), _boxes(a, b)):
            line, rim = (p[piece], q[piece]), (a[side], b[side])
            across = orient2d(*line, rim[0]) * orient2d(*line, rim[1])
            meets = (across <= 0) & (orient2d(*rim, line[0]) * orient2d(*rim, line[1]) <= 0)
            entries[piece[meets]] = face[side[meets]]
        return entries

    def _met(self, piece: Rows, face: Rows, p: Floats, q: Floats) -> list[Met]:
        """Return what pieces meet of faces, in any order, and some of it twice."""
        faces = self._surface.triangulation.simplices[face]
        turns = orient2d(p[piece, None], q[piece, None], self._points.take(faces, axis=0))
        apart = turns * turns[:, _NEXT] < 0
        sides = np.sort(np.stack([faces, faces[:, _NEXT]], axis=-1)[apart], axis=1)
        pieces = np.repeat(piece[:, None], 3, axis=1)
        return [
            self._vertices(faces[turns == 0], pieces[turns == 0], p, q),
            self._crossings(sides, pieces[apart], p, q),
        ]

    def _vertices(self, rows: Rows, piece: Rows, p: Floats, q: Floats) -> Met:
        """Return vertices on the lines of pieces that are between their ends."""
        at, p, q = self._points[rows], p[piece], q[piece]
        between = ((at >= np.minimum(p, q)) & (at <= np.maximum(p, q))).all(axis=1)
        points = np.column_stack([at, self._heights[rows]])[between]
        return points, np.full(len(points), _AT_VERTEX), piece[between]

    def _crossings(self, sides: Rows, piece: Rows, p: Floats, q: Floats) -> Met:
        """Return where pieces cross sides whose ends are apart from their lines."""
        tails, heads = self._points[sides[:, 0]], self._points[sides[:, 1]]
        swap = is_after(tails, heads)
        sides[swap] = sides[swap, ::-1]
        tails, heads = self._points[sides[:, 0]], self._points[sides[:, 1]]
        p, q = p[piece], q[piece]
        meets = orient2d(tails, heads, p) * orient2d(tails, heads, q) <= 0
        sides, piece = sides[meets], piece[meets]
        tails, heads, p, q = tails[meets], heads[meets], p[meets], q[meets]
        share = _share(p, q, tails, heads)
        at = np.clip(between(tails, heads, share[:, None]), np.minimum(p, q), np.maximum(p, q))
        low, high = self._heights[sides.T]
        points = np.column_stack([at, between(low, high, share)])
        return points, np.full(len(points), _AT_CROSSING), piece


def _boxes(p: Floats, q: Floats) -> Floats:
    """Return the least and the greatest coordinates of segments, (n, 4), the latter negative."""
    return np.hstack([np.minimum(p, q), -np.maximum(p, q)])


def _near(pieces: Floats, sides: Floats) -> Iterator[tuple[Integers, Integers]]:
    """Yield the pairs of boxes that meet, from halves of the pieces, each with the sides near."""
    pending = [(np.arange(len(pieces)), np.arange(len(sides)))]
    while pending:
        some, near = pending.pop()
        near = near[(sides[near] <= -np.roll(pieces[some].min(axis=0), 2)).all(axis=1)]
        if len(some) > 1 and len(some) * len(near) > _BATCH:
            middles = pieces[some, :2] / 2 - pieces[some, 2:] / 2
            along = np.ptp(middles / 2, axis=0).argmax()
            halves = np.array_split(some[middles[:, along].argsort()], 2)
            pending += [(half, near) for half in halves]
        elif len(near):
            meets = sides[near] <= -np.roll(pieces[some], 2, axis=1)[:, None]
            piece, side = np.nonzero(meets.all(axis=2))
            yield some[piece], near[side]


def _along(points: Floats, kinds: Floats, piece: Rows, p: Floats, q: Floats) -> tuple[Floats, Rows]:
    """Order what pieces meet from p to q, and keep of each position what comes first."""
    known = np.isfinite(points[:, 2])
    points, kinds, piece = points[known] + 0.0, kinds[known], piece[known]  # -0.0 becomes 0.0
    with np.errstate(over="ignore"):
        far = np.minimum(np.hypot(*(points[:, :2] - p[piece]).T), np.hypot(*(q - p).T)[piece])
        ahead = points[:, :2] * np.sign(q - p)[piece]
    order = np.lexsort([points[:, 2], kinds, ahead[:, 1], ahead[:, 0], far, piece])
    points = np.column_stack([points, far])[order]
    piece = piece[order]
    first = starts_of_runs(np.column_stack([piece, points[:, :2]]))
    return points[first], piece[first]


def _share(p: Floats, q: Floats, tails: Floats, heads: Floats) -> Floats:
    """Return how far along each side, from its tail, a line crosses it: 0 to 1."""
    at_tail, tail_scale = _distance(p, q, tails)
    at_head, head_scale = _distance(p, q, heads)
    scale = np.maximum(tail_scale, head_scale)
    at_tail, at_head = np.ldexp(at_tail, tail_scale - scale), np.ldexp(at_head, head_scale - scale)
    shares: Floats = at_tail / np.maximum(at_tail + at_head, np.finfo(float).tiny)
    return shares


def _distance(p: Floats, q: Floats, points: Floats) -> Wide:
    """Return how far points are from the lines p q, times what is the same for all of a line."""
    (dx, dy), _ = _scaled(p, q)
    offsets, scale = _scaled(p, points)
    return np.abs(dx * offsets[1] - dy * offsets[0]), scale


def _scaled(origins: Floats, points: Floats) -> Wide:
    """Return x and y of the way from origins to points, (2, n), each scaled to about 1."""
    far = np.maximum(np.abs(points), np.abs(origins)).max(axis=1)
    half = np.where(far > 1, 0.5, 1.0)
    offsets = points.T * half - origins.T * half
    scale = np.frexp(np.abs(offsets).max(axis=0))[1]
    return np.ldexp(offsets, -scale), scale - np.frexp(half)[1]


def between(tails: Floats, heads: Floats, share: Floats) -> Floats:
    """Interpolate between the ends of sides, also where their difference is no double."""
    with np.errstate(over="ignore", invalid="ignore"):
        steps = heads - tails
        near = tails + share * steps
    values = np.where(np.isfinite(steps), near, tails * (1 - share) + heads * share)
    return np.clip(values, np.minimum(tails, heads), np.maximum(tails, heads))
