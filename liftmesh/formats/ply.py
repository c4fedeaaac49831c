"""PLY, the format that keeps everything: doubles, colours, normals, attributes."""

from __future__ import annotations

from liftmesh.formats.format import Format
from liftmesh.formats.ply_reader import read_ply
from liftmesh.formats.ply_writer import write_ply

FORMAT = Format(
    name="ply",
    suffixes=(".ply",),
    read=read_ply,
    write=write_ply,
    description="PLY, binary or text: float64, colours, normals, attributes, triangles",
)
