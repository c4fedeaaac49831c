"""One coercer: write(), triangulate() and as_cloud() take the same objects."""

from __future__ import annotations

import io
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import open3d as o3d
import pytest
import trimesh
from numpy.typing import NDArray

import liftmesh
from liftmesh import Cloud, InputError, UnsupportedTypeError

POINTS = np.array([[0, 0, 5], [4, 0, 6], [0, 3, 7], [4, 3, 9.5]])
FACES = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)


class ArrayLike:
    """Anything that NumPy makes an array of."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[np.float64]:
        return np.array(POINTS, dtype=dtype)


class Convertible:
    """An object of a package that knows liftmesh."""

    def to_cloud(self) -> Cloud:
        return Cloud(POINTS)


def legacy_mesh() -> o3d.geometry.TriangleMesh:
    vectors, indices = o3d.utility.Vector3dVector(POINTS), o3d.utility.Vector3iVector(FACES)
    return o3d.geometry.TriangleMesh(vectors, indices)


OBJECTS: dict[str, Any] = {
    "array": POINTS,
    "list": POINTS.tolist(),
    "tuple": tuple(map(tuple, POINTS.tolist())),
    "array-like": ArrayLike(),
    "cloud": Cloud(POINTS),
    "surface": liftmesh.triangulate(POINTS),
    "lower hull": liftmesh.lower_hull(POINTS),
    "trimesh cloud": trimesh.PointCloud(POINTS),
    "trimesh mesh": trimesh.Trimesh(POINTS, FACES, process=False),
    "trimesh scene": trimesh.Scene(trimesh.Trimesh(POINTS, FACES, process=False)),
    "open3d cloud": o3d.geometry.PointCloud(o3d.utility.Vector3dVector(POINTS)),
    "open3d mesh": legacy_mesh(),
    "open3d tensor cloud": o3d.t.geometry.PointCloud(o3d.core.Tensor(POINTS)),
    "open3d tensor mesh": o3d.t.geometry.TriangleMesh.from_legacy(
        legacy_mesh(), o3d.core.Dtype.Float64
    ),
    "open3d tensor": o3d.core.Tensor(POINTS),
    "object with to_cloud": Convertible(),
    "object with vertices and faces": SimpleNamespace(vertices=POINTS, faces=FACES),
}


@pytest.mark.parametrize("what", OBJECTS)
def test_what_is_triangulated_is_written_too(what: str) -> None:
    source = OBJECTS[what]
    assert np.array_equal(liftmesh.as_cloud(source).points, POINTS)
    assert np.array_equal(liftmesh.triangulate(source).vertices, POINTS)
    stream = io.BytesIO()
    liftmesh.write(stream, source, format="ply")
    again = liftmesh.read(io.BytesIO(stream.getvalue()), format="ply")
    assert np.array_equal(again.points, POINTS)


@pytest.mark.parametrize("path", ["cloud.ply", Path("cloud.ply")])
def test_a_path_is_no_cloud(path: object) -> None:
    with pytest.raises(UnsupportedTypeError, match=r"is a path, not a cloud: liftmesh\.read it"):
        liftmesh.as_cloud(path)


def test_to_cloud_must_give_a_cloud() -> None:
    class Wrong:
        def to_cloud(self) -> int:
            return 3

    with pytest.raises(UnsupportedTypeError, match=r"makes a builtins\.int of a .*Wrong: it must"):
        liftmesh.as_cloud(Wrong())


def test_the_geometries_of_a_scene_are_put_in_their_places() -> None:
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0], [0, 0, 1])
    mesh = trimesh.Trimesh(
        POINTS, FACES, process=False, vertex_normals=np.tile([0.0, 0, 1], (4, 1))
    )
    scene = trimesh.Scene(mesh)
    scene.add_geometry(mesh, transform=turn)
    scene.add_geometry(trimesh.load_path(POINTS[:2]))
    scene.metadata["crs"] = "EPSG:2056"
    cloud = liftmesh.as_cloud(scene)
    assert len(cloud) == 8
    assert cloud.faces is not None
    assert cloud.faces.tolist() == [[0, 1, 2], [1, 3, 2], [4, 5, 6], [5, 7, 6]]
    assert np.allclose(cloud.points[4:], trimesh.transform_points(POINTS, turn))
    assert cloud.normals is not None
    assert np.allclose(cloud.normals[4:], [0, -1, 0])
    assert cloud.metadata["not_read"] == ("1 lines",)
    assert cloud.crs == "EPSG:2056"
    assert liftmesh.as_cloud(trimesh.Scene()).points.shape == (0, 3)


def test_the_coordinate_system_goes_all_the_way(tmp_path: Path) -> None:
    cloud = Cloud(POINTS, crs="EPSG:25832")
    surface = liftmesh.triangulate(cloud)
    assert surface.crs == "EPSG:25832"
    assert surface.to_trimesh().metadata["crs"] == "EPSG:25832"
    assert liftmesh.as_cloud(surface.to_trimesh()).crs == "EPSG:25832"
    surface.save(tmp_path / "mesh.ply")
    assert liftmesh.triangulate(tmp_path / "mesh.ply").crs == "EPSG:25832"


@pytest.mark.parametrize("crs", [25832, "", b"EPSG:25832", "EPSG\0"])
def test_a_coordinate_system_is_a_text(crs: Any) -> None:
    with pytest.raises(InputError, match=r"crs is .*: give WKT or 'EPSG:n' as a string, or None"):
        Cloud(POINTS, crs=crs)


def test_a_mirrored_geometry_keeps_its_outside() -> None:
    box = trimesh.creation.box()
    scene = trimesh.Scene()
    scene.add_geometry(box, transform=np.diag([-1.0, 1.0, 1.0, 1.0]))
    cloud = liftmesh.as_cloud(scene)
    assert trimesh.Trimesh(cloud.points, cloud.faces, process=False).volume > 0


@pytest.mark.parametrize("scale", [1e-120, 1e120, 0.0])
def test_normals_of_a_scene_do_not_depend_on_its_scale(scale: float) -> None:
    up = np.tile([0.0, 0, 1], (4, 1))
    mesh = trimesh.Trimesh(POINTS, FACES, process=False, vertex_normals=up)
    scene = trimesh.Scene()
    scene.add_geometry(mesh, transform=np.diag([scale, scale, scale, 1.0]))
    normals = liftmesh.as_cloud(scene).normals
    assert normals is None if scale == 0 else np.allclose(normals, up)


def test_a_face_beyond_32_bits_is_reported_as_it_is() -> None:
    faces = FACES.astype(np.int64)
    faces[1, 2] = 2**32 + 2
    mesh = trimesh.Trimesh(POINTS, faces, process=False, validate=False)
    for source in (mesh, trimesh.Scene(mesh)):
        with pytest.raises(liftmesh.FormatError, match="refers to vertex 4294967298"):
            liftmesh.write(io.BytesIO(), source, format="ply")


def test_the_coordinate_system_of_all_parts_is_that_of_the_scene() -> None:
    mesh = liftmesh.triangulate(Cloud(POINTS, crs="EPSG:2056")).to_trimesh()
    assert liftmesh.as_cloud(mesh.scene()).crs == "EPSG:2056"
    other = liftmesh.triangulate(Cloud(POINTS, crs="EPSG:25832")).to_trimesh()
    assert liftmesh.as_cloud(trimesh.Scene([mesh, other])).crs is None


@pytest.mark.parametrize("kind", [liftmesh.Surface, Convertible, trimesh.Trimesh])
def test_a_class_is_no_cloud(kind: type) -> None:
    with pytest.raises(UnsupportedTypeError, match=r"^an? .* is not a point cloud"):
        liftmesh.as_cloud(kind)


def test_the_values_of_a_mesh_like_object_may_be_lists() -> None:
    source = SimpleNamespace(vertices=POINTS, faces=FACES, attributes={"a": [1, 2, 3, 4]})
    stream = io.BytesIO()
    liftmesh.write(stream, source, format="ply")
    assert liftmesh.read(io.BytesIO(stream.getvalue()), format="ply").attributes["a"].tolist() == [
        1,
        2,
        3,
        4,
    ]


@pytest.mark.parametrize("text", ["a\0b", "\0", ""])
def test_what_cannot_be_a_coordinate_system_does_not_spoil_a_file(text: str) -> None:
    """Files of other programs may state anything: their points are read all the same."""
    stream = io.BytesIO()
    np.savez(stream, points=POINTS, crs=np.array(text))
    assert liftmesh.read(io.BytesIO(stream.getvalue()), format="npz").crs is None
    chunks = liftmesh.read_chunks(io.BytesIO(stream.getvalue()), format="npz")
    assert [chunk.crs for chunk in chunks] == [None]
    stated = f"crs {json.dumps(text)}"
    for kind in ("ply", "obj"):
        stream = io.BytesIO()
        liftmesh.write(stream, POINTS, format=kind, comments=[stated])
        assert liftmesh.read(io.BytesIO(stream.getvalue()), format=kind).crs is None
    scene = trimesh.Scene(trimesh.Trimesh(POINTS, FACES, process=False), metadata={"crs": text})
    cloud = liftmesh.as_cloud(scene)
    assert (cloud.crs, cloud.metadata["crs"]) == (None, text)
    again = liftmesh.read(io.BytesIO(scene.export(file_type="glb")), format="glb")
    assert (again.crs, len(again)) == (None, 4)
