"""`classify_ground`: which rows of an unclassified cloud are ground.

The rows are ground by a triangulation or by a cloth. Low noise, which both take
for ground, is found first, if it is asked for.

The cloth simulation filter (CSF) turns a cloud upside down and lets a cloth fall on it: what is
near the cloth is ground. It knows metres alone, so coordinates are converted. Noise and withheld
rows are kept from it, since the cloth would hang on them.

CSF prints what it does to stdout, whatever Python redirects, looks for no Ctrl-C, and on several
threads gives other results from run to run. In a process of its own, on one thread, none of that
matters.

Source: Zhang et al., An easy-to-use airborne LiDAR data filtering method based on cloth simulation,
Remote Sensing 8 (2016), 501.

*Progressive densification of a triangulation (TIN).* The lowest row of each cell of a grid is
ground to begin with. Each round triangulates the ground found so far, and of the rows over each
facet takes the lowest that is near enough to the facet and sees it under small angles from the
facet's corners. So the surface grows up from below, and facets become smaller, down to a spacing of
1 m; what then lies near the surface is ground, too. Beyond the hull of the ground, its facets go on
as they are up to slopes of 45 degrees, and level if steeper.

Axelsson also takes rows whose mirror image beyond the nearest corner is near enough. That finds the
edges of terraces (of 14 % of the ground that are lost, all but 2.5), and a fourth of all roofs,
trees and shrubs on steep slopes with them, where a larger angle takes a twelfth: it is left out.

Every choice is made by coordinates, so the order of the rows does not matter.

Source: P. Axelsson, DEM generation from laser scanner data using adaptive TIN models, International
Archives of Photogrammetry and Remote Sensing 33 (B4), 2000, 110-117.
"""

from __future__ import annotations

import math
import os
import subprocess
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask
from liftmesh.base.options import GroundAlgorithm, as_count, as_positive, check_option, refused
from liftmesh.crs.description import parse_crs
from liftmesh.errors import (
    DataWarning,
    DegenerateInputError,
    InputError,
    LiftmeshError,
    MissingDependencyError,
    Option,
)
from liftmesh.io.metadata import noted
from liftmesh.io.read import read_cloud
from liftmesh.io.selection import class_column
from liftmesh.optional import python_command
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.report import bare_report
from liftmesh.terrain.sampling import gradients_at, weights_at
from liftmesh.terrain.surface_data import SurfaceData

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_GROUND, _UNCLASSIFIED = 2, 1
_CLASSES = "classification"
_NOISE = (7, 18)
_MOST_NODES = 20_000_000  # of the cloth: CSF takes about 200 bytes for each
_MANY_NODES, _NODES_OF_ROW = 1_000_000, 100  # which take 5 s; beyond both, rows are too few
_NODES_OF_CELL, _ROWS_OF_CELL = 5, 5
_MOST_BARE = 0.1  # share of cells; large roofs leave some
_MARGIN = 8  # nodes beyond the rows, on both sides together
_DEFAULTS: dict[str, dict[str, float]] = {  # of the options of each algorithm
    "csf": {"cloth_resolution": 0.5, "cloth_rigidness": 2, "cloth_threshold": 0.5},
    "tin": {"tin_cell": 40.0, "tin_distance": 1.4, "tin_angle": 15.0, "tin_threshold": 0.25},
}
_NOISE_CELL, _FEW = 5.0, 4  # metres; the first number of rows that are not too few


