"""Cells as files: GeoJSON, GeoPackage, PLY and SVG.

A cell carries the values of its row, its row number and its area. Rows without an area have no
geometry; they are kept wherever a file can hold them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.cells.columns import free_name, plain_columns
from liftmesh.cells.geojson import write_geojson
from liftmesh.cells.geopackage import write_geopackage
from liftmesh.cells.ply import write_ply
from liftmesh.cells.svg import write_svg
from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.cells.clipped import ClippedCells

SUFFIXES = {
    ".geojson": "geojson", ".json": "geojson", ".gpkg": "gpkg", ".ply": "ply", ".svg": "svg",
}  # fmt: skip
_WRITERS: Mapping[str, Callable[..., tuple[str, ...]]] = {
    "geojson": write_geojson, "gpkg": write_geopackage, "ply": write_ply, "svg": write_svg,
}  # fmt: skip


def format_of(path: Path) -> str:
    """Return the format that the suffix of a path stands for."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise FormatError(f"{path}: cells are not written as {suffix!r}: give one of {known}")
    return SUFFIXES[suffix]


def check_format(name: str) -> str:
    """Return the name of a format, or raise."""
    if (found := name.lower().removeprefix(".")) not in _WRITERS:
        raise FormatError(f"cells are not written as {name!r}: give one of {', '.join(_WRITERS)}")
    return found


def own_names(columns: Mapping[str, Array]) -> tuple[str, str]:
    """Return the names that the row number and the area of a cell have beside other columns."""
    return free_name("row", columns), free_name("area", columns)


def write_cells(
    stream: BinaryIO,
    cells: ClippedCells,
    kind: str,
    columns: Mapping[str, Array],
    crs: str | None = None,
) -> tuple[str, ...]:
    """Write cells."""
    plain, dropped = plain_columns(columns)
    row, area = own_names(plain)
    if kind == "svg":
        return (*dropped, *write_svg(stream, cells, plain, crs))
    held = {row: np.arange(len(cells.points)), **plain, area: cells.areas}
    return (*dropped, *_WRITERS[kind](stream, cells, held, crs))
