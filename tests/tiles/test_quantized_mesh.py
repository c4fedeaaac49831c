"""Tiles of the globe: decoded as the specification says, equal on common sides, errors as said."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyproj
import pytest
from hypothesis import given, strategies as st
from matplotlib.tri import LinearTriInterpolator, Triangulation

import liftmesh
from liftmesh import InputError, QuantizedMeshResult, Surface, write_quantized_mesh
from liftmesh.tiles import terrain_parts
from liftmesh.tiles.quantized_mesh import QuantizedTile, encoded

ZOOM = 14


class Decoded(NamedTuple):
    """A tile as the specification has it."""

    header: tuple[float, ...]
    uvh: np.ndarray
    faces: np.ndarray
    edges: dict[str, list[int]]


def decoded(data: bytes) -> Decoded:
    """Read a tile step by step, by the words of the specification."""
    header = struct.unpack_from("<3d2f4d3d", data)
    (count,) = struct.unpack_from("<I", data, 88)
    at, columns = 92, []
    for _ in range(3):
        value, column = 0, []
        for code in struct.unpack_from(f"<{count}H", data, at):
            value += (code >> 1) ^ -(code & 1)
            column.append(value)
        columns.append(column)
        at += 2 * count
    letter, size = ("H", 2) if count <= 65536 else ("I", 4)
    at += -at % size
    (triangles,) = struct.unpack_from("<I", data, at)
    at += 4
    highest, corners = 0, []
    for code in struct.unpack_from(f"<{3 * triangles}{letter}", data, at):
        corners.append(highest - code)
        highest += code == 0
    at += 3 * triangles * size
    edges = {}
    for name in ("west", "south", "east", "north"):
        (length,) = struct.unpack_from("<I", data, at)
        edges[name] = [*struct.unpack_from(f"<{length}{letter}", data, at + 4)]
        at += 4 + length * size
    assert at == len(data)
    return Decoded(header, np.array(columns).T, np.reshape(corners, (-1, 3)), edges)


def hills() -> Surface:
    """Some square kilometres in UTM, across the borders of tiles."""
    rng = np.random.default_rng(3)
    side = np.linspace(0, 1, 41)
    frame = [(x, y) for x in side for y in side if x in (0, 1) or y in (0, 1)]
    plane = np.concatenate([rng.random((2000, 2)), frame]) * 4000 + [500_000, 5_400_000]
    east, north = ((plane - [500_000, 5_400_000]) / 400).T
    heights = 300 + 80 * np.sin(east) * np.cos(north)
    return liftmesh.triangulate(np.column_stack([plane, heights]), crs="EPSG:25832")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Surface, QuantizedMeshResult]:
    surface = hills()
    folder = tmp_path_factory.mktemp("globe") / "new"
    return surface, write_quantized_mesh(surface, folder, max_error=6, zoom=ZOOM)


def tiles(found: QuantizedMeshResult) -> dict[tuple[int, int, int], Decoded]:
    folder = found.path.parent
    return {
        (int(path.parts[-3]), int(path.parts[-2]), int(path.stem)): decoded(path.read_bytes())
        for path in folder.glob("*/*/*.terrain")
    }


def test_tiles_are_whole_and_neighbours_have_the_same_numbers(
    made: tuple[Surface, QuantizedMeshResult],
) -> None:
    found = tiles(made[1])
    compared = 0
    for (level, column, row), tile in found.items():
        u, v, _ = tile.uvh.T
        a, b, c = np.moveaxis(tile.uvh[tile.faces][:, :, :2], 1, 0)
        (ux, uy), (vx, vy) = (b - a).T, (c - a).T
        turns = ux * vy - uy * vx
        assert (turns > 0).all()
        assert turns.sum() == 2 * 32767**2
        for name, on in (("west", u == 0), ("south", v == 0), ("east", u == 32767)):
            assert sorted(tile.edges[name]) == np.flatnonzero(on).tolist()
        assert sorted(tile.edges["north"]) == np.flatnonzero(v == 32767).tolist()
        for name, back, other, axis in (
            ("east", "west", (level, column + 1, row), 1),
            ("north", "south", (level, column, row + 1), 0),
        ):
            if other in found:
                here, there = (
                    each.uvh[each.edges[side]][:, [axis, 2]]
                    for each, side in ((tile, name), (found[other], back))
                )
                assert here.tolist() == there.tolist()
                assert tile.header[3:5] == found[other].header[3:5]
                compared += 1
    assert compared > 20


def on_map(level: int, column: int, row: int, tile: Decoded) -> np.ndarray:
    """Return longitude, latitude and height of the vertices."""
    width = 180 / 2**level
    low, high = tile.header[3:5]
    u, v, h = tile.uvh.T / 32767
    return np.column_stack(
        [(column + u) * width - 180, (row + v) * width - 90, low + h * (high - low)]
    )


def test_no_point_is_farther_than_the_error(made: tuple[Surface, QuantizedMeshResult]) -> None:
    surface, found = made
    to_degrees = pyproj.Transformer.from_crs(25832, 4326, always_xy=True)
    plane = surface.vertices
    degrees = np.column_stack(to_degrees.transform(plane[:, 0], plane[:, 1]))
    middle = degrees.mean(axis=0)
    shape = Triangulation(*(degrees - middle).T, surface.faces)
    places = degrees.min(axis=0) + np.random.default_rng(1).random((30_000, 2)) * np.ptp(
        degrees, axis=0
    )
    heights = LinearTriInterpolator(shape, plane[:, 2])(*(places - middle).T).filled(np.nan)
    rows = np.concatenate(
        [np.column_stack([degrees, plane[:, 2]]), np.column_stack([places, heights])]
    )
    rows = rows[np.isfinite(rows[:, 2])]
    worst = dict.fromkeys(range(ZOOM + 1), 0.0)
    for key, tile in tiles(found).items():
        at = on_map(*key, tile)
        low, high = at.min(axis=0), at.max(axis=0)
        inside = rows[((rows[:, :2] > low[:2]) & (rows[:, :2] < high[:2])).all(axis=1)]
        if len(inside) and key[0] > 6:
            flat = Triangulation(*(at[:, :2] - low[:2]).T, tile.faces)
            there = LinearTriInterpolator(flat, at[:, 2])(*(inside[:, :2] - low[:2]).T)
            away = np.abs(there.filled(np.nan) - inside[:, 2])
            worst[key[0]] = max(worst[key[0]], np.nanmax(away))
    for level in range(7, ZOOM + 1):
        assert worst[level] <= found.errors[level] + 1e-6
    assert worst[ZOOM] > 0.6 * found.errors[ZOOM]
    assert found.errors[ZOOM] < 30


def test_headers_hold_what_the_vertices_need(made: tuple[Surface, QuantizedMeshResult]) -> None:
    to_space = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
    for key, tile in tiles(made[1]).items():
        at = np.column_stack(to_space.transform(*on_map(*key, tile).T))
        middle, radius, horizon = tile.header[5:8], tile.header[8], np.array(tile.header[9:12])
        assert np.linalg.norm(at - middle, axis=1).max() <= radius * (1 + 1e-9) + 1e-3
        if key[0] >= 8:
            assert np.linalg.norm(at.mean(axis=0) - tile.header[:3]) < 1.5 * radius
            # A camera that sees no vertex of a smooth earth does not see the point either: seen
            # from far away, what is behind the horizon is beyond the plane of the horizon.
            scaled = at / [6378137.0, 6378137.0, 6356752.3142451793]
            for _ in range(3):
                camera = -3 * horizon / np.linalg.norm(horizon) + np.random.default_rng(0).normal(
                    size=3
                )
                if not any(_is_seen(camera, each) for each in scaled):
                    assert not _is_seen(camera, horizon)


def _is_seen(camera: np.ndarray, point: np.ndarray) -> bool:
    """Whether a line of sight passes beside the unit sphere."""
    way = point - camera
    share = np.clip(-(camera @ way) / (way @ way), 0, 1)
    return bool(np.linalg.norm(camera + share * way) >= 1 - 1e-12)


@pytest.mark.slow
def test_a_surface_in_tiles_gives_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Moved in blocks of few faces, with a hull that is bent on the globe, and places beyond it."""
    monkeypatch.setattr(terrain_parts, "_BLOCK", 100)
    monkeypatch.setattr(terrain_parts, "_KEPT", 300)
    points = hills().vertices[::3] + np.array([-150_000, 200_000, 0])  # where lines bend
    tiled = liftmesh.tile_surface(points, tmp_path / "shards", tile_rows=300, crs="EPSG:25832")
    whole = liftmesh.triangulate(points, crs="EPSG:25832")
    found = [
        write_quantized_mesh(each, tmp_path / name, max_error=20, zoom=13)
        for name, each in (("a", whole), ("b", tiled))
    ]
    assert found[0].errors == found[1].errors
    files = sorted((tmp_path / "a").rglob("*.*"))
    assert len(files) > 20
    for path in files:
        twin = tmp_path / "b" / path.relative_to(tmp_path / "a")
        assert path.read_bytes() == twin.read_bytes()


