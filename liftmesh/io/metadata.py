"""Metadata in files: what the user or a file said of a cloud as a whole.

What a reader notes of its own file, such as its name or what it skipped, belongs to that file: it
is never written, so that bytes are a function of the mesh. Its notes have types of their own, by
which they are known: what a caller or another library says under the same keys is theirs, is not
stored, and is named. All else is stored as JSON, one object of one entry each: in comments as
``metadata {"survey": "2024"}``, in NPZ as a text, in glTF as extras. An entry is stored if JSON
holds it without loss (tuples come back as lists) and it is not too long; others are named in
`WriteResult.dropped`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from liftmesh.base.cloud import is_crs
from liftmesh.io.markup import ascii_string, parsed_or_none

if TYPE_CHECKING:
    from typing_extensions import Unpack

TRANSFORMATION = "transformation"
"""The entry that says how coordinates were transformed as they were read."""

LIFTED = "triangulated_by"
"""The entry that says by what the points of a mesh were lifted, if not to the paraboloid."""

CARVED = "carved"
"""The entry that says that regions that edges bound are missing from a mesh."""

OWN = "liftmesh"  # the comment that begins every header

# Lines of a file, which PLY keeps as such.
LINES = ("comments", "obj_info")

# What begins the comments that state a coordinate system, an entry, or something else.
_CRS, _STATED = "crs ", "metadata "
_STATEMENTS = (_STATED, _CRS, "property ", "color_depth ")

# Characters of an entry, and of all: a line of a PLY header is as long at most, and objects of
# Python take up to 64 times their JSON.
LONGEST = (1 << 15) - 64
_MOST = 1 << 18
_LINE = 40  # more than the characters around a line that is stated by itself


class Label(str):
    """The name or the format of a file, as `read` notes it."""

    __slots__ = ()


class Unread(tuple[str, ...]):
    """What an object of another library has and its cloud has not."""

    __slots__ = ()


class NotedColumns(dict[str, str]):
    """Which columns of a table are what, as its reader notes it."""


class Notes(TypedDict, total=False):
    """What readers note of their file, and functions of a cloud of their work."""

    source: Label
    format: Label
    columns: NotedColumns
    notes: tuple[str, ...]
    not_read: tuple[str, ...]
    polygons: int
    degenerate_faces: int
    repeated_vertices: int
    ignored: dict[str, int]
    origin: tuple[float, float, float] | None
    selection: Mapping[str, int]
    las_records: Mapping[str, bytes]
    merged: list[dict[str, Any]]
    thinning: Mapping[str, Any]
    ground: Mapping[str, Any]
    stated_crs: str | None
    transformation: Mapping[str, Any]


_LABELS = ("source", "format")  # which `read` notes of every cloud
_OF_TABLES = ("columns", "notes")  # also of tables in memory, which have no labels
_NOTES = frozenset(Notes.__annotations__)


def noted(metadata: Mapping[str, Any], **notes: Unpack[Notes]) -> dict[str, Any]:
    """Add notes to metadata, but for those that say nothing."""
    return {**metadata, **{key: each for key, each in notes.items() if each not in (None, (), {})}}


def with_carved(metadata: Mapping[str, Any], carved: bool) -> Mapping[str, Any]:
    """State whether regions that edges bound are missing from a mesh."""
    if not isinstance(metadata, Mapping):
        return metadata  # the cloud that it is for refuses it
    others = {key: each for key, each in metadata.items() if key != CARVED or each is not True}
    return others | {CARVED: True} if carved else others


def user_entries(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries that are not a reader's notes, sorted by their keys."""
    known = Provenance(metadata)
    of_table = _OF_TABLES if known.columns else ()
    notes = _NOTES if known.is_read else of_table
    keys = (key for key in sorted(metadata, key=str) if key not in notes)
    return {key: metadata[key] for key in keys if key != "not_read" or not known.not_read}


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where a cloud comes from, as its metadata say: what has another form there says nothing."""

    entries: Mapping[str, Any]

    @property
    def is_read(self) -> bool:
        """Whether the cloud was read from a file, whatever its user says of it."""
        return all(isinstance(self.entries.get(each), Label) for each in _LABELS)

    @property
    def source(self) -> str | None:
        """The name of the file."""
        entry = self.entries.get("source")
        return entry if isinstance(entry, str) else None

    @property
    def columns(self) -> dict[str, str]:
        """Which columns of a table are the coordinates, colours and normals."""
        entry = self.entries.get("columns")
        return entry if isinstance(entry, NotedColumns) else {}

    @property
    def is_flat(self) -> bool:
        """Whether a table was read without heights."""
        return bool(self.columns) and "z" not in self.columns

    @property
    def notes(self) -> tuple[str, ...]:
        """What is worth knowing about how the file was read."""
        entry = self.entries.get("notes")
        return entry if isinstance(entry, tuple) else ()

    @property
    def not_read(self) -> tuple[str, ...]:
        """What was not read of a file or of an object."""
        entry = self.entries.get("not_read")
        return entry if isinstance(entry, tuple if self.is_read else Unread) else ()

    @property
    def lost(self) -> tuple[str, ...]:
        """What an object of another library had and its cloud has not."""
        names = self.not_read
        return () if self.is_read and not isinstance(names, Unread) else names

    @property
    def selection(self) -> dict[str, int]:
        """How many rows were selected and left out when the cloud was read."""
        entry = self._mapping("selection")
        is_right = {"rows", "selected"} <= entry.keys() and _are_counts(entry.values())
        return entry if is_right else {}

    @property
    def stated_crs(self) -> str | None:
        """The coordinate system that the file states, if the caller has said another."""
        entry = self.entries.get("stated_crs")
        return entry if isinstance(entry, str) else None

    @property
    def transformation(self) -> dict[str, Any]:
        """How coordinates were transformed as they were read."""
        entry = self._mapping(TRANSFORMATION)
        return entry if {"operation", "accuracy"} <= entry.keys() else {}

    @property
    def merged(self) -> list[dict[str, Any]]:
        """The "source", "rows" and "overlap" of each part of a merged cloud."""
        entry = self.entries.get("merged")
        return [*entry] if isinstance(entry, list | tuple) else []

    @property
    def flight_lines(self) -> dict[str, Any]:
        """The number of "lines" of a merged cloud, and the "overlap" in each "cell"."""
        return self._mapping("flight_lines")

    @property
    def ground(self) -> dict[str, Any]:
        """How the ground was classified."""
        return self._mapping("ground")

    @property
    def thinning(self) -> dict[str, Any]:
        """How the cloud was thinned."""
        return self._mapping("thinning")

    @property
    def simplification(self) -> dict[str, Any]:
        """How the surface was simplified."""
        return self._mapping("simplification")

    @property
    def carved(self) -> bool:
        """Whether regions that edges bound are missing from the mesh."""
        return self.entries.get(CARVED) is True

    @property
    def las(self) -> dict[str, Any]:
        """Scales, version and point format of a LAS file."""
        return self._mapping("las")

    @property
    def las_records(self) -> dict[str, Any]:
        """The bytes of the header and the records of a LAS file."""
        return self._mapping("las_records")

    @property
    def raster(self) -> dict[str, Any]:
        """The pixels and the unit of a raster."""
        return self._mapping("raster")

    @property
    def lifted_by(self) -> dict[str, Any]:
        """By what the points of a mesh were lifted when it was triangulated, or on the sphere."""
        entry = self.entries.get(LIFTED)  # a file may hold anything of that name
        if not isinstance(entry, dict) or len(entry) != 1:
            return {}
        kind, value = next(iter(entry.items()))
        is_name = kind in {"weights", "radii"} and isinstance(value, str)
        is_other = (kind == "metric" and _is_matrix(value)) or entry == {"spherical": True}
        return entry if is_name or is_other else {}

    def _mapping(self, name: str) -> dict[str, Any]:
        entry = self.entries.get(name)
        return {**entry} if isinstance(entry, Mapping) else {}


def _are_counts(values: Iterable[object]) -> bool:
    return all(isinstance(each, int) for each in values)


def _is_matrix(value: object) -> bool:
    rows = value if isinstance(value, list) and len(value) == 2 else [None]
    return all(
        isinstance(row, list) and len(row) == 2 and all(isinstance(x, float | int) for x in row)
        for row in rows
    )


def storable(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries that files store, as JSON will give them back."""
    entries: dict[str, Any] = {}
    left = _MOST
    for key, value in user_entries(metadata).items():
        text = None if key in _NOTES else _text(key, value)
        size = 0 if text is None else len(text) + _LINE * (len(value) if is_lines(value) else 0)
        if text is not None and size <= left and _has_short_lines(key, value, text):
            entries[key] = json.loads(text)[key]
            left -= size
    return entries


