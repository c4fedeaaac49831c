"""trimesh, Open3D and meshio open the files and see the same numbers."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import open3d as o3d
import pytest
import trimesh
from file_samples import AWKWARD, COLORS, FACES, NORMALS, assert_same_bits, full_mesh

import liftmesh
from liftmesh import Cloud

# Normals of unit length, and coordinates whose cross products trimesh can form without overflow.
POINTS = np.where(np.abs(AWKWARD) > 1e9, -123456.789012345, AWKWARD)
MESH = Cloud(
    POINTS,
    colors=COLORS,
    normals=NORMALS / np.linalg.norm(NORMALS, axis=1)[:, None],
    attributes={
        "intensity": np.array([0, 1, 65535, 7, 8], dtype=np.uint16),
        "class": np.array([2, 6, 255, 0, 1], dtype=np.uint8),
        "offset": np.array([-1, 2**31 - 1, 0, 1, 2], dtype=np.int32),
        "narrow": np.array([-5, 5, 0, 1, 2], dtype=np.int16),
        "height": np.array([0.1, -0.0, 1e300, 0.5, 3.5]),
        "weight": np.array([0.1, 0.2, 1e30, 0.5, 3.5], dtype=np.float32),
    },
    faces=FACES,
)


@pytest.fixture(params=["binary", "ascii"])
def ply(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    liftmesh.write(tmp_path / "mesh.ply", MESH, encoding=request.param)
    return tmp_path / "mesh.ply"


@pytest.fixture
def obj(tmp_path: Path) -> Path:
    liftmesh.write(tmp_path / "mesh.obj", MESH)
    return tmp_path / "mesh.obj"


def test_ply_in_trimesh(ply: Path) -> None:
    mesh = trimesh.load_mesh(ply, process=False)
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    np.testing.assert_array_equal(mesh.faces, FACES)
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], COLORS)
    raw = mesh.metadata["_ply_raw"]["vertex"]["data"]
    for key, values in MESH.attributes.items():
        np.testing.assert_array_equal(np.ravel(raw[key]), values)


def test_ply_in_open3d(ply: Path) -> None:
    mesh = o3d.io.read_triangle_mesh(str(ply))
    np.testing.assert_array_equal(np.asarray(mesh.vertices), POINTS)
    np.testing.assert_array_equal(np.asarray(mesh.triangles), FACES)
    np.testing.assert_array_equal(np.asarray(mesh.vertex_colors), COLORS / 255)
    np.testing.assert_array_equal(np.asarray(mesh.vertex_normals), MESH.normals)


def test_ply_in_open3d_tensors(ply: Path) -> None:
    points = o3d.t.io.read_point_cloud(str(ply)).point
    np.testing.assert_array_equal(points["positions"].numpy(), POINTS)
    np.testing.assert_array_equal(points["colors"].numpy(), COLORS)
    for key, values in MESH.attributes.items():
        np.testing.assert_array_equal(points[key].numpy()[:, 0], values)


def test_ply_in_meshio(ply: Path) -> None:
    mesh = meshio.read(ply)
    np.testing.assert_array_equal(mesh.points, POINTS)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], FACES)
    for key, values in MESH.attributes.items():
        np.testing.assert_array_equal(mesh.point_data[key], values)
    for channel, key in enumerate(("red", "green", "blue")):
        np.testing.assert_array_equal(mesh.point_data[key], COLORS[:, channel])


def test_obj_in_trimesh(obj: Path) -> None:
    mesh = trimesh.load_mesh(obj, process=False, maintain_order=True)
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    np.testing.assert_array_equal(mesh.faces, FACES)
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], COLORS)


def test_obj_in_open3d(obj: Path) -> None:
    # Open3D itself reads OBJ in single precision.
    mesh = o3d.io.read_triangle_mesh(str(obj))
    np.testing.assert_array_equal(np.asarray(mesh.vertices), POINTS.astype(np.float32))
    np.testing.assert_array_equal(np.asarray(mesh.triangles), FACES)
    colors = (COLORS / 255).astype(np.float32)
    np.testing.assert_array_equal(np.asarray(mesh.vertex_colors), colors)


def test_obj_in_meshio(obj: Path) -> None:
    mesh = meshio.read(obj)
    np.testing.assert_array_equal(mesh.points[:, :3], POINTS)
    np.testing.assert_array_equal(mesh.cells_dict["triangle"], FACES)
    np.testing.assert_array_equal(mesh.point_data["obj:vn"], MESH.normals)


@pytest.mark.parametrize("suffix", ["off", "stl", "glb"])
def test_other_formats_in_open3d(tmp_path: Path, suffix: str) -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0.5], [0, 1, 0.25], [1, 1, 2]])
    shape = Cloud(points, faces=np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32))
    options = {"up": "z"} if suffix == "glb" else {}
    liftmesh.write(tmp_path / f"mesh.{suffix}", shape, **options)
    mesh = o3d.io.read_triangle_mesh(str(tmp_path / f"mesh.{suffix}"))
    triangles = np.asarray(mesh.vertices)[np.asarray(mesh.triangles)]
    np.testing.assert_array_equal(triangles, points[shape.faces])


def test_off_in_trimesh(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "mesh.off", full_mesh())
    mesh = trimesh.load_mesh(tmp_path / "mesh.off", process=False)
    np.testing.assert_array_equal(mesh.vertices, AWKWARD)
    np.testing.assert_array_equal(mesh.faces, FACES)


@pytest.mark.parametrize("encoding", ["binary", "ascii"])
def test_ply_of_trimesh_and_meshio_and_open3d(tmp_path: Path, encoding: str) -> None:
    # Few digits: that is all Open3D writes as text, and trimesh as single precision.
    simple = Cloud(np.round(POINTS) % 1000, faces=FACES)
    trimesh.Trimesh(simple.points, FACES, process=False).export(
        tmp_path / "trimesh.ply", encoding=encoding, vertex_normal=False
    )
    meshio.Mesh(simple.points, [("triangle", FACES)]).write(
        tmp_path / "meshio.ply", binary=encoding == "binary"
    )
    theirs = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(simple.points), o3d.utility.Vector3iVector(FACES)
    )
    o3d.io.write_triangle_mesh(
        str(tmp_path / "open3d.ply"), theirs, write_ascii=encoding == "ascii"
    )
    for name in ("trimesh", "meshio", "open3d"):
        found = liftmesh.read(tmp_path / f"{name}.ply")
        np.testing.assert_array_equal(found.points, simple.points)
        assert_same_bits(found.faces, FACES)


def test_obj_of_trimesh_and_meshio_and_open3d(tmp_path: Path) -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0.5], [0, 1, 0.25], [1, 1, 2], [3, 4, 5]])
    mesh = trimesh.Trimesh(points, FACES, process=False, vertex_colors=COLORS)
    mesh.export(tmp_path / "trimesh.obj", include_color=True)
    meshio.Mesh(points, [("triangle", FACES)]).write(tmp_path / "meshio.obj")
    theirs = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(points), o3d.utility.Vector3iVector(FACES)
    )
    theirs.vertex_colors = o3d.utility.Vector3dVector(COLORS / 255)
    theirs.vertex_normals = o3d.utility.Vector3dVector(np.round(NORMALS))
    o3d.io.write_triangle_mesh(str(tmp_path / "open3d.obj"), theirs)
    for name in ("trimesh", "meshio", "open3d"):
        found = liftmesh.read(tmp_path / f"{name}.obj")
        np.testing.assert_array_equal(found.points, points)
        np.testing.assert_array_equal(found.faces, FACES)
        if name != "meshio":
            np.testing.assert_array_equal(found.colors, COLORS)
    found = liftmesh.read(tmp_path / "open3d.obj")
    np.testing.assert_array_equal(found.normals, np.round(NORMALS))
