"""LandXML 1.2, the surfaces of civil engineering: reader and writer.

*Read* are a surface of a file, its breaklines, or the points of a survey (CgPoints). expat hands
over one element after another, so that memory has the numbers and none of the tree. Document types,
and so entities, are refused, and so are crowds of names, deep nesting and tags longer than any
program writes, for which expat takes far more memory or time than the file has bytes. Nothing that
a file names is opened.

Points are northing, easting and height. Faces name points by their ids; those with ``i="1"`` are
invisible and left out. What ``n=`` says of neighbours is not needed. Each two successive corners of
a breakline are an edge; where there are faces, both have to be at points of the surface. A surface
without points and faces is that of its source data: data points, and corners of breaklines.

*Written* are digits that round-trip; a face lists its points counter-clockwise seen from above.
Edges are breaklines of two points, which hold their coordinates. A file has one unit of length for
all three, which is that of the coordinate system, and metres where there is none. The format
demands a date: it is that of no day, since bytes are a function of the mesh.

Source: LandXML-1.2 schema, landxml.org, 2008.
"""

from __future__ import annotations

import re
from array import array
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from typing import Any, BinaryIO
from xml.parsers import expat  # opens nothing, and document types are refused

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted, refused
from liftmesh.crs.description import is_number, urn_of
from liftmesh.crs.units import band_unit, length_unit
from liftmesh.errors import FormatError, Option
from liftmesh.io.columns import Ragged, edges_of, face_counts, faces_of, triangulated
from liftmesh.io.formats.stl import weld
from liftmesh.io.markup import attribute, is_possible
from liftmesh.io.metadata import noted
from liftmesh.io.text_tables import Block, is_count, quoted, ragged_numbers, write_rows

LANDXML = "landxml"
"""The entry of the metadata with the "surface" of a file, and its "unit"."""

POINTS = "CgPoints"
"""What `landxml_surface=` calls the points of a survey."""

_ENCODINGS = {"UTF-8", "UTF-16", "US-ASCII", "ISO-8859-1", "WINDOWS-1252"}
_PIECE, _TAG = 1 << 16, 1 << 18  # bytes
_DEEPEST, _NAMES = 64, 4096  # elements within one another; names of elements and attributes
_BATCH = 1 << 14  # rows parsed at a time
_LISTED = 12
_KNOWN = {"Units", "CoordinateSystem", "Project", "Application", "Surfaces", POINTS}
_UNITS = {
    "meter": "metre", "foot": "foot", "USSurveyFoot": "US survey foot",
    "millimeter": "millimetre", "centimeter": "centimetre", "kilometer": "kilometre",
    "inch": "inch", "mile": "mile",
}  # fmt: skip


def validate_landxml_options(*, landxml_surface: str | None = None) -> str | None:
    """Check the name of a surface."""
    if landxml_surface is not None and not isinstance(landxml_surface, str):
        raise refused("landxml_surface", landxml_surface, "give the name of a surface in the file")
    return landxml_surface


def read_landxml(stream: BinaryIO, name: str, *, options: str | None = None) -> Cloud:
    """Read a surface, or the points of a file without surfaces."""
    document = _Document(name, options)
    document.parse(stream)
    return document.cloud()


