"""Files of shapes: what geopandas writes is read; what else a file may ask for is refused."""

from __future__ import annotations

import functools
import json
import sqlite3
import struct
from contextlib import closing, suppress
from pathlib import Path
from typing import Any
from warnings import catch_warnings, simplefilter

import geopandas
import numpy as np
import pytest
import shapely
from children import output
from hypothesis import given, settings, strategies as st

from liftmesh import read
from liftmesh.cells.files import read_domain
from liftmesh.errors import DataWarning, FormatError
from liftmesh.vector.files import read_features
from liftmesh.vector.geopackage import geometry_of

SQUARE = shapely.box(0, 0, 8, 8)
ISLANDS = shapely.MultiPolygon(
    [
        shapely.Polygon(SQUARE.exterior, [shapely.box(1, 1, 7, 7).exterior]),
        shapely.Polygon(shapely.box(2, 2, 6, 6).exterior, [shapely.box(3, 3, 5, 5).exterior]),
        shapely.box(10, 0, 12, 2),
    ]
)
CURVES = ("CircularString", "CompoundCurve", "CurvePolygon", "MultiCurve", "MultiSurface")
LINES = shapely.MultiLineString([[(0, 0), (1, 1)], [(2, 2), (3, 5), (4, 4)]])
COMMON = [shapely.Point(1, 2), LINES, shapely.MultiPoint([(1, 2), (3, 4)]), ISLANDS]
ALL = [
    *COMMON,
    SQUARE,
    shapely.LineString([(0, 1, 5), (2, 3, 6)]),
    shapely.GeometryCollection(COMMON),
]


def saved(path: Path, shapes: Any, **columns: Any) -> Path:
    frame = geopandas.GeoDataFrame(columns, geometry=[*shapes], crs="EPSG:25832")
    frame.to_file(path, **({"layer": "lots"} if path.suffix == ".gpkg" else {}))
    return path


def changed(path: Path, *commands: str) -> Path:
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        connection.execute("PRAGMA writable_schema = ON")
        triggers = connection.execute("SELECT name FROM sqlite_master WHERE type = 'trigger'")
        for each in [*(f'DROP TRIGGER "{name}"' for (name,) in triggers.fetchall()), *commands]:
            connection.execute(each)
    return path


def shapes_in(path: Path) -> list[Any]:
    held = (each["geometry"] for each in read_features(path, "shapes")["features"])
    return [None if each is None else shapely.geometry.shape(each) for each in held]


@pytest.mark.parametrize("shape", ALL)
@pytest.mark.parametrize("options", [{}, {"byte_order": 0}, {"include_srid": True}])
def test_binary_geometries_are_those_of_shapely(shape: Any, options: dict[str, Any]) -> None:
    for flavor in ("extended", "iso"):
        if flavor == "extended" or "include_srid" not in options:
            held = shapely.set_srid(shape, 25832)
            found = geometry_of(shapely.to_wkb(held, flavor=flavor, **options))
            assert shapely.geometry.shape(found) == shape


def test_binary_geometries_that_are_none() -> None:
    whole = shapely.to_wkb(ISLANDS)
    for length in range(len(whole)):
        with pytest.raises((ValueError, struct.error, IndexError)):
            geometry_of(whole[:length])
    for kind in (0, 13, 14, 18):
        with pytest.raises(ValueError, match="a curve, a surface or unknown"):
            geometry_of(struct.pack("<BII", 1, kind, 0))
    with pytest.raises(ValueError, match="a curve, a surface"):
        geometry_of(struct.pack("<BII", 1, 7, 1) * 100_000)
    with pytest.raises(ValueError, match="type 8 of geometries is a curve"):
        geometry_of(struct.pack("<BIIBII", 1, 7, 1, 1, 8, 0))
    with pytest.raises(ValueError, match="a MultiPoint holds type 2"):
        geometry_of(struct.pack("<BIIBII", 1, 4, 1, 1, 2, 0))
    with pytest.raises(ValueError, match="a TIN holds type 3"):
        geometry_of(struct.pack("<BIIBII", 1, 1016, 1, 1, 1003, 0))
    with pytest.raises(ValueError, match="smaller than requested"):
        geometry_of(struct.pack("<BII", 1, 2, 2**32 - 1))


