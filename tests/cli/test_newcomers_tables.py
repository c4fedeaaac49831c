"""Tables as other programs export them: the command that is typed, what is said, what comes out.

Each file is written as the documentation of its program describes the export, and holds the same
three points. Where a table has two readings, the first command is refused, and the option that the
message names is what the second one takes.
"""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any, NamedTuple

import laspy
import numpy as np
import pandas as pd
import polars as pl
import pytest
import trimesh
from commands import liftmesh

import liftmesh as lm
from liftmesh.cli import exit_codes

POINTS = [[512345.25, 5403210.5, 312.4], [512350.75, 5403212, 310.1], [512347, 5403220.125, 315]]
NORTH_FIRST = (
    "1,5403210.5,512345.25,312.4{}\n2,5403212,512350.75,310.1{}\n3,5403220.125,512347,315{}\n"
)
GERMAN = "1;512345,25;5403210,5;312,4\r\n2;512350,75;5403212;310,1\r\n3;512347;5403220,125;315\r\n"


class Task(NamedTuple):
    """A file, what refuses it if anything does, the options that read it, and what is said then."""

    name: str
    data: str | bytes
    refused: str = ""
    options: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    holds: tuple[str, ...] = ()
    points: list[list[float]] = POINTS


TASKS = {
    "QGIS, GEOMETRY=AS_XY": Task(
        "layer.csv",
        "X,Y,fid,name,elevation\r\n"
        '512345.25,5403210.5,1,Hügel,312.4\r\n512350.75,5403212,2,"Tal, unten",310.1\r\n'
        "512347,5403220.125,3,,315\r\n",
        said=("z is 'elevation'", "not read: column name (text, line 2: 'Hügel')"),
        holds=("fid",),
    ),
    "QGIS, AS_XYZ beside a field of heights": Task(
        "layer.csv",
        "X,Y,Z,fid,elevation\n512345.25,5403210.5,0,1,312.4\n"
        "512350.75,5403212,0,2,310.1\n512347,5403220.125,0,3,315\n",
        refused="the header has 2 columns for 'z', 'Z', 'elevation': read it with --columns x=..",
        options=("--columns", "z=elevation"),
        said=("z is 'elevation'",),
        holds=("Z", "fid"),
    ),
    "QGIS, SEPARATOR=SEMICOLON and decimal commas": Task(
        "layer.csv",
        '"fid";"X";"Y";"Höhe"\r\n' + GERMAN,
        said=("z is 'Höhe'", "commas are decimal, as in '512345,25'"),
        holds=("fid",),
    ),
    "CloudCompare, with the title of columns and the number of points": Task(
        "cloud.asc",
        "//X Y Z R G B Scalar_field\n3\n512345.25 5403210.5 312.4 255 0 0 0.25\n"
        "512350.75 5403212 310.1 0 255 0 0.5\n512347 5403220.125 315 0 0 255 0.75\n",
        refused="with --skip-rows 2 and --columns X,Y,Z,R,G,B,Scalar_field",
        options=("--skip-rows", "2", "--columns", "X,Y,Z,R,G,B,Scalar_field"),
        holds=("Scalar_field", "colors"),
    ),
    "a controller's PNEZD": Task(
        "job.csv",
        NORTH_FIRST.format(",CP", ",", ",TREE 0.3"),
        refused="(or 'id,y,x,z,column_5' if northing comes first)",
        options=("--columns", "id,y,x,z,column_5"),
        said=("not read: column column_5 (text, line 1: 'CP')",),
        holds=("id",),
    ),
    "a controller's PNEZD, sorted by code": Task(
        "job.txt",
        "1001 5403210.5 512345.25 312.4\n12 5403212 512350.75 310.1\n507 5403220.125 512347 315\n",
        refused="whole numbers that are all different, from 1001 to 507, x or an id",
        options=("--columns", "id,y,x,z"),
        holds=("id",),
    ),
    "a controller's file with a header": Task(
        "job.csv",
        "P,N,E,Z,D\n" + NORTH_FIRST.format(",CP", ",", ",TREE"),
        said=("x is 'E', y is 'N', z is 'Z'", "not read: column D"),
        holds=("P",),
    ),
    "Leica, a format file with tabs and units": Task(
        "leica.txt",
        "Point ID\tEasting [m]\tNorthing [m]\tOrtho. Height [m]\tPoint Code\n"
        "GPS1\t512345.25\t5403210.5\t312.4\tCP\nGPS2\t512350.75\t5403212\t310.1\t\n"
        "GPS3\t512347\t5403220.125\t315\tTR\n",
        said=("z is 'Ortho. Height [m]'", "column Point ID (text, line 2: 'GPS1')"),
    ),
    "English spreadsheet, thousands in groups": Task(
        "sheet.csv",
        '\ufeffPoint,Easting,Northing,Height\r\nA,"512,345.25","5,403,210.50",312.4\r\n',
        refused="line 2, value 2: '512,345.25' is not a number: save it without the marks between",
    ),
    "German spreadsheet in cp1252": Task(
        "sheet.csv",
        ("Punkt;Rechtswert;Hochwert;Höhe\r\n" + GERMAN).encode("cp1252"),
        refused="read it with --encoding cp1252",
        options=("--encoding", "cp1252"),
        said=("x is 'Rechtswert', y is 'Hochwert', z is 'Höhe'",),
        holds=("Punkt",),
    ),
    "French spreadsheet, narrow blanks between thousands": Task(
        "sheet.csv",
        "\ufeffPoint;X (m);Y (m);Altitude (m)\r\nA;512\u202f345,25;5\u202f403\u202f210,5;312,4\r\n",
        refused="value 2: '512\\u202f345,25' is not a number: save it without the marks between",
    ),
    "Polish spreadsheet, a heading that is not known": Task(
        "sheet.csv",
        "\ufeffNr;X;Y;Rzędna [m]\r\n" + GERMAN,
        refused="no column of 'Nr', 'X', 'Y', 'Rzędna [m]' is known as the height z",
        options=("--columns", "z=Rzędna [m]"),
        holds=("Nr",),
    ),
    "Japanese spreadsheet in cp932": Task(
        "sheet.csv",
        (
            "点名,X座標,Y座標,標高\r\nT1,5403210.5,512345.25,312.4\r\nT2,5403212,512350.75,310.1\r\n"
            "T3,5403220.125,512347,315\r\n"
        ).encode("cp932"),
        refused="cp932 for Japan",
        options=("--encoding", "cp932", "--columns", "x=Y座標,y=X座標,z=標高"),
        said=("x is 'Y座標', y is 'X座標', z is '標高'",),
    ),
    "PDAL's writers.text": Task(
        "points.txt",
        '"X","Y","Z","Intensity","Red","Green","Blue"\n'
        "512345.250,5403210.500,312.400,143.000,68.000,77.000,88.000\n"
        "512350.750,5403212.000,310.100,18.000,54.000,66.000,68.000\n"
        "512347.000,5403220.125,315.000,118.000,112.000,97.000,114.000\n",
        holds=("Intensity", "colors"),
    ),
    "las2txt -coldesc": Task(
        "points.txt",
        "x y z classification number_of_returns return_number\n"
        "512345.25 5403210.5 312.4 2 1 1\n512350.75 5403212 310.1 2 2 1\n"
        "512347 5403220.125 315 6 1 1\n",
        holds=("classification", "number_of_returns", "return_number"),
    ),
    "las2txt -parse xyzi": Task(
        "points.txt",
        "512345.25 5403210.5 312.4 143\n512350.75 5403212 310.1 18\n512347 5403220.125 315 118\n",
        said=("there is no header: columns 1, 2 and 3 are read as x, y and z",),
        holds=("column_4",),
    ),
    "a logger's track": Task(
        "track.csv",
        "time,lat,lon,elevation,speed\n2024-05-01T10:00:00Z,52.5,13.25,34.5,1.5\n"
        "2024-05-01T10:00:05Z,52.75,13.5,34.75,\n2024-05-01T10:00:10Z,52.5,13.75,35,2\n",
        said=("x is 'lon', y is 'lat'", "x and y are degrees", "'2024-05-01T10:00:00Z'"),
        holds=("speed",),
        points=[[13.25, 52.5, 34.5], [13.5, 52.75, 34.75], [13.75, 52.5, 35]],
    ),
    "a database's dump": Task(
        "dump.csv",
        "id,x,y,z,measured_at,remark\n1,512345.25,5403210.5,312.4,2019-05-01 10:00,\n"
        '2,512350.75,5403212,310.1,2019-05-01 10:05,""\n3,512347,5403220.125,315,NULL,NULL\n'
        "4,512349,5403221,NULL,NULL,NULL\n",
        refused="line 5, value 4: 'NULL' is not a number: if it stands for a missing value, read",
        options=("--nodata", "NULL", "--nonfinite", "skip"),
        said=("column measured_at (text, line 2: '2019-05-01 10:00')", "remark (empty)"),
        holds=("id",),
        points=[*POINTS, [512349, 5403221, np.nan]],
    ),
    "positions and an id": Task(
        "positions.txt",
        "512345.25 5403210.5 1\n512350.75 5403212 2\n512347 5403220.125 3\n",
        refused="the third column holds whole numbers that grow from 1 to 3, z or an id",
        options=("--columns", "x,y,id"),
        holds=("id",),
        points=[[x, y, 0] for x, y, _ in POINTS],
    ),
}


