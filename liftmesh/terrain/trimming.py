"""Trimming: faces left out of a surface, which keeps its triangulation.

A trimmed surface is a mask over the same triangles: nothing is triangulated again, and masks
compose. Long thin triangles along the hull, and those across bays, go without opening the gaps in
the middle if trimming begins at the boundary.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.options import as_number, as_switch
from liftmesh.errors import InputError, Option
from liftmesh.terrain.surface_data import AnySurface, SurfaceData, ordered_corners
from liftmesh.vector.polygons import contains, polygons_in


def trim(
    surface: AnySurface,
    *,
    max_edge: float | None,
    boundary_only: bool,
    max_radius: float | None,
    polygon: object,
) -> AnySurface:
    """Make a copy without some of the faces; vertices and triangulation stay as they are."""
    left_out = mask_of(surface).copy()
    corners = surface.triangulation.points[surface.triangulation.simplices]
    inwards = as_switch("boundary_only", boundary_only)
    if max_edge is None and max_radius is None and polygon is None:
        raise InputError(
            f"nothing is asked for: give {Option('max_edge')}, {Option('max_radius')} or a polygon"
        )
    if inwards and max_edge is None:
        raise InputError(f"{Option('boundary_only')} needs {Option('max_edge')}")
    if max_radius is not None:
        left_out |= _radii(corners) > _length("max_radius", max_radius)
    if polygon is not None:
        left_out |= ~contains(polygons_in(surface.crs, polygon), _centroids(corners))
    if max_edge is not None:
        is_long = _sides(corners) > _length("max_edge", max_edge)
        left_out = _from_rim(surface, is_long, left_out) if inwards else left_out | is_long.any(1)
    return masked(surface, left_out)


def boundary(surface: SurfaceData) -> list[Rows]:
    """Return the boundary of the faces as closed rings."""
    solved = surface.triangulation
    rows, starts = _kernel.rings(
        solved.points,
        np.ascontiguousarray(solved.simplices),
        np.ascontiguousarray(solved.neighbors),
        None if surface.mask is None else surface.mask.view(np.uint8),
    )
    return np.split(rows, starts[1:-1])


def mask_of(surface: SurfaceData) -> Array:
    """Return which triangles of the triangulation are left out."""
    if surface.mask is None:
        return np.zeros(surface.triangulation.nsimplex, dtype=np.bool_)
    return surface.mask


def masked(surface: AnySurface, left_out: Array) -> AnySurface:
    """Make a copy that leaves out faces; without any, its faces are the triangulation's own."""
    if left_out.all():
        raise InputError("no face is left: give larger limits, or a polygon over the faces")
    simplices = surface.triangulation.simplices
    if not left_out.any():
        return replace(surface, faces=simplices, mask=None)
    return replace(surface, faces=simplices[~left_out], mask=left_out)


def _from_rim(surface: SurfaceData, is_long: Array, left_out: Array) -> Array:
    """Leave out faces with a long side on the boundary, from there inwards."""
    flags = left_out.view(np.uint8)
    neighbors = np.ascontiguousarray(surface.triangulation.neighbors)
    _kernel.leave_out_from_rim(neighbors, is_long.view(np.uint8), flags)
    return flags.view(np.bool_)


def _sides(corners: Floats) -> Floats:
    """Compute the lengths of the sides opposite each corner, (m, 3)."""
    with np.errstate(over="ignore"):
        across = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        lengths: Floats = np.hypot(across[..., 0], across[..., 1])
    return lengths


def _radii(corners: Floats) -> Floats:
    """Compute the radii of circumcircles; the order of the corners changes no bit."""
    lengths = np.sort(_sides(corners), axis=1)
    a, b, c = np.moveaxis(ordered_corners(corners), 1, 0)
    with np.errstate(all="ignore"):
        # By a power of two, so that no square leaves the range of doubles.
        exponents = np.frexp(lengths[:, 2])[1]
        (bx, by), (cx, cy) = (np.ldexp(each - a, -exponents[:, None]).T for each in (b, c))
        short, middle, long = np.ldexp(lengths, -exponents[:, None]).T
        radii: Floats = np.ldexp(
            short * (middle / np.abs(bx * cy - by * cx)) * (long / 2), exponents
        )
    return np.where(np.isnan(radii), np.inf, radii)


def _centroids(corners: Floats) -> Floats:
    """Compute centroids; the order of the corners changes no bit."""
    a, b, c = np.moveaxis(ordered_corners(corners), 1, 0)
    centroids: Floats = a / 3 + b / 3 + c / 3
    return centroids


def _length(name: str, value: Any) -> float:
    return as_number(name, value, "a positive length", lambda length: length > 0)
