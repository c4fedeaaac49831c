"""Files of a tiled triangulation: whole or absent, the same bytes whoever writes them.

The output folder holds shards of triangles and a manifest, written last; the scratch folder what
only the run needs. A record of what a task has done names the SHA-256 of each file it wrote, and is
written after them, so a task is either done and its files are sound, or it is done again. Each
record is sealed with its own SHA-256 and that of the plan: a damaged one, and one of another plan,
count as none.

A tile reads some values of a large file of every chunk, so this has to be quick: `fill` does not
parse headers.

The manifest of a folder of triangles names all other files and is written last. Whoever changes a
manifest can also seal it, so everything that it says is checked.
"""

from __future__ import annotations

import errno
import hashlib
import io
import json
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any, BinaryIO, get_args

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.base.interruption import opened
from liftmesh.base.options import NonFinite, OnDuplicate, ShardFormat
from liftmesh.base.platform import HOLDS_FOLDERS
from liftmesh.errors import FormatError
from liftmesh.io.atomic import replacing
from liftmesh.tiles.schema import POSITION, ROW

_BLOCK = 1 << 22
_NPY_TEXT = 12  # the byte of an NPY file of version 3 where its header stands
_NPY_ALIGNED = 64
_NPY_VERSION, _NPY_LENGTH = 6, 8  # the bytes of an NPY file where these of its header stand
_WORD = np.dtype(np.int64)


class Hashed:
    """A stream to write to, which hashes what is written."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._hash = hashlib.sha256()
        self.closed = False

    @property
    def digest(self) -> str:
        """The SHA-256 of all bytes, in hexadecimal digits."""
        return self._hash.hexdigest()

    def write(self, content: Any) -> int:
        """Write bytes, in blocks that are still in the cache when they are written."""
        values = memoryview(content)
        for begin in range(0, len(values), _BLOCK):
            self._hash.update(values[begin : begin + _BLOCK])
            self._stream.write(values[begin : begin + _BLOCK])
        return len(values)

    def flush(self) -> None:
        """Hand on what has been written."""
        self._stream.flush()


@contextmanager
def saving(path: Path) -> Iterator[Hashed]:
    """Write a file that is there when it is on the disk, whole."""
    with replacing(path, follow_links=False) as stream:
        yield Hashed(stream)
        _to_disk(stream)


def save_array(path: Path, array: Array) -> str:
    """Write an NPY file and return the SHA-256 of its bytes."""
    plain = np.ascontiguousarray(array)
    with saving(path) as stream:
        stream.write(_header(plain))
        stream.write(plain.reshape(-1).view(np.uint8).data)
        return stream.digest


def _header(array: Array) -> bytes:
    """Return what an NPY file begins with: of version 3 if fields have names beyond Latin-1."""
    said = np.lib.format.header_data_from_array_1_0(array)
    if array.dtype.isbuiltin or all(_is_latin(name) for name in array.dtype.names or ()):
        header = io.BytesIO()
        np.lib.format.write_array_header_1_0(header, said)
        return header.getvalue()
    text = repr(said).encode()
    text += b" " * (-(_NPY_TEXT + len(text) + 1) % _NPY_ALIGNED) + b"\n"
    return np.lib.format.magic(3, 0) + len(text).to_bytes(4, "little") + text


def _is_latin(name: str) -> bool:
    return all(ord(letter) < 256 for letter in name)


def save_blocks(path: Path, shape: tuple[int, int], blocks: Iterable[Integers]) -> None:
    """Write an NPY file of int64 from blocks of rows."""
    header = {"descr": "<i8", "fortran_order": False, "shape": shape}
    with replacing(path, follow_links=False) as stream:
        np.lib.format.write_array_header_1_0(stream, header)
        for block in blocks:
            stream.write(np.ascontiguousarray(block, dtype="<i8").data)
        _to_disk(stream)


def mapped(path: Path) -> Integers:
    """Map a file of a folder."""
    try:
        array: Integers = np.load(path, mmap_mode="r")
    except (ValueError, EOFError) as error:
        raise damaged(path, error) from error
    except OSError as error:
        if error.errno == errno.ENOMEM:  # no room for the map
            raise MemoryError from error
        raise
    return array


def within(numbers: Array, least: int, end: int) -> bool:
    """Whether all numbers of an array, which may be empty, are in a range."""
    return not numbers.size or (least <= int(numbers.min()) and int(numbers.max()) < end)


def concatenated(parts: Sequence[Array]) -> Array:
    """Put arrays of one type side by side; NumPy would change the order of bytes in records."""
    shape = (sum(map(len, parts)), *parts[0].shape[1:])
    return np.concatenate(parts, out=np.empty(shape, parts[0].dtype))


def save_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file whose bytes depend on its content alone."""
    with replacing(path, follow_links=False) as stream:
        stream.write(json.dumps(content, indent=1, sort_keys=True).encode() + b"\n")
        _to_disk(stream)


