"""`liftmesh volume` of one surface: what is printed with polygons, and without."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from commands import liftmesh as run

import liftmesh


def test_the_area_of_the_surface_is_that_of_all_its_faces(tmp_path: Path) -> None:
    liftmesh.triangulate([[0, 0, 0], [2, 0, 0], [0, 2, 2], [2, 2, 2]]).save(tmp_path / "ramp.ply")
    square = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]]}
    (tmp_path / "part.geojson").write_text(json.dumps(square))
    words = ("volume", "ramp.ply", "--level", "1")
    inside = ("volume", "ramp.ply", "--within", "part.geojson", "--json")  # above 0
    whole = json.loads(run(*words, "--json", cwd=tmp_path).stdout)
    assert whole["surface_area"] == pytest.approx(4 * 2**0.5)
    assert (whole["above"], whole["below"]) == pytest.approx((1, 1))
    assert "polygons" not in whole
    part = json.loads(run(*inside, cwd=tmp_path).stdout)
    assert "surface_area" not in part
    assert [each["above"] for each in part["polygons"]] == [part["above"]] == [0.5]
    assert "surface area  5.65685" in run(*words, cwd=tmp_path).stdout
