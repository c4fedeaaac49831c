"""GLB and glTF: what a scene holds is read or named, and counted before it is built."""

from __future__ import annotations

import io
import json
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from file_samples import loaded
from gltf_models import SQUARE, TRIANGLE, Model, faces, shape

import liftmesh
from liftmesh import FormatError
from liftmesh.cli import exit_codes, main

QUARTER = [0.0, 0.0, 0.5**0.5, 0.5**0.5]

EXPECTED = {
    0: [[4, 5, 6]],
    5: [[0, 1, 2], [3, 2, 1], [4, 5, 6]],
    6: [[0, 1, 2], [0, 2, 3], [4, 5, 6]],
}


@pytest.mark.parametrize("mode", EXPECTED)
@pytest.mark.parametrize("node", [{}, {"camera": 0}, {"name": "world"}, {"extras": {"a": 1}}])
def test_every_mode_is_read_beside_others(mode: int, node: dict[str, Any]) -> None:
    model = shape(mode, **node)
    model.tree["cameras"] = [
        {"type": "perspective", "perspective": {"znear": 0.1, "yfov": 1, "aspectRatio": 1}}
    ]
    cloud = model.read()
    assert cloud.points.tolist() == [*SQUARE.tolist(), *TRIANGLE.tolist()]
    assert faces(cloud) == EXPECTED[mode]
    assert "not_read" not in cloud.metadata


