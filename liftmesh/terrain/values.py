"""Values of the vertices in place of heights: what a surface can do with these, it does with them.

Beyond the faces there is none, but for what a caller asks to be there: the value of the nearest
vertex, or that of the nearest place on the hull.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_numbers
from liftmesh.errors import InputError, Option
from liftmesh.optional import load
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.surface_data import AnySurface, SurfaceData, plane_system

Values: TypeAlias = "str | ArrayLike"
_REMEDY = "give the name of values of the vertices, or an array with a row for each"


def values_of(surface: SurfaceData, values: Values) -> Floats:
    """Return values of the vertices, (n, ...) float64, by their name or as they are given."""
    given = values
    if isinstance(values, str):
        known = dict(surface.attributes)
        if surface.colors is not None:
            known.setdefault("colors", surface.colors)
        if values not in known:
            names = ", ".join(map(repr, sorted(known))) or "none at all"
            raise InputError(f"the surface has no values {values!r}, but {names}: {_REMEDY}")
        given = known[values]
    array = as_numbers("values", given, _REMEDY)
    if array.ndim == 0 or len(array) != len(surface.vertices):
        raise InputError(
            f"{Option('values')} have the shape {array.shape}, and there are "
            f"{len(surface.vertices):,} vertices: {_REMEDY}"
        )
    return array


def over_values(surface: AnySurface, values: Values) -> AnySurface:
    """Make the surface whose heights are values, one of each vertex."""
    heights = values_of(surface, values)
    if heights.ndim != 1:
        raise InputError(
            f"{Option('values')} have the shape {heights.shape}: give one of each vertex, as a "
            "column of theirs"
        )
    planar = np.where(np.isfinite(surface.triangulation.points), surface.triangulation.points, 0.0)
    return replace(
        surface,
        vertices=np.column_stack([planar, heights]),
        frame=resolve_plane("xy", planar),
        crs=plane_system(surface),
    )


def columns_over(surface: AnySurface, values: Values) -> Iterator[AnySurface]:
    """Make such a surface of each column of values, (n, ...)."""
    array = values_of(surface, values)
    for column in array.reshape(len(array), -1).T:
        yield over_values(surface, column)


def heights_on_hull(surface: SurfaceData, places: Floats) -> Floats:
    """Return heights at the places of the convex hull nearest to others, NaN for places inside."""
    shapely = load("shapely", extra="shapes")
    hull = surface.triangulation.convex_hull
    corners = surface.triangulation.points[hull]
    heights = surface.frame.heights(surface.vertices)[hull]
    sides = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    tree = shapely.STRtree(shapely.linestrings(sides))
    side = tree.query_nearest(shapely.points(places), all_matches=False)[1]
    toward = sides[side, 1] - sides[side, 0]
    share = ((places - sides[side, 0]) * toward).sum(axis=1) / (toward * toward).sum(axis=1)
    share = share.clip(0, 1)
    found: Floats = heights[side] * (1 - share) + np.roll(heights, -1)[side] * share
    found[shapely.contains_xy(shapely.polygons(corners), places)] = np.nan
    return found