@pytest.mark.parametrize("suffix", ["gpkg", "geojson"])
def test_every_kind_of_shape_in_one_file(tmp_path: Path, suffix: str) -> None:
    path = saved(tmp_path / f"all.{suffix}", [*ALL, None])
    *found, nothing = shapes_in(path)
    assert nothing is None
    assert [*map(shapely.force_2d, found)] == [*map(shapely.force_2d, ALL)]


@pytest.mark.parametrize("shape", COMMON)
@pytest.mark.parametrize("is_high", [False, True])
def test_every_kind_of_shapefile(tmp_path: Path, shape: Any, is_high: bool) -> None:
    held = shapely.force_3d(shape, 7.0) if is_high else shape
    path = saved(tmp_path / "all.shp", [held, held, None])
    one, other, nothing = shapes_in(path)
    assert nothing is None
    assert one == other
    assert shapely.equals(one, shape)
    assert read_features(path, "shapes")["crs"]["properties"]["name"] == "EPSG:25832"


@pytest.mark.parametrize("suffix", ["gpkg", "shp"])
def test_values_are_kept(tmp_path: Path, suffix: str) -> None:
    columns = {
        "name": ["A", "Höhe", None],
        "id": [2**53 + 1, -5, 0],
        "depth": [1.5, None, -1e-3],
        "wet": [True, False, True],
    }
    path = saved(tmp_path / f"a.{suffix}", map(shapely.Point, range(3), range(3)), **columns)
    rows = [each["properties"] for each in read_features(path, "points")["features"]]
    for name, values in columns.items():
        assert [row[name] for row in rows] == values


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=6))
def test_holes_go_to_the_smallest_ring_around_them(tmp_path_factory, corners) -> None:
    """Rings in rings, eight deep, at several places."""
    places = sorted({*corners})
    rings = [
        shapely.box(x + k / 20, y + k / 20, x + 0.9 - k / 20, y + 0.9 - k / 20)
        for x, y in places
        for k in range(8)
    ]
    shape = rings[0]
    for ring in rings[1:]:
        shape = shape.symmetric_difference(ring)
    path = saved(tmp_path_factory.mktemp("rings") / "a.shp", [shape])
    assert shapely.equals(shapes_in(path)[0], shape)
    assert shapely.equals(area_of(read_domain(path)), shape)


def area_of(domain: Any) -> shapely.Geometry:
    """What is within an odd number of rings."""
    rings = map(shapely.Polygon, np.split(domain.corners, domain.starts[1:-1]))
    return functools.reduce(shapely.symmetric_difference, rings)


def test_the_domain_is_the_same_in_every_format(tmp_path: Path) -> None:
    found = [read_domain(saved(tmp_path / f"a.{each}", [ISLANDS])) for each in ("gpkg", "shp")]
    (tmp_path / "a.geojson").write_text(shapely.to_geojson(ISLANDS))
    assert all(each.crs == "EPSG:25832" for each in found)
    found.append(read_domain(tmp_path / "a.geojson"))
    assert all(shapely.equals(area_of(each), ISLANDS) for each in found)
    assert found[2].crs == "EPSG:4326"  # of GeoJSON that names no other
    tree = json.loads(shapely.to_geojson(ISLANDS))
    tree["crs"] = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    (tmp_path / "a.geojson").write_text(json.dumps(tree))
    assert read_domain(tmp_path / "a.geojson").crs == "EPSG:25832"


FOREIGN = {
    "vrt": '<OGRVRTDataSource><OGRVRTLayer name="t"><SrcDataSource>/vsicurl/http://127.0.0.1:9/a'
    "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>",
    "gml": '<?xml version="1.0"?><ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/"/>',
    "kml": '<?xml version="1.0"?><kml><NetworkLink href="http://127.0.0.1:9/a"/></kml>',
    "csv": "WKT\nPOINT (1 2)\n",
    "wfs": "WFS:http://127.0.0.1:9/wfs",
    "dxf": "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n",
    "flatgeobuf": "fgb\x03fgb\x00",
    "zip": "PK\x03\x04",
}


