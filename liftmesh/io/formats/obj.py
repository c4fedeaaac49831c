"""OBJ files, reader and writer: text with doubles, colours, normals and triangles.

An OBJ file is a list of lines, each a keyword and its values: ``v`` a vertex, ``vn`` a normal,
``f`` a face whose corners are vertex, vertex/texture, vertex/texture/normal or vertex//normal,
counted from 1, or backwards from the last one so far; ``l`` a chain of edges. The lines are read in
large blocks and grouped by keyword, so that all vertices of a block are parsed at once. Keywords
that do not concern the shape are counted and skipped. The writer emits the shortest digits that
round-trip, and a chain for each edge. A coordinate system is a JSON string in a comment,
``# crs "EPSG:25832"``; metadata stand there too, and axes other than those of maps,
``# axes {"up": "y"}``: x, z and -y are written then.

The kernel parses all faces of a block at once, whatever their sizes. Colours are three further
values of each vertex, or comments that ZBrush introduced: ``v x y z r g b`` is what most programs
read; but some take all six for coordinates. Lines of ``#MRGB`` are comments to these: after the
mark a mask and a colour of two hexadecimal digits a channel for each vertex, 64 vertices to a line.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from typing import Any, BinaryIO

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import as_float, as_uint8, fits_eight_bits, recognized
from liftmesh.base.options import ObjColors, Up, as_threads, check_option
from liftmesh.errors import FormatError
from liftmesh.io.axes import AS_STATED, Axes, OriginChoice, chosen_origin, turned, upright
from liftmesh.io.columns import Ragged, edges_of, face_counts, triangulated
from liftmesh.io.format import Origin, checked_origin, with_origin, without_origin
from liftmesh.io.markup import parsed_or_none
from liftmesh.io.metadata import (
    as_text,
    header_comments,
    others,
    stated,
    stated_crs,
    storable,
)
from liftmesh.io.text_tables import (
    BLOCK,
    Block,
    Lines,
    Syntax,
    count_kind,
    leading_comments,
    number_table,
    quoted,
    shortened,
    words_of,
    write_rows,
)

_CORNER = re.compile(r"([+-]?\d{1,9})(?:/(?:[+-]?\d{1,18})?(?:/([+-]?\d{1,9}))?)?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Corners:
    """Faces: vertices, counted from 0, the normal of each corner (-1: none), and line numbers."""

    vertices: Ragged
    normals: Integers | None
    lines: Integers

    @classmethod
    def joined(cls, parts: Sequence[Corners]) -> Corners:
        """Concatenate the faces of all parts."""
        normals = None
        if any(each.normals is not None for each in parts):
            normals = np.concatenate([each.normals_or_none() for each in parts])
        return cls(
            Ragged.joined([each.vertices for each in parts]),
            normals,
            np.concatenate([each.lines for each in parts]),
        )

    def normals_or_none(self) -> Integers:
        """Return the normal of each corner, -1 for none."""
        if self.normals is not None:
            return self.normals
        return np.full(len(self.vertices.values), -1, dtype=np.int32)


def parse_corners(
    faces: Block, name: str, numbers: tuple[Integers, Integers], before: tuple[int, int]
) -> Corners:
    """Parse the face lines of a block, without the keyword ``f``."""
    threads, _ = as_threads(None, len(faces))
    parsed = _kernel.parse_corners(faces.plain, faces.places, threads)
    if parsed is None:
        raise _corner_error(faces, name)
    counts, vertices, normals = parsed
    sizes: Integers = counts.astype(np.int32)
    lines = faces.numbers
    named = None
    if normals is not None:
        named = _from_zero(normals, sizes, lines, numbers[1], before[1])
    from_zero = _from_zero(vertices, sizes, lines, numbers[0], before[0])
    return Corners(Ragged(sizes, from_zero), named, lines)


def _from_zero(
    numbers: Array, sizes: Integers, at: Integers, lines: Integers, before: int
) -> Array:
    """Count from 0, in place; resolve negative indices, which count back from their own line."""
    if not len(numbers) or numbers.min() >= 0:
        numbers -= 1
        return numbers
    backward = numbers < 0
    so_far = np.repeat(before + np.searchsorted(lines, at), sizes)
    resolved = np.where(backward, so_far + numbers, numbers - 1)
    # Before the first there is no vertex; keep it distinct from -1, which means no normal.
    resolved[backward & (resolved < 0)] -= 1
    indices: Array = resolved.astype(np.int32)
    return indices


def outside(index: int, count: int, kind: str = "vertex") -> str:
    """Describe a corner that refers to a missing vertex or normal, in the file's numbers."""
    kinds = "vertices" if kind == "vertex" else f"{kind}s"
    if index < 0:
        return f"refers back to before the first of {count} {kinds}"
    return f"refers to {kind} {index + 1}, but there are {count} {kinds}"


