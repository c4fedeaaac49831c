"""Rasters: each sample that has a value becomes a row, at the centre of its pixel."""

from __future__ import annotations

import io
import re
import tracemalloc
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from commands import liftmesh
from file_samples import assert_same_bits
from files.geotiff import HEIGHTS, NORTH_UP, geotiff, read
from rasterio.transform import Affine

import liftmesh as lm
from liftmesh import FormatError, InputError


@pytest.mark.parametrize(
    "dtype", ["uint8", "int16", "uint16", "int32", "uint32", "int64", "float32", "float64"]
)
def test_samples_keep_their_values(dtype: str) -> None:
    values = HEIGHTS.astype(dtype)
    cloud = read(geotiff(values, crs="EPSG:25832"))
    assert_same_bits(cloud.points[:, 2], values.ravel().astype(np.float64))
    assert cloud.points[0].tolist() == [500001.0, 5399999.0, float(values[0, 0])]
    assert cloud.points[-1, :2].tolist() == [500007.0, 5399995.0]
    assert "25832" in (cloud.crs or "")
    assert cloud.metadata["raster"] == {
        "width": 4, "height": 3, "transform": [2.0, 0.0, 500000.0, 0.0, -2.0, 5400000.0],
        "band": 1,
    }  # fmt: skip


def test_rotated_transforms() -> None:
    a, b, c, d, e, f = numbers = (1.7, 1.0, 500000.0, 1.0, -1.7, 5400000.0)
    cloud = read(geotiff(transform=Affine(*numbers)))
    centres = [(column + 0.5, row + 0.5) for row in range(3) for column in range(4)]
    expected = [(a * x + b * y + c, d * x + e * y + f) for x, y in centres]
    assert np.allclose(cloud.points[:, :2], expected, rtol=0, atol=1e-9)


def test_pixels_that_are_points() -> None:
    area = read(geotiff())
    point = read(geotiff(tags={"AREA_OR_POINT": "Point"}))
    assert np.array_equal(area.points, point.points)  # GDAL writes another corner for these


def test_without_a_transform_the_first_row_is_north() -> None:
    cloud = read(placed_nowhere())
    assert cloud.points[0].tolist() == [0.5, 2.5, 100.0]
    assert cloud.points[-1, :2].tolist() == [3.5, 0.5]
    assert cloud.metadata["notes"] == (
        "no transform: pixels have the size 1, the first row is north",
    )


def placed_nowhere() -> bytes:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return geotiff(transform=None)


def test_world_and_prj_files(tmp_path: Path) -> None:
    (tmp_path / "a.tif").write_bytes(placed_nowhere())
    (tmp_path / "a.tfw").write_text("2.0\n0.0\n0.0\n-2.0\n500001.0\n5399999.0\n")
    (tmp_path / "a.prj").write_text('PROJCS["ETRS89",GEOGCS["b"],UNIT["Meter",1.0]]')
    cloud = lm.read(tmp_path / "a.tif")
    assert_same_bits(cloud.points, read(geotiff()).points)
    assert cloud.metadata["raster"]["transform"] == [*NORTH_UP][:6]
    assert cloud.metadata["notes"] == ("no transform but that of a.tfw beside it",)
    assert cloud.crs == 'PROJCS["ETRS89",GEOGCS["b"],UNIT["Meter",1.0]]'
    with rasterio.open(tmp_path / "a.tif") as file:  # which looks at the world file as well
        assert [*file.transform] == [*NORTH_UP]
    with (tmp_path / "a.tif").open("rb") as stream:
        assert_same_bits(lm.read(stream).points, cloud.points)
    for wrong in ("1 0 0 x 5 5", "1 0 0 -1 5", "0 0 0 0 5 5", "1 0 0 nan 5 5"):
        (tmp_path / "a.tfw").write_text(wrong)
        with pytest.raises(FormatError, match=r"a\.tfw: a world file has six numbers"):
            lm.read(tmp_path / "a.tif")


NODATA = {"-9999": -9999.0, "NaN": np.nan, "-1.7e308": -1.7e308}


@pytest.mark.parametrize("mark", NODATA)
def test_samples_without_a_value_are_left_out(mark: str) -> None:
    values = HEIGHTS.copy()
    values[1, 1:3] = NODATA[mark]
    cloud = read(geotiff(values, nodata=NODATA[mark]))
    assert len(cloud) == 10
    assert cloud.metadata["not_read"] == ("2 samples without a value",)
    assert_same_bits(cloud.points[:, 2], np.delete(values.ravel(), [5, 6]))


MARKS = {
    "-9999": "float32", "-32768": "int16", "-3.4028235e38": "float32", "3.4028235e38": "float32",
    "-1.7976931348623157e308": "float64",
}  # fmt: skip