@pytest.mark.parametrize("kind", FOREIGN)
@pytest.mark.parametrize("suffix", ["gpkg", "shp", "fgb", "vrt", "geojson"])
def test_a_file_of_another_kind_is_refused_whatever_its_name(tmp_path, kind, suffix) -> None:
    path = tmp_path / f"area.{suffix}"
    path.write_text(FOREIGN[kind])
    with pytest.raises(FormatError, match=r"neither GeoJSON nor|not GeoJSON"):
        read_features(path, "polygons")
    assert [*tmp_path.iterdir()] == [path]


def test_no_other_library_reads_a_file_of_shapes(tmp_path: Path) -> None:
    """Those fetch, write and start threads by what a file says; some end for want of memory."""
    paths = [saved(tmp_path / f"a.{each}", [SQUARE]) for each in ("gpkg", "shp", "geojson")]
    program = """
        import sys
        from pathlib import Path
        from liftmesh.vector.files import read_features
        from liftmesh.vector.polygons import polygons_in

        for each in sys.argv[1:]:
            polygons_in(None, each)
        print(sorted({"pyogrio", "geopandas", "fiona", "osgeo", "pyarrow"} & {*sys.modules}))
    """
    assert output(program, *map(str, paths)).strip() == "[]"


def endless(path: Path) -> Path:
    view = (
        "CREATE VIEW lots AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
        "SELECT i AS fid, geom FROM n, real WHERE i < 0"
    )
    return changed(path, "ALTER TABLE lots RENAME TO real", view)


def of_contents(path: Path) -> Path:
    text = "CREATE VIEW gpkg_contents AS SELECT * FROM kept"
    return changed(path, "ALTER TABLE gpkg_contents RENAME TO kept", text)


def virtual(path: Path) -> Path:
    name = "UPDATE {} SET table_name = 'rtree_lots_geom'"
    return changed(
        path, *(name.format(each) for each in ("gpkg_contents", "gpkg_geometry_columns"))
    )


def disguised(path: Path) -> Path:
    """A view that the schema calls a table, with a page of its own."""
    text = "UPDATE sqlite_master SET sql = 'CREATE VIEW lots AS SELECT 1 AS fid, x''00'' AS geom' "
    return changed(path, text + "WHERE name = 'lots'")


def computed(path: Path) -> Path:
    text = "ALTER TABLE lots ADD COLUMN more GENERATED ALWAYS AS (hex(zeroblob(1000000))) VIRTUAL"
    return changed(path, text)


def computed_contents(path: Path) -> Path:
    """A name of 400 MB, each column of which is the one before it twice."""
    twice = (f"c{k} AS (c{k - 1} || c{k - 1})" for k in range(1, 24))
    columns = f"data_type, c0, {', '.join(twice)}, table_name AS (c23)"
    row = f"INSERT INTO gpkg_contents(data_type, c0) VALUES ('features', '{'x' * 50}')"
    return changed(path, "DROP TABLE gpkg_contents", f"CREATE TABLE gpkg_contents({columns})", row)


def nameless(path: Path) -> Path:
    name = "CREATE TABLE {0} AS SELECT 7 AS table_name, {1}"
    return changed(
        path,
        "DROP TABLE gpkg_contents",
        "DROP TABLE gpkg_geometry_columns",
        name.format("gpkg_contents", "'features' AS data_type"),
        name.format("gpkg_geometry_columns", "'geom' AS column_name, 0 AS srs_id"),
    )


def plain(path: Path) -> Path:
    return changed(path, "DROP TABLE gpkg_contents")


def without_geometry(path: Path) -> Path:
    return changed(path, "UPDATE gpkg_contents SET data_type = 'attributes'")


def no_column(path: Path) -> Path:
    return changed(path, "UPDATE gpkg_geometry_columns SET column_name = 'nothing'")


def no_blob(path: Path) -> Path:
    return changed(path, "UPDATE lots SET geom = 'GP'")