@pytest.mark.parametrize("mode", [4, 5, 6])
@pytest.mark.parametrize("kind", ["<u1", "<u2", "<u4"])
@pytest.mark.parametrize("stride", [0, 4, 8])
def test_indices_of_every_type(mode: int, kind: str, stride: int) -> None:
    corners = np.array([3, 0, 1, 2, 3, 1], dtype=kind)
    model = Model()
    rows = model.accessor(SQUARE)
    held = np.zeros((6, max(stride // corners.itemsize, 1)), dtype=kind)
    held[:, 0] = corners
    indices = model.accessor(held.reshape(-1), count=6)
    if stride:
        model.tree["bufferViews"][-1]["byteStride"] = stride
    part = {"attributes": {"POSITION": rows}, "indices": indices, "mode": mode}
    model.node(mesh=model.mesh(part))
    expected = {
        4: [[3, 0, 1], [2, 3, 1]],
        5: trimesh.util.triangle_strips_to_faces([corners]).tolist(),
        6: [[3, 0, 1], [3, 1, 2], [3, 2, 3], [3, 3, 1]],
    }
    assert faces(model.read()) == expected[mode]
    model.tree["accessors"][-1]["count"] = 0
    assert faces(model.read()) == []


@pytest.mark.parametrize("mode", [4, 5, 6])
@pytest.mark.parametrize("corner", [4, 255, 2**31, 2**32 - 1])
def test_indices_beyond_the_vertices(mode: int, corner: int) -> None:
    model = Model()
    corners = model.accessor(np.array([0, corner, 1], dtype="<u4"))
    part = {"attributes": {"POSITION": model.accessor(SQUARE)}, "indices": corners, "mode": mode}
    model.node(mesh=model.mesh(part))
    model.refused(f"index 1 refers to vertex {corner} .* there are 4 vertices")


@pytest.mark.parametrize(("mode", "what"), [(1, "lines"), (2, "line loop"), (3, "line strip")])
def test_lines_are_named(mode: int, what: str) -> None:
    model = shape(mode)
    cloud = model.read()
    assert (len(cloud), faces(cloud)) == (3, [[0, 1, 2]])
    assert cloud.metadata["not_read"] == (f"1 {what}",)
    model.node(mesh=1)
    plural = what if mode == 1 else f"{what}s"
    assert model.read().metadata["not_read"] == (f"2 {plural}",)
    model.tree["scenes"][0]["nodes"] = [1]
    model.refused(f"the file holds no vertices: only 1 {what}, 2 nodes outside the scene")


def test_what_is_not_read_is_named() -> None:
    model = Model(scenes=[{"nodes": []}, {"nodes": [0]}, {}])
    rows = model.accessor(SQUARE)
    attributes = {"POSITION": rows, "TEXCOORD_0": 0, "MINE": 0, "JOINTS_0": 0}
    draco = {"KHR_draco_mesh_compression": {}, "KHR_materials_variants": {}}
    one = model.mesh({"attributes": attributes, "mode": 0, "targets": [{}], "extensions": draco})
    instances = {"EXT_mesh_gpu_instancing": {}, "KHR_lights_punctual": {}}
    model.node(mesh=one, skin=0, extensions=instances)
    model.node(mesh=one, root=False)
    model.node(mesh=model.mesh({"mode": 0, "attributes": {"COLOR_0": rows}}))
    assert set(model.read().metadata["not_read"]) == {
        "1 skin",
        "1 node with EXT_mesh_gpu_instancing",
        "1 primitive with TEXCOORD_0",
        "1 primitive with MINE",
        "1 primitive with JOINTS_0",
        "1 primitive with KHR_draco_mesh_compression",
        "1 primitive with morph targets",
        "1 primitive without positions",
        "1 node outside the scene",
        "2 other scenes",
    }


def test_colours_and_normals_that_not_all_have() -> None:
    model = shape(0)
    part = model.tree["meshes"][1]["primitives"][0]["attributes"]
    part["COLOR_0"] = model.accessor(np.full((4, 4), 9, dtype="<u1"), normalized=True)
    part["NORMAL"] = model.accessor(SQUARE + np.array([0, 0, 1], dtype="<f4"))
    cloud = model.read()
    assert cloud.colors is None
    assert cloud.normals is None
    assert cloud.metadata["not_read"] == (
        "1 primitive with COLOR_0, which not all have",
        "1 primitive with NORMAL, which not all have",
    )
    model.tree["scenes"][0]["nodes"] = [1]
    cloud = model.read()
    assert cloud.colors is not None
    assert cloud.normals is not None
    assert cloud.colors.tolist() == [[53, 53, 53, 9]] * 4
    assert cloud.normals.tolist() == (SQUARE + np.array([0, 0, 1])).tolist()
    model.tree["nodes"][1]["scale"] = [1, 1, 0]
    assert "1 primitive with NORMAL, which not all have" in model.read().metadata["not_read"]


def test_meshes_stand_in_their_places() -> None:
    model = Model()
    mesh = model.mesh({"attributes": {"POSITION": model.accessor(TRIANGLE)}})
    outer = model.node(translation=[10, 0, 0], rotation=QUARTER, children=[1, 2])
    model.node(mesh=mesh, scale=[2, 3, -1], root=False)
    matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]
    model.node(mesh=mesh, matrix=matrix, root=False, children=[3])
    model.node(mesh=mesh, root=False)
    cloud = model.read()
    turned = trimesh.transformations.quaternion_matrix([QUARTER[3], *QUARTER[:3]])[:3, :3]
    moved = (TRIANGLE + np.array([7, 8, 9])) @ turned.T + [10, 0, 0]
    scaled = (TRIANGLE * [2, 3, -1]) @ turned.T + [10, 0, 0]
    np.testing.assert_allclose(cloud.points, [*moved, *moved, *scaled], atol=1e-12)
    assert faces(cloud) == [[0, 1, 2], [3, 4, 5], [8, 7, 6]]  # the last is mirrored
    assert outer == 0


def test_primitives_in_many_places() -> None:
    model = Model()
    for count in (3, 6, 9):
        corners = np.arange(count * 3, dtype="<f4").reshape(-1, 3) + 100 * count
        parts = [{"attributes": {"POSITION": model.accessor(corners[: 3 * k])}} for k in (1, 2, 1)]
        mesh = model.mesh(*[part for part in parts if count > 3 or part is not parts[1]])
        for place in range(count):
            model.node(mesh=mesh, translation=[place, 0, 0])
    whole = model.read()
    scene = trimesh.load_scene(io.BytesIO(model.glb()), file_type="glb", process=False)
    assert len(whole) == sum(len(each.vertices) for each in scene.dump())
    joined = liftmesh.as_cloud(scene)
    assert whole.points.tobytes() == joined.points.tobytes()
    assert faces(whole) == faces(joined)


@pytest.mark.parametrize(
    ("kind", "one"), [("<i1", 127), ("<u1", 255), ("<i2", 32767), ("<u2", 65535)]
)
def test_normalised_integers(kind: str, one: int) -> None:
    rows = np.array([[0, 0, 0], [one, 0, 0], [0, one, 0]], dtype=kind)
    if kind[1] == "i":
        rows[0, 2] = -one - 1
    model = Model(extensionsRequired=["KHR_mesh_quantization"])
    attributes = {"POSITION": model.accessor(rows, normalized=True)}
    if kind[1] == "i":
        attributes["NORMAL"] = attributes["POSITION"]
    model.node(mesh=model.mesh({"attributes": attributes}))
    low = -1.0 if kind[1] == "i" else 0.0
    cloud = model.read()
    assert cloud.points.tolist() == [[0, 0, low], [1, 0, 0], [0, 1, 0]]
    if kind[1] == "i":
        assert cloud.normals is not None
        assert cloud.normals.tolist() == cloud.points.tolist()
    del model.tree["accessors"][0]["normalized"]
    assert model.read().points.tolist() == rows.tolist()


def instances(uses: int, rows: int) -> Model:
    """Make a model of one mesh of zeros that is used many times."""
    model = Model()
    zeros = model.accessor(np.zeros((rows, 3), dtype="<f4"))
    mesh = model.mesh({"attributes": {"POSITION": zeros}, "mode": 0})
    model.tree["nodes"] = [{"mesh": mesh}] * uses
    model.tree["scenes"][0]["nodes"] = [*range(uses)]
    return model


def test_uses_are_counted_before_they_are_built() -> None:
    model = instances(1000, 1000)
    assert len(model.read()) == 10**6
    assert len(model.read(max_bytes=24 * 10**6)) == 10**6
    model.refused(
        "its scene of 1,000 meshes expands to 24,000,000 bytes, more than the limit of "
        "23,999,999: if you trust the file, raise it with max_bytes=",
        max_bytes=24 * 10**6 - 1,
    )
    bomb = instances(4_000, 4_000).gltf()
    tracemalloc.start()
    with pytest.raises(FormatError, match=r"expands to 384,000,000 bytes.* of 268,435,456"):
        loaded(bomb, "gltf")
    assert tracemalloc.get_traced_memory()[1] < 50 * len(bomb)
    tracemalloc.stop()


def test_the_limit_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "many.glb"
    path.write_bytes(instances(100, 100).glb())
    assert main(["info", str(path), "--max-bytes", "239k"]) == exit_codes.BAD_INPUT
    assert "240,000 bytes, more than the limit of 239,000" in (told := capsys.readouterr().err)
    assert "raise it with --max-bytes" in " ".join(told.split())
    assert main(["info", str(path), "--max-bytes", "240k"]) == exit_codes.DONE


@pytest.mark.parametrize(("part", "count"), [(b'{"":0},', 350_000), (b"[],", 800_000)])
def test_trees_of_nothing_are_counted_too(part: bytes, count: int) -> None:
    data = b'{"x":[' + part * count + b"0]}"
    with pytest.raises(FormatError, match=r"its JSON of [\d,]+ bytes expands to [\d,]+ bytes"):
        loaded(data, "gltf")
    with pytest.raises(FormatError, match="no vertices"):
        liftmesh.read(io.BytesIO(data), format="gltf", max_bytes=10**9)


@pytest.mark.slow
def test_nodes_nested_as_deep_as_one_likes() -> None:
    model = shape(5)
    depth = 20_000
    model.tree["nodes"] = [
        *({"children": [k + 1], "translation": [1, 0, 0]} for k in range(depth)),
        {"mesh": 0},
    ]
    model.tree["scenes"][0]["nodes"] = [0]
    assert model.read().points.tolist() == (TRIANGLE + np.array([depth, 0, 0])).tolist()


def test_normals_that_one_place_flattens() -> None:
    model = Model(extensions={"KHR_materials_variants": {"variants": []}})
    normals = model.accessor(np.array([[0, 0, 1]] * 3, dtype="<f4"))
    attributes = {"POSITION": model.accessor(TRIANGLE), "NORMAL": normals}
    mesh = model.mesh({"attributes": attributes})
    model.node(mesh=mesh)
    model.node(mesh=mesh, translation=[0, 0, 1])
    cloud = model.read()
    assert cloud.normals is not None
    assert cloud.normals.tolist() == [[0, 0, 1]] * 6
    assert cloud.metadata["gltf_extensions"] == model.tree["extensions"]
    model.node(mesh=mesh, scale=[1, 0, 1])
    cloud = model.read()
    assert cloud.normals is None
    assert cloud.metadata["not_read"] == ("3 primitives with NORMAL, which not all have",)


def test_more_vertices_than_indices_count() -> None:
    data = instances(60_000, 40_000).glb()
    with pytest.raises(FormatError, match="2,400,000,000 vertices are more than 32-bit indices"):
        liftmesh.read(io.BytesIO(data), format="glb", max_bytes=10**12)


def test_matrices_that_single_precision_rounded() -> None:
    matrix = [2.0, 0, 0, 1e-6, 0, 2, 0, -1e-6, 0, 0, 2, 1e-7, 5, 6, 7, 0.99999988]
    exact = [2.0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]
    cloud = shape(5, matrix=matrix).read()
    assert cloud.points.tolist() == shape(5, matrix=exact).read().points.tolist()
    assert [7, 8, 7] in cloud.points.tolist()


@pytest.mark.parametrize("mark", ["\n", "\r\n", " ", "\t"])
def test_base64_in_lines(mark: str) -> None:
    tree = json.loads(shape(5).gltf())
    head, text = tree["buffers"][0]["uri"].split(",")
    lines = [text[k : k + 16] for k in range(0, len(text), 16)]
    tree["buffers"][0]["uri"] = f"{head},{mark.join(lines)}{mark}"
    assert len(loaded(json.dumps(tree).encode(), "gltf")) == 7


@pytest.mark.parametrize(
    "name", ["EXT_mesh_features", "EXT_structural_metadata", "KHR_animation_pointer"]
)
def test_required_extensions_that_move_nothing(name: str) -> None:
    model = shape(5)
    model.tree["extensionsRequired"] = [name]
    model.tree["meshes"][1]["primitives"][0]["extensions"] = {name: {}}
    assert model.read().metadata["not_read"] == (f"1 primitive with {name}",)


def test_points_beyond_doubles_are_infinite_without_a_warning() -> None:
    cloud = shape(0, scale=[1.7e308] * 3).read()
    assert cloud.points[:4].tolist() == (SQUARE.astype(float) * 1.7e308).tolist()
    cloud = shape(0, rows=SQUARE + np.float32(1), scale=[1.7e308] * 3).read()
    assert cloud.points[2].tolist() == [np.inf, np.inf, 1.7e308]
