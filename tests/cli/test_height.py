"""``liftmesh height``: heights above the ground, and everything else as it was."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import laspy
import numpy as np
import pytest
from commands import failed, liftmesh
from files.las import encoded, tile
from scipy.interpolate import LinearNDInterpolator

import liftmesh as lm

COUNT = 600


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    las = tile(COUNT, point_format=6, version="1.4")
    las.withheld = (np.arange(COUNT) % 50 == 0).astype(np.uint8)
    (tmp_path / "tile.laz").write_bytes(encoded(las, compressed=True))
    return tmp_path


def heights(cloud: lm.Cloud) -> np.ndarray:
    """Above the ground, by SciPy."""
    values = cloud.attributes
    ground = cloud.points[(values["classification"] == 2) & (values["withheld"] == 0)]
    return cloud.points[:, 2] - LinearNDInterpolator(ground[:, :2], ground[:, 2])(
        cloud.points[:, :2]
    )


@pytest.mark.parametrize("name", ["out.laz", "out.las"])
def test_all_else_stays(folder: Path, name: str) -> None:
    done = liftmesh("height", "tile.laz", name, cwd=folder)
    assert done.returncode == 0, done.stderr
    before, after = laspy.read(folder / "tile.laz"), laspy.read(folder / name)
    assert [*after.point_format.extra_dimension_names] == ["HeightAboveGround"]
    for dimension in before.point_format.dimension_names:
        assert np.array_equal(before[dimension], after[dimension]), dimension
    assert (before.header.scales == after.header.scales).all()
    expected = heights(lm.read(folder / "tile.laz"))
    np.testing.assert_allclose(after["HeightAboveGround"], expected, atol=1e-9)
    known = np.isfinite(expected).sum()
    assert f"{known} of {COUNT} points have a height" in done.stdout


def test_heights_are_those_of_the_library(folder: Path) -> None:
    cloud = lm.read(folder / "tile.laz")
    liftmesh("triangulate", "tile.laz", "ground.ply", cwd=folder)
    words = ("--ground", "ground.ply", "--extrapolate", "nearest", "--json", "--every", "2")
    told = json.loads(liftmesh("height", "tile.laz", "out.ply", *words, cwd=folder).stdout)
    assert (told["n_points"], told["n_known"]) == (COUNT // 2, COUNT // 2)
    surface = lm.as_surface(folder / "ground.ply")
    expected = surface.height_above(cloud.select(slice(0, None, 2)), extrapolate="nearest")
    found = lm.read(folder / "out.ply").attributes["HeightAboveGround"]
    np.testing.assert_array_equal(found, expected)
    assert told["n_faces"] == len(surface.faces)


def test_the_ground_is_whole_whatever_is_measured(folder: Path) -> None:
    liftmesh("height", "tile.laz", "all.ply", cwd=folder)
    liftmesh("height", "tile.laz", "few.ply", "--every", "5", cwd=folder)
    whole, few = (lm.read(folder / f"{name}.ply") for name in ("all", "few"))
    name = "HeightAboveGround"
    np.testing.assert_array_equal(few.attributes[name], whole.attributes[name][::5])


def test_heights_take_the_place_of_z(folder: Path) -> None:
    liftmesh("height", "tile.laz", "flat.ply", "--replace-z", cwd=folder)
    cloud, flat = lm.read(folder / "tile.laz"), lm.read(folder / "flat.ply")
    np.testing.assert_allclose(flat.points[:, 2], heights(cloud), atol=1e-9)
    np.testing.assert_array_equal(flat.attributes["given_z"], cloud.points[:, 2])


def test_without_a_ground(folder: Path) -> None:
    (folder / "plain.csv").write_text("x,y,z\n0,0,1\n4,0,1\n0,4,1\n1,1,5\n")
    failed(
        liftmesh("height", "plain.csv", "o.csv", cwd=folder), 3, "no classes: give --ground FILE"
    )
    failed(liftmesh("height", "tile.laz", "o.csv", "--ground", "no.ply", cwd=folder), 3, "no.ply")
    done = liftmesh("height", "plain.csv", "o.csv", "--ground", "plain.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert lm.read(folder / "o.csv").attributes["HeightAboveGround"].tolist() == [0, 0, 0, 0]


def test_no_row_of_the_ground(folder: Path) -> None:
    las = laspy.read(folder / "tile.laz")
    las.classification[:] = 5
    las.write(folder / "trees.las")
    done = liftmesh("height", "trees.las", "o.las", cwd=folder)
    assert done.returncode == 3
    assert done.stderr.endswith("error: trees.las: none of 600 rows meets the conditions\n")
    assert not (folder / "o.las").exists()


@pytest.mark.parametrize(
    ("words", "name"), [((), "HeightAboveGround"), (("--replace-z",), "given_z")]
)
def test_values_of_the_same_name_are_not_replaced(
    folder: Path, words: tuple[str, ...], name: str
) -> None:
    (folder / "in.csv").write_text(f"x,y,z,{name}\n0,0,1,7\n4,0,1,7\n0,4,1,7\n1,1,5,7\n")
    done = liftmesh("height", "in.csv", "o.csv", "--ground", "in.csv", *words, cwd=folder)
    failed(done, 3, f"in.csv: the points have values named '{name}', which this command writes")
    assert not (folder / "o.csv").exists()


def test_rows_without_z_are_not_measured(folder: Path) -> None:
    (folder / "flat.csv").write_text("x,y\n0,0\n4,0\n0,4\n1,1\n")
    surface = lm.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1.0]])
    cloud = lm.read(folder / "flat.csv", flat=True)
    for points in ([[1, 1]], np.ones((3, 2)), cloud):
        with pytest.raises(lm.InputError, match="the points have no z: give rows of x, y and z"):
            surface.height_above(points)
    with pytest.raises(lm.InputError, match="the ground has no z"):
        lm.triangulate(cloud).height_above([[1, 1, 1]])
    done = liftmesh("height", "flat.csv", "o.csv", "--ground", "flat.csv", "--flat", cwd=folder)
    assert done.returncode == 3
    assert "no z" in done.stderr


def test_heights_that_las_does_not_hold_as_z(folder: Path) -> None:
    done = liftmesh("height", "tile.laz", "o.laz", "--replace-z", cwd=folder)
    assert done.returncode == 3
    assert done.stderr.endswith("or write PLY or OBJ, or give --extrapolate nearest\n")
    words = ("--replace-z", "--extrapolate", "nearest")
    assert liftmesh("height", "tile.laz", "o.laz", *words, cwd=folder).returncode == 0


def test_a_ground_elsewhere_is_said(folder: Path) -> None:
    (folder / "far.csv").write_text("x,y,z\n0,0,1\n4,0,1\n0,5,1\n")
    done = liftmesh("height", "tile.laz", "o.laz", "--ground", "far.csv", cwd=folder)
    assert done.returncode == 0
    said = "note: tile.laz: no point is over the ground, whose x is from 0 to 4, and y from 0 to 5"
    assert said in done.stderr


def test_a_narrow_range_of_colours_is_said_once(folder: Path) -> None:
    las = laspy.read(folder / "tile.laz")
    las = laspy.convert(las, point_format_id=7)
    las.red[:] = 200
    las.write(folder / "colors.las")
    said = "no colour exceeds 255: they are read as 8-bit colours (--color-depth says another)"
    done = liftmesh("height", "colors.las", "o.las", cwd=folder)
    assert done.stderr.count("no colour exceeds") == done.stderr.count(said) == 1
    words = ("--color-depth", "16")
    assert "colour" not in liftmesh("height", "colors.las", "p.las", *words, cwd=folder).stderr


def test_above_a_surface_of_another_plane_and_system() -> None:
    ground = lm.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1.0]])
    wall = lm.triangulate(ground.vertices[:, [2, 0, 1]], plane="yz")
    points = np.array([[1, 1, 12], [2, 1, 6], [9, 9, 9.0]])
    np.testing.assert_array_equal(
        wall.height_above(points[:, [2, 0, 1]]), ground.height_above(points)
    )
    there = lm.Cloud(points, crs="EPSG:25832")
    with pytest.raises(lm.InputError, match=r"the points are in .* 32N', and the surface in"):
        ground.replace(crs="EPSG:25833").height_above(there)


def test_a_narrow_range_of_colours_is_said_once_of_a_part(folder: Path) -> None:
    las = laspy.convert(laspy.read(folder / "tile.laz"), point_format_id=7)
    las.red[:] = 200
    las.write(folder / "colors.las")
    box = f"{las.x.min()},{las.y.min()},{las.x.max()},{las.y.max()}"
    done = liftmesh("height", "colors.las", "o.las", "--bounds", box, cwd=folder)
    assert done.stderr.count("no colour exceeds") == 1, done.stderr


def test_chunks_have_the_bytes_of_the_whole(folder: Path) -> None:
    cloud = lm.read(folder / "tile.laz")
    ground = lm.triangulate(lm.read(folder / "tile.laz", classes=2, withheld=False))
    heights = ground.height_above(cloud)
    values = {**cloud.attributes, "HeightAboveGround": heights}
    lm.write(folder / "whole.laz", replace(cloud, attributes=values))
    done = liftmesh("height", "tile.laz", "out.laz", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert (folder / "out.laz").read_bytes() == (folder / "whole.laz").read_bytes()


def test_above_tiles(folder: Path) -> None:
    words = ("--surface", "--tile-rows", "100")
    done = liftmesh("tile", "tile.laz", "tiles", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    liftmesh("height", "tile.laz", "one.laz", cwd=folder)
    done = liftmesh("height", "tile.laz", "tiled.laz", "--ground", "tiles", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["n_faces"] == lm.open_tiled(folder / "tiles").nsimplex
    assert (folder / "tiled.laz").read_bytes() == (folder / "one.laz").read_bytes()
    words = ("--ground", "tiles", "--extrapolate", "nearest")
    done = liftmesh("height", "tile.laz", "o.laz", *words, cwd=folder)
    assert done.returncode == 2
    assert "--extrapolate is for files: tiles is a surface in tiles" in done.stderr
    assert not (folder / "o.laz").exists()


def test_a_damaged_file_leaves_none(folder: Path) -> None:
    las = laspy.read(folder / "tile.laz")
    las.write(folder / "whole.las")
    data = (folder / "whole.las").read_bytes()
    (folder / "part.las").write_bytes(data[: len(data) - 1000])
    failed(liftmesh("height", "part.las", "o.las", cwd=folder), 3, "part.las")
    assert not (folder / "o.las").exists()
