"""No unit is said that nobody knows; what was transformed, how, and how finely it is kept."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from commands import liftmesh as command
from files.las import encoded, records

import liftmesh as lm
from liftmesh import Cloud, InputError
from liftmesh.crs.comparison import plane_of
from liftmesh.crs.transformation import (
    common_transformation,
    transform,
    transformation_text,
)
from liftmesh.io.metadata import Provenance

UTM = np.array([[500000.0, 5400000.0, 100.0], [500100, 5400000, 110], [500000, 5400100, 120]])
GAUSS = np.array([[3500000.0, 5400000.0, 100.0], [3500100, 5400000, 1], [3500000, 5400100, 2]])
NORTH = GAUSS + np.array([0.0, 350000.0, 0.0])
ROWS = b"300000 4600000 400\n300100 4600000 410\n300000 4600100 420\n"


def unit_in(path: Path) -> tuple[str | None, str | None]:
    with rasterio.open(path) as file:
        return file.units[0], str(file.crs)


@pytest.mark.parametrize("cog", [False, True])
@pytest.mark.parametrize(
    ("crs", "band", "height"),
    [
        ("EPSG:25832+7837", None, "metre"),
        ("EPSG:25832+8228", None, "foot"),
        ("EPSG:25832", None, None),
        ("EPSG:25832", "ft", "foot"),
        (None, "ft", "foot"),
        (None, None, None),
    ],
)
@pytest.mark.filterwarnings("ignore:the units differ")
def test_rasters_say_the_unit_of_their_values(
    crs: str | None, band: str | None, height: str | None, cog: bool, tmp_path: Path
) -> None:
    metadata = {} if band is None else {"raster": {"unit": band}}
    cloud = Cloud(UTM, crs=crs, metadata=metadata)
    surface, tiled = lm.triangulate(cloud), lm.tile_surface(cloud, tmp_path / "tiles")
    units = {"height": height, "slope": "degree", "aspect": "degree", "hillshade": None}
    plane = plane_of(crs)
    for quantity, unit in units.items():
        found = surface.raster(20, quantity=quantity)
        assert (found.unit, tiled.raster(20, quantity=quantity).unit) == (unit, unit)
        found.save(tmp_path / "a.tif", cog=cog)
        tiled.save_raster(tmp_path / "b.tif", 20, quantity=quantity, cog=cog)
        for name in ("a.tif", "b.tif"):
            assert unit_in(tmp_path / name)[0] == unit
            if quantity != "height":
                assert unit_in(tmp_path / name)[1] == str(plane)


@pytest.mark.parametrize(
    ("crs", "target"),
    [
        ("EPSG:26910", "EPSG:26910+5703"),
        ("EPSG:2263", "EPSG:26918+5703"),
        ("EPSG:4326", "EPSG:4979"),
    ],
)
def test_heights_of_no_stated_unit_get_none(crs: str, target: str) -> None:
    cause = r"states what heights are, but nothing says their unit in the file: .* with src_crs="
    rows = ROWS if crs != "EPSG:4326" else b"9 48 1\n"
    with pytest.raises(InputError, match=cause):
        lm.read(io.BytesIO(rows), format="xyz", src_crs=crs, dst_crs=target)


def test_the_command_refuses_cubic_metres_that_nobody_knows(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_bytes(ROWS)
    words = ("volume", "a.xyz", "--level", "400", "--dst-crs", "EPSG:26910+5703", "--src-crs")
    done = command(*words, "EPSG:26910", cwd=tmp_path)
    assert done.returncode == 3
    assert "name their system, too, with --src-crs, as 'EPSG:2263+6360'" in done.stderr
    done = command(*words, "EPSG:26910+6360", cwd=tmp_path)
    assert done.returncode == 0
    assert " m3" in done.stdout


def test_the_best_operation_is_taken_and_said() -> None:
    found, told = transform(GAUSS, "EPSG:31467", "EPSG:25832")
    assert "DHDN to ETRS89 (3)" in told["operation"]  # of the south, not the one of all Germany
    assert told["accuracy"] == 1.0
    assert told["grid"] == "de_lgl_bw_BWTA2017.tif"
    assert transformation_text(told).endswith(
        "needs the grid de_lgl_bw_BWTA2017.tif, which is not installed"
    )
    assert np.abs(found[:, :2] - GAUSS[:, :2] + (3000000, 0)).max() < 2000


def test_all_rows_of_a_file_are_transformed_alike_also_in_chunks() -> None:
    far = np.vstack([GAUSS, NORTH[:1]])  # where another operation is better
    data = encoded(records(far, 6, version="1.4", offset=(3500000, 5400000, 0)))
    options: dict[str, Any] = {"format": "las", "src_crs": "EPSG:31467", "dst_crs": "EPSG:25832"}
    whole = lm.read(io.BytesIO(data), **options)
    parts = [*lm.read_chunks(io.BytesIO(data), rows=2, **options)]
    assert np.array_equal(np.concatenate([each.points for each in parts]), whole.points)
    assert all(
        each.metadata["transformation"] == whole.metadata["transformation"] for each in parts
    )
    north, told = transform(far[3:], "EPSG:31467", "EPSG:25832")
    assert told["operation"] != whole.metadata["transformation"]["operation"]
    assert not np.array_equal(north, whole.points[3:])


def test_a_missing_grid_is_named() -> None:
    with pytest.raises(InputError, match=r"a grid that is not installed \(.*us_noaa_conus\.tif"):
        transform(np.array([[-100.0, 40.0, 0.0]]), "EPSG:4267", "EPSG:4269")


def test_reports_say_the_transformation(tmp_path: Path) -> None:
    data = encoded(records(GAUSS, 6, version="1.4", offset=(3500000, 5400000, 0)))
    (tmp_path / "a.las").write_bytes(data)
    cloud = lm.read(tmp_path / "a.las", src_crs="EPSG:31467", dst_crs="EPSG:25832")
    report = lm.triangulate(cloud).report
    assert report.transformation["accuracy"] == 1.0
    assert "Transformed by Inverse of 3-degree Gauss-Kruger zone 3 + DHDN to ETRS89 (3)" in str(
        report
    )
    words = ("--src-crs", "EPSG:31467", "--dst-crs", "EPSG:25832", "--json")
    done = command("triangulate", "a.las", "a.ply", *words, cwd=tmp_path)
    assert json.loads(done.stdout)["transformation"] == dict(report.transformation)
    assert "a.las: transformed by Inverse of 3-degree" in done.stderr
    assert "(accuracy 1 m); " in done.stderr
    assert "transformation" not in lm.read(tmp_path / "a.ply").metadata


def test_clouds_that_were_transformed_by_several_operations_say_so() -> None:
    parts = [
        lm.read(io.BytesIO(encoded(records(points, 6, version="1.4", offset=(3e6, 5e6, 0)))),
                format="las", src_crs="EPSG:31467", dst_crs="EPSG:25832")
        for points in (GAUSS, NORTH)
    ]  # fmt: skip
    told = lm.triangulate(lm.merge(parts)).report.transformation
    assert ", others by " in told["operation"]
    assert lm.merge(parts[:1]).metadata["transformation"] == parts[0].metadata["transformation"]
    unknown = common_transformation(
        [{"operation": "a", "accuracy": None}, {"operation": "b", "accuracy": 1.0}]
    )
    assert transformation_text(unknown) == "transformed by a, others by b (accuracy not known)"
    assert not Provenance({"transformation": {"operation": "by hand"}}).transformation


@pytest.mark.parametrize(
    ("source", "target", "steps"),
    [
        ("EPSG:31467", "EPSG:25832", (0.01, 0.01, 0.01)),  # one unit: the same step
        ("EPSG:25832+7837", "EPSG:25833", (0.01, 0.01, 0.01)),
        ("EPSG:25832", "EPSG:4258", (1e-8, 1e-8, 0.01)),
        ("EPSG:25832+8228", "EPSG:25832+5703", (0.01, 0.01, 0.001)),
    ],
)
def test_scales_of_lidar_stay_as_fine_as_they_were(
    source: str, target: str, steps: tuple[float, ...], tmp_path: Path
) -> None:
    points = GAUSS if source == "EPSG:31467" else UTM
    data = encoded(records(points, 6, version="1.4", offset=points[0]))
    (tmp_path / "a.las").write_bytes(data)
    cloud = lm.read(tmp_path / "a.las", src_crs=source, dst_crs=target)
    written = lm.write(tmp_path / "b.las", cloud)
    back = lm.read(tmp_path / "b.las")
    assert tuple(back.metadata["las"]["scale"]) == pytest.approx(steps, rel=1e-12)
    assert (np.abs(back.points - cloud.points) <= np.array(steps) * 0.51).all()
    is_kept = np.array_equal(back.points, cloud.points)
    assert bool(written.dropped) == (not is_kept)
    assert (tmp_path / "b.las").stat().st_size >= len(data)


@pytest.mark.filterwarnings("ignore:x and y are degrees")
def test_slopes_of_degrees_are_refused(tmp_path: Path) -> None:
    cloud = Cloud(np.array([[9.0, 48, 400], [9.001, 48, 410], [9, 48.001, 420]]), crs="EPSG:4326")
    surface, tiled = lm.triangulate(cloud), lm.tile_surface(cloud, tmp_path / "tiles")
    for quantity in ("slope", "aspect", "hillshade"):
        for each in (surface, tiled):
            with pytest.raises(InputError, match="x and y are degrees, which are no lengths"):
                each.raster(0.0001, quantity=quantity)
            each.raster(0.0001, quantity=quantity, z_factor=9e-6)
    for measure in (surface.slope, surface.aspect):
        with pytest.raises(InputError, match="x and y are degrees, which are no lengths"):
            measure([9.0001, 48.0001])
    assert surface.slope([9.0001, 48.0001], z_factor=1 / 111_320) < 20
    assert surface.raster(0.0001).unit is None
    lm.write(tmp_path / "a.ply", cloud)
    words = ("raster", "a.ply", "o.tif", "--resolution", "0.0001", "--quantity", "slope")
    done = command(*words, cwd=tmp_path)
    assert (done.returncode, (tmp_path / "o.tif").exists()) == (3, False)
    assert "with --dst-crs a projected system, or give --z-factor" in done.stderr
    assert command(*words, "--z-factor", "9e-6", cwd=tmp_path).returncode == 0
