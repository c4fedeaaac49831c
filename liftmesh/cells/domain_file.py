"""A domain that is a file: the union of its polygons, and their coordinate system."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from liftmesh.cells.domain import shapes_of, united
from liftmesh.errors import FormatError, InputError
from liftmesh.vector.files import own_system, read_features


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
    return shape, own_system(tree, shape.bounds)
