"""Lines that a surface is made to follow: breaklines, boundaries and holes, as a caller gives them.

A line has heights or has none: one with a height that is missing (NaN) counts as one without. Rings
of polygons are lines, too. Lines without heights are in the coordinates of the plane.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.arrays import MOST_ROWS
from liftmesh.base.options import Crossing, as_positive, check_option, refused
from liftmesh.errors import InputError, Option
from liftmesh.terrain.lifting import DIVIDING, Lifting
from liftmesh.terrain.profile import between
from liftmesh.vector.geojson import spatial_corners

if TYPE_CHECKING:
    from liftmesh.terrain.frame import Frame
    from liftmesh.vector.polygons import Polygon

_LINES = "give an array of corners (n, 3), or (n, 2) without heights, or a list of such lines"
_POLYGONS = "give a ring as an array of corners (n, 3) or (n, 2), or a list of polygons"


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line as it was given."""

    name: str  # in messages
    corners: Floats  # (c, 3): x, y, z; or coordinates in the plane, and NaN
    draped: bool  # over the surface without it
    closed: bool = False

    @property
    def holds(self) -> bool:
        """Whether its heights are those of the surface."""
        return not (self.draped or np.isnan(self.corners[:, 2]).any())

    def planar(self, frame: Frame) -> Floats:
        """Return the corners in the plane."""
        if self.holds:
            return frame.planar(self.corners)
        if frame.name not in ("xy", "xz", "yz"):
            raise InputError(
                f"{self.name} has no heights of its own, and the plane is {frame.name!r}: give "
                f"heights, or {Option('plane')} 'xy', 'xz' or 'yz', whose coordinates are exact"
            )
        return self.corners[:, :2]

    def densified(self, frame: Frame, distance: float | None) -> Floats:
        """Return the corners with further ones between them, the first repeated if it is closed."""
        corners = np.concatenate([self.corners, self.corners[:1]]) if self.closed else self.corners
        if distance is None:
            return corners
        planar = self.planar(frame)
        planar = np.concatenate([planar, planar[:1]]) if self.closed else planar
        with np.errstate(over="ignore"):
            parts = np.ceil(np.hypot(*np.diff(planar, axis=0).T) / distance)
        if not parts.sum() < MOST_ROWS:
            raise InputError(
                f"{Option('densify', distance)} is too short for {self.name}: give a longer one"
            )
        counts = np.maximum(parts, 1).astype(np.int64)
        piece = np.repeat(np.arange(len(counts)), counts)
        number = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
        tails, heads = corners[piece], corners[piece + 1]
        swap = _is_after(tails, heads)[:, None]  # the places do not depend on the direction
        share = np.where(swap[:, 0], counts[piece] - number, number) / counts[piece]
        placed = between(np.where(swap, heads, tails), np.where(swap, tails, heads), share[:, None])
        placed[number == 0] = corners[:-1]
        return np.concatenate([placed, corners[-1:]])


def _is_after(tails: Floats, heads: Floats) -> Any:
    """Whether the first ends come after the second ones, by x, then y."""
    (x, y), (u, v) = tails.T[:2], heads.T[:2]
    return (x > u) | ((x == u) & (y > v))


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """All lines of a surface, and what bounds its faces."""

    lines: list[Line]
    boundary: list[Sequence[Line]]  # polygons, as their rings
    holes: list[Sequence[Line]]
    densify: float | None
    crossing: Crossing

    def all(self) -> Iterator[Line]:
        """Yield the lines, then the rings."""
        return chain(self.lines, *self.boundary, *self.holes)

    @staticmethod
    def check(lifting: Lifting, algorithm: str) -> None:
        """Refuse triangulations that are not Delaunay, and engines that know no lines."""
        lifted = "metric" if lifting.metric is not None else None
        if lifting.weights is not None:
            lifted = lifting.weights.name
        if lifted:
            raise InputError(
                f"{Option(lifted)} and lines are given, and a triangulation that contains lines is "
                "by distances alone: leave one of them out"
            )
        if algorithm not in DIVIDING:
            raise InputError(
                f"{Option('algorithm')} {algorithm!r} takes no lines: leave one of the two out"
            )

    @staticmethod
    def rings(polygons: list[Sequence[Line]], frame: Frame) -> list[Polygon]:
        """Return polygons in the plane."""
        return [[each.planar(frame) for each in rings] for rings in polygons]


def lines_given(
    breaklines: Any,
    soft_breaklines: Any,
    boundary: Any,
    holes: Any,
    densify: Any,
    crossing: Any,
) -> Lines | None:
    """Convert the options of `triangulate`; None if there are no lines."""
    check_option("crossing", crossing, Crossing)
    distance = None if densify is None else as_positive("densify", densify)
    given = breaklines, soft_breaklines, boundary, holes
    if all(each is None for each in given):
        if densify is not None:
            raise InputError(f"{Option('densify')} is for lines: give {Option('breaklines', ...)}")
        return None
    return Lines(
        [*_lines("breaklines", breaklines), *_lines("soft_breaklines", soft_breaklines)],
        _polygons("boundary", boundary),
        _polygons("holes", holes),
        distance,
        crossing,
    )


def _lines(option: str, given: Any) -> list[Line]:
    name, draped = option.replace("_", " ").removesuffix("s"), option.startswith("soft")
    return [
        Line(title, spatial_corners(each, title, title, 2), draped)
        for number, each in enumerate(_items(option, given, 2, _LINES))
        for title in [f"{name} {number}"]
    ]


def _polygons(option: str, given: Any) -> list[Sequence[Line]]:
    title = f"polygon {{}} of {Option(option)}"
    return [
        [
            _ring(f"a ring of {title.format(number)}", ring)
            for ring in ([each] if _depth(each) == 2 else _items(option, each, 3, _POLYGONS))
        ]
        for number, each in enumerate(_items(option, given, 2, _POLYGONS))
    ]


def _ring(title: str, given: Any) -> Line:
    corners = spatial_corners(given, title, title, 3)
    is_closed = np.array_equal(corners[0], corners[-1], equal_nan=True)
    corners = corners[:-1] if is_closed else corners
    return Line(title, corners, draped=bool(np.isnan(corners[:, 2]).any()), closed=True)


def _items(option: str, given: Any, one: int, remedy: str) -> Sequence[Any]:
    """Tell apart what is one, by its depth, and a list of several."""
    if given is None:
        return []
    depth = _depth(given)
    if depth == one and len(given):
        return [given]
    if depth < one:
        raise refused(option, given, remedy, verb="are")
    items: Sequence[Any] = given
    return items


def _depth(given: Any) -> int:
    """Return how deep the lists are nested."""
    if isinstance(given, np.ndarray):
        return given.ndim
    if isinstance(given, list | tuple):
        return 1 + (_depth(given[0]) if len(given) else 1)
    return 0
