"""``liftmesh sample``, ``raster`` and ``contour``, and trimming, as a person runs them."""

from __future__ import annotations

import io
import json
from pathlib import Path

import geopandas
import numpy as np
import pyproj
import pytest
import rasterio
import trimesh
from commands import failed, liftmesh as run, process
from hypothesis import given, strategies as st
from surfaces import meadow

import liftmesh
from liftmesh.cli.sample import _EmptyFields


@pytest.fixture
def tin(tmp_path: Path) -> Path:
    """A mesh that was trimmed from the boundary inwards, as the command writes it."""
    np.savetxt(tmp_path / "meadow.csv", meadow(), delimiter=",", header="x,y,z", comments="")
    words = ("--max-edge", "12", "--boundary-only")
    done = run("triangulate", tmp_path / "meadow.csv", tmp_path / "tin.ply", *words)
    assert done.returncode == 0, done.stderr
    return tmp_path / "tin.ply"


def surface() -> liftmesh.Surface:
    return liftmesh.triangulate(meadow()).trim(max_edge=12, boundary_only=True)


def test_a_mesh_is_trimmed_before_it_is_written(tin, tmp_path) -> None:
    whole = liftmesh.triangulate(meadow())
    assert len(liftmesh.read(tin).faces) == len(surface().faces) < len(whole.faces)
    done = run(
        "triangulate", tmp_path / "meadow.csv", tin, "--max-edge", "12", "--json", "--overwrite"
    )
    found = json.loads(done.stdout)
    assert found["n_trimmed"] == whole.trim(max_edge=12).mask.sum()
    assert found["n_triangles"] == len(whole.faces)


def test_a_raster_has_the_heights_of_the_surface(tin, tmp_path) -> None:
    words = ("--resolution", "0.5", "--crs", "EPSG:25832", "--double")
    done = run("raster", tin, tmp_path / "dtm.tif", *words)
    assert done.returncode == 0, done.stderr
    expected = surface().raster(0.5)
    known = np.isfinite(expected.values).sum()
    assert done.stdout.endswith(f"pixels of height, {known:,} with a value\n")
    with rasterio.open(tmp_path / "dtm.tif") as file:
        np.testing.assert_array_equal(file.read(1), expected.values)
        assert file.crs.to_epsg() == 25832


def test_rasters_of_other_quantities(tin, tmp_path) -> None:
    words = (
        "--resolution",
        "2,1",
        "--raster-bounds",
        "0,0,50,50",
        "--quantity",
        "hillshade",
        "--json",
    )
    done = run("raster", tin, tmp_path / "s.tif", *words, "--cog", "--compress", "none", "--json")
    found = json.loads(done.stdout)
    assert (found["n_rows"], found["n_columns"], found["quantity"]) == (50, 25, "hillshade")
    with rasterio.open(tmp_path / "s.tif") as file:
        expected = surface().raster((2, 1), bounds=(0, 0, 50, 50), quantity="hillshade")
        np.testing.assert_array_equal(file.read(1), expected.values.astype(np.float32))


def test_a_raster_by_natural_neighbours(tin, tmp_path) -> None:
    words = ("--resolution", "5", "--interpolation", "sibson", "--double")
    assert run("raster", tin, tmp_path / "dtm.tif", *words).returncode == 0
    with rasterio.open(tmp_path / "dtm.tif") as file:
        expected = surface().raster(5, interpolation="sibson").values
        np.testing.assert_array_equal(file.read(1), expected)


def test_voids_are_filled_and_heights_smooth(tin, tmp_path) -> None:
    words = ("--resolution", "5", "--max-edge", "10", "--double")
    ways = ("--interpolation", "c1", "--fill", "12.5")
    assert run("raster", tin, tmp_path / "dtm.tif", *words, *ways).returncode == 0
    expected = surface().trim(max_edge=10).raster(5, interpolation="c1", fill=12.5)
    with rasterio.open(tmp_path / "dtm.tif") as file:
        np.testing.assert_array_equal(file.read(1), expected.values)
    done = run("raster", tin, tmp_path / "dtm.tif", *words, "--fill", "0", "--overwrite")
    failed(done, 2, "--fill is 0: give a positive number")
    vertices = np.random.default_rng(1).random((9, 3))
    colored = liftmesh.triangulate(vertices, colors=vertices)
    colored.save(tmp_path / "colors.ply")
    done = run("raster", tmp_path / "colors.ply", tmp_path / "c.tif", *words, "--values=colors")
    failed(
        done,
        3,
        "--values colors has 3 numbers for each vertex: give values with one, of which there",
    )


