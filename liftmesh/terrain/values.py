"""Any surface operation on vertex values instead of heights."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_numbers
from liftmesh.errors import InputError, Option
from liftmesh.terrain.boundary import mask_of, masked
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.surface_data import AnySurface, SurfaceData, plane_system

Values: TypeAlias = "str | ArrayLike"
_REMEDY = "give the name of values of the vertices, or an array with a row for each"


def values_of(surface: SurfaceData, values: Values, *, one_each: bool = False) -> Floats:
    """Return values of the vertices, (n, ...) float64, by their name or as they are given."""
    given = values
    if isinstance(values, str):
        known = _named(surface)
        if values not in known:
            names = _names(surface, one_each=one_each)
            raise InputError(f"the surface has no values {values!r}, but {names}: {_REMEDY}")
        given = known[values]
    array = as_numbers("values", given, _REMEDY)
    if array.ndim == 0 or len(array) != len(surface.vertices):
        raise InputError(
            f"{Option('values')} have the shape {array.shape}, and there are "
            f"{len(surface.vertices):,} vertices: {_REMEDY}"
        )
    if not array[:1].size:
        raise InputError(f"{Option('values')} have the shape {array.shape}, so none: {_REMEDY}")
    objects = np.asarray(given)
    named = np.ndenumerate(objects) if objects.dtype.hasobject else ()
    row = next((at[0] for at, each in named if each is None), None)
    if row is not None:
        raise InputError(f"{Option('values')} hold None in row {row}: give NaN where there is none")
    return array


def _named(surface: SurfaceData) -> dict[str, Array]:
    """Return what names of values mean."""
    named = dict(surface.attributes)
    if surface.colors is not None:
        named.setdefault("colors", surface.colors)
    return named


def _names(surface: SurfaceData, *, one_each: bool) -> str:
    """Name the values that are numbers, or those with one for each vertex, in a message."""
    numbers = {key: each for key, each in _named(surface).items() if each.dtype.kind in "biuf"}
    usable = (key for key, each in numbers.items() if each.ndim == 1 or not one_each)
    return ", ".join(map(repr, sorted(usable))) or "none at all"


def over_values(surface: AnySurface, values: Values) -> AnySurface:
    """Make the surface whose heights are values, one of each vertex."""
    heights = values_of(surface, values, one_each=True)
    if heights.ndim != 1:
        if isinstance(values, str):
            each, single = heights[0].size, _names(surface, one_each=True)
            raise InputError(
                f"{Option('values', values)} has {each} numbers for each vertex: give values with "
                f"one, of which there are {single}"
            )
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


def over_known(surface: AnySurface, values: Values) -> AnySurface:
    """Make that surface of the faces whose corners all have a value."""
    over = over_values(surface, values)
    is_none = ~np.isfinite(over.vertices[:, 2])
    left_out = mask_of(over) | is_none.take(over.triangulation.simplices, axis=0).any(axis=1)
    if left_out.all():
        raise InputError(f"{Option('values')} are not finite at a corner of each face: {_REMEDY}")
    return masked(over, left_out) if is_none.any() else over
