"""GeoKeys: the system that counts, and the units of the plane and of heights, known apart."""

from __future__ import annotations

import io
import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyproj
import pytest
import rasterio
from files.las import encoded, geo_keys, record, tile, with_records
from rasterio.transform import Affine

import liftmesh as lm
from liftmesh import Cloud, FormatError, InputError
from liftmesh.crs.description import parse_crs
from liftmesh.crs.geokeys import _tiff

PROJECTION = b"LASF_Projection"
WKT = 'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89"],UNIT["metre",1]]'


def read(*others: bytes, wkt: bool = False, **keys: Any) -> Cloud:
    made = record(PROJECTION, 34735, geo_keys(**keys))
    data = with_records(encoded(tile(4)), made, *others, wkt=wkt)
    return lm.read(io.BytesIO(data), format="las")


def units(cloud: Cloud) -> tuple[str | None, ...]:
    system = parse_crs(cloud.crs)
    assert system is not None
    return tuple(each.name if each else None for each in system.units)


@pytest.mark.parametrize(
    "keys",
    [
        {"k1024": 1, "k2048": 4269, "k3072": 32767, "k3076": 9003},
        {"k1024": 1, "k2048": 4269, "k3075": 8},
        {"k2048": 4269, "k3072": 32767},
        {"k1024": 1, "k2048": 4269},
    ],
)
def test_what_a_projected_system_is_made_of_is_not_its_system(keys: dict[str, Any]) -> None:
    assert read(**keys).crs is None
    beside = record(b"liblas", 2112, WKT.encode())
    assert read(beside, **keys).crs == WKT


def test_degrees_are_said_by_the_model_or_by_nothing_else() -> None:
    assert read(k1024=2, k2048=4326, k3072=32767).crs == "EPSG:4326"
    assert read(k2048=4326).crs == "EPSG:4326"
    assert read(k1024=2, k2048=4326, k4096=5773).crs == "EPSG:4326+5773"


@pytest.mark.parametrize(("number", "crs"), [(4326, "EPSG:4978"), (4978, "EPSG:4978"), (4269, "")])
def test_geocentric_systems(number: int, crs: str) -> None:
    cloud = read(k1024=3, k2048=number)
    assert crs in (cloud.crs or "")
    system = parse_crs(cloud.crs)
    assert system is not None
    assert system.kind == "geocentric"
    with pytest.raises(InputError, match="geocentric"):
        lm.triangulate(cloud)


HEIGHTS: dict[str, tuple[dict[str, Any], str, str | None]] = {
    "old number": ({"k4096": 5103}, "EPSG:26910+5703", "metre"),
    "old number in feet": ({"k4096": 5103, "k4099": 9002}, "EPSG:26910+8228", "foot"),
    "in survey feet": ({"k4096": 5103, "k4099": 9003}, "EPSG:26910+6360", "US survey foot"),
    "of 1929": ({"k4096": 5102, "k4099": 9003}, "EPSG:26910+5702", "US survey foot"),
    "of metres, in feet": ({"k4096": 5703, "k4099": 9003}, "EPSG:26910+6360", "US survey foot"),
    "unknown number": ({"k4096": 5030}, "EPSG:26910", None),
    "number of another kind": ({"k4096": 4326}, "EPSG:26910", None),
    "user-defined": ({"k4096": 32767}, "EPSG:26910", None),
    "unknown unit": ({"k4099": 9036}, "EPSG:26910", None),
}


@pytest.mark.parametrize("case", HEIGHTS)
def test_systems_of_heights(case: str) -> None:
    keys, crs, unit = HEIGHTS[case]
    cloud = read(k1024=1, k3072=26910, k3076=9001, **keys)
    assert cloud.crs == crs
    assert units(cloud) == ("metre", "metre", unit)


@pytest.mark.parametrize("keys", [{}, {"k4096": 5030}, {"k4096": 5709}])
def test_a_unit_of_heights_without_a_system(keys: dict[str, Any]) -> None:
    cloud = read(k1024=1, k3072=26910, k4099=9003, **keys)
    assert units(cloud) == ("metre", "metre", "US survey foot")
    system = parse_crs(cloud.crs)
    assert system is not None
    assert system.is_mixed
    assert (system.kind, system.name) == ("projected", "EPSG:26910 + heights in US survey foot")


