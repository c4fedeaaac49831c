"""LandXML, 3MF, VTU and XDMF: what other programs read is the mesh, and all else is named."""

from __future__ import annotations

import io
import sys
import zipfile
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

import lib3mf
import meshio
import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, FormatError, InputError
from liftmesh.crs.description import parse_crs

FEET = 'PROJCS["a",GEOGCS["b",UNIT["degree",0.0174532925199433]],UNIT["foot",{}]]'
OFFSET = np.array([450000.1, 5200000.2, 0.0])
POINTS = np.array([[0, 0, 1.1], [4, 0, 2.5], [0, 3, 1 / 3], [9, 9, 9]]) + OFFSET
MESH = Cloud(POINTS, faces=np.array([[0, 1, 2]], np.int32))
SPACE = "{http://www.landxml.org/schema/LandXML-1.2}"
# What the schema of LandXML 1.2 says of the elements that are written: which attributes they must
# have, and which elements they hold in which order.
SCHEMA: dict[str, tuple[set[str], list[str]]] = {
    "LandXML": (
        {"version", "date", "time"},
        ["Units", "CoordinateSystem", "Application", "Surfaces"],
    ),
    "Units": (set(), ["Metric", "Imperial"]),
    "Metric": ({"areaUnit", "linearUnit", "volumeUnit", "temperatureUnit", "pressureUnit"}, []),
    "Imperial": ({"areaUnit", "linearUnit", "volumeUnit", "temperatureUnit", "pressureUnit"}, []),
    "CoordinateSystem": (set(), []),
    "Application": ({"name"}, []),
    "Surfaces": (set(), ["Surface"]),
    "Surface": ({"name"}, ["SourceData", "Definition"]),
    "SourceData": (set(), ["Breaklines"]),
    "Breaklines": (set(), ["Breakline"]),
    "Breakline": ({"brkType"}, ["PntList3D"]),
    "PntList3D": (set(), []),
    "Definition": ({"surfType"}, ["Pnts", "Faces"]),
    "Pnts": (set(), ["P"]),
    "P": ({"id"}, []),
    "Faces": (set(), ["F"]),
    "F": (set(), []),
}


@pytest.fixture(autouse=True)
def h5py(monkeypatch: pytest.MonkeyPatch) -> None:
    """meshio imports it to read any XDMF, but uses it for arrays in HDF5 alone."""
    if find_spec("h5py") is None:
        monkeypatch.setitem(sys.modules, "h5py", ModuleType("h5py"))


def written(cloud: Cloud, kind: str, **options: Any) -> bytes:
    stream = io.BytesIO()
    liftmesh.write(stream, cloud, format=kind, **options)
    return stream.getvalue()


def landxml(cloud: Cloud, **options: Any) -> ET.Element:
    root = ET.fromstring(written(cloud, "landxml", **options))
    for each in root.iter():
        needed, inside = SCHEMA[each.tag.removeprefix(SPACE)]
        assert needed <= each.attrib.keys()
        places = [inside.index(part.tag.removeprefix(SPACE)) for part in each]
        assert places == sorted(places)
    return root


def test_landxml_has_northing_easting_and_height() -> None:
    root = landxml(replace(MESH, crs="EPSG:25832"))
    rows = [[float(x) for x in (each.text or "").split()] for each in root.iter(SPACE + "P")]
    assert np.array_equal(np.array(rows)[:, [1, 0, 2]], POINTS)
    assert [each.get("id") for each in root.iter(SPACE + "P")] == ["1", "2", "3", "4"]
    assert [each.text for each in root.iter(SPACE + "F")] == ["1 2 3"]
    definition = next(root.iter(SPACE + "Definition"))
    limits = [float(definition.attrib[key]) for key in ("elevMin", "elevMax")]
    assert (definition.get("surfType"), limits) == ("TIN", [1 / 3, 9.0])
    assert next(root.iter(SPACE + "CoordinateSystem")).get("epsgCode") == "25832"
    assert next(root.iter(SPACE + "Metric")).get("linearUnit") == "meter"


def test_edges_are_breaklines_of_landxml_and_lines_of_vtu(tmp_path: Path) -> None:
    mesh = replace(MESH, edges=np.array([[0, 2], [1, 3]], np.int32))
    texts = [each.text or "" for each in landxml(mesh).iter(SPACE + "PntList3D")]
    ends = np.array([[float(x) for x in text.split()] for text in texts]).reshape(2, 2, 3)
    assert np.array_equal(ends[..., [1, 0, 2]], POINTS[mesh.edges])
    for kind in ("vtu", "xdmf"):
        assert liftmesh.write(tmp_path / f"a.{kind}", mesh).dropped == ()
        found = meshio.read(tmp_path / f"a.{kind}")
        triangles, lines = found.cells
        assert np.array_equal(triangles.data, MESH.faces)
        assert (lines.type, lines.data.tolist()) == ("line", [[0, 2], [1, 3]])
        assert [each.tolist() for each in found.cell_data["region"]] == [[0], [-1, -1]]
        assert written(replace(MESH, edges=mesh.edges[:0]), kind) == written(MESH, kind)
    assert "edges" in liftmesh.write(tmp_path / "a.3mf", mesh).dropped


