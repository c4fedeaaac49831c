"""Summary of a cloud before triangulation: counts, measures, and predictions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.cli.notes import cloud_notes, lidar_counts, parts_not_read
from liftmesh.crs.units import system_of
from liftmesh.io.metadata import Provenance
from liftmesh.planar.points import find_positions, pieces

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


# Measured: peak memory of reading, triangulating and writing, in addition to the file's arrays.
_BYTES_PER_ROW = 70


@dataclass(frozen=True, slots=True)
class Summary:
    """Statistics of a cloud."""

    rows: int
    faces: int
    not_finite: int
    holds: tuple[str, ...]
    not_read: tuple[str, ...]
    columns: dict[str, str]
    notes: tuple[str, ...]
    lidar: dict[str, Any]
    raster: dict[str, Any]
    crs: str | None
    units: tuple[str | None, ...]
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
    """Compute the statistics of a cloud."""
    points = _finite_rows(cloud.points)
    positions = find_positions(points)
    overhangs = _overhangs(points, positions.duplicates)
    minimum, maximum = _bounds(points)
    return Summary(
        rows=len(cloud),
        faces=0 if cloud.faces is None else len(cloud.faces),
        not_finite=len(cloud) - len(points),
        crs=cloud.crs,
        units=_units(cloud),
        holds=_holds(cloud),
        not_read=parts_not_read(cloud),
        columns=Provenance(cloud.metadata).columns,
        notes=cloud_notes(cloud),
        lidar=lidar_counts(cloud),
        raster=_raster(cloud),
        minimum=minimum,
        maximum=maximum,
        positions=positions.count,
        duplicates=len(positions.duplicates) - overhangs,
        overhangs=overhangs,
        collinear=positions.collinear,
        spacing=positions.spacing,
        float32_shift=_float32_shift(points),
        memory=_memory(cloud),
    )


def _raster(cloud: Cloud) -> dict[str, Any]:
    raster = Provenance(cloud.metadata).raster
    return raster if "transform" in raster else {}


def _units(cloud: Cloud) -> tuple[str | None, ...]:
    system = system_of(cloud)
    return () if system is None else tuple(each.name if each else None for each in system.units)


def _finite_rows(points: Floats) -> Floats:
    """Return the rows without NaN or infinity; the same array if that is all of them."""
    finite = np.ones(len(points), dtype=np.bool_)
    for piece in pieces(len(points)):
        finite[piece] = np.isfinite(points[piece]).all(axis=1)
    return points if finite.all() else points[finite]


def _overhangs(points: Floats, duplicates: Rows) -> int:
    """Count the rows at another height than the first row at their position."""
    rows, first = duplicates.T
    z = points[:, 2]
    return sum(
        int(np.count_nonzero(z[rows[piece]] != z[first[piece]])) for piece in pieces(len(rows))
    )


def _bounds(points: Floats) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the corners of the bounding box; empty without points."""
    if len(points) == 0:
        return (), ()
    columns = [points[piece].T for piece in pieces(len(points))]
    # Of each column by itself: across short rows NumPy is twenty times slower.
    lows = [[column.min() for column in part] for part in columns]
    highs = [[column.max() for column in part] for part in columns]
    return tuple(np.min(lows, axis=0).tolist()), tuple(np.max(highs, axis=0).tolist())


def _float32_shift(points: Floats) -> float:
    """Compute the maximum change of a coordinate when it is stored as float32."""
    most = 0.0
    with np.errstate(over="ignore", under="ignore"):
        for piece in pieces(len(points)):
            part = points[piece]
            most = max(most, float(np.abs(part.astype(np.float32) - part).max()))
    return most


def _holds(cloud: Cloud) -> tuple[str, ...]:
    named = {"colors": cloud.colors, "normals": cloud.normals}
    return (*(name for name, values in named.items() if values is not None), *cloud.attributes)


def _memory(cloud: Cloud) -> int:
    arrays: list[Any] = [cloud.points, cloud.colors, cloud.normals, *cloud.attributes.values()]
    held = sum(array.nbytes for array in arrays if array is not None)
    return int(held + _BYTES_PER_ROW * len(cloud))