def names_to_disk(folder: Path) -> None:
    """Wait until the names of a folder's files are on the disk, as their contents are."""
    if HOLDS_FOLDERS:
        with opened(folder, os.O_RDONLY) as descriptor:
            os.fsync(descriptor)


def load_json(path: Path) -> dict[str, Any]:
    """Read a JSON file that holds an object."""
    try:
        content = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{path}: not valid JSON: {error}") from error
    if not isinstance(content, dict):
        raise FormatError(f"{path}: an object is expected, not {type(content).__name__}")
    return content


def save_record(path: Path, plan: str, content: Mapping[str, Any]) -> None:
    """Write what a task has done, after the files that it wrote."""
    names_to_disk(path.parent)
    save_json(path, {"content": content, "plan": plan, "seal": seal(plan, content)})


def load_record(path: Path, plan: str) -> Any:
    """Read what a task has done."""
    try:
        record = load_json(path)
    except (FileNotFoundError, FormatError):
        return None
    content = record.get("content")
    return content if record.get("seal") == seal(plan, content) else None


def seal(*content: object) -> str:
    """Return a hash of what can be written as JSON."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file, or nothing if it is not there."""
    digest = hashlib.sha256()
    try:
        with path.open("rb") as stream:
            while block := stream.read(_BLOCK):
                digest.update(block)
    except FileNotFoundError:
        return ""
    return digest.hexdigest()


def sound(path: Path, digest: str) -> Path:
    """Raise if a file is not as it was written; one that stays as it is is read once for that."""
    state = path.stat()
    known = (state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns, state.st_ctime_ns)
    if _digest_in(path, known) != digest:
        raise damaged(path, "its SHA-256 is not that of the manifest")
    return path


@lru_cache(maxsize=1 << 14)
def _digest_in(path: Path, _state: tuple[int, ...]) -> str:
    return digest_of(path)


def damaged(path: Path, reason: object) -> FormatError:
    """Return the error for a file that does not hold what it was written to hold."""
    return FormatError(f"{path}: damaged ({reason}): tile the source again")


def is_sound(folder: Path, digests: Mapping[str, str]) -> bool:
    """Whether all files of a folder are as they were written."""
    return all(digest_of(folder / name) == digest for name, digest in digests.items())


def _to_disk(stream: Any) -> None:
    """Wait for the disk: what is named done must outlast a loss of power."""
    stream.flush()
    os.fsync(stream.fileno())


def values_of(path: Path, begin: int, end: int, kind: np.dtype[Any] = _WORD) -> Array:
    """Read some values of an NPY file that `save_array` has written."""
    values = np.empty(end - begin, dtype=kind)
    fill(values, path, begin)
    return values


def fill(values: Array, path: Path, begin: int) -> None:
    """Read values of an NPY file that `save_array` has written into an array."""
    rest = values.reshape(-1).view(np.uint8).data
    with (
        opened(path, os.O_RDONLY) as descriptor,
        os.fdopen(descriptor, "rb", buffering=0, closefd=False) as file,
    ):
        begun = file.read(_NPY_LENGTH + 4)
        size = 2 if begun[_NPY_VERSION : _NPY_VERSION + 1] == b"\1" else 4
        length = int.from_bytes(begun[_NPY_LENGTH : _NPY_LENGTH + size], "little")
        file.seek(_NPY_LENGTH + size + length + values.dtype.itemsize * begin)
        while len(rest) and (count := file.readinto(rest)):
            rest = rest[count:]
    if len(rest):
        raise FormatError(f"{path}: truncated: tile the source again")


def kind_of(path: Path) -> np.dtype[Any]:
    """Read the type of the values in an NPY file that `save_array` has written."""
    return mapped(path).dtype


MANIFEST = "manifest.json"
PLAN = "plan.json"
KIND = "liftmesh tiles"
VERSION = 2