class _Rows:
    """The numbers of elements, each of which is a row, parsed a batch at a time."""

    def __init__(self, name: str, what: str, sizes: Callable[[Array], Mask]) -> None:
        self._name = name
        self._what = what
        self._fits = sizes
        self._texts: list[str] = []
        self._lines: list[int] = []
        self._parts: list[Ragged] = []
        self.count = 0

    def add(self, text: str, line: int) -> None:
        """Add a row, and the line of its element."""
        text = text.replace("\n", " ").replace("\r", " ").strip()
        if not text:
            raise FormatError(f"{self._name}: line {line}: an element without {self._what}")
        self.count += 1
        self._texts.append(text)
        self._lines.append(line)
        if len(self._texts) == _BATCH:
            self._parse()

    def rows(self) -> Ragged:
        """Return all rows, which are not held any longer."""
        if self._texts:
            self._parse()
        parts, self._parts = self._parts, []
        return Ragged.joined(parts) if parts else Ragged.empty(np.dtype(np.float64))

    def places(self) -> tuple[Floats, Integers]:
        """Return x, y and z of the points in all rows, and how many numbers each row has."""
        rows = self.rows()
        points: Floats = rows.values.reshape(-1, 3)[:, [1, 0, 2]].astype(np.float64)
        return points, rows.sizes

    def _parse(self) -> None:
        block = Block.of(self._texts, np.array(self._lines))
        numbers = ragged_numbers(block, self._name)
        fits = self._fits(numbers.sizes)
        if not fits.all():
            row = int(np.argmin(fits))
            raise FormatError(
                f"{self._name}: line {self._lines[row]}: {quoted(self._texts[row])} has "
                f"{counted(int(numbers.sizes[row]), 'number')}: expected {self._what}"
            )
        self._parts.append(numbers)
        self._texts, self._lines = [], []


