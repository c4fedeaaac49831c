"""Lines that a surface follows: breaklines, boundaries and holes, as a caller gives them.

A line has heights or has none: one with a height that is missing (NaN) counts as one without. Rings
of polygons are lines, too. Lines without heights are in the coordinates of the plane.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.arrays import is_after
from liftmesh.base.options import Crossing, as_positive, refused, shown
from liftmesh.crs.description import parse_crs
from liftmesh.errors import DataWarning, FormatError, InputError, Option
from liftmesh.terrain.lifting import DIVIDING, Lifting
from liftmesh.terrain.profile import between
from liftmesh.vector.files import check_system, read_shapes, stated_system
from liftmesh.vector.geojson import coordinates_of, spatial_corners

if TYPE_CHECKING:
    from liftmesh.terrain.frame import Frame
    from liftmesh.vector.polygons import Polygon

_LINES = "give corners (n, 3), or (n, 2) without heights; a list of such lines; geometries; a path"
_MOST_CORNERS = 1 << 24  # with those between
_POLYGONS = "give a ring as corners (n, 2) or (n, 3); a list of polygons; geometries; or a path"


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line as it was given."""

    name: str  # in messages
    corners: Floats  # (c, 3): x, y, z; or coordinates in the plane, and NaN
    draped: bool  # over the surface without it
    closed: bool = False

    @property
    def is_spatial(self) -> bool:
        """Whether it has all heights, so that its corners are in space."""
        return not np.isnan(self.corners[:, 2]).any()

    @property
    def holds(self) -> bool:
        """Whether its heights are those of the surface."""
        return self.is_spatial and not self.draped

    def planar(self, frame: Frame, corners: Floats | None = None) -> Floats:
        """Return its corners, or others like these, in the plane."""
        corners = self.corners if corners is None else corners
        if self.is_spatial:
            return frame.planar(corners)
        if frame.name not in ("xy", "xz", "yz"):
            raise InputError(
                f"{self.name} has no heights of its own, and the plane is {frame.name!r}: give "
                f"heights, or {Option('plane')} 'xy', 'xz' or 'yz', whose coordinates are exact"
            )
        return corners[:, :2]

    def parts(self, frame: Frame, distance: float) -> Floats:
        """Return how many parts each piece gets, of at most a length."""
        planar = self.planar(frame)
        planar = np.concatenate([planar, planar[:1]]) if self.closed else planar
        with np.errstate(over="ignore"):
            parts: Floats = np.ceil(np.hypot(*np.diff(planar, axis=0).T) / distance)
        return np.maximum(parts, 1)

    def densified(self, frame: Frame, distance: float | None) -> Floats:
        """Return the corners with further ones between them, the first repeated if it is closed."""
        corners = np.concatenate([self.corners, self.corners[:1]]) if self.closed else self.corners
        if distance is None:
            return corners
        counts = self.parts(frame, distance).astype(np.int64)
        piece = np.repeat(np.arange(len(counts)), counts)
        number = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
        tails, heads = corners[piece], corners[piece + 1]
        swap = is_after(tails, heads)[:, None]  # the places do not depend on the direction
        share = np.where(swap[:, 0], counts[piece] - number, number) / counts[piece]
        placed = between(np.where(swap, heads, tails), np.where(swap, tails, heads), share[:, None])
        placed[number == 0] = corners[:-1]
        return np.concatenate([placed, corners[-1:]])


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

    def check(self, frame: Frame, points: Floats) -> None:
        """Refuse more corners than memory may hold, and warn of lines far from the points."""
        if self.densify is not None:
            counts = [(each.parts(frame, self.densify).sum(), each.name) for each in self.all()]
            total = sum(count for count, _ in counts)
            if not total <= _MOST_CORNERS:
                raise InputError(
                    f"{Option('densify', self.densify)} is too short for {max(counts)[1]}: there "
                    f"would be {total:,.0f} corners, and {_MOST_CORNERS:,} are the most: give a "
                    "longer one"
                )
        points = points[np.isfinite(points).all(axis=1)]
        for name, lines in self._groups().items():
            if not (lines and len(points)):
                continue
            corners = np.concatenate([each.planar(frame) for each in lines])
            boxes = [(each.min(axis=0), each.max(axis=0)) for each in (points, corners)]
            if (boxes[0][0] > boxes[1][1]).any() or (boxes[1][0] > boxes[0][1]).any():
                near, far = (f"{low.tolist()} to {high.tolist()}" for low, high in boxes)
                warnings.warn(
                    f"the lines of {Option(name)} lie beyond all points, which reach from {near}; "
                    f"they from {far}: are both in one coordinate system, and in one unit?",
                    DataWarning,
                    stacklevel=5,
                )

    def _groups(self) -> dict[str, list[Line]]:
        return {
            "breaklines": [each for each in self.lines if not each.draped],
            "soft_breaklines": [each for each in self.lines if each.draped],
            "boundary": [*chain(*self.boundary)],
            "holes": [*chain(*self.holes)],
        }

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
    crs: str | None,
) -> Lines | None:
    """Convert the options of `triangulate`; None if there are no lines."""
    distance = None if densify is None else as_positive("densify", densify)
    given = breaklines, soft_breaklines, boundary, holes
    if all(each is None for each in given):
        if densify is not None:
            raise InputError(f"{Option('densify')} is for lines: give {Option('breaklines', ...)}")
        return None
    return Lines(
        [*_lines("breaklines", breaklines, crs), *_lines("soft_breaklines", soft_breaklines, crs)],
        _polygons("boundary", boundary, crs),
        _polygons("holes", holes, crs),
        distance,
        crossing,
    )


