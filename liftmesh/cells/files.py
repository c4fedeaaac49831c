"""Cells as files, GeoJSON, GeoPackage, PLY and SVG, with values of their rows; domains of files.

A cell carries the values of its row, its row number and its area. Where the caller has a column of
such a name, ours is called ``cell_area``: no value is replaced. Rows without an area have no
geometry; they are kept wherever a file can hold them.

*GeoJSON* (RFC 7946) has a feature in a line, and is written block by block. JSON has neither NaN
nor infinity: both become null, and infinite values are counted as lost. *SVG* has a path for each
row with an area.

*PLY.* A face is one ring, and most programs draw it as a fan of triangles. So a convex part of a
cell is one face; any other part is cut into triangles (constrained Delaunay, by shapely), which all
carry the values of the cell. Faces share vertices wherever corners have the same coordinates. The
file is text, with digits that round-trip, and its faces are in the order of their numbers of
corners: libraries in wide use cannot read the values of faces otherwise.
"""

from __future__ import annotations

import io
import json
import math
import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats, Indices, Integers, Mask
from liftmesh.base.interruption import preserve_signals
from liftmesh.base.options import counted, refused, shown
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.domain import Domain, as_domain, following_corners, shapes_of, unite
from liftmesh.crs.comparison import as_system, common_system, crs_of
from liftmesh.crs.description import look_up
from liftmesh.errors import FormatError, InputError
from liftmesh.io.atomic import replacing
from liftmesh.io.columns import places
from liftmesh.io.formats.ply.header import name_statements, property_names
from liftmesh.io.formats.ply.writer import PORTABLE, portable
from liftmesh.io.metadata import OWN, crs_comment
from liftmesh.io.streams import at_home, check_stream, name_of
from liftmesh.io.text_tables import write_rows
from liftmesh.io.write import WriteResult
from liftmesh.optional import load
from liftmesh.predicates import orient2d
from liftmesh.vector.files import own_system, read_features
from liftmesh.vector.geojson import crs_member
from liftmesh.vector.geopackage import write_shapes

_SUFFIXES = {
    ".geojson": "geojson", ".json": "geojson", ".gpkg": "gpkg", ".ply": "ply", ".svg": "svg",
}  # fmt: skip
_ROWS = 1 << 13  # of a block
_FACES = 1 << 14  # of a block
_CORNERS = "vertex_indices"
_MOST = np.iinfo(np.int64).max
_WIDTH = 1000  # of the longer side


def frame_of(data: Any, rows: int) -> Any:
    """Convert values of rows to a DataFrame, without a geometry."""
    pandas = load("pandas", extra="shapes")
    if isinstance(data, pandas.DataFrame):
        _check_length("data", len(data), rows)
        return pandas.DataFrame(data.drop(columns=_geometry_of(data)))
    columns = _values_of(data, rows)
    for name, values in columns.items():
        if np.ndim(values) > 1:
            shape = np.shape(values)
            raise InputError(f"column {name!r} has the shape {shape}: give a value each")
    return pandas.DataFrame(columns, index=pandas.RangeIndex(rows))


def columns_of(data: Any, rows: int) -> dict[str, Array]:
    """Convert values of rows to arrays: objects of one type to numbers or text."""
    arrays = {str(name): np.asarray(each) for name, each in _values_of(data, rows).items()}
    for name, values in arrays.items():
        if values.dtype.hasobject and {*map(type, values)} in ({str}, {int}, {float}, {bool}):
            arrays[name] = np.array(values.tolist())
    return arrays


def _values_of(data: Any, rows: int) -> dict[Any, Any]:
    if data is not None and not isinstance(data, Mapping) and not hasattr(data, "columns"):
        raise refused("data", data, "give a mapping of names to values, or a table")
    columns = {}
    for name in getattr(data, "columns", () if data is None else data):
        given = data[name]
        if isinstance(given, str | bytes) or not hasattr(given, "__len__"):
            raise InputError(f"column {name!r} is {shown(given)}: give a value for each row")
        _check_length(f"column {name!r}", len(given), rows)
        columns[name] = getattr(given, "array", given)  # of a Series, without its index
    return {name: columns[name] for name in columns if name not in _geometry_of(data)}


def _check_length(what: str, count: int, rows: int) -> None:
    if count != rows:
        raise InputError(
            f"{what} has {counted(count, 'value')} for {counted(rows, 'row')}: give one for each"
        )


def _geometry_of(data: Any) -> list[Any]:
    """The column that is the geometry of a GeoDataFrame."""
    name = getattr(data, "active_geometry_name", None)
    return [] if name is None else [name]


