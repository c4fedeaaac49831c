"""Profiles: what a line in the plane becomes on a surface, with a corner at every side it crosses.

The height where it crosses a side comes from the ends of the side, the lexicographically lesser
first, so it is the one of both faces. Where the line leaves the faces, the profile has a gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Mask
from liftmesh.base.arrays import as_pairs
from liftmesh.base.frozen import constructed_from, freeze
from liftmesh.base.options import shown
from liftmesh.errors import InputError
from liftmesh.terrain.line_crossings import LineCrossings

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
            There are fewer than two corners, or one is not finite; or the line is longer than the
            largest double.

        Notes
        -----
        The line is halved, again and again, and each half looks only at the faces that are near the
        one that it is of. So a piece takes time for the faces near it; one piece across the whole
        surface, for all of them. Corners are draped by `sample`. No bit depends on the order of the
        rows.

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
        >>> slope.profile([[-1, 1], [2, 1], [2, 9]]).points.tolist()
        [[0.0, 1.0, 0.0], [2.0, 1.0, 4.0], [2.0, 2.0, 4.0]]
        """
        corners = _corners(line)
        before = _distances(corners)
        pieces = LineCrossings(self).of(corners)
        points = np.concatenate(pieces)
        piece = np.repeat(np.arange(len(pieces)), [*map(len, pieces)])
        points[:, 3] += before[piece]
        return _parts(points, _are_joined(self, points, piece))


def _are_joined(surface: Surface, points: Floats, piece: Array) -> Mask:
    """Whether points and those after them are one corner of the line, or have a face between."""
    firsts, steps = points[:-1, :2], np.diff(points[:, :2], axis=0)
    one_piece = piece[1:] == piece[:-1]
    joined: Mask = (steps == 0).all(axis=1)
    joined[one_piece] = np.isfinite(surface.sample((firsts + steps / 2)[one_piece]))
    return joined


def _parts(points: Floats, joined: Mask) -> Profile:
    """Make a profile of the parts that are more than a point."""
    part = np.concatenate([[0], np.cumsum(~joined)])[: len(points)]
    fresh = np.ones(len(points), dtype=np.bool_)
    fresh[1:] = ~joined | (points[1:, :2] != points[:-1, :2]).any(axis=1)
    counts = np.bincount(part[fresh])
    kept = fresh & (counts > 1)[part]
    starts = np.concatenate([[0], np.cumsum(counts[counts > 1])])
    return Profile(points[kept, :3], points[kept, 3], starts)


def _distances(corners: Floats) -> Floats:
    """Return how far along the line its corners are."""
    with np.errstate(over="ignore"):
        found = np.cumsum(np.hypot(*np.diff(corners, axis=0, prepend=corners[:1]).T))
    if not np.isfinite(found[-1]):
        raise InputError("the line is longer than the largest double: scale the coordinates")
    return found


def _corners(line: Any) -> Floats:
    corners = as_pairs(line)
    if corners.ndim != 2 or len(corners) < 2:
        raise InputError(f"a line has two corners at least, not the shape {corners.shape}")
    if not np.isfinite(corners).all():
        raise InputError(f"a corner of the line is not finite: {shown(line)}")
    return corners