def wide(path: Path) -> Path:
    """Every row has long values, of which its bytes hold none."""
    rows = ", ".join(["(NULL)"] * 2000)
    added = (f"ALTER TABLE lots ADD COLUMN a{k} TEXT DEFAULT '{'x' * 5000}'" for k in range(100))
    return changed(path, f"INSERT INTO lots(geom) VALUES {rows}", *added)


def waiting(path: Path) -> Path:
    path.with_name(path.name + "-wal").write_bytes(b"changes")
    return path


def circular(path: Path) -> Path:
    """Six levels of pages, all of whose children are the page below: 10 to the 12 rows."""
    with closing(sqlite3.connect(path)) as connection:
        (root,) = next(connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'lots'"))
        (size,) = next(connection.execute("PRAGMA page_size"))
    data = bytearray(path.read_bytes())
    leaf = data[(root - 1) * size : root * size]
    below = len(data) // size + 1
    data += leaf
    for level in range(6):
        cells = [struct.pack(">IB", below, 1)] * 100
        places = [size - 5 * (k + 1) for k in range(100)]
        head = struct.pack(">BHHHBI", 5, 0, 100, places[-1], 0, below)
        page = (head + struct.pack(">100H", *places)).ljust(size - 500, b"\0") + b"".join(cells)
        if level < 5:
            data += page
            below += 1
        else:
            data[(root - 1) * size : root * size] = page
    data[28:32] = struct.pack(">I", len(data) // size)
    path.write_bytes(data)
    return path


REFUSED = {
    endless: "'lots' is no ordinary table but view",
    of_contents: "'gpkg_contents' is no ordinary table but view",
    virtual: "'rtree_lots_geom' is no ordinary table but table",
    disguised: "damaged|no ordinary table",
    computed: "table 'lots' has computed columns",
    computed_contents: "table 'gpkg_contents' has computed columns",
    nameless: "7 is no ordinary table but nothing",
    plain: "no GeoPackage",
    without_geometry: "no layer of features",
    no_column: "has no column 'nothing'",
    no_blob: "no geometry of a GeoPackage",
    wide: "holds more than the file",
    waiting: "changes wait in a.gpkg-wal",
    circular: "holds more than the file|interrupted|malformed",
}


@pytest.mark.slow
@pytest.mark.parametrize("change", REFUSED, ids=lambda each: each.__name__)
def test_what_is_no_row_of_a_table_is_refused(tmp_path: Path, change: Any) -> None:
    path = change(saved(tmp_path / "a.gpkg", [SQUARE]))
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    with pytest.raises(FormatError, match=REFUSED[change]):
        read_features(path, "polygons")
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before


def test_other_layers_are_named(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.gpkg", [SQUARE])
    geopandas.GeoSeries([ISLANDS], crs="EPSG:25832").to_file(path, layer="more", mode="a")
    with pytest.warns(DataWarning, match="layer 'lots' is read, and 'more' not"):
        assert shapes_in(path) == [SQUARE]


@pytest.mark.parametrize("kind", range(8, 13))
@pytest.mark.parametrize("high", [0, 1000])
def test_curves_are_named_beside_points_and_refused_beside_lines(
    tmp_path: Path, kind: int, high: int
) -> None:
    path = saved(tmp_path / "a.gpkg", [shapely.Point(1, 2), shapely.Point(3, 4), LINES])
    curve = "4750000100000000" + struct.pack("<BII", 1, kind + high, 3).hex()
    changed(path, f"UPDATE lots SET geom = x'{curve}' WHERE fid = 2")
    found, name = read(path), CURVES[kind - 8]
    assert found.points.tolist() == [[1, 2, 0]]
    assert found.metadata["not_read"] == (f"1 {name}", "1 MultiLineString")
    said = f"a.gpkg: row 1 is a {name}, and curves are not read: make chords of them, as ogr2ogr"
    with pytest.raises(FormatError, match=said):
        shapes_in(path)


def test_a_system_that_nobody_knows_is_named(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.shp", [SQUARE])
    path.with_suffix(".prj").write_text("+init=" + str(tmp_path / "file") + ":1")
    with pytest.warns(DataWarning, match="coordinate system is not known"):
        assert read_features(path, "polygons")["crs"] is None


@pytest.mark.parametrize(
    ("suffix", "change", "said"),
    [
        (".shp", lambda data: data[:-9], "and says 236"),
        (".shp", lambda data: data[:104] + b"\0\0\0\0" + data[108:], "the record at byte 100"),
        (".shp", lambda data: data[:108] + b"\3" + data[109:], "has the type 3"),
        (".shp", lambda data: data[:144] + b"\xff\xff\xff\xff" + data[148:], "damaged"),
        (".dbf", lambda data: data[:4] + b"\2" + data[5:], "has 2 rows for 1 shapes"),
        (".dbf", lambda data: data[:48] + b"\0" + data[49:], "wider than its rows"),
        (".dbf", lambda data: data[:-9], "truncated"),
        (".cpg", lambda _: b"../x", "the .cpg file says '../x'"),
    ],
)
def test_a_damaged_shapefile_is_named(tmp_path: Path, suffix: str, change: Any, said: str) -> None:
    path = saved(tmp_path / "a.shp", [SQUARE], id=[1])
    part = path.with_suffix(suffix)
    part.write_bytes(change(part.read_bytes()))
    with pytest.raises(FormatError, match=said):
        read_features(path, "polygons")


def test_deleted_rows_and_code_pages(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.shp", map(shapely.Point, range(3), range(3)), name=["a", "é", "c"])
    table = path.with_suffix(".dbf")
    data = bytearray(table.read_bytes())
    begin, size = struct.unpack_from("<2H", data, 8)
    data[begin] = ord("*")
    data[begin + size + 1 : begin + size + 3] = "é ".encode("cp1252")
    table.write_bytes(data)
    for said in ("1252", "ANSI 1252", "ISO-8859-1", None):
        path.with_suffix(".cpg").unlink(missing_ok=True)
        if said is not None:
            path.with_suffix(".cpg").write_text(said)
        rows = read_features(path, "points")["features"]
        assert [each["properties"]["name"] for each in rows] == ["é", "c"]


def test_rings_that_lie_in_each_other_end_in_an_error(tmp_path: Path) -> None:
    """Thousands of rings around thousands of holes are millions of pairs."""
    size = np.linspace(1, 2, 4000)
    outer = shapely.box(-size, -size, size, size, ccw=False)
    holes = shapely.box(-size / 3, -size / 3, size / 3, size / 3)
    rings = shapely.get_coordinates([*outer, *holes]).reshape(-1, 5, 2)
    assert not shapely.is_ccw(outer[0].exterior)
    content = struct.pack("<i4d2I", 5, *[0] * 4, len(rings), 5 * len(rings))
    content += np.arange(0, 5 * len(rings), 5, "<u4").tobytes() + rings.astype("<f8").tobytes()
    words = (108 + len(content)) // 2
    head = struct.pack(">i20xi", 9994, words) + struct.pack("<2i64x", 1000, 5)
    (tmp_path / "a.shp").write_bytes(head + struct.pack(">2i", 1, len(content) // 2) + content)
    with pytest.raises(FormatError, match="too many to sort"):
        read_features(tmp_path / "a.shp", "polygons")


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([".gpkg", ".shp", ".dbf", ".prj"]), st.data())
def test_changed_bytes_are_shapes_or_one_error(tmp_path_factory, suffix: str, data) -> None:
    folder = tmp_path_factory.mktemp("damaged")
    path = saved(folder / ("a.gpkg" if suffix == ".gpkg" else "a.shp"), ALL[3:5], name=["a", "b"])
    part = path.with_suffix(suffix)
    held = bytearray(part.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        place = data.draw(st.integers(0, len(held) - 1))
        held[place] = data.draw(st.sampled_from([0, 1, 5, 13, 127, 128, 255]))
    part.write_bytes(held[: data.draw(st.integers(len(held) // 2, len(held)))])
    with suppress(FormatError), catch_warnings():
        simplefilter("ignore", DataWarning)
        assert isinstance(read_features(path, "shapes"), dict)