def test_values_take_the_place_of_heights(tmp_path) -> None:
    rows = np.column_stack([meadow(), np.arange(len(meadow()))])
    np.savetxt(tmp_path / "wet.csv", rows, delimiter=",", header="x,y,z,wet", comments="")
    whole = liftmesh.triangulate(rows[:, :3])
    words = (tmp_path / "wet.csv", tmp_path / "wet.tif", "--resolution=5", "--double")
    done = run("raster", *words, "--values", "wet")
    assert "pixels of wet" in done.stdout, done.stderr
    with rasterio.open(tmp_path / "wet.tif") as file:
        np.testing.assert_array_equal(file.read(1), whole.raster(5, values=rows[:, 3]).values)
    lines = (tmp_path / "wet.csv", tmp_path / "wet.geojson", "--values=wet")
    assert json.loads(run("contour", *lines, "--interval=50", "--json").stdout)["n_lines"] == len(
        whole.contours(interval=50, values=rows[:, 3])
    )
    high = run("contour", *lines, "--levels=1e9", "--overwrite")
    assert f"its values 'wet' are from 0 to {len(rows) - 1}" in high.stderr
    failed(run("raster", *words, "--values=dry", "--overwrite"), 3, "no values 'dry', but 'wet'")


def test_contours_are_those_of_the_surface(tin, tmp_path) -> None:
    words = ("--interval", "2", "--min-length", "5", "--contour-base", "1")
    done = run("contour", tin, tmp_path / "lines.geojson", *words)
    assert done.returncode == 0, done.stderr
    expected = surface().contours(interval=2, contour_base=1).longer_than(5)
    tree = json.loads((tmp_path / "lines.geojson").read_text())
    found = [each["geometry"]["coordinates"] for each in tree["features"]]
    assert found == [line.points.tolist() for line in expected]
    assert f"{len(expected):,} lines at " in done.stdout
    said = json.loads(run("contour", tin, tmp_path / "l.geojson", *words, "--json").stdout)
    assert said["n_lines"] == len(expected)
    assert said["length"] == pytest.approx(expected.lengths.sum())


def test_filled_contours_are_those_of_the_surface(tin, tmp_path) -> None:
    words = ("--interval", "2", "--contour-base", "1", "--filled")
    done = run("contour", tin, tmp_path / "bands.geojson", *words)
    assert done.returncode == 0, done.stderr
    expected = surface().filled_contours(interval=2, contour_base=1)
    tree = json.loads((tmp_path / "bands.geojson").read_text())
    assert [each["properties"]["lower"] for each in tree["features"]] == expected.lower.tolist()
    assert f"{len(expected)} bands of {len(expected.polygons) - 1} polygons" in done.stdout
    said = json.loads(run("contour", tin, tmp_path / "b.gpkg", *words, "--json").stdout)
    assert (said["n_bands"], said["n_polygons"]) == (len(expected), len(expected.polygons) - 1)
    assert said["area"] == pytest.approx(surface().area(planar=True))
    for option, value in (("--min-length", "5"), ("--index-every", "2")):
        done = run("contour", tin, tmp_path / "c.gpkg", *words, option, value)
        failed(done, 2, f"{option} is of lines, and --filled is given")


def test_faces_are_left_out_by_radius_and_polygon(tin, tmp_path) -> None:
    ring = [[10, 10], [60, 10], [60, 70], [10, 70]]
    area = tmp_path / "area.geojson"
    area.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    words = ("--levels", "-1,2", "--trim-polygon", area, "--max-radius", "9", "--json")
    done = run("contour", tin, tmp_path / "lines.gpkg", *words)
    expected = surface().trim(polygon=ring, max_radius=9).contours([-1, 2])
    assert json.loads(done.stdout)["length"] == pytest.approx(expected.lengths.sum())
    assert len(geopandas.read_file(tmp_path / "lines.gpkg")) == len(expected)


