"""``liftmesh info``: every number compared with a separate plain computation."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import numpy as np
import pytest
import rasterio
from commands import COMMAND, PLAIN, ROOT, TERRAIN, failed, liftmesh, process
from files.las import records
from scipy.spatial.distance import cdist

import liftmesh as lm
from liftmesh.cli import exit_codes
from liftmesh.cli.info import summarise


def summary_of(path):
    done = liftmesh("info", path, "--json")
    assert (done.returncode, done.stderr) == (0, "")
    return json.loads(done.stdout)


def lines_of(*words, cwd=None):
    done = liftmesh("info", *words, cwd=cwd)
    assert (done.returncode, done.stderr) == (0, "")
    return dict(re.findall(r"^(\w+) +(.*)$", done.stdout, flags=re.MULTILINE))


def test_the_terrain():
    told = lines_of(TERRAIN)
    assert told["rows"] == "138,632"
    assert told["z"] == "236 to 1076  (840)"
    assert told["duplicates"] == told["overhangs"] == "0"
    assert told["collinear"] == "no"
    assert told["float32"].startswith("enough")
    assert told["memory"] == "about 13 MB to triangulate"


def test_edges_are_counted(tmp_path):
    lines = lm.Cloud(np.eye(3), edges=np.array([[0, 1], [1, 2]], np.int32))
    lm.write(tmp_path / "a.ply", lines)
    assert lines_of("a.ply", cwd=tmp_path)["edges"] == "2"
    assert summary_of(tmp_path / "a.ply")["n_edges"] == 2


def test_a_raster_and_how_far_apart_its_samples_are(tmp_path):
    turned = rasterio.Affine.translation(5, 7) @ rasterio.Affine.rotation(30)
    placed = {"a.tif": rasterio.Affine(0.5, 0, 5, 0, -2, 7), "b.tif": turned}
    for name, transform in placed.items():
        with rasterio.open(
            tmp_path / name, "w", driver="GTiff", count=1, width=3, height=2, dtype="float64",
            transform=transform,
        ) as file:  # fmt: skip
            file.write(np.arange(6.0).reshape(1, 2, 3))
    told = lines_of("a.tif", cwd=tmp_path)
    assert told["raster"] == "3 x 2 samples, 0.5 x 2 apart"
    assert told["crs"] == "not stated"
    assert told["x"] == "5.25 to 6.25  (1)"
    assert lines_of("b.tif", cwd=tmp_path)["raster"] == "3 x 2 samples, 1 x 1 apart, turned"
    assert summary_of(tmp_path / "a.tif")["raster"]["transform"] == [0.5, 0, 5, 0, -2, 7]
    assert summary_of(TERRAIN)["raster"] == {}


def test_coordinates_have_the_digits_of_the_scale(tmp_path):
    far = np.array([[0, 0, 0], [3, 0, 1], [0, 3, 2]]) * [1, 1, 0.25] + [5e6 + 1e-4, 1, 627.5300293]
    las = records(far, 6, version="1.4", scale=0.0001, offset=[5e6, 0.0, 0.0300293])
    las.header.scales = [0.0001, 1.0, 0.25]
    las.x, las.y, las.z = far.T
    las.write(tmp_path / "a.las")
    told = lines_of("a.las", cwd=tmp_path)
    assert told["scale"] == "0.0001, 1, 0.25"
    assert told["x"] == "5000000.0001 to 5000003.0001  (3)"
    assert told["y"] == "1 to 4  (3)"
    assert told["z"] == "627.53 to 628.03  (0.5)"
    assert told["crs"] == "not stated"


def test_the_coordinate_system_is_shown_where_there_is_one(tmp_path):
    lm.write(tmp_path / "cloud.ply", lm.Cloud(np.eye(3), crs="EPSG:25832"))
    shown = lines_of(tmp_path / "cloud.ply")["crs"]
    assert shown == "EPSG:25832, ETRS89 / UTM zone 32N (projected)"
    assert summary_of(tmp_path / "cloud.ply")["crs"] == "EPSG:25832"
    assert "crs" not in lines_of(TERRAIN)
    assert summary_of(TERRAIN)["crs"] is None
    wkt = 'PROJCS["mine",GEOGCS["b",UNIT["degree",0.0174532925199433]],UNIT["metre",1]]'
    lm.write(tmp_path / "wkt.ply", lm.Cloud(np.eye(3), crs=wkt))
    assert lines_of(tmp_path / "wkt.ply")["crs"] == "mine (projected)"
    assert summary_of(tmp_path / "wkt.ply")["crs"] == wkt
    lm.write(tmp_path / "odd.ply", lm.Cloud(np.eye(3), crs="of our own"))
    done = liftmesh("info", "odd.ply", cwd=tmp_path)
    assert re.search(r"^crs +of our own$", done.stdout, flags=re.MULTILINE)
    line = "odd.ply: the coordinate system 'of our own' is not understood: its units are not known"
    assert done.stderr == f"liftmesh: note: {line}\n"


def test_spacing_is_the_median_distance_to_the_nearest():
    points = lm.read(ROOT / "data" / "hill.csv").points
    between = cdist(points[:, :2], points[:, :2]) + np.diag(np.full(len(points), np.inf))
    expected = np.median(between.min(axis=1))
    assert summary_of(ROOT / "data" / "hill.csv")["spacing"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("scale", [5e-324, 1e-300, 1.0, 2.0**1020])
def test_spacing_at_every_magnitude(scale):
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0))
    rows = np.column_stack([x.ravel(), y.ravel(), np.zeros(20)]) * scale
    summary = summarise(lm.Cloud(rows))
    assert summary.spacing == scale
    assert not summary.collinear


def test_duplicates_and_overhangs_are_those_of_the_report():
    rng = np.random.default_rng(0)
    rows = rng.integers(0, 6, (200, 3)).astype(float)
    rows[rng.random(200) < 0.2, 0] *= -0.0
    summary, report = summarise(lm.Cloud(rows)), lm.triangulate(rows).report
    assert (summary.n_duplicates, summary.n_overhangs) == (report.n_duplicates, report.n_overhangs)
    assert summary.n_positions == report.n_used


def test_rows_that_are_not_finite_are_counted_and_left_out(tmp_path):
    (tmp_path / "c.csv").write_text("x,y,z\n0,0,0\nnan,9,9\n4,0,1\n0,inf,1\n0,3,2\n")
    told = lines_of("c.csv", cwd=tmp_path)
    assert told["rows"] == "5, 2 not finite"
    assert told["x"] == "0 to 4  (4)"
    assert told["spacing"].startswith("3 ")


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0 0 0\n", "fewer than three"),
        ("0 0 0\n1 1 1\n0 0 0\n", "fewer than three"),
        ("0 0 0\n1 1 1\n3 3 9\n", "all points are collinear"),
        ("450000.1 5200000.1 0\n450000.2 5200000.2 0\n450000.3 5200000.3 0\n", None),
    ],
)
def test_collinearity_is_exact(rows, words, tmp_path):
    (tmp_path / "c.xyz").write_text(rows)
    told = lines_of("c.xyz", cwd=tmp_path)["collinear"]
    assert told == "no" if words is None else words in told
    done = liftmesh("triangulate", "c.xyz", "m.ply", cwd=tmp_path)
    assert (done.returncode == 0) == (words is None)


def test_offset_and_what_float32_would_do(tmp_path):
    rows = np.random.default_rng(0).random((2000, 3)) * 10 + (450_000, 5_200_000, 0)
    np.save(tmp_path / "utm.npy", rows)
    summary = summary_of(tmp_path / "utm.npy")
    assert summary["float32_shift"] == np.abs(rows.astype(np.float32) - rows).max()
    assert summary["float32_is_enough"] is False
    assert summary["offset"] == pytest.approx(np.hypot(450_005, 5_200_005), abs=0.1)
    assert lines_of("utm.npy", cwd=tmp_path)["float32"].startswith(
        "not enough: changes coordinates"
    )
    np.save(tmp_path / "whole.npy", np.floor(rows - (450_000, 5_200_000, 0)))
    assert "exactly" in lines_of("whole.npy", cwd=tmp_path)["float32"]


def test_float32_where_it_overflows_or_there_is_no_spacing(tmp_path):
    np.save(tmp_path / "far.npy", np.eye(3) * 1e39)
    assert lines_of("far.npy", cwd=tmp_path)["float32"] == "not enough: coordinates overflow"
    np.save(tmp_path / "one.npy", np.full((2, 3), 0.1))
    told = lines_of("one.npy", cwd=tmp_path)
    assert told["spacing"] == "none: one position"
    shift = abs(float(np.float32(0.1)) - 0.1)
    assert told["float32"] == f"not enough: changes coordinates by up to {shift:.3g}"


def test_a_mesh_with_colours(tmp_path):
    lm.triangulate(ROOT / "data" / "hill.csv").save(tmp_path / "hill.ply")
    told = lines_of("hill.ply", cwd=tmp_path)
    assert told["faces"] == "147"
    assert told["holds"] == "coordinates, colors"


def test_stdin():
    content = TERRAIN.read_bytes()
    done = process("info", "-", "--input-format", "ply", stdin=content, text=False)
    assert done.returncode == 0
    assert b"138,632" in done.stdout


@pytest.mark.parametrize("rows", [0, 3])
def test_nothing_finite(rows, tmp_path):
    np.save(tmp_path / "c.npy", np.full((rows, 3), np.nan))
    told = lines_of("c.npy", cwd=tmp_path)
    assert told["rows"].startswith(str(rows))
    assert "spacing" not in told


def test_a_file_that_is_not_there():
    failed(liftmesh("info", "nowhere.ply"), exit_codes.BAD_INPUT, "nowhere.ply: No such file")


@pytest.mark.slow
def test_predicted_memory_is_what_triangulating_takes(tmp_path):
    np.save(tmp_path / "c.npy", np.random.default_rng(0).random((600_000, 3)))
    np.save(tmp_path / "tiny.npy", np.eye(3))
    measured = peak("c.npy", tmp_path) - peak("tiny.npy", tmp_path)
    predicted = summary_of(tmp_path / "c.npy")["memory"]
    assert 0.8 < measured / predicted < 1.15


def peak(name, folder):
    """Peak memory in bytes of triangulating a file."""
    script = (
        "import resource, subprocess, sys\n"
        "subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)\n"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    )
    words = [*COMMAND, "triangulate", name, "mesh.ply", "--overwrite"]
    done = subprocess.run(
        [sys.executable, "-c", script, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        env=PLAIN,
        check=True,
    )
    return int(done.stdout) * 1024


def test_what_is_not_read_is_named(tmp_path):
    path = tmp_path / "many.npz"
    others = {f"grid{k}": np.zeros((3, 3, k)) for k in range(2, 14)}
    np.savez(path, points=np.random.default_rng(0).random((5, 3)), **others)
    for words in (["info", path], ["triangulate", path, tmp_path / "mesh.ply"]):
        done = liftmesh(*words)
        assert done.returncode == 0, words
        assert f"{path}: not read: grid2 (3, 3, 2), grid3" in done.stderr
        assert done.stderr.count("grid") == 8
        assert "and 4 more" in done.stderr
    named = json.loads(liftmesh("info", path, "--json").stdout)["not_read"]
    assert len(named) == 12