def classify_ground(  # noqa: PLR0913 - options are keywords
    cloud: object,
    *,
    algorithm: GroundAlgorithm = "csf",
    cloth_resolution: float | None = None,
    cloth_rigidness: int | None = None,
    cloth_threshold: float | None = None,
    tin_cell: float | None = None,
    tin_distance: float | None = None,
    tin_angle: float | None = None,
    tin_threshold: float | None = None,
    noise_depth: float | None = None,
) -> Cloud:
    """Find the ground among the rows of a cloud, by a cloth or by a triangulation that grows.

    Where ground is sparse, as under trees and large roofs, low vegetation and roofs may be taken
    for it: look at the result.

    Parameters
    ----------
    cloud : path, Cloud or object
        Anything that `triangulate` takes.
    algorithm : {"csf", "tin"}, default "csf"
        The cloth simulation filter, or progressive densification of a triangulation (TIN).
    cloth_resolution : float, optional
        Distance between the nodes of the cloth, in metres; 0.5 unless given. It has to be given
        where that makes more than 1,000,000 nodes, and more than 100 for each row.
    cloth_rigidness : {1, 2, 3}, optional
        Of the cloth: 1 for steep slopes, 2 unless given, 3 for flat terrain.
    cloth_threshold : float, optional
        Rows nearer to the cloth than this, in metres, are ground; 0.5 unless given.
    tin_cell : float, optional
        Side of the cells of a grid, in metres, the lowest row of each of which is ground to begin
        with: more than the largest building has; 40 unless given. It is halved until these rows
        are not on a line.
    tin_distance : float, optional
        Rows that join the triangulation are not farther from the facet below or above them, in
        metres; 1.4 unless given.
    tin_angle : float, optional
        The lines from such a row to the corners of the facet make no larger angles with it, in
        degrees: more for broken terrain, less where vegetation is low; 15 unless given.
    tin_threshold : float, optional
        Rows that are in the end not higher above the triangulation, nor lower, in metres, are
        ground; 0.25 unless given.
    noise_depth : float, optional
        Rows become low noise, class 7, and take no part, if among the rows in their square of 5 m
        and the eight around at most two others are less than this, in metres, above them.

    Returns
    -------
    Cloud
        All rows, with their classes in the column that has them (``class``, in any spelling), else
        in the attribute ``classification``: 2 for ground; what was ground and is no more becomes 1,
        as all rows without a class; other classes stay.
        ``metadata["ground"]`` counts "rows", "ground" and "noise", and says how; of the square
        "cells", five nodes or 5 m wide, that have five rows or more, "bare_cells" have no ground
        among them.

    Raises
    ------
    InputError
        Coordinates are degrees or geocentric, an option is invalid or of the other algorithm, or
        the cloth would have more than 20,000,000 nodes, or too many for so few rows.
    MissingDependencyError
        The package cloth-simulation-filter is not installed.
    FormatError, UnsupportedTypeError
        As for `read` and `as_cloud`.

    Warns
    -----
    DataWarning
        More than a tenth of the cells have no ground: on slopes, a cloth that is too coarse loses
        most of it, and so does a small angle.

    See Also
    --------
    read : Its option ``classes`` selects ground that is classified already.
    thin : Fewer rows.

    Notes
    -----
    Of even slopes with 0.7 rows a square metre, a fifth of them in trees, this share of the ground
    was found, with the default rigidness: with a resolution of 0.5 m 97 % or more up to 35 degrees;
    with 1 m 99 % at 16 degrees, 96 % at 24 and 68 % at 35; with 2 m 93 % at 8 degrees, 39 % at 16
    and 3 % at 24. Of hills, tops are lost: at a mean slope of 8 degrees 24 %, 21 % and 76 %. A
    rigidness of 1 finds more on slopes.

    A triangulation (P. Axelsson, DEM generation from laser scanner data using adaptive TIN models,
    2000) needs no package. Each round takes the lowest row over each facet that is within the
    thresholds and 1 m or more from its corners, at most a hundred times. On generated scenes of
    flat land, hills and a slope of 31 degrees, with buildings and trees, it has fewer errors than
    the cloth; at steps of terraces it needs a larger angle, and
    roofs that are larger than its cells it takes for ground. The result is the same for any order
    of the rows.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> flat = np.column_stack([rng.random((400, 2)) * 20, np.zeros(400)])
    >>> tree = np.column_stack([rng.random((50, 2)) + 10, rng.random(50) + 5])
    >>> cloud = np.vstack([flat, tree])
    >>> [classify_ground(cloud, algorithm=each).metadata["ground"]["ground"] for each in
    ...  ("csf", "tin")]
    [400, 400]
    """
    check_option("algorithm", algorithm, GroundAlgorithm)
    given = {
        "cloth_resolution": cloth_resolution, "cloth_rigidness": cloth_rigidness,
        "cloth_threshold": cloth_threshold, "tin_cell": tin_cell, "tin_distance": tin_distance,
        "tin_angle": tin_angle, "tin_threshold": tin_threshold,
    }  # fmt: skip
    options: dict[str, Any] = _options(algorithm, given)
    if noise_depth is not None:
        as_positive("noise_depth", noise_depth, "a positive number of metres")
    source = read_cloud(cloud)
    metres, is_known, is_known_of_z = _metres(source)
    rows = np.flatnonzero(_takes_part(source))
    points = np.ascontiguousarray(source.points[rows] * metres, dtype=np.float64)
    points -= points.min(axis=0) if len(points) else 0.0
    is_noise = _low_noise(points, noise_depth)
    noise, rows, points = rows[is_noise], rows[~is_noise], points[~is_noise]
    if algorithm == "csf":
        _check_size(points, options["cloth_resolution"], is_given=cloth_resolution is not None)
    is_ground = _filtered(points, **options) if algorithm == "csf" else _tin(points, **options)
    ground = rows[is_ground]
    cells, bare = _bare_cells(points, is_ground, _side(options))
    told = {} if noise_depth is None else {"noise_depth": noise_depth, "noise": len(noise)}
    counts = {
        "rows": len(source), "ground": len(ground), "algorithm": algorithm, **options, **told,
        "unit_known": is_known, "z_unit_known": is_known_of_z, "cells": cells, "bare_cells": bare,
    }  # fmt: skip
    if warning := bare_warning(counts):
        warnings.warn(warning, DataWarning, stacklevel=2)
    return replace(
        source,
        attributes={**source.attributes, **_classes(source, ground, noise)},
        metadata=noted(source.metadata, ground=counts),
    )


