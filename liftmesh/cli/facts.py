"""What can be told of a cloud before it is triangulated: counts, measures, and what to expect."""

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
# Measured: peak memory of reading, triangulating and writing, beyond the arrays of the file.
_BYTES_PER_ROW = 116


@dataclass(frozen=True, slots=True)
class Facts:
    """A cloud in numbers.

    Parameters
    ----------
    rows, faces, not_finite : int
        Rows, faces of a mesh, rows with NaN or infinity. All else is about the finite rows.
    holds : tuple of str
        What is known of each row beside its coordinates.
    minimum, maximum : tuple of float
        Corners of the bounding box in x, y, z; empty without finite rows.
    positions : int
        Distinct planar positions.
    duplicates : int
        Rows equal in x, y and z to the first row of their position.
    overhangs : int
        Rows at another height than the first row of their position.
    collinear : bool
        Whether all positions lie exactly on one line (or fewer than three exist): no triangle.
    spacing : float, optional
        Median planar distance from a position to its nearest neighbour; of every k-th position
        when there are many.
    float32_shift : float
        The farthest that a coordinate moves when it is stored as float32.
    memory : int
        Bytes that ``triangulate`` is predicted to take at its peak.
    """

    rows: int
    faces: int
    not_finite: int
    holds: tuple[str, ...]
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
        """Sizes of the bounding box; infinite where they exceed float64."""
        return tuple(high - low for low, high in zip(self.minimum, self.maximum, strict=True))

    @property
    def offset(self) -> float:
        """Planar distance from the origin to the centre of the bounding box."""
        sides = zip(self.minimum[:2], self.maximum[:2], strict=True)
        return math.hypot(*(low / 2 + high / 2 for low, high in sides))

    @property
    def float32_is_enough(self) -> bool:
        """Whether float32 moves no coordinate by more than a hundredth of the spacing."""
        return self.float32_shift <= (self.spacing or 0.0) / 100


def gather(cloud: Cloud) -> Facts:
    """Measure a cloud.

    Parameters
    ----------
    cloud : Cloud
        Any cloud, empty and flawed ones too.

    Returns
    -------
    Facts
        Its measures.

    Examples
    --------
    >>> from liftmesh.cloud import Cloud
    >>> facts = gather(Cloud(np.array([[0.0, 0, 1], [3, 0, 1], [0, 4, 1], [3, 0, 2]])))
    >>> facts.positions, facts.overhangs, facts.spacing
    (3, 1, 3.0)
    """
    finite = np.isfinite(cloud.points).all(axis=1)
    points = cloud.points if finite.all() else cloud.points[finite]
    first, group = _positions(points)
    apart = points[:, 2] != points[first[group], 2]
    distinct = points[first, :2]
    return Facts(
        rows=len(cloud),
        faces=0 if cloud.faces is None else len(cloud.faces),
        not_finite=len(cloud) - len(points),
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
    """The lowest row of each planar position, in lexicographic order, and each row's position."""
    order = np.lexsort((points[:, 1], points[:, 0]))
    placed = points[order, :2]
    is_new = np.ones(len(points), dtype=bool)
    is_new[1:] = (placed[1:] != placed[:-1]).any(axis=1)
    group = np.empty(len(points), dtype=np.intp)
    group[order] = np.cumsum(is_new) - 1
    return order[is_new], group


def _collinear(distinct: Floats) -> bool:
    """Exactly: whether all lie on the line through the lexicographically first and last."""
    if len(distinct) < 3:
        return True
    return not orient2d(distinct[0], distinct[-1], distinct).any()


def _spacing(distinct: Floats) -> float | None:
    """Median distance to the nearest neighbour; scaled, so that no square overflows."""
    if len(distinct) < 2:
        return None
    exponent = int(np.frexp(np.abs(distinct).max())[1])
    scaled = np.ldexp(distinct, -exponent)
    scaled -= scaled[len(scaled) // 2]
    tree = load("scipy.spatial").cKDTree(scaled, balanced_tree=False, compact_nodes=False)
    asked = scaled[:: max(1, len(scaled) // _SAMPLE)]
    distances, _ = tree.query(asked, k=2)
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