def manifest_of(folder: Path) -> dict[str, Any]:
    """Read the manifest of a folder."""
    place = folder / MANIFEST
    if not place.is_file():
        raise FormatError(f"{folder}: no finished triangulation is here: {MANIFEST} is missing")
    manifest = load_json(place)
    if manifest.get("kind") != KIND or manifest.get("version") != VERSION:
        raise FormatError(f"{place}: not the manifest of tiles of version {VERSION}")
    if manifest.pop("seal", None) != seal(manifest):
        raise FormatError(f"{place}: damaged or changed: move it, and tile the source again")
    wrong = wrong_part(manifest)
    if wrong is not None:
        raise FormatError(f"{place}: {wrong} is not what tile writes: tile the source again")
    return manifest


Check = Callable[[Any], bool]

_MOST = 1 << 48  # of anything that is counted
_COUNTS = ("rows", "vertices", "duplicates", "skipped", "triangles", "hull", "tile_rows")
_MERGES = ("tiles", "rows_up_from_tiles", "rows_at_root", "bytes_up")


def wrong_part(manifest: Mapping[str, Any]) -> str | None:
    """Find what no run has written."""
    parts = _PARTS | {"surface": _is_surface} if "surface" in manifest else _PARTS
    if {*manifest} != {*parts}:
        return f"the names {sorted({*manifest} ^ {*parts})}"
    for name, check in parts.items():
        if not check(manifest[name]):
            return name
    return next((name for name, check in _TOGETHER.items() if not check(manifest)), None)


def wrong_job(job: object) -> str | None:
    """Find what no run has written of its source and its options."""
    if not isinstance(job, dict):
        return "all of it"
    parts = {name: check for name, check in _PARTS.items() if name in _OF_JOBS}
    parts |= {"surface": _is_read_surface} if "surface" in job else {}
    wrong = (name for name, check in parts.items() if name not in job or not check(job[name]))
    return next(wrong, None)


def _is_count(value: Any) -> bool:
    return type(value) is int and 0 <= value < _MOST


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) < math.inf


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and "\0" not in value


def _is_hash(value: Any) -> bool:
    return isinstance(value, str) and re.fullmatch("[0-9a-f]{64}", value) is not None


def _is_one_of(kind: Any) -> Check:
    return lambda value: isinstance(value, str) and value in get_args(kind)


def _or_none(check: Check) -> Check:
    return lambda value: value is None or check(value)


def _is_list(check: Check) -> Check:
    return lambda value: isinstance(value, list) and all(map(check, value))


def _is_entry(required: Mapping[str, Check], optional: Mapping[str, Check] | None = None) -> Check:
    """Whether a value is an object with these names, and perhaps some of those."""
    known = {**required, **(optional or {})}

    def check(value: Any) -> bool:
        if not isinstance(value, dict) or not {*required} <= {*value} <= {*known}:
            return False
        return all(known[name](each) for name, each in value.items())

    return check


def _is_classes(value: Any) -> bool:
    """Whether these are the rows of each class of lidar."""
    known = isinstance(value, dict) and all(re.fullmatch("[0-9]{1,3}", key) for key in value)
    return known and all(map(_is_count, value.values()))


def _is_box(value: Any) -> bool:
    if not isinstance(value, list) or len(value) != 6 or not all(map(_is_number, value)):
        return False
    return all(low <= high for low, high in zip(value[:3], value[3:], strict=True))


def _is_fields(value: Any) -> bool:
    """Whether these are types of NumPy that a vertex may have besides its position."""
    is_field = _is_list(_is_count)
    if not isinstance(value, list):
        return False
    for each in value:
        if not isinstance(each, list) or len(each) != 3 or not all(map(_is_text, each[:2])):
            return False
        if not is_field(each[2]) or math.prod(each[2]) > _WIDEST:
            return False
    try:
        kind = np.dtype(
            [ROW, *POSITION, *((name, how, tuple(shape)) for name, how, shape in value)]
        )
    except (TypeError, ValueError, SyntaxError):
        return False
    return not kind.hasobject and kind.itemsize <= _WIDEST


