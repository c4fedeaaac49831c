"""GLB and glTF: the work to read a scene is in proportion to its parts, not to their products."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
from file_samples import loaded
from gltf_models import TRIANGLE, Model, faces

from liftmesh.io.formats.gltf import reader as gltf_reader
from liftmesh.io.formats.gltf.buffers import Buffers, StatedBuffer
from liftmesh.io.formats.gltf.validation import Document
from liftmesh.io.objects.trimesh import transformed


def test_lists_are_not_checked_again_for_each_of_their_parts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    count = 300
    model = Model()
    rows = model.accessor(TRIANGLE)
    for _ in range(count):
        model.node(mesh=model.mesh({"attributes": {"POSITION": rows}}))
    looked_at = Counter[str]()
    objects = Document.objects

    def counted(self: Document, found: Any, what: str) -> Any:
        looked_at["all"] += len(found)
        return objects(self, found, what)

    monkeypatch.setattr(Document, "objects", counted)
    assert len(loaded(model.glb(), "glb")) == 3 * count
    assert looked_at["all"] < 10 * count


class Compared(str):
    """Text that counts how often it is compared."""

    __hash__ = str.__hash__
    count = 0

    def __eq__(self, other: object) -> bool:
        type(self).count += 1
        return str.__eq__(self, other)


def test_long_addresses_are_compared_once() -> None:
    address = "data:;base64," + "A" * 4000
    stated = [StatedBuffer(Compared(address), 3000, is_fallback=False) for _ in range(3)]
    buffers = Buffers(stated, None, "scene.gltf")
    assert all(bytes(buffers[number % 3]) == bytes(3000) for number in range(100))
    assert Compared.count < 10


def test_a_mesh_of_many_primitives_is_placed_as_a_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    count = 60
    model = Model()
    attributes = {"POSITION": model.accessor(TRIANGLE)}
    mesh = model.mesh(*[{"attributes": attributes}] * count)
    for place in range(count):
        model.node(mesh=mesh, translation=[place, 0, 0])
    calls = []
    monkeypatch.setattr(
        gltf_reader, "transformed", lambda *given: calls.append(given) or transformed(*given)
    )
    cloud = model.read()
    assert len(calls) == 2 * (count - 1)  # as glTF and as GLB; one stands in its place
    shifts = np.arange(count)[::-1, None, None] * np.array([1, 0, 0])
    assert np.array_equal(
        cloud.points.reshape(count, -1, 3), np.tile(TRIANGLE, (count, 1)) + shifts
    )
    assert np.array_equal(np.ravel(cloud.faces), np.arange(3 * count**2))


@pytest.mark.parametrize("mirror", [1, -1])
def test_meshes_of_every_mix_stand_where_each_primitive_alone_would(mirror: int) -> None:
    def build(*, split: bool) -> Model:
        model = Model()
        up = model.accessor(np.array([[0, 0, 1]] * 3, dtype="<f4"))
        red = model.accessor(np.array([[255, 0, 0, 255]] * 3, dtype="<u1"), normalized=True)
        parts = [
            {"attributes": {"POSITION": model.accessor(TRIANGLE + shift), "NORMAL": up,
                            "COLOR_0": red}, "mode": mode}
            for shift, mode in ((np.float32(0), 4), (np.float32(9), 0), (np.float32(5), 6))
        ]  # fmt: skip
        other = {"attributes": {**parts[0]["attributes"]}}
        groups = [[part] for part in parts] if split else [parts]
        for matrix in (None, [0, 2, 0, 0, -3 * mirror, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1], None):
            place = {} if matrix is None else {"matrix": matrix}
            for group in groups[::-1]:  # a scene is read from its end
                model.node(mesh=model.mesh(*group), **place)
            model.node(mesh=model.mesh(other), scale=[1, 2, mirror])
        return model

    apart, joined = build(split=True).read(), build(split=False).read()
    assert joined.points.tolist() == apart.points.tolist()
    assert np.array_equal(joined.normals, apart.normals)
    assert np.array_equal(joined.colors, apart.colors)
    assert faces(joined) == faces(apart)
