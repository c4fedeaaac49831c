"""Triangles and surfaces in tiles, and what is made of them, as subjects to watch."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from distributions import Points
from growth.counting import Prepare, Work, on
from growth.planar import PLANAR
from growth.spatial import SPATIAL

import liftmesh


def tiled_by(work: Callable[..., object]) -> Prepare:
    """Prepare a run in eight tiles, in a folder of its own."""

    def prepare(points: Points) -> Work:
        def call() -> object:
            with tempfile.TemporaryDirectory() as folder:
                return work(points, folder, tile_rows=rows_of(points), threads=1)

        return Work(call, len(points))

    return prepare


def on_shards(work: Callable[..., Any], call: Callable[[Any], object], **options: Any) -> Prepare:
    """Prepare a call on what such a run leaves in its folder."""

    def made(points: Points) -> tuple[object, Any]:
        folder = tempfile.TemporaryDirectory()
        run = work(points, folder.name, tile_rows=rows_of(points), threads=1, **options)
        return folder, run

    return on(made)(lambda pair: (pair[0], call(pair[1])))


on_tiles = partial(on_shards, liftmesh.tile)
on_surface_tiles = partial(on_shards, liftmesh.tile_surface)


def rows_of(points: Points) -> int:
    """Return the rows of a tile."""
    return max(16, len(points) // 8)


def proved(points: Points) -> Work:
    """Prepare the proof of triangles in shards."""
    return on_tiles(lambda tiled: tiled.verify(points, threads=1))(points)


def pixels(tiled: liftmesh.TiledSurface) -> dict[str, Any]:
    """Lay about one pixel over each row."""
    west, south, east, north = tiled.bounds
    count = int(tiled.npoints**0.5) + 1
    transform = ((east - west) / count, 0, west, 0, (south - north) / count, north)
    return {"transform": transform, "shape": (count, count), "threads": 1}


def saved(tiled: liftmesh.TiledSurface) -> object:
    """Write a raster beside the shards."""
    return tiled.save_raster(Path(tiled.folder) / "raster.tif", **pixels(tiled))


def corners(tiled: liftmesh.TiledSurface) -> Points:
    """Return the corners of all shards."""
    return np.concatenate([mesh.points for mesh in tiled.iter_meshes()])


def middle(tiled: liftmesh.TiledSurface) -> Points:
    """Return a triangle in the middle."""
    west, south, east, north = tiled.bounds
    corners = np.array([[0.2, 0.3], [0.7, 0.25], [0.5, 0.8]])
    return (west, south) + (east - west, north - south) * corners


def lines(tiled: liftmesh.TiledSurface) -> object:
    """Find lines at four levels."""
    return tiled.contours(np.linspace(*tiled.manifest["surface"]["box"][2::3], 6)[1:-1])


def tiled_surface_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families."""
    yield "tile_surface", PLANAR, tiled_by(liftmesh.tile_surface), ("uniform", "few positions")
    heights = ("random heights",)
    for name in ("report", "iter_vertices", "iter_faces", "iter_meshes"):
        yield f"TiledSurface.{name}", SPATIAL, on_surface_tiles(PARTS[name]), heights
    raster = on_surface_tiles(lambda tiled: tiled.raster(**pixels(tiled)))
    yield "TiledSurface.raster", SPATIAL, raster, heights
    yield "TiledSurface.save_raster", SPATIAL, on_surface_tiles(saved), ()
    yield "TiledSurface.contours", SPATIAL, on_surface_tiles(lines), heights
    at = on_surface_tiles(lambda tiled: tiled.sample(corners(tiled)[:, :2], threads=1))
    yield "TiledSurface.sample", SPATIAL, at, heights
    above = on_surface_tiles(lambda tiled: tiled.height_above(corners(tiled), threads=1))
    yield "TiledSurface.height_above", SPATIAL, above, ()
    bands = on_surface_tiles(lambda tiled: tiled.filled_contours([0.0, 0.5]))
    yield "TiledSurface.filled_contours", SPATIAL, bands, ()
    part = on_surface_tiles(lambda tiled: tiled.clip(middle(tiled), threads=1))
    yield "TiledSurface.clip", SPATIAL, part, ()


PARTS: dict[str, Callable[[liftmesh.TiledSurface], object]] = {
    "report": lambda tiled: tiled.report,
    "iter_vertices": lambda tiled: list(tiled.iter_vertices()),
    "iter_faces": lambda tiled: list(tiled.iter_faces()),
    "iter_meshes": lambda tiled: list(tiled.iter_meshes()),
}


def tiled_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families of what works in tiles."""
    yield (
        "tile",
        PLANAR,
        tiled_by(liftmesh.tile),
        ("uniform", "circle and centre", "two columns", "few positions"),
    )
    opened = on_tiles(lambda tiled: liftmesh.open_tiled(tiled.folder))
    yield "open_tiled", PLANAR, opened, ("uniform",)
    yield "Tiled.to_array", PLANAR, on_tiles(liftmesh.Tiled.to_array), ("uniform",)
    yield "Tiled.verify", PLANAR, proved, ("uniform", "circle and centre", "few positions")
    yield "Tiled.is_sound", PLANAR, on_tiles(liftmesh.Tiled.is_sound), ("uniform",)
    linked = on_tiles(liftmesh.Tiled.neighbors_to_array, neighbors=True)
    yield "Tiled.neighbors_to_array", PLANAR, linked, ("uniform",)
    blocks = on_tiles(lambda tiled: list(tiled.iter_neighbor_blocks()), neighbors=True)
    yield "Tiled.iter_neighbor_blocks", PLANAR, blocks, ("uniform",)
    yield (
        "Tiled.iter_blocks",
        PLANAR,
        on_tiles(lambda tiled: list(tiled.iter_blocks())),
        ("uniform",),
    )
    for name in ("to_delayed", "to_dask_dataframe"):  # Dask takes long to import under callgrind
        yield f"Tiled.{name}", PLANAR, on_tiles(getattr(liftmesh.Tiled, name)), ()
        surface = on_surface_tiles(getattr(liftmesh.TiledSurface, name))
        yield f"Tiled.{name} of a surface", SPATIAL, surface, ()
    yield "Tiled.report", PLANAR, on_tiles(lambda tiled: tiled.report), ()
    yield from tiled_surface_functions()