@pytest.mark.parametrize(
    ("metres", "unit"), [("0.3048", "foot"), ("0.3048006096012192", "USSurveyFoot")]
)
def test_landxml_in_feet(metres: str, unit: str) -> None:
    root = landxml(replace(MESH, crs=FEET.format(metres)), name='a < "b"')
    assert next(root.iter(SPACE + "Imperial")).get("linearUnit") == unit
    assert next(root.iter(SPACE + "Surface")).get("name") == 'a < "b"'
    assert next(root.iter(SPACE + "CoordinateSystem")).get("ogcWktCode") == FEET.format(metres)


@pytest.mark.parametrize(
    ("crs", "code"),
    [
        ("epsg:25832", "25832"),
        ("urn:ogc:def:crs:EPSG::25832", "25832"),
        (FEET.format("0.3048").removesuffix("]") + ',AUTHORITY["EPSG","2222"]]', "2222"),
        (FEET.format("0.3048").removesuffix("]") + ',AUTHORITY["ESRI","2222"]]', None),
        (FEET.format("0.3048").replace('"b"', '"b",AUTHORITY["EPSG","4269"]'), None),
    ],
)
def test_landxml_states_the_number_that_a_system_has(crs: str, code: str | None) -> None:
    found = next(landxml(replace(MESH, crs=crs)).iter(SPACE + "CoordinateSystem"))
    assert found.get("epsgCode") == code
    assert found.get("ogcWktCode" if crs.startswith("PROJCS") else "desc") == crs


@pytest.mark.parametrize("kind", ["landxml", "3mf"])
@pytest.mark.parametrize(
    ("crs", "cause"),
    [
        ("EPSG:4326", r"geographic \(WGS 84\), but .* holds lengths: transform them with dst_crs="),
        ("EPSG:2225+5703", r"US survey foot and metre, but .* has one for all"),
        (FEET.format("0.5"), r"the unit is foot of 0.5 m, but"),
        ("EPSG:999999", r"the unit of 'EPSG:999999' is not known, .* states one: state"),
        ('LOCAL_CS["site"]', r"the unit of 'LOCAL_CS.*' is not known"),
    ],
)
def test_units_that_a_format_has_not(kind: str, crs: str, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        written(replace(MESH, crs=crs), kind)


@pytest.mark.parametrize("kind", ["landxml", "3mf"])
def test_a_number_without_pyproj_has_no_unit(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyproj", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    parse_crs.cache_clear()
    with pytest.raises(FormatError, match=r"'EPSG:2236' is not known, .* install liftmesh\[terr"):
        written(replace(MESH, crs="EPSG:2236"), kind)
    parse_crs.cache_clear()


@pytest.mark.parametrize("kind", ["landxml", "3mf"])
@pytest.mark.parametrize("crs", ["EPSG:25832", "EPSG:7415", None])
def test_heights_of_a_band_in_feet(kind: str, crs: str | None) -> None:
    for unit, cause in (("ft", "foot"), ("US survey foot", "US survey foot"), ("cm", "cm")):
        mesh = replace(MESH, crs=crs, metadata={"raster": {"unit": unit}})
        words = f"metre and {cause}, but" if crs else f"z is in {cause}, and the unit of x and y"
        with pytest.raises(FormatError, match=words):
            written(mesh, kind)
    assert written(replace(MESH, crs=crs, metadata={"raster": {"unit": "metre"}}), kind)


def test_a_coordinate_system_that_xml_cannot_hold_is_named() -> None:
    crs = FEET.format("0.3048").replace('"a"', '"bell \x07"')
    result = liftmesh.write(io.BytesIO(), replace(MESH, crs=crs), format="landxml")
    assert result.dropped == ("crs",)


def read_3mf(data: bytes, tmp_path: Path) -> tuple[Any, Any]:
    (tmp_path / "a.3mf").write_bytes(data)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "a.3mf"))
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    return model, meshes.GetCurrentMeshObject()


def test_3mf_is_what_lib3mf_reads(tmp_path: Path) -> None:
    stream = io.BytesIO()
    result = liftmesh.write(stream, replace(MESH, crs="EPSG:25832"), format="3mf")
    assert result.origin == (450000.0, 5200000.0, 0.0)
    assert result.dropped == ("rows in no face", "crs", "double precision")
    model, mesh = read_3mf(stream.getvalue(), tmp_path)
    found = np.array([mesh.GetVertex(k).Coordinates[:] for k in range(mesh.GetVertexCount())])
    assert np.array_equal(found, (POINTS[:3] - result.origin).astype(np.float32))
    assert mesh.GetTriangle(0).Indices[:] == [0, 1, 2]
    assert model.GetUnit() == lib3mf.ModelUnit.Meter
    assert mesh.GetType() == lib3mf.ObjectType.Surface
    note = model.GetMetaDataGroup().GetMetaData(0)
    assert note.GetValue() == "450000.0 5200000.0 0.0"


