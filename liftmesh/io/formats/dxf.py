"""DXF as text: surfaces, lines and points of drawings, reader and writer.

A drawing is a sequence of pairs of lines, a code and a value. Of its entities these are read: faces
(3DFACE, and polyface meshes), points, and lines with straight parts (LINE, POLYLINE, LWPOLYLINE),
whose parts are edges. Equal corners of faces and lines are one row, in the order of their first
appearance; points are rows of their own, before these. Polylines of a plane that is seen from below
(extrusion 0, 0, -1) are turned. Curves, blocks, layouts on paper and other planes are counted and
left out. The pairs are read one by one, so that memory has the
numbers alone.

Faces are written as 3DFACE, edges as LINE, with digits that round-trip, as DXF of R12.

Source: DXF Reference, Autodesk.
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterator
from typing import BinaryIO, TypeAlias

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted
from liftmesh.errors import FormatError
from liftmesh.io.columns import edges_of, faces_of
from liftmesh.io.formats.stl import weld
from liftmesh.io.metadata import noted
from liftmesh.io.text_tables import count_kind, quoted, shortened, write_rows

Tags: TypeAlias = dict[int, list[float]]

_BINARY = b"AutoCAD Binary DXF"
_PIECE, _LONGEST = 1 << 18, 1 << 20  # bytes that are read at a time, and of a line
_MOST_WHOLE = 2.0**31
_LISTED = 8
_AT_ONCE = 1 << 16  # rows that are written at a time
_POINT, _FACE, _LINE, _LIGHT, _HEAVY, _VERTEX = (
    *("POINT", "3DFACE", "LINE", "LWPOLYLINE", "POLYLINE", "VERTEX"),
)  # fmt: skip
_TAKEN = {_POINT, _FACE, _LINE, _LIGHT, _HEAVY, _VERTEX}
_NUMBERS = {
    *range(10, 14), *range(20, 24), *range(30, 34), 38, 42, 67, 70, *range(71, 75), 210, 220, 230,
}  # fmt: skip
_FIRST, _SECOND = (10, 20, 30), (11, 21, 31)
_CLOSED, _SPATIAL, _GRID, _POLYFACE = 1, 8, 16, 64  # flags of polylines
_OF_FACE, _FRAME = 128, 16  # flags of a vertex: without that of a place; of a spline's frame
_ON_PAPER = 67


def read_dxf(stream: BinaryIO, name: str) -> Cloud:
    """Read the faces, lines and points of a drawing."""
    drawing = _Drawing(name)
    for kind, tags, line in _entities(stream, name):
        drawing.take(kind, tags, line)
    return drawing.cloud()


def _lines(stream: BinaryIO, name: str) -> Iterator[list[bytes]]:
    """Yield lists of lines, of an even number each."""
    rest: list[bytes] = [b""]
    while data := stream.read(_PIECE):
        lines = data.split(b"\n")
        rest[-1] += lines[0]
        rest += lines[1:]
        whole = (len(rest) - 1) // 2 * 2
        if whole:
            yield rest[:whole]
        rest = rest[whole:]
        if len(rest[-1]) > _LONGEST:
            raise FormatError(f"{name}: a line of more than {_LONGEST:,} bytes, which DXF has not")
    if rest[0].strip():
        yield [*rest, b""][:2]


def _pairs(stream: BinaryIO, name: str) -> Iterator[tuple[int, bytes, int]]:
    """Yield the code and the value of each pair, and the line of the value."""
    number = 0
    for lines in _lines(stream, name):
        for text, value in zip(lines[::2], lines[1::2], strict=True):
            number += 2
            try:
                code = int(text)
            except ValueError as error:
                if text.startswith(_BINARY):
                    raise FormatError(f"{name}: binary DXF is not read: save it as text") from error
                shown = quoted(text.decode("latin-1").strip())
                raise FormatError(
                    f"{name}: line {number - 1}: {shown} is no code of DXF"
                ) from error
            yield code, value, number


def _entities(stream: BinaryIO, name: str) -> Iterator[tuple[str, Tags, int]]:
    """Yield the entities of a drawing: kind, numbers by their codes, and the line of the kind."""
    section, kind, is_taken, is_named = b"", "", False, False
    tags, begin = Tags(), 0
    for code, text, number in _pairs(stream, name):
        if is_taken and code in _NUMBERS:
            tags.setdefault(code, []).append(_number(text, number, name))
        elif code == 0:
            if kind:
                yield kind, tags, begin
            value = text.strip()
            is_named = value == b"SECTION"
            section = b"" if value == b"ENDSEC" else section
            kind = value.decode("latin-1") if section == b"ENTITIES" else ""
            is_taken, tags, begin = kind in _TAKEN, {}, number
        elif is_named and code == 2:
            section, is_named = text.strip(), False
    if kind:
        raise FormatError(f"{name}: it ends within a {shortened(kind)}: it is cut off")


def _number(text: bytes, line: int, name: str) -> float:
    try:
        return float(text if b"_" not in text else b"")  # Python allows 1_000
    except ValueError as error:
        shown = quoted(text.decode("latin-1").strip())
        raise FormatError(f"{name}: line {line}: {shown} is not a number") from error


def _whole(tags: Tags, code: int = 70) -> int:
    """Return a whole number of an entity, as its flags are; 0 if it is not there."""
    value = tags.get(code, [0.0])[0]
    return int(value) if abs(value) < _MOST_WHOLE else 0


def _side(tags: Tags) -> int:
    """Return -1 for what is drawn in the plane, but seen from below: there x and z are turned."""
    return -1 if tags.get(230, [1.0])[0] < 0 else 1


class _Drawing:
    """What the entities so far hold."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._points, self._corners = array("d"), array("d")
        self._faces, self._edges = array("q"), array("q")  # numbers of corners
        self._left_out: Counter[str] = Counter()
        # Of a POLYLINE flags, elevation, and -1 if it is seen from below.
        self._open: tuple[int, float, int] | None = None
        self._chain: list[tuple[float, float, float]] = []
        self._records: list[list[int]] = []

    def take(self, kind: str, tags: Tags, line: int) -> None:
        """Take an entity."""
        if kind == _VERTEX and self._open is not None:
            self._take_vertex(tags, line)
            return
        self._end()  # SEQEND may be missing
        if kind == "SEQEND":
            return
        reason = self._refused(kind, tags)
        if reason:
            count_kind(self._left_out, reason)
        if kind == _HEAVY:
            flags = _GRID if reason else _whole(tags)
            self._open = (flags, tags.get(30, [0.0])[0], _side(tags))
        elif not reason:
            self._take_simple(kind, tags, line)

    def _refused(self, kind: str, tags: Tags) -> str:
        """Say what an entity is that is left out."""
        if kind not in _TAKEN or kind == _VERTEX:
            return shortened(kind)
        if _whole(tags, _ON_PAPER):
            return f"paper {kind}"
        if kind in (_LIGHT, _HEAVY) and self._is_turned(tags):
            return f"turned {kind}"
        return "POLYLINE grid" if kind == _HEAVY and _whole(tags) & _GRID else ""

    def _is_turned(self, tags: Tags) -> bool:
        is_spatial = _whole(tags) & (_SPATIAL | _POLYFACE) and 30 in tags
        return not is_spatial and (bool(tags.get(210, [0.0])[0]) or bool(tags.get(220, [0.0])[0]))

    def _take_simple(self, kind: str, tags: Tags, line: int) -> None:
        if kind == _POINT:
            self._points.extend(self._place(tags, 10, line))
        elif kind == _FACE:
            corners = [self._place(tags, 10 + k, line) for k in range(4 if 13 in tags else 3)]
            self._add_face(corners)
        elif kind == _LINE:
            self._chain = [self._place(tags, 10, line), self._place(tags, 11, line)]
            self._end_chain(is_closed=False)
        else:
            x, y, height = tags.get(10, []), tags.get(20, []), tags.get(38, [0.0])[0]
            if len(x) != len(y):
                raise FormatError(
                    f"{self._name}: line {line}: {kind} has {len(x)} x and {len(y)} y"
                )
            if _side(tags) < 0:
                x, height = [-each for each in x], -height
            self._chain = [(*each, height) for each in zip(x, y, strict=True)]
            self._count_arcs(tags)
            self._end_chain(is_closed=bool(_whole(tags) & _CLOSED))

    def _count_arcs(self, tags: Tags) -> None:
        arcs = sum(each != 0 for each in tags.get(42, []))
        if arcs:
            self._left_out["arc"] += arcs

    def _place(self, tags: Tags, code: int, line: int) -> tuple[float, float, float]:
        x, y, z = (tags.get(code + 10 * k, [None])[0] for k in range(3))
        if x is None or y is None:
            raise FormatError(
                f"{self._name}: line {line}: an entity without x and y (codes {code} and "
                f"{code + 10})"
            )
        return x, y, 0.0 if z is None else z

    def _take_vertex(self, tags: Tags, line: int) -> None:
        flags, height, side = self._open or (0, 0.0, 1)
        own = _whole(tags)
        if flags & _GRID or (own & _FRAME and not flags & _POLYFACE):
            return
        if flags & _POLYFACE and own & _OF_FACE and not own & _POLYFACE:
            corners = (abs(_whole(tags, code)) for code in range(71, 75))
            self._records.append([each for each in corners if each])
            return
        x, y, z = self._place(tags, 10, line)
        is_spatial = flags & (_SPATIAL | _POLYFACE)
        self._chain.append((x, y, z) if is_spatial else (side * x, y, side * height))
        self._count_arcs(tags)

    def _end(self) -> None:
        """End a POLYLINE."""
        if self._open is None:
            return
        (flags, *_), self._open = self._open, None
        if not flags & (_POLYFACE | _GRID):
            self._end_chain(is_closed=bool(flags & _CLOSED))
            return
        places, self._chain, records, self._records = self._chain, [], self._records, []
        for record in records:
            if max(record, default=0) > len(places):
                raise FormatError(
                    f"{self._name}: a face of a polyface mesh names vertex {max(record)} of "
                    f"{len(places)}"
                )
            if len(record) >= 3:
                self._add_face([places[each - 1] for each in record])

    def _end_chain(self, *, is_closed: bool) -> None:
        chain, self._chain = self._chain, []
        begin = len(self._corners) // 3
        for each in chain:
            self._corners.extend(each)
        ends = range(begin, begin + len(chain) - 1)
        for k in ends:
            self._edges.extend((k, k + 1))
        if is_closed and len(chain) > 2:
            self._edges.extend((begin + len(chain) - 1, begin))

    def _add_face(self, corners: list[tuple[float, float, float]]) -> None:
        begin = len(self._corners) // 3
        for each in corners:
            self._corners.extend(each)
        self._faces.extend((begin, begin + 1, begin + 2))
        if len(corners) == 4 and corners[3] not in (corners[2], corners[0]):
            self._faces.extend((begin, begin + 2, begin + 3))

    def cloud(self) -> Cloud:
        """Return points, then the corners of faces and lines."""
        self._end()
        points = _rows(self._points)
        corners = _rows(self._corners)
        if not len(points) and not len(corners):
            others = ", ".join(counted(n, kind) for kind, n in self._left_out.most_common(_LISTED))
            but = f", but {others}" if others else ""
            raise FormatError(f"{self._name}: there are no faces, lines and points in it{but}")
        kept, place = weld(corners)
        rows = (place + len(points)).astype(np.int32)
        faces = rows[np.frombuffer(self._faces, np.int64)].reshape(-1, 3)
        edges = rows[np.frombuffer(self._edges, np.int64)].reshape(-1, 2)
        left_out = (counted(count, kind) for kind, count in self._left_out.items())
        return Cloud(
            np.concatenate([points, corners[kept]]),
            faces=faces if len(faces) else None,
            edges=edges if len(edges) else None,
            metadata=noted({}, not_read=tuple(left_out)),
        )


def _rows(numbers: array[float]) -> Floats:
    return np.frombuffer(numbers, np.float64).reshape(-1, 3)


def write_dxf(stream: BinaryIO, cloud: Cloud) -> None:
    """Write faces and edges."""
    faces, edges = faces_of(cloud), edges_of(cloud)
    stream.write(b"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n")
    stream.write(b"0\nSECTION\n2\nENTITIES\n")
    _write_entities(stream, _FACE, cloud.points, faces[:, [0, 1, 2, 2]])
    _write_entities(stream, _LINE, cloud.points, edges)
    stream.write(b"0\nENDSEC\n0\nEOF\n")


def _write_entities(stream: BinaryIO, kind: str, points: Floats, rows: Rows) -> None:
    if not len(rows):
        return
    codes = [10 * axis + corner for corner in range(rows.shape[1]) for axis in (1, 2, 3)]
    for begin in range(0, len(rows), _AT_ONCE):
        columns = points[rows[begin : begin + _AT_ONCE]].reshape(-1, len(codes))
        between = [f"\n{code}\n" for code in codes[1:]]
        write_rows(stream, [columns], prefix=f"0\n{kind}\n8\n0\n10\n", between=between)
