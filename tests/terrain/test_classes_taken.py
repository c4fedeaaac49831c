"""Which classes of lidar a surface takes: the library as the commands, over all files, and said."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command
from files.las import encoded, records

import liftmesh
from liftmesh import InputError
from liftmesh.io.read import bytes_of, classes_of, for_chunks

GROUND, TREES = 2, 5
EMPTY = "b.las: no ground (class 2), while other files have some"


def tile(first: float, classes: Any, **values: Any) -> bytes:
    """Make rows at x from a corner on: ground lies at 10, the rest stands at 40."""
    classes = np.asarray(classes, np.uint8)
    rng = np.random.default_rng(int(first))
    plane = np.round(rng.random((len(classes), 2)) * 50, 2) + np.array([first, 0.0])
    points = np.column_stack([plane, np.where(classes == GROUND, 10.0, 40.0)])
    return encoded(records(points, offset=(0, 0, 0), classification=classes, **values))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    mixed = np.resize([GROUND, GROUND, TREES], 60)
    withheld = (np.arange(60) % 20 == 0).astype(np.uint8)
    (tmp_path / "a.las").write_bytes(tile(0, mixed, withheld=withheld))
    (tmp_path / "b.las").write_bytes(tile(50, np.ones(40)))
    (tmp_path / "c.las").write_bytes(tile(100, mixed))
    return tmp_path


def test_the_library_takes_the_rows_that_the_command_takes(folder: Path) -> None:
    done = command("triangulate", "a.las", "a.ply", "--json", cwd=folder)
    report, mesh = json.loads(done.stdout), liftmesh.read(folder / "a.ply")
    surface = liftmesh.triangulate(folder / "a.las")
    assert np.array_equal(surface.vertices, mesh.points)
    assert (surface.vertices[:, 2] == 10).all()
    assert surface.report.classes == {GROUND: len(mesh)} == {2: report["classes"]["2"]}
    assert f"Rows by class: 2 ({len(mesh)}). " in str(surface.report)
    assert surface.metadata["selection"] == report["selection"]
    assert pickle.loads(pickle.dumps(surface)).report.classes == surface.report.classes


def test_a_file_of_another_suffix_is_lidar_if_its_format_says_so(folder: Path) -> None:
    other = (folder / "a.las").rename(folder / "a.bin")
    surface = liftmesh.triangulate(other, format="las")
    tiled = liftmesh.tile_surface(other, folder / "tiles", format="las")
    assert tiled.report.n_used == surface.report.n_used == 38
    assert tiled.report.classes == surface.report.classes == {GROUND: 38}


@pytest.mark.parametrize(("classes", "taken"), [("all", {2: 38, 5: 19}), (5, {5: 19})])
def test_other_classes_are_taken_if_asked(
    classes: Any, taken: dict[int, int], folder: Path
) -> None:
    assert liftmesh.triangulate(folder / "a.las", classes=classes).report.classes == taken
    found = liftmesh.simplify(folder / "a.las", classes=classes, max_error=0.0)
    assert {*found.report.classes} == {*taken}
    words = ("--all-classes",) if classes == "all" else ("--classes", str(classes))
    done = command("triangulate", "a.las", "a.ply", *words, cwd=folder)
    names = {2: "ground", 5: "high vegetation"}
    said = ", ".join(f"{each} {names[each]} {count}" for each, count in taken.items())
    assert f"classes     {said}" in done.stdout


def test_without_ground_all_classes_are_taken_and_said(folder: Path) -> None:
    assert liftmesh.triangulate(folder / "b.las").report.classes == {1: 40}
    assert liftmesh.simplify(folder / "a.las", max_error=0.0).report.classes.keys() == {GROUND}
    assert liftmesh.compare(folder / "a.las").triangulation.npoints == 38


def test_objects_are_taken_as_they_are(folder: Path) -> None:
    cloud = liftmesh.read(folder / "a.las")
    assert liftmesh.triangulate(cloud).report.classes == {2: 40, 5: 20}
    with pytest.raises(InputError, match="classes= is for files: select the rows of a cloud"):
        liftmesh.triangulate(cloud, classes=2)
    with pytest.raises(InputError, match="classes= is for files"):
        liftmesh.simplify(liftmesh.triangulate(cloud), max_error=1, classes=2)
    with pytest.raises(InputError, match=r"a.las: none of 60 rows meets the conditions"):
        liftmesh.triangulate(folder / "a.las", classes=9)


def test_one_file_without_ground_among_others_is_refused(folder: Path) -> None:
    done = command("triangulate", "a.las", "b.las", "c.las", "t.ply", cwd=folder)
    assert done.returncode == 3
    remedy = "give --all-classes for all rows of each file, --classes 2 for none of these, or find "
    assert f"{EMPTY}: {remedy}the ground with triangulate --ground csf" in done.stderr
    assert not (folder / "t.ply").exists()
    parts = [liftmesh.read(folder / name, classes="ground") for name in ("a.las", "b.las")]
    with pytest.raises(InputError, match=r"give classes='all' for all .*, classes=2 for none"):
        liftmesh.merge(parts)
    done = command("simplify", "a.las", "b.las", "t.ply", "--max-error", "1", cwd=folder)
    assert EMPTY in done.stderr


def test_the_remedies_work(folder: Path) -> None:
    names = ("a.las", "b.las", "c.las")
    done = command("triangulate", *names, "t.ply", "--classes", "2", "--json", cwd=folder)
    report = json.loads(done.stdout)
    assert [each["rows"] for each in report["merged"]] == [38, 0, 40]
    assert report["classes"] == {"2": 78}
    assert "b.las: 0 of 40 rows; left out: 40 of other classes" in done.stderr
    assert report["selection"] == {"rows": 160, "selected": 78, "withheld": 3, "classes": 79}
    done = command("triangulate", *names, "all.ply", "--all-classes", "--json", cwd=folder)
    assert json.loads(done.stdout)["classes"] == {"1": 40, "2": 78, "5": 39}


def test_no_row_of_any_file_is_an_error(folder: Path) -> None:
    done = command("triangulate", "a.las", "b.las", "t.ply", "--classes", "9", cwd=folder)
    assert done.returncode == 3
    assert "a.las, b.las: none of 100 rows meets the conditions" in done.stderr


def test_files_without_classes_and_empty_ones_go_with_ground(folder: Path) -> None:
    (folder / "marks.csv").write_text("x,y,z\n60,60,10\n70,60,10\n")
    (folder / "none.las").write_bytes(tile(150, []))
    words = ("a.las", "marks.csv", "none.las", "t.ply", "--json")
    report = json.loads(command("triangulate", *words, cwd=folder).stdout)
    assert (report["n_rows"], "ground" in report["selection"]) == (40, False)


def test_commands_say_the_classes(folder: Path) -> None:
    (folder / "marks.csv").write_text("x,y\n20,20\n25,25\n")
    for words in (
        ("raster", "a.las", "o.tif", "--resolution", "5"),
        ("contour", "a.las", "o.geojson", "--interval", "1"),
        ("volume", "a.las"),
        ("solid", "a.las", "o.stl", "--base-height", "0"),
        ("profile", "a.las", "o.csv", "--along", "20,20", "--along", "25,25"),
        ("sample", "a.las", "s.csv", "--at", "marks.csv"),
        ("simplify", "a.las", "o.ply", "--max-error", "1"),
        ("compare", "a.las"),
    ):
        done = command(*words, "--json", cwd=folder)
        assert {*json.loads(done.stdout)["classes"]} == {"2"}, words


def test_conditions_of_files_that_are_read_in_chunks(folder: Path) -> None:
    names = [folder / name for name in ("a.las", "b.las", "c.las")]
    found = for_chunks([names[0], "marks.csv"], {"every": 2})
    assert found == [{"classes": GROUND, "withheld": False, "every": 2}, {"every": 2}]
    assert for_chunks(names, {"classes": (2, 9)})[1]["classes"] == (2, 9)
    assert for_chunks(names[1:2], {})[0]["classes"] == "all"
    assert for_chunks(names, {"bounds": (0, 0, 50, 50)})[1]["classes"] == "all"
    with pytest.raises(InputError, match=r"b.las: no ground \(class 2\), while other files"):
        for_chunks(names, {"dst_crs": "EPSG:25832"})


@pytest.mark.parametrize("kind", [np.uint8, np.int64, np.float64])
def test_classes_are_counted(kind: Any) -> None:
    values = np.random.default_rng(1).integers(0, 256, 1_100_000)
    numbers, counts = np.unique(values, return_counts=True)
    found = bytes_of(values.astype(kind))
    assert found == dict(zip(numbers.tolist(), counts.tolist(), strict=True))
    assert classes_of({"Class": values[:3].astype(kind)})
    assert classes_of({"class": np.array([0.5])}) == classes_of({"other": values}) == {}
    for odd in (np.inf, -np.inf, np.nan):
        assert bytes_of(np.array([1, odd], kind if np.dtype(kind).kind == "f" else float)) == {}


def test_two_surfaces_are_of_the_same_classes(folder: Path) -> None:
    bare = liftmesh.read(folder / "a.las").points
    (folder / "later.las").write_bytes(encoded(records(bare, offset=(0, 0, 0))))
    done = command("volume", "a.las", "later.las", cwd=folder)
    assert done.returncode == 3
    assert "later.las: no ground (class 2), while other files have some" in done.stderr
    words = ("--all-classes", "--withheld", "--json")
    done = command("volume", "a.las", "later.las", *words, cwd=folder)
    assert (done.returncode, json.loads(done.stdout)["cut"]) == (0, 0.0)
    assert command("volume", "a.las", "c.las", cwd=folder).stderr.count("ground (class 2)") == 2


def test_surfaces_are_not_compared_with_those_of_files_without_ground(folder: Path) -> None:
    ground, trees = (liftmesh.triangulate(folder / name) for name in ("a.las", "b.las"))
    over = liftmesh.triangulate(folder / "a.las", classes="all")
    lot = [[5, 5], [45, 5], [25, 45]]
    for one, other, which in ((ground, trees, "the other"), (trees, ground, "this")):
        for call in (one.cut_and_fill, lambda it, one=one: one.cut_and_fill_by_polygon(it, lot)):
            with pytest.raises(InputError, match=f"the file of {which} surface: no ground"):
                call(other)
    assert ground.cut_and_fill(over).fill > 0
    assert ground.cut_and_fill(liftmesh.triangulate(ground.vertices)).fill == 0


def test_the_report_says_which_rows_were_read(folder: Path) -> None:
    report = liftmesh.triangulate(folder / "a.las").report
    left_out = {"withheld": 3, "classes": 19}
    assert report.selection == {"rows": 60, "selected": 38, "ground": 1, **left_out}
    assert "Read: ground (class 2): 38 of 60 rows; left out: " in str(report)
    bounded = liftmesh.triangulate(folder / "a.las", classes="all", bounds=(0, 0, 25, 50))
    assert 0 < bounded.report.n_rows < 60
    assert "Read: " not in str(liftmesh.triangulate(liftmesh.read(folder / "b.las")).report)