def test_holes_are_filled(tmp_path: Path) -> None:
    square = np.array([[0, 0], [1500, 0], [1500, 1500], [0, 1500]]) + np.array([501_000, 5_401_000])
    surface = hills().clip(square, invert=True)
    write_quantized_mesh(surface, tmp_path, max_error=6, zoom=12)
    for path in tmp_path.glob("12/*/*.terrain"):
        tile = decoded(path.read_bytes())
        a, b, c = np.moveaxis(tile.uvh[tile.faces][:, :, :2], 1, 0)
        (ux, uy), (vx, vy) = (b - a).T, (c - a).T
        assert (ux * vy - uy * vx).sum() == 2 * 32767**2


def test_the_layer_says_what_there_is(made: tuple[Surface, QuantizedMeshResult]) -> None:
    layer = json.loads(made[1].path.read_text())
    assert (layer["format"], layer["scheme"]) == ("quantized-mesh-1.0", "tms")
    assert layer["projection"] == "EPSG:4326"
    assert layer["tiles"] == ["{z}/{x}/{y}.terrain"]
    there = {
        (level, x, y)
        for level, [box] in enumerate(layer["available"])
        for x in range(box["startX"], box["endX"] + 1)
        for y in range(box["startY"], box["endY"] + 1)
    }
    assert there == set(tiles(made[1]))
    assert layer["maxzoom"] == ZOOM
    west, south, east, north = layer["bounds"]
    assert 8.9 < west < east < 9.1
    assert 48.7 < south < north < 48.8
    assert [sum(key[0] == level for key in there) for level in range(ZOOM + 1)] == list(
        made[1].n_tiles
    )


