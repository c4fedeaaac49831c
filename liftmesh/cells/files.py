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
    """Return the format that the suffix of a path stands for.

    Parameters
    ----------
    path : Path
        The file to write.

    Returns
    -------
    str
        One of "geojson", "gpkg", "ply" and "svg".

    Raises
    ------
    FormatError
        It is none of them.

    Examples
    --------
    >>> format_of(Path("schools.geojson"))
    'geojson'
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise FormatError(f"{path}: cells are not written as {suffix!r}: give one of {known}")
    return SUFFIXES[suffix]


def check_format(name: str) -> str:
    """Return the name of a format, or raise.

    Parameters
    ----------
    name : str
        As `format_of` returns it, in any letters.

    Returns
    -------
    str
        The name.

    Raises
    ------
    FormatError
        It is none.

    Examples
    --------
    >>> check_format("SVG")
    'svg'
    """
    if (found := name.lower().removeprefix(".")) not in _WRITERS:
        raise FormatError(f"cells are not written as {name!r}: give one of {', '.join(_WRITERS)}")
    return found


def own_names(columns: Mapping[str, Array]) -> tuple[str, str]:
    """Return the names that the row number and the area of a cell have beside other columns.

    Parameters
    ----------
    columns : mapping
        The other columns.

    Returns
    -------
    row, area : str
        ``row`` and ``area``, unless others are called so.

    Examples
    --------
    >>> own_names({"Area": np.ones(1)})
    ('row', 'cell_area')
    """
    return free_name("row", columns), free_name("area", columns)


def write_cells(
    stream: BinaryIO,
    cells: ClippedCells,
    kind: str,
    columns: Mapping[str, Array],
    crs: str | None = None,
) -> tuple[str, ...]:
    """Write cells.

    Parameters
    ----------
    stream : binary stream
        Where to.
    cells : ClippedCells
        The cells.
    kind : {"geojson", "gpkg", "ply", "svg"}
        The format.
    columns : mapping of str to (n, ...) ndarray
        Values of the rows.
    crs : str, optional
        The coordinate system.

    Returns
    -------
    tuple of str
        What the file does not keep of `columns` and `crs`, by name.

    Raises
    ------
    InputError, FormatError
        The format cannot hold the columns.
    MissingDependencyError
        A library of the format is missing.

    Examples
    --------
    >>> import io, liftmesh
    >>> cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=(-1, -1, 3, 1))
    >>> write_cells(io.BytesIO(), cells, "ply", {"name": np.array(["a", "b"])})
    ('name (not numbers)',)
    """
    plain, dropped = plain_columns(columns)
    row, area = own_names(plain)
    if kind == "svg":
        return (*dropped, *write_svg(stream, cells, plain, crs))
    held = {row: np.arange(len(cells.points)), **plain, area: cells.areas}
    return (*dropped, *_WRITERS[kind](stream, cells, held, crs))
