"""Files of shapes on the command line: which points and lines are GeoJSON or GeoPackage."""

from __future__ import annotations

from pathlib import Path

from liftmesh.errors import FormatError

SHAPES = {".geojson", ".json", ".gpkg"}


def is_cloud(path: Path) -> bool:
    """Whether a file is a table or a cloud, by its suffix, and not one of shapes."""
    from liftmesh.io.registry import find_format  # noqa: PLC0415 - help does without
    from liftmesh.io.streams import suffix_of  # noqa: PLC0415 - help does without

    if path.suffix.lower() in SHAPES or not path.suffix:
        return False
    try:
        return find_format(suffix_of(path.name), str(path)) is not None
    except FormatError:
        return False
