"""Meshes for solvers, as meshio writes them: MSH of Gmsh, version 4.1, and SU2; written, not read.

In MSH each region is a surface, and the edges of each marker are a curve, with a physical group
each: region k has the number k + 1. Of nodes meshio takes one thing that they lie on, and leaves
out surfaces and curves on which no node lies. So a node is on its region, or on a curve, and where
nodes are few, each surface and each curve gets one of its own, as far as there are as many. The
time of meshio grows with the groups, times the nodes.

In SU2, which is flat, each side of the boundary has a marker, as solvers want; edges inside have no
place there. The rows are those of faces alone, since solvers fail at others.

meshio writes MSH to real files only, so files are copied. Its writer of SU2 takes apart blocks of
cells as tuples, which those of meshio 5.3 are not: it gets tuples.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.errors import FormatError
from liftmesh.io.columns import edges_of, faces_of
from liftmesh.io.format import CONTENT
from liftmesh.io.tags import Boundary, grouped, positive_markers, regions_of
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_LINE, _TRIANGLE = "line", "triangle"
_NONE = np.empty((0, 2), np.int32)


class _Block(NamedTuple):
    type: str
    data: Rows


def write_msh(stream: BinaryIO, cloud: Cloud) -> None:
    """Write faces and edges, with regions and markers as physical groups."""
    faces, edges = faces_of(cloud), edges_of(cloud)
    regions, markers = regions_of(cloud) + 1, positive_markers(cloud, _NONE, "MSH")
    parts = [(1, *part) for part in grouped(edges, markers)]
    parts += [(2, *part) for part in grouped(faces, regions)]
    tags = np.array([each[:2] for each in parts], np.int32)
    groups = [np.full(len(rows), tag, np.int32) for _, tag, rows in parts]
    _write(
        stream,
        "gmsh",
        cloud.points,
        [_Block(_LINE if kind == 1 else _TRIANGLE, rows) for kind, _, rows in parts],
        point_data={"gmsh:dim_tags": tags[_place_of_nodes(len(cloud), [p[2] for p in parts])]},
        cell_data={"gmsh:physical": groups, "gmsh:geometrical": groups},
    )


def _place_of_nodes(count: int, parts: list[Rows]) -> Array:
    """Return for each node one of the parts that it lies on: curves before surfaces."""
    place = np.full(count, len(parts) - 1)
    for k in range(len(parts) - 1, -1, -1):
        place[parts[k]] = k
    if np.bincount(place, minlength=len(parts)).all():
        return place
    sparse = load("scipy.sparse", extra="scipy")
    graphs = load("scipy.sparse.csgraph", extra="scipy")
    part = np.repeat(np.arange(len(parts)), [each.size for each in parts])
    node = np.concatenate([each.reshape(-1) for each in parts])
    lies_on = sparse.coo_array((np.ones(len(node), np.bool_), (part, node)), (len(parts), count))
    own = graphs.maximum_bipartite_matching(lies_on.tocsr(), perm_type="column")
    if (own < 0).any():
        raise FormatError(
            f"{count} vertices are too few for the {len(parts)} regions and markers, of which each "
            "needs a vertex of its own in MSH: refine the mesh, or write VTU"
        )
    place[own] = np.arange(len(parts))
    return place


def write_su2(stream: BinaryIO, cloud: Cloud) -> frozenset[str]:
    """Write faces, and the sides of the boundary by their markers; name what is lost."""
    faces, edges = faces_of(cloud), edges_of(cloud)
    boundary = Boundary.of(cloud)
    beyond = boundary.beyond(edges)
    lines, markers = (
        np.concatenate([edges, beyond]),
        positive_markers(cloud, beyond, "SU2", boundary),
    )
    is_outer = boundary.has(lines)
    lines, markers = lines[is_outer], markers[is_outer]
    rows = used_rows(len(cloud), faces)
    number = np.zeros(len(cloud), np.int32)
    number[rows] = np.arange(len(rows), dtype=np.int32)
    _write(
        stream,
        "su2",
        cloud.points[rows, :2],
        [_Block(_TRIANGLE, number[faces]), _Block(_LINE, number[lines])],
        cell_data={"su2:tag": [np.zeros(len(faces), np.int32), markers]},
    )
    lost = {"heights": cloud.points[:, 2].any(), "edges inside": not is_outer.all()}
    lost[CONTENT["points"]] = len(rows) < len(cloud)  # also if edges inside have them
    return frozenset(each for each, is_lost in lost.items() if is_lost)


def _write(stream: BinaryIO, kind: str, points: Floats, cells: list[_Block], **data: Any) -> None:
    meshio = load("meshio", extra="solvers")
    mesh = meshio.Mesh(np.ascontiguousarray(points, np.float64), cells, **data)
    mesh.cells = cells if kind == "su2" else mesh.cells
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "mesh")
        mesh.write(path, file_format=kind)
        with path.open("rb") as written:
            shutil.copyfileobj(written, stream)
