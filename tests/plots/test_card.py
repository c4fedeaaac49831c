"""What notebooks show: pictures and figures that are whole, small, harmless and right."""

from __future__ import annotations

import base64
import io
import os
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from PIL import Image

import liftmesh
from liftmesh import Cloud

RNG = np.random.default_rng(40)
FEW = RNG.random((40, 2))
ROWS = np.column_stack([RNG.random((900, 2)) * 30, RNG.random(900)])
SURFACE = liftmesh.triangulate(ROWS)
SPACE = RNG.normal(size=(200, 3))
HOSTILE = "</td></script><script>alert(1)</script>&\"'"


def tiled(folder: Path) -> Any:
    return liftmesh.tile_surface(ROWS, folder / "tiles", tile_rows=200)


MAKERS: dict[str, Callable[[Path], Any]] = {
    "surface": lambda _: SURFACE,
    "report": lambda _: SURFACE.report,
    "frame": lambda _: SURFACE.frame,
    "cloud": lambda _: SURFACE.to_cloud(),
    "few points": lambda _: Cloud(SPACE),
    "mesh": lambda _: liftmesh.convex_hull(SPACE).to_cloud(),
    "colors": lambda _: Cloud(ROWS, colors=(ROWS * 8).astype(np.uint8)),
    "raster": lambda _: SURFACE.raster(0.1),
    "contours": lambda _: SURFACE.contours(interval=0.1),
    "bands": lambda _: SURFACE.filled_contours(interval=0.5),
    "profile": lambda _: SURFACE.profile([[1, 1], [20, 20], [40, 0]]),
    "accuracy": lambda _: SURFACE.accuracy([[1, 1, 0.5], [2, 2, 0.4]]),
    "volume": lambda _: SURFACE.volume(0.5),
    "stages": lambda _: SURFACE.stage_storage([0.2, 0.5]),
    "triangulation": lambda _: SURFACE.triangulation,
    "constrained": lambda _: liftmesh.constrained_delaunay(FEW, edges=[[0, 1], [2, 3]]),
    "regular": lambda _: liftmesh.regular(FEW, radii=FEW[:, 0]),
    "refined": lambda _: liftmesh.refine([[[0.0, 0], [4, 0], [0, 3]]], max_area=0.5),
    "sets": lambda _: liftmesh.delaunay_many(FEW, [0, 20, 40]),
    "dynamic": lambda _: liftmesh.DynamicTriangulation(FEW),
    "lift": lambda _: liftmesh.delaunay(FEW).lifted(),
    "alpha shape": lambda _: liftmesh.delaunay(FEW).alpha_shape(),
    "alpha shape in space": lambda _: liftmesh.tetrahedralize(SPACE).alpha_shape(),
    "tetrahedra": lambda _: liftmesh.tetrahedralize(SPACE),
    "sphere": lambda _: liftmesh.spherical_delaunay(RNG.normal(size=(300, 3))),
    "alpha complex": lambda _: liftmesh.delaunay(FEW).alpha_complex(),
    "cells": lambda _: liftmesh.voronoi(FEW, domain=(0, 0, 1, 1)),
    "many cells": lambda _: liftmesh.voronoi(ROWS[:, :2], domain=(0, 0, 30, 30)),
    "disks": lambda _: liftmesh.apollonius_diagram(FEW, FEW[:, 0] / 9, domain=(0, 0, 1, 1)),
    "diagram": lambda _: liftmesh.voronoi(FEW).unclipped,
    "lloyd": lambda _: liftmesh.lloyd(FEW, max_iter=1),
    "weights": lambda _: SURFACE.weights([[5, 5]]),
    "certificate": lambda _: SURFACE.verify(),
    "flaws": lambda _: liftmesh.verify(SURFACE.triangulation.points, SURFACE.faces[1:]),
    "broken": lambda _: liftmesh.verify(FEW, [[0, 1, 99]]),
    "written": lambda folder: SURFACE.save(folder / "a.ply"),
    "tiled": tiled,
    "plain tiles": lambda folder: liftmesh.tile(FEW, folder / "tiles", tile_rows=16),
}


