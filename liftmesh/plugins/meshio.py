"""PLY with every bit and LandXML as formats of meshio.

>>> import meshio
>>> import liftmesh.plugins.meshio as plugin
>>> plugin.register()
>>> len(meshio.read("data/overhang.ply", file_format="liftmesh-ply").points)
25
>>> plugin.unregister()

After `register`, meshio knows the formats "liftmesh-ply" and "landxml". They have to be named, as
meshio has other formats of the same suffixes. Values of points, normals, colours (as red, green and
blue) and lines are kept; other cells than triangles and lines are an error.
"""

from __future__ import annotations

import os
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted
from liftmesh.errors import InputError
from liftmesh.io.read import read
from liftmesh.io.write import write
from liftmesh.optional import load

if TYPE_CHECKING:
    import meshio as host
else:
    host = load("meshio", extra="solvers")

_FORMATS = {"landxml": "xml", "liftmesh-ply": "ply"}
_NAMES = ("red", "green", "blue")


def register() -> None:
    """Add the formats to meshio's, until `unregister`.

    Calling it again changes nothing.

    See Also
    --------
    unregister : Undoes it.

    Examples
    --------
    >>> from liftmesh.plugins.meshio import register, unregister
    >>> register()
    >>> unregister()
    """
    unregister()
    for name, kind in _FORMATS.items():
        host.register_format(name, [], partial(_read, kind), {name: partial(_write, kind)})


def unregister() -> None:
    """Take the formats away from meshio.

    See Also
    --------
    register : What is undone.

    Examples
    --------
    >>> from liftmesh.plugins.meshio import unregister
    >>> unregister()  # where nothing is registered, nothing happens
    """
    for name in _FORMATS:
        host.deregister_format(name)


def _read(kind: str, source: Any) -> host.Mesh:
    cloud = read(source, format=kind)
    cells = [] if cloud.faces is None else [("triangle", cloud.faces)]
    if cloud.edges is not None and len(cloud.edges):
        cells.append(("line", cloud.edges))
    values = dict(cloud.attributes)
    if cloud.normals is not None:
        values["normals"] = cloud.normals
    if cloud.colors is not None:
        values |= dict(zip(_NAMES, cloud.colors.T, strict=True))
    return host.Mesh(cloud.points, cells, point_data=values)


def _write(kind: str, target: str | os.PathLike[str], mesh: host.Mesh, **options: Any) -> None:
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    values = {name: np.asarray(each) for name, each in mesh.point_data.items()}
    colors = [values.pop(name) for name in _NAMES] if values.keys() >= {*_NAMES} else None
    cloud = Cloud(
        points,
        colors=None if colors is None else np.stack(colors, axis=1),
        normals=values.pop("normals", None),
        attributes=values,
        faces=_cells_of(mesh, "triangle"),
        edges=_cells_of(mesh, "line"),
    )
    write(target, cloud, format=kind, overwrite=True, **options)


def _cells_of(mesh: host.Mesh, kind: str) -> Array | None:
    """Return the cells of one kind; raise if there are others than triangles and lines."""
    others = {each.type: len(each.data) for each in mesh.cells}
    others = {name: n for name, n in others.items() if name not in ("triangle", "line", "vertex")}
    if others:
        told = " and ".join(f"{counted(count, name)}" for name, count in others.items())
        raise InputError(f"a mesh of {told} cannot be written: give triangles and lines")
    found = [each.data for each in mesh.cells if each.type == kind]
    return np.concatenate(found).astype(np.int32) if found else None