@pytest.mark.parametrize("mark", MARKS)
def test_what_may_stand_for_a_missing_value_is_refused(mark: str) -> None:
    values = np.arange(12).reshape(3, 4).astype(MARKS[mark])
    values[1, 1:3] = values.dtype.type(float(mark))
    data = geotiff(values)
    with pytest.raises(
        FormatError, match=r"<stream>: band 1 is .* in 2 of 12 samples, far"
    ) as told:
        read(data)
    given = re.search(r"read it with nodata='(.*?)' if it is missing", str(told.value))
    assert given is not None
    for nodata in (given[1], mark, float(mark)):
        cloud = read(data, nodata=nodata)
        assert cloud.points[:, 2].tolist() == [0, 1, 2, 3, 4, 7, 8, 9, 10, 11]
        assert cloud.metadata["not_read"] == ("2 samples without a value",)
    assert len(read(data, nodata="none")) == 12
    alone = geotiff(values[1:2, 1:3])
    with pytest.raises(FormatError, match="in 2 of 2 samples, a value or the mark of a missing"):
        read(alone)
    with pytest.raises(FormatError, match="none of 2 samples has a value"):
        read(alone, nodata=mark)
    with pytest.raises(InputError, match="nodata is 'void': give the number that stands for"):
        read(data, nodata="void")


def test_values_among_others_are_no_marks() -> None:
    values = np.linspace(-10500, 0, 12).reshape(3, 4)
    values[0, 1] = -9999
    assert len(read(geotiff(values))) == 12
    scaled = np.arange(12, dtype=np.int16).reshape(3, 4)
    scaled[0, 0] = -9999
    with pytest.raises(FormatError, match="band 1 is -9999 in 1 of 12 samples"):
        read(geotiff(scaled, scales=(0.1,), offsets=(50.0,)))
    assert len(read(geotiff(scaled, scales=(0.1,)), nodata=-9999)) == 11


def test_the_command_names_and_takes_nodata(tmp_path: Path) -> None:
    values = HEIGHTS.copy()
    values[0, 0] = -9999
    (tmp_path / "a.tif").write_bytes(geotiff(values))
    done = liftmesh("triangulate", "a.tif", "a.ply", cwd=tmp_path)
    assert done.returncode == 3
    assert (
        "read it with --nodata -9999 if it is missing there, or with --nodata none" in done.stderr
    )
    assert (
        liftmesh("triangulate", "a.tif", "a.ply", "--nodata", "-9999", cwd=tmp_path).returncode == 0
    )
    assert len(lm.read(tmp_path / "a.ply")) == 11


def test_masks_and_nan_without_a_mark() -> None:
    mask = np.full((3, 4), 255, np.uint8)
    mask[0, 0] = 0
    assert len(read(geotiff(mask=mask))) == 11
    values = HEIGHTS.copy()
    values[2, 3] = np.nan
    assert len(read(geotiff(values))) == 11


def test_scale_and_offset() -> None:
    values = np.arange(12, dtype=np.int16).reshape(3, 4)
    values[0, 0] = -9999
    cloud = read(geotiff(values, nodata=-9999, scales=(0.1,), offsets=(50.0,)))
    assert_same_bits(cloud.points[:, 2], np.arange(1, 12) * 0.1 + 50.0)


def test_the_unit_of_a_band_is_said(tmp_path: Path) -> None:
    cloud = read(geotiff(units=("US survey foot",), crs="EPSG:26910"))
    assert cloud.metadata["raster"]["unit"] == "US survey foot"
    assert cloud.metadata["notes"] == ("band 1 says that heights are in US survey foot",)
    (tmp_path / "a.tif").write_bytes(geotiff(units=("ft",)))
    done = liftmesh("triangulate", "a.tif", "a.ply", cwd=tmp_path)
    assert "a.tif: band 1 says that heights are in ft" in done.stderr
    (tmp_path / "a.tif").write_bytes(geotiff(units=("ft",), crs="EPSG:25832"))
    done = liftmesh("info", "a.tif", cwd=tmp_path)
    assert "units       x: metre, y: metre, z: foot\n" in done.stdout
    assert "the units differ: x is in metre, y in metre, z in foot" in done.stderr


def test_bands() -> None:
    data = geotiff(np.stack([HEIGHTS, HEIGHTS + 1, HEIGHTS + 2]))
    cloud = read(data)
    assert cloud.metadata["not_read"] == ("band 2, 3",)
    assert read(data, band=3).points[0, 2] == 102
    with pytest.raises(FormatError, match="<stream>: there is no band 4: give one from 1 to 3"):
        read(data, band=4)
    with pytest.raises(InputError, match="band is 0: give a whole number from 1"):
        read(data, band=0)


