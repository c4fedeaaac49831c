"""Tables on the command line: what is said of their columns, and the options in messages."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest
from commands import liftmesh, process

import liftmesh as lm
from liftmesh.cli import exit_codes

SURVEY = """Point;Rechtswert;Hochwert;Höhe [m];Code
A1;4500000,25;5300000,5;410,5;GB
A2;4500010;5300000;411;
A3;4500000;5300010,125;409,75;GB
"""


@pytest.fixture
def survey(tmp_path: Path) -> Path:
    path = tmp_path / "survey.csv"
    path.write_bytes(SURVEY.encode("utf-16"))
    return path


def test_the_mapping_is_said_on_stderr_in_info_and_in_json(survey: Path) -> None:
    said = "x is 'Rechtswert', y is 'Hochwert', z is 'Höhe [m]'"
    names = {"x": "Rechtswert", "y": "Hochwert", "z": "Höhe [m]"}
    done = liftmesh("triangulate", survey, survey.with_suffix(".ply"), "--json")
    assert done.returncode == exit_codes.DONE
    assert f"liftmesh: note: {survey}: {said}\n" in done.stderr
    assert "commas are decimal, as in '4500000,25'" in done.stderr
    assert "not read: column Point (text, line 2: 'A1'), column Code (text" in done.stderr
    report = json.loads(done.stdout)
    assert report["columns"] == names
    assert report["notes"][0] == said
    assert len(report["not_read"]) == 2
    mesh = lm.read(survey.with_suffix(".ply"))
    assert mesh.points[0].tolist() == [4500000.25, 5300000.5, 410.5]
    info = liftmesh("info", survey)
    assert "columns     x = Rechtswert, y = Hochwert, z = Höhe [m]\n" in info.stdout
    assert said in info.stderr
    found = json.loads(liftmesh("info", survey, "--json").stdout)
    assert (found["columns"], found["notes"][0]) == (names, said)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ("x=x,y=y,z=h", "--columns names 'h', which is not one of the columns"),
        ("x=x,y=y,z=x", "--columns takes 'x' for 'x' and for 'z': give two columns"),
        ("x=-x,y=y,z=z", "--columns gives 'x' a sign"),
        ("x,y", "--columns names 2 columns, and the table has 3"),
    ],
)
def test_messages_about_columns_name_the_option(tmp_path: Path, columns: str, said: str) -> None:
    path = tmp_path / "plain.csv"
    path.write_text("x,y,z\n0,0,1\n1,0,2\n0,1,3\n")
    done = liftmesh("info", path, "--columns", columns)
    assert done.returncode == exit_codes.BAD_INPUT
    assert f"{path}: line 1: {said}" in done.stderr


def test_a_depth_that_is_too_small_names_the_option(tmp_path: Path) -> None:
    path = tmp_path / "colors.csv"
    path.write_text("x,y,z,red,green,blue\n0,0,1,300,0,0\n1,0,2,0,0,0\n0,1,3,0,0,0\n")
    done = liftmesh("triangulate", path, tmp_path / "mesh.ply", "--color-depth", "8")
    assert done.returncode == exit_codes.BAD_INPUT
    assert "range of --color-depth 8: give another depth" in done.stderr


def test_plain_names_are_not_worth_a_line(tmp_path: Path) -> None:
    path = tmp_path / "plain.csv"
    path.write_text("X,Y,Z\n0,0,1\n1,0,2\n0,1,3\n")
    done = liftmesh("info", path)
    assert (done.returncode, done.stderr) == (exit_codes.DONE, "")
    assert "columns     x = X, y = Y, z = Z\n" in done.stdout


def test_degrees_are_a_note(tmp_path: Path) -> None:
    path = tmp_path / "track.csv"
    path.write_text("lng,lat,alt\n8,50,1\n9,50,2\n8,51,3\n")
    done = process("info", path)
    assert done.returncode == exit_codes.DONE
    assert "note: " in done.stderr
    assert "x and y are degrees" in done.stderr
    assert "Warning" not in done.stderr


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("id,x,y,GroundZ\n1,0,0,5\n2,4,0,6\n3,0,3,7\n", ["--flat"]),
        ("x,y,Water depth\n0,0,5\n4,0,6\n0,3,7\n", ["--columns", "z=-Water depth"]),
        ("1,0.5,0,5\n2,4,0.5,6\n3,0,3,7\n", ["--columns", "id,x,y,z"]),
        ("0 0 5\n4 0 6\n0 3 7\n1 1 -9999\n", ["--nodata", "-9999"]),
        ("3\n0 0 5\n4 0 6\n0 3 7\n", ["--skip-rows", "1"]),
        ("0 0 5\n4 0 6\n0 3 7\nEND\n", ["--end", "END"]),
        ("0,5 0 5\n4 0 6\n0 3 7\n", ["--decimal", ","]),
        ("0,125;0;5\n4;0;6\n0;3;7\n", ["--decimal", ","]),
        ("x,y,z\n0,0,NA\n4,0,6\n0,3,7\n1,1,2\n", ["--nodata", "NA"]),
    ],
)
def test_the_option_that_a_message_names_is_the_remedy(
    text: str, options: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "table.csv"
    path.write_text(text)
    done = liftmesh("triangulate", path, tmp_path / "mesh.ply")
    assert done.returncode == exit_codes.BAD_INPUT
    assert str(path) in done.stderr
    assert shlex.join(options) in done.stderr
    assert not re.search(r"\b(columns|nodata|skip_rows|decimal|end|flat)=", done.stderr)
    words = [*options, "--nonfinite", "skip"]
    again = liftmesh("triangulate", path, tmp_path / "mesh.ply", *words)
    assert again.returncode == exit_codes.DONE, again.stderr
    assert len(lm.read(tmp_path / "mesh.ply").faces) == 1


def test_all_options_reach_the_reader(tmp_path: Path) -> None:
    path = tmp_path / "table.txt"
    path.write_text("Title\n9:4,5:1:2:x\n9:4:0:-1:x\nSTOP\nmore\n")
    words = ["--skip-rows", "1", "--delimiter", ":", "--decimal", ",", "--no-header"]
    words += ["--columns", "-,y,x,z,-", "--nodata", "-1", "--end", "STOP", "--json"]
    found = json.loads(liftmesh("info", path, *words).stdout)
    assert (found["n_rows"], found["n_not_finite"]) == (2, 1)
    assert found["minimum"] == [1, 4.5, 2]
    assert found["columns"] == {"x": "column_3", "y": "column_2", "z": "column_4"}


@pytest.mark.parametrize(
    "options", [["--delimiter", "ab"], ["--columns", "x="], ["--skip-rows", "-1"]]
)
def test_invalid_options_are_wrong_usage(options: list[str], survey: Path) -> None:
    done = liftmesh("info", survey, *options)
    assert done.returncode == exit_codes.USAGE
    assert options[0] in done.stderr


def test_options_of_tables_are_refused_for_other_files() -> None:
    done = liftmesh("info", "data/overhang.ply", "--flat")
    assert done.returncode == exit_codes.BAD_INPUT
    assert "ply files are read without options" in done.stderr
