"""VTU, the unstructured grids of VTK: written, not read.

Arrays follow the tree, each with its length, every bit of them in base64: raw bytes would be a
quarter shorter, but then the file is no XML, and few programs read it. Rows without faces become
cells of one point each, edges cells of two, which come last. Where there are edges and faces, cells
have values: `region` of faces, and `marker` of edges, as `io.tags` has them; those of others are -1
and 0. meshio, which reads such files, writes
them to paths only, and holds all of the text in memory: so this is written here, a block at a time.

Source: VTK File Formats, docs.vtk.org.
"""

from __future__ import annotations

import sys
from base64 import b64encode
from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.colors import as_float, as_uint8, fits_eight_bits
from liftmesh.io.columns import edges_of, faces_of
from liftmesh.io.format import dropped_values
from liftmesh.io.markup import attribute, is_possible
from liftmesh.io.tags import markers_of, regions_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_Arrays: TypeAlias = list[tuple[str, Array]]  # by their names

_TYPES = {
    "i1": "Int8", "i2": "Int16", "i4": "Int32", "i8": "Int64", "u1": "UInt8", "u2": "UInt16",
    "u4": "UInt32", "u8": "UInt64", "f4": "Float32", "f8": "Float64",
}  # fmt: skip
_VERTEX, _LINE, _TRIANGLE, _TETRAHEDRON = 1, 3, 5, 10  # kinds of cells
_COLORS, _NORMALS = "Colors", "Normals"
_ROWS = 1 << 18  # written at a time


def write_vtu(stream: BinaryIO, cloud: Cloud) -> None:
    """Write a mesh or a cloud as VTU."""
    _write(stream, cloud.points, of_points(cloud), _cells(parts_of(cloud)), of_cells(cloud))


def write_tetrahedra(stream: BinaryIO, points: Floats, simplices: Rows) -> None:
    """Write tetrahedra as VTU, with all rows of the points."""
    _write(stream, points, [], _cells([(simplices, _TETRAHEDRON)]), [])


def _write(
    stream: BinaryIO, points: Floats, of_points: _Arrays, cells: _Arrays, values: _Arrays
) -> None:
    arrays = [*of_points, ("", points), *cells, *values]
    places = np.cumsum([0, *(4 * -(-(8 + each.nbytes) // 3) for _, each in arrays)]).tolist()
    tags = [
        _tag(name, each, place) for (name, each), place in zip(arrays, places[:-1], strict=True)
    ]
    end = len(tags) - len(values)
    count = end - 4
    byte_order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    head = f'type="UnstructuredGrid" version="1.0" header_type="UInt64" byte_order="{byte_order}"'
    lines = [
        '<?xml version="1.0"?>', f"<VTKFile {head}>", "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells[1][1])}">',
        "<PointData>", *tags[:count], "</PointData>",
        "<Points>", tags[count], "</Points>",
        "<Cells>", *tags[count + 1 : end], "</Cells>",
        *(["<CellData>", *tags[end:], "</CellData>"] if values else []),
        "</Piece>", "</UnstructuredGrid>", '<AppendedData encoding="base64">', "_",
    ]  # fmt: skip
    stream.write("\n".join(lines).encode())
    for _, each in arrays:
        for text in _encoded(each):  # noqa: FURB122 - streams may only `write`
            stream.write(text)
    stream.write(b"\n</AppendedData>\n</VTKFile>\n")


def _encoded(values: Array) -> Iterator[bytes]:
    """Yield an array after its length in base64, block by block."""
    held = np.uint64(values.nbytes).tobytes()
    for start in range(0, len(values), _ROWS):
        held += np.ascontiguousarray(values[start : start + _ROWS]).tobytes()
        whole = len(held) - len(held) % 3
        yield b64encode(held[:whole])
        held = held[whole:]
    yield b64encode(held)


def dropped_parts(cloud: Cloud, _: Mapping[str, Any]) -> Collection[str]:
    """Return the attributes that are not written."""
    kept = dict(_attributes(cloud))
    return [dropped_values(name) for name in cloud.attributes if name not in kept]


def parts_of(cloud: Cloud) -> list[tuple[Array, int]]:
    """Return the cells of each kind, lines last."""
    parts = [(np.arange(len(cloud), dtype=np.int32)[:, None], _VERTEX)]
    if cloud.faces is not None and len(cloud.faces):
        parts = [(cloud.faces, _TRIANGLE)]
    if len(edges := edges_of(cloud)):
        parts.append((edges, _LINE))
    return parts


def _cells(parts: list[tuple[Array, int]]) -> _Arrays:
    """Return the corners of all cells, where each ends, and its kind."""
    cells, kinds = zip(*parts, strict=True)
    counts = [len(each) for each in cells]
    corners = np.concatenate([each.reshape(-1) for each in cells])
    ends = np.cumsum(np.repeat([each.shape[1] for each in cells], counts), dtype=np.int64)
    of_cells = np.repeat(np.array(kinds, np.uint8), counts)
    return [("connectivity", corners), ("offsets", ends), ("types", of_cells)]


def of_cells(cloud: Cloud) -> _Arrays:
    """Return the regions of faces, and the markers of edges."""
    faces, edges = faces_of(cloud), edges_of(cloud)
    if not len(faces) or not len(edges):
        return []
    regions = np.full(len(faces) + len(edges), -1, np.int32)
    regions[: len(faces)] = regions_of(cloud)
    markers = np.zeros_like(regions)
    markers[len(faces) :] = markers_of(cloud, edges[:0])
    return [("region", regions), ("marker", markers)]


def of_points(cloud: Cloud) -> _Arrays:
    """Return the values of the points: colours in 8 bits, or as floats from 0 to 1."""
    arrays = _attributes(cloud)
    if cloud.colors is not None:
        is_eight = fits_eight_bits(cloud.colors)
        arrays.append((_COLORS, as_uint8(cloud.colors) if is_eight else as_float(cloud.colors)))
    return arrays if cloud.normals is None else [*arrays, (_NORMALS, _known(cloud.normals))]


def _attributes(cloud: Cloud) -> _Arrays:
    taken = {_COLORS} if cloud.colors is not None else set()
    taken |= {_NORMALS} if cloud.normals is not None else set()
    return [
        (name, _known(values))
        for name, values in cloud.attributes.items()
        if name and name not in taken and is_possible(name) and _has_type(values)
    ]


def _has_type(values: Array) -> bool:
    return values.ndim <= 2 and values.dtype.str[1:] in {*_TYPES, "b1", "f2"} and values.size > 0


def _known(values: Array) -> Array:
    """Return values in a type of VTK, which holds them all, in the machine's byte order."""
    wider = {"b1": "u1", "f2": "f4"}.get(values.dtype.str[1:])
    return values.astype(wider or values.dtype.newbyteorder("="), copy=False)


def _tag(name: str, values: Array, place: int) -> str:
    columns = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    named = f" Name={attribute(name)}" if name else ""
    kind = _TYPES[values.dtype.str[1:]]
    return f'<DataArray type="{kind}"{named}{columns} format="appended" offset="{place}"/>'
