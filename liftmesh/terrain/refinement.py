"""Refined surfaces: `refine` adds rows in the plane, with the heights of the faces before.

Both surfaces are linear on the parts into which their edges divide the plane, and equal at all
rows: so they differ most where an edge of one crosses an edge of the other.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats, Integers
from liftmesh.base.arrays import pair_keys, pairs_of_keys
from liftmesh.io.tags import MARKERS
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation, with_left
from liftmesh.planar.refinement import as_constrained
from liftmesh.terrain.profile import LineCrossings
from liftmesh.terrain.sampling import heights_at
from liftmesh.terrain.surface_data import AnySurface, SurfaceData, as_cloud

if TYPE_CHECKING:
    from liftmesh.planar.refined import RefineResult

STEINER = "steiner"  # the values that say which rows were added
_INWARD = 2.0 ** np.arange(-50, 0, 10)


def refined(
    surface: AnySurface, refine: Callable[[ConstrainedTriangulation], RefineResult]
) -> RefineResult:
    """Refine the faces of a surface, and make a surface of them."""
    from liftmesh.terrain.breaklines import check_exact, check_flag  # noqa: PLC0415 - makes surfaces

    tri = as_constrained(surface.triangulation)
    check_exact(surface.frame)
    check_flag(surface.attributes, STEINER)
    if surface.mask is not None:
        tri = with_left(tri, ~surface.mask)
    result = refine(tri)
    made = _surface(surface, result)
    return replace(result, surface=made, original=surface)


def _surface(surface: AnySurface, result: RefineResult) -> AnySurface:
    from liftmesh.terrain.breaklines import extended, in_space  # noqa: PLC0415 - makes surfaces

    tri, frame = result.triangulation, surface.frame
    count = len(tri.is_constrained)
    whole = with_left(tri, np.ones(len(tri._whole[0]), dtype=np.bool_))  # noqa: SLF001
    mask = np.arange(whole.nsimplex) >= count
    rows = in_space(frame, tri.points[result.steiner], _heights(surface, result))
    flags = np.ones(len(rows), dtype=np.uint8)
    cloud = extended(as_cloud(surface), frame, rows, flags, STEINER)
    report = replace(
        surface.report,
        n_rows=surface.report.n_rows + len(rows),
        n_used=surface.report.n_used + len(rows),
        n_triangles=count,
    )
    return replace(
        surface,
        vertices=cloud.points,
        faces=tri.simplices,
        triangulation=whole,
        report=report,
        colors=cloud.colors,
        normals=cloud.normals,
        attributes=cloud.attributes,
        metadata={key: each for key, each in surface.metadata.items() if key != MARKERS},
        mask=mask if mask.any() else None,
    )


def _heights(surface: AnySurface, result: RefineResult) -> Floats:
    """Return the heights at rows that were added; some are rounded to beside the faces."""
    tri, rows = result.triangulation, result.steiner
    places = tri.points[rows]
    heights = heights_at(surface, places)
    for part in _INWARD.tolist():
        beside = np.flatnonzero(np.isnan(heights))
        inside = tri.simplices[tri.vertex_to_simplex[rows[beside]]]
        toward = tri.points[inside].mean(axis=1)
        heights[beside] = heights_at(surface, places[beside] * (1 - part) + toward * part)
    return heights


def deviation(before: SurfaceData, after: SurfaceData) -> float:
    """Return the largest difference of heights: along edges of the faces before that are gone."""
    keys, kept = map(_edge_keys, (before, after))
    gone = np.stack(pairs_of_keys(keys[~np.isin(keys, kept, assume_unique=True)]), axis=1)
    ends = before.triangulation.points[gone]
    points, _ = LineCrossings(after).of(ends[:, 0], ends[:, 1])
    differences = np.abs(points[:, 2] - heights_at(before, points[:, :2]))
    return float(np.max(differences, where=~np.isnan(differences), initial=0.0))


def _edge_keys(surface: SurfaceData) -> Integers:
    edges = np.sort(np.concatenate([surface.faces[:, [k - 1, k]] for k in range(3)]), axis=1)
    return np.unique(pair_keys(*edges.T))
