"""`liftmesh raster --minus`: maps of cut and fill, of files and of tiles."""

from __future__ import annotations

import numpy as np
import rasterio
from commands import failed, liftmesh as run
from surfaces import meadow

import liftmesh


def test_a_raster_less_another_surface(tmp_path) -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=12, boundary_only=True)
    tin = surface.save(tmp_path / "tin.ply").path
    other = liftmesh.triangulate(surface.vertices[::2] + np.array([0, 0, 1.5]))
    other.save(tmp_path / "before.ply")
    liftmesh.tile_surface(other.vertices, tmp_path / "before", tile_rows=100)
    liftmesh.tile_surface(surface.vertices, tmp_path / "after", tile_rows=100)
    whole = liftmesh.triangulate(surface.vertices)
    for before, after, one in (
        ("before.ply", tin, surface),
        ("before", tin, surface),
        ("before", tmp_path / "after", whole),
    ):
        words = ("--resolution", "2", "--double", "--minus", tmp_path / before, "--overwrite")
        done = run("raster", after, tmp_path / "change.tif", *words)
        assert done.returncode == 0, done.stderr
        assert "pixels of difference" in done.stdout
        places = one.raster(2).centers()
        with rasterio.open(tmp_path / "change.tif") as file:
            np.testing.assert_array_equal(file.read(1), one.sample(places) - other.sample(places))
    done = run("raster", tin, tmp_path / "c.tif", *words, "--quantity", "aspect")
    failed(done, 3, "of aspect nothing is subtracted")
    failed(run("raster", tin, tmp_path / "c.tif", *words[:4], "no.ply"), 3, "no.ply")
