"""`SurfaceData`: the fields of a surface, its units, and helpers shared by this package.

Among it are the units of x, y and heights: what they are in metres, and how steep that makes a
gradient. Surveys with metres in the plane and feet in height exist, and in feet of two kinds.
Angles and areas in space compare heights with lengths, so heights are converted first, as far as
the coordinate system and the band of a raster say the units; where they do not, the caller may.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import as_pairs, planar_bounds
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import kept_depth
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import as_positive
from liftmesh.crs.comparison import are_different, common_system, crs_of
from liftmesh.crs.units import Placed, band_unit, system_of
from liftmesh.errors import InputError, Option
from liftmesh.io.metadata import with_carved

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.frame import Frame
    from liftmesh.terrain.report import Report


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SurfaceData(FrozenResult):
    """The fields of a `Surface`: read-only arrays, of which `Surface.replace` makes changed copies.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float64
        All rows of the input in their order: a view of the caller's array if that is float64, which
        writes to that array change.
    faces : (m, 3) ndarray of int32
        Triangles as rows of ``vertices``, counter-clockwise seen from above the plane.
    triangulation : Triangulation
        The planar problem and its solution. Its ``simplices`` are the faces, unless some are left
        out: at a shared planar position it has the row that ``report`` names, whose height is the
        surface's.
    frame : Frame
        The projection plane and its axes.
    report : Report
        Summary of the use of every row.
    colors : (n, 3) or (n, 4) ndarray, optional
        Colours of the vertices.
    normals : (n, 3) ndarray, optional
        Normals of the input's rows, unchanged.
    attributes : mapping of str to (n, ...) ndarray
        Further named values of the vertices.
    metadata : mapping
        Information about the input as a whole.
    crs : str, optional
        The coordinate reference system of the input: WKT or ``EPSG:n``.
    mask : (t,) ndarray of bool, optional
        True for the triangles of ``triangulation`` that are no faces, as `trim` leaves them out;
        None if all are.

    See Also
    --------
    triangulate : Makes surfaces of clouds.
    as_surface : Of meshes.
    TiledSurface : Of clouds larger than memory.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 1, 8]])
    <Surface of 2 triangles over 4 vertices>
    """

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


HIDDEN = "hidden"  # the values that say which rows weights or radii hide
AnySurface = TypeVar("AnySurface", bound=SurfaceData)  # of functions that change one


def as_cloud(surface: SurfaceData) -> Cloud:
    """Convert the surface to a cloud with faces.

    Parameters
    ----------
    surface : Surface
        What is converted; both share their arrays.

    Returns
    -------
    Cloud
        The same arrays, without the triangulation and the report.

    See Also
    --------
    as_surface : The way back.
    Surface.save : Write the surface to a file.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
    >>> surface.to_cloud().faces.shape
    (1, 3)
    """
    edges = getattr(surface.triangulation, "constraints", None)
    return Cloud(
        points=surface.vertices,
        colors=surface.colors,
        normals=surface.normals,
        attributes=surface.attributes,
        faces=surface.faces,
        metadata=with_carved(surface.metadata, edges is not None and surface.mask is not None),
        crs=surface.crs,
        color_depth=kept_depth(surface.colors),
        edges=edges,
    )


def kernel_surface(surface: SurfaceData, heights: Floats | None = None) -> _kernel.Relief:
    """Hand a surface over to the kernel, which shares its arrays; or with others for heights."""
    solved = surface.triangulation
    return _kernel.Relief(
        solved.points,
        np.ascontiguousarray(solved.simplices),
        np.ascontiguousarray(solved.neighbors),
        surface.frame.heights(surface.vertices) if heights is None else heights,
        None if surface.mask is None else surface.mask.view(np.uint8),
    )


def bounds_of_faces(surface: SurfaceData) -> tuple[float, float, float, float]:
    """Return xmin, ymin, xmax and ymax of the faces."""
    solved = surface.triangulation
    corners = solved.convex_hull if surface.mask is None else surface.faces.ravel()
    return planar_bounds(solved.points.take(corners, axis=0))


def plane_system(surface: OverPlane) -> str | None:
    """Return the coordinate system of the plane: none if the plane is not that of x and y."""
    return surface.crs if surface.frame.name == "xy" else None


def places_on(surface: OverPlane, points: ArrayLike) -> Floats:
    """Convert points of the plane to pairs; raise if they say they are in another system."""
    common_system(crs_of(points), plane_system(surface), ("the points", "the surface"))
    return as_pairs(points)


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


class OverPlane(Placed, Protocol):
    """What is over a plane, in a coordinate system: a surface, in memory or in tiles."""

    @property
    def frame(self) -> Frame:
        """The plane."""


_AXES = {"xy": (0, 1, 2), "xz": (0, 2, 1), "yz": (1, 2, 0)}


def metres_of(surface: OverPlane) -> tuple[float, float, float] | None:
    """Return how many metres the units of both planar coordinates and of heights have."""
    system = system_of(surface)
    units = () if system is None else system.units
    metres = [each.metres for each in units if each is not None and each.metres is not None]
    if len(metres) != 3:
        return None
    axes = _AXES.get(surface.frame.name)
    if axes is None:
        return (metres[0],) * 3 if len({*metres}) == 1 else None
    x, y, z = (metres[axis] for axis in axes)
    return x, y, z


def unit_names(surface: OverPlane) -> tuple[str | None, str | None]:
    """Return the names of the unit in the plane and of that of heights."""
    system = system_of(surface)
    axes = _AXES.get(surface.frame.name)
    if axes is None:
        return None, None
    if system is None:
        band = band_unit(surface) if axes[2] == 2 else None
        return None, None if band is None else band.name
    x, y, z = (None if unit is None else unit.name for unit in (system.units[k] for k in axes))
    return (x if x == y else None), z


def check_planes(surface: OverPlane, other: OverPlane) -> None:
    """Raise for surfaces that are not over one plane in one system."""
    one, two = surface.frame, other.frame
    if not (np.array_equal(one.axes, two.axes) and np.array_equal(one.origin, two.origin)):
        raise InputError("the surfaces are over different planes: give both the same")
    if are_different(surface.crs, other.crs):
        raise InputError(
            "the surfaces have different coordinate systems: read both with the "
            f"same {Option('dst_crs', ...)}, or the same {Option('src_crs', ...)} if they are in it"
        )


def slope_scale(surface: OverPlane, z_factor: float | None) -> tuple[float, float]:
    """Return what gradients are multiplied by before they become angles."""
    if z_factor is not None:
        factor = as_positive("z_factor", z_factor, "a positive number")
        return factor, factor
    x, y, z = metres_of(surface) or (1.0, 1.0, 1.0)
    return z / x, z / y


def steepness(surface: OverPlane, z_factor: float | None) -> tuple[float, float]:
    """Return `slope_scale` for slopes, which x and y in degrees have only by a factor."""
    system = system_of(surface)
    axes = _AXES.get(surface.frame.name, (0, 1))[:2]
    units = [] if system is None else [system.units[axis] for axis in axes]
    if z_factor is None and any(each is not None and each.metres is None for each in units):
        raise InputError(
            "x and y are degrees, which are no lengths, so slopes and aspects are wrong: read the "
            f"points with {Option('dst_crs', ...)} a projected system, or give "
            f"{Option('z_factor', ...)}"
        )
    return slope_scale(surface, z_factor)
