"""Files of Triangle and TetGen: .node, points, .ele, triangles of the .node beside, and .poly.

https://www.cs.cmu.edu/~quake/triangle.node.html, and triangle.ele.html and triangle.poly.html.

A .node file begins with its number of points, their dimension, the number of attributes and whether
there are boundary markers; each line is an index, the coordinates, the attributes and the marker.
An .ele file begins with its number of triangles, their number of nodes (3, or 6 with the midpoints
of edges) and of attributes; each line is an index, the nodes and the attributes. Indices count
from 0 or 1, as the first point says. A .poly file has the points of a .node file, or none if they
are in the one beside it, then segments, each with its ends and marker, holes, each with a point in
it, and regions, each with a point in it, an attribute and the largest area of its triangles.

What is written is counted from 0. Comments at the top name the attributes, in their order:
``# attribute "intensity"``, or ``# heights``, which Triangle interpolates as it does attributes.
Triangle reads lines of up to 1,023 characters.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.columns import attribute_columns, checked_edges, checked_faces
from liftmesh.io.markup import ascii_string, parsed_or_none
from liftmesh.io.metadata import OWN, noted
from liftmesh.io.options import check_columns
from liftmesh.io.streams import decompressed
from liftmesh.io.tags import MARKERS
from liftmesh.io.text_tables import (
    HASH,
    Lines,
    check_end,
    is_count,
    leading_comments,
    number_table,
    promised,
    quoted,
    write_rows,
)

HOLES, REGIONS = "holes", "regions"
"""The entries of the metadata with a point in each hole, and what is stated of regions."""

_HEIGHTS, _STATED = "heights", "attribute "  # comments
_LONGEST = 1000  # characters of a comment
_OF_REGION = (3, 4)  # numbers
_MARKER = "boundary_marker"
_NODES = "points, their dimension, attributes and markers"


def read_node(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read the points of a .node file."""
    return _nodes(stream, name, max_bytes)[0]