def test_a_unit_that_contradicts_the_number_is_named() -> None:
    cloud = read(k1024=1, k3072=2225, k3076=9001)
    assert cloud.crs is None
    assert cloud.metadata["not_read"] == (
        "GeoKeys (EPSG:2225 has the unit US survey foot, but they state metre)",
    )
    beside = record(PROJECTION, 2112, WKT.encode())
    assert read(beside, k1024=1, k3072=2225, k3076=9001).crs == WKT
    assert "not_read" not in read(beside, wkt=True, k3072=2225, k3076=9001).metadata
    assert read(k1024=1, k3072=2225, k3076=9003).crs == "EPSG:2225"


@pytest.mark.parametrize("version", ["1.0", "1.1"])
def test_heights_of_a_raster_in_feet_over_metres(version: str) -> None:
    with rasterio.MemoryFile() as memory:
        with memory.open(
            driver="GTiff", count=1, height=2, width=2, dtype="float32", crs="EPSG:26910+6360",
            transform=Affine(2, 0, 10, 0, -2, 10), GEOTIFF_VERSION=version,
        ):  # fmt: skip
            pass
        cloud = lm.read(io.BytesIO(memory.getbuffer()), format="tif")
    assert units(cloud) == ("metre", "metre", "US survey foot")


CUSTOM = {
    "lambert": "+proj=lcc +lat_1=43 +lat_2=45.5 +lat_0=41.75 +lon_0=-120.5 +x_0=400000 +y_0=0 "
    "+datum=NAD83 +units=ft",
    "mercator": "+proj=tmerc +lat_0=1 +lon_0=9.5 +k=0.9999 +x_0=3000 +y_0=17 +ellps=GRS80 +units=m",
    "albers": "+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +datum=NAD83 +units=us-ft",
}


def parameters(system: str) -> list[bytes]:
    """Take the GeoKeys that GDAL writes to a TIFF file, as records of LAS."""
    with rasterio.MemoryFile() as memory:
        with memory.open(
            driver="GTiff", width=1, height=1, count=1, dtype="uint8", crs=system,
            transform=Affine(2, 0, 0, 0, -2, 0),
        ):  # fmt: skip
            pass
        data = bytes(memory.getbuffer())
    start = int.from_bytes(data[4:8], "little")
    found = []
    for k in range(int.from_bytes(data[start : start + 2], "little")):
        number, kind, count, place = struct.unpack_from("<HHII", data, start + 2 + 12 * k)
        if number in (34735, 34736, 34737):
            size = count * {3: 2, 12: 8, 2: 1}[kind]
            found.append(record(PROJECTION, number, data[place : place + size]))
    return found


@pytest.mark.parametrize("name", CUSTOM)
def test_systems_of_parameters(name: str) -> None:
    las = with_records(encoded(tile(4)), *parameters(CUSTOM[name]))
    cloud = lm.read(io.BytesIO(las), format="las")
    there = pyproj.Transformer.from_crs(CUSTOM[name], "EPSG:4326", always_xy=True)
    ours = pyproj.Transformer.from_crs(cloud.crs, "EPSG:4326", always_xy=True)
    places = np.array([[1e6, 4e5], [2e6, 6e5]])
    assert np.allclose(ours.transform(*places), there.transform(*places), rtol=0, atol=1e-12)
    unit = {"lambert": "foot", "mercator": "metre", "albers": "US survey foot"}[name]
    assert units(cloud)[0] == unit
    stream = io.BytesIO()
    lm.write(stream, cloud, format="las")
    assert stream.getvalue() == las  # GeoKeys stay as they are
    assert "not_read" not in cloud.metadata


