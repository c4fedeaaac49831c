"""LandXML that is read: surfaces, breaklines and points, and files that do harm."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from commands import liftmesh as command
from file_samples import assert_same_mesh
from surfaces import hills

import liftmesh
from liftmesh import Cloud, FormatError, InputError

LINES = (
    '<SourceData><Breaklines><Breakline name="kerb"><PntList3D>0 0 1 0 1 2\n9 9 9</PntList3D>'
    "</Breakline></Breaklines><Boundaries><Boundary/></Boundaries></SourceData>"
)
POINTS = '<P id="7">0 0 1</P><P id="9">0 1 2</P><P id="3">1 0 3</P><P id="4"> 1\r\n1 4</P>'
FACES = '<F n="0 0 2">7 9 3</F><F i="1">9 4 3</F><F>9 4 3 7</F>'
SURVEY = '<CgPoints><CgPoint name="a">5 6 7</CgPoint><CgPoint>5 8</CgPoint><CgPoint pntRef="a"/>'


def surface(name: str = "EG", lines: str = LINES, points: str = POINTS, faces: str = FACES) -> str:
    made = f"<Pnts>{points}</Pnts><Faces>{faces}</Faces>" if points else ""
    return f'<Surface name="{name}">{lines}<Definition surfType="TIN">{made}</Definition></Surface>'


def document(*surfaces: str, before: str = "", head: str = '<?xml version="1.0"?>') -> str:
    inside = f"{before}<Surfaces>{''.join(surfaces)}</Surfaces>"
    return f'{head}\n<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.1">{inside}</LandXML>'


def loaded(text: str | bytes, **options: Any) -> Cloud:
    data = text.encode() if isinstance(text, str) else text
    return liftmesh.read(io.BytesIO(data), format="landxml", **options)


def test_points_are_northing_easting_height_and_faces_name_ids() -> None:
    found = loaded(document(surface(), before="<Alignments/><Alignments/>"))
    assert found.points.tolist() == [[0, 0, 1], [1, 0, 2], [0, 1, 3], [1, 1, 4]]
    assert found.faces is not None
    assert found.edges is not None
    assert found.faces.tolist() == [[0, 1, 2], [1, 3, 2], [1, 2, 0]]
    assert found.edges.tolist() == [[0, 1]]
    assert found.metadata["landxml"] == {"surface": "EG"}
    assert set(found.metadata["not_read"]) == {
        "2 Alignments elements",
        "1 Boundary element",
        "1 invisible face",
        "1 stray breakline segment",
    }


@pytest.mark.parametrize(
    ("units", "name", "metres"),
    [
        ('<Metric linearUnit="meter"/>', "metre", 1),
        ('<Imperial linearUnit="foot"/>', "foot", 0.3048),
        ('<Imperial linearUnit="USSurveyFoot"/>', "US survey foot", 1200 / 3937),
        ('<Metric linearUnit="millimeter"/>', "millimetre", None),
    ],
)
def test_units_are_those_of_heights(units: str, name: str, metres: float | None) -> None:
    from liftmesh.crs.units import band_unit

    found = loaded(document(surface(), before=f"<Units>{units}</Units>"))
    unit = band_unit(found)
    assert unit is not None
    assert (unit.name, unit.metres) == (name, metres)
    if name != "metre":
        with pytest.raises(FormatError, match=f"z is in {name}, and the unit of x and y"):
            liftmesh.write(io.BytesIO(), found, format="landxml")


@pytest.mark.parametrize(
    ("attributes", "crs"),
    [
        ('epsgCode="25832"', "EPSG:25832"),
        ('desc="EPSG:25832+7837" epsgCode="25832"', "EPSG:25832+7837"),
        ('desc="our grid" ogcWktCode="LOCAL_CS[&quot;site&quot;]"', 'LOCAL_CS["site"]'),
        ('desc="+init=/etc/passwd" epsgCode="x"', None),
        ('ogcWktCode=""', None),
    ],
)
def test_coordinate_systems(attributes: str, crs: str | None) -> None:
    assert loaded(document(surface(), before=f"<CoordinateSystem {attributes}/>")).crs == crs


def test_one_of_several_surfaces_is_chosen(tmp_path: Path) -> None:
    text = document(surface("EG"), surface("FG", points=POINTS.replace("4<", "5<")), surface("FG"))
    with pytest.raises(FormatError, match=r"surfaces 'EG', 'FG', 'FG': choose .* landxml_surface="):
        loaded(text)
    with pytest.raises(FormatError, match=r"surfaces 'EG', 'FG', 'FG', but not 'fg': choose"):
        loaded(text, landxml_surface="fg")
    with pytest.raises(FormatError, match="two surfaces are named 'FG'"):
        loaded(text, landxml_surface="FG")
    with pytest.raises(InputError, match="landxml_surface is 3: give the name of a surface"):
        loaded(text, landxml_surface=3)
    (tmp_path / "a.xml").write_text(text)
    done = command("triangulate", "a.xml", "a.ply", "--landxml-surface", "EG", cwd=tmp_path)
    assert done.returncode == 0
    assert "invisible face" in done.stderr
    assert len(liftmesh.read(tmp_path / "a.ply")) == 4
    wrong = command("triangulate", "a.xml", "b.ply", cwd=tmp_path)
    assert wrong.returncode == 3
    assert "choose one with --landxml-surface" in wrong.stderr


def test_points_of_a_survey() -> None:
    text = document(before=f"{SURVEY}</CgPoints>").replace("<Surfaces></Surfaces>", "")
    found = loaded(text)
    assert np.array_equal(found.points, [[6, 5, 7], [8, 5, np.nan]], equal_nan=True)
    both = document(surface(), before=f"{SURVEY}</CgPoints>")
    assert "2 survey points" in loaded(both).metadata["not_read"]
    assert len(loaded(both, landxml_surface="CgPoints")) == 2


def test_a_surface_of_source_data_has_its_points_and_lines() -> None:
    lines = LINES.replace(
        "</Breaklines>",
        "</Breaklines><DataPoints><PntList3D>5 5 5 9 9 9</PntList3D><PntList2D/></DataPoints>",
    )
    found = loaded(document(surface(lines=lines, points="")))
    assert found.points.tolist() == [[5, 5, 5], [9, 9, 9], [0, 0, 1], [1, 0, 2]]
    assert found.edges is not None
    assert found.edges.tolist() == [[2, 3], [3, 1]]
    assert found.faces is None
    made = liftmesh.constrained_delaunay(found)
    assert made.constraints.tolist() == [[1, 3], [2, 3]]


@pytest.mark.parametrize("kind", ["us-ascii", "utf-8", "utf-16", "iso-8859-1"])
def test_encodings(kind: str) -> None:
    text = document(surface("Höhe" if kind != "us-ascii" else "a"), head="")
    data = f'<?xml version="1.0" encoding="{kind}"?>{text}'.encode(kind.replace("us-", ""))
    assert loaded(data).points.shape == (4, 3)


def test_elements_may_have_a_prefix() -> None:
    ET.register_namespace("lx", "http://www.landxml.org/schema/LandXML-1.1")
    data = ET.tostring(ET.fromstring(document(surface())))
    assert b"<lx:P " in data
    assert loaded(data).points.shape == (4, 3)


BAD = {
    "no xml": ("x", "damaged, or no LandXML: syntax error: line 1"),
    "another root": ("<gpx/>", "line 1: the file is 'gpx', not LandXML"),
    "nothing in it": ("<LandXML/>", "no surfaces and no points"),
    "entities": ('<!DOCTYPE a [<!ENTITY x "y">]><LandXML/>', "a document type, which LandXML has"),
    "depth": ("<LandXML>" + "<a>" * 99, "more than 64 deep"),
    "names": ("<LandXML>" + "".join(f"<a{k}/>" for k in range(5000)), "4,096 names"),
    "attributes": (
        f"<LandXML {' '.join(f'a{k}=' + chr(34) * 2 for k in range(5000))}/>",
        "4,096 names",
    ),
    "a tag": (f"<LandXML a='{'a' * 600_000}'/>", "a tag or a comment of more than 262,144 bytes"),
    "a comment": (f"<LandXML><!--{'a' * 600_000}", "a tag or a comment of more than 262,144"),
    "an encoding": ('<?xml version="1.0" encoding="utf-7"?><LandXML/>', "XML in 'utf-7' is not"),
    "bytes": (b"<LandXML>\xff</LandXML>", "not well-formed"),
    "cut off": (document(surface())[:-60], "damaged, or no LandXML: no element found"),
    "a point that is not there": (document(surface(faces="<F>7 9 3</F><F>7 9 5</F>")), "face 2 na"),
    "a face of two": (document(surface(faces="<F>7 9</F>")), "line 4: '7 9' has 2 numbers"),
    "a point of two": (document(surface(points='<P id="1">1 2</P>')), "expected northing, east"),
    "no number": (document(surface(points='<P id="1">1 b 2</P>')), "value 2: 'b' is not a num"),
    "an empty point": (document(surface(points='<P id="1"/>')), "without northing"),
    "no id": (document(surface(points="<P>1 2 3</P>")), "the id of a point is ''"),
    "an id twice": (document(surface(points=POINTS.replace('"9"', '"7"'))), "points have the id 7"),
    "faces without points": (document(surface(points=" ")), "there are faces, but no points"),
    "an empty surface": (document('<Surface name="EG"/>'), "there is nothing in the surface 'EG'"),
    "a line of four": (
        document(surface(lines=LINES.replace("9 9 9", "9"))),
        "has 7 numbers: expected northing",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_files_name_the_place(case: str) -> None:
    text, cause = BAD[case]
    with pytest.raises(FormatError, match=cause):
        loaded(text)


def test_what_is_written_comes_back(tmp_path: Path) -> None:
    hill = liftmesh.triangulate(hills())
    edges = hill.faces[:9, :2]
    mesh = replace(hill.to_cloud(), edges=edges, crs="EPSG:25832", colors=None, attributes={})
    liftmesh.write(tmp_path / "a.xml", mesh, name="hill")
    back = liftmesh.read(tmp_path / "a.xml")
    assert_same_mesh(back, mesh)
    assert back.edges is not None
    assert np.array_equal(back.edges, edges)
    assert back.metadata["landxml"] == {"unit": "metre", "surface": "hill"}
    assert liftmesh.write(tmp_path / "b.xml", back).dropped == ()
    assert (tmp_path / "a.xml").read_bytes() == (tmp_path / "b.xml").read_bytes()
    assert len(liftmesh.as_surface(tmp_path / "a.xml").faces) == len(hill.faces)


@pytest.mark.parametrize(
    ("crs", "unit"),
    [(None, "meter"), ("EPSG:25832", "meter"), ("EPSG:2263", "USSurveyFoot"), (2222, "foot")],
)
def test_the_unit_is_that_of_the_coordinate_system(crs: Any, unit: str) -> None:
    stream = io.BytesIO()
    surface = liftmesh.triangulate([[0, 0, 1.0], [1, 0, 2], [0, 1, 3]], crs=crs)
    liftmesh.write(stream, surface, format="landxml")
    assert f'linearUnit="{unit}"' in stream.getvalue().decode()