def read_ele(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read the triangles of an .ele file, with the points of the .node file beside it."""
    with _beside(name, max_bytes) as (nodes, beside):
        cloud, first = _nodes(nodes, beside, max_bytes)
    lines = Lines(stream, name, HASH)
    count, corners, more = _header(lines, name, "triangles, their nodes and attributes", 3)
    if corners not in (3, 6):
        raise FormatError(
            f"{name}: line {lines.number}: elements of {corners} nodes are no triangles"
        )
    check_columns(1 + corners + more, max_bytes, name, "its header")
    table = _rows(lines, count, 1 + corners + more, "triangles", name)
    check_end(lines, name)
    _check_indices(table[:, 0], first, f"counted from {first} as in {beside}", name)
    faces = table[:, 1:4] - first
    skipped = [f"{more} attribute{'s' * (more > 1)} of triangles"] * (more > 0)
    skipped += ["midpoints of edges"] * (corners == 6)
    return replace(
        cloud,
        faces=checked_faces(_whole(faces, "triangle", name), len(cloud), name),
        metadata=noted({}, not_read=tuple(skipped)),
    )


def _nodes(stream: BinaryIO, name: str, max_bytes: int | None) -> tuple[Cloud, int]:
    """Read a .node file; return its points and the index of the first."""
    names = _stated_names(stream, name)
    lines = Lines(stream, name, HASH)
    nodes = _points(lines, _header(lines, name, _NODES, 4), names, name, max_bytes)
    check_end(lines, name)
    return nodes


def read_poly(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read the points and segments of a .poly file; the rest is metadata."""
    names = _stated_names(stream, name)
    lines = Lines(stream, name, HASH)
    header = _header(lines, name, _NODES, 4)
    if header[0]:
        cloud, first = _points(lines, header, names, name, max_bytes)
    else:
        with _beside(name, max_bytes) as (nodes, beside):
            cloud, first = _nodes(nodes, beside, max_bytes)
    count, markers = _header(lines, name, "segments and their markers", 2, 1)
    table = _rows(lines, count, 3 + (markers > 0), "segments", name)
    edges = checked_edges(_whole(table[:, 1:3] - first, "segment", name), len(cloud), name)
    (count,) = _header(lines, name, "holes", 1, 1)
    entries: dict[str, Any] = {HOLES: _rows(lines, count, 3, "holes", name)[:, 1:]}
    (count,) = _header(lines, name, "regions", 1, 0)
    entries[REGIONS] = _rows(lines, count, None, "regions", name)[:, 1:]
    if entries[REGIONS].shape[1] not in _OF_REGION:
        raise FormatError(f"{name}: a region has x, y, an attribute and at most one further value")
    check_end(lines, name)
    if markers:
        entries[MARKERS] = _whole(table[:, 3], "segment", name)
    kept = {key: rows for key, rows in entries.items() if len(rows)}
    return replace(cloud, edges=edges, metadata=kept)


def write_node(stream: BinaryIO, cloud: Cloud) -> None:
    """Write points; with heights as those of TetGen, in three dimensions."""
    write_points(stream, cloud, 3 if _has_heights(cloud) else 2)


def write_points(stream: BinaryIO, cloud: Cloud, dimension: int) -> None:
    """Write points with their named values; in two dimensions heights are among these."""
    columns = _columns(cloud)
    markers = [columns.pop(_MARKER)] if _are_markers(columns.get(_MARKER)) else []
    stated = [_STATED + ascii_string(name) for name in columns]
    values = [*columns.values()]
    if dimension == 2 and _has_heights(cloud):
        stated, values = [_HEIGHTS, *stated], [cloud.points[:, 2], *values]
    comments = "".join(f"# {comment}\n" for comment in (OWN, *stated))
    header = len(cloud), dimension, len(values), len(markers)
    stream.write(comments.encode() + b"%d %d %d %d\n" % header)
    write_numbered(stream, [cloud.points[:, :dimension], *values, *markers])


def write_numbered(stream: BinaryIO, columns: Sequence[Array]) -> None:
    """Write rows with their numbers."""
    write_rows(stream, [np.arange(len(columns[0]), dtype=np.int32), *columns])


def check(cloud: Cloud) -> None:
    """Raise for named values that the files cannot hold."""
    _columns(cloud)


def _has_heights(cloud: Cloud) -> bool:
    heights = cloud.points[:, 2]
    return bool((heights != 0).any() or np.signbit(heights).any())


def _columns(cloud: Cloud) -> dict[str, Array]:
    """Return the named values as columns: their readers know finite numbers only."""
    columns = attribute_columns(cloud.attributes)
    for name, values in columns.items():
        if len(ascii_string(name)) > _LONGEST:
            raise FormatError(f"the name of attribute {quoted(name)} is too long: rename it")
        is_finite = np.isfinite(values)
        if not is_finite.all():
            row = int(is_finite.argmin())
            raise FormatError(
                f"attribute {quoted(name)} is {values[row]} in row {row}: files of Triangle hold "
                "finite values only: leave it out, or write PLY"
            )
    return columns


def _are_markers(values: Array | None) -> bool:
    if values is None or values.dtype.kind not in "iu":
        return False
    return np.array_equal(values.astype(np.int32), values)


def _stated_names(stream: BinaryIO, name: str) -> list[str | None]:
    """Return the names of attributes that comments state, and None for heights."""
    names: list[str | None] = []
    with closing(leading_comments(stream, name)) as comments:
        for comment in comments:
            if comment.startswith(_STATED):
                text = parsed_or_none(comment.removeprefix(_STATED))
                names += [text] if isinstance(text, str) else []
            elif comment == _HEIGHTS:
                names.append(None)
    return names


def _points(
    lines: Lines, header: list[int], names: list[str | None], name: str, max_bytes: int | None
) -> tuple[Cloud, int]:
    count, dimension, more, markers = header
    if dimension not in (2, 3) or markers > 1 or not count:
        raise FormatError(
            f"{name}: line {lines.number}: expected points of dimension 2 or 3 and at most one "
            f"marker, found {count} points of dimension {dimension} with {markers}"
        )
    width = 1 + dimension + more + markers
    check_columns(width, max_bytes, name, "its header")
    table = _rows(lines, count, width, "points", name)
    first = 1 if table[0, 0] == 1 else 0
    _check_indices(table[:, 0], first, "counted from 0 or 1", name)
    taken = [*names, *[_MARKER] * markers]
    if len(names) != more or len({*taken}) < len(taken) or (None in names and dimension == 3):
        names = [f"attribute_{k + 1}" for k in range(more)]
    values = map(np.ascontiguousarray, table[:, 1 + dimension : width - markers].T)
    columns: dict[Any, Array] = dict(zip(names, values, strict=True))
    points = np.zeros((count, 3))
    points[:, :dimension] = table[:, 1 : 1 + dimension]
    if None in columns:
        points[:, 2] = columns.pop(None)
    if markers:
        columns[_MARKER] = _whole(table[:, -1], "point", name)
    return Cloud(points, attributes=columns), first


def _header(lines: Lines, name: str, what: str, count: int, least: int = 2) -> list[int]:
    """Read the numbers of the first line; those that are left out are zero."""
    words = lines.next().split()
    are_counts = all(map(is_count, words))
    if not least <= len(words) <= count or not are_counts:
        raise FormatError(
            f"{name}: line {lines.number}: expected the numbers of {what}, "
            f"found {quoted(' '.join(words))}"
        )
    return [*map(int, words), *[0] * (count - len(words))]


def _rows(lines: Lines, count: int, width: int | None, what: str, name: str) -> Floats:
    """Read rows of so many numbers, or as many as the first has."""
    parts = []
    for block in promised(lines, count, what, name):
        parts.append(number_table(block, name, width=width))
        width = parts[-1].shape[1]
    return np.concatenate(parts) if parts else np.zeros((0, width or 1 + _OF_REGION[0]))


def _check_indices(indices: Floats, first: int, counted: str, name: str) -> None:
    wrong = indices != np.arange(first, first + len(indices))
    if wrong.any():
        row = int(np.argmax(wrong))
        raise FormatError(
            f"{name}: row {row + 1} has the index {indices[row]:.15g}, not {row + first}: the rows "
            f"must be in the order of their indices, {counted}"
        )


def _whole(values: Array, of: str, name: str) -> Rows:
    """Convert indices or markers to int32; an error gives the row, counted from 1."""
    with np.errstate(invalid="ignore"):
        converted: Rows = values.astype(np.int32)
    differ = converted != values
    if differ.any():
        raise FormatError(
            f"{name}: {of} {np.argwhere(differ)[0, 0] + 1}: an index or marker is "
            f"{values[differ][0]}, which is not int32"
        )
    return converted


@contextmanager
def _beside(name: str, max_bytes: int | None) -> Iterator[tuple[BinaryIO, str]]:
    """Open the .node file of an .ele file, which may be compressed."""
    if not os.path.isfile(name):  # noqa: PTH113 - a name of a stream may hold any bytes
        raise FormatError(
            f"{name}: its points are in a .node file in the same folder, which is unknown for a "
            "stream: give a path"
        )
    given = Path(name)
    plain = given.with_suffix("") if given.suffix.lower() == ".gz" else given
    stem = plain.with_suffix(".node")
    path = next((each for each in (stem, Path(f"{stem}.gz")) if each.is_file()), None)
    if path is None:
        raise FormatError(f"{name}: its points are in {stem}, which does not exist")
    _check_folder(path, given)
    with path.open("rb") as stream:
        yield decompressed(stream, str(path), max_bytes), str(path)


def _check_folder(path: Path, given: Path) -> None:
    """Raise if a link leads out of the folder: who made the file may not choose among all files."""
    folders = (given.absolute().parent.resolve(), given.resolve().parent)
    if path.resolve().parent not in folders:
        raise FormatError(f"{given}: its points, {path}, are a link to another folder: copy them")
