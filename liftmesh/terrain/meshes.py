"""Surfaces from meshes: the triangles of a file, with the triangulation that they are part of.

A triangle of a Delaunay triangulation is one of every subset of the points that holds its corners,
and of a regular one, too, by whose weights the metadata of a file say that it was made. So the
corners of a mesh that was triangulated, and perhaps trimmed, have a triangulation with all its
faces: it is made again, and what the mesh does not have is masked.

Other meshes, as those that follow lines, have sides that the Delaunay triangulation of their
corners lacks. These are all that must be asked for: a side that is Delaunay is in every constrained
triangulation whose edges it does not cross. But first those are asked for that the mesh states.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import pair_keys, pairs_of_keys, triangles_of_faces, used_rows
from liftmesh.errors import CrossingError, InputError
from liftmesh.io.columns import checked_edges, checked_faces, edges_of
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import read_cloud
from liftmesh.io.registry import known_formats
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import named_values
from liftmesh.planar.regular import regular
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.report import Report, report_on
from liftmesh.terrain.surface import Surface

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.triangulation import Triangulation


def as_surface(
    mesh: object, *, plane: str | ArrayLike = "xy", threads: int | None = None
) -> Surface:
    """Make a surface of a mesh, such as one that `triangulate` has written to a file.

    Parameters
    ----------
    mesh : object
        A file or an object with faces, as for `verify`; a `Surface` is returned as it is.
    plane : str or array_like, default "xy"
        The plane that it was triangulated on, as for `triangulate`.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    Surface
        All rows of the mesh are its vertices; rows in no face are skipped by its triangulation.
        Triangles that the mesh does not have, as one that was trimmed, are masked. Sides that are
        not Delaunay, as along breaklines, become constraints of the triangulation.

    Raises
    ------
    InputError
        The mesh has no faces, faces share a planar position but no row, faces overlap, or hold
        further corners; or one is no triangle of the regular triangulation, or the one in a metric,
        that the metadata say. So are many meshes that a format in single precision (GLB, glTF,
        STL) has rounded.
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

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
    >>> trimmed = liftmesh.triangulate(points).trim(max_edge=2)
    >>> as_surface(trimmed.to_cloud())
    <Surface of 2 triangles over 5 vertices>
    """
    if isinstance(mesh, Surface):
        return mesh
    cloud = read_cloud(mesh)
    if cloud.faces is None or not len(cloud.faces):
        raise InputError("there are no faces: triangulate the points")
    faces = checked_faces(cloud.faces, len(cloud), "the mesh")
    frame = resolve_plane(plane, cloud.points)
    planar = frame.planar(cloud.points).copy()
    used = used_rows(len(cloud), faces)
    _check(cloud, planar, used)
    planar[np.setdiff1d(np.arange(len(cloud)), used)] = np.nan
    solved = _solved(cloud, planar, threads)
    place = triangles_of_faces(solved.simplices, faces, len(cloud))
    edges = checked_edges(edges_of(cloud), len(cloud), "the mesh")
    if ((place < 0).any() or len(edges)) and not Provenance(cloud.metadata).lifted_by:
        for asked in _sides(solved, faces, edges):
            solved = _with_edges(solved, asked, planar, threads)
            place = triangles_of_faces(solved.simplices, faces, len(cloud))
            if (place >= 0).all():
                break
    if len(solved.duplicates):
        row, kept = solved.duplicates[0].tolist()
        raise InputError(
            f"rows {kept} and {row} of faces are at one planar position: {_remedy(cloud, 'points')}"
        )
    mask = _absent(place, solved.simplices, faces, cloud)
    kept_faces = solved.simplices if mask is None else solved.simplices[~mask]
    return Surface(
        vertices=cloud.points,
        faces=kept_faces,
        triangulation=solved,
        frame=frame,
        report=_report(solved, len(used), len(kept_faces), cloud),
        colors=cloud.colors,
        normals=cloud.normals,
        attributes=cloud.attributes,
        metadata=cloud.metadata,
        crs=cloud.crs,
        mask=mask,
    )


def _solved(cloud: Cloud, planar: Floats, threads: int | None) -> Triangulation:
    """Triangulate the corners by what the mesh says that it was triangulated by."""
    said = Provenance(cloud.metadata).lifted_by
    if "metric" in said or not said:
        form = said.get("metric")
        return delaunay(planar, nonfinite="skip", order="canonical", threads=threads, metric=form)
    ((kind, name),) = said.items()
    values: dict[str, Any] = {kind: named_values(cloud, kind, name)}
    return regular(planar, **values, nonfinite="skip", order="canonical", threads=threads)


def _sides(solved: Triangulation, faces: Rows, edges: Rows) -> tuple[Integers, Integers]:
    """Return the sides that are edges, and these with those that a triangulation does not have."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    sides = np.unique(pair_keys(*ends.T))
    missing = np.setdiff1d(sides, pair_keys(*solved.edges.T), assume_unique=True)
    stated = np.intersect1d(sides, pair_keys(*np.sort(edges, axis=1).T))
    return stated, np.union1d(missing, stated)


def _with_edges(
    solved: Triangulation, asked: Integers, planar: Floats, threads: int | None
) -> Triangulation:
    """Triangulate the corners with edges."""
    if not len(asked):
        return solved
    edges = np.stack(pairs_of_keys(asked), axis=1).astype(np.int32)
    try:
        return constrained_delaunay(
            planar, edges, nonfinite="skip", order="canonical", threads=threads
        )
    except CrossingError:
        return solved  # faces that overlap: the first that it does not have is named


def _check(cloud: Cloud, planar: Floats, used: Rows) -> None:
    """Raise for corners that are not finite."""
    finite = np.isfinite(planar[used]).all(axis=1) & np.isfinite(cloud.points[used]).all(axis=1)
    if not finite.all():
        row = int(used[np.argmin(finite)])
        raise InputError(f"row {row} of a face is not finite: {cloud.points[row].tolist()}")


def _absent(place: Integers, simplices: Rows, faces: Rows, cloud: Cloud) -> Array | None:
    """Tell which triangles the mesh does not have; raise if it has others."""
    if (place < 0).any():
        number = int(np.argmin(place))
        raise InputError(
            f"face {number}, of the rows {faces[number].tolist()}, is no triangle of the Delaunay "
            f"triangulation of the vertices, nor of one with its sides as constraints: "
            f"{_remedy(cloud, 'vertices')}"
        )
    absent = np.ones(len(simplices), dtype=np.bool_)
    absent[place] = False
    return absent if absent.any() else None


def _remedy(cloud: Cloud, points: str) -> str:
    """Say what to do about faces; of a format that rounds, why they are not those written."""
    is_read = Provenance(cloud.metadata).is_read
    origin = known_formats().get(cloud.metadata["format"]) if is_read else None
    if origin is None or "float64" in origin.keeps:
        return f"triangulate the {points}"
    return (
        f"triangulate the {points}; the file holds single precision, which has moved them: write "
        "PLY for faces that are found again"
    )


def _report(solved: Any, used: int, triangles: int, cloud: Cloud) -> Report:
    unused = len(cloud) - used
    return report_on(
        cloud,
        n_used=used,
        n_duplicates=0,
        n_overhangs=0,
        n_skipped=0,
        n_triangles=triangles,
        policy="error",
        seconds={},
        left_out=solved.skipped,
        representatives=np.full(unused, -1, dtype=np.int32),
        n_unused=unused,
    )