def _corner_error(faces: Block, name: str) -> FormatError:
    bad = (
        (corner, number)
        for text, number in faces
        for corner in words_of(text)
        if not _is_corner(corner)
    )
    corner, number = next(bad)
    return FormatError(
        f"{name}: line {number}: {quoted(corner)} is not a corner of a face: expected vertex, "
        "vertex/texture, vertex/texture/normal or vertex//normal, counted from 1"
    )


def _is_corner(text: str) -> bool:
    match = _CORNER.fullmatch(text)
    return match is not None and all(each is None or int(each) for each in match.groups())


MARK = "#MRGB"
_PER_LINE = 64
_OPAQUE = 255

# k/255 in the shortest digits of single precision: readers that use floats get this number.
_EIGHT_BITS = (np.arange(256) / 255).astype(np.float32)


def color_columns(colors: Array) -> Array:
    """The red, green and blue to be written behind coordinates."""
    rgb = colors[:, :3]
    if rgb.dtype == np.uint8:
        return np.take(_EIGHT_BITS, rgb)
    unit = as_float(rgb)
    # Single precision is kept: it needs fewer digits.
    return unit.astype(rgb.dtype) if rgb.dtype.kind == "f" else unit


def write_comments(stream: BinaryIO, colors: Array) -> None:
    """Write colours as comments, rounded to eight bits."""
    masked = np.full((len(colors), 4), _OPAQUE, dtype=np.uint8)
    masked[:, 1:] = as_uint8(colors)[:, :3]
    for start in range(0, len(masked), _PER_LINE):
        digits = masked[start : start + _PER_LINE].tobytes().hex()
        stream.write(f"{MARK} {digits}\n".encode("ascii"))


def commented_colors(stream: BinaryIO, name: str) -> Array | None:
    """Read the colours that comments hold, from the beginning of a stream."""
    values = bytearray()
    lines = Lines(stream, name)
    while len(block := lines.take(BLOCK)):
        for text in block.texts:
            if text.startswith(MARK):
                try:
                    values += bytes.fromhex(text[len(MARK) :])
                except ValueError:
                    return None
    if len(values) % 4:
        return None
    colors: Array = np.frombuffer(bytes(values), np.uint8).reshape(-1, 4)[:, 1:]
    return np.ascontiguousarray(colors)


_SYNTAX = Syntax(comments=("#",), continued=True)
_KEYWORDS = ("v", "vn", "f", "l")

# Possible numbers of values of a vertex line: x y z, with a weight, with r g b, with alpha.
_VERTEX_WIDTHS = (3, 4, 6, 7)


# Characters of the comments at the top that are kept, each with so many more: all that is written.
_MOST_COMMENTS, _COMMENT = 1 << 18, 4

_AXES = "axes "  # begins a comment that says which axis is up, and what was subtracted

_RUN = 1 << 16  # corners compared at a time


