"""Files of the formats that liftmesh only writes, as other libraries read them, or by hand."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import lib3mf
import meshio
import numpy as np
import xarray

from liftmesh import Cloud, InputError
from liftmesh.io.format import checked_origin, with_origin
from liftmesh.io.metadata import Label


def three_mf(data: bytes) -> Cloud:
    """Read vertices and triangles with lib3mf, strictly, and the origin in the metadata."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.3mf")
        path.write_bytes(data)
        model = lib3mf.get_wrapper().CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(True)
        try:
            reader.ReadFromFile(str(path))
        except lib3mf.Lib3MF.ELib3MFException as error:
            if not str(error).endswith("Invalid Model Coordinates"):
                raise
            raise InputError("lib3mf reads no coordinates beyond 10^9") from error
    assert reader.GetWarningCount() == 0, "lib3mf warns"
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext(), "there is no mesh"
    found = meshes.GetCurrentMeshObject()
    points = np.array([each.Coordinates[:] for each in found.GetVertices()], np.float64)
    faces = np.array([each.Indices[:] for each in found.GetTriangleIndices()], np.int32)
    notes = model.GetMetaDataGroup()
    stated = [notes.GetMetaData(k).GetValue() for k in range(notes.GetMetaDataCount())]
    cloud = Cloud(points, faces=faces, metadata={"source": Label("stream"), "format": Label("3mf")})
    origin = [float(word) for word in stated[0].split()] if stated else None
    return cloud if origin is None else with_origin(cloud, checked_origin(origin, "a.3mf"))


def vtu(data: bytes) -> Cloud:
    """Read points, triangles, lines and values with meshio, which reads no file without cells."""
    if b'NumberOfCells="0"' in data:
        raise InputError("meshio does not read this")
    found = _by_meshio(data, "vtu")
    values: dict[str, Any] = {name: _native(each) for name, each in found.point_data.items()}
    colors, normals = values.pop("Colors", None), values.pop("Normals", None)
    cells = {each.type: each.data.astype(np.int32) for each in found.cells}
    points = _native(found.points)
    return Cloud(
        points,
        colors=colors,
        normals=normals,
        attributes=values,
        faces=cells.get("triangle"),
        edges=cells.get("line"),
    )


def xdmf(data: bytes) -> Cloud:
    """Read points, cells and values by hand."""
    grid = ET.fromstring(data).find("Domain/Grid")
    assert grid is not None, "there is no grid"
    topology, points = grid.find("Topology"), _item_of(grid.find("Geometry"))
    kind, numbers = topology.get("TopologyType"), _item_of(topology).tolist()
    cells: dict[int, list[list[int]]] = {3: [], 2: [], 1: []}
    if kind != "Mixed":
        cells[3 if kind == "Triangle" else 1] = numbers
    while kind == "Mixed" and numbers:
        width, start = (3, 1) if numbers[0] == 4 else (numbers[1], 2)
        cells[width].append(numbers[start : start + width])
        numbers = numbers[start + width :]
    values: dict[str, Any] = {
        str(each.get("Name")): _item_of(each)
        for each in grid.iter("Attribute")
        if each.get("Center") == "Node"
    }
    colors, normals = values.pop("Colors", None), values.pop("Normals", None)
    faces, edges = (np.array(cells[width], np.int32) if cells[width] else None for width in (3, 2))
    return Cloud(
        points, colors=colors, normals=normals, attributes=values, faces=faces, edges=edges
    )


def _item_of(element: Any) -> Any:
    """Return the array of an element."""
    item = element.find("DataItem")
    kind = {"Float": "f", "Int": "i", "UInt": "u"}[item.get("DataType")] + item.get("Precision")
    whole = int if kind[0] != "f" else np.dtype(kind).type
    numbers = np.array([whole(word) for word in item.text.split()], dtype=kind)
    return numbers.reshape([int(size) for size in item.get("Dimensions").split()])


def msh(data: bytes) -> Cloud:
    """Read cells with meshio; the nodes, which it leaves in the order of the file, by hand."""
    at = data.index(b"$Nodes\n") + 7
    blocks = int(np.frombuffer(data, np.uint64, 1, at)[0])
    at, tags = at + 32, []
    for _ in range(blocks):
        count = int(np.frombuffer(data, np.uint64, 1, at + 12)[0])
        tags.append(np.frombuffer(data, np.uint64, count, at + 20).astype(int) - 1)
        at += 20 + 32 * count
    rows = np.concatenate(tags)
    found = _by_meshio(data, "msh")
    points = np.empty_like(found.points)
    points[rows] = found.points
    parts: dict[str, list[Any]] = {"triangle": [], "line": []}
    for each in found.cells:
        parts[each.type].append(rows[each.data].astype(np.int32))
    faces, edges = (np.concatenate(each) if each else None for each in parts.values())
    return Cloud(points, faces=faces, edges=edges)


def ugrid(data: bytes) -> Cloud:
    """Read the mesh that attributes name, with xarray."""
    held = xarray.open_dataset(io.BytesIO(data), engine="scipy", decode_cf=False).load()
    (mesh,) = (each for each in held.values() if each.attrs.get("cf_role") == "mesh_topology")
    x, y = mesh.attrs["node_coordinates"].split()
    faces = mesh.attrs["face_node_connectivity"]
    left_out = {mesh.name, "crs", x, y, "mesh2d_node_z", faces}
    values = {str(name): _native(held[name].values) for name in held if name not in left_out}
    about = held["crs"].attrs if "crs" in held else {}
    return Cloud(
        np.stack([_native(held[each].values) for each in (x, y, "mesh2d_node_z")], axis=1),
        faces=_native(held[faces].values),
        attributes=values,
        crs=about.get("epsg_code") or about.get("crs_wkt"),
    )


def _by_meshio(data: bytes, kind: str) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"a.{kind}")
        path.write_bytes(data)
        return meshio.read(path, {"msh": "gmsh"}.get(kind, kind))


def _native(values: Any) -> Any:
    """Return an array whose type says no byte order, as meshio's do."""
    return values.astype(values.dtype.newbyteorder("="))


READERS: dict[str, Callable[[bytes], Cloud]] = {
    "3mf": three_mf,
    "vtu": vtu,
    "xdmf": xdmf,
    "msh": msh,
    "ugrid": ugrid,
}
