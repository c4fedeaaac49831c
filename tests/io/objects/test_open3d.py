"""Open3D objects in and out, legacy and tensor: every coordinate bit for bit, named values too."""

from __future__ import annotations

import io
import os
import subprocess
import sys

import hypothesis.extra.numpy as hnp
import numpy as np
import open3d as o3d
import pytest
import trimesh
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh.base.cloud import Cloud
from liftmesh.errors import FormatError, InputError, UnsupportedTypeError
from liftmesh.io.objects.open3d import to_legacy, to_tensor
from liftmesh.io.registry import as_cloud

POINTS = np.array([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0], [1.0, 1.0, -0.0]])
FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
FLOATS = np.array([[1.0, 0.0, 0.0], [0.0, 0.2, 0.0], [0.1, 0.2, 0.3], [0.7, 0.8, 0.9]])
BYTES = np.array([[255, 0, 0], [0, 51, 0], [1, 2, 3], [7, 8, 9]], dtype=np.uint8)
NORMALS = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.1, 0.2, 0.3]])

any_rows = hnp.arrays(
    np.float64,
    st.tuples(st.integers(1, 12), st.just(3)),
    elements=st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True),
)


def legacy_cloud(points):
    return o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))


def tensor_cloud(**named):
    cloud = o3d.t.geometry.PointCloud()
    for name, values in named.items():
        cloud.point[name] = o3d.core.Tensor(values)
    return cloud


@pytest.mark.slow
@given(any_rows)
@settings(max_examples=50, deadline=None)
def test_coordinates_survive_bit_for_bit(points):
    cloud = Cloud(points, faces=np.zeros((1, 3), dtype=np.int32))
    legacy, tensor = to_legacy(cloud), to_tensor(cloud)
    assert np.asarray(legacy.vertices).tobytes() == points.tobytes()
    assert tensor.vertex["positions"].numpy().tobytes() == points.tobytes()
    for source in (legacy, tensor, legacy_cloud(points), tensor_cloud(positions=points)):
        assert as_cloud(source).points.tobytes() == points.tobytes()


def test_legacy_cloud_comes_in_with_colours_and_normals():
    source = legacy_cloud(POINTS)
    source.colors = o3d.utility.Vector3dVector(FLOATS)
    source.normals = o3d.utility.Vector3dVector(NORMALS)
    cloud = as_cloud(source)
    assert cloud.colors.tolist() == FLOATS.tolist()
    assert cloud.normals.tolist() == NORMALS.tolist()
    assert cloud.faces is None


def test_legacy_cloud_without_colours_and_normals_has_none():
    cloud = as_cloud(legacy_cloud(POINTS))
    assert cloud.colors is None
    assert cloud.normals is None


def test_legacy_rows_outlive_their_reassignment():
    source = legacy_cloud(POINTS)
    cloud = as_cloud(source)
    source.points = o3d.utility.Vector3dVector(np.full((100_000, 3), 9.0))
    assert cloud.points.tobytes() == POINTS.tobytes()


def test_tensor_cloud_comes_in_with_named_values():
    source = tensor_cloud(
        positions=POINTS,
        colors=BYTES,
        normals=NORMALS,
        intensity=np.arange(4, dtype=np.uint16)[:, None],
        scores=np.eye(4, 2),
        label=np.array([2, 2, 6, 9]),
    )
    cloud = as_cloud(source)
    assert cloud.colors.dtype == np.uint8
    assert cloud.colors.tolist() == BYTES.tolist()
    assert cloud.normals.tolist() == NORMALS.tolist()
    assert cloud.attributes["intensity"].dtype == np.uint16
    assert cloud.attributes["intensity"].tolist() == [0, 1, 2, 3]
    assert cloud.attributes["scores"].tolist() == np.eye(4, 2).tolist()
    assert cloud.attributes["label"].tolist() == [2, 2, 6, 9]


def test_tensor_positions_outlive_the_cloud():
    points = as_cloud(tensor_cloud(positions=POINTS)).points
    assert points.tobytes() == POINTS.tobytes()


def test_single_precision_positions_become_doubles_of_the_same_value():
    single = (POINTS / 3).astype(np.float32)
    points = as_cloud(tensor_cloud(positions=single)).points
    assert points.dtype == np.float64
    assert np.array_equal(points, single)


@pytest.mark.parametrize(
    "source",
    [o3d.geometry.PointCloud(), o3d.t.geometry.PointCloud(), o3d.t.geometry.TriangleMesh()],
)
def test_empty_objects_have_no_rows(source):
    assert len(as_cloud(source)) == 0


