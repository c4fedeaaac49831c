"""The difference of two surfaces: a surface over the overlay of their triangulations.

Both are linear in each part that a face of one and a face of the other have in common, and so is
their difference. So its faces triangulate these parts (`overlay_mesh.py`): its rows are those of
both, and the crossings of their sides. Where rounding would fold them, they are constraints that
are split (`cutting.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Integers, Progress, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import check_progress, part_of
from liftmesh.errors import InputError
from liftmesh.planar.planarity import are_planar
from liftmesh.terrain.boundary import mask_of
from liftmesh.terrain.breaklines import check_exact, in_space
from liftmesh.terrain.cutting import Layer, Overlay
from liftmesh.terrain.measures import check_pair
from liftmesh.terrain.overlay_mesh import OverlayMesh, overlay_mesh
from liftmesh.terrain.report import bare_report
from liftmesh.terrain.surface import Surface
from liftmesh.terrain.triangulate import as_surface

if TYPE_CHECKING:
    from liftmesh.terrain.surface_data import SurfaceData

_LAID = 0.9  # of the time


def difference(
    surface: Surface,
    other: Surface,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Surface:
    """Subtract the heights of another surface: a surface where both have faces.

    Parameters
    ----------
    surface : Surface
        A surface over the plane "xy", "xz" or "yz", such as that after earthworks.
    other : Surface
        What is subtracted from it, over the same plane, such as that before. The surfaces need
        not have the same points, nor cover the same area.
    threads, progress : optional
        As for `triangulate`.

    Returns
    -------
    Surface
        Its heights are differences, exact in all faces of both but for rounding. Its rows are
        those of both that are in use, and the crossings of sides, by x, then y. What surfaces can
        do, it does: `raster` is a map of the differences, `filled_contours` with the level 0 has
        the polygons where the first surface is above and below, and `volume` the volumes, which
        are those of `cut_and_fill`. ``metadata["difference"]`` says how many ``rows_at_crossings``
        there are, and the largest ``displacement`` of rows from the sides that go through them,
        since they are rounded.

    Raises
    ------
    InputError
        The surfaces are over different planes or in different coordinate systems, have no area in
        common, or are one of ground and one of a file without any, of which all rows were read; or
        a difference is beyond the largest double.
    CrossingError
        Sides of faces as thin as the rounding of their corners are nearer to each other than
        doubles can tell apart.

    See Also
    --------
    Surface.cut_and_fill : The volumes alone, which takes less than half of the time.
    Surface.height_above : Of points.
    TiledSurface.raster : With ``minus=``, the difference of surfaces in tiles, as a raster alone.

    Notes
    -----
    Which sides cross is decided exactly; a crossing is rounded once. A vertex that is beside a side
    of the other surface by the rounding of its coordinates alone, as is common where both are in
    decimals (centimetres), is taken to be on it. Where both surfaces are exchanged, heights change
    their signs, and no other bit; neither does the order of the rows. Surfaces that nearly coincide
    are laid over each other with up to 128 units in the last place of the largest coordinate for
    rounding, and without faces that are flat within them. Where crossings come together all the
    same, sides are split until none cross, which takes some twenty times as long.

    Examples
    --------
    >>> import liftmesh
    >>> before = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
    >>> after = liftmesh.triangulate([[0, 0, -1], [4, 0, 3], [0, 4, -1], [4, 4, 3], [2, 2, 1]])
    >>> change = liftmesh.difference(after, before)
    >>> change.sample([[1, 1], [3, 2]]).tolist(), change.volume().net
    ([0.0, 2.0], 16.0)
    """
    check_pair(surface, other)
    check_exact(surface.frame)
    check_progress(progress)
    laid = overlay_mesh(surface, other, threads, part_of(progress, 0.0, _LAID))
    found = None if laid is None else _over(surface, laid, threads)
    if found is None:
        return _by_constraints(surface, other, part_of(progress, _LAID, 1.0))
    if progress is not None:
        progress(1.0)
    return found


def _over(surface: SurfaceData, laid: OverlayMesh, threads: int | None) -> Surface | None:
    """Make a surface of an overlay; None if faces of it overlap."""
    points = in_space(surface.frame, laid.points, _finite(laid.rises))
    told = {"rows_at_crossings": laid.crossings, "displacement": laid.displacement}
    if laid.triangulation is None:
        try:
            return _of_mesh(surface, points, laid.faces, told)
        except InputError:
            if are_planar(laid.points, laid.faces, threads):
                raise
            return None
    return Surface(
        vertices=points,
        faces=laid.faces,
        triangulation=laid.triangulation,
        frame=surface.frame,
        report=bare_report(len(points), len(laid.faces)),
        metadata={"difference": told},
        crs=surface.crs,
        mask=laid.mask,
    )


def _of_mesh(surface: SurfaceData, points: Floats, faces: Rows, told: dict[str, Any]) -> Surface:
    mesh = Cloud(points, faces=faces, crs=surface.crs, metadata={"difference": told})
    return as_surface(mesh, plane=surface.frame.name)


def _finite(heights: Floats) -> Floats:
    if not np.isfinite(heights).all():
        raise InputError("a difference is beyond the largest double: scale the coordinates")
    return heights


def _by_constraints(
    surface: SurfaceData, other: SurfaceData, progress: Progress | None = None
) -> Surface:
    """The same where both nearly coincide: their sides are split until none cross."""
    layers = [Layer.of(one, _near(one, two)) for one, two in [(surface, other), (other, surface)]]
    order = (1, 0) if layers[1].key < layers[0].key else (0, 1)  # either way gives the same
    laid = Overlay.of([layers[k] for k in order], progress=progress)
    over = [laid.faces(k) for k in order]
    common = (over[0] >= 0) & (over[1] >= 0)
    if not common.any():
        raise InputError("the surfaces have no area in common")
    faces = laid.tri.simplices[common]
    rows = used_rows(laid.tri.npoints, faces)
    rows = rows[np.lexsort(laid.tri.points[rows].T[::-1])]
    with np.errstate(over="ignore", invalid="ignore"):
        own, its = (
            laid.heights_within(k, faces)[rows] for k, faces in zip(order, over, strict=True)
        )
        heights = _finite(own - its)
    place = np.empty(laid.tri.npoints, dtype=np.int32)
    place[rows] = np.arange(len(rows), dtype=np.int32)
    is_own = np.zeros(laid.tri.npoints, dtype=np.bool_)
    is_own[np.concatenate([laid.rows(0), laid.rows(1)])] = True
    told = {
        "rows_at_crossings": int(np.count_nonzero(~is_own[rows])),
        "displacement": laid.tri.displacement,
    }
    points = in_space(surface.frame, laid.tri.points[rows], heights)
    return _of_mesh(surface, points, place.take(faces, axis=0), told)


def _near(surface: SurfaceData, other: SurfaceData) -> Integers:
    """Return the faces whose boxes touch that of another surface."""
    low, high = other.triangulation.min_bound, other.triangulation.max_bound
    corners = surface.triangulation.points.take(surface.triangulation.simplices, axis=0)
    touches = (corners.min(axis=1) <= high).all(axis=1) & (corners.max(axis=1) >= low).all(axis=1)
    near = np.flatnonzero(touches & ~mask_of(surface))
    if not len(near):
        raise InputError("the surfaces have no area in common")
    return near