def test_3mf_of_a_solid_is_a_model(tmp_path: Path) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.int32)
    model, mesh = read_3mf(written(Cloud(corners, faces=faces), "3mf", unit="inch"), tmp_path)
    assert (mesh.GetType(), mesh.IsManifoldAndOriented()) == (lib3mf.ObjectType.Model, True)
    assert model.GetUnit() == lib3mf.ModelUnit.Inch
    turned = np.vstack([faces[:3], faces[3:, ::-1]])
    _, mesh = read_3mf(written(Cloud(corners, faces=turned), "3mf"), tmp_path)
    assert mesh.GetType() == lib3mf.ObjectType.Surface


def test_3mf_is_the_same_every_time() -> None:
    data = written(MESH, "3mf")
    assert written(MESH, "3mf") == data
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.testzip() is None
    with pytest.raises(InputError, match="unit is 'mile': give one of 'micron'"):
        written(MESH, "3mf", unit="mile")


def test_3mf_has_no_faces_with_a_corner_twice(tmp_path: Path) -> None:
    flat = replace(MESH, faces=np.array([[0, 1, 2], [3, 1, 3]], np.int32))
    with pytest.raises(FormatError, match=r"face 1 is \[3, 1, 3\], but 3MF has no faces with"):
        liftmesh.write(tmp_path / "a.3mf", flat)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("kind", ["vtu", "xdmf"])
def test_vtu_and_xdmf_are_what_meshio_reads(kind: str, tmp_path: Path) -> None:
    values = {
        "class": np.array([2, 2, 9, 1], np.uint8), "time": np.array([0.1, 0.2, np.nan, 4]),
        "is & < ok": np.array([True, False, True, False]), "half": np.zeros(4, np.float16),
        "vector": np.arange(12.0).reshape(4, 3), "big": np.array([2**63, 1, 2, 3], np.uint64),
        "text": np.array(["a", "b", "c", "d"]), "bell \x07": np.zeros(4),
    }  # fmt: skip
    colors = np.array([[0, 51, 255]] * 4, np.uint8)
    cloud = replace(MESH, attributes=values, colors=colors, normals=np.eye(3)[[0, 1, 2, 2]])
    result = liftmesh.write(tmp_path / f"a.{kind}", cloud)
    assert result.dropped == ("text", "bell \x07")
    found = meshio.read(tmp_path / f"a.{kind}")
    assert found.points.tobytes() == POINTS.tobytes()
    assert found.cells[0].type == "triangle"
    assert np.array_equal(found.cells[0].data, MESH.faces)
    for name in ("class", "time", "is & < ok", "half", "vector", "big"):
        assert np.array_equal(found.point_data[name], values[name], equal_nan=name == "time")
    assert np.array_equal(found.point_data["Colors"], colors)
    assert np.array_equal(found.point_data["Normals"], cloud.normals)


def test_vtu_and_xdmf_of_points_and_of_nothing(tmp_path: Path) -> None:
    for kind in ("xdmf", "vtu"):
        liftmesh.write(tmp_path / f"a.{kind}", Cloud(POINTS, colors=np.full((4, 3), 0.1)))
        found = meshio.read(tmp_path / f"a.{kind}")
        assert found.points.tobytes() == POINTS.tobytes()
    assert (found.cells[0].type, found.cells[0].data.tolist()) == ("vertex", [[0], [1], [2], [3]])
    assert (found.point_data["Colors"] == 0.1).all()
    liftmesh.write(tmp_path / "b.vtu", Cloud(np.zeros((0, 3))))
    assert b'NumberOfPoints="0"' in (tmp_path / "b.vtu").read_bytes()
    assert b'Dimensions="0 3"' in written(Cloud(np.zeros((0, 3))), "xdmf")


@pytest.mark.parametrize("kind", ["3mf", "vtu", "xdmf"])
def test_they_are_not_read(kind: str) -> None:
    with pytest.raises(
        FormatError, match=f"{kind} files are written, not read: keep the mesh as PLY"
    ):
        liftmesh.read(io.BytesIO(written(MESH, kind)), format=kind)


@pytest.mark.parametrize("kind", ["landxml", "3mf"])
def test_faces_are_needed(kind: str) -> None:
    with pytest.raises(FormatError, match="a cloud without faces cannot be written as"):
        written(Cloud(POINTS), kind)
