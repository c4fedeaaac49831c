"""Clouds that are no height field are told, on any scale, and terrain is not."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
from commands import liftmesh as run

import liftmesh
from liftmesh.terrain.height_field import folded_share

DATA = Path(__file__).parents[2] / "data"
MAKE = trimesh.creation


def sampled(mesh: trimesh.Trimesh, count: int = 3_000) -> np.ndarray:
    return np.asarray(trimesh.sample.sample_surface(mesh, count, seed=1)[0])


def walls() -> np.ndarray:
    points = sampled(MAKE.box([10, 8, 6]), 6_000)
    return points[points[:, 2] > -2.99]  # without a floor


CLOSED = {
    "sphere": lambda: sampled(MAKE.icosphere(4)),
    "vertices of a sphere": lambda: MAKE.icosphere(4).vertices,
    "torus": lambda: sampled(MAKE.torus(3, 1)),
    "capsule": lambda: sampled(MAKE.capsule(3, 1)),
    "tube": lambda: sampled(MAKE.annulus(1, 2, 3)),
    "cone": lambda: sampled(MAKE.cone(1, 2)),
    "building": walls,
    "room": lambda: sampled(MAKE.box([30, 20, 3]), 20_000),
}


def terrain(kind: str) -> np.ndarray:
    rng = np.random.default_rng(7)
    x, y = rng.random((2, 20_000)) * 200
    ground = np.sin(x / 20) * 9 + np.cos(y / 30) * 9
    on_top = {
        "ground": 0.0,
        "trees": np.where(rng.random(20_000) < 0.7, rng.uniform(3, 18, 20_000), 0),
        "roofs": np.where((x % 20 < 12) & (y % 20 < 12), 8.0, 0),
        "noise": rng.normal(0, 0.02, 20_000),
    }[kind]
    return np.column_stack([x, y, ground * (kind != "noise") + on_top])


@pytest.mark.parametrize("kind", CLOSED)
def test_closed_shapes_are_told(kind: str) -> None:
    points = CLOSED[kind]()
    with pytest.warns(liftmesh.DataWarning, match=r"no height field: at \d+ % of .* rows"):
        liftmesh.triangulate(points)
    scaled = folded_share(points[:, :2] * 2.0**300, points[:, 2] * 2.0**300)
    assert scaled[0] > 0.5
    other = np.random.default_rng(1).permutation(len(points))
    assert folded_share(points[other, :2], points[other, 2]) == folded_share(
        points[:, :2], points[:, 2]
    )


@pytest.mark.parametrize("scale", [1.0, 2.0**900, 2.0**-1000])
def test_thin_closed_meshes_are_told_by_their_faces(scale: float) -> None:
    plate, ball = MAKE.box([10, 8, 0.01]), MAKE.icosphere(3)
    for mesh, times in ((plate, "2"), (ball, r"1\.[89]\d?|2")):
        points = np.asarray(mesh.vertices) * (scale, scale, 1)
        faces = np.where(np.arange(len(mesh.faces))[:, None] % 2, mesh.faces, mesh.faces[:, ::-1])
        cloud = liftmesh.Cloud(points, faces=faces)
        with pytest.warns(liftmesh.DataWarning, match=f"its faces have ({times}) times the area"):
            liftmesh.triangulate(cloud, on_duplicate="highest")


def test_meshes_of_height_fields_are_not() -> None:
    surface = liftmesh.triangulate(terrain("roofs"))
    twice = np.concatenate([surface.faces, surface.faces[:5_000]])
    wrong = np.array([[0, 1, len(surface.vertices)]])
    rows = surface.vertices.copy()
    rows[:9] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for faces in (surface.faces, twice, wrong, wrong[:0]):
            liftmesh.triangulate(liftmesh.Cloud(surface.vertices, faces=faces))
        liftmesh.triangulate(liftmesh.Cloud(rows, faces=surface.faces), nonfinite="skip")


@pytest.mark.parametrize("kind", ["ground", "trees", "roofs", "noise"])
def test_terrain_is_not(kind: str) -> None:
    points = terrain(kind)
    degrees = points * (1e-5, 1e-5, 1)
    volume = np.random.default_rng(2).random((5_000, 3))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for each in (points, degrees, volume, volume * (1, 1, 1e5)):
            liftmesh.triangulate(each)


def test_a_plot_of_trees_is_and_its_ground_is_not() -> None:
    rng = np.random.default_rng(3)
    x, y = rng.random((2, 6_000)) * 24
    crown = 22 - 0.3 * ((x % 6 - 3) ** 2 + (y % 6 - 3) ** 2)
    is_ground = rng.random(6_000) < 0.4
    z = np.where(is_ground, 0, crown) + rng.normal(0, 0.05, 6_000)
    plot = np.column_stack([x, y, z])
    with pytest.warns(liftmesh.DataWarning, match="or of a few trees"):
        liftmesh.triangulate(plot)
    assert folded_share(plot[is_ground, :2], z[is_ground])[0] == 0


def test_files_of_the_repository_are_not() -> None:
    for name in ("jacksboro.ply", "hill.csv", "quad.xyz"):
        cloud = liftmesh.read(DATA / name)
        assert folded_share(cloud.points[:, :2], cloud.points[:, 2])[0] == 0


def test_few_rows_and_odd_numbers_are_not_judged() -> None:
    sphere = sampled(MAKE.icosphere(3), 900)
    assert folded_share(sphere[:, :2], sphere[:, 2]) == (0.0, 0)
    line = np.column_stack([np.arange(2_000.0), np.zeros(2_000)])
    assert folded_share(line, line[:, 0])[0] == 0
    holed = np.full(2_000, np.nan)
    assert folded_share(line, holed) == (0.0, 0)
    large = np.random.default_rng(0).uniform(-1, 1, (2_000, 3)) * 1.7e308
    assert folded_share(large[:, :2], large[:, 2])[0] == 0
    same = np.random.default_rng(0).integers(0, 9, (5_000, 2)).astype(float)
    assert folded_share(same, np.zeros(5_000))[0] == 0


def test_another_plane_or_degrees() -> None:
    points = terrain("ground")
    turned = np.column_stack([points[:, 0], -points[:, 2], points[:, 1]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        liftmesh.triangulate(turned, plane="xz")
    sphere = CLOSED["sphere"]()
    with pytest.warns(liftmesh.DataWarning) as told:
        liftmesh.triangulate(sphere, crs="EPSG:4326")
    assert not any("height field" in str(each.message) for each in told)


def test_the_command_says_it(tmp_path: Path) -> None:
    np.save(tmp_path / "sphere.npy", CLOSED["sphere"]())
    done = run("triangulate", "sphere.npy", "out.ply", cwd=tmp_path)
    assert done.returncode == 0
    assert "note: the cloud is no height field: at " in done.stderr
    assert "or of a few trees." in done.stderr
    assert "as the ground, give another plane, or use a program for closed" in done.stderr