def _has_short_lines(key: str, value: Any, text: str) -> bool:
    """Whether an entry fits in one line, or in as many as it has."""
    if key not in LINES or not is_lines(value):
        return len(text) <= LONGEST
    return all(len(str(_text(key, [each]))) <= LONGEST for each in value)


def dropped_entries(metadata: Mapping[str, Any]) -> list[str]:
    """Name the entries that files cannot store, as `WriteResult.dropped` does."""
    stored = storable(metadata)
    return named(key for key in user_entries(metadata) if key not in stored)


def named(keys: Iterable[object]) -> list[str]:
    """Name entries by their keys."""
    return [f"metadata {key}" for key in keys]


def header_comments(
    crs: str | None, entries: Mapping[str, Any], given: Sequence[str], stated: Iterable[str] = ()
) -> list[str]:
    """The comments of a header: our own, with other statements among them, then the caller's."""
    own = [OWN, *crs_comment(crs), *stated, *statements(entries, "comments")]
    listed = [given] if isinstance(given, str) else given
    return [*own, *(each for each in listed if each not in own)]


def crs_comment(crs: str | None) -> list[str]:
    """Comments that state a coordinate system: one, in ASCII whatever the text holds, or none."""
    return [] if crs is None else [_CRS + ascii_string(crs)]