class _Document:
    """What is kept of a file while it is parsed."""

    def __init__(self, name: str, wanted: str | None) -> None:
        self._name = name
        self._wanted = wanted
        self._parser = expat.ParserCreate()
        self._open: list[str] = []
        self._seen: set[str] = set()
        self._texts: list[str] = []
        self._line = 0
        self._surfaces: list[str] = []
        self._is_inside = self._is_visible = False
        self._left_out: Counter[str] = Counter()
        self._said: dict[str, str] = {}
        self._crs: str | None = None
        position = "northing, easting and height"
        self._ids = array("q")
        self._points = _Rows(name, position, lambda sizes: sizes == 3)
        self._faces = _Rows(name, "three or four points", lambda sizes: (sizes == 3) | (sizes == 4))
        self._data = _Rows(name, f"{position} of each point", lambda sizes: sizes % 3 == 0)
        self._lines = _Rows(name, f"{position} of each corner", lambda sizes: sizes % 3 == 0)
        self._survey = _Rows(name, position, lambda sizes: (sizes == 2) | (sizes == 3))

    def parse(self, stream: BinaryIO) -> None:
        """Parse a file."""
        parser, done = self._parser, 0
        parser.buffer_text = True
        parser.XmlDeclHandler = self._declared
        parser.StartDoctypeDeclHandler = self._typed
        parser.StartElementHandler = self._begun
        parser.EndElementHandler = self._ended
        parser.CharacterDataHandler = self._texts.append
        try:
            while data := stream.read(_PIECE):
                parser.Parse(data, False)
                done += len(data)
                if done - max(parser.CurrentByteIndex, 0) > _TAG:
                    raise self._error(f"a tag or a comment of more than {_TAG:,} bytes")
            parser.Parse(b"", True)
        except expat.ExpatError as error:
            raise FormatError(f"{self._name}: damaged, or no LandXML: {error}") from error
        del self._parser  # which holds this object

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: line {self._parser.CurrentLineNumber}: {cause}")

    def _declared(self, _: str, encoding: str | None, __: int) -> None:
        if encoding is not None and encoding.upper() not in _ENCODINGS:
            raise self._error(f"XML in {quoted(encoding)} is not read: save it as UTF-8")

    def _typed(self, *_: object) -> None:
        raise self._error("a document type, which LandXML has not")

    def _begun(self, tag: str, attributes: dict[str, str]) -> None:
        self._texts.clear()
        tag = tag.rpartition(":")[2]
        if not self._open and tag != "LandXML":
            raise self._error(f"the file is {quoted(tag)}, not LandXML")
        self._open.append(tag)
        self._seen.add(tag)
        self._seen.update(attributes)
        if len(self._open) > _DEEPEST or len(self._seen) > _NAMES:
            what = f"elements more than {_DEEPEST} deep, or more than {_NAMES:,} names of them"
            raise self._error(f"{what}, which LandXML has not")
        self._line = self._parser.CurrentLineNumber
        if begin := _BEGINS.get(tag):
            getattr(self, begin)(attributes)
        if len(self._open) == 2 and tag not in _KNOWN:
            self._left_out[f"{tag} element"] += 1

    def _ended(self, _: str) -> None:
        tag = self._open.pop()
        if end := _ENDS.get(tag):
            getattr(self, end)("".join(self._texts), self._open[-1])
        self._texts.clear()

    def _units(self, attributes: dict[str, str]) -> None:
        unit = _UNITS.get(attributes.get("linearUnit", ""))
        if unit is not None and self._open[-2:-1] == ["Units"]:
            self._said["unit"] = unit

    def _system(self, attributes: dict[str, str]) -> None:
        described, number = attributes.get("desc", ""), attributes.get("epsgCode", "")
        numbered = f"EPSG:{number}" if is_count(number, 9) else None
        stated = attributes.get("ogcWktCode") or numbered
        self._crs = described if is_number(described) else stated

    def _surface(self, attributes: dict[str, str]) -> None:
        found = attributes.get("name", "")
        is_wanted = not self._surfaces if self._wanted is None else found == self._wanted
        if is_wanted and found in self._surfaces:
            raise self._error(f"two surfaces are named {quoted(found)}: rename one")
        self._surfaces.append(found)
        self._is_inside = is_wanted
        if is_wanted and found:
            self._said["surface"] = found

    def _point(self, attributes: dict[str, str]) -> None:
        if self._is_inside:
            number = attributes.get("id", "").strip()
            if not is_count(number):
                raise self._error(f"the id of a point is {quoted(number)}: expected a whole number")
            self._ids.append(int(number))

    def _face(self, attributes: dict[str, str]) -> None:
        self._is_visible = attributes.get("i", "").strip() not in {"1", "true"}
        if self._is_inside and not self._is_visible:
            self._left_out["invisible face"] += 1

    def _counted(self, _: dict[str, str]) -> None:
        if self._is_inside:
            self._left_out[f"{self._open[-1]} element"] += 1

    def _end_surface(self, _: str, __: str) -> None:
        self._is_inside = False

    def _end_point(self, text: str, _: str) -> None:
        if self._is_inside:
            self._points.add(text, self._line)

    def _end_face(self, text: str, _: str) -> None:
        if self._is_inside and self._is_visible:
            self._faces.add(text, self._line)

    def _end_list(self, text: str, parent: str) -> None:
        if self._is_inside and parent in {"Breakline", "DataPoints"}:
            (self._lines if parent == "Breakline" else self._data).add(text, self._line)

    def _end_survey_point(self, text: str, _: str) -> None:
        if text.strip():  # else it names another one
            self._survey.add(text, self._line)

    def cloud(self) -> Cloud:
        """Return what was chosen of the file."""
        if self._is_survey():
            return self._made(_padded(self._survey.rows()), self._left_out)
        if self._survey.count:
            self._left_out["survey point"] = self._survey.count
        if self._points.count:
            return self._of_surface()
        if self._faces.count:
            raise FormatError(f"{self._name}: there are faces, but no points")
        if not self._data.count and not self._lines.count:
            chosen = self._surfaces[0] if self._wanted is None else self._wanted
            raise FormatError(f"{self._name}: there is nothing in the surface {quoted(chosen)}")
        return self._of_sources()

    def _is_survey(self) -> bool:
        """Whether the points of the survey are chosen; raise if it is not clear what is."""
        names = [*self._surfaces, *[POINTS] * bool(self._survey.count)]
        if not names:
            raise FormatError(f"{self._name}: there are no surfaces and no points in it")
        if self._wanted is None and len(self._surfaces) < 2:
            return not self._surfaces
        if self._wanted in names:
            return self._wanted not in self._surfaces
        listed = ", ".join(map(quoted, names[:_LISTED])) + ", ..." * (len(names) > _LISTED)
        given = "" if self._wanted is None else f", but not {quoted(self._wanted)}"
        raise FormatError(
            f"{self._name}: it has the surfaces {listed}{given}: choose one with "
            f"{Option('landxml_surface', ...)}"
        )

    def _of_surface(self) -> Cloud:
        self._left_out["DataPoints list"] = self._data.count
        (points, _), order = self._points.places(), np.argsort(self._ids, kind="stable")
        ids = np.frombuffer(self._ids, np.int64)[order]
        if (same := np.flatnonzero(ids[1:] == ids[:-1])).size:
            raise FormatError(f"{self._name}: two points have the id {ids[same[0]]}")
        faces = self._faces.rows()
        place = np.minimum(np.searchsorted(ids, faces.values), len(ids) - 1)
        if (unknown := np.flatnonzero(ids[place] != faces.values)).size:
            wrong = int(unknown[0])
            raise FormatError(
                f"{self._name}: face {faces.row_of(wrong) + 1} names the point "
                f"{faces.values[wrong]:.15g}, which is not there"
            )
        corners = Ragged(faces.sizes, order[place].astype(np.int32))
        edges, _ = _edges(points, self._lines)
        kept = edges[(edges < len(points)).all(axis=1)]
        self._left_out["stray breakline segment"] = len(edges) - len(kept)
        made = triangulated(corners, len(points), self._name) if len(corners.sizes) else None
        return self._made(points, self._left_out, face_counts(corners), faces=made, edges=kept)

    def _of_sources(self) -> Cloud:
        """Return the data points and the corners of breaklines; edges are these lines."""
        edges, points = _edges(self._data.places()[0], self._lines)
        return self._made(points, self._left_out, edges=edges)

    def _made(
        self,
        points: Floats,
        left_out: Counter[str],
        counts: dict[str, int] | None = None,
        faces: Rows | None = None,
        edges: Rows | None = None,
    ) -> Cloud:
        names = tuple(counted(count, what) for what, count in left_out.items() if count)
        entries = {LANDXML: self._said} if self._said else {}
        known = noted({**entries, **(counts or {})}, not_read=names)
        edges = edges if edges is not None and len(edges) else None
        return Cloud(points, faces=faces, edges=edges, metadata=known, crs=self._crs or None)