def read_obj(stream: BinaryIO, name: str, *, options: Axes = AS_STATED) -> Cloud:
    """Read an OBJ file; z is up unless it states another axis, or the caller does."""
    crs, entries, note = _stated(stream, name)
    up, origin = _axes(note, options, name)
    reading = _Reading(name, crs, entries)
    begin = stream.tell()
    lines = Lines(stream, name, _SYNTAX, sought=MARK.encode())
    while len(block := lines.take(BLOCK)):
        reading.take(block)
    if lines.found:
        stream.seek(begin)
        reading.painted = commented_colors(stream, name)
    cloud = reading.cloud()
    if up == "y":
        normals = None if cloud.normals is None else upright(cloud.normals)
        cloud = replace(cloud, points=upright(cloud.points), normals=normals)
    return with_origin(cloud, origin)


def _axes(note: Mapping[str, Any], options: Axes, name: str) -> tuple[Up, Origin | None]:
    """Take the axis and the origin that a comment states, unless a caller does."""
    origin = checked_origin(note["origin"], name) if "origin" in note else None
    return options.up or ("y" if note.get("up") == "y" else "z"), options.origin or origin


def _stated(stream: BinaryIO, name: str) -> tuple[str | None, dict[str, Any], dict[str, Any]]:
    """Return the coordinate system, metadata and axes that the comments at the top state."""
    crs, kept, left = None, [], _MOST_COMMENTS
    note: dict[str, Any] = {}
    with closing(leading_comments(stream, name)) as comments:
        for comment in comments:
            crs = stated_crs([comment]) if crs is None else crs
            axes = comment.startswith(_AXES) and parsed_or_none(comment.removeprefix(_AXES))
            if isinstance(axes, dict) and not note:
                note = axes
                continue
            left -= len(comment) + _COMMENT
            if left >= 0:
                kept.append(comment)
    return crs, stated(others(kept, crs)), note