def parsed(result: Any) -> ET.Element:
    """Read a card as XML, which is stricter than HTML; its size and what is in it."""
    text = result._repr_html_()
    assert len(text.encode()) < 100_000
    assert "\n" not in repr(result)
    card = ET.fromstring(text)
    assert {each.tag.rpartition("}")[2] for each in card.iter()} <= {
        "div", "b", "table", "tr", "td", "svg", "path", "rect", "circle", "img"
    }  # fmt: skip
    return card


def figures(card: ET.Element) -> dict[str, str]:
    cells = [each.text or "" for each in card.iter("td")]
    return dict(zip(cells[::2], cells[1::2], strict=True))


def pixels(card: ET.Element) -> np.ndarray:
    (image,) = card.iter("img")
    data = image.attrib["src"].removeprefix("data:image/png;base64,")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))), int)


@pytest.mark.parametrize("name", MAKERS)
def test_every_result_has_a_card(name: str, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = MAKERS[name](tmp_path)
        card = parsed(result)
    assert next(card.iter("b")).text == type(result).__name__
    assert figures(card)
    drawn = {"frame", "accuracy", "volume", "stages", "sets", "weights", "written", "alpha complex"}
    has_picture = len([each for each in card.iter() if each.tag.endswith(("svg", "img"))]) > 0
    assert has_picture == (name not in drawn)


def test_figures_have_units() -> None:
    cloud = Cloud(ROWS + [500_000, 4_600_000, 0], crs="EPSG:25832")  # noqa: RUF005 - a sum
    surface = liftmesh.triangulate(cloud)
    said = figures(parsed(surface))
    assert re.fullmatch(r"500,000\.\d+ to 500,0\d\d\.\d+ metre", said["x"])
    assert said["coordinate system"] == "ETRS89 / UTM zone 32N"
    raster = surface.raster(2, quantity="slope")
    assert figures(parsed(raster))["size of a pixel"] == "2 x 2 metre"
    assert figures(parsed(raster))["slope"].endswith(" degree")
    assert repr(raster).endswith("pixels: slope in degree>")
    assert repr(surface).endswith("vertices, x and y in metre>")
    assert repr(surface.contours(interval=1)).endswith(", x and y in metre>")


def test_heights_are_colours_and_voids_are_transparent() -> None:
    slope = liftmesh.triangulate([[0, 0, 0], [10, 0, 0], [0, 10, 90], [10, 10, 90]])
    drawn = pixels(parsed(slope))
    assert drawn.shape == (200, 200, 4)
    assert (drawn[..., 3] > 250).all()
    assert drawn[2, 100, :3].sum() > 2 * drawn[-2, 100, :3].sum()  # north is up, and higher
    corner = liftmesh.triangulate([[0, 0, 0], [10, 0, 0], [0, 10, 90]])
    drawn = pixels(parsed(corner))
    assert drawn[5, 195, 3] == 0
    assert drawn[195, 5, 3] > 250


def test_a_part_of_many_is_said() -> None:
    card = parsed(SURFACE.triangulation)
    assert any((each.text or "").endswith("triangles, in the middle") for each in card.iter("div"))


def test_hostile_names_and_values_are_text() -> None:
    named = SURFACE.with_attributes({HOSTILE: np.full(len(ROWS), np.nan)}).replace(crs=HOSTILE)
    said = figures(parsed(named))
    assert said["values"] == HOSTILE
    assert figures(parsed(named.to_cloud()))["coordinate system"].count("script") > 0
    long = liftmesh.WriteResult(Path("x" * 10**6), HOSTILE, 1, None, (HOSTILE,) * 999)
    assert figures(parsed(long))["format"] == HOSTILE
    parsed(liftmesh.WriteResult(Path(os.fsdecode(b"a\xff.ply")), "ply", 1, None, ()))
    parsed(liftmesh.Raster(np.ones((3, 3)), (1, 0, 0, 0, -1, 0), quantity="\n" * 10**6))


@pytest.mark.parametrize(
    "result",
    [
        Cloud(np.empty((0, 3))),
        Cloud(np.full((5, 3), np.nan)),
        Cloud(np.array([[1e308, -1e308, 0], [-1e308, 1e308, np.inf]])),
        Cloud(np.ones((3000, 3))),
        Cloud(np.array([[0, 0, np.inf], [1, 0, -np.inf], [0, 1, 0]]), faces=np.array([[0, 1, 2]])),
        liftmesh.tetrahedralize((RNG.random((20, 3)) - 0.5) * 1e300),
        liftmesh.lower_hull(RNG.random((20, 3)) * 1e300),
        liftmesh.triangulate([[0, 0, 1], [1, 0, 1e-200], [0, 1, 0], [1, 1, 1e-200]]),
        liftmesh.Raster(np.full((3, 3), np.nan), (1, 0, 0, 0, -1, 0)),
        liftmesh.Raster(np.empty((0, 4)), (1, 0, 0, 0, -1, 0)),
        liftmesh.Raster(RNG.random((700, 900)), (1, 0.5, 0, 0, 1, 0)),
        SURFACE.contours([99, 98]),
        SURFACE.profile([[90, 90], [99, 99]]),
        liftmesh.triangulate([[0, 0, 1], [1e6, 0, 2], [0, 1e-3, 3.0]]),
        liftmesh.delaunay(FEW * 1e300),
        liftmesh.voronoi(FEW, domain=(5, 5, 6, 6)),
        liftmesh.voronoi([[0, 0], [1, 1], [2, 2]]).unclipped,
        liftmesh.voronoi([[0, 0], [1, 0], [2, 1e-320], [1, -1]]).unclipped,
        liftmesh.verify([[0, 0], [1, 0], [0, 1], [np.nan, 2]], [[0, 1, 3]], nonfinite="skip"),
        liftmesh.delaunay([*FEW.tolist(), [np.nan, 1]], nonfinite="skip"),
    ],
)
def test_what_can_hardly_be_drawn_has_a_card(result: Any) -> None:
    with np.errstate(all="raise"):
        parsed(result)


def test_points_without_a_height_are_grey() -> None:
    drawn = pixels(parsed(Cloud(np.column_stack([RNG.random((2000, 2)), np.full(2000, np.nan)]))))
    assert {*map(tuple, drawn[drawn[..., 3] > 0].tolist())} == {(136, 136, 136, 255)}


def test_of_many_lines_the_longest_are_shown() -> None:
    short = np.tile([[0.0, 0], [3, 3]], (5000, 1)) + np.repeat(
        RNG.random((5000, 2)) * 90, 2, axis=0
    )
    points = np.concatenate([short, [[0, 0], [90, 0], [90, 90]]])
    starts, count = np.append(np.arange(0, 10_001, 2), 10_003), 5001
    flags = np.zeros(count, np.bool_)
    lines = liftmesh.Contours(points, starts, np.zeros(count), flags, flags)
    card = parsed(lines)
    (thin,) = [each for each in card.iter() if each.tag.endswith("path")]
    drawn = [each.split("L") for each in thin.attrib["d"].split("M")[1:]]
    assert len(drawn[-1]) == 3
    assert sum(map(len, drawn)) in (5999, 6000)
    assert any(each.text == "the longest of 5,001 lines" for each in card.iter("div"))


def test_noise_is_bounded() -> None:
    noise = liftmesh.triangulate(RNG.random((8_000, 3)))
    for each in (noise, noise.contours(interval=0.05), noise.profile(FEW), noise.to_cloud()):
        parsed(each)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(*[st.floats()] * 3), max_size=20), st.integers(0, 2))
def test_any_cloud_has_a_card(rows: list[tuple[float, ...]], power: int) -> None:
    points = np.tile(np.array(rows).reshape(-1, 3), (10**power, 1))
    assert len(points) == len(rows) * 10**power
    parsed(Cloud(points))


def test_tiles_without_their_folder_have_figures(tmp_path: Path) -> None:
    made = liftmesh.tile_surface(ROWS, tmp_path / "tiles", tile_rows=200)
    (made.folder / "plan.json").unlink()
    card = parsed(made)
    assert figures(card)["rows"] == "900"
    assert not [each for each in card.iter() if each.tag.endswith("svg")]
