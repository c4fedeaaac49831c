"""Orthophotos over meshes in GLB and glTF: which pixel each vertex gets, and what is refused."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
import trimesh
from rasterio.transform import Affine

import liftmesh
from liftmesh import Cloud, DataWarning, FormatError, InputError

PLACE = Affine(0.5, 0, 450000, 0, -0.5, 5200010)  # 40 x 20 pixels: 20 wide, 10 high
PIXELS = np.random.default_rng(4).integers(0, 256, (3, 20, 40), dtype=np.uint8)
CORNERS = np.array([[0, 0, 1], [20, 0, 2], [0, 10, 3], [20, 10, 4], [5.25, 7.75, 5]])
MESH = liftmesh.triangulate(CORNERS + np.array([450000, 5200000, 0]), crs="EPSG:25832")


def ortho(path: Path, pixels: np.ndarray = PIXELS, **profile: Any) -> Path:
    """Write an image as GeoTIFF."""
    profile = {"crs": "EPSG:25832", "transform": PLACE, "driver": "GTiff", **profile}
    bands, rows, columns = pixels.shape
    size = {"count": bands, "height": rows, "width": columns, "dtype": pixels.dtype}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        with rasterio.open(path, "w", **size, **profile) as file:
            file.write(pixels)
    return path


def painted(path: Path, kind: str = "glb") -> trimesh.Trimesh:
    stream = io.BytesIO()
    liftmesh.write(stream, MESH, format=kind, texture=path)
    scene = trimesh.load_scene(io.BytesIO(stream.getvalue()), file_type=kind, process=False)
    (mesh,) = scene.geometry.values()
    return mesh


@pytest.mark.parametrize("kind", ["glb", "gltf"])
@pytest.mark.parametrize("bands", [1, 3])
def test_each_vertex_lies_on_its_pixel(kind: str, bands: int, tmp_path: Path) -> None:
    mesh = painted(ortho(tmp_path / "o.tif", PIXELS[:bands]), kind)
    image = np.asarray(mesh.visual.material.baseColorTexture.convert("RGB"))
    assert np.array_equal(image[..., 0], PIXELS[0])
    # trimesh counts v from below, glTF from above. (5.25, 7.75) is the middle of a pixel.
    row = int(np.argmax(np.isclose(mesh.visual.uv[:, 0], 5.25 / 20)))
    assert mesh.visual.uv[row].tolist() == [np.float32(10.5 / 40), 1 - np.float32(4.5 / 20)]
    assert sorted(map(tuple, np.delete(mesh.visual.uv, row, 0))) == [(0, 0), (0, 1), (1, 0), (1, 1)]


def test_colours_give_way_to_the_image(tmp_path: Path) -> None:
    path = ortho(tmp_path / "o.tif", compress="deflate")
    colored = MESH.replace(colors=np.full((5, 3), 9, np.uint8))
    stream = io.BytesIO()
    written = liftmesh.write(stream, colored, format="glb", texture=str(path))
    assert written.dropped == ("colors",)
    back = liftmesh.read(io.BytesIO(stream.getvalue()), format="glb")
    assert back.points.tolist() == MESH.vertices.tolist()
    assert back.metadata["not_read"] == ("1 primitive with TEXCOORD_0",)


def test_rotated_images(tmp_path: Path) -> None:
    turned = Affine(0, 0.5, 450000, 0.5, 0, 5200000)  # columns to the north, rows to the east
    mesh = painted(ortho(tmp_path / "o.tif", PIXELS.transpose(0, 2, 1), transform=turned))
    assert sorted(mesh.visual.uv[:, 0].tolist())[2] == np.float32(7.75 / 10)


def test_vertices_outside_are_counted(tmp_path: Path) -> None:
    path = ortho(tmp_path / "o.tif", transform=Affine(0.5, 0, 450001, 0, -0.5, 5200010))
    with pytest.warns(DataWarning, match="2 of 5 vertices lie outside the image"):
        painted(path)


@pytest.mark.parametrize(
    ("pixels", "profile", "cause"),
    [
        (PIXELS[:2], {}, "2 bands of uint8: a texture has 1, 3 or 4 of uint8"),
        (PIXELS.astype(np.uint16), {}, "3 bands of uint16"),
        (PIXELS, {"nodata": int(PIXELS[0, 0, 0])}, "pixels have no value"),
        (PIXELS[:1], {"photometric": "palette"}, "a palette: gdal_translate -expand rgb"),
        (PIXELS, {"transform": Affine.identity()}, "does not say where its pixels are"),
        (np.zeros((1, 1, 20000), np.uint8), {}, "20,000 x 1 pixels: textures have at most 16,384"),
    ],
)
def test_images_that_are_no_textures(
    pixels: np.ndarray, profile: dict[str, Any], cause: str, tmp_path: Path
) -> None:
    if "nodata" in profile:
        pixels = np.repeat(pixels[:1], 3, axis=0)
    with pytest.raises(FormatError, match=cause):
        painted(ortho(tmp_path / "o.tif", pixels, **profile))


def test_what_else_is_refused(tmp_path: Path) -> None:
    path = ortho(tmp_path / "o.tif", crs="EPSG:25833")
    with pytest.raises(InputError, match="in another coordinate system than the mesh: warp it"):
        painted(path)
    (tmp_path / "o.png").write_bytes(b"\x89PNG")
    with pytest.raises(FormatError, match="not a TIFF file: a texture is a GeoTIFF"):
        painted(tmp_path / "o.png")
    with pytest.raises(FileNotFoundError):
        painted(tmp_path / "none.tif")
    (tmp_path / "cut.tif").write_bytes(path.read_bytes()[:100])
    with pytest.raises(FormatError, match="cannot be decoded, truncated or damaged"):
        painted(tmp_path / "cut.tif")
    with pytest.raises(InputError, match="texture is 3: give the path"):
        liftmesh.write(io.BytesIO(), MESH, format="glb", texture=3)
    with pytest.raises(InputError, match="points have no faces to show it"):
        liftmesh.write(io.BytesIO(), Cloud(CORNERS), format="glb", texture=path)
