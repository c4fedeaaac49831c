"""Cells as GeoJSON (RFC 7946), a feature in a line, written block by block.

JSON has neither NaN nor infinity: both become null, and infinite values are counted as lost.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.io.text_tables import write_rows
from liftmesh.vector.geojson import crs_member

if TYPE_CHECKING:
    from liftmesh.cells.clipped import ClippedCells

_ROWS = 1 << 13  # of a block


def write_geojson(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as a collection of features: a writer of `files.write_cells`."""
    count = len(cells.points)
    stream.write(f'{{"type": "FeatureCollection", {crs_member(crs)}"features": [\n'.encode())
    for first in range(0, count, _ROWS):
        last = min(first + _ROWS, count)
        lines = ",\n".join(_features(cells, columns, first, last))
        stream.write(f"{lines}{',' if last < count else ''}\n".encode())
    stream.write(b"]}\n")
    infinite = {name: _infinite(values) for name, values in columns.items()}
    lost = (f"{name} ({number:,} infinite)" for name, number in infinite.items() if number)
    return tuple(lost)


def _infinite(values: Array) -> int:
    return int(np.isinf(values).sum()) if values.dtype.kind == "f" else 0


def _features(
    cells: ClippedCells, columns: Mapping[str, Array], first: int, last: int
) -> Iterator[str]:
    texts = [
        [f"{json.dumps(name)}: {text}" for text in _texts(values[first:last])]
        for name, values in columns.items()
    ]
    shapes = _shapes(cells, first, last)
    values = zip(*texts, strict=True) if texts else [()] * (last - first)
    for held, shape in zip(values, shapes, strict=True):
        yield f'{{"type": "Feature", "properties": {{{", ".join(held)}}}, "geometry": {shape}}}'


def _texts(values: Array) -> Sequence[str]:
    """Values as JSON has them."""
    if values.dtype.kind != "f":
        return [json.dumps(each) for each in values.tolist()]
    finite = np.isfinite(values).tolist()
    return [
        repr(each) if is_finite else "null"
        for each, is_finite in zip(values.tolist(), finite, strict=True)
    ]


def _shapes(cells: ClippedCells, first: int, last: int) -> Iterator[str]:
    """The geometries of a block of rows."""
    parts = cells.parts[first : last + 1]
    rings = cells.rings[parts[0] : parts[-1] + 1]
    starts = cells.ring_corners[rings[0] : rings[-1] + 1]
    corners = _corners(cells.corners[starts[0] : starts[-1]])
    closed = [
        f"[{', '.join(corners[a:b])}, {corners[a]}]"
        for a, b in pairwise((starts - starts[0]).tolist())
    ]
    polygons = [f"[{', '.join(closed[a:b])}]" for a, b in pairwise((rings - rings[0]).tolist())]
    for a, b in pairwise((parts - parts[0]).tolist()):
        if b == a:
            yield "null"
        elif b == a + 1:
            yield f'{{"type": "Polygon", "coordinates": {polygons[a]}}}'
        else:
            several = ", ".join(polygons[a:b])
            yield f'{{"type": "MultiPolygon", "coordinates": [{several}]}}'


def _corners(corners: Array) -> list[str]:
    """Corners as text, by the kernel's printer: the shortest digits that stand for the numbers."""
    if not len(corners):
        return []
    stream = io.BytesIO()
    write_rows(stream, [corners], prefix="[", between=", ", end="]\n")
    return stream.getvalue().decode().splitlines()
