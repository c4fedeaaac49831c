"""Areas and volumes at many levels (stage-area-storage), and the level for a given volume.

A face that is under a level as a whole adds its area, and its volume below the level grows by the
area from there on. So these are added up along the sorted levels, exactly, and rounded once. Only
faces that a level crosses are cut there, each by the closed form of its prism: the time is that for
the faces and for the pairs of faces and levels that cross, not for all pairs.

Between two neighbouring heights of corners the same faces are cut, and the volume is a cubic. So
the level for a volume is sought among heights first, and then between two by bisection. All volumes
go the same ways until they part: so a larger volume never has a lower level, whatever is rounded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers
from liftmesh.base.arrays import as_numbers
from liftmesh.base.display import card_of
from liftmesh.base.options import as_switch, counted, refused, shown
from liftmesh.errors import InputError, Option
from liftmesh.terrain.contours import wanted_levels
from liftmesh.terrain.measures import (
    check_measured,
    cubic_metres_of,
    faces_of,
    planar_areas,
    prisms,
)

if TYPE_CHECKING:
    from liftmesh.terrain.surface_data import SurfaceData

_PAIRS = 1 << 20  # of faces and levels that are cut at once
_STEPS = 1 << 10  # heights that are tried at once, unless many faces are cut at each
_CUT = 8  # times that a face may be cut for these
_VOLUMES = "give volumes of zero or more"
Under: TypeAlias = tuple[Fraction, Fraction]  # area and volume of faces that are below as a whole


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class StageStorage:
    """Areas and volumes at several levels, as `Surface.stage_storage` returns them.

    Attributes
    ----------
    levels : (k,) ndarray of float64
        The levels, ascending.
    areas : (k,) ndarray of float64
        The planar area that is at or under each level (``above``: at or over it).
    volumes : (k,) ndarray of float64
        The volume between the faces and each level, over these areas.
    above : bool
        Whether areas and volumes are those above the levels.
    cubic_metres : float or None
        As in `VolumeResult`.

    See Also
    --------
    Surface.stage_storage
    VolumeResult : At one level.

    Examples
    --------
    >>> import liftmesh
    >>> pit = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, -6]])
    >>> found = pit.stage_storage([-3, 0])
    >>> found.areas.tolist(), found.volumes.tolist()
    ([4.0, 16.0], [4.0, 32.0])
    """

    levels: Floats
    areas: Floats
    volumes: Floats
    above: bool
    cubic_metres: float | None
    _faces: _Faces
    _repr_html_ = card_of

    def __repr__(self) -> str:
        side = "above" if self.above else "below"
        return f"<StageStorage: areas and volumes {side} {counted(len(self.levels), 'level')}>"

    def level_of(self, volumes: ArrayLike) -> Floats:
        """Compute the levels of volumes, also of such as are at none of the levels.

        Parameters
        ----------
        volumes : array_like of float
            Volumes, zero or more.

        Returns
        -------
        ndarray of float64
            Of the same shape: the level below which the faces hold the volume (``above``: above
            which), as exact as volumes are; of zero the lowest (highest) height of the faces. A
            larger volume never has a lower (higher) level. Beyond all faces, walls stand around
            them.

        Raises
        ------
        InputError
            A volume is negative or not finite, or its level is beyond the largest double.

        See Also
        --------
        Surface.stage_storage : The volumes of levels.

        Examples
        --------
        >>> import liftmesh
        >>> pit = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, -6]])
        >>> pit.stage_storage(0).level_of([4, 32, 48]).round(9).tolist()
        [-3.0, 0.0, 1.0]
        """
        wanted = as_numbers("volumes", volumes, _VOLUMES, verb="are")
        if not (np.isfinite(wanted) & (wanted >= 0)).all():
            raise InputError(f"{Option('volumes')} are {shown(volumes)}: {_VOLUMES}")
        levels = self._faces.levels_of(wanted.ravel()).reshape(wanted.shape)
        return (-levels if self.above else levels) + 0.0


def stage_storage(
    surface: SurfaceData,
    levels: ArrayLike | None = None,
    *,
    interval: float | None = None,
    above: bool = False,
) -> StageStorage:
    """Compute the areas and the volumes below each of many levels: the stage-area-storage table.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    levels : array_like of float, optional
        Heights above the plane, in any order; what is equal counts once.
    interval : float, optional
        In place of levels: all its multiples that the surface has, and one more at both ends.
    above : bool, default False
        Measure what is above the levels instead, as of heaps.

    Returns
    -------
    StageStorage
        By ascending level. Only faces count: the ground beside them holds nothing.

    Raises
    ------
    InputError
        Neither levels nor an interval are given, or both; a level is no finite number, or there is
        none; the interval is not positive, or has more than a million multiples; or an area or
        volume is beyond the largest double.

    See Also
    --------
    Surface.volume : At one level, also in polygons.
    StageStorage.level_of : The level of a volume.

    Notes
    -----
    Prisms are those of `volume_of`. No bit depends on the order of the rows.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
    >>> slope.stage_storage([1, 2, 3]).volumes.round(9).tolist()
    [2.0, 8.0, 18.0]
    """
    is_above = as_switch("above", above)
    faces = _Faces.of(surface, is_above=is_above)
    wanted, _ = wanted_levels(levels, interval, 0.0, 1, partial(faces.range, is_above=is_above))
    if not len(wanted):
        raise refused("levels", levels, "give a height, or more", verb="are")
    areas, volumes = faces.at(-wanted[::-1] if is_above else wanted)
    step = -1 if is_above else 1
    found = wanted, areas[::step], volumes[::step]
    return StageStorage(*found, is_above, cubic_metres_of(surface), faces)


@dataclass(frozen=True, slots=True, eq=False)
class _Faces:
    """Planar areas of faces, (m,), and the heights of their corners, ascending, (m, 3)."""

    areas: Floats
    heights: Floats

    @classmethod
    def of(cls, surface: SurfaceData, *, is_above: bool) -> _Faces:
        """Measure the faces; upside down for what is above."""
        corners, heights = faces_of(surface)
        with np.errstate(all="ignore"):
            areas = planar_areas(corners)
        return cls(areas, np.sort(-heights if is_above else heights, axis=1))

    def range(self, *, is_above: bool) -> tuple[Fraction, Fraction]:
        """Return the least and the greatest height of a corner."""
        ends = Fraction(self.heights[:, 0].min()), Fraction(self.heights[:, 2].max())
        return (-ends[1], -ends[0]) if is_above else ends

    def at(self, levels: Floats) -> tuple[Floats, Floats]:
        """Return the areas and the volumes below ascending levels."""
        return self._at(levels, self.whole(levels))

    def _at(self, levels: Floats, whole: list[Under]) -> tuple[Floats, Floats]:
        found = np.empty((2, len(levels)))
        for k, (areas, volumes) in enumerate(self._cut(levels)):
            found[:, k] = _sum(areas, whole[k][0]), _sum(volumes, whole[k][1])
        check_measured(("area", float(found[0].max())), ("volume", float(found[1].max())))
        return found[0], found[1]

    def whole(self, levels: Floats) -> list[Under]:
        """Return area and volume of the faces that are below each level as a whole, exactly."""
        group = np.searchsorted(levels, self.heights[:, 2])
        order = np.argsort(group, kind="stable")
        starts = np.searchsorted(group[order], np.arange(len(levels) + 1))
        under = order[: starts[-1]]
        with np.errstate(all="ignore"):
            low, middle, high = (levels[group[under], None] - self.heights[under]).T
            volumes = self.areas[under] * ((low + middle + high) / 3)
        areas = self.areas[under]
        found, area, volume, before = [], Fraction(0), Fraction(0), Fraction(0)
        for level, first, last in zip(levels.tolist(), starts, starts[1:], strict=False):
            at = Fraction(level)
            volume += area * (at - before) + _total(volumes[first:last])
            area += _total(areas[first:last])
            before = at
            found.append((area, volume))
        return found

    def _cut(self, levels: Floats) -> Iterator[tuple[Floats, Floats]]:
        """Yield for each level what is below it of the faces that it crosses."""
        first = np.searchsorted(levels, self.heights[:, 0], side="right")
        last = np.searchsorted(levels, self.heights[:, 2])
        crossed = np.flatnonzero(first < last)
        first, last = first[crossed], last[crossed]
        steps = np.bincount(first, minlength=len(levels) + 1)
        counts = np.cumsum(steps - np.bincount(last, minlength=len(levels) + 1))[:-1]
        part = np.cumsum(counts) // _PAIRS
        for begin, end in _runs(part):
            own = np.flatnonzero((first < end) & (last > begin))
            low, high = np.maximum(first[own], begin), np.minimum(last[own], end)
            face = np.repeat(crossed[own], high - low)
            shift = low - np.cumsum(high - low) + (high - low)
            level = np.arange(len(face)) + np.repeat(shift, high - low)
            order = np.argsort(level, kind="stable")
            face, level = face[order], level[order]
            both = self.below(face, levels[level])
            bounds = np.searchsorted(level, np.arange(begin, end + 1))
            for i, j in pairwise(bounds):
                yield both[0][i:j], both[1][i:j]

    def below(self, face: Integers, level: Floats) -> tuple[Floats, Floats]:
        """Return area and volume of faces below levels that cross them."""
        areas, heights = self.areas[face], self.heights[face]
        with np.errstate(all="ignore"):
            depths = heights - level[:, None]
            low, middle, high = depths.T
            across, upper = high - low, high - middle
            first = (low / (low - middle)) * (-low / across)
            second = (middle - low) / across - (middle / across) * ((upper + high) / upper)
            return areas * np.where(middle > 0, first, second), prisms(areas, depths)[1]

    def levels_of(self, volumes: Floats) -> Floats:
        """Return the lowest level of each volume."""
        heights = np.unique(self.heights)
        low, high = np.searchsorted(heights, self.heights[:, [0, 2]]).T
        share = float((high - low).mean()) / len(heights)  # of the faces, as a height cuts them
        steps = int(min(_STEPS, 2 + _CUT / max(share, _CUT / _STEPS)))
        tried = np.unique(np.linspace(0, len(heights) - 1, steps).astype(np.int64))
        whole = self.whole(heights[tried])
        reached = np.maximum.accumulate(self._at(heights[tried], whole)[1])
        place = np.searchsorted(reached, volumes)
        levels = np.full(len(volumes), heights[0])
        for k in np.unique(place[place > 0]).tolist():
            own = np.flatnonzero(place == k)
            first, last = tried[k - 1], tried[min(k, len(tried) - 1)]
            part = _Between.of(self, heights[first : last + 1], *whole[k - 1])
            levels[own] = [part.level_of(each) for each in volumes[own].tolist()]
        check_measured(("level", float(levels.max(initial=0.0))))
        return levels


@dataclass(frozen=True, slots=True, eq=False)
class _Between:
    """The faces that are neither above nor below all of some heights, ascending."""

    faces: _Faces
    heights: Floats
    area: Fraction  # of the faces below the first
    volume: Fraction  # below the first, over these

    @classmethod
    def of(cls, faces: _Faces, heights: Floats, area: Fraction, volume: Fraction) -> _Between:
        """Choose the faces."""
        low, _, high = faces.heights.T
        own = np.flatnonzero((low < heights[-1]) & (high > heights[0]))
        return cls(_Faces(faces.areas[own], faces.heights[own]), heights, area, volume)

    def level_of(self, sought: float) -> float:
        """Return the level of a volume that is reached at the last height, or after it."""
        heights: list[float] = self.heights.tolist()
        low, high = 0, len(heights) - 1
        if not high:
            rise = (Fraction(sought) - self.volume) / self.area
            return _rounded(Fraction(heights[0]) + rise)
        while low < (middle := (low + high) // 2):
            is_reached = self._volume_at(heights[middle]) >= sought
            low, high = (low, middle) if is_reached else (middle, high)
        bottom, top = heights[low], heights[high]
        share = _root(self._cubic(bottom, top - bottom), sought)
        return min(bottom + share * (top - bottom), top)

    def _under(self, level: float) -> Fraction:
        """Return the volume below a level over the faces that are below the first height."""
        return self.volume + self.area * (Fraction(level) - Fraction(self.heights[0]))

    def _volume_at(self, level: float) -> float:
        _, (volume,) = self.faces.at(np.array([level]))
        return _rounded(self._under(level) + Fraction(float(volume)))

    def _cubic(self, level: float, step: float) -> tuple[float, float, float, float]:
        """Return the volume as a cubic in shares of a step from a height to the next one.

        No term is negative but the last, which is at most a third of the third.
        """
        ((area, volume),) = self.faces.whole(np.array([level]))
        low, middle, high = self.faces.heights.T
        face = np.flatnonzero((low <= level) & (high > level))
        wet, below = self.faces.below(face, np.full(len(face), level))
        low, middle, high = low[face], middle[face], high[face]
        is_lower = middle > level
        legs = np.where(is_lower, middle - low, high - middle)
        wide = np.where(is_lower, level - low, high - level)
        steep = self.faces.areas[face] * (step / (high - low)) * (step / legs)
        last = np.where(is_lower, steep, -steep) * (step / 3)
        return (
            _sum(below, self._under(level) + volume),
            _sum(wet, self.area + area) * step,
            _sum(steep * wide, Fraction(0)),
            _sum(last, Fraction(0)),
        )


def _root(cubic: tuple[float, float, float, float], sought: float) -> float:
    """Return the first share in (0, 1] at which a rising cubic reaches a value, or 1."""
    a, b, c, d = cubic
    low, high = 0.0, 1.0
    while low < (middle := (low + high) / 2) < high:
        is_reached = a + middle * (b + middle * (c + middle * d)) >= sought
        low, high = (low, middle) if is_reached else (middle, high)
    return high


def _runs(groups: Integers) -> Iterator[tuple[int, int]]:
    """Yield where runs of equal numbers begin and end."""
    bounds = np.flatnonzero(np.diff(groups, prepend=-1, append=-1))
    yield from pairwise(bounds.tolist())


def _total(parts: Floats) -> Fraction:
    """Sum, rounded once."""
    total = _sum(parts, Fraction(0))
    check_measured(("volume", total))
    return Fraction(total)


def _sum(parts: Floats, rest: Fraction) -> float:
    """Sum what faces have, and what others have."""
    try:
        return _rounded(Fraction(math.fsum(parts.tolist())) + rest)
    except (OverflowError, ValueError):
        return math.inf


def _rounded(number: Fraction) -> float:
    """Round; what is beyond the largest double becomes infinite."""
    try:
        return float(number)
    except OverflowError:
        return math.inf
