"""PLY, the format that preserves everything: doubles, colours, normals, attributes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from liftmesh.io.format import Format
from liftmesh.io.ply.reader import read_ply, read_ply_chunks
from liftmesh.io.ply.writer import write_ply

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud


def _lost(_cloud: Cloud, options: Mapping[str, Any]) -> tuple[str, ...]:
    return () if options.get("colors") == "exact" else ("deep_colors",)


FORMAT = Format(
    name="ply",
    suffixes=(".ply",),
    read=read_ply,
    write=write_ply,
    description="PLY, binary or text: float64, colours, normals, attributes, triangles",
    loses=_lost,
    read_chunks=read_ply_chunks,
)
