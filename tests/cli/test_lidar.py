"""The commands on lidar: ground by default, said aloud, and every row accounted for."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import pytest
from commands import COMMAND, PLAIN, liftmesh, process
from files.las import copc, encoded, patched, tile

import liftmesh as lm

COUNT = 600


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    las = tile(COUNT, point_format=6, version="1.4")
    las.withheld = (np.arange(COUNT) % 50 == 0).astype(np.uint8)
    las.synthetic = (np.arange(COUNT) % 60 == 1).astype(np.uint8)
    las.overlap = (np.arange(COUNT) % 60 < 12).astype(np.uint8)
    (tmp_path / "tile.laz").write_bytes(encoded(las, compressed=True))
    return tmp_path


def test_a_surface_takes_the_ground_and_says_so(folder: Path) -> None:
    done = liftmesh("triangulate", "tile.laz", "tin.ply", cwd=folder)
    assert done.returncode == 0
    whole, mesh = lm.read(folder / "tile.laz"), lm.read(folder / "tin.ply")
    is_kept = (whole.attributes["classification"] == 2) & (whole.attributes["withheld"] == 0)
    assert np.array_equal(mesh.points, whole.points[is_kept])
    assert "withheld" in mesh.attributes
    line = (
        "tile.laz: ground (class 2): 296 of 600 rows; left out: 12 withheld, 292 of other classes"
    )
    assert line in done.stderr
    synthetic = np.count_nonzero(whole.attributes["synthetic"][is_kept])
    overlap = np.count_nonzero(whole.attributes["overlap"][is_kept])
    assert f"among them {synthetic} synthetic and {overlap} in the overlap of flight" in done.stderr


@pytest.mark.parametrize("kind", ["laz", "las"])
def test_a_pipe_takes_the_same_rows_as_a_file(kind: str, folder: Path) -> None:
    lm.write(folder / "tile.las", lm.read(folder / "tile.laz"))
    data = (folder / f"tile.{kind}").read_bytes()
    assert liftmesh("triangulate", f"tile.{kind}", "a.ply", cwd=folder).returncode == 0
    done = process(
        "triangulate", "-", "b.ply", "--input-format", kind, cwd=folder, stdin=data, text=False
    )
    assert "ground (class 2): 296 of 600 rows" in done.stderr.decode()
    file, pipe = (lm.read(folder / name) for name in ("a.ply", "b.ply"))
    assert np.array_equal(file.points, pipe.points)
    assert len(pipe) == 296


def test_options_choose_other_rows(folder: Path) -> None:
    words = ("triangulate", "tile.laz", "tin.ply", "--all-classes", "--withheld", "--json")
    done = liftmesh(*words, cwd=folder)
    assert json.loads(done.stdout)["n_rows"] == COUNT
    words = ("--classes", "2,9", "--returns", "last", "--bounds", "500000,5400000,500900,5400900")
    words += ("--z-range", "5,45", "--every", "2", "--json", "--overwrite")
    done = liftmesh("triangulate", "tile.laz", "tin.ply", *words, cwd=folder)
    report = json.loads(done.stdout)
    chosen = lm.read(
        folder / "tile.laz",
        classes=(2, 9),
        returns="last",
        bounds=(500000, 5400000, 500900, 5400900),
        z_range=(5, 45),
        every=2,
        withheld=False,
    )
    assert report["n_rows"] == len(chosen) > 30
    (note, *_) = report["notes"]
    numbers = [int(each.replace(",", "")) for each in re.findall(r"[\d,]*\d", note)]
    assert numbers[0] == len(chosen)
    assert numbers[1] == COUNT == numbers[0] + sum(numbers[2:])


def test_info_counts_classes_returns_and_flags(folder: Path) -> None:
    shown = liftmesh("info", "tile.laz", cwd=folder).stdout
    assert re.search(r"classes +2 ground 300, 5 high vegetation 100, 7 low noise 100, 9 wa", shown)
    assert re.search(r"returns +1: 300, 2: 200, 3: 100", shown)
    assert re.search(r"flags +withheld 12, synthetic 10, overlap 120", shown)
    found = json.loads(liftmesh("info", "tile.laz", "--json", cwd=folder).stdout)
    assert found["n_rows"] == COUNT
    assert found["lidar"]["classes"] == {"2": 300, "5": 100, "7": 100, "9": 100}
    part = json.loads(liftmesh("info", "tile.laz", "--classes", "9", "--json", cwd=folder).stdout)
    assert part["n_rows"] == 100
    assert part["notes"][0] == "100 of 600 rows; left out: 500 of other classes"


@pytest.mark.parametrize(("point_format", "version"), [(3, "1.2"), (6, "1.4")])
def test_overlap_is_a_class_of_older_formats_and_a_flag_of_later_ones(
    tmp_path: Path, point_format: int, version: str
) -> None:
    las = tile(60, point_format=point_format, version=version)
    las.classification = np.resize(np.array([12, 12, 18, 31], np.uint8), 60)
    las.synthetic = np.zeros(60, np.uint8)
    if point_format == 6:
        las.overlap = np.arange(60) < 7
        las.classification[:4] = 65
    (tmp_path / "a.las").write_bytes(encoded(las))
    done = liftmesh("triangulate", "a.las", "a.ply", cwd=tmp_path)
    assert "a.las: no ground (class 2), so all classes: 60 of 60 rows" in done.stderr
    count = 30 if point_format == 3 else 7
    assert f"among them {count} in the overlap of flight lines" in done.stderr
    if point_format == 6:
        las.overlap[:] = 0
        (tmp_path / "b.las").write_bytes(encoded(las))
        assert "overlap" not in liftmesh("triangulate", "b.las", "b.ply", cwd=tmp_path).stderr
    shown = liftmesh("info", "a.las", cwd=tmp_path).stdout
    classes = "12 overlap 30, 18 high noise 15, 31 15"
    later = "12 overlap 28, 18 high noise 14, 31 14, 65 4"
    assert f"classes     {classes if point_format == 3 else later}\n" in shown


def test_a_header_of_garbage_is_refused_at_once(tmp_path: Path) -> None:
    for size in (4, 100, 227, 4000):
        for fill in (b"\xff", b"\x02", b"\x7f\x01"):
            (tmp_path / "a.las").write_bytes((b"LASF" + fill * size)[:size])
            done = liftmesh("info", "a.las", cwd=tmp_path)
            assert done.returncode == 3
            assert re.fullmatch(r"liftmesh: error: a\.las: [^\n]+\n", done.stderr)


def test_comparing_takes_the_ground(folder: Path) -> None:
    done = liftmesh("compare", "tile.laz", cwd=folder)
    assert "ground (class 2): 296 of 600 rows" in done.stderr
    assert done.returncode == 0


def test_tables_are_taken_whole(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,y,z,class\n0,0,1,2\n1,0,1,5\n0,1,1,2\n")
    done = liftmesh("triangulate", "a.csv", "a.ply", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["n_rows"] == 3


def test_nothing_is_left_of_a_tile(folder: Path) -> None:
    done = liftmesh("triangulate", "tile.laz", "tin.ply", "--classes", "99", cwd=folder)
    assert done.returncode == 3
    assert "error: tile.laz: none of 600 rows meets the conditions" in done.stderr
    assert not (folder / "tin.ply").exists()
    (folder / "none.las").write_bytes(encoded(tile(0)))
    done = liftmesh("triangulate", "none.las", "tin.ply", cwd=folder)
    assert done.returncode == 3
    assert "none.las: " in done.stderr


WRONG = {
    ("--classes", "trees"): "--classes is 'trees': give ground, or numbers as 2,9",
    ("--classes", "all"): "--classes is 'all': give --all-classes",
    ("--classes", "300"): "--classes is [300]: give numbers from 0 to 255",
    ("--returns", "second"): "--returns 'second' is unknown: give first, last or only",
    ("--bounds", "1,2,3"): "--bounds is [1.0, 2.0, 3.0]: give xmin, ymin, xmax, ymax",
    ("--bounds", "a,b"): "--bounds is 'a': give a number",
    ("--z-range", "3,1"): "--z-range is [3.0, 1.0]: give z0, z1 with z0 <= z1",
    ("--every", "0"): "--every is 0: give a whole number from 1",
}


@pytest.mark.parametrize("words", WRONG)
def test_conditions_that_are_none(words: tuple[str, str], folder: Path) -> None:
    for command in (("triangulate", "tile.laz", "tin.ply"), ("info", "tile.laz")):
        done = liftmesh(*command, *words, cwd=folder)
        assert done.returncode == 2
        assert WRONG[words] in done.stderr
    assert {each.name for each in folder.iterdir()} == {"tile.laz"}


@pytest.mark.parametrize("end", [100, 400, -50, -1])
def test_a_truncated_file_is_one_line(end: int, folder: Path) -> None:
    data = (folder / "tile.laz").read_bytes()
    (folder / "cut.laz").write_bytes(data[:end])
    done = process("triangulate", "cut.laz", "tin.ply", cwd=folder)
    assert done.returncode == 3
    assert re.fullmatch(r"liftmesh: error: cut\.laz: [^\n]+\n", done.stderr)
    assert not (folder / "tin.ply").exists()


def test_records_that_lie_are_one_line_at_once(folder: Path) -> None:
    (folder / "lie.las").write_bytes(patched(encoded(tile(6)), "<I", 100, 2**32 - 1))
    done = process("info", "lie.las", cwd=folder)
    assert done.returncode == 3
    assert done.stderr == (
        "liftmesh: error: lie.las: byte 100: the header states 4,294,967,295 records, but there "
        "are only 0 bytes before the points\n"
    )


@pytest.mark.parametrize("missing", ["laspy", "lazrs"])
def test_what_to_install_for_lidar(missing: str, folder: Path) -> None:
    program = (
        f"import sys; sys.modules[{missing!r}] = None\n"
        "sys.argv = ['liftmesh', 'info', 'tile.laz']\n"
        "from liftmesh.cli import program; sys.exit(program())"
    )
    import subprocess

    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 3
    assert re.fullmatch(
        rf"liftmesh: error: this needs {missing}, .*: pip install 'liftmesh\[las\]'\n", done.stderr
    )


def test_other_files_load_no_library_of_lidar(tmp_path: Path) -> None:
    program = (
        "import sys, liftmesh\n"
        "liftmesh.triangulate([[0, 0, 1], [1, 0, 2], [0, 1, 3]]).save('a.ply')\n"
        "liftmesh.read('a.ply', every=2)\n"
        "sys.exit(bool({'laspy', 'lazrs'} & {*sys.modules}))"
    )
    import subprocess

    subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True)


def test_a_part_of_a_copc_file(folder: Path) -> None:
    (folder / "tile.copc.laz").write_bytes(copc(tile(COUNT, point_format=6, version="1.4")))
    shown = liftmesh("info", "tile.copc.laz", cwd=folder).stdout
    assert re.search(r"copc +3 levels, spacing 16 at the first", shown)
    words = (
        "--copc-resolution",
        "20",
        "--bounds",
        "500000,5400000,500500,5400900",
        "--all-classes",
    )
    done = liftmesh("triangulate", "tile.copc.laz", "tin.ply", *words, cwd=folder)
    assert re.search(r"left out: 400 finer than the resolution, \d+ outside the box", done.stderr)
    (folder / "a.csv").write_text("x,y,z\n1,2,3\n")
    done = liftmesh("info", "a.csv", "--copc-resolution", "5", cwd=folder)
    assert "--copc-resolution, for which the file has no index (COPC)" in done.stderr
    assert "leave it out, or take every k-th row by --every\n" in done.stderr
    done = liftmesh("info", "tile.laz", "--copc-resolution", "0", cwd=folder)
    assert "--copc-resolution is 0: give a positive number" in done.stderr


@pytest.mark.parametrize(
    ("flag", "times", "shown"),
    [
        (0, (5.5, 604000.0), "5.5 to 604000.0  (seconds of a week)"),
        (0, (5.5, 1e6), "5.5 to 1000000.0  (stated as seconds of a week, which has only 604,800)"),
        (1, (-1e9, 300000000.5), "1980-01-06 00:00:00 to 2021-03-17 07:06:40"),
        (1, (1.0, 1e300), "2011-09-14 01:46:41 to 1e+300"),
    ],
)
def test_info_says_when_and_by_what(
    tmp_path: Path, flag: int, times: tuple[float, float], shown: str
) -> None:
    las = tile(3, point_format=6, version="1.4")
    las.gps_time = np.array([times[1], np.nan, times[0]])
    data = patched(encoded(las), "<H", 6, flag)
    data = patched(patched(data, "<32s", 58, b"a program\0rest"), "<HH", 90, 60, 2024)
    (tmp_path / "a.las").write_bytes(data)
    text = liftmesh("info", "a.las", cwd=tmp_path).stdout
    assert f"gps time    {shown}\n" in text
    assert "made by     a program, 2024-02-29\n" in text


def test_a_pipe_is_read_like_a_file(folder: Path) -> None:
    words = ("triangulate", "-", "tin.ply", "--input-format", "laz")
    data = (folder / "tile.laz").read_bytes()
    done = subprocess.run(
        [*COMMAND, *words], input=data, capture_output=True, cwd=folder, env=PLAIN, check=True
    )
    assert b"stdin: ground (class 2): 296 of 600 rows" in done.stderr
    assert len(lm.read(folder / "tin.ply")) == 296


def test_options_of_the_written_format(folder: Path) -> None:
    words = ("triangulate", "tile.laz", "out.las", "--scale", "0.5", "--point-format", "7")
    assert liftmesh(*words, cwd=folder).returncode == 0
    with laspy.open(folder / "out.las") as file:
        assert file.header.scales.tolist() == [0.5, 0.5, 0.5]
        assert file.header.point_format.id == 7
    done = liftmesh("triangulate", "tile.laz", "out.3mf", "--unit", "inch", cwd=folder)
    assert done.returncode == 0, done.stderr
    done = liftmesh("triangulate", "tile.laz", "out.ply", "--point-format", "7", cwd=folder)
    assert done.returncode == 2
    assert "--point-format: ply files have none" in done.stderr
    done = liftmesh("triangulate", "tile.laz", "new.las", "--point-format", "11", cwd=folder)
    assert done.returncode == 3
    assert "--point-format is 11: give a whole number from 0 to 10" in done.stderr