def test_a_bare_tensor_is_an_array():
    assert as_cloud(o3d.core.Tensor(POINTS)).points.tobytes() == POINTS.tobytes()


def test_attributes_of_another_length_are_refused():
    with pytest.raises(InputError, match="bad has 3 rows for 4 points"):
        as_cloud(tensor_cloud(positions=POINTS, bad=np.arange(3)))


def test_legacy_mesh_goes_out_and_comes_back():
    mesh = to_legacy(Cloud(POINTS, colors=FLOATS, normals=NORMALS, faces=FACES))
    assert isinstance(mesh, o3d.geometry.TriangleMesh)
    back = as_cloud(mesh)
    assert back.colors.tobytes() == FLOATS.tobytes()
    assert back.normals.tobytes() == NORMALS.tobytes()
    assert back.faces.dtype == np.int32
    assert back.faces.tolist() == FACES.tolist()


def test_legacy_colours_lie_between_zero_and_one():
    rgba = np.column_stack([BYTES, np.full(4, 255, dtype=np.uint8)])
    mesh = to_legacy(Cloud(POINTS, colors=rgba, faces=FACES))
    assert np.asarray(mesh.vertex_colors).tolist() == (BYTES / 255).tolist()


def test_nothing_is_made_up_on_the_way_out():
    cloud = Cloud(POINTS, faces=FACES)
    legacy, tensor = to_legacy(cloud), to_tensor(cloud)
    assert not legacy.has_vertex_colors()
    assert not legacy.has_vertex_normals()
    assert [name for name, _ in tensor.vertex.items()] == ["positions"]


def test_read_only_and_strided_arrays_go_out():
    points = np.asfortranarray(POINTS)
    points.flags.writeable = False
    faces = FACES.copy()
    faces.flags.writeable = False
    cloud = Cloud(points, normals=points, colors=BYTES[:, ::-1], faces=faces)
    for mesh in (to_legacy(cloud), to_tensor(cloud)):
        back = as_cloud(mesh)
        assert np.array_equal(back.points, POINTS)
        assert np.array_equal(back.normals, POINTS)
        assert np.array_equal(back.faces, FACES)


def test_tensor_mesh_goes_out_and_comes_back():
    attributes = {
        "intensity": np.arange(4, dtype=np.uint16),
        "label": np.array([1, 2, 3, 2**53 + 1]),
        "scores": np.eye(4, 2, dtype=np.float32),
        "half": np.array([0.1, 0.2, 0.3, 0.4], dtype=np.float16),
        "big_endian": np.array([1.5, 2.5, 3.5, np.nan], dtype=">f8"),
        "ground": np.array([True, False, True, True]),
    }
    cloud = Cloud(POINTS, colors=FLOATS, normals=NORMALS, attributes=attributes, faces=FACES)
    mesh = to_tensor(cloud)
    assert mesh.vertex["positions"].dtype == o3d.core.float64
    assert mesh.triangle["indices"].dtype == o3d.core.int64
    assert tuple(mesh.vertex["intensity"].shape) == (4, 1)
    back = as_cloud(mesh)
    assert back.faces.tolist() == FACES.tolist()
    assert back.colors.tobytes() == FLOATS.tobytes()
    assert back.normals.tobytes() == NORMALS.tobytes()
    assert set(back.attributes) == set(attributes)
    for name, values in attributes.items():
        assert np.array_equal(back.attributes[name], values, equal_nan=values.dtype.kind == "f")
    assert back.attributes["intensity"].dtype == np.uint16


def test_tensor_colours_survive_the_way_to_a_legacy_mesh():
    mesh = to_tensor(Cloud(POINTS, colors=BYTES, faces=FACES))
    assert mesh.vertex["colors"].dtype == o3d.core.float32
    legacy = np.asarray(mesh.to_legacy().vertex_colors)
    assert np.rint(legacy * 255).astype(np.uint8).tolist() == BYTES.tolist()


FAR = POINTS + np.array([450_000, 5_200_000, 100])
ORIGIN = (450_000, 5_200_000, 0)


@pytest.mark.parametrize("dtype", ["float32", "Float32", np.float32, o3d.core.float32])
def test_single_precision_for_ray_casting(dtype):
    surface = liftmesh.triangulate(FAR, normals=NORMALS)
    mesh = surface.to_open3d_t(dtype=dtype, origin=ORIGIN)
    assert mesh.vertex["positions"].dtype == o3d.core.float32
    assert mesh.vertex["normals"].dtype == o3d.core.float32
    assert np.array_equal(mesh.vertex["positions"].numpy() + np.array(ORIGIN), FAR)
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh)
    rays = o3d.core.Tensor([[0.25, 0.5, 1000, 0, 0, -1]], dtype=o3d.core.float32)
    met = int(scene.cast_rays(rays)["primitive_ids"].numpy()[0])
    assert met == surface.triangulation.find_simplex([ORIGIN[0] + 0.25, ORIGIN[1] + 0.5])


