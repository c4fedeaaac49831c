"""The place of a glTF mesh, and its named values: in the standard's own words, and exact."""

from __future__ import annotations

import io
import json
import struct
from typing import Any

import numpy as np
import pytest
import trimesh
from file_samples import assert_same_bits, loaded, saved, small_mesh
from gltf_models import SQUARE, Model, shape

import liftmesh
from liftmesh import Cloud, FormatError

UTM = np.array([450000.0, 5200000.0, 0.0])
MESH = small_mesh()
KINDS = ["glb", "gltf"]


def far() -> Cloud:
    points = np.array([[0, 0, 0.1], [100.2, 0, 0.5], [0, 99.3, 0.25], [80.1, 77.7, 2]]) + UTM
    return Cloud(points, faces=MESH.faces, normals=np.eye(4)[:, :3] + [0, 0, 0.5])


def tree(data: bytes) -> dict[str, Any]:
    """Return the JSON of a GLB file."""
    found: dict[str, Any] = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    return found


def changed(data: bytes, found: dict[str, Any]) -> bytes:
    """Replace the JSON of a GLB file."""
    text = json.dumps(found).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + struct.unpack_from("<I", data, 12)[0] :]
    size = 20 + len(text) + len(rest)
    return struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON") + text + rest


def plain(cloud: Cloud) -> np.ndarray:
    """What single precision beside the origin makes of coordinates."""
    rounded: np.ndarray = (cloud.points - UTM).astype(np.float32).astype(np.float64) + UTM
    return rounded


@pytest.mark.parametrize("kind", KINDS)
def test_every_viewer_puts_the_mesh_where_it_belongs(kind: str) -> None:
    data = saved(far(), kind)
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
    x, y, z = far().points.T
    with_y_up = np.column_stack([x, z, -y])
    np.testing.assert_allclose(scene.bounds, [with_y_up.min(0), with_y_up.max(0)], atol=1e-4)
    found = tree(data) if kind == "glb" else json.loads(data)
    (node,) = (each for each in found["nodes"] if "mesh" in each)
    assert node["translation"] == UTM.tolist()
    assert "matrix" not in node


@pytest.mark.parametrize("kind", KINDS)
def test_coordinates_come_back_bit_for_bit(kind: str) -> None:
    for cloud in (far(), Cloud(far().points)):
        back = loaded(saved(cloud, kind), kind)
        assert_same_bits(back.points, plain(cloud))
        assert back.metadata["origin"] == (450000.0, 5200000.0, 0.0)
        assert_same_bits(loaded(saved(back, kind), kind).points, plain(cloud))


def test_files_of_older_versions_are_read_alike() -> None:
    """Their nodes are at zero, and the origin stands in the extras alone."""
    data = saved(far(), "glb")
    older = tree(data)
    for node in older["nodes"]:
        node.pop("translation", None)
    older["scenes"][0]["extras"] = {"origin": UTM.tolist()}
    back = loaded(changed(data, older), "glb")
    assert_same_bits(back.points, loaded(data, "glb").points)
    assert back.metadata["origin"] == (450000.0, 5200000.0, 0.0)


def test_a_place_that_another_program_rounded_is_exact_again() -> None:
    origin = np.array([450000.125, 5200000.3, 1 / 3])
    cloud = Cloud(MESH.points * 1e-6 + origin, faces=MESH.faces)
    data = saved(cloud, "glb")
    found = tree(data)
    for node in found["nodes"]:
        if "translation" in node:
            node["translation"] = np.float32(node["translation"]).astype(float).tolist()
    assert_same_bits(loaded(changed(data, found), "glb").points, loaded(data, "glb").points)


def test_an_origin_beyond_single_precision() -> None:
    cloud = Cloud(np.array([[1e300, 0.0, 0.0]]))
    assert_same_bits(loaded(saved(cloud, "glb"), "glb").points, cloud.points)


def test_a_mesh_that_was_moved_stays_where_it_was_put() -> None:
    data = saved(far(), "glb")
    found = tree(data)
    for node in found["nodes"]:
        if "translation" in node:
            node["translation"] = [7.0, 8.0, 9.0]
    back = loaded(changed(data, found), "glb")
    assert_same_bits(back.points, plain(far()) - UTM + [7, 8, 9])
    assert "origin" not in back.metadata


