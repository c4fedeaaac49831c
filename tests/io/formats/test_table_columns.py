"""What the columns of a table are: by their names, or by what the caller says, never by a guess."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, DataWarning, FormatError, InputError
from liftmesh.io.formats.text.columns import meaning
from liftmesh.io.options import validate_table_options

ROW = "1.5,2.5,3.5\n"
POINT = [[1.5, 2.5, 3.5]]


def read(text: str, **options: Any) -> Cloud:
    return liftmesh.read(io.BytesIO(text.encode()), format="csv", **options)


def refused(text: str, **options: Any) -> str:
    """The message of the error that reading a table raises, whole and in chunks."""
    with pytest.raises(FormatError) as caught:
        read(text, **options)
    with pytest.raises(FormatError) as in_chunks:
        [*liftmesh.read_chunks(io.BytesIO(text.encode()), format="csv", **options)]
    assert str(in_chunks.value) == str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    "header",
    [
        "x,y,Elev.",
        "X [m],Y [m],Z [m]",
        "X(m),Y(m),Z(m)",
        "x_m,y_m,z_m",
        "x/ft,y/ft,z/ft",
        "POINT_X,POINT_Y,POINT_Z",
        "E,N,Z",
        "e,n,h",
        "Easting,Northing,Elevation (m)",
        "Grid Easting (m),Grid Northing (m),Elevation (m)",
        "EASTING,NORTHING,ALT",
        "Easting (E),Northing (N),Height (H)",
        "Rechtswert,Hochwert,Hoehe",
        "Rechtswert,Hochwert,Höhe",
        "Ostwert,Nordwert,Höhe [m ü. NHN]",
        "X-Koordinate,Y-Koordinate,Z-Wert",
        "Abscisse,Ordonnée,Altitude",
        "Coordonnée X,Coordonnée Y,Hauteur",
        "Este,Norte,Cota",
        "Coordenada X,Coordenada Y,Altura",
        "Est,Nord,Quota",
        "Oost,Noord,Hoogte",
        "coordX,coordY,coordZ",
        "xcoord,ycoord,zcoord",
        "Points:0,Points:1,Points:2",
        "field.x,field.y,field.z",
        '"X","Y","Z"',
        "# X,Y,Z",
        "//X,Y,Height",
    ],
)
def test_known_names_in_any_form(header: str) -> None:
    cloud = read(f"{header}\n{ROW}")
    assert cloud.points.tolist() == POINT
    assert [*cloud.metadata["columns"]] == ["x", "y", "z"]
    names = [name.strip(' #/"') for name in header.split(",")]
    assert [*cloud.metadata["columns"].values()] == names


@pytest.mark.parametrize("name", ["GroundZ", "xyz", "height above ground", "zone", "", "ab" * 50])
def test_names_that_are_not_guessed(name: str) -> None:
    assert meaning(name).part == ""


def test_a_controller_s_point_file() -> None:
    cloud = read("P,N,E,Z,D\n1,5000.25,1000.5,12,EP\n7,5001,1001,13,\n")
    assert cloud.points.tolist() == [[1000.5, 5000.25, 12], [1001, 5001, 13]]
    assert cloud.metadata["columns"] == {"x": "E", "y": "N", "z": "Z"}
    assert cloud.metadata["not_read"] == ("column D (text, line 2: 'EP')",)
    assert cloud.attributes["P"].tolist() == [1, 7]


@pytest.mark.parametrize(
    ("header", "values"),
    [
        ("id,x,y,GroundZ", "7,1,2,3"),
        ("x,y,ground", "1,2,3"),
        ("E,N,RL_1", "1,2,3"),
        ("x,y,R", "1,2,3"),
    ],
)
def test_a_height_that_is_not_known_is_refused_with_the_header_and_the_options(
    header: str, values: str
) -> None:
    told = refused(f"{header}\n{values}\n")
    assert all(repr(name) in told for name in header.split(","))
    assert "is known as the height z" in told
    assert "read it with columns='x=..,y=..,z=..', or with flat=True" in told


@pytest.mark.parametrize("columns", ["z=GroundZ", {"z": "GroundZ"}, "z=groundz", "z=4", "-,x,y,z"])
def test_the_caller_names_the_height(columns: Any) -> None:
    cloud = read("id,x,y,GroundZ\n7,1.5,2.5,3.5\n", columns=columns)
    assert cloud.points.tolist() == POINT


def test_flat_says_that_heights_do_not_matter() -> None:
    cloud = read("id,x,y,GroundZ\n7,1,2,3\n", flat=True)
    assert cloud.points.tolist() == [[1, 2, 0]]
    assert {name: values.tolist() for name, values in cloud.attributes.items()} == {
        "id": [7],
        "GroundZ": [3],
    }
    known = read("x,y,Elev.\n1,2,3\n", flat=True)
    assert known.points.tolist() == [[1, 2, 0]]
    assert known.metadata["not_read"] == ("column Elev.",)
    assert read("1 2 3\n4 5 6\n", flat=True).points.tolist() == [[1, 2, 0], [4, 5, 0]]


def test_a_depth_needs_its_sign() -> None:
    told = refused("x,y,Depth\n1,2,3\n")
    assert "columns='z=-Depth'" in told
    assert "columns='z=+Depth'" in told
    assert refused("x,y,Depth\n1,2,3\n", columns="z=Depth") == told
    down = read("x,y,Depth\n1,2,3\n1,2,0\n", columns="z=-Depth")
    assert down.points[:, 2].tolist() == [-3, 0]
    assert not np.signbit(down.points[1, 2])
    assert down.metadata["columns"]["z"] == "-Depth"
    assert read("x,y,Depth\n1,2,3\n", columns="z=+Depth").points.tolist() == [[1, 2, 3]]
    assert read("x,y,Depth\n1,2,3\n", flat=True).attributes["Depth"].tolist() == [3]
    assert read("x,y,z,Depth\n1,2,3,4\n").attributes["Depth"].tolist() == [4]


@pytest.mark.parametrize("header", ["lng,lat,alt", "Longitude,Latitude,z", "X [°],Y [deg],Z [m]"])
def test_degrees_are_warned_of(header: str) -> None:
    with pytest.warns(DataWarning, match="x and y are degrees"):
        cloud = read(f"{header}\n{ROW}")
    assert cloud.points.tolist() == POINT
    assert "degrees" in cloud.metadata["notes"][0]


def test_different_units_are_warned_of() -> None:
    with pytest.warns(DataWarning, match="different units: x in m, y in m, z in ft"):
        assert read(f"X [m],Y [m],Z [ft]\n{ROW}").points.tolist() == POINT


def test_no_header_names_columns_by_position_as_the_caller_says() -> None:
    text = "9 1 2 3 7\n9 4 5 6 8\n"
    cloud = read(text, columns="-,y,x,z,class")
    assert cloud.points.tolist() == [[2, 1, 3], [5, 4, 6]]
    assert [*cloud.attributes] == ["class"]
    assert read(text, columns={"x": "column_3", "y": "2", "z": "4"}).points.tolist() == [
        [2, 1, 3],
        [5, 4, 6],
    ]
    assert (
        read(text, columns=[None, "y", "x", "z", "class"]).points.tolist() == cloud.points.tolist()
    )


def test_a_first_line_of_names_and_numbers_is_a_header_if_it_names_x_and_y() -> None:
    assert refused("x,y,2019\n1,2,3\n").startswith("<stream>: no column of 'x', 'y', '2019' is")
    assert read("x,y,2019\n1,2,3\n", columns="z=2019").points.tolist() == [[1, 2, 3]]
    assert "value 1: 'x' is not a number" in refused("x,y,2019\n1,2,3\n", header=False)


def test_colours_and_normals_are_groups() -> None:
    cloud = read("x,y,z,r,nx,a\n1,2,3,4,5,6\n")
    assert cloud.colors is None
    assert [*cloud.attributes] == ["r", "nx", "a"]


@pytest.mark.parametrize(
    ("text", "options", "cause"),
    [
        ("x,y,elev,alt\n1,2,3,4\n", {}, "the header has 2 columns for 'z', 'elev', 'alt': read"),
        (
            "lon,lat,x,y,z\n1,2,3,4,5\n",
            {},
            "2 columns for 'x', 'lon', 'x': read it with columns='x=..,y=..",
        ),
        (
            "x,y,z,w,w\n1,2,3,4,5\n",
            {},
            "columns for 'w', 'w', 'w': read it with columns='..,..,..'",
        ),
        ("WKT,id\n,1\n", {}, "points as WKT are not read: save x, y and z as columns"),
        ('x,y,"Depth, m"\n1,2,3\n', {}, "with columns='z=-3' if heights are negative depths"),
        ("x,y,z\n1,2,3\n", {"columns": "z=Z2"}, "columns= names 'Z2', which is not one of the"),
        ("x,y,z\n1,2,3\n", {"columns": "x=y,y=y"}, "takes 'y' for 'x' and for 'y'"),
        ("x,y,z\n1,2,3\n", {"columns": "x=-x"}, "only z can have one"),
        ("x,y,z\n1,2,3\n", {"columns": "x,y"}, "names 2 columns, and the table has 3"),
        ("1 2 3\n", {"columns": "a,b,c"}, "columns to 'a', 'b', 'c', and none of these is x or y"),
        ("x,y\n1,2\n", {"columns": "a,y"}, "columns to 'a', 'y', and none of these is x: name"),
    ],
)
def test_what_is_in_doubt_or_does_not_fit_is_refused(
    text: str, options: dict[str, Any], cause: str
) -> None:
    assert cause in refused(text, **options)


def test_a_column_whose_name_is_taken_is_left_out_and_named() -> None:
    cloud = read("x,y,z,E,N\n1,2,3,4,5\n", columns="x=E,y=N")
    assert cloud.points.tolist() == [[4, 5, 3]]
    assert cloud.metadata["not_read"] == ("column x", "column y")


@pytest.mark.parametrize(
    "options",
    [
        {"columns": 3},
        {"columns": "x="},
        {"columns": {"x": 1}},
        {"columns": [1, 2]},
        {"flat": 2},
        {"header": None},
        {"delimiter": ""},
        {"delimiter": "ab"},
        {"delimiter": "."},
        {"decimal": ";"},
        {"decimal": ",", "delimiter": ","},
        {"skip_rows": -1},
        {"skip_rows": 1.5},
        {"skip_rows": True},
        {"nodata": float("nan")},
        {"nodata": True},
        {"nodata": [1]},
        {"nodata": " "},
        {"end": ""},
        {"end": 3},
        {"encoding": "rot13"},
        {"encoding": "no such"},
        {"encoding": 8},
        {"flat": True, "columns": "z=Z"},
    ],
)
def test_invalid_options_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        validate_table_options(**options)


def test_other_formats_and_other_options_are_refused() -> None:
    with pytest.raises(FormatError, match=r"columns= cannot be given: npy files are read without"):
        liftmesh.read(io.BytesIO(b"-"), format="npy", columns="x,y")
    with pytest.raises(FormatError, match="colums= cannot be given: text files take columns"):
        read(ROW, colums="x,y,z")


def test_a_wide_header_is_shortened_in_messages() -> None:
    names = ",".join(["x", "y", *(f"{k}" + "a" * 90 for k in range(500))])
    told = refused(f"{names}\n1{',1' * 501}\n")
    assert "and 490 more is known" in told
    assert len(told) < 1200


def test_tables_whose_x_may_be_northing_are_told() -> None:
    rows = "1;2;3;4\n"
    with pytest.warns(DataWarning, match="'Y' stands before 'X'.* with columns='x=Y,y=X'"):
        assert read(f"Nr;Y;X;H\n{rows}", columns="z=H").points.tolist() == [[3, 2, 4]]
    assert read(f"Nr;Y;X;H\n{rows}", columns="x=Y,y=X,z=H").points.tolist() == [[2, 3, 4]]
    for header in ("Nr;X;Y;Z", "Nr;y;x;z", "X;Nr;Y;Z"):
        read(f"{header}\n{rows}")
