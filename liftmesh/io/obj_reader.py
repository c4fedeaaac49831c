"""OBJ to Cloud.

An OBJ file is a list of lines, each a keyword and its values: ``v`` a vertex, ``vn`` a normal,
``f`` a face whose corners are vertex, vertex/texture, vertex/texture/normal or vertex//normal,
counted from 1, or backwards from the last one so far. The lines are taken in large blocks and
sorted by keyword, so that all vertices of a block are parsed at once. Keywords that say nothing
about the shape are counted and passed over.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Mask, Rows
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.faces import remarks, triangulated
from liftmesh.io.file_colors import recognized
from liftmesh.io.obj_corners import Corners, parse_corners
from liftmesh.io.obj_normals import vertex_normals
from liftmesh.io.text_tables import BLOCK, Block, Lines, number_table

_KEYWORDS = ("v", "vn", "f")

# How many values a vertex line may have: x y z, with a weight, with r g b, with alpha.
_VERTEX_WIDTHS = (3, 4, 6, 7)


def read_obj(stream: BinaryIO, name: str) -> Cloud:
    """Read an OBJ file.

    Parameters
    ----------
    stream : binary stream
        At the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Coordinates as float64; colours ``v x y z r g b`` as uint8 if they are multiples of 1/255,
        else as floats; normals if all corners of a vertex agree on one. ``metadata`` counts
        ``ignored`` lines by keyword, ``polygons`` cut into triangles, ``degenerate_faces`` of fewer
        than three corners left out.

    Raises
    ------
    FormatError
        A line is broken; the message names it.
    """
    reading = _Reading(name)
    lines = Lines(stream, name, comments=("#",), continued=True)
    while len(block := lines.take(BLOCK)):
        reading.take(block)
    return reading.cloud()


@dataclass(slots=True)
class _Reading:
    """One OBJ file on its way into a Cloud: what the blocks gave so far."""

    name: str
    vertices: list[Array] = field(default_factory=list)
    normals: list[Array] = field(default_factory=list)
    corners: list[Corners] = field(default_factory=list)
    ignored: Counter[str] = field(default_factory=Counter)
    vertex_count: int = 0
    normal_count: int = 0

    def take(self, block: Block) -> None:
        v, vn, f = self._sorted(block)
        if len(f):
            before = (self.vertex_count, self.normal_count)
            self.corners.append(parse_corners(f, self.name, (v.numbers, vn.numbers), before))
        self._take_vertices(v)
        if len(vn):
            self.normals.append(number_table(vn, self.name, width=3))
        self.vertex_count += len(v)
        self.normal_count += len(vn)

    def _sorted(self, block: Block) -> tuple[Block, ...]:
        """Take the lines of each keyword that matters, without it, and count the others."""
        masks = [_begin_with(block, keyword) for keyword in _KEYWORDS]
        for text, number in block[~np.any(masks, axis=0)]:
            if text in _KEYWORDS:
                raise FormatError(f"{self.name}: line {number}: {text!r} without values")
            self.ignored[text.split(None, 1)[0]] += 1
        return tuple(
            Block([text[len(keyword) + 1 :] for text in found.texts], found.numbers)
            for keyword, found in zip(_KEYWORDS, (block[mask] for mask in masks), strict=True)
        )

    def _take_vertices(self, block: Block) -> None:
        if not len(block):
            return
        width = self.vertices[0].shape[1] if self.vertices else None
        table = number_table(block, self.name, width=width)
        if table.shape[1] not in _VERTEX_WIDTHS:
            raise FormatError(
                f"{self.name}: line {block.numbers[0]}: a vertex has 3 coordinates, and perhaps "
                f"3 colours: found {table.shape[1]} values"
            )
        if table.shape[1] == 4:
            self.ignored["weight of v"] += len(table)
        self.vertices.append(table)

    def cloud(self) -> Cloud:
        if not self.vertices:
            raise FormatError(f"{self.name}: no line 'v x y z': no OBJ file, or one of no vertices")
        table = np.concatenate(self.vertices)
        corners = Corners.joined(self.corners) if self.corners else None
        colors, attributes = _colors(table[:, 3:])
        # Faces first: that checks the vertices which normals are gathered for.
        faces = self._faces(corners, len(table))
        return Cloud(
            np.ascontiguousarray(table[:, :3]),
            colors=colors,
            normals=self._normals(corners, len(table)),
            attributes=attributes,
            faces=faces,
            metadata=self._metadata(corners),
        )

    def _faces(self, corners: Corners | None, vertices: int) -> Rows | None:
        if corners is None:
            return None
        lines = corners.lines
        return triangulated(
            corners.vertices, vertices, self.name, lambda face: f"line {lines[face]}: face"
        )

    def _metadata(self, corners: Corners | None) -> dict[str, Any]:
        ignored = {"ignored": dict(self.ignored)} if self.ignored else {}
        return ignored | (remarks(corners.vertices) if corners is not None else {})

    def _normals(self, corners: Corners | None, vertices: int) -> Array | None:
        if not self.normals:
            return None
        return vertex_normals(np.concatenate(self.normals), corners, vertices, self.name)


def _begin_with(block: Block, keyword: str) -> Mask:
    begins = (f"{keyword} ", f"{keyword}\t")
    return np.fromiter((text.startswith(begins) for text in block.texts), bool, len(block))


def _colors(extra: Array) -> tuple[Array | None, dict[str, Array]]:
    """Tell colours; three more values that cannot be colours become an attribute instead."""
    if extra.shape[1] < 3:
        return None, {}
    values = np.ascontiguousarray(extra)
    colors = recognized(values)
    return colors, {} if colors is not None else {"color": values}
