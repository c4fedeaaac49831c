"""Heights and slopes of a surface at points of its plane.

The kernel locates each point and interpolates in its face, or between the ends of an edge, by rules
that name coordinates only: no bit of a height depends on the order of the rows or of the points, on
the triangle by which an edge was reached, or on threads (`_core/surface/facet.hpp`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_pairs
from liftmesh.base.options import Interpolation, as_threads, check_option
from liftmesh.errors import InputError, Option
from liftmesh.terrain.surface_data import SurfaceData, kernel_surface
from liftmesh.terrain.units import steepness


def heights_at(
    surface: SurfaceData,
    points: ArrayLike,
    interpolation: Interpolation = "linear",
    *,
    threads: int | None = None,
) -> Floats:
    """Interpolate heights at points of the plane."""
    check_option("interpolation", interpolation, Interpolation)
    solved = surface.triangulation
    if interpolation != "linear" and (solved.metric is not None or hasattr(solved, "hidden")):
        raise InputError(
            f"{Option('interpolation')} {interpolation!r} needs a Delaunay triangulation, and the "
            f"surface has weights, radii or a metric: give {Option('interpolation', 'linear')}"
        )
    pairs = as_pairs(points)
    heights = np.empty(pairs.shape[:-1])
    kernel_surface(surface).sample(
        solved._locator,  # noqa: SLF001 - made once for all that is asked of it
        pairs.reshape(-1, 2),
        heights.reshape(-1),
        interpolation,
        *as_threads(threads, heights.size),
    )
    return heights[()]


def gradients_at(surface: SurfaceData, points: ArrayLike, *, threads: int | None = None) -> Floats:
    """Compute the gradient of the face at points of the plane."""
    pairs = as_pairs(points)
    gradients = np.empty(pairs.shape)
    kernel_surface(surface).gradients(
        surface.triangulation._locator,  # noqa: SLF001 - as above
        pairs.reshape(-1, 2),
        gradients.reshape(-1, 2),
        *as_threads(threads, gradients.size // 2),
    )
    return gradients


def slopes_at(
    surface: SurfaceData,
    points: ArrayLike,
    *,
    z_factor: float | None = None,
    threads: int | None = None,
) -> Floats:
    """Compute how steep the face is at points of the plane."""
    return slope_degrees(
        gradients_at(surface, points, threads=threads) * steepness(surface, z_factor)
    )


def aspects_at(surface: SurfaceData, points: ArrayLike, *, threads: int | None = None) -> Floats:
    """Compute which way the face descends at points of the plane."""
    return aspect_degrees(gradients_at(surface, points, threads=threads) * steepness(surface, None))


def slope_degrees(gradients: Floats) -> Floats:
    """Convert gradients to degrees from the plane."""
    slopes: Floats = np.degrees(np.arctan(np.hypot(gradients[..., 0], gradients[..., 1])))
    return slopes


def aspect_degrees(gradients: Floats) -> Floats:
    """Convert gradients to directions of descent."""
    east, north = -gradients[..., 0], -gradients[..., 1]
    turned = np.degrees(np.arctan2(east, north)) % 360
    is_level = (east == 0) & (north == 0)
    aspects: Floats = np.where(is_level, np.nan, np.where(turned == 360, 0.0, turned))
    return aspects[()]
