"""The generators of files: the same number makes the same file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from fuzz.structure.e57 import scans
from fuzz.structure.gltf import gltf
from fuzz.structure.las import copc, las, laz
from fuzz.structure.numpy_files import npy, npz
from fuzz.structure.parts import Chance
from fuzz.structure.ply import ply
from fuzz.structure.points import compressed, ele, node, pcd, poly, pts, xyzrgb
from fuzz.structure.raster import geotiff, grid
from fuzz.structure.shapes import geojson, geopackage, shapefile
from fuzz.structure.tetrahedra import cells
from fuzz.structure.text import ascii_stl, binary_stl, dxf, mesh2d, obj, off, table
from fuzz.structure.xml import landxml

if TYPE_CHECKING:
    from fuzz.structure.case import Case

GENERATORS: dict[str, Callable[[Chance], Case]] = {
    "ply": ply,
    "obj": obj,
    "off": off,
    "text": table,
    "ascii-stl": ascii_stl,
    "stl": binary_stl,
    "gltf": gltf,
    "npy": npy,
    "npz": npz,
    "pcd": pcd,
    "pts": pts,
    "xyzrgb": xyzrgb,
    "node": node,
    "ele": ele,
    "poly": poly,
    "gzip": compressed,
    "las": las,
    "laz": laz,
    "copc": copc,
    "e57": scans,
    "landxml": landxml,
    "2dm": mesh2d,
    "dxf": dxf,
    "geojson": geojson,
    "geopackage": geopackage,
    "shapefile": shapefile,
    "tetrahedra": cells,
    "geotiff": geotiff,
    "grid": grid,
}


def generated(name: str, number: int) -> Case:
    """Make the file of a generator with a number."""
    return GENERATORS[name](Chance(f"{name} {number}"))
