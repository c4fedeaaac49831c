"""Sites and the triangulation dual to their cells, or a chain of rows if all are on one line.

Sites come in whatever holds points: arrays, clouds, tables without heights, GeoPandas.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Reals, Rows
from liftmesh.base.arrays import are_geometries, as_coordinates, coordinates_of, non_finite, widened
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import Part, part_of
from liftmesh.crs.comparison import common_system, crs_of
from liftmesh.errors import DegenerateInputError, InputError, NonFiniteError
from liftmesh.io.objects.plain import is_table
from liftmesh.io.registry import as_cloud
from liftmesh.planar import delaunay, regular
from liftmesh.planar.diagram import LiftedTriangles, diagram_of, regions_of, rows_without_area
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
    if are_geometries(points):
        return coordinates_of(points)[:, :2]
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
    if are_geometries(points):
        columns = [name for name in getattr(points, "columns", ()) if name != points.geometry.name]
        held = {name: np.asarray(points[name]) for name in columns}
        return named_values(Cloud(np.zeros((len(points), 3)), attributes=held), kind, given)
    cloud = as_cloud(points, flat=None) if is_table(points) else as_cloud(points)
    return named_values(cloud, kind, given)


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
    planar = _own(as_coordinates(rows_of(points))[:, :2])
    if not len(planar):
        raise InputError("there are no points: give one at least")
    values = np.empty(0) if kind == "plain" else as_weights(kind, given, len(planar)).values
    sites = Dual(planar, kind, _own(values))
    told = part_of(progress, 0.0, _TRIANGULATED)
    try:
        solution = _solve(sites, slice(None), threads, told)
    except (DegenerateInputError, NonFiniteError) as error:
        if told is not None and told.has_raised:
            raise
        if isinstance(error, DegenerateInputError):
            return _chained(sites)
        raise _unskippable(error.row, sites) from None
    dual = _with_vertices(sites, solution.simplices, solution.neighbors, threads)
    degenerate = _without_area(dual, solution)
    if len(degenerate):  # the cells of the others stay as they are without them
        kept = np.setdiff1d(dual.simplices, degenerate).astype(np.int32)
        others = _solve(sites, kept, threads)
        dual = _with_vertices(sites, kept.take(others.simplices, axis=0), others.neighbors, threads)
    if progress is not None:
        progress(1.0)
    hidden, duplicates = solution.hidden, solution.duplicates
    return replace(dual, duplicates=duplicates, hidden=hidden, degenerate=degenerate)


def _own(given: Reals) -> Floats:
    """Return a copy, which no other thread can write between the triangulation and its use."""
    return np.array(widened(given), dtype=np.float64, order="C")


def _solve(
    sites: Dual, rows: Rows | slice, threads: int | None, progress: Part | None = None
) -> Solution:
    if sites.kind == "plain":
        return delaunay.solve(sites.points[rows], threads=threads, progress=progress)
    given = sites.points[rows], sites.kind, sites.values[rows]
    return regular.solve(*given, threads=threads, progress=progress)


def _unskippable(row: int, sites: Dual) -> NonFiniteError:
    """Return the error for a row that is not finite: cells have no option to skip it."""
    if np.isfinite(sites.points[row]).all():
        return TriangulationKind(sites.kind, sites.values).non_finite(row, skippable=False)
    return non_finite(row, sites.points[row], skippable=False)


def _with_vertices(sites: Dual, simplices: Rows, neighbors: Rows, threads: int | None) -> Dual:
    given = sites.points, simplices, neighbors, sites.values, sites.kind
    diagram = diagram_of(*given, threads=threads)
    return replace(
        sites, simplices=simplices, neighbors=neighbors, vertices=diagram.vertices,
        simplex_to_vertex=diagram.simplex_to_vertex,
    )  # fmt: skip


def _without_area(dual: Dual, solution: Solution) -> Rows:
    """Find degenerate rows: their triangles share vertices, and they have at most two ridges."""
    rows, simplices = len(dual.points), dual.simplices
    if solution.weights is None or len(dual.vertices) == len(simplices):
        return _NO_ROWS
    regions = regions_of(rows, simplices, dual.neighbors, dual.simplex_to_vertex)
    ridges = np.bincount(regions.ridge_points.reshape(-1), minlength=rows)
    if (ridges.take(simplices, axis=0) > 2).all():
        return _NO_ROWS
    triangles = dual.points, simplices, dual.neighbors, solution.hull
    return rows_without_area(LiftedTriangles(*triangles, solution.weights))


def _chained(sites: Dual) -> Dual:
    """Order rows on one line, and leave out those that the others hide: a lower hull."""
    planar = sites.points + 0.0
    sites = replace(sites, points=planar)
    heaviness = sites.values if len(sites.values) else np.zeros(len(planar))
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
    chain = _lower_hull(sites, kept) if len(sites.values) else kept
    degenerate = _on_hull(sites, kept, chain) if len(chain) < len(kept) else []
    hidden += {*kept} - {*chain} - {*degenerate}
    return replace(
        sites,
        chain=np.array(chain, dtype=np.int32),
        duplicates=np.array(sorted(duplicates), dtype=np.int32).reshape(-1, 2),
        hidden=np.array(sorted(hidden), dtype=np.int32),
        degenerate=np.array(sorted(degenerate), dtype=np.int32),
    )


def _height(sites: Dual, *rows: int) -> int:
    """Where the lift of the second of three rows is: 1 above the segment of the others, or -1."""
    sign = np.empty(1, dtype=np.int8)
    a, b, c = (sites.points[[row]] for row in rows)
    _kernel.height_between(a, b, c, sites.values[[*rows]].reshape(1, 3), sites.kind, sign)
    return int(sign[0])


def _lower_hull(sites: Dual, rows: list[int]) -> list[int]:
    """Leave out, of rows in their order, those on the hull of the others, or above it."""
    hull: list[int] = []
    for row in rows:
        while len(hull) > 1 and _height(sites, *hull[-2:], row) >= 0:
            hull.pop()
        hull.append(row)
    return hull


def _on_hull(sites: Dual, rows: list[int], hull: list[int]) -> list[int]:
    """Return the rows that are on a segment of the hull, between its ends."""
    between, place = [], 0
    for row in rows:
        if row == hull[place]:
            place = min(place + 1, len(hull) - 1)
        elif _height(sites, hull[place - 1], row, hull[place]) == 0:
            between.append(row)
    return between
