"""Formats of liftmesh in meshio."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import meshio
import numpy as np
import pytest

import liftmesh
from liftmesh.plugins.meshio import register, unregister

ROWS = np.random.default_rng(7).random((40, 3)) * 1e6


@pytest.fixture(autouse=True)
def registered() -> Iterator[None]:
    before = {**meshio._helpers.reader_map}
    register()
    register()
    yield
    unregister()
    unregister()
    assert meshio._helpers.reader_map == before


@pytest.mark.parametrize(("name", "suffix"), [("liftmesh-ply", "ply"), ("landxml", "xml")])
def test_there_and_back(name: str, suffix: str, tmp_path: Path) -> None:
    colors = np.arange(120, dtype=np.uint8).reshape(40, 3)
    cloud = liftmesh.Cloud(ROWS, colors=colors, attributes={"intensity": ROWS[:, 0] / 3})
    surface = liftmesh.triangulate(cloud)
    path, other = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    surface.save(path)
    mesh = meshio.read(path, file_format=name)
    assert np.array_equal(mesh.points, ROWS)
    assert np.array_equal(mesh.cells_dict["triangle"], surface.faces)
    if name == "liftmesh-ply":
        assert np.array_equal(mesh.point_data["green"], colors[:, 1])
        assert np.array_equal(mesh.point_data["intensity"], ROWS[:, 0] / 3)
    meshio.write(other, mesh, file_format=name)
    again = meshio.read(other, file_format=name)
    assert np.array_equal(again.points, mesh.points)
    assert np.array_equal(again.cells_dict["triangle"], mesh.cells_dict["triangle"])
    assert again.point_data.keys() == mesh.point_data.keys()


def test_lines_and_plane_points(tmp_path: Path) -> None:
    mesh = meshio.Mesh(ROWS[:4, :2], [("triangle", [[0, 1, 2]]), ("line", [[0, 1], [1, 2]])])
    mesh.write(tmp_path / "a.ply", file_format="liftmesh-ply")
    again = meshio.read(tmp_path / "a.ply", file_format="liftmesh-ply")
    assert again.cells_dict["line"].tolist() == [[0, 1], [1, 2]]
    assert (again.points[:, 2] == 0).all()


def test_other_cells(tmp_path: Path) -> None:
    mesh = meshio.Mesh(ROWS[:4], [("quad", [[0, 1, 2, 3]]), ("tetra", [[0, 1, 2, 3]] * 2)])
    with pytest.raises(liftmesh.InputError, match="a mesh of 1 quad and 2 tetras cannot be"):
        mesh.write(tmp_path / "a.ply", file_format="liftmesh-ply")
    assert not (tmp_path / "a.ply").exists()
    (tmp_path / "b.xml").write_text("<a/>")
    with pytest.raises(liftmesh.FormatError, match=r"b\.xml"):
        meshio.read(tmp_path / "b.xml", file_format="landxml")
