"""Files as they are found: each is read, triangulated, written to each format, and read again."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

from conversions.checking import went_through
from conversions.comparing import ChangedError
from conversions.passages import OF_FILES, Arrival, Passage, files
from conversions.probing import kept_by

from liftmesh import Cloud, LiftmeshError, read, triangulate
from liftmesh.io.registry import FORMATS

_NOTES = {*OF_FILES, "notes", "selection"}
_NAMES = {f"metadata {each}" for each in _NOTES} | {"the index of COPC"}
_SUFFIXES = {suffix for each in FORMATS if each.read is not None for suffix in each.suffixes}


def files_in(folders: Iterable[Path]) -> Iterator[Path]:
    """Yield the files of folders, in order, whose suffix is that of a format that is read."""
    for each in folders:
        found = [each] if each.is_file() else sorted(each.rglob("*"))
        yield from (path for path in found if path.suffix.lower() in _SUFFIXES and path.is_file())


def there_and_back(path: Path) -> str:
    """Send the surface of a file through every format; return what is to be said of it.

    Raises
    ------
    ChangedError
        Something changed unsaid.
    """
    try:
        cloud = _surface(path)
    except LiftmeshError as error:
        return f"refused: {error}"
    ways = [*files()]
    changed = [each for way in ways if (each := _changed(way, cloud)) is not None]
    if any(changed):
        raise ChangedError("; ".join(filter(None, changed)))
    held = len(changed)
    count = 0 if cloud.faces is None else len(cloud.faces)
    return f"{len(cloud):,} rows, {count:,} faces: {held} of {len(ways)} ways, no change unsaid"


def _changed(way: Passage, cloud: Cloud) -> str | None:
    """Say what changed unsaid on a way; None if the format refuses the cloud."""
    kept_by(way)  # by the clouds that probe it
    try:
        found = went_through(replace(way, send=partial(_sent, way, cloud)), cloud)
    except ChangedError as error:
        return str(error)
    return None if found is None else ""


def _sent(way: Passage, cloud: Cloud, _: Cloud) -> Arrival:
    """Send a cloud with what its reader noted, which need not come back."""
    arrival = way.send(cloud)
    named = arrival.named and [each for each in arrival.named if each not in _NAMES]
    sent, back = _without_notes(cloud), _without_notes(arrival.cloud)
    return replace(arrival, sent=sent, cloud=back, named=named)


def _without_notes(cloud: Cloud) -> Cloud:
    kept = {key: each for key, each in cloud.metadata.items() if key not in _NOTES}
    return replace(cloud, metadata=kept)


def _surface(path: Path) -> Cloud:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cloud = read(path)
        try:
            return triangulate(replace(cloud, edges=None)).to_cloud()
        except LiftmeshError:
            return cloud
