"""PyVista: conversion from datasets, and to `pyvista.PolyData`.

Everything is copied: VTK may move the memory of an array that grows. Colours are the point data
"RGB" or "RGBA", as PyVista's own readers name them, and normals are "Normals"; the coordinate
system is the first entry of the field data "crs". Triangles and lines of a `PolyData` are the faces
and edges, and the triangles of an `UnstructuredGrid`; other polygons are divided by PyVista.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Rows
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.colors import as_uint8
from liftmesh.errors import InputError, MissingDependencyError
from liftmesh.io.columns import edges_of
from liftmesh.io.markup import ascii_string, parsed_or_none
from liftmesh.io.metadata import Unread, noted
from liftmesh.optional import load

if TYPE_CHECKING:
    import pyvista

_SHADES = ("RGBA", "RGB")
_NORMALS, _SYSTEM = "Normals", "crs"
_TRIANGLE = 5  # of VTK's kinds of cells
_OLDEST = [0, 48]  # has accessors, readers and writers of others


def to_cloud(source: Any) -> Cloud:
    """Convert a dataset of PyVista to a cloud."""
    values = {name: np.array(source.point_data[name]) for name in source.point_data}
    shades = next((name for name in _SHADES if _are_shades(values.get(name))), "")
    normals = values.get(_NORMALS)
    if normals is not None and (normals.dtype.kind != "f" or normals.shape[1:] != (3,)):
        normals = None
    edges = edges_of_lines(getattr(source, "lines", ()))
    unread = Unread(f"cell data {name}" for name in source.cell_data)
    return Cloud(
        points=np.array(source.points, dtype=np.float64),
        colors=values.pop(shades, None),
        normals=None if normals is None else values.pop(_NORMALS),
        attributes=values,
        faces=faces_of(source),
        edges=edges if len(edges) else None,
        crs=_system(source),
        metadata=noted({}, not_read=unread) if unread else {},
    )


def to_pyvista(cloud: Cloud) -> pyvista.PolyData:
    """Convert a cloud, with faces and edges if any, to a dataset of PyVista.

    Parameters
    ----------
    cloud : Cloud
        The points, in float64 or float32, with their values.

    Returns
    -------
    pyvista.PolyData
        Every point in its place; triangles, lines, point data, and the coordinate system as field
        data "crs". Points of a cloud without faces and edges are cells, as PyVista makes them.

    Raises
    ------
    InputError
        Values have a type that PyVista does not hold, or a name of its own.
    MissingDependencyError
        PyVista is not installed, or too old.

    See Also
    --------
    liftmesh.as_cloud : The way back.

    Examples
    --------
    >>> import liftmesh
    >>> from liftmesh.io.objects.pyvista import to_pyvista
    >>> to_pyvista(liftmesh.read("data/quad.xyz")).n_points
    4
    """
    mesh: pyvista.PolyData = library().PolyData(np.array(cloud.points))
    edges = edges_of(cloud)
    if cloud.faces is not None or len(edges):
        mesh.verts = np.empty(0, dtype=np.int64)
    if cloud.faces is not None:
        mesh.regular_faces = cloud.faces.astype(np.int64)
    if len(edges):
        mesh.lines = np.insert(edges.astype(np.int64), 0, 2, axis=1).reshape(-1)
    for name, values in {**_named(cloud), **_appearance(cloud)}.items():
        mesh.point_data[name] = values
    if cloud.crs is not None:
        is_plain = cloud.crs.isascii() and cloud.crs.isprintable()
        mesh.field_data[_SYSTEM] = [cloud.crs if is_plain else ascii_string(cloud.crs)]
    return mesh


def library() -> Any:
    """Import PyVista, or say what to install."""
    host = load("pyvista", extra="pyvista")
    if [*map(int, re.findall(r"\d+", host.__version__)[:2])] < _OLDEST:
        raise MissingDependencyError(
            f"PyVista {host.__version__} is older than 0.48: pip install -U 'liftmesh[pyvista]'"
        )
    return host


def faces_of(source: Any) -> Rows | None:
    """Return the triangles of a dataset; None if it has none."""
    if hasattr(source, "cells_dict"):
        found = source.cells_dict.get(_TRIANGLE)
    elif hasattr(source, "GetNumberOfPolys") and source.GetNumberOfPolys() + source.n_strips:
        found = (source if source.is_all_triangles else source.triangulate()).regular_faces
    else:
        found = None
    return None if found is None else np.array(found, dtype=np.int32)


def corners_of(cells: Any) -> list[Array]:
    """Split VTK's list of cells, each after its number of corners."""
    given, found, place = np.asarray(cells), [], 0
    while place < len(given):
        end = place + 1 + int(given[place])
        found.append(given[place + 1 : end])
        place = end
    return found


def edges_of_lines(lines: Any) -> Rows:
    """Return pairs of rows of VTK's list of lines."""
    given = np.asarray(lines)
    if len(given) % 3 == 0 and (given[::3] == 2).all():
        return given.reshape(-1, 3)[:, 1:].astype(np.int32)
    pairs = [np.stack([each[:-1], each[1:]], axis=1) for each in corners_of(given)]
    return np.concatenate(pairs).astype(np.int32)


def _are_shades(values: Array | None) -> bool:
    return values is not None and values.dtype == np.uint8 and values.shape[1:] in {(3,), (4,)}


def _system(source: Any) -> str | None:
    if _SYSTEM not in source.field_data or not len(found := source.field_data[_SYSTEM]):
        return None
    text = str(found[0])
    stated = parsed_or_none(text) if text.startswith('"') else text
    return str(stated) if is_crs(stated) else None


def _named(cloud: Cloud) -> dict[str, Array]:
    for name, values in cloud.attributes.items():
        if values.dtype.kind not in "biufU" or not _is_ascii(values):
            raise InputError(
                f"the values {name!r} are of {values.dtype}: leave them out, or give numbers or "
                "texts in ASCII, which PyVista holds"
            )
        if (
            not name
            or "\0" in name
            or name.encode(errors="replace") != name.encode(errors="surrogatepass")
        ):
            raise InputError(f"values are named {name!r}, as none can be in PyVista: rename them")
    return {name: _held(values) for name, values in cloud.attributes.items() if values.size}


def _is_ascii(values: Array) -> bool:
    return values.dtype.kind != "U" or all(each.isascii() for each in values.reshape(-1).tolist())


def _held(values: Array) -> Array:
    """Make values of a type and shape that VTK has; it takes any order of bytes for its own."""
    values = values.astype(values.dtype.newbyteorder("="))
    if values.dtype.kind == "f" and values.dtype.itemsize not in {4, 8}:
        values = values.astype(np.float32 if values.dtype.itemsize == 2 else np.float64)
    return values if values.ndim < 3 else values.reshape(len(values), -1)


def _appearance(cloud: Cloud) -> dict[str, Array]:
    found: dict[str, Array] = {}
    if cloud.colors is not None and len(cloud):
        found["RGB" if cloud.colors.shape[1] == 3 else "RGBA"] = as_uint8(cloud.colors)
    if cloud.normals is not None and len(cloud):
        found[_NORMALS] = _held(cloud.normals)
    if taken := found.keys() & cloud.attributes.keys():
        raise InputError(f"an attribute is named {min(taken)!r}, as PyVista's own: rename it")
    return found
