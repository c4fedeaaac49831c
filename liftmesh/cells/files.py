"""Cells as files, GeoJSON, GeoPackage, PLY and SVG, and domains that are files.

A cell carries the values of its row, its row number and its area. Rows without an area have no
geometry; they are kept wherever a file can hold them.

GeoJSON (RFC 7946) has a feature in a line, and is written block by block. JSON has neither NaN nor
infinity: both become null, and infinite values are counted as lost. SVG has a path for each row
with an area.
"""

from __future__ import annotations

import io
import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.cells.clipped import free_name
from liftmesh.cells.domain import shapes_of, unite
from liftmesh.cells.ply import write_ply
from liftmesh.crs.description import look_up
from liftmesh.errors import FormatError, InputError
from liftmesh.io.text_tables import write_rows
from liftmesh.vector.files import own_system, read_features
from liftmesh.vector.geojson import crs_member
from liftmesh.vector.geopackage import write_shapes

if TYPE_CHECKING:
    from liftmesh.cells.clipped import ClippedCells


SUFFIXES = {
    ".geojson": "geojson", ".json": "geojson", ".gpkg": "gpkg", ".ply": "ply", ".svg": "svg",
}  # fmt: skip


def format_of(path: Path) -> str:
    """Return the format that the suffix of a path stands for."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise FormatError(f"{path}: cells are not written as {suffix!r}: give one of {known}")
    return SUFFIXES[suffix]


def check_format(name: str) -> str:
    """Return the name of a format, or raise."""
    if (kind := name.lower().removeprefix(".")) not in _WRITERS:
        raise FormatError(f"cells are not written as {name!r}: give one of {', '.join(_WRITERS)}")
    return kind


def own_names(columns: Mapping[str, Array]) -> tuple[str, str]:
    """Return the names that the row number and the area of a cell have beside other columns."""
    return free_name("row", columns), free_name("area", columns)


def write_cells(
    stream: BinaryIO,
    cells: ClippedCells,
    kind: str,
    columns: Mapping[str, Array],
    crs: str | None = None,
) -> tuple[str, ...]:
    """Write cells; return what the file does not keep, by name."""
    plain, dropped = plain_columns(columns)
    row, area = own_names(plain)
    if kind == "svg":
        return (*dropped, *write_svg(stream, cells, plain, crs))
    held = {row: np.arange(len(cells.points)), **plain, area: cells.areas}
    return (*dropped, *_WRITERS[kind](stream, cells, held, crs))


def plain_columns(columns: Mapping[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Convert the values of rows to what files of polygons hold: one number or text each."""
    kept: dict[str, Array] = {}
    dropped = []
    for name, given in columns.items():
        values = _plain(given)
        width = math.prod(given.shape[1:])
        if values is None or not width:
            dropped.append(f"{name} ({given.dtype if width else 'no values'})")
            continue
        names = [name] if given.ndim == 1 else [f"{name}_{k}" for k in range(width)]
        if taken := kept.keys() & {*names}:
            raise InputError(f"two columns are named {min(taken)!r}: rename one")
        kept |= zip(names, values.reshape(len(given), width).T, strict=True)
    return kept, tuple(dropped)


def _plain(values: Array) -> Array | None:
    if values.dtype.kind in "biuU":
        return values
    if values.dtype.kind != "f":
        return None
    with np.errstate(all="ignore"):
        doubles = values.astype(np.float64)
    return doubles if np.array_equal(doubles, values, equal_nan=True) else None


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


_MOST = np.iinfo(np.int64).max


def write_geopackage(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as one layer: a writer of `files.write_cells`."""
    _check_names(columns)
    shapes = cells.to_shapely()
    shapes[cells.empty] = None
    values = {name: _signed(name, column) for name, column in columns.items()}
    system = _known(crs)
    names = {"FID": free_name("fid", columns), "GEOMETRY_NAME": free_name("geom", columns)}
    write_shapes(stream, shapes, values, system, "cells", **names)
    return ("crs",) if crs is not None and system is None else ()


def _check_names(columns: Mapping[str, Array]) -> None:
    name, count = Counter(map(str.casefold, columns)).most_common(1)[0] if columns else ("", 0)
    if count > 1:
        both = " and ".join(repr(each) for each in columns if each.casefold() == name)
        raise FormatError(f"a GeoPackage takes columns {both} for one: rename one")


def _signed(name: str, values: Array) -> Array:
    if values.dtype != np.uint64:
        return values
    if values.max(initial=0) > _MOST:
        raise FormatError(
            f"column {name!r} has the value {values.max()}: a GeoPackage has no integers beyond "
            "2**63"
        )
    return values.astype(np.int64)


def _known(crs: str | None) -> str | None:
    try:
        return crs if crs is None or look_up(crs, extra="shapes") else None
    except InputError:
        return None


_WIDTH = 1000  # of the longer side


def write_svg(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Draw the outlines of cells: a writer of `files.write_cells`."""
    for line in _lines(cells):  # noqa: FURB122 - streams may only `write`
        stream.write(f"{line}\n".encode())
    return (*columns, *(["crs"] if crs else []))


def _lines(cells: ClippedCells) -> Iterator[str]:
    low, high = cells.domain.corners.min(axis=0), cells.domain.corners.max(axis=0)
    scale = _WIDTH / float((high - low).max())
    width, height = ((high - low) * scale).tolist()
    yield (
        '<svg xmlns="http://www.w3.org/2000/svg" '
        f'viewBox="-1 -1 {width + 2:.3f} {height + 2:.3f}" '
        'fill="none" stroke="#333" stroke-width="0.7" stroke-linejoin="round">'
    )
    placed = (cells.corners - (low[0], high[1])) * (scale, -scale)
    for row in np.flatnonzero(np.diff(cells.parts)).tolist():
        first, last = cells.rings[cells.parts[row : row + 2]].tolist()
        rings = [placed[slice(*cells.ring_corners[r : r + 2].tolist())] for r in range(first, last)]
        yield f'<path id="row{row}" d="{"".join(map(_outline, rings))}"/>'
    yield "</svg>"


def _outline(ring: Floats) -> str:
    return f"M{'L'.join(f'{x:.3f} {y:.3f}' for x, y in ring.tolist())}Z"


_WRITERS: Mapping[str, Callable[..., tuple[str, ...]]] = {
    "geojson": write_geojson, "gpkg": write_geopackage, "ply": write_ply, "svg": write_svg,
}  # fmt: skip


def read_domain(path: Path) -> tuple[Any, str | None]:
    """Read the polygons of a file."""
    tree = read_features(path, "a domain")
    try:
        shapes = shapes_of(tree) if tree else []
    except Exception as error:  # of whatever kind shapely makes
        raise FormatError(f"{path}: cannot be read as a domain: {error}") from error
    try:
        shape = unite(shapes)
    except InputError as error:
        error.within(path)
        raise
    return shape, own_system(tree, shape.bounds)
