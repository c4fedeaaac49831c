"""Sites, and the triangulation behind their cells, or the chain of rows that are all on one line.

Sites come in whatever holds points: arrays, clouds, tables without heights, GeoPandas.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Reals, Rows
from liftmesh.base.arrays import as_coordinates, non_finite, widened
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import Part, part_of
from liftmesh.crs.comparison import common_system, crs_of
from liftmesh.errors import DegenerateInputError, InputError, NonFiniteError
from liftmesh.io.objects.plain import is_table
from liftmesh.io.registry import as_cloud
from liftmesh.planar import delaunay, regular
from liftmesh.planar.diagram import (
    Diagram,
    LiftedTriangles,
    diagram_of,
    regions_of,
    rows_without_area,
)
from liftmesh.planar.kinds import TriangulationKind, as_weights, named_values
from liftmesh.planar.points import rows_of

if TYPE_CHECKING:
    from liftmesh.planar.delaunay import Solution

_TRIANGULATED = 0.75  # of the progress: the vertices are the rest
_NOTHING = np.empty((0, 3), dtype=np.int32)
_NO_ROWS = np.empty(0, dtype=np.int32)
_NO_PAIRS = np.empty((0, 2), dtype=np.int32)


def sites_of(points: Any, domain: Any = None) -> Any:
    """Return the points of anything, for arrays to be made of."""
    common_system(crs_of(points), crs_of(domain))
    if _is_geometric(points):
        return _coordinates(points)
    if is_table(points):
        return as_cloud(points, flat=None).points
    listed = isinstance(points, list | tuple) or (isinstance(points, np.ndarray) and points.ndim)
    first = points[0] if listed and len(points) else points
    if hasattr(first, "geom_type"):
        raise InputError("the points are geometries of shapely: give shapely.get_coordinates of it")
    return rows_of(points)


def values_of(points: Any, kind: str, given: Any) -> Any:
    """Return weights or radii: values of the points, if a name is given."""
    if not isinstance(given, str):
        return given
    if _is_geometric(points):
        columns = [name for name in getattr(points, "columns", ()) if name != points.geometry.name]
        held = {name: np.asarray(points[name]) for name in columns}
        return named_values(Cloud(np.zeros((len(points), 3)), attributes=held), kind, given)
    cloud = as_cloud(points, flat=None) if is_table(points) else as_cloud(points)
    return named_values(cloud, kind, given)


def _is_geometric(points: Any) -> bool:
    """Whether this is a GeoSeries, a GeoDataFrame or the array of one."""
    return hasattr(type(points), "geom_type") and hasattr(type(points), "union_all")


def _coordinates(points: Any) -> Any:
    shapes = getattr(points, "geometry", points)
    kinds = np.asarray(shapes.geom_type)
    if (other := kinds != "Point").any():
        row = int(other.argmax())
        kind = kinds[row] if isinstance(kinds[row], str) else "nothing"
        raise InputError(f"row {row} is {kind}: give points, such as the centroids of polygons")
    return np.stack([np.asarray(shapes.x), np.asarray(shapes.y)], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Dual:
    """Sites, and which of their cells have a ridge between them."""

    points: Floats
    kind: str  # "plain", "weights" or "radii"
    values: Floats  # the weights or radii; empty if there are none
    simplices: Rows = field(default_factory=lambda: _NOTHING)
    neighbors: Rows = field(default_factory=lambda: _NOTHING)
    # Without triangles, the rows with a cell, in the order on their line.
    chain: Rows = field(default_factory=lambda: _NO_ROWS)
    vertices: Floats = field(default_factory=lambda: np.empty((0, 2)))  # rounded correctly
    simplex_to_vertex: Rows = field(default_factory=lambda: _NO_ROWS)
    duplicates: Rows = field(default_factory=lambda: _NO_PAIRS)
    hidden: Rows = field(default_factory=lambda: _NO_ROWS)
    degenerate: Rows = field(default_factory=lambda: _NO_ROWS)  # in no triangle


def dual_of(
    points: Any,
    kind: str = "plain",
    given: Any = None,
    threads: int | None = None,
    progress: Part | None = None,
) -> Dual:
    """Triangulate sites of any number and position."""
    rows = as_coordinates(rows_of(points))
    planar = _own(rows[:, :2])
    if not len(planar):
        raise InputError("there are no points: give one at least")
    values = _values(kind, given, len(planar))
    told = part_of(progress, 0.0, _TRIANGULATED)
    try:
        if kind == "plain":
            solution = delaunay.solve(planar, threads=threads, progress=told)
        else:
            solution = regular.solve(planar, kind, values, threads=threads, progress=told)
    except (DegenerateInputError, NonFiniteError) as error:
        if told is not None and told.has_raised:
            raise
        if isinstance(error, DegenerateInputError):
            return _chained(planar, kind, values)
        raise _unskippable(error, planar, kind, values) from None
    triangles = solution.simplices, solution.neighbors
    diagram = diagram_of(planar, *triangles, values, kind, threads=threads)
    degenerate = _NO_ROWS if kind == "plain" else _without_area(planar, solution, diagram)
    if len(degenerate):
        triangles = _without(degenerate, planar, kind, values, triangles[0], threads)
        diagram = diagram_of(planar, *triangles, values, kind, threads=threads)
    if progress is not None:
        progress(1.0)
    return Dual(
        planar,
        kind,
        values,
        *triangles,
        vertices=diagram.vertices,
        simplex_to_vertex=diagram.simplex_to_vertex,
        duplicates=solution.duplicates,
        hidden=solution.hidden,
        degenerate=degenerate,
    )


def _without_area(planar: Floats, solution: Solution, diagram: Diagram) -> Rows:
    """Find degenerate rows: their triangles share vertices, and they have at most two ridges."""
    rows, simplices = len(planar), solution.simplices
    if len(diagram.vertices) == len(simplices):
        return _NO_ROWS
    regions = regions_of(rows, simplices, solution.neighbors, diagram.simplex_to_vertex)
    ridges = np.bincount(regions.ridge_points.reshape(-1), minlength=rows)
    is_vertex = np.zeros(rows, dtype=np.bool_)
    is_vertex[simplices.reshape(-1)] = True
    few = np.flatnonzero(is_vertex & (ridges <= 2))
    if not len(few) or solution.weights is None:
        return _NO_ROWS
    triangles = planar, simplices, solution.neighbors, solution.hull
    return rows_without_area(LiftedTriangles(*triangles, solution.weights))


def _without(
    degenerate: Rows,
    planar: Floats,
    kind: str,
    values: Floats,
    simplices: Rows,
    threads: int | None,
) -> tuple[Rows, Rows]:
    """Triangulate the vertices but for some; the cells of the others stay as they are."""
    kept = np.setdiff1d(simplices, degenerate).astype(np.int32)
    solution = regular.solve(planar[kept], kind, values[kept], threads=threads)
    return kept[solution.simplices], solution.neighbors


def _values(kind: str, given: Any, rows: int) -> Floats:
    if kind == "plain":
        return np.empty(0)
    return _own(as_weights(kind, given, rows).values)


def _own(given: Reals) -> Floats:
    """Return a copy, which no other thread can write between the triangulation and its use."""
    return np.array(widened(given), dtype=np.float64, order="C")


def _unskippable(error: NonFiniteError, planar: Floats, kind: str, values: Floats) -> Exception:
    row = error.row
    if np.isfinite(planar[row]).all():
        return TriangulationKind(kind, values).non_finite(row, skippable=False)
    return non_finite(row, planar[row], skippable=False)


def _chained(planar: Floats, kind: str, values: Floats) -> Dual:
    """Order rows on one line, and leave out those that the others hide: a lower hull."""
    planar = planar + 0.0
    heaviness = values if len(values) else np.zeros(len(planar))
    order = np.lexsort((np.arange(len(planar)), -heaviness, planar[:, 1], planar[:, 0]))
    kept: list[int] = []
    duplicates: list[tuple[int, int]] = []
    hidden: list[int] = []
    for row in order.tolist():
        if not kept or (planar[row] != planar[kept[-1]]).any():
            kept.append(row)
        elif heaviness[row] == heaviness[kept[-1]]:
            duplicates.append((row, kept[-1]))
        else:
            hidden.append(row)
    line = _Line(planar, kind, values)
    chain = line.lower_hull(kept) if len(values) else kept
    degenerate = line.on_hull(kept, chain) if len(chain) < len(kept) else []
    hidden += {*kept} - {*chain} - {*degenerate}
    pairs = np.array(sorted(duplicates), dtype=np.int32).reshape(-1, 2)
    return Dual(
        planar,
        kind,
        values,
        chain=np.array(chain, dtype=np.int32),
        duplicates=pairs,
        hidden=np.array(sorted(hidden), dtype=np.int32),
        degenerate=np.array(sorted(degenerate), dtype=np.int32),
    )


@dataclass(frozen=True, slots=True)
class _Line:
    """Weighted rows on one line."""

    planar: Floats
    kind: str
    values: Floats

    def height(self, *three: int) -> int:
        """Where the lift of the second row is: 1 above the segment of the others, -1 below."""
        sign = np.empty(1, dtype=np.int8)
        a, b, c = (self.planar[[row]] for row in three)
        _kernel.height_between(a, b, c, self.values[[*three]].reshape(1, 3), self.kind, sign)
        return int(sign[0])

    def lower_hull(self, rows: list[int]) -> list[int]:
        """Leave out, of rows in their order, those on the hull of the others, or above it."""
        hull: list[int] = []
        for row in rows:
            while len(hull) > 1 and self.height(*hull[-2:], row) >= 0:
                hull.pop()
            hull.append(row)
        return hull

    def on_hull(self, rows: list[int], hull: list[int]) -> list[int]:
        """Return the rows that are on a segment of the hull, between its ends."""
        between, place = [], 0
        for row in rows:
            if row == hull[place]:
                place = min(place + 1, len(hull) - 1)
            elif self.height(hull[place - 1], row, hull[place]) == 0:
                between.append(row)
        return between
