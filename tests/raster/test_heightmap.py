"""Heightmaps of engines: 16 bits from the lowest height to the highest, in PNG or bare."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import rasterio
from commands import liftmesh as command
from PIL import Image

import liftmesh
from liftmesh import FormatError, InputError
from liftmesh.raster.heightmap import SIZES, suits_engines
from liftmesh.raster.raster import Raster

SLOPE = [[0, 0, 10], [8, 0, 30], [0, 8, 10], [8, 8, 30]]  # from 10 in the west to 30 in the east
PLACE = (1.0, 0.0, 0.0, 0.0, -1.0, 3.0)


def raster(values: object) -> Raster:
    return Raster(np.array(values, dtype=np.float64), PLACE)


def samples(path: Path) -> np.ndarray:
    """The samples of a file, by other programs than the writer."""
    if path.suffix == ".png":
        return np.asarray(Image.open(path))
    flat = np.frombuffer(path.read_bytes(), "<u2")
    side = int(len(flat) ** 0.5)
    return flat.reshape(side, side)


@pytest.mark.parametrize("suffix", [".png", ".r16", ".PNG"])
def test_heights_are_spread_over_16_bits(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    heights = np.array([[3.0, 3.5], [4.25, 7.0]])
    written = raster(heights).save(path)
    assert (written.format, written.scaling) == ("heightmap", (4 / 65535, 3.0))
    found = samples(path.with_suffix(suffix)) if suffix != ".PNG" else np.asarray(Image.open(path))
    assert found.dtype == np.uint16
    assert found.tolist() == [[0, 8192], [20480, 65535]]
    scale, offset = written.scaling
    assert np.abs(found * scale + offset - heights).max() <= scale / 2
    if suffix == ".png":
        said = Image.open(path).text["Description"]
        assert said == f"height = {scale!r} * value + {offset!r}; pixels of 1.0 x 1.0"
    beside = [tmp_path / "a.r16.json"] if suffix == ".r16" else []
    assert sorted(tmp_path.iterdir()) == [path, *beside]


def test_bare_samples_are_described_beside(tmp_path: Path) -> None:
    place = (2.0, 0.0, 500_000.0, 0.0, -3.0, 5_300_000.0)
    values = np.array([[3.0, 3.5, 5.0], [4.25, 7.0, 4.0]])
    written = Raster(values, place, crs="EPSG:25832", unit="metre").save(tmp_path / "a.r16")
    said = json.loads((tmp_path / "a.r16.json").read_text())
    assert said == {
        "columns": 3, "rows": 2, "type": "uint16", "byte_order": "little", "scale": 4 / 65535,
        "offset": 3.0, "pixel_size": [2.0, 3.0], "transform": [*place], "unit": "metre",
        "crs": "EPSG:25832",
    }  # fmt: skip
    assert written.scaling == (said["scale"], said["offset"])
    flat = np.fromfile(tmp_path / "a.r16", "<u2").reshape(said["rows"], said["columns"])
    assert np.abs(flat * said["scale"] + said["offset"] - values).max() <= said["scale"] / 2


def test_neither_of_both_files_is_left_by_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "no space left")

    (tmp_path / "a.r16.json").symlink_to(tmp_path / "elsewhere")
    monkeypatch.setattr(np, "ascontiguousarray", fail)
    with pytest.raises(OSError, match="no space left"):
        raster([[1.0, 2.0]]).save(tmp_path / "a.r16")
    assert [each.name for each in tmp_path.iterdir()] == ["a.r16.json"]
    monkeypatch.undo()
    raster([[1.0, 2.0]]).save(tmp_path / "a.r16")  # its own name is no link that one follows
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.r16", "a.r16.json"]


def test_flat_and_extreme_heights(tmp_path: Path) -> None:
    path = tmp_path / "a.r16"
    assert raster([[5.0, 5.0], [5.0, 5.0]]).save(path).scaling == (1.0, 5.0)
    assert samples(path).tolist() == [[0, 0], [0, 0]]
    assert raster([[0.0, 5e-324], [0.0, 0.0]]).save(path).scaling == (1.0, 0.0)
    raster([[1e300, 0], [1, 2]]).save(path)
    assert samples(path).tolist() == [[65535, 0], [0, 0]]
    for beyond in (-1.7e308, np.inf):
        with pytest.raises(InputError, match="beyond what a heightmap can hold"):
            raster([[1.7e308, beyond], [0, 0]]).save(path)


def test_voids_are_refused_or_filled(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    holed = raster([[3.0, np.nan], [4, 7]])
    with pytest.raises(InputError, match="1 of 4 pixels have no value, the first in row 0, column"):
        holed.save(path)
    assert not path.exists()
    holed.save(path, voids="lowest")
    assert samples(path).tolist() == [[0, 0], [16384, 65535]]
    with pytest.raises(InputError, match="no pixel has a value"):
        raster([[np.nan]]).save(path, voids="lowest")
    with pytest.raises(InputError, match="voids is 'zero'"):
        holed.save(path, voids="zero")
    with pytest.raises(FormatError, match="rasters are written as GeoTIFF"):
        holed.save(tmp_path / "a.jpg")


def test_the_command_makes_what_engines_take(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.ply", liftmesh.triangulate(SLOPE))
    done = command("raster", "a.ply", "a.png", "--size", "127", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    said = json.loads(done.stdout)
    found = samples(tmp_path / "a.png")
    assert found.shape == (127, 127)
    assert (said["n_rows"], said["n_known"]) == (127, 127 * 127)
    east = 8 / 127 * (np.arange(127) + 0.5)
    heights = found * said["scale"] + said["offset"]
    assert np.abs(heights - (10 + 20 * east / 8)).max() < said["scale"]
    done = command("raster", "a.ply", "a.r16", "--resolution", "1", cwd=tmp_path)
    assert "8 x 8 pixels of height, 64 with a value, 1 x 1 each: height = 0.000267" in done.stdout
    assert "Unreal takes 127, 253" in done.stderr


def test_the_sizes_that_engines_take() -> None:
    named = {int(each) for each in re.findall(r"\d+", SIZES)}
    taken = {size for size in range(10_000) if suits_engines(size)}
    assert taken == named | {129, 257, 513, 1025, 2049}  # so on


def test_a_square_in_the_middle_or_bounds(tmp_path: Path) -> None:
    wide = np.array(SLOPE) * [3, 1, 1]
    liftmesh.write(tmp_path / "a.ply", liftmesh.triangulate(wide))
    command("raster", "a.ply", "a.tif", "--size", "4", cwd=tmp_path)
    with rasterio.open(tmp_path / "a.tif") as file:
        assert (tuple(file.bounds), file.shape) == ((8, 0, 16, 8), (4, 4))
    words = ("raster", "a.ply", "b.png", "--size", "4", "--raster-bounds")
    done = command(*words, "-4,0,12,8", cwd=tmp_path)
    assert (done.returncode, (tmp_path / "b.png").exists()) == (3, False)
    assert "4 of 16 pixels have no value" in done.stderr
    assert "--voids lowest to fill them" in done.stderr
    done = command(*words, "-4,0,12,8", "--voids", "lowest", cwd=tmp_path)
    assert samples(tmp_path / "b.png")[0].tolist() in ([0, 0, k, 65535] for k in (32767, 32768))


@pytest.mark.parametrize(
    ("words", "cause"),
    [
        ((), "give either --resolution or --size"),
        (("--size", "4", "--resolution", "1"), "give either --resolution or --size"),
        (("--size", "0"), "--size"),
    ],
)
def test_sizes_that_are_none(words: tuple[str, ...], cause: str, tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.ply", liftmesh.triangulate(SLOPE))
    done = command("raster", "a.ply", "a.png", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert cause in done.stderr