def meshes() -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Meshes with every sign of steps, and one that 16 bits do not number."""
    rng = np.random.default_rng(0)
    for count in (3, 50, 70_000):
        corners = np.array([[0, 0], [32767, 0], [32767, 32767], [0, 32767]])
        places = np.unique(np.concatenate([corners, rng.integers(0, 32768, (count, 2))]), axis=0)
        yield (
            np.column_stack([places, rng.integers(0, 32768, len(places))]),
            liftmesh.delaunay(places).simplices,
        )


def test_any_mesh_comes_back() -> None:
    for places, faces in meshes():
        tile = QuantizedTile(places, faces, 1.0, 2.0, np.ones(3), np.ones((len(places), 3)))
        back = decoded(encoded(tile))
        assert np.array_equal(back.uvh[back.faces], places[faces])


@given(st.lists(st.tuples(*[st.integers(0, 32767)] * 3), min_size=3, max_size=20), st.data())
def test_any_numbers_come_back(rows: list[tuple[int, ...]], data: Any) -> None:
    places = np.array(rows)
    corner = st.integers(0, len(rows) - 1)
    faces = np.array(data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1)))
    tile = QuantizedTile(places, faces, 0.0, 1.0, np.ones(3), np.ones((len(places), 3)))
    back = decoded(encoded(tile))
    assert np.array_equal(back.uvh[back.faces], places[faces])


def test_level_ground_and_the_order_of_rows(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(hills().vertices * [1, 1, 0] + [0, 0, 7], crs="EPSG:25832")
    found = write_quantized_mesh(surface, tmp_path / "a", max_error=1, zoom=9)
    assert max(found.errors) < 1e-3
    order = np.random.default_rng(1).permutation(len(surface.vertices))
    one = hills()
    other = liftmesh.triangulate(one.vertices[order], crs="EPSG:25832")
    for name, each in (("b", one), ("c", other)):
        write_quantized_mesh(each, tmp_path / name, max_error=20, zoom=10)
    files = sorted(path for path in (tmp_path / "b").rglob("*") if path.is_file())
    assert len(files) > 11
    for path in files:
        assert path.read_bytes() == (tmp_path / "c" / path.relative_to(tmp_path / "b")).read_bytes()


def test_what_makes_no_tiles(tmp_path: Path) -> None:
    surface = hills()
    feet = replace(surface, crs="EPSG:25832+6360")
    wall = liftmesh.triangulate(surface.vertices[:, [0, 2, 1]], plane="xz")
    for each, options, cause in (
        (replace(surface, crs=None), {}, "states no coordinate system"),
        (feet, {}, "heights are in US survey foot, but tiles in metres"),
        (wall, {}, "over x and y"),
        ("a.ply", {}, "surface is 'a.ply': give a Surface"),
        (surface, {"max_error": 0}, "max_error is 0"),
        (surface, {"zoom": 23}, "zoom is 23: give a whole number from 0 to 22"),
        (surface, {"zoom": 21}, "tiles in level 21: give a larger max_error, or a smaller zoom"),
        (surface, {"progress": 3}, "progress is 3"),
        (surface, {"folder": 3}, "folder is a int"),
    ):
        with pytest.raises(InputError, match=cause):
            write_quantized_mesh(each, **{"folder": tmp_path / "out", "max_error": 1, **options})
    assert [*tmp_path.iterdir()] == []
