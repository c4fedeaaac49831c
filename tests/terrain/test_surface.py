"""A surface on its way to other libraries and to files: all of it, bit for bit."""

from __future__ import annotations

import io

import hypothesis.extra.numpy as hnp
import numpy as np
import open3d as o3d
import pytest
import trimesh
from hypothesis import assume, given, settings, strategies as st
from matplotlib.tri import LinearTriInterpolator

import liftmesh
from liftmesh.errors import DegenerateInputError, FormatError

finite_rows = hnp.arrays(
    np.float64,
    st.tuples(st.integers(3, 20), st.just(3)),
    elements=st.floats(allow_nan=False, allow_infinity=False) | st.integers(-2, 2),
)


@pytest.fixture
def surface():
    """Coloured terrain with a duplicate, an overhang and a row that is not finite."""
    rng = np.random.default_rng(1)
    points = rng.random((200, 3)) * (500, 400, 30) + (4.5e5, 5.2e6, 100)
    points = np.vstack([points, points[5], points[6] + (0, 0, 3), [[np.nan, 1, 2]]])
    cloud = liftmesh.Cloud(
        points,
        colors=rng.integers(0, 256, (203, 3), dtype=np.uint8),
        normals=rng.normal(size=(203, 3)),
        attributes={"intensity": np.arange(203, dtype=np.uint16)},
        metadata={"crs": "EPSG:32614"},
    )
    return liftmesh.triangulate(cloud, on_duplicate="highest", nonfinite="skip")


@given(finite_rows)
@settings(deadline=None, max_examples=60)
def test_every_coordinate_goes_out_bit_for_bit(points):
    try:
        surface = liftmesh.triangulate(points, on_duplicate="last")
    except DegenerateInputError:
        assume(False)
    for mesh in (surface.to_trimesh(), surface.to_open3d(), surface.to_open3d_t()):
        back = liftmesh.as_cloud(mesh)
        assert back.points.tobytes() == points.tobytes()
        assert np.array_equal(back.faces, surface.faces)


def test_a_cloud_holds_the_same_arrays(surface):
    cloud = surface.to_cloud()
    assert cloud.points is surface.vertices
    assert cloud.faces is surface.faces
    assert cloud.colors is surface.colors
    assert cloud.normals is surface.normals
    assert dict(cloud.attributes) == dict(surface.attributes)
    assert cloud.metadata["crs"] == "EPSG:32614"


def test_trimesh_gets_everything(surface):
    mesh = surface.to_trimesh()
    assert type(mesh) is trimesh.Trimesh
    assert mesh.vertices.tobytes() == surface.vertices.tobytes()
    assert np.array_equal(mesh.faces, surface.faces)
    assert np.array_equal(mesh.visual.vertex_colors[:, :3], surface.colors)
    assert np.array_equal(mesh.vertex_normals, surface.normals)
    assert np.array_equal(mesh.vertex_attributes["intensity"], np.arange(203))
    assert mesh.metadata["crs"] == "EPSG:32614"


def test_faces_look_up_in_trimesh(surface):
    assert (surface.to_trimesh().face_normals[:, 2] > 0).all()


def test_legacy_open3d_gets_colours_and_normals(surface):
    mesh = surface.to_open3d()
    assert type(mesh) is o3d.geometry.TriangleMesh
    assert np.asarray(mesh.vertices).tobytes() == surface.vertices.tobytes()
    assert np.array_equal(mesh.triangles, surface.faces)
    assert np.array_equal(mesh.vertex_colors, surface.colors / 255)
    assert np.array_equal(mesh.vertex_normals, surface.normals)
    mesh.compute_triangle_normals()
    assert (np.asarray(mesh.triangle_normals)[:, 2] > 0).all()