def _options(algorithm: str, given: dict[str, float | None]) -> dict[str, float]:
    """Return the options of an algorithm: those given are its own, and valid."""
    chosen = dict(_DEFAULTS[algorithm])
    for name, value in given.items():
        if value is None:
            continue
        if name not in chosen:
            (other,) = _DEFAULTS.keys() - {algorithm}
            raise refused(name, value, f"it belongs to {Option('algorithm', other)}")
        _check(name, value)
        chosen[name] = value
    return chosen


def _check(name: str, value: float) -> None:
    """Check an option of an algorithm."""
    if name == "cloth_rigidness":
        if as_count(name, value, 1) > 3:
            raise refused(name, value, "give 1, 2 or 3")
    elif name == "tin_angle":
        if not as_positive(name, value, "a positive number of degrees") < 90:
            raise refused(name, value, "give less than 90 degrees")
    else:
        as_positive(name, value, "a positive number of metres")


def _tin(
    points: Floats, tin_cell: float, tin_distance: float, tin_angle: float, tin_threshold: float
) -> Mask:
    return tin_ground(points, TinOptions(tin_cell, tin_distance, tin_angle, tin_threshold))


def _low_noise(points: Floats, depth: float | None) -> Mask:
    """Tell which points have few others around that are less than a depth above them."""
    is_noise = np.zeros(len(points), np.bool_)
    if depth is None or not len(points):
        return is_noise
    across, down = np.floor(points[:, :2].T / _NOISE_CELL)
    order = np.lexsort((points[:, 2], down, across))
    keys = np.column_stack([across, down])[order]
    starts = np.flatnonzero(np.r_[True, (np.diff(keys, axis=0) != 0).any(axis=1)])
    places = {(x, y): k for k, (x, y) in enumerate(keys[starts].tolist())}
    lowest = np.full((len(starts) + 1, _FEW), np.inf)  # the last stands for cells without points
    ends = np.append(starts[1:], len(order))
    for k in range(_FEW):
        has_more = starts + k < ends
        lowest[:-1][has_more, k] = points[order[starts[has_more] + k], 2]
    around = np.array(
        [
            [places.get((x + i, y + j), len(starts)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
            for x, y in places
        ]
    )
    last = np.sort(lowest[around].reshape(len(starts), -1), axis=1)[:, _FEW - 1]
    is_noise[order] = points[order, 2] + depth < np.repeat(last, ends - starts)
    return is_noise


def _metres(cloud: Cloud) -> tuple[Floats, bool, bool]:
    """Return how many metres the units have, and whether those of x and of z are known."""
    system = parse_crs(cloud.crs)
    if system is None:
        return np.ones(3), False, False
    if system.kind in {"geographic", "geocentric"}:
        raise InputError(
            f"the coordinates are {system.kind} ({system.name}), but the ground is found in "
            f"metres: transform them with {Option('dst_crs', ...)}"
        )
    x, y, z = ((each and each.metres) for each in system.units)
    plane = x or 1.0
    return np.array([plane, y or plane, z or plane]), x is not None, z is not None


def _takes_part(cloud: Cloud) -> Array:
    """Whether rows are finite, and neither noise nor withheld."""
    is_taken = np.isfinite(cloud.points).all(axis=1)
    name, withheld = class_column(cloud.attributes), cloud.attributes.get("withheld")
    if name is not None:
        is_taken &= ~np.isin(cloud.attributes[name], _NOISE)
    if withheld is not None and withheld.ndim == 1:
        is_taken &= np.asarray(withheld == 0)
    return np.asarray(is_taken)


def _check_size(points: Floats, resolution: float, *, is_given: bool) -> None:
    """Raise for a cloth of too many nodes: for any rows, or for so few."""
    width, height = points[:, :2].max(axis=0) if len(points) else (0.0, 0.0)
    nodes = (width / resolution + _MARGIN) * (height / resolution + _MARGIN)
    if not nodes <= _MOST_NODES:
        raise InputError(
            f"the rows are in a box of {width:,.0f} by {height:,.0f} m, for which the cloth has "
            f"{nodes:.2g} nodes: remove rows that are far away, or give a larger "
            f"{Option('cloth_resolution', ...)}"
        )
    if not is_given and nodes > max(_NODES_OF_ROW * len(points), _MANY_NODES):
        apart = float(f"{math.sqrt(width * height / len(points)):.2g}")
        raise InputError(
            f"{len(points):,} rows in a box of {width:,.0f} by {height:,.0f} m are some {apart:g} "
            f"m apart, and a cloth of {resolution:g} m has {nodes:.2g} nodes: give "
            f"{Option('cloth_resolution', apart)}, or {Option('cloth_resolution', resolution)} for "
            "this one"
        )


def _filtered(
    points: Floats, cloth_resolution: float, cloth_rigidness: int, cloth_threshold: float
) -> Array:
    """Run CSF in a process of its own; return which points are ground."""
    if not len(points):
        return np.zeros(0, np.bool_)
    if find_spec("CSF") is None:
        raise MissingDependencyError(
            "this needs cloth-simulation-filter, which is not installed: "
            "pip install 'liftmesh[terrain]'"
        )
    options = map(str, (float(cloth_resolution), int(cloth_rigidness), float(cloth_threshold)))
    words = [*python_command(_PROGRAM, "CSF"), *options]
    done = subprocess.run(  # noqa: S603 - our own program and numbers
        words,
        input=points.tobytes(),
        capture_output=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        check=False,
    )
    if done.returncode or len(done.stdout) != len(points):
        cause = " ".join(done.stderr.decode(errors="replace").split())[-200:]
        raise LiftmeshError(f"CSF ended with code {done.returncode}: {cause or 'no message'}")
    return np.frombuffer(done.stdout, np.uint8).astype(np.bool_)


# The first argument is the path of modules, which must not begin with the current folder. It reads
# float64 coordinates from stdin, and writes a byte for each row to stdout: 1 is ground.
_PROGRAM = """
import json, os, sys
sys.path[:] = json.loads(sys.argv[1])
answer = os.dup(1)
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
import CSF
import numpy as np
resolution, rigidness, threshold = map(float, sys.argv[2:])
points = np.frombuffer(sys.stdin.buffer.read()).reshape(-1, 3)
cloth = CSF.CSF()
cloth.params.bSloopSmooth = False
cloth.params.cloth_resolution = resolution
cloth.params.rigidness = int(rigidness)
cloth.params.class_threshold = threshold
cloth.setPointCloud(np.array(points))
ground, others = CSF.VecInt(), CSF.VecInt()
cloth.do_filtering(ground, others, False)
found = np.zeros(len(points), np.uint8)
found[np.array(ground, dtype=np.int64)] = 1
with open(answer, "wb") as stream:
    stream.write(found.tobytes())
"""


def _side(counts: Mapping[str, Any]) -> float:
    """Return the side of the cells that are looked at."""
    side: float = _NODES_OF_CELL * counts.get("cloth_resolution", 1.0)
    return side


def _bare_cells(points: Floats, is_ground: Array, side: float) -> tuple[int, int]:
    """Count the cells that have rows enough, and those of them that have no ground."""
    across, down = (np.unique(each, return_inverse=True)[1] for each in points[:, :2].T // side)
    keys = across * (down.max(initial=0) + 1) + down
    _, which, counts = np.unique(keys, return_inverse=True, return_counts=True)
    has_ground = np.bincount(which[is_ground], minlength=len(counts)) > 0
    is_full = counts >= _ROWS_OF_CELL
    return int(is_full.sum()), int((is_full & ~has_ground).sum())


def bare_warning(counts: Mapping[str, Any]) -> str:
    """Say that the ground of many cells was lost, and what helps; "" if it was not."""
    cells, bare = counts["cells"], counts["bare_cells"]
    if bare <= _MOST_BARE * cells:
        return ""
    cloth = (
        "on slopes the cloth has lost it, if they are no roofs: give a smaller "
        f"{Option('cloth_resolution', ...)}, or {Option('cloth_rigidness', 1)}"
    )
    tin = (
        "the triangulation does not reach it, if they are no roofs: give a larger "
        f"{Option('tin_angle', ...)}, or a smaller {Option('tin_cell', ...)}"
    )
    remedy = cloth if counts["algorithm"] == "csf" else tin
    return f"{bare:,} of {cells:,} cells of {_side(counts):g} m have no ground: {remedy}"


def _classes(cloud: Cloud, ground: Array, noise: Array) -> dict[str, Array]:
    """Return the column of classes: those before, but for the ground and noise that were found."""
    name = class_column(cloud.attributes)
    if name is None or cloud.attributes[name].dtype.kind == "b":
        name, classes = _CLASSES, np.full(len(cloud), _UNCLASSIFIED, np.uint8)
    else:
        classes = cloud.attributes[name].copy()
        classes[classes == _GROUND] = _UNCLASSIFIED
    classes[ground] = _GROUND
    classes[noise] = _NOISE[0]
    return {name: classes}


_FINEST = 1.0  # metres between rows that join
_MOST_ROUNDS = 100
_INWARDS = 1e-6  # of the way to the middle of the hull, where a facet is


class TinOptions(NamedTuple):
    """Side of cells, thresholds of rows that join, and of rows at the end; metres and degrees."""

    cell: float
    distance: float
    angle: float
    threshold: float


def tin_ground(points: Floats, options: TinOptions) -> Mask:
    """Tell which points, in metres, are ground."""
    ground, left = _began(points, options.cell), points
    if ground is None:
        return np.zeros(len(points), np.bool_)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for _ in range(_MOST_ROUNDS):
            seen = _Seen.of(ground, left)
            joins = seen.joining(left, options)
            if not len(joins):
                break
            ground = np.concatenate([ground, left[joins]])
            left = left[seen.is_apart]
        is_ground: Mask = np.abs(_Seen.of(ground, points).above) <= options.threshold
    return is_ground


def _began(points: Floats, cell: float) -> Floats | None:
    """Take the lowest points of cells, which are halved until these are not on a line."""
    while len(points):
        ground = points[_seeds(points, cell)]
        with suppress(DegenerateInputError):
            delaunay(ground[:, :2])
            return ground
        if cell < _FINEST:
            break
        cell /= 2
    return None


def _slopes_within(surface: SurfaceData, places: Floats) -> Floats:
    """Return the slopes of the facets at places of the hull; of steep ones, none."""
    corners = surface.triangulation.points[surface.triangulation.convex_hull]
    middle = np.array([math.fsum(each) for each in corners.T]) / len(corners)
    slopes = gradients_at(surface, places + (middle - places) * _INWARDS)
    slopes[~((slopes**2).sum(axis=1) <= 1)] = 0  # NaN, too
    return slopes


def _surface(ground: Floats) -> SurfaceData:
    solved = delaunay(ground[:, :2])
    faces = solved.simplices
    report = bare_report(len(ground), len(faces))
    return SurfaceData(ground, faces, solved, resolve_plane("xy", ground), report)


def _seeds(points: Floats, cell: float) -> Integers:
    """Choose the lowest point of each cell, of several the lexicographically least."""
    x, y, z = points.T
    across, down = (np.floor((each - each.min()) / cell) for each in (x, y))
    return _firsts((across, down), (z, x, y))


def _firsts(keys: tuple[Array, ...], order: tuple[Array, ...]) -> Integers:
    """Return the first row in an order of each group of rows with the same keys."""
    rows = np.lexsort((*reversed(order), *reversed(keys)))
    is_first = np.zeros(len(rows), np.bool_)
    is_first[:1] = True
    for each in keys:
        is_first[1:] |= np.diff(each[rows]) != 0
    return rows[is_first]


class _Seen(NamedTuple):
    """What points see of the ground: how high they are above it, and the corners of their facet."""

    above: Floats
    distance: Floats  # from the facet
    corners: tuple[Floats, Floats, Floats]  # vectors to the corners of the facet
    facet: tuple[Integers, Integers]

    @classmethod
    def of(cls, ground: Floats, points: Floats) -> _Seen:
        surface = _surface(ground)
        places = points[:, :2]
        weights = weights_at(surface, places, extrapolate="hull")
        slopes, beyond = gradients_at(surface, places), np.zeros(len(points))
        outside = np.flatnonzero(np.isnan(slopes[:, 0]))
        nearest = np.stack([(weights @ each)[outside] for each in ground.T[:2]], axis=1)
        slopes[outside] = _slopes_within(surface, nearest)
        beyond[outside] = (slopes[outside] * (places[outside] - nearest)).sum(axis=1)
        above = points[:, 2] - weights @ ground[:, 2] - beyond
        distance = np.abs(above) / np.sqrt(1 + (slopes**2).sum(axis=1))
        last = weights.indptr[1:] - 1
        rows = [weights.indices[np.minimum(weights.indptr[:-1] + k, last)] for k in range(3)]
        within = surface.triangulation.find_simplex(places)
        is_inside = np.diff(weights.indptr) == 3
        low, high = np.minimum(rows[0], rows[1]), np.maximum(rows[0], rows[1])
        facet = np.where(is_inside, -1, low), np.where(is_inside, within, high)
        first, second, third = (ground[each] - points for each in rows)
        return cls(above, distance, (first, second, third), facet)

    @property
    def is_apart(self) -> Mask:
        """Whether points are so far from all corners that they may join."""
        apart: Mask = np.min([np.hypot(*each[:, :2].T) for each in self.corners], axis=0) >= _FINEST
        return apart

    def joining(self, points: Floats, options: TinOptions) -> Integers:
        """Choose the lowest point over each facet of those within the thresholds."""
        fits = self.is_apart & (self.distance <= options.distance)
        steepest = np.sin(np.radians(options.angle))
        for each in self.corners:
            fits &= self.distance <= steepest * np.sqrt((each**2).sum(axis=1))
        rows = np.flatnonzero(fits)
        x, y, _ = points[rows].T
        return rows[_firsts(tuple(each[rows] for each in self.facet), (self.above[rows], x, y))]
