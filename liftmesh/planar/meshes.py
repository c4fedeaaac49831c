"""Clouds and meshes of other libraries as arrays: their points, and what `verify` checks."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import InputError


def rows_of(points: Any, *, has_heights: bool = False) -> Any:
    """Return the points of a cloud or mesh, and anything else as it is, for arrays to be made of.

    Parameters
    ----------
    points : object
        As for `delaunay`.
    has_heights : bool
        Whether z counts, and a table needs a column that is known as the height.

    Returns
    -------
    array_like
        For lists, and arrays without named fields, the same object.

    Raises
    ------
    UnsupportedTypeError
        It is a path.

    Examples
    --------
    >>> import liftmesh
    >>> rows_of(liftmesh.Cloud(np.zeros((1, 3))))
    array([[0., 0., 0.]])
    """
    if isinstance(points, np.ndarray):
        is_record = points.dtype.names is not None
    else:
        is_record = not isinstance(points, list | tuple)
    if not is_record:
        return points
    from liftmesh.io import registry  # noqa: PLC0415 - arrays do without

    return registry.rows_of(points, has_heights=has_heights)


def points_and_triangles(
    mesh: Any, *, told: bool = False
) -> tuple[Array, Array, bool, dict[str, Any]]:
    """Return the planar points and the triangles of a mesh.

    Parameters
    ----------
    mesh : object
        As for `verify`.
    told : bool, default False
        Whether the caller says by what it was triangulated, and it is not asked.

    Returns
    -------
    points : (n, 2) or (n, 3) ndarray
        Planar points; a third column is to be ignored.
    triangles : (m, 3) ndarray
        Rows of the points.
    skipping : bool
        Whether rows that are not finite were skipped when the mesh was made.
    lifted_by : dict
        Weights, radii, a metric or the farthest site by which it was triangulated: at most one, as
        an option of `verify`; none if the caller told it.

    Raises
    ------
    InputError
        There are no triangles.
    UnsupportedTypeError
        The object is no mesh.
    FormatError
        A file cannot be read.

    Examples
    --------
    >>> import liftmesh
    >>> _, triangles, *_ = points_and_triangles(liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]))
    >>> triangles
    array([[0, 1, 2]], dtype=int32)
    """
    from liftmesh.planar.member import options_of  # noqa: PLC0415 - a first triangulation does without

    solved = getattr(mesh, "triangulation", None)  # of a `Surface`, whose plane may be any
    said = (lambda _: {}) if told else options_of
    lifted_by = said(mesh if solved is None else solved)
    if solved is not None and hasattr(mesh, "faces"):
        return solved.points, mesh.faces, len(solved.skipped) > 0, lifted_by
    if hasattr(mesh, "points") and hasattr(mesh, "simplices"):
        return mesh.points, mesh.simplices, len(getattr(mesh, "skipped", ())) > 0, lifted_by
    if hasattr(mesh, "get_masked_triangles"):  # of matplotlib
        return np.column_stack([mesh.x, mesh.y]), mesh.get_masked_triangles(), False, {}
    cloud = _as_mesh(mesh)
    return cloud.points, cloud.faces, False, said(cloud)


def _as_mesh(mesh: Any) -> Any:
    from liftmesh.io.files import read_cloud  # noqa: PLC0415 - arrays do without

    cloud = read_cloud(mesh)
    if cloud.faces is None or not len(cloud.faces):
        what = repr(mesh) if isinstance(mesh, str | os.PathLike) else f"a {type(mesh).__name__}"
        raise InputError(
            f"{what} without triangles cannot be verified: give a mesh, or give simplices besides; "
            "simplices need the shape (m, 3)"
        )
    return cloud
