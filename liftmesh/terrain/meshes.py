"""Surfaces from meshes: any triangles that are a planar triangulation seen from above.

A triangle of a Delaunay triangulation is one of every subset of the points that holds its corners,
and of a regular one, too, by whose weights the metadata of a file say that it was made. So the
corners of a mesh that was triangulated, and perhaps trimmed, have a triangulation with all its
faces: it is made again, and what the mesh does not have is masked.

Other meshes, as those that follow lines or were smoothed, have faces of their own (`own_faces.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.options import OwnFaces, check_option
from liftmesh.errors import InputError
from liftmesh.io.columns import checked_edges, checked_faces, edges_of
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import read_cloud
from liftmesh.io.registry import known_formats
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import named_values
from liftmesh.planar.regular import regular
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.lifting import without_former
from liftmesh.terrain.own_faces import Found, found_in, with_faces
from liftmesh.terrain.report import Report, report_on
from liftmesh.terrain.surface import Surface

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.triangulation import Triangulation


def as_surface(
    mesh: object,
    *,
    plane: str | ArrayLike = "xy",
    triangulation: OwnFaces | None = None,
    threads: int | None = None,
) -> Surface:
    """Make a surface of a mesh: of any whose faces do not overlap seen from above.

    The mesh may be one that `triangulate` has written, or have been smoothed, subdivided, trimmed
    or made by any other program, in one piece or several, with holes.

    Parameters
    ----------
    mesh : object
        A file or an object with faces, as for `verify`; a `Surface` is returned as it is.
    plane : str or array_like, default "xy"
        The plane that it was triangulated on, as for `triangulate`.
    triangulation : "own", optional
        With "own" the faces are taken as they are. By default they are first sought where the
        metadata of the mesh say, as in a regular triangulation by its weights.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    Surface
        All rows of the mesh are its vertices; rows in no face are skipped by its triangulation. Of
        rows at one position and height the first counts, as in a file whose triangles share no
        vertices. The faces are those of the mesh, turned counter-clockwise, in the order of the
        triangulation. Triangles that the mesh does not have, as one that was trimmed, are masked.
        Sides that are not Delaunay, as along breaklines, become constraints of the triangulation:
        it has none if the mesh is Delaunay.

    Raises
    ------
    InputError
        The mesh has no faces; a face is vertical or its corners are on a line; rows of faces share
        a planar position at different heights; or faces overlap seen from above, or have a vertex
        inside a side: then the first face that conflicts with an earlier one is named, with the
        first of these. Some meshes that a format in single precision (GLB, glTF, STL) has rounded
        are such.
    UnsupportedTypeError
        No adapter can convert the object to a cloud.
    FormatError
        A file cannot be read.
    OSError
        A file does not exist or cannot be opened.

    See Also
    --------
    Surface.to_cloud : The way back.
    triangulate : Makes surfaces of clouds.
    verify : Checks a mesh without making a surface.

    Notes
    -----
    Whether faces overlap is decided exactly, in O(m log m) for m faces: `orient2d` tells that none
    has another orientation or no area, and a sweep over the boundary that they cover no place
    twice (M. I. Shamos and D. Hoey, 1976).

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
    >>> trimmed = liftmesh.triangulate(points).trim(max_edge=2)
    >>> as_surface(trimmed.to_cloud())
    <Surface of 2 triangles over 5 vertices>

    A mesh that is not Delaunay, and one that folds over:

    >>> kite = [[0, 0, 0], [4, -1, 1], [8, 0, 0], [4, 1, 1]]
    >>> mesh = liftmesh.Cloud(np.array(kite), faces=np.array([[0, 1, 2], [0, 2, 3]]))
    >>> as_surface(mesh).sample([[4, 0], [4, 0.5]])
    array([0. , 0.5])
    >>> as_surface(liftmesh.Cloud(mesh.points, faces=np.array([[0, 1, 2], [0, 1, 3]])))
    Traceback (most recent call last):
        ...
    liftmesh.errors.InputError: face 0, of the rows [0, 1, 2], and face 1, of ... overlap seen ...
    """
    if isinstance(mesh, Surface):
        return mesh
    if triangulation is not None:
        check_option("triangulation", triangulation, OwnFaces)
    cloud = read_cloud(mesh)
    if cloud.faces is None or not len(cloud.faces):
        raise InputError("there are no faces: triangulate the points")
    faces = checked_faces(cloud.faces, len(cloud), "the mesh")
    frame = resolve_plane(plane, cloud.points)
    planar = frame.planar(cloud.points).copy()
    used = used_rows(len(cloud), faces)
    _check(cloud, planar, used)
    planar[np.delete(np.arange(len(cloud)), used)] = np.nan
    lifted = None if triangulation == "own" else _lifted(cloud, planar, threads)
    found = None if lifted is None else found_in(lifted, faces)
    if found is None:
        cloud = without_former(cloud)
        edges = checked_edges(edges_of(cloud), len(cloud), "the mesh")
        solved = delaunay(planar, nonfinite="skip", order="canonical", threads=threads)
        heights = frame.heights(cloud.points)
        found = with_faces(solved, faces, heights, edges, _remedy(cloud), threads)
    return Surface(
        vertices=cloud.points,
        faces=found.faces,
        triangulation=found.solved,
        frame=frame,
        report=_report(found, cloud),
        colors=cloud.colors,
        normals=cloud.normals,
        attributes=cloud.attributes,
        metadata=cloud.metadata,
        crs=cloud.crs,
        mask=found.mask,
    )


def _lifted(cloud: Cloud, planar: Floats, threads: int | None) -> Triangulation | None:
    """Triangulate the corners by what the mesh says that it was triangulated by, if anything."""
    said = Provenance(cloud.metadata).lifted_by
    if not said:
        return None
    if "metric" in said:
        form = said["metric"]
        return delaunay(planar, nonfinite="skip", order="canonical", threads=threads, metric=form)
    ((kind, name),) = said.items()
    values: dict[str, Any] = {kind: named_values(cloud, kind, name)}
    return regular(planar, **values, nonfinite="skip", order="canonical", threads=threads)


def _check(cloud: Cloud, planar: Floats, used: Rows) -> None:
    """Raise for corners that are not finite."""
    finite = np.isfinite(planar[used]).all(axis=1) & np.isfinite(cloud.points[used]).all(axis=1)
    if not finite.all():
        row = int(used[np.argmin(finite)])
        raise InputError(f"row {row} of a face is not finite: {cloud.points[row].tolist()}")


def _remedy(cloud: Cloud) -> str:
    """Say what to do about faces; of a format that rounds, what may have moved them."""
    is_read = Provenance(cloud.metadata).is_read
    origin = known_formats().get(cloud.metadata["format"]) if is_read else None
    if origin is None or "float64" in origin.keeps:
        return "triangulate the vertices"
    return (
        "triangulate the vertices; the file holds single precision, which has moved them: write "
        "PLY for faces that are found again"
    )


def _report(found: Found, cloud: Cloud) -> Report:
    row, kept = found.solved.duplicates.T
    unused = len(found.solved.skipped)
    left_out = np.sort(np.concatenate([found.solved.skipped, row]))
    representatives = np.full(len(left_out), -1, dtype=np.int32)
    representatives[np.searchsorted(left_out, row)] = kept
    return report_on(
        cloud,
        n_used=len(cloud) - len(left_out),
        n_duplicates=len(row),
        n_overhangs=0,
        n_skipped=0,
        n_triangles=len(found.faces),
        policy="error",
        seconds={},
        left_out=left_out,
        representatives=representatives,
        n_unused=unused,
    )
