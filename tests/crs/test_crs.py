"""What coordinate systems say of coordinates, and what follows for surfaces."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import pytest
from commands import liftmesh
from files.las import encoded, record, records, tile, with_records

import liftmesh as lm
from liftmesh import Cloud, DataWarning, FormatError, InputError
from liftmesh.crs.description import parse_crs, parse_wkt
from liftmesh.crs.units import coordinate_warnings

METRE, FOOT, SURVEY_FOOT = ("metre", 1.0), ("foot", 0.3048), ("US survey foot", 1200 / 3937)
DEGREE = ("degree", None)
VERSIONS = ("WKT1_GDAL", "WKT1_ESRI", "WKT2_2015", "WKT2_2019")
CODES = {
    "25832": ("projected", METRE, None),
    "3857": ("projected", METRE, None),
    "2232": ("projected", SURVEY_FOOT, None),
    "2992": ("projected", FOOT, None),
    "4326": ("geographic", DEGREE, None),
    "4978": ("geocentric", METRE, METRE),
    "7415": ("projected", METRE, METRE),
    "28992+5709": ("projected", METRE, METRE),
    "25832+6360": ("projected", METRE, SURVEY_FOOT),
    "2992+8228": ("projected", FOOT, FOOT),
    "4979": ("geographic", DEGREE, METRE),
}


@pytest.mark.parametrize("code", CODES)
@pytest.mark.parametrize("version", [*VERSIONS, "EPSG"])
def test_kinds_and_units_of_every_way_to_write_a_system(code: str, version: str) -> None:
    system = pyproj.CRS(f"EPSG:{code}")
    if version == "EPSG":
        text = f"EPSG:{code}"
    else:
        try:
            text = system.to_wkt(version)
        except pyproj.exceptions.CRSError:
            text = None
        if text is None:
            assert (version, code) in {("WKT1_ESRI", "4978"), ("WKT1_GDAL", "4979")}
            return
    found = parse_crs(text)
    assert found is not None
    kind, plane, height = CODES[code]
    units = [each and (each.name.lower(), each.metres) for each in found.units]
    wanted = [each and (each[0].lower(), each[1]) for each in (plane, plane, height)]
    if version == "WKT1_ESRI" and code in {"4979", "7415", "28992+5709"}:
        wanted[2] = units[2]  # Esri's text of these may leave out the heights
    assert found.kind == kind
    assert units == [each and (each[0], pytest.approx(each[1], abs=1e-12)) for each in wanted]


def test_the_two_feet_are_not_one() -> None:
    found = parse_crs("EPSG:2992+6360")
    assert found is not None
    assert found.is_mixed
    assert coordinate_warnings(found) == (
        "the units differ: x is in foot, y in foot, z in US survey foot",
    )


def test_feet_by_other_names() -> None:
    for factor, name in ((0.3048006096012192, "US survey foot"), (0.3048, "foot"), (0.5, "ell")):
        found = parse_crs(f'PROJCS["a",GEOGCS["b"],UNIT["ell",{factor!r}]]')
        assert found is not None
        assert found.units[0] is not None
        assert found.units[0].name == name


NOTHING = (
    "\ud800", 'PROJCS["\ud800"', "+proj=longlat", "+init=/etc/hosts:1", "EPSG:25832 ", "a:1",
    None, "", "nonsense", "EPSG:999999", 'PROJCS["a"', 'PROJCS["a"]]', "VERT_CS[]", "UNIT[metre,1]",
    "COMPD_CS[COMPD_CS[]]", "BOUNDCRS[]", "[" * 100, "A[" * 30_000 + "]" * 30_000,
    'PROJCS["' + "a" * 70_000 + '"]',
)  # fmt: skip


@pytest.mark.parametrize("text", NOTHING)
def test_texts_that_say_nothing(text: str | None) -> None:
    assert parse_crs(text) is None
    assert coordinate_warnings(parse_crs(text)) == ()


@pytest.mark.parametrize("unit", ["UNIT[]", 'UNIT["metre"]', 'UNIT["metre",abc]', ""])
def test_units_that_are_none(unit: str) -> None:
    found = parse_crs(f'PROJCS["a",{unit}]')
    assert found is not None
    assert found.units == (None, None, None)


def test_brackets_may_be_round_and_names_hold_brackets() -> None:
    found = parse_wkt('PROJCS("a ""[(b",UNIT("metre",1))')
    assert found is not None
    assert found.title == 'a ""[(b'
    assert [each.values for each in found.parts] == [['"metre"', "1"]]


POINTS = np.array([[9.0, 48.0, 1], [9.1, 48.0, 2], [9.0, 48.1, 3]])


def test_degrees_are_a_warning_and_geocentric_coordinates_are_refused() -> None:
    with pytest.warns(DataWarning, match=r"x and y are degrees \(WGS 84\), .*with dst_crs="):
        lm.triangulate(Cloud(POINTS, crs="EPSG:4326"))
    with pytest.warns(DataWarning, match="the units differ"):
        lm.triangulate(Cloud(POINTS, crs="EPSG:25832+6360"))
    with pytest.raises(InputError, match=r"are geocentric \(WGS 84\), .* dst_crs= a projected"):
        lm.triangulate(Cloud(POINTS, crs="EPSG:4978"))
    with pytest.warns(DataWarning, match="geocentric"):
        lm.triangulate(Cloud(POINTS, crs="EPSG:4978"), plane=(0, 0, 1))


def lidar(crs: str, points: np.ndarray = POINTS) -> bytes:
    las = records(points, 6, version="1.4", scale=1e-7, offset=(9, 48, 0))
    made = record(b"LASF_Projection", 2112, pyproj.CRS(crs).to_wkt("WKT1_GDAL").encode())
    return with_records(encoded(las), made, wkt=True)


def test_coordinates_are_transformed_as_pyproj_does() -> None:
    data = lidar("EPSG:4326")
    found = lm.read(io.BytesIO(data), format="las", dst_crs="EPSG:25832")
    change = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:25832", always_xy=True)
    whole = lm.read(io.BytesIO(data), format="las")
    assert np.array_equal(found.points, np.column_stack(change.transform(*whole.points.T)))
    assert found.crs == "EPSG:25832"
    scale = [0.01, 0.01, 1e-7]  # as fine on the ground
    assert found.metadata["las"] == {"version": "1.4", "point_format": 6, "scale": scale}
    parts = [*lm.read_chunks(io.BytesIO(data), rows=1, format="las", dst_crs="EPSG:25832")]
    assert np.array_equal(np.concatenate([each.points for each in parts]), found.points)
    lm.triangulate(found)


def test_what_cannot_be_transformed() -> None:
    data = lidar("EPSG:4326")
    with pytest.raises(InputError, match=r"<stream>: dst_crs is 'EPSG:999999', which is unknown"):
        lm.read(io.BytesIO(data), format="las", dst_crs="EPSG:999999")
    for crs in ("+init=epsg:25832", "\ud800", 'A["\ud800"]', "nowhere"):
        with pytest.raises(InputError, match="is unknown: give WKT or EPSG:n"):
            lm.read(io.BytesIO(data), format="las", dst_crs=crs)
    with pytest.raises(InputError, match=r"<stream>: dst_crs= needs .*: read them with src_crs="):
        lm.read(io.BytesIO(b"1 2 3\n"), format="xyz", dst_crs="EPSG:25832")
    far = lidar("EPSG:4326", np.array([[9.0, 48, 1], [9.0, 91, 2]]))
    with pytest.raises(InputError, match=r"row 1, \(9\.0, 91\.0, 2\.0\), has no place in 'EPSG"):
        lm.read(io.BytesIO(far), format="las", dst_crs="EPSG:25832")
    with pytest.raises(
        InputError, match=r"or it needs a grid .* give the system without heights, or"
    ):
        lm.read(io.BytesIO(lidar("EPSG:7415")), format="las", dst_crs="EPSG:4979")


def test_a_system_that_the_file_does_not_state(tmp_path: Path) -> None:
    rows = b"9 48 1\n10 48 2\n9 49 3\n"
    found = lm.read(io.BytesIO(rows), format="xyz", src_crs="EPSG:4326", dst_crs="EPSG:25832")
    stated = lidar("EPSG:4326", np.array([[9.0, 48, 1], [10, 48, 2], [9, 49, 3]]))
    expected = lm.read(io.BytesIO(stated), format="las", dst_crs="EPSG:25832")
    assert np.array_equal(found.points, expected.points)
    (part,) = lm.read_chunks(io.BytesIO(rows), format="xyz", src_crs="EPSG:4326")
    with pytest.warns(DataWarning, match="x and y are degrees"):
        lm.triangulate(part)
    assert part.crs == "EPSG:4326"
    with pytest.raises(InputError, match="src_crs is '', which is unknown"):
        lm.read(io.BytesIO(rows), format="xyz", src_crs="")
    (tmp_path / "a.xyz").write_bytes(rows)
    words = ("triangulate", "a.xyz", "a.ply", "--dst-crs", "EPSG:25832")
    done = liftmesh(*words, cwd=tmp_path)
    assert done.returncode == 3
    assert "--dst-crs needs the coordinate system of the points" in done.stderr
    assert "read them with --src-crs\n" in done.stderr
    assert liftmesh(*words, "--src-crs", "EPSG:4326", cwd=tmp_path).returncode == 0
    assert np.array_equal(lm.read(tmp_path / "a.ply").points, found.points)


def test_commands_say_what_the_units_are(tmp_path: Path) -> None:
    (tmp_path / "a.las").write_bytes(lidar("EPSG:4326"))
    done = liftmesh("info", "a.las", cwd=tmp_path)
    assert "units       x: degree, y: degree, z: not stated" in done.stdout
    line = (
        "a.las: x and y are degrees (WGS 84), which are no lengths: transform them with --dst-crs"
    )
    assert line in done.stderr
    done = liftmesh(
        "triangulate", "a.las", "a.ply", "--dst-crs", "EPSG:25832", "--json", cwd=tmp_path
    )
    assert done.returncode == 0
    assert "degrees" not in done.stderr
    found = json.loads(liftmesh("info", "a.ply", "--json", cwd=tmp_path).stdout)
    assert (found["crs"], found["units"]) == ("EPSG:25832", ["metre", "metre", None])
    done = liftmesh("triangulate", "a.las", "b.ply", "--dst-crs", "EPSG:99", cwd=tmp_path)
    assert done.returncode == 3
    assert "error: a.las: --dst-crs is 'EPSG:99', which is unknown" in done.stderr
    assert not (tmp_path / "b.ply").exists()


def test_a_geocentric_tile_is_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "a.las").write_bytes(lidar("EPSG:4978"))
    done = liftmesh("triangulate", "a.las", "a.ply", cwd=tmp_path)
    assert done.returncode == 3
    assert "error: a.las: the coordinates are geocentric" in done.stderr
    assert "--dst-crs" in done.stderr


def test_the_hint_without_pyproj(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    lm.write(tmp_path / "a.ply", lm.Cloud(np.eye(3), crs="EPSG:25832"))
    monkeypatch.setitem(sys.modules, "pyproj", None)
    parse_crs.cache_clear()
    try:
        assert parse_crs("EPSG:25832") is None
        assert parse_crs('PROJCS["a",UNIT["metre",1]]') is not None
        with pytest.raises(lm.MissingDependencyError, match=r"pip install 'liftmesh\[terrain\]'"):
            lm.read(io.BytesIO(lidar_text()), format="las", dst_crs="EPSG:25832")
        said = liftmesh("info", "a.ply", cwd=tmp_path).stderr
        assert "not known (pip install 'liftmesh[terrain]' looks up numbers)\n" in said
    finally:
        parse_crs.cache_clear()


def lidar_text() -> bytes:
    made = record(b"LASF_Projection", 2112, b'GEOGCS["a",UNIT["degree",0.0174532925199433]]')
    return with_records(encoded(tile(4)), made, wkt=True)


def test_formats_that_cannot_hold_a_system_say_so() -> None:
    surface = lm.triangulate(Cloud(POINTS, crs="EPSG:25832"))
    for kind in ("ply", "npz", "glb", "obj"):
        stream = io.BytesIO()
        assert "crs" not in lm.write(stream, surface, format=kind).dropped
        stream.seek(0)
        assert lm.read(stream, format=kind).crs == "EPSG:25832"
    for kind in ("stl", "off", "csv"):
        assert "crs" in lm.write(io.BytesIO(), surface, format=kind).dropped


@pytest.mark.parametrize("crs", ["foo", "EPSG:999999", "foo[bar]", "/etc/passwd", "@passwd"])
def test_what_is_given_must_be_a_system(crs: Any, tmp_path: Path) -> None:
    for read in (lm.read, lm.read_chunks):
        with pytest.raises(InputError, match=r"^src_crs is .*, which is unknown: give WKT or"):
            read(io.BytesIO(b"0 0 1\n"), format="xyz", src_crs=crs)
    (tmp_path / "a.csv").write_text("x,y,z\n0,0,1\n1,0,1\n0,1,1\n")
    done = liftmesh("triangulate", "a.csv", "a.ply", "--src-crs", str(crs), cwd=tmp_path)
    assert done.returncode == 3
    assert f"error: --src-crs is '{crs}', which is unknown: give WKT or EPSG:n" in done.stderr
    done = liftmesh(
        "raster", "a.csv", "a.tif", "--resolution", "1", "--crs", str(crs), cwd=tmp_path
    )
    assert f"error: --crs is '{crs}', which is unknown: give WKT or EPSG:n" in done.stderr


def test_a_system_in_place_of_the_stated_one_is_said(tmp_path: Path) -> None:
    cloud = Cloud(np.array([[5e5, 5e6, 1], [5e5 + 9, 5e6, 1], [5e5, 5e6 + 9, 1]]), crs="EPSG:25832")
    lm.write(tmp_path / "a.ply", cloud)
    words = "a.ply: states ETRS89 / UTM zone 32N; taken as ETRS89 / UTM zone 33N"
    done = liftmesh("triangulate", "a.ply", "b.ply", "--src-crs", "EPSG:25833", cwd=tmp_path)
    assert words in done.stderr
    assert lm.read(tmp_path / "a.ply", src_crs="EPSG:25833").metadata["stated_crs"] == "EPSG:25832"
    assert "stated_crs" not in lm.read(tmp_path / "b.ply").metadata
    done = liftmesh("triangulate", "a.ply", "b.ply", "--src-crs", "EPSG:25832", cwd=tmp_path)
    assert "taken as" not in done.stderr
    words = ("--src-crs", "EPSG:25833", "--dst-crs", "EPSG:25832")
    done = liftmesh("triangulate", "a.ply", "c.ply", *words, cwd=tmp_path)
    assert "a.ply: states ETRS89 / UTM zone 32N; --src-crs says another system" in done.stderr


def test_degrees_that_were_asked_for(tmp_path: Path) -> None:
    cloud = Cloud(np.array([[5e5, 5e6, 1], [5e5 + 9, 5e6, 1], [5e5, 5e6 + 9, 1]]), crs="EPSG:25832")
    lm.write(tmp_path / "a.ply", cloud)
    done = liftmesh("triangulate", "a.ply", "b.ply", "--dst-crs", "EPSG:4326", cwd=tmp_path)
    assert "are no lengths: name a projected system with --dst-crs\n" in done.stderr
    done = liftmesh("triangulate", "b.ply", "c.ply", cwd=tmp_path)
    assert "are no lengths: transform them with --dst-crs\n" in done.stderr


def test_no_system_is_no_error() -> None:
    with pytest.raises(FormatError, match="not a LAS file"):
        lm.read(io.BytesIO(b"LASG" + bytes(400)), format="las", dst_crs="EPSG:25832")
