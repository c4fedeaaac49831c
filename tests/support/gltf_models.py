"""glTF files of any parts, put together for tests."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from files import gltf

import liftmesh
from liftmesh import Cloud, FormatError

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype="<f4")
TRIANGLE = np.array([[5, 5, 0], [6, 5, 0], [5, 6, 0]], dtype="<f4")


class Model(gltf.Model):
    """A model that is read in both forms."""

    def read(self, **options: Any) -> Cloud:
        """Read, as both, in the scene's own axes unless others are given."""
        options = {"up": "z", **options}
        one = liftmesh.read(io.BytesIO(self.gltf()), format="gltf", **options)
        other = liftmesh.read(io.BytesIO(self.glb()), format="glb", **options)
        assert one.points.tobytes() == other.points.tobytes()
        assert {**one.metadata, "format": "glb"} == other.metadata
        return one

    def refused(self, cause: str, **options: Any) -> None:
        for data, kind in ((self.gltf(), "gltf"), (self.glb(), "glb")):
            with pytest.raises(FormatError, match=cause):
                liftmesh.read(io.BytesIO(data), format=kind, **options)


def shape(mode: int, rows: np.ndarray = SQUARE, **node: Any) -> Model:
    """Make a model of a mesh of some mode and a triangle beside it."""
    model = Model()
    model.node(mesh=model.mesh({"attributes": {"POSITION": model.accessor(TRIANGLE)}}))
    part = {"attributes": {"POSITION": model.accessor(rows)}, "mode": mode}
    model.node(mesh=model.mesh(part), **node)
    return model


def faces(cloud: Cloud) -> list[list[int]]:
    return [] if cloud.faces is None else cloud.faces.tolist()
