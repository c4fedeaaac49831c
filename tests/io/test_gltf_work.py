"""GLB and glTF: the work to read a scene is in proportion to its parts, not to their products."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from file_samples import loaded
from gltf_models import TRIANGLE, Model

from liftmesh.io.gltf_validation import Document


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
