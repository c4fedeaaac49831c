"""The files that a glTF file names: its buffers and images."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote

from liftmesh.errors import LiftmeshError
from liftmesh.io.formats.gltf.validation import Document


def named_in(path: Path) -> list[Path]:
    """List the files that a glTF file is read with, or shown with."""
    try:
        with path.open("rb") as stream:
            tree = Document(stream, str(path), path.suffix.lower().removeprefix("."), None).tree
    except (LiftmeshError, OSError):
        return []  # which the command that reads it says
    listed = (tree.get(key) for key in ("buffers", "images"))
    parts = [part for each in listed if isinstance(each, list) for part in each]
    names = [part.get("uri") for part in parts if isinstance(part, dict)]
    return [
        path.absolute().parent / unquote(each)
        for each in names
        if isinstance(each, str) and not each.startswith("data:")
    ]
