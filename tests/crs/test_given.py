"""Coordinate systems that callers give: whatever pyproj takes, but no text that names files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import pytest
import rasterio.crs

import liftmesh
from liftmesh import InputError

ROWS = b"500000 5300000 1\n500001 5300000 2\n500000 5300001 3\n"
SAME: list[Any] = [
    "EPSG:25832",
    25832,
    np.int64(25832),
    ("EPSG", "25832"),
    pyproj.CRS(25832),
    pyproj.CRS(25832).to_json_dict(),
    rasterio.crs.CRS.from_epsg(25832),
    "ETRS89 / UTM zone 32N",
]


def read(**options: Any) -> liftmesh.Cloud:
    return liftmesh.read(io.BytesIO(ROWS), format="xyz", **options)


@pytest.mark.parametrize("crs", SAME, ids=repr)
def test_what_pyproj_takes_is_a_system(crs: Any) -> None:
    wanted = pyproj.CRS(25832)
    found = read(src_crs=crs)
    assert found.crs is not None
    assert pyproj.CRS(found.crs) == wanted
    (chunk,) = liftmesh.read_chunks(io.BytesIO(ROWS), format="xyz", src_crs=crs)
    assert chunk.crs == found.crs
    surface = liftmesh.triangulate(found.points, crs=crs)
    assert surface.crs == found.crs
    assert surface.replace(crs=25833).replace(crs=crs).crs == found.crs
    assert liftmesh.simplify(found.points, max_error=0, crs=crs).crs == found.crs
    moved = read(src_crs="EPSG:25833", dst_crs=crs)
    expected = pyproj.Transformer.from_crs(25833, 25832, always_xy=True)
    x, y = expected.transform(*found.points.T[:2])
    assert np.allclose(moved.points[:, :2], np.column_stack([x, y]), atol=1e-6)


def test_surfaces_in_tiles_and_simplified_ones_are_in_the_given_system(tmp_path: Path) -> None:
    points = read().points
    tiled = liftmesh.tile_surface(points, tmp_path / "out", crs=25832)
    assert tiled.crs == "EPSG:25832"
    surface = liftmesh.triangulate(points, crs="EPSG:25833")
    assert liftmesh.simplify(surface, max_error=0, crs=pyproj.CRS(25832)).crs == "EPSG:25832"
    assert liftmesh.simplify(surface, max_error=0).crs == "EPSG:25833"
    assert surface.replace(crs=None).crs is None
    with pytest.raises(InputError, match="crs"):
        liftmesh.tile_surface(points, tmp_path / "other", crs=3.5)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="crs"):
        surface.replace(crs=3.5)


def test_strings_of_proj_without_files() -> None:
    found = read(src_crs="+proj=utm +zone=32 +datum=WGS84")
    assert found.crs is not None
    assert "UTM zone 32N" in pyproj.CRS(found.crs).to_wkt()


@pytest.mark.parametrize(
    "crs",
    [
        "nonsense",
        "+init=/etc/hosts:1",
        "+proj=longlat +nadgrids=@a.gsb",
        "/etc/hosts",
        "@hosts",
        '{"type": "GeographicCRS"}',
        "+proj=pipeline +step +proj=utm",
        3.5,
        object(),
        [1, 2],
        "",
    ],
    ids=lambda crs: "object" if type(crs) is object else repr(crs),
)
def test_others_are_refused(crs: Any) -> None:
    for options in ({"src_crs": crs}, {"src_crs": "EPSG:25832", "dst_crs": crs}):
        with pytest.raises(InputError, match=r"(src|dst)_crs"):
            read(**options)


def test_no_text_of_a_file_is_taken_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    real = pyproj.CRS.from_user_input
    monkeypatch.setattr(
        pyproj.CRS, "from_user_input", lambda text: asked.append(text) or real(text)
    )
    points = liftmesh.Cloud(np.zeros((1, 3)), crs="+proj=utm +zone=32")
    liftmesh.write(tmp_path / "a.ply", points)
    assert liftmesh.read(tmp_path / "a.ply").crs == "+proj=utm +zone=32"
    with pytest.raises(InputError):
        liftmesh.read(tmp_path / "a.ply", dst_crs="EPSG:25832")
    assert "+proj=utm +zone=32" not in asked
