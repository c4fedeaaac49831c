"""UGRID 1.0, the meshes of ocean and flood models in NetCDF: written, not read.

The file is NetCDF 3 with 64-bit offsets, which SciPy writes and every reader of NetCDF takes. It
has one mesh, of which heights and named values are at the nodes; counts begin at 0. Text has no
type of its own there, nor have whole numbers of 64 bits: those up to 2**53 become doubles.

Source: UGRID Conventions 1.0, ugrid-conventions.github.io; CF Conventions 1.8.
"""

from __future__ import annotations

import io
import re
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.crs.description import is_number, look_up, parse_crs
from liftmesh.errors import FormatError, InputError, MissingDependencyError
from liftmesh.io.columns import faces_of
from liftmesh.io.format import DOUBLE, dropped_values, fits_whole
from liftmesh.io.markup import is_possible
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_MESH = "mesh2d"
_X, _Y, _Z = (f"{_MESH}_node_{axis}" for axis in "xyz")
_FACES, _SYSTEM = f"{_MESH}_face_nodes", "crs"
_NODES, _CORNERS = f"{_MESH}_nNodes", f"{_MESH}_nMax_face_nodes"
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,99}")
_UNITS = {"metre": "m", "foot": "ft", "US survey foot": "US_survey_foot"}
_KINDS = {"i1": "i1", "i2": "i2", "i4": "i4", "f4": "f4", "f8": "f8"}
_WIDER = {"b1": "i1", "u1": "i2", "u2": "i4", "u4": "f8", "i8": "f8", "u8": "f8", "f2": "f4"}
_MOST = 1 << 31  # bytes of an array


def write_ugrid(stream: BinaryIO, cloud: Cloud) -> None:
    """Write a mesh."""
    faces = faces_of(cloud)
    if max(faces.nbytes, 8 * len(cloud)) >= _MOST:
        raise FormatError("NetCDF 3 has no arrays of 2 GiB, which this mesh needs: write VTU")
    content = io.BytesIO()  # which SciPy closes
    file = load("scipy.io", extra="scipy").netcdf_file(content, "w", mmap=False, version=2)
    file.Conventions = "CF-1.8 UGRID-1.0"
    for name, size in ((_NODES, len(cloud)), (f"{_MESH}_nFaces", len(faces)), (_CORNERS, 3)):
        file.createDimension(name, size)
    _add(file, _MESH, np.array(0, "i4"), (), _topology())
    system = _system(cloud.crs)
    if system:
        _add(file, _SYSTEM, np.array(0, "i4"), (), system)
    for name, values, about in zip((_X, _Y, _Z), cloud.points.T, _axes(cloud.crs), strict=True):
        _add(file, name, values, (_NODES,), about)
    about = {"cf_role": "face_node_connectivity", "start_index": 0, "long_name": "nodes of faces"}
    _add(file, _FACES, faces, (f"{_MESH}_nFaces", _CORNERS), about)
    for name, values in _attributes(cloud).items():
        _add(file, name, values, (_NODES,), _at_nodes(cloud.crs))
    file.flush()
    stream.write(content.getbuffer())


def dropped_parts(cloud: Cloud, _: Mapping[str, Any]) -> Collection[str]:
    """Return what is not written: attributes, and a coordinate system that is no text."""
    kept = _attributes(cloud)
    system = ["crs"] if cloud.crs is not None and not is_possible(cloud.crs) else []
    return [*system, *(dropped_values(name) for name in cloud.attributes if name not in kept)]


def _add(
    file: Any, name: str, values: Array, dimensions: tuple[str, ...], about: Mapping[str, Any]
) -> None:
    variable = file.createVariable(name, _type_of(values), dimensions)
    variable[...] = values
    for key, each in about.items():
        setattr(variable, key, each.encode() if isinstance(each, str) else each)


def _topology() -> dict[str, Any]:
    return {
        "cf_role": "mesh_topology",
        "long_name": "topology of a mesh of triangles",
        "topology_dimension": 2,
        "node_coordinates": f"{_X} {_Y}",
        "node_dimension": _NODES,
        "face_node_connectivity": _FACES,
        "face_dimension": f"{_MESH}_nFaces",
    }


def _axes(crs: str | None) -> tuple[dict[str, Any], ...]:
    """Return what is said of x, y and z."""
    system = parse_crs(crs)
    units = (None, None, None) if system is None else system.units
    names = [None if each is None else _UNITS.get(each.name) for each in units]
    if system is not None and system.kind == "geographic":
        x = {"standard_name": "longitude", "units": "degrees_east"}
        y = {"standard_name": "latitude", "units": "degrees_north"}
    else:
        x, y = ({"standard_name": f"projection_{axis}_coordinate"} for axis in "xy")
        x |= _unit(names[0])
        y |= _unit(names[1])
    z = {"standard_name": "altitude", "long_name": "height of nodes", **_unit(names[2])}
    return x, y, {**z, **_at_nodes(crs)}


def _unit(name: str | None) -> dict[str, str]:
    return {} if name is None else {"units": name}


def _at_nodes(crs: str | None) -> dict[str, str]:
    about = {"mesh": _MESH, "location": "node", "coordinates": f"{_X} {_Y}"}
    return about if crs is None else {**about, "grid_mapping": _SYSTEM}


def _system(crs: str | None) -> dict[str, Any]:
    """Return what is said of the coordinate system, with the parameters that pyproj knows."""
    if crs is None or not is_possible(crs):
        return {}
    own = {"epsg_code": crs} if is_number(crs) else {"crs_wkt": crs}
    try:
        found = look_up(crs).to_cf()
    except (InputError, MissingDependencyError):
        return own
    known = {key: _as_value(each) for key, each in found.items() if each is not None}
    return {**known, **own}


def _as_value(value: Any) -> Any:
    return value if isinstance(value, str) else np.asarray(value, np.float64)


def _attributes(cloud: Cloud) -> dict[str, Array]:
    """Return the named values that NetCDF 3 has a type for, which holds them all."""
    taken = {_MESH, _SYSTEM, _X, _Y, _Z, _FACES}
    return {
        name: values
        for name, values in cloud.attributes.items()
        if values.ndim == 1 and name not in taken and _NAME.fullmatch(name) and _has_type(values)
    }


def _has_type(values: Array) -> bool:
    kind = values.dtype.str[1:]
    is_long = kind in ("i8", "u8")
    return kind in {**_KINDS, **_WIDER} and not (is_long and not fits_whole(values, DOUBLE))


def _type_of(values: Array) -> str:
    kind = values.dtype.str[1:]
    return _KINDS.get(kind) or _WIDER[kind]