_WIDEST = 1 << 24  # bytes of a record
_FILE: dict[str, Check] = {"bytes": _is_count, "sha256": _is_hash}
_READING: dict[str, Check] = {
    "on_duplicate": _is_one_of(OnDuplicate),
    "reading": lambda value: isinstance(value, dict),
    "fields": _is_fields,
    "crs": _or_none(_is_text),
    "color_depth": _or_none(lambda value: type(value) is int and value in (8, 16)),
    "columns": lambda value: isinstance(value, dict) and all(map(_is_text, value.values())),
}
_is_read_surface = _is_entry(_READING, {"unit": _is_text})
_is_surface = _is_entry({**_READING, "overhangs": _is_count, "box": _is_box}, {"unit": _is_text})
_OF_JOBS = {"version", "tile_rows", "nonfinite", "shard_format", "neighbors", "chunks"}
_PARTS: dict[str, Check] = {
    **dict.fromkeys(_COUNTS, _is_count),
    "kind": _is_text,
    "version": _is_count,
    "plan": _is_hash,
    "nonfinite": _is_one_of(NonFinite),
    "shard_format": _is_one_of(ShardFormat),
    "neighbors": lambda value: isinstance(value, bool),
    "chunks": _is_list(
        _is_entry(
            {"rows": _is_count, "sha256": _is_hash}, {"values": _is_hash, "classes": _is_classes}
        )
    ),
    "files": lambda value: isinstance(value, dict) and all(map(_is_entry(_FILE), value.values())),
    "merges": _is_entry(dict.fromkeys(_MERGES, _is_count)),
    "shards": _is_list(
        _is_entry(
            {**_FILE, "file": _is_text, "triangles": _is_count},
            {"vertices": _is_count, "box": _is_box},
        )
    ),
    "source": _is_list(
        _is_entry({"file": _is_text, "first": _is_count, "rows": _is_count}, {"path": _is_text})
    ),
}


def _are_files_named(manifest: Mapping[str, Any]) -> bool:
    """Whether the files are those that a run writes: no name leads out of the folder."""
    ends = ["-neighbors", "-links"] * manifest["neighbors"]
    ends += ["-vertices", "-faces"] * ("surface" in manifest)
    names = [shard["file"] for shard in manifest["shards"]]
    pattern = rf"((tile|seam)-\d{{5,}})\.{manifest['shard_format']}"
    matches = [re.fullmatch(pattern, name, re.ASCII) for name in names]
    stems = [each[1] for each in matches if each is not None]
    expected = {f"{stem}{end}.npy" for stem in stems for end in ends} | _ALWAYS
    return len({*stems}) == len(names) > 0 and {*manifest["files"]} == expected


_ALWAYS = {"duplicates.npy", "hull.npy", "skipped.npy", "plan.json"}


def _are_extents_there(manifest: Mapping[str, Any]) -> bool:
    has = "surface" in manifest
    is_right = all({"vertices", "box"} <= {*shard} for shard in manifest["shards"])
    return is_right if has else not any({"vertices", "box"} & {*s} for s in manifest["shards"])


def _is_counted(manifest: Mapping[str, Any]) -> bool:
    """Whether the counts fit each other."""
    rows, vertices, triangles = (int(manifest[name]) for name in ("rows", "vertices", "triangles"))
    overhangs = int(manifest.get("surface", {}).get("overhangs", 0))
    return (
        rows == vertices + manifest["duplicates"] + manifest["skipped"]
        and rows == sum(int(chunk["rows"]) for chunk in manifest["chunks"])
        and triangles == 2 * vertices - 2 - manifest["hull"]
        and triangles == sum(int(shard["triangles"]) for shard in manifest["shards"])
        and overhangs <= manifest["duplicates"]
    )


def _is_source_counted(manifest: Mapping[str, Any]) -> bool:
    first = 0
    for each in manifest["source"]:
        if each["first"] != first:
            return False
        first += each["rows"]
    return bool(first == manifest["rows"])


_TOGETHER: dict[str, Check] = {
    "the names of files": _are_files_named,
    "vertices and extents": _are_extents_there,
    "the counts": _is_counted,
    "the rows of the source": _is_source_counted,
}


def neighbors_name(shard: str) -> str:
    """Name the file of the neighbours within a shard."""
    return f"{shard.partition('.')[0]}-neighbors.npy"


def links_name(shard: str) -> str:
    """Name the file of the neighbours of a shard in others."""
    return f"{shard.partition('.')[0]}-links.npy"


def vertices_name(shard: str) -> str:
    """Name the file of the vertices of a shard."""
    return f"{shard.partition('.')[0]}-vertices.npy"


def faces_name(shard: str) -> str:
    """Name the file of the faces of a shard."""
    return f"{shard.partition('.')[0]}-faces.npy"
