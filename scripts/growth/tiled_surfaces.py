"""Surfaces in tiles, and what is made of them, as subjects to watch."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from distributions import Points

import liftmesh
from growth.counting import Work
from growth.planar import PLANAR
from growth.spatial import SPATIAL

Prepare = Callable[[Any], Work]


def surface_tiles(points: Points) -> Work:
    """Prepare a surface in eight tiles, in a folder of its own."""
    rows = max(16, len(points) // 8)

    def call() -> object:
        with tempfile.TemporaryDirectory() as folder:
            return liftmesh.tile_surface(points, folder, tile_rows=rows, threads=1)

    return Work(call, len(points))


def on_surface_tiles(call: Callable[[liftmesh.TiledSurface], object]) -> Prepare:
    """Prepare a call on a surface in shards."""

    def prepare(points: Points) -> Work:
        folder, rows = tempfile.TemporaryDirectory(), max(16, len(points) // 8)
        found = liftmesh.tile_surface(points, folder.name, tile_rows=rows, threads=1)
        return Work(lambda: (folder, call(found)), len(points))

    return prepare


def pixels(tiled: liftmesh.TiledSurface) -> dict[str, Any]:
    """Lay about one pixel over each row."""
    west, south, _, east, north, _ = tiled.extent
    count = int(tiled.npoints**0.5) + 1
    transform = ((east - west) / count, 0, west, 0, (south - north) / count, north)
    return {"transform": transform, "shape": (count, count), "threads": 1}


def saved(tiled: liftmesh.TiledSurface) -> object:
    """Write a raster beside the shards."""
    return tiled.save_raster(Path(tiled.directory) / "raster.tif", **pixels(tiled))


def lines(tiled: liftmesh.TiledSurface) -> object:
    """Find lines at four levels."""
    return tiled.contours(np.linspace(tiled.extent[2], tiled.extent[5], 6)[1:-1])


def tiled_surface_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families."""
    yield "tile_surface", PLANAR, surface_tiles, ("uniform", "few positions")
    heights = ("random heights",)
    for name in ("report", "vertices", "faces", "meshes"):
        yield f"TiledSurface.{name}", SPATIAL, on_surface_tiles(PARTS[name]), heights
    raster = on_surface_tiles(lambda tiled: tiled.raster(**pixels(tiled)))
    yield "TiledSurface.raster", SPATIAL, raster, heights
    yield "TiledSurface.save_raster", SPATIAL, on_surface_tiles(saved), ()
    yield "TiledSurface.contours", SPATIAL, on_surface_tiles(lines), heights


PARTS: dict[str, Callable[[liftmesh.TiledSurface], object]] = {
    "report": lambda tiled: tiled.report,
    "vertices": lambda tiled: list(tiled.vertices()),
    "faces": lambda tiled: list(tiled.faces()),
    "meshes": lambda tiled: list(tiled.meshes()),
}
