"""The shipped clouds: their script makes the same bytes again, and they hold what is said."""

from __future__ import annotations

from pathlib import Path

import make_data
import numpy as np
import pytest

import liftmesh

DATA = Path(__file__).resolve().parent.parent / "data"
CLOUDS = sorted(p.name for p in DATA.iterdir() if p.is_file() and p.suffix not in {".md", ".png"})


@pytest.fixture(scope="module")
def remade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data")
    make_data.main(folder)
    return folder


def test_the_script_makes_every_cloud(remade: Path) -> None:
    assert sorted(p.name for p in remade.iterdir()) == CLOUDS


@pytest.mark.parametrize("name", CLOUDS)
def test_regeneration_gives_the_same_bytes(name: str, remade: Path) -> None:
    assert (remade / name).read_bytes() == (DATA / name).read_bytes()


@pytest.mark.parametrize("name", CLOUDS)
def test_the_readme_lists_every_cloud(name: str) -> None:
    assert f"`{name}`" in (DATA / "README.md").read_text("utf-8")


def test_the_terrain_is_a_lattice_in_metres_from_north_to_south() -> None:
    points = liftmesh.read(DATA / "jacksboro.ply").points.reshape(344, 403, 3)
    x, y, z = np.moveaxis(points, -1, 0)
    assert np.array_equal(x, np.broadcast_to(x[0], x.shape))
    assert np.array_equal(y, np.broadcast_to(y[:, :1], y.shape))
    assert np.allclose(np.diff(x[0]), 74.404, atol=0.0011)
    assert np.allclose(np.diff(y[:, 0]), -92.667, atol=0.0011)
    assert (x[0, 0], y[-1, 0]) == (0.0, 0.0)
    assert (z.min(), z.max()) == (236.0, 1076.0)


def test_the_terrain_triangulates_without_a_row_left_out() -> None:
    report = liftmesh.triangulate(DATA / "jacksboro.ply").report
    assert (report.n_rows, report.n_used) == (344 * 403, 344 * 403)
    assert report.n_triangles == 2 * 343 * 402


def test_the_overhang_has_a_wall_and_a_repeated_row() -> None:
    report = liftmesh.triangulate(DATA / "overhang.ply").report
    assert (report.n_rows, report.n_overhangs, report.n_duplicates) == (25, 4, 1)


def test_the_hill_keeps_its_colours() -> None:
    surface = liftmesh.triangulate(DATA / "hill.csv")
    assert surface.colors is not None
    assert surface.colors.shape == (80, 3)
    assert surface.report.n_used == 80


def test_the_quad_is_a_tie_that_the_largest_point_loses() -> None:
    tri = liftmesh.delaunay(liftmesh.read(DATA / "quad.xyz").points[:, :2], order="canonical")
    assert tri.simplices.tolist() == [[0, 1, 3], [3, 1, 2]]