def test_systems_of_parameters_that_nobody_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    doubles = record(PROJECTION, 34736, struct.pack("<2d", 1, 2))
    for said, beside in (("which are missing", ()), ("that GDAL does not know", (doubles,))):
        cloud = read(*beside, k1024=1, k2048=4269, k3072=32767, k3075=99)
        assert cloud.crs is None
        assert said in cloud.metadata["not_read"][0]
    monkeypatch.setitem(sys.modules, "rasterio", None)
    cloud = read(doubles, k1024=1, k2048=4269, k3072=32767, k3075=8)
    assert "pip install 'liftmesh[terrain]'" in cloud.metadata["not_read"][0]


def keys_of(model: int, *others: tuple[int, int, int, int]) -> bytes:
    rows = sorted([(1024, 0, 1, model), (3072, 0, 1, 32767), *others])
    return struct.pack("<4H", 1, 1, 0, len(rows)) + b"".join(struct.pack("<4H", *k) for k in rows)


def raster(model: int, text: bytes, *others: tuple[int, int, int, int]) -> bytes:
    """Make a TIFF file of a pixel whose citation of the projected system is a text."""
    cited = (3073, 34737, len(text), 0)
    records = {34735: keys_of(model, cited, *others), 34737: text, 34736: struct.pack("<d", 9)}
    return _tiff(records)


ESRI = pyproj.CRS(25832).to_wkt("WKT1_ESRI")


def test_the_wkt_of_a_citation_is_read_by_us(tmp_path: Path) -> None:
    mark = b"ESRI PE String = "
    (tmp_path / "init").write_text("<1> +proj=utm +zone=33 +datum=WGS84 +no_defs <>\n")
    data = raster(32767, mark + ESRI.encode() + b"|")
    cloud = lm.read(io.BytesIO(data), format="tif")
    assert cloud.crs == ESRI
    evil = f'{ESRI[:-1]},EXTENSION["PROJ4","+proj=utm +init={tmp_path}/init:1"]]'
    prefixes = (mark, b"0123456789abcdefg", b"A|")
    for each in prefixes:
        text = each + evil.encode() + (b"" if each == mark else mark) + b"|"
        cloud = lm.read(io.BytesIO(raster(32767, text)), format="tif")
        assert cloud.crs is not None
        assert cloud.crs.startswith("LOCAL_CS")
    with rasterio.MemoryFile(data, ext=".tif") as memory, memory.open() as file:
        assert file.crs.to_wkt().startswith('PROJCS["ETRS89')  # GDAL takes it for WKT


def test_citations_in_other_encodings() -> None:
    method = (3075, 0, 1, 1)
    data = raster(1, "Gauß-Krüger, Zone 3|".encode("latin-1"), method)
    cloud = lm.read(io.BytesIO(data), format="tif")
    assert cloud.crs is not None
    assert cloud.crs.startswith('PROJCS["Gau?-Kr?ger, Zone 3"')
    found = lm.read(io.BytesIO(raster(1, "Gauß|".encode(), method)), format="tif")
    assert str(found.crs).startswith('PROJCS["Gauß"')
    cited = record(PROJECTION, 34737, "Gauß-Krüger|".encode("latin-1"))
    keys = keys_of(1, (3073, 34737, 12, 0), method, (3088, 34736, 1, 0))
    records = record(PROJECTION, 34735, keys), record(PROJECTION, 34736, struct.pack("<d", 9))
    las = with_records(encoded(tile(4)), *records, cited)
    assert str(lm.read(io.BytesIO(las), format="las").crs).startswith('PROJCS["Gau?-Kr?ger"')


def test_parameters_that_are_no_numbers() -> None:
    nan = struct.pack("<d", np.nan)
    keys = keys_of(1, (3074, 0, 1, 32767), (3075, 0, 1, 27), (3088, 34736, 1, 0))
    with pytest.raises(FormatError, match="<stream>: the raster cannot be decoded"):
        lm.read(io.BytesIO(_tiff({34735: keys, 34736: nan})), format="tif")
    records = record(PROJECTION, 34735, keys), record(PROJECTION, 34736, nan)
    cloud = lm.read(io.BytesIO(with_records(encoded(tile(4)), *records)), format="las")
    assert cloud.crs is None
    assert "that GDAL does not know" in cloud.metadata["not_read"][0]