def test_part_of_a_raster() -> None:
    values = np.arange(600.0).reshape(20, 30)
    data = geotiff(values)
    whole = read(data)
    steps = read(data, every=7)
    assert_same_bits(steps.points[:, 2], values[::7, ::7].ravel())
    assert steps.metadata["selection"] == {"rows": 600, "selected": 15, "every": 585}
    assert len(read(data, every=10**30)) == 1
    box = (500010.0, 5399970.0, 500031.0, 5399991.0)
    inside = (whole.points[:, :2] >= box[:2]).all(1) & (whole.points[:, :2] <= box[2:]).all(1)
    assert_same_bits(read(data, bounds=box).points, whole.points[inside])
    assert len(read(data, z_range=(0, 9))) == 10
    chunks = [*lm.read_chunks(io.BytesIO(data), rows=4, format="tif", every=7)]
    assert [len(each) for each in chunks] == [4, 4, 4, 3]
    assert_same_bits(np.concatenate([each.points for each in chunks]), steps.points)
    assert chunks[0].metadata["selection"] == steps.metadata["selection"]
    chunks = [*lm.read_chunks(io.BytesIO(data), rows=70, format="tif")]
    assert_same_bits(np.concatenate([each.points for each in chunks]), whole.points)
    with pytest.raises(FormatError, match="cannot be selected by class: there is no class"):
        read(data, classes=2)


