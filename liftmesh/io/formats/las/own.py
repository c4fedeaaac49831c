"""What LAS has no place for, in a record of liftmesh's own: metadata, and how the rest is meant.

The coordinate system stands as WKT, or as the numbers of EPSG where the file that was read had
them. What the cloud itself said, such as ``EPSG:25832``, is noted with a checksum of the WKT, and
holds as long as that is the same: other programs may have changed it.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from liftmesh.base.cloud import is_crs
from liftmesh.io import metadata
from liftmesh.io.formats.las.carried import ENTRY, made

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.formats.las.header import Record

LIFTMESH_VLR = (b"liftmesh", 1)
LAYOUT = "las"  # the entry of metadata that says how a file holds its points
DEPTH = "color_depth"  # of that entry: 8 where all colours of the file are no larger than 255
_DESCRIPTION = b"metadata"
_MOST_JSON = 1 << 19  # characters


def record_of(cloud: Cloud, crs: str | None, depth: int | None) -> Record | None:
    """Make the record; None if there is nothing to say."""
    found: dict[str, Any] = {}
    entries = {k: v for k, v in metadata.storable(cloud.metadata).items() if not is_layout(k, v)}
    found |= {"metadata": entries} if entries else {}
    if cloud.crs is not None and cloud.crs != crs:
        found["crs"] = [cloud.crs, _checksum(crs)]
    found |= {} if depth is None else {DEPTH: depth}
    data = json.dumps(found, sort_keys=True).encode() if found else b""
    return made(*LIFTMESH_VLR, data, _DESCRIPTION) if data else None


def is_layout(key: str, value: object) -> bool:
    """Whether an entry of metadata is what the reader of LAS says of the layout."""
    is_known = key == LAYOUT and isinstance(value, dict)
    return key == ENTRY or (is_known and {"version", "point_format"} <= {*value})  # type: ignore[misc]


class LiftmeshVlr:
    """What the record of a file says; nothing if there is none, or it is not understood."""

    def __init__(self, records: Iterable[Record]) -> None:
        mine = (each.data for each in records if (each.user, each.number) == LIFTMESH_VLR)
        found = _parsed(next(mine, b""))
        self.metadata: dict[str, Any] = _entries(found.get("metadata"))
        depth = found.get(DEPTH)
        self.color_depth = depth if depth in (8, 16) else None
        self._crs = found.get("crs")

    def crs(self, text: str | None) -> str | None:
        """Return what the cloud said of its coordinate system, if the file still says the same."""
        pair = self._crs if isinstance(self._crs, list) and len(self._crs) == 2 else [None, -1]
        mine = pair[0] if is_crs(pair[0]) and pair[1] == _checksum(text) else text
        return None if mine is None else str(mine)


def _checksum(text: str | None) -> int | None:
    return None if text is None else zlib.crc32(text.encode("utf-8", "replace"))


def _entries(value: object) -> dict[str, Any]:
    text = json.dumps(value) if isinstance(value, dict) else ""
    found = metadata.parsed(text) or {}
    return {key: each for key, each in found.items() if key not in (LAYOUT, ENTRY)}


def _parsed(data: bytes) -> dict[str, Any]:
    try:
        found = json.loads(data.decode()) if len(data) <= _MOST_JSON else None
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}
