"""Which way is up in GLB, glTF and OBJ, where their zero is, and what viewers shade by."""

from __future__ import annotations

import io
import json
import struct
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import trimesh
from file_samples import assert_same_bits, loaded, saved
from gltf_models import SQUARE, shape

import liftmesh
from liftmesh import Cloud, FormatError, InputError

KINDS = ["glb", "gltf", "obj"]
UTM = np.array([450000.0, 5200000.0, 300.0])
HILL = np.array([[0, 0, 1], [4, 0, -0.0], [0, 8, 0], [4, 8, 3], [2, 4, 5.5]])
FACES = np.array([[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4]], np.int32)
HILLS = {
    "mesh": Cloud(HILL, faces=FACES),
    "points": Cloud(HILL + UTM),
    "far": Cloud(HILL + UTM, faces=FACES, crs="EPSG:25832"),
}


def tree(data: bytes) -> dict[str, Any]:
    """Return the JSON of a GLB file."""
    found: dict[str, Any] = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    return found


def rows(data: bytes, key: str, dtype: str) -> np.ndarray:
    """Return the values of an attribute of a GLB file with one primitive, by its accessor."""
    found = tree(data)
    accessor = found["accessors"][found["meshes"][0]["primitives"][0]["attributes"][key]]
    view = found["bufferViews"][accessor["bufferView"]]
    begin = 28 + struct.unpack_from("<I", data, 12)[0] + view["byteOffset"]
    flat = np.frombuffer(data, dtype, view["byteLength"] // np.dtype(dtype).itemsize, begin)
    return flat.reshape(accessor["count"], -1)


@pytest.mark.parametrize("name", HILLS)
@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("kind", KINDS)
def test_both_axes_come_back_bit_for_bit(name: str, up: str, kind: str) -> None:
    cloud = HILLS[name]
    near: list[Any] = [[450001.0, 5200000.0, 0.0], UTM]
    for origin in (None, "center", *([] if name == "mesh" else near)):
        stream = io.BytesIO()
        written = liftmesh.write(stream, cloud, format=kind, up=up, origin=origin)
        back = loaded(stream.getvalue(), kind)
        assert_same_bits(back.points + 0.0, cloud.points + 0.0)
        assert written.dropped == ()
        assert back.normals is None
        if cloud.faces is not None:
            assert_same_bits(back.faces, cloud.faces)


@pytest.mark.parametrize("kind", ["glb", "gltf"])
def test_other_programs_see_y_up_near_zero(kind: str) -> None:
    stream = io.BytesIO()
    written = liftmesh.write(stream, HILLS["far"], format=kind, origin="center")
    assert written.origin == (450002.0, 5200004.0, 300.0)
    shown = trimesh.load_scene(io.BytesIO(stream.getvalue()), file_type=kind).to_geometry()
    assert shown.bounds.tolist() == [[-2, 0, -4], [2, 5.5, 4]]  # width, height, depth


def test_obj_has_the_same_numbers_on_other_axes() -> None:
    cloud = Cloud(HILLS["far"].points, faces=FACES, normals=HILL + 1)
    stream = io.BytesIO()
    liftmesh.write(stream, cloud, format="obj", up="y", origin=[450000, 5200000, 300])
    lines = stream.getvalue().decode().splitlines()
    axes = '# axes {"origin": [450000.0, 5200000.0, 300.0], "up": "y"}'
    assert axes in lines
    assert [line for line in lines if line.startswith("v ")] == [
        "v 0.0 1.0 -0.0", "v 4.0 0.0 -0.0", "v 0.0 0.0 -8.0", "v 4.0 3.0 -8.0", "v 2.0 5.5 -4.0",
    ]  # fmt: skip
    back = loaded(stream.getvalue(), "obj")
    assert_same_bits(back.normals, cloud.normals)
    assert back.metadata["origin"] == (450000.0, 5200000.0, 300.0)
    assert "comments" not in back.metadata


def test_readers_take_the_word_of_the_caller() -> None:
    data = b"v 1 2 3\nv 2 2 3\nv 1 5 3\n"
    stand = liftmesh.read(io.BytesIO(data), format="obj", up="y", origin=[10, 20, 30])
    assert stand.points.tolist() == [[11, 17, 32], [12, 17, 32], [11, 17, 35]]
    glb = saved(HILLS["mesh"], "glb")
    lying = liftmesh.read(io.BytesIO(glb), format="glb", up="z", origin=(0, 0, 7))
    assert lying.points[3].tolist() == [4, 3, -1]


def test_a_scene_of_another_program_has_y_up() -> None:
    model = shape(4, SQUARE[:3], rotation=[-(0.5**0.5), 0, 0, 0.5**0.5], translation=[5, 6, 7])
    model.tree["scenes"][0]["nodes"] = [1]
    for data, kind in ((model.glb(), "glb"), (model.gltf(), "gltf")):
        cloud = loaded(data, kind)
        assert cloud.points.tolist() == [[5, -7, 6], [6, -7, 6], [6, -6, 6]]  # without an error
        assert cloud.metadata["notes"] == ("y is up, as in all glTF: turned to z up",)


@pytest.mark.parametrize("place", [[0.5, 0.5, 0.5, 0.5], [0, 1, 0, 0], [0, 0, 3, 3]])
def test_turns_between_axes_are_exact(place: list[float]) -> None:
    model = shape(4, SQUARE[:3], rotation=place)
    part = model.tree["meshes"][1]["primitives"][0]["attributes"]
    model.tree["scenes"][0]["nodes"] = [1]
    normals = np.array([[0.1, 0.2, 0.3], [3, 0, 0], [0, 0, 2]], "<f4")
    part["NORMAL"] = model.accessor(normals)
    back = model.read()
    assert sorted(np.abs(back.points).sum(axis=1).tolist()) == [0, 1, 2]
    for before, after in zip(normals, back.normals, strict=True):
        assert sorted(map(abs, before.astype(float).tolist())) == sorted(map(abs, after.tolist()))


def test_feet_become_metres_in_the_node_alone() -> None:
    cloud = Cloud(HILL, faces=FACES, crs="EPSG:2263")
    data = saved(cloud, "glb")
    shown = trimesh.load_scene(io.BytesIO(data), file_type="glb").to_geometry()
    foot = 1200 / 3937
    assert np.allclose(shown.extents, [4 * foot, 5.5, 8 * foot])  # nothing says what heights are
    assert_same_bits(rows(data, "POSITION", "<f4"), HILL.astype(np.float32))
    assert_same_bits(loaded(data, "glb").points, HILL)


@pytest.mark.parametrize("kind", KINDS)
def test_axes_that_are_none(kind: str) -> None:
    for given in ({"up": "x"}, {"up": 1}, {"origin": "here"}, {"origin": [1, 2]}):
        with pytest.raises(InputError, match=f"^{next(iter(given))} is "):
            liftmesh.write(io.BytesIO(), HILLS["mesh"], format=kind, **given)
    for given in ({"up": "x"}, {"origin": [1, np.nan, 0]}, {"origin": "center"}):
        with pytest.raises(InputError, match=f"^{next(iter(given))} is "):
            liftmesh.read(io.BytesIO(), format=kind, **given)


def test_files_that_state_none() -> None:
    with pytest.raises(FormatError, match="the origin is"):
        loaded(b'# axes {"origin": [1, "x", 2]}\nv 1 2 3\n', "obj")
    model = shape(0)
    model.tree["scenes"][0]["extras"] = {"liftmesh": {"zero": [1]}}
    model.refused("the origin is")
    model.tree["scenes"][0]["extras"] = {"liftmesh": {"up": "y", "metres": [1, 0, 1]}}
    model.refused("the units in metres are")


def test_an_origin_far_from_the_points_is_refused() -> None:
    with pytest.raises(InputError, match="give a place near the points, or 'center'"):
        liftmesh.write(io.BytesIO(), Cloud(HILL + UTM / 3), format="glb", origin=[0, 0, 0])
    tiny = Cloud(np.array([[1e-20, 0.1, 0.3]]))
    written = liftmesh.write(io.BytesIO(), tiny, format="obj", origin=[1, 1, 1])
    assert written.dropped == ("double precision",)


def test_grey_128_is_half_lit_and_every_colour_comes_back() -> None:
    levels = np.arange(256, dtype=np.uint8)
    colors = np.column_stack([levels, levels[::-1], levels, levels[::-1]])
    cloud = Cloud(np.random.default_rng(3).random((256, 3)), colors=colors)
    for kind in ("glb", "gltf"):
        assert_same_bits(loaded(saved(cloud, kind), kind).colors, colors)
    light = rows(saved(cloud, "glb"), "COLOR_0", "<u2")[128] / 65535
    assert round(light[0], 4) == 0.2159  # as a viewer shows it: 1.055 L^(1/2.4) - 0.055
    assert round(1.055 * light[0] ** (1 / 2.4) - 0.055, 3) == 0.502


def test_the_material_is_dull_and_no_metal() -> None:
    for cloud in HILLS.values():
        found = tree(saved(cloud, "glb"))
        (each,) = found["materials"]
        dull = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
        assert each["pbrMetallicRoughness"] == dull
        assert found["meshes"][0]["primitives"][0]["material"] == 0


def test_normals_are_those_of_the_faces_by_area() -> None:
    found = rows(saved(HILLS["mesh"], "glb"), "NORMAL", "<f4")
    for row in range(len(HILL)):
        total = [Fraction(0)] * 3
        for face in FACES[(row == FACES).any(axis=1)]:
            a, b, c = ([Fraction(x) for x in HILL[k].tolist()] for k in face)
            u, v = ([q - p for p, q in zip(a, end, strict=True)] for end in (b, c))
            across = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
            total = [p + q for p, q in zip(total, across, strict=True)]
        expected = np.array([float(each) for each in total])
        assert np.allclose(found[row], expected / np.linalg.norm(expected), atol=1e-7)


def test_normals_do_not_depend_on_the_order_of_anything() -> None:
    rng = np.random.default_rng(8)
    surface = liftmesh.triangulate(rng.random((300, 3)))
    order = rng.permutation(300)
    place = np.argsort(order)
    turned = np.array([np.roll(face, k) for k, face in enumerate(place[surface.faces])])
    other = Cloud(surface.vertices[order], faces=rng.permutation(turned).astype(np.int32))
    one = rows(saved(surface.to_cloud(), "glb"), "NORMAL", "<f4")
    assert_same_bits(rows(saved(other, "glb"), "NORMAL", "<f4"), one[order])


def test_vertices_without_a_face_get_a_normal_of_length_one() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5], [5, 5, 5.0]])
    faces = np.array([[0, 1, 2], [3, 4, 3]], np.int32)
    found = rows(saved(Cloud(points, faces=faces), "glb"), "NORMAL", "<f4")
    assert found.tolist() == [[0, 0, 1]] * 5