def free_name(name: str, taken: Iterable[Any]) -> str:
    """Return a name for a column of ours that no other column has, in any letters."""
    others = {str(each).casefold() for each in taken}
    while name.casefold() in others:
        name = f"cell_{name}"
    return name


def common_crs(data: Any, crs: Any, cells: str | None = None) -> Any:
    """Return the coordinate system that is given, or that of a table or of cells with one."""
    wanted = None if crs is None else as_system("crs", crs)
    own = crs_of(data) if _geometry_of(data) else None
    common = common_system(own, wanted, ("data", "crs"))
    return common_system(common, cells, ("data or crs", "the cells"))


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


def format_of(place: Any, name: str | None = None) -> str:
    """Return the name of a format: of the one that is given, or that the suffix stands for."""
    given = Path(name_of(place)).suffix if name is None else name
    kind = _SUFFIXES.get("." + given.lower().removeprefix("."))
    if kind is None:
        where = f"{name_of(place)}: " if name is None else ""
        known = ", ".join(_SUFFIXES)
        raise FormatError(f"{where}cells are not written as {given!r}: give one of {known}")
    return kind


def save_cells(
    cells: ClippedCells, target: Any, data: Any, file_format: str | None, crs: Any
) -> WriteResult:
    """Write cells to a file, completely or not at all, or to a stream."""
    kind, system = format_of(target, file_format), common_crs(data, crs, cells.crs)
    columns, dropped = plain_columns(columns_of(data, len(cells.points)))
    own = {name: free_name(name, columns) for name in ("row", "area")}
    held = {own["row"]: np.arange(len(cells.points)), **columns, own["area"]: cells.areas}
    is_path = isinstance(target, str | os.PathLike)
    if not is_path:
        check_stream(target, "write")
    place: Any = at_home(target)
    with replacing(place) if is_path else nullcontext(target) as stream, preserve_signals():
        counting = _Counting(stream)
        dropped += _WRITERS[kind](counting, cells, held, system)
    names = () if kind == "svg" else own.items()
    renamed = tuple((name, given) for name, given in names if name != given)
    return WriteResult(
        Path(place) if is_path else None, kind, counting.count, None, dropped, renamed
    )


class _Counting:
    """A stream that counts the bytes written to it."""

    def __init__(self, stream: Any) -> None:
        self._stream, self.count = stream, 0

    def write(self, data: Any) -> None:
        """Write and count."""
        self.count += len(data)
        self._stream.write(data)


