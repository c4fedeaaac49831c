"""trimesh objects in and out: every coordinate bit for bit, nothing made up, nothing lost."""

from __future__ import annotations

import io

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh.base.cloud import Cloud
from liftmesh.errors import InputError
from liftmesh.io.objects.trimesh import to_mesh, transformed
from liftmesh.io.registry import as_cloud

POINTS = np.array([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0], [1.0, 1.0, -0.0]])
FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
COLORS = np.array([[255, 0, 0, 255], [0, 255, 0, 128], [0, 0, 255, 0], [1, 2, 3, 4]], np.uint8)
NORMALS = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.1, 0.2, 0.3]])

any_rows = hnp.arrays(
    np.float64,
    st.tuples(st.integers(1, 12), st.just(3)),
    elements=st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True),
)


@given(any_rows)
@settings(max_examples=50, deadline=None)
def test_coordinates_survive_bit_for_bit(points):
    faces = np.zeros((1, 3), dtype=np.int32)
    mesh = to_mesh(Cloud(points, faces=faces))
    assert np.asarray(mesh.vertices).tobytes() == points.tobytes()
    assert as_cloud(mesh).points.tobytes() == points.tobytes()
    assert as_cloud(trimesh.PointCloud(points)).points.tobytes() == points.tobytes()


def test_point_cloud_shares_its_coordinates():
    source = trimesh.PointCloud(POINTS)
    points = as_cloud(source).points
    assert type(points) is np.ndarray
    assert np.shares_memory(points, source.vertices)


def test_point_cloud_colours_and_metadata():
    cloud = as_cloud(trimesh.PointCloud(POINTS, colors=COLORS, metadata={"crs": "EPSG:32614"}))
    assert cloud.colors.dtype == np.uint8
    assert cloud.colors.tolist() == COLORS.tolist()
    assert cloud.crs == "EPSG:32614"
    assert cloud.faces is None
    assert cloud.normals is None
    assert not cloud.attributes


def test_point_cloud_without_colours_has_none():
    assert as_cloud(trimesh.PointCloud(POINTS)).colors is None


def test_empty_point_cloud():
    assert len(as_cloud(trimesh.PointCloud(None))) == 0


def test_mesh_carries_everything_in():
    source = trimesh.Trimesh(
        POINTS,
        FACES,
        vertex_colors=COLORS,
        vertex_normals=NORMALS,
        vertex_attributes={"intensity": np.arange(4.0), "flow": np.ones((4, 2))},
        process=False,
    )
    cloud = as_cloud(source)
    assert cloud.points.tobytes() == POINTS.tobytes()
    assert cloud.faces.dtype == np.int32
    assert cloud.faces.tolist() == FACES.tolist()
    assert cloud.colors.tolist() == COLORS.tolist()
    assert cloud.normals.tolist() == NORMALS.tolist()
    assert cloud.attributes["intensity"].tolist() == [0, 1, 2, 3]
    assert cloud.attributes["flow"].shape == (4, 2)


def test_mesh_without_colours_and_normals_has_none_and_stays_without():
    source = trimesh.Trimesh(POINTS, FACES, process=False)
    cloud = as_cloud(source)
    assert cloud.colors is None
    assert cloud.normals is None
    assert not source.visual.defined
    assert "vertex_normals" not in source._cache


def test_face_colours_are_no_vertex_colours():
    source = trimesh.Trimesh(POINTS, FACES, face_colors=COLORS[:2], process=False)
    assert as_cloud(source).colors is None


def test_textures_are_no_vertex_colours():
    visual = trimesh.visual.TextureVisuals(uv=np.zeros((4, 2)))
    assert as_cloud(trimesh.Trimesh(POINTS, FACES, visual=visual, process=False)).colors is None


def test_derived_classes_are_accepted():
    class Terrain(trimesh.Trimesh):
        pass

    assert len(as_cloud(Terrain(POINTS, FACES, process=False))) == 4
    assert len(as_cloud(trimesh.primitives.Box())) == 8


def test_colours_of_another_length_are_refused():
    source = trimesh.PointCloud(POINTS, colors=COLORS)
    source.vertices = POINTS[:3]
    with pytest.raises(InputError, match="colors has 4 rows for 3 points"):
        as_cloud(source)


def test_attributes_of_another_length_are_refused():
    source = trimesh.Trimesh(POINTS, FACES, vertex_attributes={"a": 7.0}, process=False)
    with pytest.raises(InputError, match="a has 1 row for 4 points"):
        as_cloud(source)


def test_everything_goes_out():
    cloud = Cloud(
        POINTS,
        colors=COLORS,
        normals=NORMALS,
        attributes={"class": np.array([2, 2, 6, 9], dtype=np.uint8)},
        faces=FACES,
        metadata={"comments": ["made by hand"]},
    )
    mesh = to_mesh(cloud)
    assert mesh.faces.tolist() == FACES.tolist()
    assert mesh.visual.kind == "vertex"
    assert mesh.visual.vertex_colors.tolist() == COLORS.tolist()
    assert mesh.vertex_normals.tolist() == NORMALS.tolist()
    assert mesh.vertex_attributes["class"].dtype == np.uint8
    assert mesh.metadata["comments"] == ["made by hand"]
    back = as_cloud(mesh)
    assert back.colors.tolist() == COLORS.tolist()
    assert back.normals.tolist() == NORMALS.tolist()
    assert back.attributes["class"].tolist() == [2, 2, 6, 9]


def test_unused_and_equal_vertices_stay():
    points = np.vstack([POINTS, POINTS, [[np.nan, 0, 0]]])
    mesh = to_mesh(Cloud(points, faces=FACES))
    assert len(mesh.vertices) == 9
    assert mesh.faces.tolist() == FACES.tolist()