def test_a_solid_is_written(tin, tmp_path) -> None:
    words = ("--base-height", "-50", "--longest", "100", "--z-factor", "2", "--pinched", "trim")
    said = json.loads(run("solid", tin, tmp_path / "s.stl", *words, "--json").stdout)
    found = trimesh.load(tmp_path / "s.stl")
    assert found.is_volume
    assert said["volume"] == pytest.approx(found.volume, rel=1e-6)
    assert max(said["size"][:2]) == 100
    assert said["n_triangles"] == len(found.faces)
    done = run("solid", tin, tmp_path / "s.3mf", "--thickness", "3", "--pinched", "trim")
    assert "triangles, volume " in done.stdout


def test_a_cloud_is_triangulated_first(tmp_path) -> None:
    np.savetxt(tmp_path / "meadow.csv", meadow(), delimiter=",", header="x,y,z", comments="")
    source, target = tmp_path / "meadow.csv", tmp_path / "lines.geojson"
    done = run("contour", source, target, "--interval", "2", "--max-edge", "12", "--json")
    expected = liftmesh.triangulate(meadow()).trim(max_edge=12).contours(interval=2)
    assert json.loads(done.stdout)["n_lines"] == len(expected)


def test_points_get_heights_and_keep_their_values(tin, tmp_path) -> None:
    (tmp_path / "points.csv").write_text("x,y,id\n20,20,7\n50,50,8\n99,50,9\n")
    done = run("sample", tin, tmp_path / "heights.csv", "--at", tmp_path / "points.csv")
    assert done.returncode == 0, done.stderr
    assert "2 of 3 points have a height" in done.stderr
    found = liftmesh.read(tmp_path / "heights.csv")
    expected = surface().sample([[20, 20], [50, 50], [99, 50]])
    np.testing.assert_array_equal(found.points[:, 2], expected)
    assert np.isnan(expected[2])
    assert found.attributes["id"].tolist() == [7, 8, 9]
    assert (tmp_path / "heights.csv").read_text().splitlines()[-1].split(",")[2] == ""
    run("sample", tin, tmp_path / "heights.xyz", "--at", tmp_path / "points.csv")
    assert " nan " in (tmp_path / "heights.xyz").read_text()


def test_contours_outside_of_the_heights_are_said(tmp_path) -> None:
    points = np.array([[0.0, 0, 2], [9, 0, 3], [0, 9, 4], [9, 9, 5.5]])
    liftmesh.write(tmp_path / "tin.ply", liftmesh.triangulate(points))
    liftmesh.tile_surface(points, tmp_path / "tiles")
    for source in ("tin.ply", "tiles"):
        words = ("contour", source, "o.geojson", "--overwrite")
        done = run(*words, "--levels", "99", cwd=tmp_path)
        assert "o.geojson: 0 lines at 0 levels" in done.stdout
        assert f"{source}: no line: its heights are from 2 to 5.5\n" in done.stderr
        done = run(*words, "--levels", "3", "--min-length", "99", "--json", cwd=tmp_path)
        assert (json.loads(done.stdout)["n_lines"], done.stderr) == (0, "")


@pytest.mark.parametrize("kind", ["csv", "tsv"])
def test_stdout_has_the_bytes_of_a_file(kind: str, tin, tmp_path) -> None:
    (tmp_path / "at.csv").write_text("x,y,nan,id\n20,20,1,7\n99,50,,8\n50,50,nan,9\n")
    words = ("--at", "at.csv", "--json")
    done = run("sample", tin, f"out.{kind}", *words, cwd=tmp_path)
    told = {"path": f"out.{kind}", "interpolation": "linear", "n_points": 3, "n_known": 2}
    told |= {"classes": {}, "transformation": None}
    assert (json.loads(done.stdout), done.stderr) == (told, "")
    printed = process("sample", tin, "-", "--output-format", kind, *words, cwd=tmp_path, text=False)
    assert printed.stdout == (tmp_path / f"out.{kind}").read_bytes()
    assert json.loads(printed.stderr) == told | {"path": "-"}
    lines = [
        line.split("\t" if kind == "tsv" else ",") for line in printed.stdout.decode().splitlines()
    ]
    assert lines[0] == ["x", "y", "z", "nan", "id"]
    assert [line[2] == "" for line in lines[1:]] == [False, True, False]
    assert [line[3] == "" for line in lines[1:]] == [False, True, True]


