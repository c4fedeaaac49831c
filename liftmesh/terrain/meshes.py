"""Surfaces from meshes: any triangles that are a planar triangulation seen from above."""

from __future__ import annotations

from numpy.typing import ArrayLike

from liftmesh.base.options import OwnFaces, check_option
from liftmesh.io.read import read_cloud
from liftmesh.terrain.own_faces import fields_of
from liftmesh.terrain.surface import Surface


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
    >>> import numpy as np
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
    return Surface(**fields_of(read_cloud(mesh), plane, triangulation, threads))