def check_plain(lifting: Lifting, algorithm: str) -> None:
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


def _lines(option: str, given: Any, crs: str | None) -> list[Line]:
    name, draped = option.replace("_", " ").removesuffix("s"), option.startswith("soft")
    with _told(given):
        return [
            Line(title, spatial_corners(each, title, title, 2), draped)
            for number, each in enumerate(_all(option, given, crs, 2))
            for title in [f"{name} {number}"]
        ]


def _polygons(option: str, given: Any, crs: str | None) -> list[Sequence[Line]]:
    with _told(given):
        return [
            [
                _ring(f"a ring of polygon {number} of {Option(option)}", ring)
                for ring in ([each] if _depth(each) == 2 else each)
            ]
            for number, each in enumerate(_all(option, given, crs, 3))
        ]


@contextmanager
def _told(given: Any) -> Iterator[None]:
    """Name the file that an error is about."""
    try:
        yield
    except InputError as error:
        if isinstance(given, str | os.PathLike) and not str(error).startswith(str(given)):
            raise FormatError(f"{given}: {error.message.marked}") from error
        raise


def _all(option: str, given: Any, crs: str | None, depth: int) -> Iterator[Any]:
    """Yield lines, or polygons, of which each is a ring or several: the depth is 2, or 3."""
    tree = _tree(option, given, crs)
    if tree is None:
        for each in _items(option, given, 2):
            if isinstance(each, list | tuple | np.ndarray):
                yield each
            else:
                yield from _all(option, each, crs, depth)
        return
    try:
        found, lines = (list(coordinates_of(tree, each)) for each in ("Polygon", "LineString"))
    except (TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"no GeoJSON: {shown(tree)}: give type and coordinates") from error
    if depth == 2:
        found = lines + [ring for each in found for ring in each]
    elif not found:  # of a drawing: what closes itself, where one inside of another is a hole
        rings = [each for each in lines if len(each) > 3 and each[0][:2] == each[-1][:2]]
        found = [rings] if rings else []
    if not found:
        kinds = "LineString or Polygon" if depth == 2 else "Polygon or MultiPolygon"
        raise InputError(f"there is no {kinds} in what {Option(option)} are given as")
    yield from found


def _tree(option: str, given: Any, crs: str | None) -> Any:
    """Return the tree of GeoJSON of what is no array; None of others."""
    if isinstance(given, str | os.PathLike):
        tree = read_shapes(Path(given), option.replace("_", " "), crs)
        _check_heights(option, crs, tree)
        return tree
    described = getattr(given, "__geo_interface__", given)
    if not isinstance(described, Mapping):
        return None
    check_system(crs, given, f"{Option(option)}")
    _check_heights(option, crs, given)
    return described


def _check_heights(option: str, crs: str | None, shapes: object) -> None:
    """Refuse heights in another unit than those of the points."""
    systems = parse_crs(crs), parse_crs(stated_system(shapes))
    own, other = (None if each is None else each.units[2] for each in systems)
    if own and other and own.metres != other.metres:
        raise InputError(
            f"{Option(option)} have heights in the unit {other.name}, and the points in "
            f"{own.name}: transform them to the system of the points"
        )


def _ring(title: str, given: Any) -> Line:
    corners = spatial_corners(given, title, title, 3)
    is_closed = np.array_equal(corners[0], corners[-1], equal_nan=True)
    corners = corners[:-1] if is_closed else corners
    return Line(title, corners, draped=bool(np.isnan(corners[:, 2]).any()), closed=True)


def _items(option: str, given: Any, one: int) -> Sequence[Any]:
    """Tell apart what is one, by its depth, and a list of several."""
    if given is None:
        return []
    depth = _depth(given)
    if depth == one and len(given):
        return [given]
    if not depth:
        raise refused(option, given, _LINES if "lines" in option else _POLYGONS, verb="are")
    items: Sequence[Any] = given
    return items


def _depth(given: Any) -> int:
    """Return how deep the lists are nested."""
    if isinstance(given, np.ndarray):
        return given.ndim
    if isinstance(given, list | tuple):
        return 1 + (_depth(given[0]) if len(given) else 1)
    return 0