def test_tensor_open3d_gets_named_values_too(surface):
    mesh = surface.to_open3d_t()
    assert type(mesh) is o3d.t.geometry.TriangleMesh
    assert mesh.vertex["positions"].dtype == o3d.core.float64
    assert mesh.triangle["indices"].dtype == o3d.core.int64
    back = liftmesh.as_cloud(mesh)
    assert back.points.tobytes() == surface.vertices.tobytes()
    assert np.array_equal(np.rint(back.colors * 255), surface.colors)
    assert np.array_equal(back.normals, surface.normals)
    assert np.array_equal(back.attributes["intensity"], np.arange(203))


def test_matplotlib_interpolates_the_surface(surface):
    triangulation = surface.to_matplotlib()
    assert np.array_equal(triangulation.triangles, surface.faces)
    assert np.array_equal(triangulation.x, surface.vertices[:, 0], equal_nan=True)
    centres = surface.vertices[surface.faces].mean(axis=1)
    interpolate = LinearTriInterpolator(triangulation, surface.vertices[:, 2])
    assert np.allclose(interpolate(centres[:, 0], centres[:, 1]), centres[:, 2], atol=1e-6)


def test_matplotlib_sees_the_plane_of_the_surface():
    wall = np.random.default_rng(2).random((50, 3)) * (0.1, 9, 4)
    surface = liftmesh.triangulate(wall, plane=(1, 0, 0))
    triangulation = surface.to_matplotlib()
    planar = surface.frame.planar(wall)
    assert np.array_equal(np.column_stack([triangulation.x, triangulation.y]), planar)


@pytest.mark.parametrize("name", ["mesh.ply", "mesh.npz"])
def test_files_keep_everything(surface, tmp_path, name):
    path = tmp_path / name
    surface.save(path)
    back = liftmesh.read(path)
    assert back.points.tobytes() == surface.vertices.tobytes()
    assert np.array_equal(back.faces, surface.faces)
    assert np.array_equal(back.colors, surface.colors)
    assert np.array_equal(back.normals, surface.normals)
    assert np.array_equal(back.attributes["intensity"], np.arange(203))


def test_obj_files_keep_coordinates_and_faces(surface, tmp_path):
    whole = liftmesh.triangulate(surface.vertices[:200])
    whole.save(tmp_path / "mesh.obj")
    back = liftmesh.read(tmp_path / "mesh.obj")
    assert back.points.tobytes() == whole.vertices.tobytes()
    assert np.array_equal(back.faces, whole.faces)


def test_saving_to_a_buffer_writes_the_bytes_of_the_file(surface, tmp_path):
    buffer = io.BytesIO()
    surface.save(buffer, format="ply")
    surface.save(tmp_path / "mesh.ply")
    assert buffer.getvalue() == (tmp_path / "mesh.ply").read_bytes()


def test_saving_returns_what_writing_returns(surface, tmp_path):
    assert surface.save(tmp_path / "a.ply") == liftmesh.write(tmp_path / "a.ply", surface)


def test_unknown_formats_are_refused(surface, tmp_path):
    with pytest.raises(FormatError, match="nonsense"):
        surface.save(tmp_path / "mesh.nonsense")
    assert not list(tmp_path.iterdir())


def test_it_is_shown_in_one_line(surface):
    assert repr(surface) == f"<Surface of {len(surface.faces)} triangles over 203 vertices>"


def test_it_cannot_be_changed(surface):
    with pytest.raises(AttributeError):
        surface.faces = None
    with pytest.raises(AttributeError):
        surface.report.n_used = 0
    with pytest.raises(TypeError):
        surface.report.seconds["read"] = 0.0
    with pytest.raises(TypeError):
        surface.attributes["intensity"] = None


def test_bounds_are_those_of_the_faces() -> None:
    points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
    surface = liftmesh.triangulate(points)
    assert surface.bounds == (0, 0, 9, 2)
    assert surface.trim(max_edge=2).bounds == (0, 0, 1, 1)


def test_a_surface_is_verified_as_its_triangulation(surface) -> None:
    certificate = surface.verify(threads=1)
    assert certificate.canonical
    assert certificate == surface.triangulation.verify() == surface.trim(max_edge=99).verify()