@pytest.fixture(params=TASKS)
def task(request: pytest.FixtureRequest) -> Task:
    return TASKS[request.param]


def test_a_newcomer_gets_the_points_or_a_remedy(task: Task, tmp_path: Path) -> None:
    data = task.data if isinstance(task.data, bytes) else task.data.encode()
    (tmp_path / task.name).write_bytes(data)
    if task.refused:
        done = liftmesh("triangulate", task.name, "mesh.npz", cwd=tmp_path)
        assert done.returncode == exit_codes.BAD_INPUT
        assert task.refused in done.stderr
        assert not (tmp_path / "mesh.npz").exists()
    if task.options or not task.refused:
        words = ("triangulate", task.name, "mesh.npz", *task.options, "--json")
        done = liftmesh(*words, cwd=tmp_path)
        assert done.returncode == exit_codes.DONE, done.stderr
        assert [each for each in task.said if each not in done.stderr] == []
        mesh = lm.read(tmp_path / "mesh.npz")
        assert np.array_equal(mesh.points, task.points, equal_nan=True)
        found = {*mesh.attributes, *(["colors"] if mesh.colors is not None else [])}
        assert found == {*task.holds}
        assert len(mesh.faces) == 1
        assert {"x", "y"} <= {*json.loads(done.stdout)["columns"]}


