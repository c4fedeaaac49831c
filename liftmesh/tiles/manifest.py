"""The manifest of a folder of triangles, which names all others and is written last."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from liftmesh.errors import FormatError
from liftmesh.tiles.manifest_shape import wrong_part
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
