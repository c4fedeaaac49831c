"""What is watched: every public function that computes on data, every reader and every writer.

A subject is named after the public name that it calls, with what distinguishes it behind. Readers
and writers are taken from the table of formats: one that is new there has no families yet, and the
tests fail until `FILES` holds some. `WITHOUT_DATA` lists the public names that are no subjects.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from files import stream_of
from growth import cells, changing, constraints, disks, functions, lined, stars, surfaces, weighted
from growth.counting import Work
from growth.files.arrays import NPY, NPZ
from growth.files.clouds import CLOUDS
from growth.files.e57 import E57
from growth.files.gltf import GLB, GLTF, HEAVY
from growth.files.lidar import LAS
from growth.files.ply import PLY
from growth.files.points import DXF, ELE, GZIP, MESH2D, NODE, PCD, POLY, PTS, XYZN, XYZRGB
from growth.files.raster import RASTER
from growth.files.shapes import GEOJSON, GEOPACKAGE, SHAPEFILE
from growth.files.stl import STL
from growth.files.text import OBJ, OFF, TEXT
from growth.files.xml import LANDXML
from growth.planar import DEAR
from growth.spatial import DEEP

import liftmesh
from liftmesh.io.registry import FORMATS

if TYPE_CHECKING:
    from growth.families import Families

    from liftmesh.io.format import Format

FILES: dict[str, Families] = {
    "ply": PLY,
    "obj": OBJ,
    "off": OFF,
    "text": {**TEXT, **GZIP},
    "stl": STL,
    "npy": NPY,
    "npz": NPZ,
    "glb": GLB,
    "gltf": GLTF,
    "pcd": PCD,
    "pts": PTS,
    "xyzrgb": XYZRGB,
    "xyzn": XYZN,
    "node": NODE,
    "ele": ELE,
    "poly": POLY,
    "las": LAS,
    "raster": RASTER,
    "e57": E57,
    "landxml": LANDXML,
    "2dm": MESH2D,
    "dxf": DXF,
    "geojson": GEOJSON,
    "geopackage": GEOPACKAGE,
    "shapefile": SHAPEFILE,
}

GLTF_COUNTED = ("soup", "indexed", "flat json")
PARTS = 16
"""The least number of rows, faces or members in the files that are counted."""

CHEAP = (
    "chain", "empty nodes", "unused", "unused meshes", "flat json", "scalar elements",
    "foreign members",
)  # fmt: skip
"""Of very many parts that cost little each: they are counted at four times as many, since a search
among all others shows the earlier, the less there is beside it."""

SLOW = (
    "text elements", "list elements", "members", "members deflated", "skipped members",
    "chunks of one point", "nodes of one point",
)  # fmt: skip
"""Of parts that cost much each: they are counted at an eighth as many."""

IN_CHUNKS = {
    "las": ("rows", "compressed rows", "compressed in layers", "chunks of one point"),
    "ply": (
        "points in binary", "points as text", "triangles in binary", "polygons in binary",
        "vertices with lists", "two byte rows", "blank lines first",
    ),
    "npy": ("rows", "columns first", "fields"),
    "npz": ("stored", "deflated", "members deflated"),
    "text": ("table", "table with header", "columns", "blank lines", "remarks", "long word",
        "words beside", "word at the end"),
}  # fmt: skip
"""What is counted when read in chunks, where all else takes the same way as in a whole file."""

CHUNKS = 16
"""Files are read in chunks of a sixteenth of their rows, roughly."""


DRAWN = (
    "Surface", "Raster", "Contours", "Profile", "Triangulation", "Cells", "ApolloniusCells",
    "Unclipped", "Certificate", "Tiled", "scipy.Voronoi",
)  # fmt: skip
"""Results with a method `plot`."""

WITHOUT_DATA = {
    "Weights": "a result, made by Surface.weights; its methods are watched",
    "NaturalNeighbors": "a result, made by natural_neighbors; its methods are watched",
    "LloydResult": "a result, made by lloyd",
    "TransportResult": "a result, made by transport",
    "Cells": "a result, made by voronoi; its methods and properties are watched",
    "Unclipped": "a result, made by Cells.unclipped; its properties are watched",
    "AlphaComplex": "a result, made by alpha_complex; its methods are watched",
    "AlphaShape": "a result, made by alpha_shape; its methods are watched",
    "AnisotropicStars": "a result, made by anisotropic_stars; its methods are watched",
    "ApolloniusCells": "a result, made by apollonius_diagram; what it adds to Cells is watched",
    "ApolloniusGraph": "a result, made by apollonius; its methods are watched",
    "Adapter": "describes a conversion",
    "Format": "describes a format",
    "WriteResult": "tells what was written",
    "plot": "matplotlib draws what rasters and contours, which are watched, have made",
    "view": "copies arrays; difference and simplify, which are watched, do the rest",
    "Surface.view": "does what view does",
    **{f"{kind}.plot": "does what plot does" for kind in DRAWN},
    "Page": "a result, made by view",
    "Page.save": "packs arrays as they are",
    "Page.to_html": "packs arrays as they are",
    "TilesetResult": "tells what was written",
    "QuantizedMeshResult": "tells what was written",
    "write_quantized_mesh": "does what write_tileset does, and packs what it has made",
    "write_tileset": "simplify, profile, sample and write, which are watched, do its work",
    "dask.delaunay": "hands the tasks of tile, which is watched, to workers",
    "dask.local_cluster": "starts workers",
    "dask.triangulate": "hands the tasks of tile_surface, which is watched, to workers",
    "Flaw": "a result, made by verify",
    "Violation": "a result, made by verify",
    "Certificate": "a result, made by verify; its methods are watched",
    "Comparison": "a result, made by compare; its methods are watched",
    "ConstrainedTriangulation": "a result, made by constrained_delaunay; its methods are watched",
    "Contour": "a line of Contours",
    "Contours": "a result, made by Surface.contours; its methods are watched",
    "Counters": "a result, made by delaunay",
    "classify_ground": "CSF works in a process of its own, on a cloth of bounded size; a TIN "
    "has a hundred rounds at most",
    "CutFillResult": "a result, made by Surface.cut_and_fill",
    "Accuracy": "a result, made by Surface.accuracy",
    "FilledContours": "a result, made by Surface.filled_contours; its methods are watched",
    "Profile": "a result, made by Surface.profile; its methods are watched",
    "Frame": "made by triangulate from a plane; its methods are watched",
    "HullComparison": "a result, made by compare of a hull",
    "LowerHull": "a result; its methods are watched",
    "ConvexHull": "a result, made by convex_hull; its methods are watched",
    "Tetrahedralization.to_pyvista": "PyVista copies arrays",
    "Tetrahedralization": "a result, made by tetrahedralize; its methods are watched",
    "Raster": "a result, made by Surface.raster; its methods are watched",
    "RefineResult": "a result, made by refine; its methods are watched",
    "RegularTriangulation": "a result, made by regular; its methods and properties are watched",
    "Report": "a result, made by triangulate",
    "SphericalTriangulation": "a result, made by spherical_delaunay; its methods are watched",
    "StageStorage": "a result, made by Surface.stage_storage; its methods are watched",
    "Surface": "a result, made by triangulate; its methods are watched",
    "Tiled": "a result, made by tile; its methods are watched",
    "TiledSurface": "a result, made by tile_surface; its methods are watched",
    "Triangulations": "a result, made by delaunay_many: views of arrays",
    "Triangulations.triangulation": "views of arrays",
    "Triangulation": "a result, made by delaunay; its methods and properties are watched",
    "VolumeResult": "a result, made by Surface.volume",
}
"""Public names that are not watched, each with the reason; nor are exceptions and the version."""


@dataclass(frozen=True, slots=True)
class Subject:
    """A function that is watched, and the families that it is watched on.

    `prepare` makes the `Work` of an input of a family. `counted` names the families of which the
    tests count the instructions, all by default; `smallest` is the least of the sizes counted.
    """

    name: str
    families: Families
    prepare: Callable[[Any], Work]
    counted: tuple[str, ...] | None = None
    smallest: int = 64

    def sizes(self, family: str) -> tuple[int, int, int]:
        """Return the three sizes that are counted, each eight times the one before."""
        dear = family in (*DEAR, *DEEP, *HEAVY, *SLOW)
        fewest = 2 if family in SLOW else 4
        least = max(self.smallest // 8, fewest) if dear else self.smallest
        least *= 4 if family in CHEAP else 1
        return least, 8 * least, 64 * least


def content(data: bytes) -> int:
    """Return the size of a file, or of what it states to expand to."""
    return max(len(data), getattr(data, "content", 0), functions.stated_size(data))


def reader(found: Format) -> Callable[[bytes], Work]:
    """Make what prepares the reading of a whole file."""

    def prepare(data: bytes) -> Work:
        return Work(
            lambda: liftmesh.read(stream_of(data, found.name), format=found.name), content(data)
        )

    return prepare


def chunk_reader(found: Format) -> Callable[[bytes], Work]:
    """Make what prepares the reading of a file in chunks."""

    def prepare(data: bytes) -> Work:
        rows = max(len(data) // 32 // CHUNKS, 1)

        def call() -> int:
            stream = stream_of(data, found.name)
            return sum(map(len, liftmesh.read_chunks(stream, rows=rows, format=found.name)))

        return Work(call, content(data))

    return prepare


def writer(found: Format) -> Callable[[liftmesh.Cloud], Work]:
    """Make what prepares the writing of a cloud."""

    def prepare(cloud: liftmesh.Cloud) -> Work:
        values = sum(each[:1].size for each in cloud.attributes.values())
        units = len(cloud) * (1 + values) + len(cloud.faces if cloud.faces is not None else ())
        return Work(lambda: liftmesh.write(io.BytesIO(), cloud, format=found.name), units)

    return prepare


def of_formats() -> Iterator[Subject]:
    """Make the subjects of all formats in the table."""
    for each in FORMATS:
        families = FILES.get(each.name, {})
        ordinary = tuple(families)[:1]
        if each.read is not None:
            counted = GLTF_COUNTED if each.name == "gltf" else None  # all else is as in GLB
            yield Subject(f"read {each.name}", families, reader(each), counted, PARTS)
            whole = not each.read_chunks  # read whole, then split
            counted = ordinary if whole else IN_CHUNKS.get(each.name)
            yield Subject(f"read_chunks {each.name}", families, chunk_reader(each), counted, PARTS)
        if each.write is not None:
            yield Subject(f"write {each.name}", CLOUDS, writer(each), None, PARTS)


@cache
def subjects() -> Mapping[str, Subject]:
    """Return all subjects by name."""
    made = (
        Subject(*each)
        for each in (
            *functions.FUNCTIONS,
            *weighted.FUNCTIONS,
            *cells.FUNCTIONS,
            *surfaces.FUNCTIONS,
            *lined.FUNCTIONS,
            *disks.FUNCTIONS,
            *stars.FUNCTIONS,
            *changing.CHANGING,
            *constraints.CONSTRAINED,
        )
    )
    return MappingProxyType({each.name: each for each in (*made, *of_formats())})
