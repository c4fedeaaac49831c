"""PLY, the format that keeps everything: doubles, colours, normals, attributes."""

from __future__ import annotations

from liftmesh.io.format import Format
from liftmesh.io.ply.reader import read_ply
from liftmesh.io.ply.writer import write_ply

FORMAT = Format(
    name="ply",
    suffixes=(".ply",),
    read=read_ply,
    write=write_ply,
    description="PLY, binary or text: float64, colours, normals, attributes, triangles",
)
