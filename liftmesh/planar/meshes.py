"""Clouds and meshes of other libraries as arrays: their points, and what `verify` checks."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import InputError


def rows_of(points: Any, *, has_heights: bool = False) -> Any:
    """Return the points of a cloud or mesh, and anything else as it is."""
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
    """Return the planar points and the triangles of a mesh."""
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
    from liftmesh.io.read import read_cloud  # noqa: PLC0415 - arrays do without

    cloud = read_cloud(mesh)
    if cloud.faces is None or not len(cloud.faces):
        what = repr(mesh) if isinstance(mesh, str | os.PathLike) else f"a {type(mesh).__name__}"
        raise InputError(
            f"{what} without triangles cannot be verified: give a mesh, or give simplices besides; "
            "simplices need the shape (m, 3)"
        )
    return cloud
