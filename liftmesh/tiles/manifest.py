"""The manifest of a folder of triangles, which names all other files and is written last.

Whoever changes a manifest can also seal it, so everything that it says is checked.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, get_args

import numpy as np

from liftmesh.base.options import NonFinite, OnDuplicate, ShardFormat
from liftmesh.errors import FormatError
from liftmesh.tiles.schema import POSITION, ROW
from liftmesh.tiles.store import load_json, seal

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