@given(names=st.binary(), rows=st.lists(st.sampled_from([b"nan", b"1.5", b""]), min_size=2))
def test_names_of_columns_stay_however_they_are_written(names: bytes, rows: list[bytes]) -> None:
    names = names.replace(b"\n", b"nan,")
    stream = io.BytesIO()
    lines = _EmptyFields(stream)
    for part in (names[:3], names[3:], b"\n", b",".join(rows) + b"\n"):
        lines.write(part)
    expected = b",".join(b"" if each == b"nan" else each for each in rows)
    assert stream.getvalue() == names + b"\n" + expected + b"\n"


def test_rows_that_are_not_finite_may_be_skipped(tmp_path) -> None:
    (tmp_path / "nan.csv").write_text("x,y,z\n0,0,1\n9,9,nan\n4,0,2\n0,4,3\n")
    (tmp_path / "at.csv").write_text("x,y\n0,0\n1,1\n9,9\n")
    done = run("sample", "nan.csv", "o.csv", "--at", "at.csv", "--nonfinite", "skip", cwd=tmp_path)
    assert "2 of 3 points have a height" in done.stderr
    words = ("--resolution", "1", "--nonfinite", "skip", "--json")
    done = run("raster", "nan.csv", "o.tif", *words, cwd=tmp_path)
    assert json.loads(done.stdout)["n_columns"] == 4


def test_what_the_format_of_a_solid_does_not_keep_is_said(tin, tmp_path) -> None:
    words = ("--thickness", "1", "--pinched", "trim")
    done = run("solid", tin, tmp_path / "s.xyz", *words)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("; text does not keep faces\n")
    told = json.loads(run("solid", tin, tmp_path / "t.xyz", *words, "--json").stdout)
    assert told["dropped"] == ["faces"]