@dataclass(slots=True)
class _Reading:
    """State of reading one OBJ file: the contents of the blocks so far."""

    name: str
    crs: str | None
    entries: dict[str, Any]
    painted: Array | None = None
    vertices: list[Array] = field(default_factory=list)
    normals: list[Array] = field(default_factory=list)
    corners: list[Corners] = field(default_factory=list)
    chains: list[Corners] = field(default_factory=list)
    ignored: Counter[str] = field(default_factory=Counter)
    vertex_count: int = 0
    normal_count: int = 0

    def take(self, block: Block) -> None:
        v, vn, *kinds = self._sorted(block)
        before = (self.vertex_count, self.normal_count)
        for found, kind in zip((self.corners, self.chains), kinds, strict=True):
            if len(kind):
                found.append(parse_corners(kind, self.name, (v.numbers, vn.numbers), before))
        self._take_vertices(v)
        if len(vn):
            self.normals.append(number_table(vn, self.name, width=3))
        self.vertex_count += len(v)
        self.normal_count += len(vn)

    def _sorted(self, block: Block) -> tuple[Block, ...]:
        """Return the values of the lines of each relevant keyword, and count the other lines."""
        keywords = _kernel.find_keywords(block.data, block.places, _KEYWORDS)
        for text, number in _where(keywords, -1, block):
            if text in _KEYWORDS:
                raise FormatError(f"{self.name}: line {number}: {text!r} without values")
            count_kind(self.ignored, shortened(text.split(None, 1)[0]))
        return tuple(
            _where(keywords, k, block).behind(len(keyword) + 1)
            for k, keyword in enumerate(_KEYWORDS)
        )

    def _take_vertices(self, block: Block) -> None:
        if not len(block):
            return
        width = self.vertices[0].shape[1] if self.vertices else None
        table = number_table(block, self.name, width=width)
        if table.shape[1] not in _VERTEX_WIDTHS:
            raise FormatError(
                f"{self.name}: line {block.numbers[0]}: a vertex has 3 coordinates and optionally "
                f"3 colour values: found {table.shape[1]} values"
            )
        if table.shape[1] == 4:
            self.ignored["weight of v"] += len(table)
        self.vertices.append(table)

    def cloud(self) -> Cloud:
        if not self.vertices:
            raise FormatError(f"{self.name}: not an OBJ file, or without vertices: no 'v' line")
        table = np.concatenate(self.vertices)
        corners = Corners.joined(self.corners) if self.corners else None
        colors, attributes = _colors(table[:, 3:])
        if self.painted is not None:
            colors = self._painted(colors, len(table))
        # Faces first: this validates the vertex indices that the normals rely on.
        faces = self._faces(corners, len(table))
        return Cloud(
            np.ascontiguousarray(table[:, :3]),
            colors=colors,
            normals=self._normals(corners, len(table)),
            attributes=attributes,
            faces=faces,
            metadata=self._metadata(corners),
            crs=self.crs,
            edges=self._edges(len(table)),
        )

    def _edges(self, vertices: int) -> Rows | None:
        """Divide the chains of ``l`` lines into edges."""
        if not self.chains:
            return None
        chains = Corners.joined(self.chains)
        ends = chains.vertices.values
        is_wrong = (ends < 0) | (ends >= vertices)
        if is_wrong.any():
            wrong = int(is_wrong.argmax())
            line = chains.lines[chains.vertices.row_of(wrong)]
            text = outside(int(ends[wrong]), vertices)
            raise FormatError(f"{self.name}: line {line}: a corner of a chain {text}")
        joined = np.ones(len(ends), dtype=np.bool_)
        joined[np.cumsum(chains.vertices.sizes, dtype=np.int64) - 1] = False
        first = np.flatnonzero(joined)
        return np.stack([ends[first], ends[first + 1]], axis=1).astype(np.int32)

    def _painted(self, colors: Array | None, vertices: int) -> Array | None:
        """The colours of comments, if there are no others and as many as vertices."""
        if colors is None and self.painted is not None and len(self.painted) == vertices:
            return self.painted
        self.ignored["#MRGB"] += 1
        return colors

    def _faces(self, corners: Corners | None, vertices: int) -> Rows | None:
        if corners is None:
            return None
        lines = corners.lines
        return triangulated(
            corners.vertices,
            vertices,
            self.name,
            lambda face: f"line {lines[face]}: face",
            outside,
        )

    def _metadata(self, corners: Corners | None) -> dict[str, Any]:
        ignored = {"ignored": dict(self.ignored)} if self.ignored else {}
        return (
            self.entries | ignored | (face_counts(corners.vertices) if corners is not None else {})
        )

    def _normals(self, corners: Corners | None, vertices: int) -> Array | None:
        if not self.normals:
            return None
        return _vertex_normals(np.concatenate(self.normals), corners, vertices, self.name)


def _where(keywords: Array, keyword: int, block: Block) -> Block:
    """The lines of a keyword: most often all or none."""
    count = np.count_nonzero(keywords == keyword)
    if count in (0, len(block)):
        return block[:count]
    return block[keywords == keyword]


def _colors(extra: Array) -> tuple[Array | None, dict[str, Array]]:
    """Recognise colours; values that cannot be colours become an attribute instead."""
    if extra.shape[1] < 3:
        return None, {}
    values = np.ascontiguousarray(extra)
    colors = recognized(values)
    return colors, {} if colors is not None else {"color": values}


def _vertex_normals(
    normals: Floats, corners: Corners | None, vertices: int, name: str
) -> Floats | None:
    """Convert normals of corners to normals of vertices, if the corners of each vertex agree."""
    if corners is None:
        return normals if len(normals) == vertices else None
    named = corners.normals
    if named is None:
        return None
    _check(corners.vertices, named, corners.lines, len(normals), name)
    if len(normals) == vertices and np.array_equal(named, corners.vertices.values):
        return normals
    if not len(named) or (named == -1).any():
        return None
    return _agreed(normals, corners.vertices.values, named, vertices)


