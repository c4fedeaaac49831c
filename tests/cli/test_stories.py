"""What surveyors, engineers, cartographers, makers and modellers do, command by command.

The files are small, and made like theirs: a lidar tile with classes, elevation models, meshes
before and after earthwork. Each figure is known in advance, or computed in another way.
"""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import laspy
import lib3mf
import numpy as np
import pyproj
import pytest
import rasterio
import trimesh
from commands import liftmesh as run
from files.geotiff import elevation_model
from files.las import encoded, records
from numpy.typing import NDArray

import liftmesh
from liftmesh import Surface

_LANDXML = "{http://www.landxml.org/schema/LandXML-1.2}"


def done(line: str, folder: Path) -> str:
    """Run a command that succeeds; return what it prints."""
    command, *words = line.split()
    assert command == "liftmesh"
    found = run(*words, cwd=folder)
    assert found.returncode == 0, found.stderr
    return found.stdout


def tile(path: Path, crs: str | None, origin: tuple[float, float]) -> laspy.LasData:
    """Write a tile: a hill with a bay on its border, and trees, in colours of 16 bits."""
    rng = np.random.default_rng(3)
    plane = rng.random((4000, 2)) * 60
    plane = plane[~((plane[:, 0] > 20) & (plane[:, 0] < 40) & (plane[:, 1] > 42))]
    is_ground = rng.random(len(plane)) < 0.5
    heights = np.sin(plane[:, 0] / 9) * 4 + plane[:, 1] / 20 + np.where(is_ground, 0, 8)
    las = records(
        np.column_stack([plane + origin, heights]), 7, version="1.4", scale=0.001,
        offset=(*origin, 0.0), classification=np.where(is_ground, 2, 5).astype(np.uint8),
        red=rng.integers(300, 65536, len(plane)).astype(np.uint16),
        return_number=np.ones(len(plane), np.uint8),
        number_of_returns=np.ones(len(plane), np.uint8),
    )  # fmt: skip
    if crs is not None:
        las.header.add_crs(pyproj.CRS(crs))
    path.write_bytes(encoded(las, compressed=path.suffix == ".laz"))
    return las


def hills(rows: int, columns: int) -> np.ndarray:
    y, x = np.mgrid[:rows, :columns]
    return 300 + 40 * np.sin(x / 7) * np.cos(y / 5) + x


def surface_of(path: Path) -> Surface:
    return liftmesh.as_surface(path)


def test_a_surveyor_makes_a_terrain_model_and_contours(tmp_path: Path) -> None:
    las = tile(tmp_path / "ahn_small.laz", "EPSG:7415", (85000.0, 447000.0))
    words = "ahn_small.laz tin.ply --classes 2 --max-edge 5 --boundary-only"
    told = json.loads(done(f"liftmesh triangulate {words} --json", tmp_path))
    ground = np.asarray(las.classification) == 2
    mesh = liftmesh.read(tmp_path / "tin.ply")
    assert np.array_equal(mesh.points, np.asarray(las.xyz)[ground])
    assert np.array_equal(mesh.colors[:, 0], (np.asarray(las.red)[ground] / 65535 * 255).round())
    assert told["n_triangles"] - told["n_trimmed"] == len(mesh.faces)
    assert told["n_trimmed"] > 0
    assert "+ NAP height" in mesh.crs

    done("liftmesh raster tin.ply dtm.tif --resolution 0.5 --crs EPSG:7415", tmp_path)
    with rasterio.open(tmp_path / "dtm.tif") as file:
        assert file.res == (0.5, 0.5)
        assert pyproj.CRS(file.crs.to_wkt()).to_epsg() == 7415
        heights, rows = file.read(1, masked=True), np.argwhere(file.read_masks(1))
        centres = np.array([file.xy(*row) for row in rows])
    expected = surface_of(tmp_path / "tin.ply").sample(centres)
    assert np.array_equal(heights.compressed(), expected.astype(np.float32))
    bay = (np.abs(centres[:, 0] - 85030) < 5) & (centres[:, 1] > 447050)
    assert not bay.any()  # trimmed: a hull would close it

    told = json.loads(done("liftmesh contour tin.ply lines.geojson --interval 1 --json", tmp_path))
    tree = json.loads((tmp_path / "lines.geojson").read_text())
    lines = [np.array(each["geometry"]["coordinates"]) for each in tree["features"]]
    lengths = [np.linalg.norm(np.diff(each[:, :2], axis=0), axis=1).sum() for each in lines]
    assert told["length"] == pytest.approx(sum(lengths))
    low, high = mesh.points[:, 2].min(), mesh.points[:, 2].max()
    levels = {each["properties"]["height"] for each in tree["features"]}
    assert levels == {*range(math.ceil(low), math.floor(high) + 1)}


