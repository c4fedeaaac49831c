"""The comparison of heights with CGAL's, and what programs beside liftmesh make of its faces."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from benchmark import cgal
from heights import __main__ as campaign
from heights.families import FAMILIES, inside, terrain
from heights.peers import CgalHeights, Faceraster, GdalGrid
from rasterio import open as open_raster

import liftmesh


@pytest.mark.parametrize("name", FAMILIES)
def test_families_fill_the_square(name: str) -> None:
    rng = np.random.default_rng(1)
    rows = terrain(FAMILIES[name](2000, rng))
    assert abs(len(rows) - 2000) < 100
    assert rows[:, :2].min() >= 0
    assert rows[:, :2].max() <= 1
    assert np.isfinite(liftmesh.triangulate(rows * (1, 1, 0.001)).sample(inside(500, rng))).all()


class Answer:
    """A peer that has its answer."""

    def __init__(self, heights: np.ndarray) -> None:
        self.heights = heights

    def sample(self, *_: object) -> tuple[np.ndarray, float]:
        return self.heights, 4.0


@pytest.mark.parametrize(("moved", "is_same"), [(0, True), (1e-13, True), (1e-9, False)])
def test_a_difference_is_told(moved: float, is_same: bool, capsys) -> None:
    rng = np.random.default_rng(2)
    surface = liftmesh.triangulate(terrain(FAMILIES["uniform"](200, rng)))
    asked = inside(50, rng)
    heights = surface.sample(asked, "sibson")
    heights[7] += moved * np.ptp(surface.vertices[:, 2])
    case = surface, Answer(heights), asked, "sibson", 2, "uniform"
    assert campaign.compare(*case) == is_same
    line = capsys.readouterr().out
    assert ("DIFFERENT" in line) != is_same
    assert " 4.0000 " in line


def test_a_height_that_is_missing_is_a_difference() -> None:
    heights, nowhere = np.array([1.0, 2.0]), np.array([1.0, np.nan])
    assert campaign.difference(heights, nowhere, 1) == float("inf")
    assert campaign.difference(nowhere[1:], nowhere[1:], 1) == float("inf")
    assert campaign.difference(nowhere, nowhere, 1) == 0
    assert campaign.difference(heights, heights + 1, 4) == 0.25


def test_without_headers_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cgal, "HEADERS", "CGAL/no_such_header.h")
    monkeypatch.setattr(sys, "argv", ["heights", "--n", "100"])
    with pytest.raises(SystemExit, match=r"CGAL is not here: .*install libcgal-dev"):
        campaign.main()


@pytest.mark.campaign
def test_programs_make_the_heights_of_liftmesh(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    rows = terrain(FAMILIES["uniform"](300, rng))
    surface, asked = liftmesh.triangulate(rows), inside(100, rng)
    peer, loop = CgalHeights.built(tmp_path, rows), Faceraster.built(tmp_path, surface)
    for method in campaign.METHODS:
        heights, seconds = peer.sample(asked, method)
        np.testing.assert_allclose(heights, surface.sample(asked, method), atol=1e-9)
        assert seconds >= 0
    assert np.isnan(peer.sample(np.array([[2.0, 2.0]]), "sibson")[0]).all()
    assert loop.seconds(1.0, 20, tmp_path / "pixels") >= 0
    np.testing.assert_allclose(np.fromfile(tmp_path / "pixels").reshape(20, 20), ours(surface))


def ours(surface: liftmesh.Surface) -> np.ndarray:
    return surface.raster(transform=(0.05, 0, 0, 0, -0.05, 1), shape=(20, 20)).values


def test_gdal_makes_the_same_raster(tmp_path: Path) -> None:
    rows = terrain(FAMILIES["uniform"](300, np.random.default_rng(4)))
    gdal = GdalGrid.found(tmp_path, rows)
    assert gdal is not None, "gdal_grid is not here: install gdal-bin"
    gdal.make(1.0, 20)
    gdal.only_read(1.0)
    gdal.only_write(20)
    with open_raster(tmp_path / "grid.tif") as made, open_raster(tmp_path / "one.tif") as one:
        pixels, expected = made.read(1), ours(liftmesh.triangulate(rows))
        assert one.read(1).tolist() == [[300.0]]
    held = np.isfinite(expected)
    np.testing.assert_allclose(pixels[held], expected[held], atol=1e-4)