def _agreed(normals: Floats, at: Integers, named: Integers, vertices: int) -> Floats | None:
    """Give each vertex the normal of its corners; None if these differ."""
    of_vertices = np.zeros((vertices, 3))
    of_vertices[at] = normals[named]
    runs = range(0, len(at), _RUN)
    agree = (
        np.array_equal(of_vertices[at[k : k + _RUN]], normals[named[k : k + _RUN]], equal_nan=True)
        for k in runs
    )
    return of_vertices if all(agree) else None


def _check(vertices: Ragged, named: Integers, lines: Integers, count: int, name: str) -> None:
    wrong = np.flatnonzero((named < -1) | (named >= count))
    if len(wrong):
        line = lines[vertices.row_of(int(wrong[0]))]
        text = outside(int(named[wrong[0]]), count, "normal")
        raise FormatError(f"{name}: line {line}: a corner {text}")


def write_obj(
    stream: BinaryIO,
    cloud: Cloud,
    *,
    colors: ObjColors = "values",
    comments: Sequence[str] = (),
    up: Up = "z",
    origin: OriginChoice = None,
) -> Origin | None:
    """Write a cloud, or a mesh, as OBJ."""
    check_option("colors", colors, ObjColors)
    check_option("up", up, Up)
    zero = chosen_origin(origin, cloud.points)
    note = ({"up": up} if up == "y" else {}) | ({} if zero is None else {"origin": [*zero]})
    axes = [_AXES + as_text(note)] if note else []
    for comment in header_comments(cloud.crs, storable(cloud.metadata), comments, axes):
        if not comment.isprintable() or comment.endswith("\\"):
            raise FormatError(f"comment {comment!r} is not a single line, as OBJ files require")
        stream.write(f"# {comment}\n".encode())
    held = None if colors == "none" else cloud.colors
    values = [] if held is None or colors == "comments" else [color_columns(held)]
    eight_bits = held is not None and held.dtype == np.uint8
    turn = turned if up == "y" else _same
    points = turn(without_origin(cloud.points, zero))
    write_rows(stream, [points, *values], prefix="v ", shortest=eight_bits)
    if held is not None and colors == "comments":
        write_comments(stream, held)
    if cloud.normals is not None:
        write_rows(stream, [turn(cloud.normals)], prefix="vn ")
    if cloud.faces is not None:
        _write_faces(stream, cloud.faces, normals=cloud.normals is not None)
    if len(edges := edges_of(cloud)):
        write_rows(stream, [edges], prefix="l ", plus=1)
    return zero


def _same(rows: Floats) -> Floats:
    return rows


def _write_faces(stream: BinaryIO, faces: Array, *, normals: bool) -> None:
    a, b, c = faces.T
    columns = [a, a, b, b, c, c] if normals else [a, b, c]
    between = ("//", " ", "//", " ", "//") if normals else " "
    write_rows(stream, columns, prefix="f ", between=between, plus=1)


def dropped_parts(cloud: Cloud, options: Mapping[str, Any]) -> tuple[str, ...]:
    """Colours within printed precision of 8-bit ones are read as these; an origin may round."""
    zero = chosen_origin(options.get("origin"), cloud.points)
    with np.errstate(invalid="ignore"):
        again = without_origin(cloud.points, zero) + (0.0 if zero is None else np.array(zero))
    is_exact = zero is None or np.array_equal(again, cloud.points, equal_nan=True)
    return (*_dropped_colors(cloud, options), *(() if is_exact else ("float64",)))


def _dropped_colors(cloud: Cloud, options: Mapping[str, Any]) -> tuple[str, ...]:
    if options.get("colors", "values") != "values":
        return ("deep_colors", *(["colors"] if options["colors"] == "none" else []))
    if cloud.colors is None or fits_eight_bits(cloud.colors[:, :3]):
        return ()
    levels = recognized(as_float(cloud.colors[:, :3]))
    return () if levels is not None and levels.dtype.kind == "f" else ("deep_colors",)
