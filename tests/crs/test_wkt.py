"""Texts of coordinate systems from strangers: PROJ and GDAL see definitions, and no files."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import pytest
from commands import liftmesh
from hypothesis import given, settings, strategies as st

import liftmesh as lm
from liftmesh import Cloud, InputError
from liftmesh.crs.comparison import as_system, is_same
from liftmesh.crs.description import (
    check_system,
    has_grids,
    is_system,
    look_up,
    parse_crs,
    parse_wkt,
    plain_wkt,
    without_files,
)
from liftmesh.raster.writer import validate_geotiff_options

UTM1 = pyproj.CRS(25832).to_wkt("WKT1_GDAL")
UTM2 = pyproj.CRS(25832).to_wkt("WKT2_2019")
VERTICAL = pyproj.CRS(5703).to_wkt("WKT2_2019")
INIT = "<1> +proj=utm +zone=33 +datum=WGS84 +no_defs <>\n"
NUMBER, METHOD = 'AUTHORITY["EPSG","25832"]', 'METHOD["Transverse Mercator",ID["EPSG",9807]]'
BOUND = f"BOUNDCRS[SOURCECRS[{UTM2}],TARGETCRS[{pyproj.CRS(4326).to_wkt('WKT2_2019')}],"
FILE = 'PARAMETERFILE["Latitude and longitude difference file","%s"]'
DOORS = {
    "init": "X( +init=%s:1",
    "another bracket": "X[ +init=%s:1",
    "part of a system": 'METADATA[" +init=%s:1"]',
    "another part": 'BEARING["a",BEARING[" init=%s:1 "],UNIT["m",1]]',
    "a part before a system": f'METADATA[" +init=%s:1"],{UTM1}',
    "string of PROJ": "+proj=utm +zone=32 +nadgrids=%s",
    "pipeline": "+proj=pipeline +step +init=%s:1",
    "extension": UTM1.replace(NUMBER, 'EXTENSION["PROJ4","+init=%s:1"]'),
    "small letters": UTM1.replace(NUMBER, 'extension("proj4","+init=%s:1")'),
    "no quotes": UTM1.replace(NUMBER, 'EXTENSION[PROJ4,"+init=%s:1"]'),
    "grid of an extension": UTM1.replace(
        NUMBER, 'EXTENSION["PROJ4","+proj=utm +zone=32 +ellps=GRS80 +nadgrids=%s"]'
    ),
    "Mercator and more": UTM1.replace(
        NUMBER,
        'EXTENSION["PROJ4","+proj=merc +a=6378137 +b=6378137 +lat_ts=0 +lon_0=0 +x_0=0 +y_0=0 +k=1 '
        '+units=m +nadgrids=@null +nadgrids=%s +wktext +no_defs"]',
    ),
    "method": UTM2.replace(METHOD, 'METHOD["PROJ-based operation method: +init=%s:1"]'),
    "file of a method": f'{BOUND}ABRIDGEDTRANSFORMATION["x",METHOD["NTv2"],{FILE}]]',
    "geoid": VERTICAL[:-1].rpartition(",USAGE")[0] + ',GEOIDMODEL["PROJ %s"]]',
    "JSON": json.dumps({"type": "BoundCRS", "source_crs": {"file": "%s"}}),
    "a path": "%s",
    "an authority": "%s:1",
}


@pytest.mark.parametrize("door", DOORS)
def test_texts_that_name_files_reach_nobody(
    door: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "init").write_text(INIT)
    text = DOORS[door].replace("%s", str(tmp_path / "init"))
    assert DOORS[door] not in (UTM1, UTM2)
    seen: list[object] = []
    monkeypatch.setattr(pyproj.CRS, "from_user_input", seen.append)
    assert not is_system(text)
    assert plain_wkt(text) is None
    assert without_files(text) is None
    parse_crs(text)
    assert not is_same(text, "EPSG:25832")
    for refused in (
        lambda: look_up(text),
        lambda: check_system("src_crs", text),
        lambda: validate_geotiff_options(text, None),
        lambda: lm.read(io.BytesIO(b"0 0 1\n"), format="xyz", src_crs=text),
        lambda: as_system("crs", text),
    ):
        with pytest.raises(InputError, match="is unknown: give WKT or EPSG:n"):
            refused()
    assert [each for each in seen if each != "EPSG:25832"] == []


def test_the_doors_are_there() -> None:
    """PROJ takes most of these texts for systems, once the file is there."""
    for door in ("extension", "method", "grid of an extension", "file of a method", "geoid"):
        assert pyproj.CRS.from_user_input(DOORS[door].replace("%s", "none")) is not None


def test_remarks_and_grids_are_left_out() -> None:
    remark = UTM2[:-1] + ',REMARK["my PROJ CRS string: +proj=utm +zone=33"]]'
    text = plain_wkt(remark)
    assert text == UTM2
    kept = UTM2[:-1] + ',REMARK["measured twice"]]'
    assert plain_wkt(kept) == kept
    grids = 'EXTENSION["PROJ4_GRIDS","/a/grid.gtx"]'
    heights = f'VERT_CS["NAVD88 height",VERT_DATUM["NAVD88",2005,{grids}],UNIT["metre",1]]'
    assert has_grids(heights)
    text = plain_wkt(heights)
    assert text == heights.replace(f",{grids}", "")
    assert not has_grids(text)


def test_heights_of_a_named_grid_are_kept_and_not_converted() -> None:
    heights = (
        'VERT_CS["NAVD88 height",VERT_DATUM["North American Vertical Datum 1988",2005,'
        'EXTENSION["PROJ4_GRIDS","g2012b.gtx"],AUTHORITY["EPSG","5103"]],UNIT["metre",1],'
        'AXIS["Gravity-related height",UP],AUTHORITY["EPSG","5703"]]'
    )
    plane = pyproj.CRS(26910).to_wkt("WKT1_GDAL")
    crs = f'COMPD_CS["both",{plane},{heights}]'
    points = np.array([[5e5, 5e6, 7.0], [5e5 + 9, 5e6, 8.0], [5e5, 5e6 + 9, 9.0]])
    stream = io.BytesIO()
    lm.write(stream, Cloud(points, crs=crs), format="ply")
    stream.seek(0)
    found = lm.read(stream, format="ply", dst_crs="EPSG:26911")
    assert found.points[:, 2].tolist() == [7, 8, 9]
    assert found.crs == "EPSG:26911+5703"
    stream.seek(0)
    with pytest.raises(InputError, match=r"are those of a grid \(PROJ4_GRIDS\), and no file"):
        lm.read(stream, format="ply", dst_crs="EPSG:4979")
    assert validate_geotiff_options(crs, None) is not None


@pytest.mark.parametrize("version", ["WKT1_GDAL", "WKT1_ESRI", "WKT2_2015", "WKT2_2019"])
@pytest.mark.parametrize(
    "code", ["EPSG:3857", "EPSG:25832+7837", "EPSG:4979", "EPSG:2056", "ESRI:54003", "EPSG:27700"]
)
def test_what_proj_writes_is_given_back_as_it_is(code: str, version: str) -> None:
    try:
        text = pyproj.CRS(code).to_wkt(version)
    except pyproj.exceptions.CRSError:
        assert (code, version) == ("EPSG:4979", "WKT1_GDAL")
        return
    assert plain_wkt(text) == text
    assert plain_wkt(pyproj.CRS(code).to_wkt(version, pretty=True)) == text


def test_mercator_of_the_web_in_older_words() -> None:
    text = pyproj.CRS(3857).to_wkt("WKT1_GDAL")
    older = text.replace("+lat_ts=0 +lon_0=0 +x_0=0", "+lat_ts=0.0 +lon_0=0.0  +x_0=0.0")
    assert older != text
    assert look_up(older).equals(pyproj.CRS(3857))


@pytest.mark.parametrize(
    "code", ["FOO:1", "IGNF:1", "/etc/hosts:1", "EPSG:1:2", "urn:ogc:def:crs:a::1"]
)
def test_authorities_are_those_that_have_numbers(code: str) -> None:
    assert not is_system(code)


def test_authorities_that_have_numbers() -> None:
    for code in ("EPSG:25832", "epsg:25832+7837", "ESRI:102008", "urn:ogc:def:crs:EPSG::25832"):
        assert look_up(code) is not None


WRONG = (
    'A["a" "b"]', "A[1,B[2],3]", "A[[1]]", 'A["a"]"b"', "A[1]]", "A[1", "1,A[2]",
    "A[\u20181\u2019]", "A[1];", "A[1]B[2]", 'A["a]', "A[1 2]", "A[$]", "",
)  # fmt: skip


@pytest.mark.parametrize("text", WRONG)
def test_what_is_no_text_of_nodes(text: str) -> None:
    assert parse_wkt(text) is None
    assert plain_wkt(text) is None


PARTS = st.sampled_from(
    [
        "PROJCS",
        "UNIT",
        "EXTENSION",
        "REMARK",
        "[",
        "]",
        "(",
        ")",
        ",",
        '"',
        '""',
        "1",
        " ",
        "+",
        "PROJ",
    ]
)


@given(st.lists(PARTS, max_size=40).map("".join) | st.text(max_size=60))
@settings(derandomize=True, database=None)
def test_a_plain_text_is_its_own(text: str) -> None:
    found = plain_wkt(text)
    if found is not None:
        assert plain_wkt(found) == found
        first, second = parse_wkt(found), parse_wkt(text)
        assert first is not None
        assert second is not None
        assert first.title == second.title


def test_commands_open_no_files_of_a_system(tmp_path: Path) -> None:
    points = np.random.default_rng(0).random((50, 3)) * 1000 + [500000, 5000000, 0]
    (tmp_path / "init").write_text(INIT)
    evil = f"X( +init={tmp_path / 'init'}:1"
    lm.write(tmp_path / "a.ply", Cloud(points, crs=evil))
    lm.write(tmp_path / "b.ply", Cloud(points, crs="EPSG:25833"))
    for words in (
        ("triangulate", "a.ply", "o.ply", "--dst-crs", "EPSG:25833"),
        ("raster", "a.ply", "o.tif", "--resolution", "50"),
        ("contour", "a.ply", "o.gpkg", "--interval", "100"),
    ):
        done = liftmesh(*words, cwd=tmp_path)
        assert done.returncode == 3
        assert "the coordinate system 'X( +init=" in done.stderr
        assert "is unknown" in done.stderr
    square = [[[0, 0], [1e6, 0], [1e6, 9e6], [0, 9e6], [0, 0]]]
    named: Any = {"type": "name", "properties": {"name": evil}}
    polygon = {"type": "Polygon", "crs": named, "coordinates": square}
    (tmp_path / "c.geojson").write_text(json.dumps(polygon))
    done = liftmesh("triangulate", "b.ply", "o.ply", "--trim-polygon", "c.geojson", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    cells = lm.voronoi(points[:, :2], domain=(499000, 4999000, 502000, 5002000))
    object.__setattr__(cells.domain, "crs", evil)
    with pytest.raises(InputError, match="is unknown"):
        cells.to_geodataframe()


def test_grids_are_not_fetched(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    make = pyproj.Transformer.from_crs

    def watched(*systems: Any, **options: Any) -> Any:
        found.append(pyproj.network.is_network_enabled())
        return make(*systems, **options)

    monkeypatch.setattr(pyproj.Transformer, "from_crs", watched)
    was = pyproj.network.is_network_enabled()
    pyproj.network.set_network_enabled(active=True)
    try:
        rows = io.BytesIO(b"9 48 1\n")
        lm.read(rows, format="xyz", src_crs="EPSG:4326", dst_crs="EPSG:25832")
        assert pyproj.network.is_network_enabled()
    finally:
        pyproj.network.set_network_enabled(active=was)
    assert found == [False]
