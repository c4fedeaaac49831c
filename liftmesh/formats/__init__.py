"""Files: PLY, OBJ, text and NumPy's own here, STL and glTF through trimesh, others by plugins."""

from __future__ import annotations

from liftmesh.formats.access import Written, read, write
from liftmesh.formats.format import Format
from liftmesh.formats.registry import known_formats

__all__ = ["Format", "Written", "known_formats", "read", "write"]
