"""Cells as PLY: a mesh whose faces carry the values of their rows.

A face of PLY is one ring, and most programs draw it as a fan of triangles. So a convex part of a
cell is one face; any other part is cut into triangles (constrained Delaunay, by shapely), which all
carry the values of the cell. Faces share vertices wherever corners have the same coordinates.

The file is text, with digits that round-trip, and its faces are in the order of their numbers of
corners: libraries in wide use cannot read the values of faces otherwise.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats, Mask
from liftmesh.base.options import counted
from liftmesh.cells.domain import following_corners
from liftmesh.io.columns import places
from liftmesh.io.formats.ply.header import name_statements, property_names
from liftmesh.io.formats.ply.writer import PORTABLE, portable
from liftmesh.io.metadata import OWN, crs_comment
from liftmesh.io.text_tables import write_rows
from liftmesh.optional import load
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.cells.clipped import ClippedCells

_FACES = 1 << 14  # of a block
_CORNERS = "vertex_indices"


def write_ply(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as faces in the plane z = 0: a writer of `files.write_cells`."""
    texts = tuple(name for name, values in columns.items() if values.dtype.kind == "U")
    numbers = {name: values for name, values in columns.items() if name not in texts}
    corners, sizes, row = _faces(cells)
    vertices, index = np.unique(corners + 0.0, axis=0, return_inverse=True)
    names = property_names([*numbers], [_CORNERS])
    values = {names[k]: portable(v, f"column {k!r}")[row] for k, v in numbers.items()}
    lines = [*crs_comment(crs), *name_statements(names)]
    stream.write(_header(len(vertices), sizes, values, lines))
    write_rows(stream, [vertices], end=" 0\n")
    for first in range(0, len(sizes), _FACES):
        block = slice(first, first + _FACES)
        own = index.reshape(-1)[sizes[:first].sum() :][: sizes[block].sum()]
        stream.write(_lines(own, sizes[block], [column[block] for column in values.values()]))
    lost = [f"{name} (not numbers)" for name in texts]
    return (
        *lost,
        *([f"{counted(len(cells.empty), 'row')} without an area"] if len(cells.empty) else []),
    )


def _header(
    vertices: int, sizes: NDArray[np.int64], values: Mapping[str, Array], comments: list[str]
) -> bytes:
    count = "int" if sizes.max(initial=0) > 255 else "uchar"
    lines = ["ply", "format ascii 1.0", *(f"comment {line}" for line in (OWN, *comments))]
    lines += [f"element vertex {vertices}", *(f"property double {axis}" for axis in "xyz")]
    lines += [f"element face {len(sizes)}", f"property list {count} int {_CORNERS}"]
    lines += [f"property {PORTABLE[v.dtype.str[1:]]} {name}" for name, v in values.items()]
    return "\n".join([*lines, "end_header", ""]).encode("ascii")


def _lines(index: NDArray[np.intp], sizes: NDArray[np.int64], values: Sequence[Array]) -> bytes:
    """Faces as lines: how many corners, these, and the values."""
    stream = io.BytesIO()
    write_rows(stream, [sizes, *values], prefix="\0", between=["\0"] + [" "] * (len(values) - 1))
    corners = [*map(str, index.tolist())]
    ends = np.cumsum(sizes).tolist()
    held = stream.getvalue().decode().split("\0")[1:]
    return "".join(
        f"{count} {' '.join(corners[first:last])} {rest}"
        for count, rest, first, last in zip(held[::2], held[1::2], [0, *ends], ends, strict=False)
    ).encode()


def _faces(cells: ClippedCells) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64]]:
    """The corners of all faces, how many each has, and its row."""
    is_whole = _are_convex(cells)
    row = np.repeat(np.arange(len(cells.points)), np.diff(cells.parts))
    outer = cells.rings[:-1][is_whole]
    sizes = np.diff(cells.ring_corners)[outer]
    corners = cells.corners[places(cells.ring_corners[outer], sizes)]
    part = np.flatnonzero(is_whole)
    if not is_whole.all():
        triangles, cut = _cut(cells, np.flatnonzero(~is_whole))
        sizes, part = np.append(sizes, np.full(len(cut), 3)), np.append(part, cut)
        corners = np.concatenate([corners, triangles.reshape(-1, 2)])
    order = np.lexsort((part, sizes))
    starts = np.cumsum(sizes) - sizes
    return corners[places(starts[order], sizes[order])], sizes[order], row[part[order]]


def _are_convex(cells: ClippedCells) -> Mask:
    """Which parts have no holes, and turn left or go straight on at every corner."""
    following = following_corners(cells.ring_corners)
    ahead = cells.corners[following]
    turns = orient2d(cells.corners, ahead, cells.corners[following[following]]) < 0
    count = np.diff(cells.ring_corners)
    ring = np.repeat(np.arange(len(count)), count)
    reflex = np.bincount(ring, turns, minlength=len(count)) > 0
    outer = cells.rings[:-1]
    convex: Mask = (np.diff(cells.rings) == 1) & ~reflex[outer]
    return convex


def _cut(cells: ClippedCells, parts: NDArray[np.intp]) -> tuple[Floats, NDArray[np.intp]]:
    """Cut parts into triangles; return these, counter-clockwise, and the part of each."""
    shapely = load("shapely", extra="shapes")
    shapes = np.array([_polygon(cells, part, shapely) for part in parts.tolist()], dtype=object)
    pieces = shapely.constrained_delaunay_triangles(shapely.make_valid(shapes))
    triangles, of = shapely.get_parts(pieces, return_index=True)
    rings = shapely.get_coordinates(shapely.orient_polygons(triangles)).reshape(-1, 4, 2)
    return rings[:, :3], parts[of]


def _polygon(cells: ClippedCells, part: int, shapely: object) -> object:
    first, last = cells.rings[part : part + 2].tolist()
    rings = [
        cells.corners[slice(*cells.ring_corners[ring : ring + 2].tolist())]
        for ring in range(first, last)
    ]
    return shapely.Polygon(rings[0], rings[1:])  # type: ignore[attr-defined]
