"""The files that a glTF file names: its buffers and images."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import unquote

from liftmesh.errors import LiftmeshError
from liftmesh.io.gltf.validation import Document


def named_in(path: Path) -> list[Path]:
    """List the files that a glTF file is read with, or shown with.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    list of Path
        Buffers and images, whether they exist or not; none if the file cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "a.gltf")
    >>> _ = path.write_text('{"asset": {"version": "2.0"}, "images": [{"uri": "my%20wall.png"}]}')
    >>> [each.name for each in named_in(path)]
    ['my wall.png']
    """
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