def test_rgb_floats_become_opaque_bytes():
    mesh = to_mesh(Cloud(POINTS, colors=np.full((4, 3), 0.2), faces=FACES))
    assert mesh.visual.vertex_colors.tolist() == [[51, 51, 51, 255]] * 4


def test_no_colours_are_made_up_on_the_way_out():
    assert not to_mesh(Cloud(POINTS, faces=FACES)).visual.defined


def test_edits_of_the_mesh_do_not_reach_the_cloud():
    points, normals, values = POINTS.copy(), NORMALS.copy(), np.arange(4.0)
    mesh = to_mesh(Cloud(points, normals=normals, attributes={"a": values}, faces=FACES))
    mesh.vertices[:] = 9.0
    mesh.vertex_attributes["a"][:] = 9.0
    assert points.tobytes() == POINTS.tobytes()
    assert values.tolist() == [0, 1, 2, 3]
    assert normals.flags.writeable


def test_places_beyond_doubles_end_in_infinities_without_a_warning():
    cloud = Cloud(POINTS, normals=NORMALS, faces=FACES)
    huge = transformed(cloud, np.diag([1.7e308, 1.7e308, 1.7e308, 1.0]))
    assert huge.points[0].tolist() == [0.0, 0.0, np.inf]
    np.testing.assert_array_equal(huge.normals[:3], NORMALS[:3])
    flat = transformed(cloud, np.diag([1e300, 1e-5, 1e-5, 1.0]))
    assert flat.normals is None  # its determinant is beyond doubles
    for exponent in (-300, -150, 150, 160):
        sizes = np.array([1.0, 1.0, 10.0**exponent])
        normals = transformed(cloud, np.diag([*sizes, 1.0])).normals
        lengths = np.sqrt((normals**2).sum(axis=1))
        np.testing.assert_allclose(lengths, 1.0, rtol=1e-12)


def painted_box() -> trimesh.Trimesh:
    box = trimesh.creation.box()
    box.metadata = {"survey": 2024}
    box.visual.vertex_colors = np.full((8, 4), 9, dtype=np.uint8)
    box.vertex_attributes["age"] = np.arange(8)
    return box


def test_what_a_union_of_geometries_loses_is_named() -> None:
    other = trimesh.creation.icosphere(1)
    other.metadata = {}
    other.vertex_attributes["age"] = np.zeros(len(other.vertices))  # of another type
    written = liftmesh.write(io.BytesIO(), trimesh.Scene([painted_box(), other]), format="ply")
    assert sorted(written.dropped) == [
        "age of 2 of 2 geometries",
        "colors of 1 of 2 geometries",
        "metadata survey of 1 of 2 geometries",
    ]


def test_a_scene_of_one_mesh_is_that_mesh() -> None:
    box = painted_box()
    cloud, scene = liftmesh.as_cloud(box), liftmesh.as_cloud(trimesh.Scene(box))
    assert dict(scene.metadata) == dict(cloud.metadata) == {"survey": 2024}
    assert scene.colors is not None
    assert np.array_equal(scene.colors, np.full((8, 4), 9))
    assert scene.attributes["age"].tolist() == [*range(8)]
    twice = liftmesh.as_cloud(trimesh.Scene([box, box.copy()]))
    assert twice.attributes["age"].tolist() == [*range(8)] * 2


def test_what_faces_hold_is_named() -> None:
    box = trimesh.creation.box()
    box.metadata = {}
    box.visual.face_colors = np.full((12, 4), 9, dtype=np.uint8)
    box.face_attributes["label"] = np.arange(12)
    lost = ("colors of faces", "values label of faces")
    assert liftmesh.as_cloud(box).metadata["not_read"] == lost
    assert liftmesh.write(io.BytesIO(), box, format="ply").dropped == lost
    with pytest.warns(liftmesh.DataWarning, match="its faces have 2 times the area of its hull"):
        surface = liftmesh.triangulate(box)
    assert surface.save(io.BytesIO(), format="ply").dropped == lost


def test_a_scene_keeps_the_metadata_that_all_meshes_have() -> None:
    boxes = [trimesh.creation.box(), trimesh.creation.box()]
    for box, by in zip(boxes, "ab", strict=True):
        box.metadata = {"survey": 2024, "by": by, "grid": np.eye(2)}
    cloud = liftmesh.as_cloud(trimesh.Scene(boxes))
    assert cloud.metadata == {
        "survey": 2024,
        "not_read": ("metadata by of 2 of 2 geometries", "metadata grid of 2 of 2 geometries"),
    }


def test_an_empty_mesh_with_normals() -> None:
    none = np.zeros((0, 3))
    mesh = to_mesh(Cloud(none, normals=none, faces=np.zeros((0, 3), dtype=np.int32)))
    assert len(mesh.vertices) == 0


def test_an_entry_of_the_metadata_may_be_called_skipped() -> None:
    box = trimesh.creation.box()
    box.metadata = {"not_read": "no"}
    assert liftmesh.as_cloud(trimesh.Scene(box)).metadata == {"not_read": "no"}


def test_weights_of_a_point_cloud_are_named_values_once_they_are_set():
    cloud = trimesh.PointCloud(POINTS)
    assert dict(as_cloud(cloud).attributes) == {}
    cloud.weights = [0.5, -1, 2, 3]
    assert as_cloud(cloud).attributes["weights"].tolist() == [0.5, -1, 2, 3]
    scene = trimesh.Scene([cloud, cloud.copy()])
    assert len(as_cloud(scene)) == 8
    assert dict(as_cloud(trimesh.Trimesh(POINTS, FACES, process=False)).attributes) == {}
