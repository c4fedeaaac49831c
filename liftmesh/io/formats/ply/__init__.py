"""PLY, the format that preserves everything: doubles, colours, normals, attributes, a crs.

Reading starts here: the vertex element becomes rows, the face element triangles, and an edge
element edges, if its ends are vertex1 and vertex2. Data that a Cloud
cannot hold (other elements, properties of faces, lists of vertices) is skipped, and listed in the
metadata.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

import numpy as np

from liftmesh._typing import Array, Rows
from liftmesh.base.options import counted
from liftmesh.errors import FormatError
from liftmesh.io.columns import (
    COLOR,
    CloudBuilder,
    Ragged,
    built_in_chunks,
    checked_edges,
    face_counts,
    triangulated,
)
from liftmesh.io.formats.ply.body import AsciiBody, BinaryBody
from liftmesh.io.formats.ply.header import (
    EDGE,
    Element,
    depth_of_comments,
    old_names,
    read_header,
)
from liftmesh.io.metadata import noted, others, stated, stated_crs
from liftmesh.io.text_tables import shortened

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_INDICES = ("vertex_indices", "vertex_index")

Body: TypeAlias = AsciiBody | BinaryBody


def read_ply(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read a PLY file, text or binary of either byte order."""
    return _Reading(stream, name, max_bytes).cloud()


def read_ply_chunks(
    stream: BinaryIO, name: str, rows: int, *, max_bytes: int | None = None
) -> Iterator[Cloud]:
    """Read the vertices of a PLY file in chunks."""
    yield from _Reading(stream, name, max_bytes).chunks(rows)


class _Reading:
    """State of reading one PLY file."""

    def __init__(self, stream: BinaryIO, name: str, max_bytes: int | None) -> None:
        self._header = read_header(stream, name, max_bytes)
        self._body: Body = (
            AsciiBody(stream, name, self._header.lines)
            if self._header.encoding == "ascii"
            else BinaryBody(stream, name)
        )
        self._name = name
        self._skipped: list[str] = []
        properties = self._properties()
        comments = others(self._header.comments, self._crs())
        self._depth, rest = depth_of_comments(comments, properties.get(COLOR[0]))
        self._names, self._comments = old_names(rest, properties)

    def _properties(self) -> dict[str, np.dtype]:
        """The properties that become attributes, coordinates, normals and colours."""
        vertex = (each for each in self._header.elements if each.name == "vertex")
        return {name: dtype for element in vertex for name, dtype in _scalars(element).items()}

    def cloud(self) -> Cloud:
        builder, faces, edges = None, None, None
        for element in self._header.elements:
            if element.name == "vertex":
                builders = self._vertices(element, max(element.rows, 1))
                builder = next(builders, None) or CloudBuilder(_scalars(element), 0)
            elif element.name == "face":
                faces = self._faces(element)
            elif element.name == "edge" and _are_edges(element):
                edges = self._edges(element)
            else:
                self._skip_element(element)
        if builder is None:
            raise self._no_vertices()
        self._body.check_end()
        triangles = None if faces is None else triangulated(faces, builder.rows, self._name)
        if edges is not None:
            edges = checked_edges(edges, builder.rows, self._name)
        return self._cloud(builder, triangles, self._metadata(faces), edges)

    def _cloud(
        self,
        builder: CloudBuilder,
        faces: Rows | None,
        metadata: dict[str, Any],
        edges: Rows | None = None,
    ) -> Cloud:
        """Give attributes the names that comments state."""
        made = builder.cloud(faces, metadata, self._crs(), self._depth, edges)
        if not self._names:
            return made
        named = {self._names.get(key, key): values for key, values in made.attributes.items()}
        return replace(made, attributes=named)

    def chunks(self, rows: int) -> Iterator[Cloud]:
        for element in self._header.elements:
            if element.name == "vertex":
                for builder in self._vertices(element, rows):
                    yield self._cloud(builder, None, self._metadata(None))
                return
            self._skip_element(element)
        raise self._no_vertices()

    def _vertices(self, element: Element, rows: int) -> Iterator[CloudBuilder]:
        scalars = _scalars(element)
        if not {"x", "y"} <= scalars.keys():
            raise FormatError(
                f"{self._name}: the vertex element has no x and y: its properties are "
                f"{shortened(', '.join(each.name for each in element.properties)) or 'none'}"
            )
        self._note_skipped(
            element, [each.name for each in element.properties if each.length is not None]
        )
        return built_in_chunks(scalars, element.rows, self._columns(element, scalars), rows)

    def _columns(self, element: Element, names: Collection[str]) -> Iterator[Mapping[str, Array]]:
        """Yield scalar properties in blocks; those between lists are lists of one value."""
        if element.is_table:
            yield from self._body.tables(element, names)
        else:
            for block in self._body.lists(element, names):
                yield {name: column.values for name, column in block.items()}

    def _no_vertices(self) -> FormatError:
        return FormatError(f"{self._name}: the header has no vertex element")

    def _crs(self) -> str | None:
        return stated_crs(self._header.comments)

    def _faces(self, element: Element) -> Ragged | None:
        usable = [each for each in element.properties if each.name in _INDICES and each.length]
        self._note_skipped(
            element, [each.name for each in element.properties if each not in usable[:1]]
        )
        if not usable:
            self._exhaust(element)
            return None
        if usable[0].dtype.kind not in "iu":
            raise FormatError(f"{self._name}: {usable[0].name} of faces must be integers")
        name = usable[0].name
        parts = [block[name] for block in self._body.lists(element, [name])]
        return Ragged.joined(parts) if parts else Ragged.empty(usable[0].dtype)

    def _edges(self, element: Element) -> Array:
        others = [each.name for each in element.properties if each.name not in EDGE]
        self._note_skipped(element, others)
        blocks = self._columns(element, EDGE)
        parts = [np.stack([block[end] for end in EDGE], axis=1) for block in blocks]
        return np.concatenate([np.empty((0, 2), dtype=np.int32), *parts])

    def _skip_element(self, element: Element) -> None:
        self._skipped.append(f"element {element.name} ({counted(element.rows, 'row')})")
        self._exhaust(element)

    def _exhaust(self, element: Element) -> None:
        """Read an element that is not kept, to find the next and what is wrong with this one."""
        for _ in self._columns(element, ()):
            pass

    def _note_skipped(self, element: Element, names: list[str]) -> None:
        self._skipped += [
            f"{element.name} property {each} ({counted(element.rows, 'row')})" for each in names
        ]

    def _metadata(self, faces: Ragged | None) -> dict[str, Any]:
        infos = self._header.obj_info
        entries = stated(self._comments) | ({"obj_info": infos} if infos else {})
        counts = {} if faces is None else face_counts(faces)
        return noted(entries, not_read=tuple(self._skipped)) | counts


def _are_edges(element: Element) -> bool:
    types = _scalars(element)
    return element.is_table and all(end in types and types[end].kind in "iu" for end in EDGE)


def _scalars(element: Element) -> dict[str, np.dtype]:
    return {each.name: each.dtype for each in element.properties if each.length is None}
