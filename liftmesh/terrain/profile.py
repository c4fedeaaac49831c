"""Profiles: what a line in the plane becomes on a surface, with a corner at every side it crosses.

Which sides a line crosses, and which vertices it passes, is decided exactly. The height where it
crosses a side comes from the ends of the side, the lexicographically lesser first, so it is the one
of both faces. Where the line leaves the faces, the profile has a gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Rows
from liftmesh.arrays import as_pairs
from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.frozen import constructed_from, freeze
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Profile:
    """A line draped over a surface, as `Surface.profile` returns it; read-only.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        Coordinates in the plane and heights, one part after the other: the corners of the line, and
        where it crosses sides of faces.
    distances : (n,) ndarray of float64
        How far along the line they are, in the plane.
    starts : (k + 1,) ndarray of int64
        Where each part begins in ``points``, and where the last ends: a line that leaves the faces
        has several, or none.

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

    def __post_init__(self) -> None:
        freeze(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

    def __repr__(self) -> str:
        return f"<Profile: {len(self.points):,} points in {len(self.starts) - 1:,} parts>"


class Profiling:
    """The method of a `Surface` that drapes lines."""

    __slots__ = ()

    def profile(self: Any, line: ArrayLike) -> Profile:
        """Drape a line over the faces.

        Parameters
        ----------
        line : (k, 2) array_like
            Its corners in the plane, two at least.

        Returns
        -------
        Profile
            Linear between its points, as the faces are.

        Raises
        ------
        InputError
            There are fewer than two corners, or one is not finite.

        Notes
        -----
        Each piece of the line takes time for all faces. Points are draped by `sample`.

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
        >>> slope.profile([[-1, 1], [2, 1], [2, 9]]).points.tolist()
        [[0.0, 1.0, 0.0], [2.0, 1.0, 4.0], [2.0, 2.0, 4.0]]
        """
        corners = _corners(line)
        faces = _Sides(self)
        pieces = [faces.over(p, q) for p, q in pairwise(corners)]
        lengths = np.hypot(*np.diff(corners, axis=0).T)
        before = np.concatenate([[0], np.cumsum(lengths)])
        parts: list[Floats] = []
        for (points, runs), start in zip(pieces, before, strict=False):
            for first, last in runs:
                part = points[first : last + 1] + np.array([0, 0, 0, start])
                goes_on = parts and np.array_equal(parts[-1][-1, :2], part[0, :2])
                if goes_on and first == 0:
                    parts[-1] = np.concatenate([parts[-1], part[1:]])
                else:
                    parts.append(part)
        whole = np.concatenate(parts) if parts else np.empty((0, 4))
        starts = np.cumsum([0, *map(len, parts)])
        return Profile(whole[:, :3].copy(), whole[:, 3].copy(), starts)


class _Sides:
    """The sides of the faces of a surface, and what a piece of a line meets of them."""

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.points = surface.triangulation.points
        self.heights = surface.frame.heights(surface.vertices)
        corners = self.points[surface.faces]
        self.low, self.high = corners.min(axis=1), corners.max(axis=1)

    def over(self, p: Floats, q: Floats) -> tuple[Floats, list[tuple[int, int]]]:
        """Return x, y, height and distance of what the piece meets, and the runs over faces."""
        near = ((self.high >= np.minimum(p, q)) & (self.low <= np.maximum(p, q))).all(axis=1)
        faces = self.surface.faces[near]
        rows = np.unique(faces)
        turns = orient2d(p, q, self.points[rows]) if len(rows) else np.zeros(0, np.int8)
        ends = self.surface.sample([p, q])
        met = [np.column_stack([[p, q], ends]), self._vertices(rows[turns == 0], p, q)]
        sides = _sides(faces)
        apart = turns[np.searchsorted(rows, sides)].prod(axis=1) < 0
        met.append(self._crossings(sides[apart], p, q))
        points = np.concatenate(met)
        points = points[np.isfinite(points[:, 2])]
        along = np.hypot(points[:, 0] - p[0], points[:, 1] - p[1])
        order = np.lexsort([points[:, 1], points[:, 0], along])
        points = np.column_stack([points, along])[order]
        fresh = np.ones(len(points), dtype=np.bool_)
        fresh[1:] = (points[1:, :2] != points[:-1, :2]).any(axis=1)
        return self._runs(points[fresh])

    def _vertices(self, rows: Rows, p: Floats, q: Floats) -> Floats:
        """Return the vertices on the line that are between its ends."""
        at = self.points[rows]
        between = ((at >= np.minimum(p, q)) & (at <= np.maximum(p, q))).all(axis=1)
        return np.column_stack([at[between], self.heights[rows[between]]])

    def _crossings(self, sides: Rows, p: Floats, q: Floats) -> Floats:
        """Return where the piece crosses sides whose ends are apart from its line."""
        tails, heads = self.points[sides[:, 0]], self.points[sides[:, 1]]
        swap = (heads[:, 0] < tails[:, 0]) | (
            (heads[:, 0] == tails[:, 0]) & (heads[:, 1] < tails[:, 1])
        )
        sides[swap] = sides[swap, ::-1]
        tails, heads = self.points[sides[:, 0]], self.points[sides[:, 1]]
        meets = orient2d(tails, heads, p) * orient2d(tails, heads, q) <= 0
        sides, tails, heads = sides[meets], tails[meets], heads[meets]
        (dx, dy), (low, high) = q - p, self.heights[sides.T]
        at_tail, at_head = (
            np.abs(dx * (each[:, 1] - p[1]) - dy * (each[:, 0] - p[0])) for each in (tails, heads)
        )
        share = at_tail / np.maximum(at_tail + at_head, np.finfo(float).tiny)
        at = np.clip(
            tails + share[:, None] * (heads - tails),
            np.minimum(tails, heads),
            np.maximum(tails, heads),
        )
        at = np.clip(at, np.minimum(p, q), np.maximum(p, q))
        return np.column_stack([at, low + share * (high - low)])

    def _runs(self, points: Floats) -> tuple[Floats, list[tuple[int, int]]]:
        """Join neighbours with a face between them."""
        middles = (points[:-1, :2] + points[1:, :2]) / 2
        joined = np.isfinite(self.surface.sample(middles)) if len(middles) else np.zeros(0, bool)
        breaks = np.flatnonzero(~joined)
        firsts = np.concatenate([[0], breaks + 1])
        lasts = np.concatenate([breaks, [len(points) - 1]])
        runs = [(a, b) for a, b in zip(firsts.tolist(), lasts.tolist(), strict=True) if a < b]
        return points, runs


def _sides(faces: Rows) -> Rows:
    """Return the sides of faces, each once."""
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(sides, axis=0) if len(sides) else sides


def _corners(line: Any) -> Floats:
    corners = as_pairs(line)
    if corners.ndim != 2 or len(corners) < 2:
        raise InputError(f"a line has two corners at least, not the shape {corners.shape}")
    if not np.isfinite(corners).all():
        raise InputError(f"a corner of the line is not finite: {shown(line)}")
    return corners
