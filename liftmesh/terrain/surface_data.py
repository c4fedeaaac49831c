"""The data of a surface, which the functions of this room take, and what several ask of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import kept_depth
from liftmesh.base.frozen import FrozenResult

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.frame import Frame
    from liftmesh.terrain.report import Report


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SurfaceData(FrozenResult):
    """The fields of a `Surface`, which describes them."""

    vertices: Floats
    faces: Rows
    triangulation: Triangulation
    frame: Frame
    report: Report
    colors: Array | None = None
    normals: Array | None = None
    attributes: Mapping[str, Array] = field(default_factory=dict)
    metadata: Mapping[str, Any] = field(default_factory=dict)
    crs: str | None = None
    mask: Array | None = None


AnySurface = TypeVar("AnySurface", bound=SurfaceData)  # of functions that change one


def as_cloud(surface: SurfaceData) -> Cloud:
    """Convert a surface to a cloud with faces; both share their arrays."""
    return Cloud(
        points=surface.vertices,
        colors=surface.colors,
        normals=surface.normals,
        attributes=surface.attributes,
        faces=surface.faces,
        metadata=surface.metadata,
        crs=surface.crs,
        color_depth=kept_depth(surface.colors),
    )


def kernel_surface(surface: SurfaceData) -> _kernel.Relief:
    """Hand a surface over to the kernel, which shares its arrays."""
    solved = surface.triangulation
    return _kernel.Relief(
        solved.points,
        np.ascontiguousarray(solved.simplices),
        np.ascontiguousarray(solved.neighbors),
        surface.frame.heights(surface.vertices),
        None if surface.mask is None else surface.mask.view(np.uint8),
    )


def plane_system(surface: SurfaceData) -> str | None:
    """Return the coordinate system of the plane: none if the plane is not that of x and y."""
    return surface.crs if surface.frame.name == "xy" else None


def positions_of(surface: SurfaceData) -> tuple[Rows, Floats, Rows]:
    """Return the rows in use, their planar positions, and which of these are on the hull."""
    is_used = np.ones(len(surface.vertices), np.bool_)
    is_used[surface.report.left_out] = False
    used = np.flatnonzero(is_used).astype(np.int32)
    place = np.empty(len(is_used), np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    points = np.ascontiguousarray(surface.triangulation.points[used], np.float64) + 0.0
    return used, points, place[surface.triangulation.convex_hull]


def corner_order(corners: Floats) -> Array:
    """Order the corners of each face, (m, 3, 2), by x, then y: whatever the order of the rows."""
    by_y = np.argsort(corners[..., 1], axis=1, kind="stable")
    by_x = np.argsort(np.take_along_axis(corners[..., 0], by_y, 1), axis=1, kind="stable")
    return np.take_along_axis(by_y, by_x, axis=1)


def ordered_corners(corners: Floats) -> Floats:
    """Put the corners of each face, (m, 3, 2), in that order."""
    return np.take_along_axis(corners, corner_order(corners)[..., None], axis=1)