def distances(mesh: liftmesh.Cloud, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far each point is along z from the faces of a mesh as they stand, whoever made them."""
    found = np.full(len(points), -np.inf)
    for a, b, c in mesh.points[mesh.faces]:
        sides = np.column_stack([b - a, c - a])
        weights = np.linalg.solve(sides[:2], (points[:, :2] - a[:2]).T).T
        inside = (weights.min(axis=1) > -1e-9) & (weights.sum(axis=1) < 1 + 1e-9)
        distance = np.abs(a[2] + weights[inside] @ sides[2] - points[inside, 2])
        found[inside] = np.maximum(found[inside], distance)
    assert (found >= 0).all()  # each point is in a face
    return found


def test_an_engineer_compares_before_and_after(tmp_path: Path) -> None:
    def plane(rows: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
        return [(x, y, 0.25 * x + 0.5 * y + z) for x, y, z in rows]

    square = plane([(0, 0, 0), (100, 0, 0), (100, 100, 0), (0, 100, 0)])
    pyramid = plane([(20, 20, 0), (40, 20, 0), (40, 40, 0), (20, 40, 0), (30, 30, 3)])
    pit = plane([(60, 60, 0), (70, 60, 0), (70, 70, 0), (60, 70, 0), (65, 65, -6)])
    liftmesh.triangulate(square).save(tmp_path / "before.ply")
    liftmesh.triangulate(square + pyramid + pit).save(tmp_path / "after.ply")
    told = json.loads(done("liftmesh volume before.ply after.ply --json", tmp_path))
    found = [told[each] for each in ("fill", "cut", "net", "planar_area")]
    assert found == pytest.approx([400, 200, 200, 10_000])


def test_a_cartographer_simplifies_an_elevation_model(tmp_path: Path) -> None:
    heights = hills(40, 50)
    # Single precision moves y by more than a millionth of the size, 22 km, and x by 1/64: less.
    corner, pixel = (299_003 + 17 / 64, 5_258_341.25), 450.0
    elevation_model(tmp_path / "dem_01.tif", heights, pixel, "EPSG:32755", corner)
    done("liftmesh simplify dem_01.tif tin.xml --max-error 1", tmp_path)
    said = done("liftmesh simplify dem_01.tif tin.glb --max-error 1", tmp_path)
    assert "float32, so the origin (299228, 5258566, 0) was subtracted" in said
    words = "liftmesh simplify dem_01.tif tin.glb --max-error 1 --json --overwrite"
    assert json.loads(done(words, tmp_path))["origin"] == [299228, 5258566, 0]
    y, x = np.mgrid[:40, :50]
    places = pixel * np.column_stack([x.ravel() + 0.5, 39.5 - y.ravel()]) + corner
    root = ET.parse(tmp_path / "tin.xml").getroot()
    rows = np.array([(p.text or "").split() for p in root.iter(f"{_LANDXML}P")], float)
    corners = np.array([(f.text or "").split() for f in root.iter(f"{_LANDXML}F")], int) - 1
    assert root.find(f".//{_LANDXML}Metric") is not None
    glb = liftmesh.read(tmp_path / "tin.glb")
    northing_first = liftmesh.Cloud(rows[:, [1, 0, 2]], faces=corners.astype(np.int32))
    for mesh in (northing_first, glb):
        assert len(mesh.faces) < 0.7 * 2 * 39 * 49
        assert distances(mesh, np.column_stack([places, heights.ravel()])).max() <= 1 + 1e-4


def test_a_maker_prints_a_solid(tmp_path: Path) -> None:
    heights = hills(20, 30)
    elevation_model(tmp_path / "jacksboro.tif", heights, 1.0)
    surface = liftmesh.triangulate(tmp_path / "jacksboro.tif")
    done("liftmesh solid jacksboro.tif fault.stl --base-height 236", tmp_path)
    solid = trimesh.load(tmp_path / "fault.stl")
    assert solid.is_watertight
    assert solid.volume == pytest.approx(surface.volume(236.0).net, rel=1e-6)

    done("liftmesh solid jacksboro.tif fault.3mf --base-height 226", tmp_path)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "fault.3mf"))
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    assert meshes.GetCurrentMeshObject().GetType() == lib3mf.ObjectType.Model
    assert meshes.GetCurrentMeshObject().IsManifoldAndOriented()
    assert meshes.GetCurrentMeshObject().GetTriangleCount() == len(solid.faces)


def test_a_modeller_asks_for_heights(tmp_path: Path) -> None:
    las = tile(tmp_path / "autzen_trim.las", "EPSG:2992", (636000.0, 849000.0))
    done("liftmesh triangulate autzen_trim.las autzen.ply --classes 2", tmp_path)
    (tmp_path / "points.csv").write_text("x,y\n636010.125,849020.3625\n636000,849200\n")
    line = "liftmesh sample autzen.ply heights.csv --at points.csv --interpolation sibson"
    done(line, tmp_path)
    rows = [each.split(",") for each in (tmp_path / "heights.csv").read_text().splitlines()]
    ground = np.asarray(las.xyz)[np.asarray(las.classification) == 2]
    query = np.array([[636010.125, 849020.3625]])
    expected = liftmesh.triangulate(ground).sample(query, interpolation="sibson")
    assert float(rows[1][2]) == expected[0]
    assert abs(expected[0] - (np.sin(10.125 / 9) * 4 + 20.3625 / 20)) < 0.1
    assert rows[2][2] == ""

    told = done("liftmesh info autzen_trim.las", tmp_path)
    counts = [np.count_nonzero(np.asarray(las.classification) == each) for each in (2, 5)]
    assert f"classes     2 ground {counts[0]:,}, 5 high vegetation {counts[1]:,}\n" in told
    assert f"rows        {len(las.points):,}\n" in told
    assert "units       x: foot, y: foot, z: not stated\n" in told


@pytest.mark.parametrize(("kind", "unit"), [("xml", "metres"), ("3mf", "millimetres")])
def test_a_unit_that_nobody_states_is_said(kind: str, unit: str, tmp_path: Path) -> None:
    elevation_model(tmp_path / "a.tif", hills(4, 5), 1.0)
    found = run("triangulate", "a.tif", f"o.{kind}", cwd=tmp_path)
    assert f"o.{kind}: no coordinate system says the unit: " in found.stderr
    assert f" states {unit}\n" in found.stderr


def test_a_unit_that_is_given_is_not_looked_for(tmp_path: Path) -> None:
    elevation_model(tmp_path / "a.tif", hills(4, 5), 1.0)
    liftmesh.write(tmp_path / "odd.ply", liftmesh.Cloud(np.eye(3), crs="EPSG:999999"))
    for source in ("a.tif", "odd.ply"):
        found = run("triangulate", source, "o.3mf", "--overwrite", "--unit", "inch", cwd=tmp_path)
        assert found.returncode == 0
        assert "says the unit" not in found.stderr


@pytest.fixture
def flawed(tmp_path: Path) -> Path:
    """A folder of files that are wrong in one way each."""
    nothing = np.full((4, 5), -9999.0)
    elevation_model(tmp_path / "nodata.tif", nothing, 1.0)
    with rasterio.open(tmp_path / "nodata.tif", "r+") as file:
        file.nodata = -9999.0
    head = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nnodata_value -9\n"
    (tmp_path / "nodata.agr").write_text(head + "-9 -9\n")
    for name, crs in (("utm", "EPSG:25832"), ("rd", "EPSG:28992"), ("feet", "EPSG:2994+5703")):
        tile(tmp_path / f"{name}.laz", crs, (500_000.0, 5_000_000.0))
    whole = (tmp_path / "utm.laz").read_bytes()
    (tmp_path / "cut.laz").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "head.laz").write_bytes(whole[:300])
    (tmp_path / "lies.laz").write_bytes(whole[:100] + b"\xff\xff\xff\x7f" + whole[104:])
    odd = liftmesh.Cloud(np.eye(3), crs="EPSG:999999")
    liftmesh.write(tmp_path / "odd.ply", odd)
    elevation_model(tmp_path / "band.tif", hills(4, 5), 1.0, "EPSG:25832")
    with rasterio.open(tmp_path / "band.tif", "r+") as file:
        file.units = ("ft",)
    return tmp_path


FLAWS = {
    "triangulate nodata.tif o.ply": "nodata.tif: none of 20 samples has a value",
    "triangulate nodata.agr o.ply": "nodata.agr: none of 2 samples has a value",
    "triangulate utm.laz o.ply --classes 40": "utm.laz: none of 3,638 rows meets",
    "triangulate utm.laz rd.laz o.ply": "utm.laz and rd.laz have different .*: give --dst-crs",
    "triangulate feet.laz o.xml": "x, y and z are foot and metre, but LandXML has one for all",
    "triangulate band.tif o.xml": "x, y and z are metre and foot, but LandXML has one for all",
    "triangulate band.tif o.3mf": "x, y and z are metre and foot, but 3MF has one for all",
    "triangulate odd.ply o.xml": "unit of 'EPSG:999999' is not known, but LandXML .* --src-crs$",
    "triangulate cut.laz o.ply": "cut.laz: LAZ: the table of chunks should begin at byte .* trunc",
    "triangulate head.laz o.ply": r"begin at byte [\d,]+, but the file has 300: it is truncated",
    "triangulate lies.laz o.ply": "lies.laz: byte 100: the header states 2,147,483,647 records",
    "triangulate odd.ply o.ply --dst-crs EPSG:25832": "'EPSG:999999' is unknown: give WKT or EPSG",
}


@pytest.mark.parametrize("line", FLAWS)
def test_what_is_wrong_is_one_line_and_leaves_nothing(line: str, flawed: Path) -> None:
    before = sorted(each.name for each in flawed.iterdir())
    found = run(*line.split(), cwd=flawed)
    assert found.returncode == 3
    assert found.stdout == ""
    (error,) = [each for each in found.stderr.splitlines() if ": error: " in each]
    assert re.search(FLAWS[line], error)
    assert found.stderr.endswith(error + "\n")
    assert sorted(each.name for each in flawed.iterdir()) == before
