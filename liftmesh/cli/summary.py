"""Summary of a cloud before triangulation: counts, measures, and predictions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Indices
from liftmesh.optional import load
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud


_SAMPLE = 20_000
# Measured: peak memory of reading, triangulating and writing, in addition to the file's arrays.
_BYTES_PER_ROW = 116


@dataclass(frozen=True, slots=True)
class Summary:
    """Statistics of a cloud.

    Parameters
    ----------
    rows, faces, not_finite : int
        Numbers of rows, of faces, and of rows with NaN or infinity. All other values concern the
        finite rows.
    holds : tuple of str
        Names of the values of each row other than its coordinates.
    crs : str or None
        Coordinate reference system, if the file states one.
    minimum, maximum : tuple of float
        Corners of the bounding box in x, y, z; empty without finite rows.
    positions : int
        Number of distinct planar positions.
    duplicates : int
        Rows equal in x, y and z to the first row at their position.
    overhangs : int
        Rows at another height than the first row at their position.
    collinear : bool
        Whether all positions lie exactly on one line (or there are fewer than three), so that no
        triangle exists.
    spacing : float, optional
        Median planar distance from a position to its nearest neighbour, estimated from a sample of
        a large cloud.
    float32_shift : float
        Maximum change of a coordinate when it is stored as float32.
    memory : int
        Predicted peak memory of ``triangulate`` in bytes.
    """

    rows: int
    faces: int
    not_finite: int
    holds: tuple[str, ...]
    crs: str | None
    minimum: tuple[float, ...]
    maximum: tuple[float, ...]
    positions: int
    duplicates: int
    overhangs: int
    collinear: bool
    spacing: float | None
    float32_shift: float
    memory: int

    @property
    def extent(self) -> tuple[float, ...]:
        """Size of the bounding box along each axis; infinite if it exceeds float64."""
        return tuple(high - low for low, high in zip(self.minimum, self.maximum, strict=True))

    @property
    def offset(self) -> float:
        """Planar distance from the origin to the centre of the bounding box."""
        bounds = zip(self.minimum[:2], self.maximum[:2], strict=True)
        return math.hypot(*(low / 2 + high / 2 for low, high in bounds))

    @property
    def float32_is_enough(self) -> bool:
        """Whether float32 changes no coordinate by more than a hundredth of the spacing."""
        return self.float32_shift <= (self.spacing or 0.0) / 100


def summarise(cloud: Cloud) -> Summary:
    """Compute the statistics of a cloud.

    Parameters
    ----------
    cloud : Cloud
        Any cloud, even empty or with rows that are not finite.

    Returns
    -------
    Summary
        The statistics.

    Examples
    --------
    >>> from liftmesh.cloud import Cloud
    >>> summary = summarise(Cloud(np.array([[0.0, 0, 1], [3, 0, 1], [0, 4, 1], [3, 0, 2]])))
    >>> summary.positions, summary.overhangs, summary.spacing
    (3, 1, 3.0)
    """
    finite = np.isfinite(cloud.points).all(axis=1)
    points = cloud.points if finite.all() else cloud.points[finite]
    first, group = _positions(points)
    apart = points[:, 2] != points[first[group], 2]
    distinct = points[first, :2]
    return Summary(
        rows=len(cloud),
        faces=0 if cloud.faces is None else len(cloud.faces),
        not_finite=len(cloud) - len(points),
        crs=cloud.crs,
        holds=_holds(cloud),
        minimum=tuple(points.min(axis=0).tolist()) if len(points) else (),
        maximum=tuple(points.max(axis=0).tolist()) if len(points) else (),
        positions=len(first),
        duplicates=len(points) - len(first) - int(apart.sum()),
        overhangs=int(apart.sum()),
        collinear=_collinear(distinct),
        spacing=_spacing(distinct),
        float32_shift=_float32_shift(points),
        memory=_memory(cloud),
    )


def _positions(points: Floats) -> tuple[Indices, Indices]:
    """Return the first row at each planar position, sorted by position, and each row's position."""
    order = np.lexsort((points[:, 1], points[:, 0]))
    placed = points[order, :2]
    is_new = np.ones(len(points), dtype=bool)
    is_new[1:] = (placed[1:] != placed[:-1]).any(axis=1)
    group = np.empty(len(points), dtype=np.intp)
    group[order] = np.cumsum(is_new) - 1
    return order[is_new], group


def _collinear(distinct: Floats) -> bool:
    """Whether all points lie exactly on the line through the lexicographically first and last."""
    if len(distinct) < 3:
        return True
    return not orient2d(distinct[0], distinct[-1], distinct).any()


def _spacing(distinct: Floats) -> float | None:
    """Compute the median distance to the nearest neighbour, scaled so that no square overflows."""
    if len(distinct) < 2:
        return None
    exponent = int(np.frexp(np.abs(distinct).max())[1])
    scaled = np.ldexp(distinct, -exponent)
    scaled -= scaled[len(scaled) // 2]
    tree = load("scipy.spatial").cKDTree(scaled, balanced_tree=False, compact_nodes=False)
    sample = scaled[:: max(1, len(scaled) // _SAMPLE)]
    distances, _ = tree.query(sample, k=2)
    return float(np.ldexp(np.median(distances[:, 1]), exponent))


def _float32_shift(points: Floats) -> float:
    with np.errstate(over="ignore", under="ignore"):
        moved = np.abs(points.astype(np.float32).astype(np.float64) - points)
    return float(moved.max(initial=0.0))


def _holds(cloud: Cloud) -> tuple[str, ...]:
    named = {"colors": cloud.colors, "normals": cloud.normals}
    return (*(name for name, values in named.items() if values is not None), *cloud.attributes)


def _memory(cloud: Cloud) -> int:
    arrays: list[Any] = [cloud.points, cloud.colors, cloud.normals, *cloud.attributes.values()]
    held = sum(array.nbytes for array in arrays if array is not None)
    return int(held + _BYTES_PER_ROW * len(cloud))