_BEGINS = {
    "Metric": "_units",
    "Imperial": "_units",
    "CoordinateSystem": "_system",
    "Surface": "_surface",
    "P": "_point",
    "F": "_face",
    "Boundary": "_counted",
    "Contour": "_counted",
    "PntList2D": "_counted",
}
_ENDS = {
    "Surface": "_end_surface",
    "P": "_end_point",
    "F": "_end_face",
    "PntList3D": "_end_list",
    "CgPoint": "_end_survey_point",
}


def _padded(rows: Ragged) -> Floats:
    """Return x, y and z of points; heights that are not there are NaN."""
    starts = np.cumsum(rows.sizes) - rows.sizes
    values = np.append(rows.values.astype(np.float64), np.nan)
    last = np.where(rows.sizes == 3, starts + 2, len(values) - 1)
    return np.stack([values[starts + 1], values[starts], values[last]], axis=1)


def _edges(points: Floats, lines: _Rows) -> tuple[Rows, Floats]:
    """Return edges along lines, and points with the corners that are at none before them."""
    corners, sizes = lines.places()
    together = np.concatenate([points, corners])
    kept, found = weld(together)
    row = kept[found[len(points) :]]
    is_new = row >= len(points)
    new, place = np.unique(row[is_new], return_inverse=True)
    row[is_new] = len(points) + place
    is_last = np.zeros(len(corners), np.bool_)
    is_last[np.cumsum(sizes // 3) - 1] = True
    begins = np.flatnonzero(~is_last)
    edges = np.stack([row[begins], row[begins + 1]], axis=1).astype(np.int32)
    return edges, np.concatenate([points, corners[new - len(points)]])


_SPACE = "http://www.landxml.org/schema/LandXML-1.2"
_EPSG = re.compile(r"^urn:ogc:def:crs:EPSG::([0-9]{1,9})$")
_METRIC = (
    '<Metric areaUnit="squareMeter" linearUnit="meter" volumeUnit="cubicMeter" '
    'temperatureUnit="celsius" pressureUnit="milliBars"/>'
)
_IMPERIAL = (
    '<Imperial areaUnit="squareFoot" linearUnit="{}" volumeUnit="cubicFeet" '
    'temperatureUnit="fahrenheit" pressureUnit="inHG"/>'
)
_WRITTEN_UNITS = {
    "metre": _METRIC,
    "foot": _IMPERIAL.format("foot"),
    "US survey foot": _IMPERIAL.format("USSurveyFoot"),
}


def write_landxml(stream: BinaryIO, cloud: Cloud, *, name: str | None = None) -> None:
    """Write a mesh as a LandXML surface."""
    name = _stated_name(cloud) if name is None else name
    if not isinstance(name, str) or not is_possible(name):
        raise FormatError(f"name is {name!r}: give a text that XML can hold")
    units = _units(cloud)
    heights = cloud.points[:, 2]
    low, high = float(heights.min()), float(heights.max())
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<LandXML xmlns="{_SPACE}" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
        f'xsi:schemaLocation="{_SPACE} {_SPACE}/LandXML-1.2.xsd" version="1.2" '
        'date="1970-01-01" time="00:00:00">\n'
        f"<Units>{units}</Units>\n{_system(cloud.crs)}"
        '<Application name="liftmesh"/>\n'
        f"<Surfaces>\n<Surface name={attribute(name)}>\n"
    )
    stream.write(head.encode())
    _write_breaklines(stream, cloud)
    definition = f'<Definition surfType="TIN" elevMin="{low!r}" elevMax="{high!r}">\n<Pnts>\n'
    stream.write(definition.encode())
    numbers = np.arange(1, len(cloud) + 1)
    columns = [numbers, cloud.points[:, 1], cloud.points[:, 0], heights]
    write_rows(stream, columns, prefix='<P id="', between=('">', " ", " "), end="</P>\n")
    stream.write(b"</Pnts>\n<Faces>\n")
    write_rows(stream, [faces_of(cloud)], prefix="<F>", plus=1, end="</F>\n")
    stream.write(b"</Faces>\n</Definition>\n</Surface>\n</Surfaces>\n</LandXML>\n")


def _write_breaklines(stream: BinaryIO, cloud: Cloud) -> None:
    if not len(edges := edges_of(cloud)):
        return
    stream.write(b"<SourceData>\n<Breaklines>\n")
    ends = np.hstack([cloud.points[end][:, [1, 0, 2]] for end in edges.T])
    begin, end = '<Breakline brkType="standard"><PntList3D>', "</PntList3D></Breakline>\n"
    write_rows(stream, [ends], prefix=begin, end=end)
    stream.write(b"</Breaklines>\n</SourceData>\n")


def _stated_name(cloud: Cloud) -> str:
    """Return the name that a surface had in its file."""
    entry = cloud.metadata.get(LANDXML)
    name = entry.get("surface") if isinstance(entry, Mapping) else None
    return name if isinstance(name, str) and is_possible(name) else "surface"


def dropped_parts(cloud: Cloud, _: Mapping[str, Any]) -> Collection[str]:
    """Return what is lost of this cloud: a coordinate system that XML cannot hold."""
    return ("crs",) if cloud.crs is not None and not is_possible(cloud.crs) else ()


def check(cloud: Cloud) -> None:
    """Raise if coordinates have no unit of LandXML."""
    _units(cloud)


def _units(cloud: Cloud) -> str:
    name = length_unit(cloud.crs, "LandXML", band_unit(cloud)) or "metre"
    if name not in _WRITTEN_UNITS:
        raise FormatError(f"the unit is {name}, but LandXML has {', '.join(_WRITTEN_UNITS)}")
    return _WRITTEN_UNITS[name]


def _system(crs: str | None) -> str:
    if crs is None or not is_possible(crs):
        return ""
    number = _EPSG.search(urn_of(crs))
    code = "" if number is None else f' epsgCode="{number[1]}"'
    kind = "desc" if is_number(crs) else "ogcWktCode"
    return f"<CoordinateSystem {kind}={attribute(crs)}{code}/>\n"
