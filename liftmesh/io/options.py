"""The options of `read`, typed: functions that read files for their caller take them by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from collections.abc import Iterable

    from liftmesh.base.options import Returns
    from liftmesh.io.formats.text.options import ColumnChoice
    from liftmesh.io.missing import Missing
    from liftmesh.io.selection import ClassChoice


class ObjectOptions(TypedDict, total=False):
    """Options of tables and arrays, in memory and in files."""

    columns: ColumnChoice
    flat: bool | None
    nodata: Missing


class FormatOptions(ObjectOptions, total=False):
    """Options of single formats: tables as text, and rasters."""

    delimiter: str | None
    decimal: str | None
    skip_rows: int
    header: bool
    end: str | None
    encoding: str | None
    band: int


class ChunkOptions(FormatOptions, total=False):
    """The options of `read_chunks`."""

    format: str | None
    max_bytes: int | None
    color_depth: int | None
    classes: ClassChoice
    returns: Returns | None
    bounds: Iterable[float] | None
    z_range: Iterable[float] | None
    every: int
    withheld: bool
    src_crs: str | None
    dst_crs: str | None


class ReadOptions(ChunkOptions, total=False):
    """The options of `read`."""

    copc_resolution: float | None
