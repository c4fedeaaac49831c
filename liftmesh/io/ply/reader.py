"""PLY to Cloud: the vertex element becomes rows, the face element triangles.

What a Cloud has no place for (other elements, properties of faces, lists of vertices) is passed
over, and named in the metadata.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

import numpy as np

from liftmesh.errors import FormatError
from liftmesh.io.columns import Sheet
from liftmesh.io.faces import remarks, triangulated
from liftmesh.io.ply.ascii_body import AsciiBody
from liftmesh.io.ply.binary_body import BinaryBody
from liftmesh.io.ply.header import Element, Header, read_header
from liftmesh.io.text_tables import shortened

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud
    from liftmesh.io.ragged import Ragged

_INDICES = ("vertex_indices", "vertex_index")

Body: TypeAlias = AsciiBody | BinaryBody


def read_ply(stream: BinaryIO, name: str) -> Cloud:
    """Read a PLY file, text or binary of either byte order.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Coordinates as float64; nx, ny, nz as normals, red, green, blue (alpha) as colours, other
        scalar properties as attributes, all in the file's types; polygons as fans of triangles.
        ``metadata`` holds ``comments``, ``obj_info``, and, where there are any, the number of
        ``polygons`` cut into triangles, of ``degenerate_faces`` of fewer than three corners left
        out, and the names of properties and elements that were ``skipped``.

    Raises
    ------
    FormatError
        The file is broken; the message names the line or byte.
    """
    header = read_header(stream, name)
    ascii_body = header.encoding == "ascii"
    body = AsciiBody(stream, name, header.lines) if ascii_body else BinaryBody(stream, name)
    return _Reading(header, body, name).cloud()


class _Reading:
    """One PLY file on its way into a Cloud."""

    def __init__(self, header: Header, body: Body, name: str) -> None:
        self._header = header
        self._body = body
        self._name = name
        self._skipped: list[str] = []

    def cloud(self) -> Cloud:
        sheet, faces = None, None
        for element in self._header.elements:
            if element.name == "vertex":
                sheet = self._vertices(element)
            elif element.name == "face":
                faces = self._faces(element)
            else:
                self._pass_over(element)
        if sheet is None:
            raise FormatError(f"{self._name}: the header announces no vertex element")
        self._body.check_end()
        triangles = None if faces is None else triangulated(faces, len(sheet.points), self._name)
        return sheet.cloud(triangles, self._metadata(faces))

    def _vertices(self, element: Element) -> Sheet:
        scalars = {each.name: each.dtype for each in element.properties if each.length is None}
        if not {"x", "y"} <= scalars.keys():
            raise FormatError(
                f"{self._name}: the vertex element has no x and y: its properties are "
                f"{shortened(', '.join(each.name for each in element.properties)) or 'none'}"
            )
        self._skip(element, [each.name for each in element.properties if each.length is not None])
        if element.is_table:
            return self._table(element, scalars)
        lists = self._body.lists(element)
        sheet = Sheet(scalars, element.rows)
        for each in scalars:
            sheet.columns[each][:] = lists[each].values
        return sheet

    def _table(self, element: Element, types: dict[str, np.dtype]) -> Sheet:
        blocks = self._body.blocks(element)
        # The first block is taken before the arrays are made: a header that lies fails here.
        taken = next(blocks, None)
        sheet = Sheet(types, element.rows)
        while taken is not None:
            rows, columns = taken
            for each, values in columns.items():
                sheet.columns[each][rows] = values
            taken = next(blocks, None)
        return sheet

    def _faces(self, element: Element) -> Ragged | None:
        usable = [each for each in element.properties if each.name in _INDICES and each.length]
        self._skip(element, [each.name for each in element.properties if each not in usable[:1]])
        if element.is_table:
            self._exhaust(element)
            return None
        lists = self._body.lists(element)
        if not usable:
            return None
        if usable[0].dtype.kind not in "iu":
            raise FormatError(f"{self._name}: {usable[0].name} of faces must be integers")
        return lists[usable[0].name]

    def _pass_over(self, element: Element) -> None:
        self._skipped.append(f"element {element.name} ({element.rows} rows)")
        if element.is_table:
            self._exhaust(element)
        else:
            self._body.lists(element)

    def _exhaust(self, element: Element) -> None:
        for _ in self._body.blocks(element):
            pass

    def _skip(self, element: Element, names: list[str]) -> None:
        self._skipped += [f"{element.name} property {each} ({element.rows} rows)" for each in names]

    def _metadata(self, faces: Ragged | None) -> dict[str, Any]:
        found: dict[str, Any] = {
            "comments": self._header.comments,
            "obj_info": self._header.obj_info,
            "skipped": tuple(self._skipped),
        }
        return {key: value for key, value in found.items() if value} | (
            remarks(faces) if faces is not None else {}
        )