def test_what_a_solid_does_not_keep_of_its_surface_is_said(tmp_path) -> None:
    points = [[0.0, 0, 5], [4, 0, 5], [0, 3, 5], [4, 3, 6]]
    more = {"colors": np.zeros((4, 3), np.uint8), "normals": np.eye(4, 3)}
    cloud = liftmesh.Cloud(np.array(points), **more, attributes={"id": np.arange(4)})
    liftmesh.triangulate(cloud, crs="EPSG:28992").save(tmp_path / "full.ply")
    lost = " (a solid does not keep colors, normals, id), volume "
    for target, own in (("s.3mf", "3mf does not keep crs"), ("s.ply", "")):
        done = run("solid", "full.ply", target, "--base-height", "0", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert lost in done.stdout
        assert own in done.stdout
    words = ("full.ply", "t.3mf", "--base-height", "0", "--longest", "90", "--json")
    told = json.loads(run("solid", *words, cwd=tmp_path).stdout)
    assert told["dropped"][:4] == ["colors", "normals", "crs", "id"]


@pytest.mark.parametrize("crs", ["EPSG:7415", "epsg:28992", "28992", pyproj.CRS(28992).to_wkt()])
def test_a_system_may_be_stated_again(tmp_path, crs: str) -> None:
    liftmesh.triangulate(meadow(), crs="EPSG:28992").save(tmp_path / "dutch.ply")
    words = ("dutch.ply", "dtm.tif", "--resolution", "1", "--crs", crs)
    done = run("raster", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with rasterio.open(tmp_path / "dtm.tif") as file:
        assert file.crs == rasterio.CRS.from_user_input(pyproj.CRS(crs))


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("raster", "tin.ply", "out.tif", "--resolution", "0"), 2, "give a positive number"),
        (("raster", "tin.ply", "out.tif", "--resolution", "fine"), 2, "is 'fine': give a"),
        (("raster", "tin.ply", "out.tif", "--resolution", "1,2,3"), 2, "resolution is"),
        (("raster", "tin.ply", "out.tif", "--resolution", "1e-12"), 3, "too many"),
        (("raster", "tin.ply", "out.tif"), 2, "--resolution"),
        (
            ("raster", "tin.ply", "out.tif", "--resolution", "1", "--raster-bounds", "1,2"),
            2,
            "bounds",
        ),
        (("raster", "tin.ply", "out.tif", "--resolution", "1", "--crs", "EPSG:1"), 2, "EPSG:1"),
        (("raster", "tin.ply", "out.tif", "--resolution", "1", "--compress", "x"), 2, "'x'"),
        (("raster", "tin.ply", "no/out.tif", "--resolution", "1"), 3, "does not exist"),
        (("raster", "tin.ply", "tin.ply", "--resolution", "1"), 2, "same file"),
        (("raster", "a.tif", "a.tif", "--resolution", "1"), 2, "same file"),
        (("raster", "tin.ply", "-", "--resolution", "1"), 3, "-: rasters are written as GeoTIFF"),
        (("raster", "none.ply", "o.jpg", "--resolution", "1"), 3, "o.jpg: rasters are written"),
        (("raster", "none.ply", "o.tif", "--resolution", "1", "--crs", "EPSG:abc"), 2, "EPSG:abc"),
        (("raster", "none.ply", "o.tif", "--resolution", "1", "--compress", "x"), 2, "'x'"),
        (("raster", "utm.ply", "o.tif", "--resolution", "1", "--crs", "EPSG:4326"), 3, "not in --"),
        (
            ("sample", "utm.ply", "out.ply", "--at", "dutch.ply"),
            3,
            "dutch.ply is in 'EPSG:28992'",
        ),
        (("raster", "tin.ply", "o.tif", "--resolution", "1e-320"), 3, "pixels are too many"),
        (("contour", "none.ply", "lines.kml", "--interval", "1"), 3, "lines.kml: contours are"),
        (("raster", "none.ply", "out.tif", "--resolution", "1"), 3, "none.ply: No such file"),
        (("raster", "bent.ply", "out.tif", "--resolution", "1"), 3, "bent.ply: face 0, of the"),
        (("contour", "tin.ply", "out.geojson", "--interval", "0"), 2, "give a positive number"),
        (("contour", "tin.ply", "out.geojson", "--interval", "1e-9"), 3, "levels: give a larger"),
        (
            ("contour", "tin.ply", "out.geojson", "--interval", "1", "--contour-base", "x"),
            2,
            "--contour-base",
        ),
        (("contour", "tin.ply", "out.geojson", "--interval", "1", "--boundary-only"), 2, "needs"),
        (("contour", "tin.ply", "out.geojson", "--interval", "1", "--max-edge", "1e-9"), 3, "left"),
        (("contour", "tin.ply", "out.geojson"), 2, "either --interval or --levels"),
        (("contour", "tin.ply", "out.geojson", "--levels", "1,x"), 2, "is 'x': give a"),
        (
            ("contour", "tin.ply", "out.geojson", "--levels", "1", "--contour-base", "3"),
            2,
            "--contour-base is of --interval only, and --levels is given: leave one out",
        ),
        (
            ("contour", "tin.ply", "o.gpkg", "--levels", "1", "--trim-polygon", "none.gpkg"),
            3,
            "none",
        ),
        (
            ("contour", "tin.ply", "o.gpkg", "--levels", "1", "--trim-polygon", "at.csv"),
            3,
            "at.csv",
        ),
        (("contour", "tin.ply", "o.gpkg", "--levels", "1", "--max-radius", "0"), 2, "positive"),
        (("contour", "tin.ply", "no/out.geojson", "--interval", "1"), 3, "does not exist"),
        (("sample", "tin.ply", "out.csv", "--at", "none.csv"), 3, "none.csv: No such file"),
        (("sample", "tin.ply", "out.csv"), 2, "--at"),
        (("solid", "tin.ply", "out.stl"), 2, "give one of --base-height, --thickness"),
        (
            ("solid", "tin.ply", "out.stl", "--base-height", "1", "--z-factor", "2"),
            2,
            "needs --longest",
        ),
        (("solid", "tin.ply", "out.stl", "--base-height", "1e9"), 3, "reaches its base"),
        (("solid", "tin.ply", "out.stl", "--thickness", "0"), 2, "give a positive number"),
        (("solid", "none.ply", "out.png", "--base-height", "0"), 3, "out.png"),
        (
            ("sample", "tin.ply", "out.csv", "--at", "at.csv", "--interpolation", "cubic"),
            2,
            "--interpolation",
        ),
        (("sample", "tin.ply", "out.what", "--at", "at.csv"), 3, "out.what"),
        (("sample", "tin.ply", "at.csv", "--at", "at.csv"), 2, "same file"),
        (("raster", "tin.ply", "o.tif", "--resolution", "1e-5"), 3, "pixels are too many"),
        (("raster", "tin.ply", "o.tif", "--resolution", "nan"), 2, "is nan: give a"),
        (("raster", "tin.ply", "o.tif", "--resolution", "-1"), 2, "--resolution is -1.0: give"),
        (
            ("raster", "tin.ply", "o.tif", "--resolution", "1", "--compress", "x"),
            2,
            "--compress 'x' is unknown: give",
        ),
        (
            ("raster", "tin.ply", "o.tif", "--resolution", "1", "--raster-bounds", "3,3,0,0"),
            2,
            "--raster-bounds",
        ),
        (("raster", "none.ply", "o.tif", "--resolution", "0"), 2, "--resolution is 0.0: give a"),
        (
            ("raster", "none.ply", "o.tif", "--resolution", "1", "--raster-bounds", "0,0,1"),
            2,
            "--raster-bounds",
        ),
        (
            ("raster", "none.ply", "o.tif", "--resolution", "1", "--raster-bounds", "10,10,0,0"),
            2,
            "--raster-bounds are [10.0, 10.0, 0.0, 0.0]: give xmin, ymin, xmax, ymax (see liftmesh",
        ),
        (
            (
                "raster",
                "none.ply",
                "o.tif",
                "--resolution=1",
                "--quantity=slope",
                "--interpolation=sibson",
            ),
            2,
            "slope is that of faces: leave out --interpolation sibson",
        ),
        (
            ("contour", "none.ply", "o.geojson", "--interval", "1", "--min-length", "-1"),
            2,
            "--min-length is -1.0: give a number, not below zero",
        ),
        (("raster", "nan.csv", "o.tif", "--resolution", "1"), 3, "with --nonfinite skip"),
        (
            ("raster", "tin.ply", "o.tif", "--resolution", "1", "--trim-polygon", "far.json"),
            3,
            "faces",
        ),
        (("contour", "tin.ply", "o.geojson", "--interval", "1e-12"), 3, "--interval is 1e-12"),
        (
            ("contour", "tin.ply", "o.geojson", "--interval", "1", "--min-length", "-1"),
            2,
            "--min-length is -1.0",
        ),
        (("sample", "tin.ply", "o.csv", "--at", "names.csv"), 3, "has no column x or y"),
        (("sample", "nan.csv", "o.csv", "--at", "at.csv"), 3, "with --nonfinite skip"),
        (("volume", "utm.ply", "dutch.ply"), 3, "read both with the same --dst-crs"),
        (("volume", "tin.ply", "--level", "nan"), 2, "--level is nan: give a"),
        (("volume", "tin.ply", "--within", "far.json"), 3, "no area in common with the faces"),
        (
            ("solid", "tin.ply", "o.stl", "--base-height", "nan"),
            2,
            "--base-height is nan: give a",
        ),
        (("thin", "nan.csv", "o.ply", "--adaptive", "3"), 3, "remove such rows first"),
        (("thin", "tin.ply", "o.ply", "--cell", "nan"), 2, "--cell is nan: give a positive"),
        (("triangulate", "meadow.csv", "out.ply", "--max-edge", "-1"), 2, "give a positive number"),
        (("triangulate", "meadow.csv", "out.ply", "--boundary-only"), 2, "needs --max-edge"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing_behind(
    tin, tmp_path, words, code: int, said: str
) -> None:
    (tmp_path / "at.csv").write_text("x,y\n20,20\n")
    (tmp_path / "names.csv").write_text("foo,bar\n20,20\n")
    (tmp_path / "nan.csv").write_text("x,y,z\n0,0,1\n1,0,nan\n0,1,2\n1,1,3\n")
    far = {"type": "Polygon", "coordinates": [[[900, 900], [901, 900], [901, 901]]]}
    (tmp_path / "far.json").write_text(json.dumps(far))
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    faces = np.array([[0, 1, 3], [0, 2, 3]], dtype=np.int32)  # overlap
    liftmesh.write(tmp_path / "bent.ply", liftmesh.Cloud(square, faces=faces))
    liftmesh.triangulate(square, crs="EPSG:25832").save(tmp_path / "utm.ply")
    liftmesh.triangulate(square, crs="EPSG:28992").save(tmp_path / "dutch.ply")
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    failed(run(*words, cwd=tmp_path), code, said)
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before
