"""XDMF 3, which ParaView and meshio read: written, not read.

All is text in one file, with digits that round-trip: arrays in HDF5 would need a second file beside
it. What a mesh has is that of VTU (`vtu.py`): rows without faces become cells of one point each.

Source: XDMF Model and Format, xdmf.org.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

from liftmesh._typing import Array
from liftmesh.io.formats.vtu import of_cells, of_points, parts_of
from liftmesh.io.markup import attribute
from liftmesh.io.text_tables import write_rows

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_HEAD = b"""<?xml version="1.0"?>
<Xdmf Version="3.0">
<Domain>
<Grid Name="mesh" GridType="Uniform">
<Geometry GeometryType="XYZ">
"""
_ITEM_END = b"</DataItem>\n"
_END = b"</Grid>\n</Domain>\n</Xdmf>\n"
_TYPES = {"i": "Int", "u": "UInt", "f": "Float"}
_KINDS = {1: ("Polyvertex", "1 1 "), 2: ("Polyline", "2 2 "), 3: ("Triangle", "4 ")}
"""Of cells of so many corners: their name, and what is before each of them among others."""


def write_xdmf(stream: BinaryIO, cloud: Cloud) -> None:
    """Write a mesh or a cloud as XDMF."""
    stream.write(_HEAD)
    _write_item(stream, cloud.points)
    stream.write(b"</Geometry>\n")
    _write_cells(stream, [cells for cells, _ in parts_of(cloud)])
    for center, arrays in (("Node", of_points(cloud)), ("Cell", of_cells(cloud))):
        for name, values in arrays:
            width = values.shape[1] if values.ndim > 1 else 1
            kind = {1: "Scalar", 3: "Vector"}.get(width, "Matrix")
            named = f'Name={attribute(name)} AttributeType="{kind}" Center="{center}"'
            stream.write(f"<Attribute {named}>\n".encode())
            _write_item(stream, values)
            stream.write(b"</Attribute>\n")
    stream.write(_END)


def _write_cells(stream: BinaryIO, parts: list[Array]) -> None:
    """Write cells of one kind, or of two with the kind before each."""
    names, prefixes = zip(*(_KINDS[each.shape[1]] for each in parts), strict=True)
    is_one = len(parts) == 1
    kind, count = names[0] if is_one else "Mixed", sum(map(len, parts))
    per_cell = f' NodesPerElement="{parts[0].shape[1]}"' if is_one else ""
    head = f'<Topology TopologyType="{kind}" NumberOfElements="{count}"{per_cell}>\n'
    stream.write(head.encode())
    if is_one:
        _write_item(stream, parts[0])
    else:
        words = [
            each.size + len(each) * len(mark.split())
            for each, mark in zip(parts, prefixes, strict=True)
        ]
        stream.write(_item(f"{sum(words)}", parts[0]))
        for each, mark in zip(parts, prefixes, strict=True):
            write_rows(stream, [each], prefix=mark)
        stream.write(_ITEM_END)
    stream.write(b"</Topology>\n")


def _write_item(stream: BinaryIO, values: Array) -> None:
    stream.write(_item(" ".join(map(str, values.shape)), values))
    write_rows(stream, [values])
    stream.write(_ITEM_END)


def _item(dimensions: str, values: Array) -> bytes:
    kind = f'DataType="{_TYPES[values.dtype.kind]}" Precision="{values.dtype.itemsize}"'
    return f'<DataItem {kind} Dimensions="{dimensions}" Format="XML">\n'.encode()