def _write_geojson(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as a collection of features."""
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


def _write_geopackage(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as one layer."""
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


def _write_svg(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Draw the outlines of cells, without their values."""
    for line in _lines(cells):  # noqa: FURB122 - streams may only `write`
        stream.write(f"{line}\n".encode())
    values = [*columns][1:-1]  # but the number of the row, and the area
    return (*values, *(["crs"] if crs else []))


def _lines(cells: ClippedCells) -> Iterator[str]:
    low, high = np.reshape(cells.domain.bounds, (2, 2))
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


def _write_ply(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as faces in the plane z = 0."""
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
        stream.write(_face_lines(own, sizes[block], [column[block] for column in values.values()]))
    lost = [f"{name} (not numbers)" for name in texts]
    return (
        *lost,
        *([f"{counted(len(cells.empty), 'row')} without an area"] if len(cells.empty) else []),
    )


def _header(
    vertices: int, sizes: Integers, values: Mapping[str, Array], comments: list[str]
) -> bytes:
    count = "int" if sizes.max(initial=0) > 255 else "uchar"
    lines = ["ply", "format ascii 1.0", *(f"comment {line}" for line in (OWN, *comments))]
    lines += [f"element vertex {vertices}", *(f"property double {axis}" for axis in "xyz")]
    lines += [f"element face {len(sizes)}", f"property list {count} int {_CORNERS}"]
    lines += [f"property {PORTABLE[v.dtype.str[1:]]} {name}" for name, v in values.items()]
    return "\n".join([*lines, "end_header", ""]).encode("ascii")


def _face_lines(index: Indices, sizes: Integers, values: Sequence[Array]) -> bytes:
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


def _faces(cells: ClippedCells) -> tuple[Floats, Integers, Integers]:
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


def _cut(cells: ClippedCells, parts: Indices) -> tuple[Floats, Indices]:
    """Cut parts into triangles; return these, counter-clockwise, and the part of each."""
    shapely = load("shapely", extra="shapes")
    shapes = []
    for first, last in zip(
        cells.rings[parts].tolist(), cells.rings[parts + 1].tolist(), strict=True
    ):
        outer, *holes = np.split(cells.corners, cells.ring_corners[first : last + 1])[1:-1]
        shapes.append(shapely.make_valid(shapely.Polygon(outer, holes)))
    pieces = shapely.constrained_delaunay_triangles(shapes)
    triangles, of = shapely.get_parts(pieces, return_index=True)
    rings = shapely.get_coordinates(shapely.orient_polygons(triangles)).reshape(-1, 4, 2)
    return rings[:, :3], parts[of]


_WRITERS: Mapping[str, Callable[..., tuple[str, ...]]] = {
    "geojson": _write_geojson, "gpkg": _write_geopackage, "ply": _write_ply, "svg": _write_svg,
}  # fmt: skip


def read_domain(path: Path) -> Domain:
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
    return as_domain(shape, np.empty((0, 2)), own_system(tree, shape.bounds))


class SavableCells(ClippedCells):
    """Cells that become tables and files."""

    def to_geodataframe(self, data: Any = None, *, crs: Any = None) -> Any:
        """Return the cells as a GeoDataFrame.

        Parameters
        ----------
        data : mapping of str to (n,) array_like, DataFrame or GeoDataFrame, optional
            Values of the rows, which become columns, and their index. The cells take the place of
            the geometry of a GeoDataFrame.
        crs : object, optional
            The coordinate system, as geopandas takes it; by default that of `data`, or `crs`.

        Returns
        -------
        geopandas.GeoDataFrame
            One row for each point, with the columns of `data`, ``area`` and ``geometry``. If `data`
            has a column of such a name, ours is called ``cell_area`` or ``cell_geometry``.

        Raises
        ------
        InputError
            A column has not one value for each row; or the systems of `data`, of the cells and
            `crs` differ, or one is unknown.
        MissingDependencyError
            geopandas is missing.

        See Also
        --------
        Cells.to_shapely : The polygons alone.
        Cells.save : The polygons in a file, which needs no geopandas but for GeoPackages.

        Examples
        --------
        >>> import liftmesh
        >>> cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=(-1, -1, 3, 1))
        >>> cells.to_geodataframe({"name": ["a", "b"]}).columns.tolist()
        ['name', 'area', 'geometry']
        """
        geopandas = load("geopandas", extra="shapes")
        frame = frame_of(data, len(self.points))
        frame[free_name("area", frame)] = self.areas
        text = common_crs(data, crs, self.crs)
        system = None if text is None else look_up(text, extra="shapes")
        shapes = geopandas.GeoSeries(self.to_shapely(), frame.index, crs=system)
        name = free_name("geometry", frame)
        frame[name] = shapes
        return geopandas.GeoDataFrame(frame, geometry=name)

    def save(
        self,
        path: str | os.PathLike[str] | BinaryIO,
        data: Any = None,
        *,
        format: str | None = None,  # noqa: A002
        crs: Any = None,
    ) -> WriteResult:
        """Write the cells with values of their rows.

        Each cell has the number of its row as ``row``, its columns of `data`, and its ``area``.

        Parameters
        ----------
        path : path or binary file
            Where to write; the suffix determines the format. A file is written completely or not at
            all.
        data : mapping of str to (n,) array_like, DataFrame or GeoDataFrame, optional
            Values of the rows, which become columns.
        format : {"geojson", "gpkg", "ply", "svg"}, optional
            The format; by default that of the suffix. GeoJSON and GeoPackage hold polygons, PLY a
            mesh whose faces carry the values of their rows, and SVG outlines alone.
        crs : object, optional
            The coordinate system, as for `to_geodataframe`.

        Returns
        -------
        WriteResult
            The format, the number of bytes, and in ``dropped`` what the file does not keep. If
            `data` has a column ``row`` or ``area``, ``renamed`` says what that of the cells is
            called.

        Raises
        ------
        InputError
            As for `to_geodataframe`.
        FormatError
            The format is unknown, or cannot hold a column.
        MissingDependencyError
            geopandas is missing, which writes GeoPackages; or shapely, of PLY with concave cells.
        OSError
            The file cannot be written; the message gives the reason.

        See Also
        --------
        Cells.to_geodataframe : The same as a table.
        write : Write clouds and meshes.

        Examples
        --------
        >>> import io
        >>> import liftmesh
        >>> cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=(-1, -1, 3, 1))
        >>> stream = io.BytesIO()
        >>> cells.save(stream, {"name": ["a", "b"]}, format="geojson").bytes
        423
        """
        return save_cells(self, path, data, format, crs)