def stated_crs(comments: Iterable[str]) -> str | None:
    """The coordinate system that comments state; None for comments that only look alike."""
    stated = (comment.removeprefix(_CRS) for comment in comments if comment.startswith(_CRS))
    return next((str(crs) for crs in map(parsed_or_none, stated) if is_crs(crs)), None)


def others(comments: Iterable[str], crs: str | None) -> tuple[str, ...]:
    """Return the comments that are not liftmesh's own: its name, and the coordinate system."""
    return tuple(
        comment
        for comment in comments
        if comment != OWN and (crs is None or stated_crs([comment]) != crs)
    )


def statements(entries: Mapping[str, Any], *lines: str) -> list[str]:
    """Comments that state entries, each in one line of ASCII."""
    plain = [key for key in lines if key in entries and is_lines(entries[key])]
    texts = [_text(key, value) for key, value in entries.items() if key not in plain]
    comments = [f"{_STATED}{text}" for text in texts]
    for key in plain:
        comments += [_line(key, each) for each in entries[key]]
    return comments


def _line(key: str, line: str) -> str:
    """A line as such, or as JSON if other readers would not give it back."""
    return line if _is_plain(line) else f"{_STATED}{_text(key, [line])}"


def _is_plain(line: str) -> bool:
    is_bare = line.isascii() and line.isprintable() and line == line.strip()
    is_own = line == OWN or line.startswith(_STATEMENTS)
    is_marked = line.startswith("#") or line.endswith("\\")  # which mean something in OBJ
    return is_bare and not is_own and not is_marked and len(line) <= LONGEST