def test_info_shows_what_was_taken_for_what(tmp_path: Path) -> None:
    path = tmp_path / "job.csv"
    path.write_text(TASKS["a controller's file with a header"].data)
    done = liftmesh("info", path)
    assert "columns     x = E, y = N, z = Z\n" in done.stdout
    assert "310.1 to 315" in done.stdout
    assert "x is 'E', y is 'N', z is 'Z'" in done.stderr


DUMP = TASKS["a database's dump"].data


@pytest.mark.parametrize("read", [pd.read_csv, pl.read_csv])
def test_a_frame_of_the_same_dump(read: Any) -> None:
    frame = read(io.StringIO(DUMP), **({"null_values": "NULL"} if read is pl.read_csv else {}))
    with pytest.raises(lm.NonFiniteError, match="row 3 is not finite"):
        lm.triangulate(frame)
    surface = lm.triangulate(frame, nonfinite="skip")
    assert surface.vertices[:3].tolist() == POINTS
    assert surface.report.columns == {"x": "x", "y": "y", "z": "z"}
    assert surface.attributes["id"].tolist() == [1, 2, 3, 4]
    assert "column measured_at" in str(surface.metadata["not_read"])


def test_a_frame_whose_heights_are_text_is_refused() -> None:
    frame = pl.read_csv(io.StringIO(DUMP))
    with pytest.raises(lm.InputError, match=r"'z', which holds no numbers \(row 3: 'NULL'\)"):
        lm.triangulate(frame)


def test_the_arrays_of_a_pipeline() -> None:
    kinds = [("X", "f8"), ("Y", "f8"), ("Z", "f8"), ("Intensity", "u2"), ("Red", "u2")]
    array = np.zeros(3, dtype=[*kinds, ("Green", "u2"), ("Blue", "u2")])
    for name, values in zip("XYZ", np.array(POINTS).T, strict=True):
        array[name] = values
    array["Red"] = [65280, 0, 256]
    surface = lm.triangulate(array)
    assert surface.vertices.tolist() == POINTS
    assert surface.attributes["Intensity"].dtype == np.uint16
    assert surface.colors is not None
    assert surface.colors[:, 0].tolist() == [65280, 0, 256]


def test_points_of_laspy() -> None:
    header = laspy.LasHeader(point_format=3, version="1.2")
    header.scales = [0.125, 0.125, 0.1]
    data = laspy.LasData(header)
    data.x, data.y, data.z = np.array(POINTS).T
    data.classification = [2, 2, 6]
    surface = lm.triangulate(data)
    assert np.allclose(surface.vertices, POINTS, rtol=0, atol=1e-9)
    assert surface.attributes["classification"].tolist() == [2, 2, 6]


def test_a_scene_of_two_clouds() -> None:
    moved = trimesh.transformations.translation_matrix([10, 0, 0])
    scene = trimesh.Scene([trimesh.PointCloud(POINTS)])
    scene.add_geometry(trimesh.PointCloud(POINTS), transform=moved)
    surface = lm.triangulate(scene)
    assert surface.vertices[:, 0].tolist() == [x + dx for dx in (0, 10) for x, _, _ in POINTS]
    assert surface.report.n_used == 6