def test_normals_and_signs_of_zero_survive_a_translation() -> None:
    model = shape(0, SQUARE, translation=[5, 6, 7])
    part = model.tree["meshes"][1]["primitives"][0]["attributes"]
    model.tree["scenes"][0]["nodes"] = [1]
    normals = np.array([[0, 0, 2], [0, -0.0, 1], [0.1, 0, 1], [3, 0, 0]], dtype="<f4")
    part["NORMAL"] = model.accessor(normals)
    assert_same_bits(model.read().normals, normals.astype(np.float64))


VALUES = {
    "intensity": np.array([0, 65535, 7, 8], dtype=np.uint16),
    "Scan Angle": np.array([-90, 90, 0, 1], dtype=np.int8),
    "scan_angle": np.array([0.5, -0.0, 1e-30, 3], dtype=np.float32),
    "Höhe": np.array([0.5, 0.25, 1e30, 3]).astype(np.float32).astype(np.float64),
    "flag": np.array([True, False, True, True]),
    "id": np.array([2**24, 1, 2, 3]),
    "uv": np.arange(8, dtype=np.float32).reshape(4, 2),
    "_hidden": np.arange(4),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("faces", [MESH.faces, None])
def test_named_values_come_back_with_name_and_type(kind: str, faces: Any) -> None:
    cloud = Cloud(MESH.points + UTM, faces=faces, attributes=VALUES)
    written = liftmesh.write(stream := io.BytesIO(), cloud, format=kind)
    assert written.dropped == ()
    assert dict(written.renamed)["Höhe"] == "_H_HE"
    back = loaded(stream.getvalue(), kind)
    assert [*back.attributes] == [*VALUES]
    for name, values in VALUES.items():
        assert_same_bits(back.attributes[name], values)


def test_other_programs_read_named_values() -> None:
    cloud = Cloud(MESH.points, faces=MESH.faces, attributes=VALUES)
    scene = trimesh.load_scene(io.BytesIO(saved(cloud, "glb")), file_type="glb", process=False)
    (mesh,) = scene.geometry.values()
    assert mesh.vertex_attributes["_INTENSITY"].ravel().tolist() == [0, 65535, 7, 8]
    assert tree(saved(cloud, "glb"))["meshes"][0]["primitives"][0]["attributes"].keys() >= {
        "_INTENSITY",
        "_SCAN_ANGLE",
        "_SCAN_ANGLE_1",
        "_UV",
    }


def test_what_single_precision_does_not_hold_is_named() -> None:
    values = {
        "height": np.array([0.1, 0.2, 0.3, 5e6 + 0.1]),
        "id": np.array([2**24 + 1, 0, 0, 0]),
        "gap": np.array([np.nan, 0, 0, 0]),
        "text": np.array(list("abcd")),
        "none": np.zeros((4, 0)),
        "five": np.zeros((4, 5)),
    }
    cloud = Cloud(MESH.points, faces=MESH.faces, attributes=values)
    written = liftmesh.write(stream := io.BytesIO(), cloud, format="glb")
    assert written.dropped == (
        "gap (not finite)",
        "double precision of height",
        "double precision of id",
        "none (no values)",
        "text (not numbers)",
    )
    back = loaded(stream.getvalue(), "glb").attributes
    assert [*back] == ["height", "id", *(f"five_{k}" for k in range(5))]
    assert back["height"].tolist() == values["height"].astype(np.float32).tolist()


def test_values_of_other_programs_in_all_types() -> None:
    model = Model()
    attributes = {"POSITION": model.accessor(SQUARE)}
    attributes["_A"] = model.accessor(np.array([0, 1, 127, -128], dtype="<i1"))
    attributes["_B"] = model.accessor(np.array([0, 255, 51, 1], dtype="<u1"), normalized=True)
    attributes["_C"] = model.accessor(np.arange(8, dtype="<u2").reshape(4, 2))
    attributes["_"] = model.accessor(np.arange(4, dtype="<f4"))
    model.node(mesh=model.mesh({"attributes": attributes, "mode": 0}))
    cloud = model.read()
    assert cloud.attributes["A"].tolist() == [0, 1, 127, -128]
    assert cloud.attributes["B"].tolist() == [0, 1, 0.2, 1 / 255]
    assert cloud.attributes["C"].tolist() == [[0, 1], [2, 3], [4, 5], [6, 7]]
    assert cloud.attributes["_"].tolist() == [0, 1, 2, 3]


def test_values_of_several_meshes_are_joined_if_all_have_them() -> None:
    model = Model()
    for k in (0, 1):
        attributes = {"POSITION": model.accessor(SQUARE)}
        attributes["_ALL"] = model.accessor(np.arange(4, dtype="<f4") + 10 * k)
        attributes["_WIDE"] = model.accessor(np.zeros((4, 2 + k), dtype="<f4"))
        if k:
            attributes["_ONE"] = attributes["_ALL"]
        part = model.mesh({"attributes": attributes, "mode": 0})
        model.node(mesh=part, translation=[k, 0, 0])
    cloud = model.read()
    assert sorted(cloud.attributes) == ["ALL"]
    assert sorted(cloud.attributes["ALL"].tolist()) == [0, 1, 2, 3, 10, 11, 12, 13]
    assert cloud.points[cloud.attributes["ALL"] == 12].tolist() == [[2, 1, 0]]
    assert set(cloud.metadata["not_read"]) == {
        "1 primitive with _ONE, which not all have",
        "2 primitives with _WIDE, which not all have",
    }


@pytest.mark.parametrize(
    "stated",
    [7, {"_A": 5}, {"_A": ["a"]}, {"_A": [1, "f4"]}, {"_A": ["b", "void"]}, {"_A": ["b", "uint8"]}],
)
def test_a_note_that_is_wrong_has_no_effect(stated: Any) -> None:
    model = Model()
    attributes = {"POSITION": model.accessor(SQUARE)}
    attributes["_A"] = model.accessor(np.array([0.5, 1, 2, 3], dtype="<f4"))
    model.node(mesh=model.mesh({"attributes": attributes, "mode": 0}))
    model.tree["scenes"][0]["extras"] = {"liftmesh": {"attributes": stated}}
    ((name, values),) = model.read().attributes.items()
    assert name in {"A", "b"}
    assert values.tolist() == [0.5, 1, 2, 3]


def test_two_values_may_not_get_one_name() -> None:
    model = Model()
    attributes = {"POSITION": model.accessor(SQUARE)}
    for key in ("_A", "_B"):
        attributes[key] = model.accessor(np.zeros(4, dtype="<f4"))
    model.node(mesh=model.mesh({"attributes": attributes, "mode": 0}))
    note = {"attributes": {"_A": ["x", "float64"], "_B": ["x", "float64"]}}
    model.tree["scenes"][0]["extras"] = {"liftmesh": note}
    assert [*model.read().attributes] == ["x", "_B"]


def test_invalid_values_are_refused() -> None:
    model = Model()
    attributes = {"POSITION": model.accessor(SQUARE)}
    attributes["_A"] = model.accessor(np.zeros(3, dtype="<f4"))
    model.node(mesh=model.mesh({"attributes": attributes, "mode": 0}))
    model.refused("_A has 3 rows, POSITION 4")
    attributes["_A"] = model.accessor(np.zeros((1, 4), dtype="<f4"), type="MAT2")
    model.refused("_A is MAT2")
    attributes |= {f"_{k}": 0 for k in range(10_001)}
    model.refused(r"a primitive of 10,00\d values expands to .* more than the limit")
    placed = Model(scenes=[{"nodes": [], "extras": {"liftmesh": {"origin": [1, 2]}}}])
    placed.refused("the origin is 1, 2: expected three finite numbers")


def test_shared_values_are_counted_before_they_are_made() -> None:
    model = Model()
    rows = np.zeros((1000, 3), dtype="<f4")
    attributes = {"POSITION": model.accessor(rows)}
    values = model.accessor(rows[:, 0].copy())
    attributes |= {f"_{k}": values for k in range(9000)}
    model.node(mesh=model.mesh({"attributes": attributes, "mode": 0}))
    model.refused(r"expands to 72,024,000 bytes", max_bytes=70_000_000)


def test_a_part_of_a_vector_does_not_replace_another_attribute() -> None:
    """It did: hist_0 was written, and the first column of hist was not, without a word."""
    values = {"hist": np.arange(20.0).reshape(4, 5), "hist_0": np.ones(4)}
    for attributes in (values, dict(reversed(values.items()))):
        with pytest.raises(FormatError, match="two attributes are named 'hist_0'"):
            saved(Cloud(MESH.points, faces=MESH.faces, attributes=attributes), "glb")


def test_integers_at_the_end_of_their_range_are_named() -> None:
    ends = {"i": np.array([2**63 - 1, 0, 1, 2]), "u": np.array([2**64 - 1, 0, 1, 2], np.uint64)}
    written = liftmesh.write(
        io.BytesIO(), Cloud(MESH.points, faces=MESH.faces, attributes=ends), format="glb"
    )
    assert written.dropped == ("double precision of i", "double precision of u")


@pytest.mark.parametrize(
    ("stored", "read", "is_rounded"),
    [
        (np.array([[65535, 14147, 0], [200, 100, 50]], "<u2"), [[255, 128, 0], [10, 5, 3]], True),
        (np.array([[20, 40, 65535], [14146, 0, 0]], "<u2"), [[1, 2, 255], [128, 0, 0]], False),
        (
            np.array([[1, 0.21586050, 0], [7, -1, np.nan]], "<f4"),
            [[255, 128, 0], [255, 0, 0]],
            False,
        ),
        (np.array([[0.5, 0.2, 0], [0, 0, 0]], "<f4"), [[188, 124, 0], [0, 0, 0]], True),
        (np.array([[55, 0, 255], [0, 0, 0]], "<u1"), [[128, 0, 255], [0, 0, 0]], False),
        (np.array([[55, 254, 255], [253, 0, 0]], "<u1"), [[128, 255, 255], [254, 0, 0]], True),
    ],
)
@pytest.mark.parametrize("uses", [1, 2])
def test_colours_of_all_types(
    stored: np.ndarray, read: list[list[int]], is_rounded: bool, uses: int
) -> None:
    """Of 16-bit colours, as Blender writes them, only the lower eight bits were read."""
    model = Model()
    rows = np.repeat(stored, 2, axis=0)
    if rows.itemsize < 4:  # rows begin at multiples of four bytes
        rows = np.hstack([rows, np.full((4, 1), np.iinfo(rows.dtype).max, rows.dtype)])
    values = model.accessor(rows, normalized=rows.dtype.kind == "u")
    attributes = {"POSITION": model.accessor(SQUARE), "COLOR_0": values}
    mesh = model.mesh({"attributes": attributes, "mode": 0})
    for _ in range(uses):
        model.node(mesh=mesh)
    cloud = model.read()
    assert cloud.colors is not None
    expected = np.tile(np.repeat(read, 2, axis=0), (uses, 1))
    assert np.array_equal(cloud.colors, np.hstack([expected, np.full((4 * uses, 1), 255)]))
    counted = {1: "1 primitive", 2: "2 primitives"}[uses]
    noted = (f"{counted} with COLOR_0 of more than 8 bits, rounded",) if is_rounded else None
    assert cloud.metadata.get("not_read") == noted


WIDEST = [np.int32(2**31 - 1), np.uint32(2**32 - 1), np.int64(2**63 - 1), np.uint64(2**64 - 1)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("value", WIDEST, ids=[value.dtype.name for value in WIDEST])
def test_the_largest_number_of_a_type_is_named_without_a_warning(kind: str, value: Any) -> None:
    cloud = Cloud(MESH.points, faces=MESH.faces, attributes={"id": np.full(4, value)})
    assert liftmesh.write(io.BytesIO(), cloud, format=kind).dropped == ("double precision of id",)
    assert (loaded(saved(cloud, kind), kind).attributes["id"] == np.float32(value)).all()


@pytest.mark.parametrize("kind", KINDS)
def test_whole_numbers_of_24_bits_are_kept(kind: str) -> None:
    values = np.array([2**24 - 1, -(2**40), 2**62, 0])
    cloud = Cloud(MESH.points, faces=MESH.faces, attributes={"id": values})
    assert liftmesh.write(io.BytesIO(), cloud, format=kind).dropped == ()
    assert_same_bits(loaded(saved(cloud, kind), kind).attributes["id"], values)


@pytest.mark.parametrize("kind", KINDS)
def test_normals_that_single_precision_rounds_are_named(kind: str) -> None:
    normals = np.array([[0, 0.6, 0.8], [0, 0, 1], [1, 0, 0], [0, 0, 0]])
    cloud = Cloud(MESH.points, faces=MESH.faces, normals=normals)
    dropped = liftmesh.write(io.BytesIO(), cloud, format=kind).dropped
    assert dropped == ("double precision of normals",)
    back = loaded(saved(cloud, kind), kind).normals
    assert back is not None
    assert np.array_equal(back, normals.astype(np.float32))
    tiny = Cloud(MESH.points, faces=MESH.faces, normals=normals * 1e-180)
    assert liftmesh.write(io.BytesIO(), tiny, format=kind).dropped == ("normals",)
    single = Cloud(MESH.points, faces=MESH.faces, normals=normals.astype(np.float32))
    assert liftmesh.write(io.BytesIO(), single, format=kind).dropped == ()


def test_a_name_may_be_the_key_of_another() -> None:
    values = {"a": np.ones(4), "_A": np.zeros(4)}
    cloud = Cloud(MESH.points, faces=MESH.faces, attributes=values)
    assert {*loaded(saved(cloud, "glb"), "glb").attributes} == {*values}