def plain_lines(entries: dict[str, Any], key: str) -> list[str]:
    """Remove an entry that holds lines if all can be written as such, and return them."""
    lines = entries.get(key)
    is_written = is_lines(lines) and all(map(_is_plain, lines or ()))
    return list(entries.pop(key)) if is_written else []


def stated(comments: Iterable[str]) -> dict[str, Any]:
    """Return the entries that comments state; the others stand under "comments", in order."""
    entries: dict[str, Any] = {}
    others: list[str] = []
    left = _MOST
    for comment in comments:
        text = comment.removeprefix(_STATED)
        is_short = text is not comment and len(text) <= min(left, 2 * LONGEST)
        entry = parsed(text) if is_short else None
        left -= len(text) if is_short else 0
        if not entry:  # or of what a reader notes
            others.append(comment)
        elif isinstance(entry.get("comments"), tuple):
            others += entry.pop("comments")
        entries |= entry or {}
    return entries | ({"comments": tuple(others)} if others else {})


def parsed(text: str) -> dict[str, Any] | None:
    """Parse an object of entries; None if a text is anything else. Lines become tuples again."""
    entries = parsed_or_none(text) if len(text) <= _MOST else None
    if not isinstance(entries, dict):
        return None
    return _with_lines({key: entries[key] for key in entries if key not in _NOTES})


def _with_lines(entries: dict[str, Any]) -> dict[str, Any]:
    return entries | {key: tuple(entries[key]) for key in LINES if is_lines(entries.get(key))}


def as_text(entries: Mapping[str, Any]) -> str:
    """Write entries as one object."""
    return json.dumps(dict(entries), sort_keys=True)


# What else stands in the extras of a glTF scene.
NOTE = OWN  # the origin, and the names of attributes
_TAKEN = ("origin", "crs", "metadata", NOTE)


def as_extras(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Give entries the form of a glTF scene's extras; those of taken names stand in one of them."""
    inner = {key: value for key, value in entries.items() if key in _TAKEN}
    extras = {key: value for key, value in entries.items() if key not in _TAKEN}
    return extras | ({"metadata": inner} if inner else {})


def of_extras(extras: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a scene's extras."""
    notes = {key: value for key, value in extras.items() if key in _NOTES}
    if notes:  # of other programs: they say nothing of how this file is read
        extras = {key: value for key, value in extras.items() if key not in notes}
        return {**of_extras(extras), "extras": {**notes, **_of_notes(extras)}}
    inner = extras.get("metadata")
    if not isinstance(inner, dict) or not inner.keys() <= set(_TAKEN):
        return _with_lines(dict(extras))
    rest = {key: value for key, value in extras.items() if key not in ("metadata", *inner)}
    return _with_lines(rest | inner)


def _of_notes(extras: Mapping[str, Any]) -> dict[str, Any]:
    inner = extras.get("extras")
    return inner if isinstance(inner, dict) else {}


def is_lines(value: object) -> bool:
    """Whether a value is a sequence of texts, one at least."""
    if not isinstance(value, list | tuple) or not value:
        return False
    return all(isinstance(each, str) for each in value)


def _text(key: object, value: object) -> str | None:
    """An object of one entry as JSON in printable ASCII; None if JSON cannot hold it."""
    if not isinstance(key, str):
        return None
    try:
        text = json.dumps({key: _plain(value)}, allow_nan=False, sort_keys=True)
    except (TypeError, ValueError, RecursionError):
        return None
    return text.replace("\x7f", "\\u007f")


def _plain(value: Any) -> Any:
    """Replace tuples, mappings and scalars of NumPy by what JSON has."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, Mapping):
        if not all(isinstance(key, str) for key in value):
            raise TypeError("JSON has texts for keys")
        return {key: _plain(each) for key, each in value.items()}
    return value
