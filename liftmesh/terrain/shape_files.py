"""Files of polygons, lines and points, and the coordinate systems that shapes say they are in.

Old GeoJSON names its system in the member ``crs``, and so do the trees of other files; without it,
coordinates are taken to be those of the surface.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.io.geometry_files import read_features, stated_system
from liftmesh.same_crs import are_different


def read_shapes(path: Path, what: str, crs: str | None) -> dict[str, Any]:
    """Read a file, and see that it is in the system of a surface."""
    tree = read_features(path, what)
    check_system(crs, tree, str(path))
    return tree


def check_system(own: str | None, shapes: object, name: str) -> None:
    """Raise if shapes are known to be in another system than the surface."""
    stated = stated_system(shapes)
    if are_different(own, stated):
        raise InputError(f"{name} is in {shown(stated)}, the surface in {shown(own)}: transform it")