PLACES = {
    "north up": NORTH_UP,
    "south up": Affine(0.1, 0.0, 450000.3, 0.0, 0.1, 5200000.7),
    "flipped": Affine(-3.0, 0.0, 9.0, 0.0, -1 / 3, 7.0),
    "rotated": Affine(1.7, 1.0, 500000.0, 1.0, -1.7, 5400000.0),
    "nowhere": None,
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("block", [{}, {"blockysize": 1}, {"tiled": True}], ids=str)
def test_windows_hold_what_all_samples_in_the_box_do(place: str, block: dict[str, Any]) -> None:
    rng = np.random.default_rng(5)
    values = rng.random((70, 90))
    size = {"blockxsize": 16, "blockysize": 32} if block.get("tiled") else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = geotiff(values, transform=PLACES[place], **block, **size)
    whole = read(data).points
    lattice = np.arange(values.size).reshape(values.shape)
    for every in (1, 2, 7, 40):
        rows = lattice[::every, ::every].ravel()
        for corners in rng.choice(whole[:, :2], (4, 2)):  # centres of pixels: the border counts
            box = (*corners.min(0), *corners.max(0))
            inside = ((whole[rows, :2] >= box[:2]) & (whole[rows, :2] <= box[2:])).all(1)
            found = read(data, bounds=box, every=every)
            assert_same_bits(found.points, whole[rows][inside])
            counts = found.metadata["selection"]
            assert counts["rows"] == values.size
            assert counts["selected"] + counts.get("bounds", 0) + counts.get("every", 0) == 6300
    assert len(read(data, bounds=(-np.inf, -np.inf, np.inf, np.inf))) == 6300
    assert len(read(data, bounds=(1e9, 1e9, 2e9, 2e9))) == 0


@pytest.mark.parametrize("options", [{"bounds": (10, 10, 20, 20)}, {"every": 50}])
@pytest.mark.parametrize("kind", ["tif", "raster"])
def test_a_part_takes_no_memory_for_the_rest(kind: str, options: dict[str, Any]) -> None:
    heights = np.random.default_rng(4).random((600, 600))
    placed = Affine(1, 0, 0, 0, -1, 600)
    data = geotiff(heights, transform=placed, tiled=True, blockxsize=128, blockysize=128)
    if kind == "raster":
        rows = "\n".join(" ".join(map(repr, row)) for row in heights.tolist())
        head = "ncols 600\nnrows 600\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
        data = (head + rows).encode()
    peaks = []
    for chosen in (options, {}):
        tracemalloc.start()
        read(data, kind, **chosen)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[0] < 1.5 * len(data)
    assert peaks[1] > 24 * heights.size


def test_damage_outside_of_the_window_is_not_decoded() -> None:
    values = np.random.default_rng(1).random((6400, 16))
    data = geotiff(values, compress="deflate", blockysize=1)
    with rasterio.MemoryFile(data) as memory, memory.open() as file:
        begin = int(file.get_tag_item("BLOCK_OFFSET_0_3200", "TIFF", bidx=1))
    broken = data[:begin] + bytes(9) + data[begin + 9 :]
    with pytest.raises(FormatError, match=r"row 3,200, column 0|cannot be decoded"):
        read(broken)
    north = (0, NORTH_UP.f - 2 * 3200.0, 1e9, 1e9)
    assert_same_bits(read(broken, bounds=north).points[:, 2], values[:3200].ravel())


def test_what_lies_between_every_kth_sample_is_not_decoded() -> None:
    values = np.random.default_rng(1).random((2000, 1000))
    data = geotiff(values, compress="deflate", blockysize=1)
    with rasterio.MemoryFile(data) as memory, memory.open() as file:
        begin = int(file.get_tag_item("BLOCK_OFFSET_0_1001", "TIFF", bidx=1))
    broken = data[:begin] + bytes(200) + data[begin + 200 :]
    assert_same_bits(read(broken, every=40).points[:, 2], values[::40, ::40].ravel())


def test_a_raster_becomes_a_surface(tmp_path: Path) -> None:
    (tmp_path / "a.tif").write_bytes(geotiff(crs="EPSG:25832"))
    done = liftmesh("triangulate", "a.tif", "a.ply", cwd=tmp_path)
    assert done.returncode == 0
    assert "12 vertices, 12 triangles" in done.stdout
    assert "metre" in liftmesh("info", "a.tif", cwd=tmp_path).stdout
    (tmp_path / "b.tif").write_bytes(geotiff(np.stack([HEIGHTS, HEIGHTS + 50])))
    liftmesh("triangulate", "b.tif", "b.ply", "--band", "2", cwd=tmp_path)
    heights = lm.read(tmp_path / "b.ply").points[:, 2]
    assert np.array_equal(heights, lm.read(tmp_path / "b.tif", band=2).points[:, 2])
    done = liftmesh("triangulate", "a.ply", "c.ply", "--band", "2", cwd=tmp_path)
    assert "a.ply: --band cannot be given: ply files are read without options" in done.stderr


BROKEN = {
    "nothing but a beginning": (b"II*\0" + bytes(100), "the raster cannot be decoded"),
    "another file": (b"ply\n", "neither a TIFF file nor an ASCII grid"),
    "all nodata": (geotiff(np.full((3, 4), 7.0), nodata=7), "none of 12 samples has a value"),
    "complex numbers": (geotiff(HEIGHTS.astype(complex)), "band 1 holds complex128, not heights"),
    "cut off": (
        geotiff(np.random.default_rng(1).random((99, 99)))[:40_000],
        "cannot be decoded, truncated",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_no_raster_of_heights(case: str) -> None:
    data, cause = BROKEN[case]
    with pytest.raises(FormatError, match=f"^<stream>: .*{cause}") as caught:
        read(data)
    assert "vsimem" not in str(caught.value)


def test_sparse_rasters_are_limited() -> None:
    data = geotiff(np.zeros((4, 4)), transform=NORTH_UP)
    with rasterio.MemoryFile() as memory:
        with memory.open(
            driver="GTiff", count=1, height=10**5, width=10**5, dtype="uint8", tiled=True,
            transform=NORTH_UP, SPARSE_OK=True, compress="deflate", blockxsize=4096,
            blockysize=4096,
        ):  # fmt: skip
            pass
        sparse = bytes(memory.getbuffer())
    assert len(sparse) < 10**5
    with pytest.raises(FormatError, match="100,000 x 100,000 samples expands to 250,4"):
        read(sparse)
    with pytest.raises(FormatError, match="160,000 samples of a raster of 100,000 x 100,000"):
        read(sparse, every=250, max_bytes=10**7)
    some = read(sparse, every=50_000)  # GDAL fills what is sparse with zeros
    assert some.points.tolist() == [
        [NORTH_UP.c + 2 * (c + 0.5), NORTH_UP.f - 2 * (r + 0.5), 0]
        for r in (0, 50_000) for c in (0, 50_000)
    ]  # fmt: skip
    with pytest.raises(FormatError, match="with max_bytes="):
        read(data, max_bytes=100)
    assert len(read(data, max_bytes=10**6)) == 16


def test_nothing_beside_a_raster_is_opened(tmp_path: Path) -> None:
    (tmp_path / "a.tif").write_bytes(geotiff())
    (tmp_path / "a.tif.aux.xml").write_text(
        "<PAMDataset><PAMRasterBand band='1'><NoDataValue>100</NoDataValue></PAMRasterBand>"
        "</PAMDataset>"
    )
    (tmp_path / "a.tfw").write_text("9\n0\n0\n-9\n0\n0\n")
    (tmp_path / "a.prj").write_text('PROJCS["other",UNIT["metre",1]]')
    data = geotiff(crs="EPSG:25832")
    (tmp_path / "a.tif").write_bytes(data)
    found = lm.read(tmp_path / "a.tif")
    assert_same_bits(found.points, read(data).points)
    assert "25832" in (found.crs or "")
    with pytest.raises(FormatError, match="neither a TIFF file"):
        read(b"<VRTDataset rasterXSize='4' rasterYSize='3'></VRTDataset>")


def test_the_hint_without_rasterio(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "rasterio", None)
    with pytest.raises(lm.MissingDependencyError, match=r"pip install 'liftmesh\[terrain\]'"):
        read(geotiff())
