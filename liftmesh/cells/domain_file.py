"""A domain that is a file: the union of its polygons, and their coordinate system."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from liftmesh.cells.domain import shapes_of, united
from liftmesh.crs.description import described
from liftmesh.errors import FormatError, InputError
from liftmesh.vector.files import read_features, stated_system

_STANDARD = "EPSG:4326"  # of GeoJSON that names no other
_DEGREES = np.array([180.0, 90.0])


def read_domain(path: Path) -> tuple[Any, str | None]:
    """Read the polygons of a file."""
    tree = read_features(path, "a domain")
    try:
        shapes = shapes_of(tree) if tree else []
    except Exception as error:  # of whatever kind shapely makes
        raise FormatError(f"{path}: cannot be read as a domain: {error}") from error
    try:
        shape = united(shapes)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return shape, _system(tree, shape)


def _system(tree: dict[str, Any], shape: Any) -> str | None:
    crs = stated_system(tree) if "crs" in tree else _STANDARD
    system = described(crs)
    if system is None or (system.kind == "geographic" and not _is_degrees(shape.bounds)):
        return None
    return crs


def _is_degrees(bounds: tuple[float, ...]) -> bool:
    return bool((np.abs(np.reshape(bounds, (2, 2))) <= 2 * _DEGREES).all())