def test_single_precision_that_is_too_coarse_names_the_origin():
    surface = liftmesh.triangulate(FAR + 0.1)
    with pytest.raises(InputError, match=r"give origin=\(450000.0, 5200000.0, 0.0\), which is"):
        surface.to_open3d_t(dtype="float32")
    with pytest.raises(InputError, match=r"give origin=\(450000.0, 5200000.0, 0.0\), which is"):
        surface.to_open3d_t(dtype="float32", origin=(1, 2, 3))
    wide = liftmesh.triangulate(POINTS * 1e300)
    with pytest.raises(InputError, match="whatever their origin: give dtype='float64'"):
        wide.to_open3d_t(dtype="float32")


@pytest.mark.parametrize("dtype", ["float64", None, float, o3d.core.Dtype.Float64])
def test_double_precision_with_and_without_an_origin(dtype):
    surface = liftmesh.triangulate(FAR)
    mesh = surface.to_open3d_t(dtype=dtype)
    assert mesh.vertex["positions"].numpy().tobytes() == FAR.tobytes()
    moved = surface.to_open3d_t(dtype=dtype, origin=list(ORIGIN)).vertex["positions"].numpy()
    assert np.array_equal(moved, FAR - np.array(ORIGIN))


def test_rows_that_are_not_finite_go_out_in_single_precision():
    surface = liftmesh.triangulate(np.vstack([POINTS, [[np.nan, np.inf, 0]]]), nonfinite="skip")
    positions = surface.to_open3d_t(dtype="float32").vertex["positions"].numpy()
    assert np.array_equal(positions[4], [np.nan, np.inf, 0], equal_nan=True)


@pytest.mark.parametrize("dtype", ["float16", int, 5, "a word", object(), o3d.core.int32])
def test_other_precisions_are_refused(dtype):
    with pytest.raises(InputError, match=r"dtype is .*: give 'float32' or 'float64'"):
        liftmesh.triangulate(POINTS).to_open3d_t(dtype=dtype)


@pytest.mark.parametrize("origin", [5, (1, 2), (1, 2, np.nan), "abc", (1, 2, 3j), (1, 2, 10**400)])
def test_origins_are_three_finite_numbers(origin):
    with pytest.raises(InputError, match="give three finite numbers x, y, z"):
        liftmesh.triangulate(POINTS).to_open3d_t(origin=origin)


@pytest.mark.parametrize(
    "source",
    [
        legacy_cloud(POINTS),
        tensor_cloud(positions=POINTS),
        to_legacy(Cloud(POINTS, faces=FACES)),
        to_tensor(Cloud(POINTS, faces=FACES)),
        o3d.core.Tensor(POINTS),
        o3d.core.Tensor(POINTS[:, :2].copy()),
        o3d.core.Tensor(POINTS.astype(np.float32)),
        trimesh.PointCloud(POINTS),
        Cloud(POINTS),
    ],
    ids=lambda source: type(source).__name__,
)
def test_planar_functions_take_clouds_meshes_and_tensors(source):
    expected = liftmesh.delaunay(POINTS).simplices
    assert np.array_equal(liftmesh.delaunay(source).simplices, expected)
    assert np.array_equal(liftmesh.lift(source), liftmesh.lift(POINTS))
    assert np.array_equal(liftmesh.project(source), POINTS[:, :2])
    assert len(liftmesh.lower_hull(source).faces)


def test_planar_functions_take_no_paths_and_name_what_is_no_cloud():
    with pytest.raises(UnsupportedTypeError, match=r"is a path, not a cloud: liftmesh\.read it"):
        liftmesh.delaunay("cloud.ply")
    with pytest.raises(InputError, match="points are a LineSet: give an array with one row per"):
        liftmesh.delaunay(o3d.geometry.LineSet())


def test_alpha_that_says_something_comes_back_from_beside_the_colours():
    opaque = np.column_stack([BYTES, np.full(4, 255, dtype=np.uint8)])
    clear = np.column_stack([BYTES, np.array([255, 255, 51, 0], dtype=np.uint8)])
    assert "alpha" not in to_tensor(Cloud(POINTS, colors=opaque, faces=FACES)).vertex
    mesh = to_tensor(Cloud(POINTS, colors=clear, faces=FACES))
    assert np.rint(mesh.vertex["alpha"].numpy() * 255).ravel().tolist() == [255, 255, 51, 0]
    back = as_cloud(mesh)
    assert np.array_equal(np.rint(back.colors * 255), clear)
    assert not back.attributes


