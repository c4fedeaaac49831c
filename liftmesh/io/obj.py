"""OBJ, the text format that every program opens: doubles, colours, normals, triangles."""

from __future__ import annotations

from liftmesh.io.format import Format
from liftmesh.io.obj_reader import read_obj
from liftmesh.io.obj_writer import write_obj

FORMAT = Format(
    name="obj",
    suffixes=(".obj",),
    read=read_obj,
    write=write_obj,
    description="Wavefront OBJ: shortest digits that round-trip, colours, normals, triangles",
    keeps=("colors", "normals"),
)