@pytest.mark.parametrize(
    "alpha", [np.full((4, 1), 2, np.float32), np.ones((4, 1)), np.ones((4, 2), np.float32)]
)
def test_other_values_called_alpha_stay_named_values(alpha):
    mesh = to_tensor(Cloud(POINTS, colors=BYTES, faces=FACES))
    mesh.vertex["alpha"] = o3d.core.Tensor(alpha)
    back = as_cloud(mesh)
    assert back.colors.shape == (4, 3)
    assert np.array_equal(back.attributes["alpha"], np.squeeze(alpha))


def test_fields_of_records_become_tensors():
    records = np.zeros(4, [("x", "f8"), ("y", "f8"), ("z", "f8"), ("c", "u1"), ("time", "f8")])
    for name, values in zip("xyz", POINTS.T, strict=True):
        records[name] = values
    records["time"] = [0.5, 1, 2, 3]
    mesh = liftmesh.triangulate(records).to_open3d_t()
    assert mesh.vertex["time"].numpy().ravel().tolist() == [0.5, 1, 2, 3]


@pytest.mark.parametrize("name", ["positions", "normals", "colors", "alpha"])
def test_names_that_tensors_keep_for_themselves(name):
    cloud = Cloud(POINTS, attributes={name: np.arange(4.0)}, faces=FACES)
    with pytest.raises(InputError, match=f"named '{name}', .*: rename it"):
        to_tensor(cloud)


def test_half_a_character_is_no_name_of_a_tensor():
    cloud = Cloud(POINTS, attributes={"\ud800": np.arange(4.0)}, faces=FACES)
    with pytest.raises(InputError, match=r"named '\\ud800', half a character: rename it"):
        to_tensor(cloud)


def test_types_unknown_to_tensors_name_the_attribute():
    cloud = Cloud(POINTS, attributes={"name": np.array(list("abcd"))}, faces=FACES)
    with pytest.raises(InputError, match=r"attribute 'name' has the type <U1"):
        to_tensor(cloud)


def test_open3d_writes_what_goes_out(tmp_path):
    path = str(tmp_path / "mesh.ply")
    cloud = Cloud(POINTS, colors=BYTES, attributes={"label": np.arange(4)}, faces=FACES)
    assert o3d.t.io.write_triangle_mesh(path, to_tensor(cloud))
    read = o3d.io.read_triangle_mesh(path)
    assert np.asarray(read.vertices).tolist() == POINTS.tolist()
    assert np.rint(np.asarray(read.vertex_colors) * 255).tolist() == BYTES.tolist()


@pytest.mark.parametrize(
    ("cause", "remedy"),
    [
        ("libusb-1.0.so.0: cannot open shared object file", "libusb-1.0-0"),
        ("No module named 'open3d.core'", r"pip install 'liftmesh[open3d]'"),
    ],
)
def test_an_open3d_that_cannot_be_loaded_is_explained(tmp_path, cause, remedy):
    package = tmp_path / "open3d"
    package.mkdir()
    (package / "__init__.py").write_text(f"raise ImportError({cause!r})\n")
    script = (
        "import numpy as np\n"
        "from liftmesh.io.objects.open3d import to_tensor\n"
        "from liftmesh import Cloud, MissingDependencyError\n"
        "try:\n"
        "    to_tensor(Cloud(np.zeros((3, 3))))\n"
        "except MissingDependencyError as error:\n"
        "    print(error)\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "open3d" in run.stdout
    assert cause in run.stdout
    assert remedy in run.stdout


def test_what_clouds_do_not_hold_of_meshes_is_named() -> None:
    mesh = o3d.t.geometry.TriangleMesh.create_box()
    mesh.compute_triangle_normals()  # which follow from the triangles
    mesh.triangle["label"] = o3d.core.Tensor(np.zeros((12, 1)))
    assert liftmesh.write(io.BytesIO(), mesh, format="ply").dropped == ("label of triangles",)
    sphere = o3d.geometry.TriangleMesh.create_sphere(resolution=4, create_uv_map=True)
    assert liftmesh.as_cloud(sphere).metadata["not_read"] == ("texture coordinates",)


def test_triangles_beyond_32_bits_are_refused() -> None:
    mesh = o3d.t.geometry.TriangleMesh.create_box()
    mesh.triangle["indices"] = o3d.core.Tensor(np.array([[0, 1, 2**32 + 2]]))
    with pytest.raises(FormatError, match="face 0 refers to vertex 4294967298"):
        liftmesh.write(io.BytesIO(), mesh, format="ply")
