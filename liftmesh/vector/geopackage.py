"""GeoPackage: geometries and values, which the SQLite of the standard library reads.

A file of SQLite holds statements as well as rows. So it is opened for reading alone, without any
file beside it, and nothing but rows of ordinary tables is read: views, virtual tables and computed
columns are refused, functions denied. What is read is counted, and the steps that SQLite takes for
it: pages that are used many times, as only damaged files have them, end in an error.

Geometries are well-known binary (WKB), read as objects of GeoJSON; those of surfaces, TIN and
PolyhedralSurface, have a list of polygons as coordinates, as a MultiPolygon has; curves are only
named. Counts are compared with the bytes that are there, and collections may be nested only so
deep.

Lines and other shapes are written by geopandas: in memory, since the database behind it cannot be
written to a stream.
"""

from __future__ import annotations

import io
import os
import struct
import warnings
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias
from warnings import warn

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.options import shown
from liftmesh.crs.description import look_up
from liftmesh.errors import DataWarning, FormatError, LiftmeshError, Option
from liftmesh.io.streams import is_file, remaining
from liftmesh.optional import load

if TYPE_CHECKING:
    import sqlite3

MAGIC = b"SQLite format 3\0"

_SCHEMA, _COLUMNS = "sqlite_master", "table_xinfo"
_STEPS = 10_000  # of SQLite between two counts
_STEPS_OF_A_BYTE, _STEPS_MORE = 10, 1_000_000
_EXPANSION, _BYTES_MORE = 20, 1 << 22  # of what is read, for each byte of the file, and in all
_ENVELOPES = (0, 32, 48, 48, 64)  # bytes before the geometry, by a number in its flags
_WAITING = ("-wal", "-journal")
_JOURNAL = slice(18, 20)  # the bytes that say whether there may be a journal beside the file
_LISTED = 9
_UNDEFINED = 'LOCAL_CS["Undefined SRS"'  # of GDAL

Feature: TypeAlias = tuple[dict[str, Any] | None, dict[str, Any]]


def read_geopackage(path: Path) -> tuple[dict[str, Any], str | None]:
    """Read the features of the first layer as a collection, and its system."""
    with opened(str(path)) as package:
        rows, crs = package.features(is_first=True)
        features = [
            {"type": "Feature", "properties": own, "geometry": _straight(each, row, str(path))}
            for row, (each, own) in enumerate(rows)
        ]
    return {"type": "FeatureCollection", "features": features}, crs


def _straight(shape: Geometry | None, row: int, name: str) -> Geometry | None:
    """Raise for a curve: lines and areas would be others without it."""
    if shape is not None and shape["type"] in _CURVES.values():
        raise FormatError(
            f"{name}: row {row} is a {shape['type']}, and curves are not read: make chords of "
            "them, as ogr2ogr -nlt CONVERT_TO_LINEAR does"
        )
    return shape


@contextmanager
def opened(name: str, stream: BinaryIO | None = None) -> Iterator[_Package]:
    """Open a file by its name, or a stream that is in memory, and read it amid the block."""
    held = None if stream is None or is_file(stream, name) else stream
    if held is None:
        _check_complete(Path(name))
    try:
        size = os.stat(name).st_size if held is None else remaining(held)  # noqa: PTH116
        with ExitStack() as stack:
            connection = _connected(name) if held is None else _in_memory(held, stack)
            stack.enter_context(closing(connection))
            _configure(connection, size)
            yield _Package(connection, name, size)
    except (load("sqlite3").Error, ValueError, struct.error, IndexError) as error:
        if isinstance(error, LiftmeshError):
            raise
        raise FormatError(f"{name}: damaged, or no GeoPackage: {error}") from error


def _check_complete(path: Path) -> None:
    for each in map(path.with_name, (path.name + suffix for suffix in _WAITING)):
        if each.is_file() and each.stat().st_size:
            raise FormatError(f"{path}: changes wait in {each.name}: close what has the file open")


def _connected(name: str) -> sqlite3.Connection:
    """Open a file as it is: neither changed nor locked, and without a journal."""
    uri = f"{Path(name).absolute().as_uri()}?mode=ro&immutable=1"
    connection: sqlite3.Connection = load("sqlite3").connect(uri, uri=True, isolation_level=None)
    return connection


def _in_memory(stream: BinaryIO, stack: ExitStack) -> sqlite3.Connection:
    """Open the content of a stream, as if it had never had a journal."""
    data = bytearray(stream.read())
    data[_JOURNAL] = b"\1\1"
    connection: sqlite3.Connection = load("sqlite3").connect(":memory:", isolation_level=None)
    if not hasattr(connection, "deserialize"):  # pragma: no cover - Python 3.10
        connection.close()
        file = Path(stack.enter_context(load("tempfile").TemporaryDirectory()), "content")
        file.write_bytes(data)
        return _connected(str(file))
    connection.deserialize(data)
    return connection


def _configure(connection: sqlite3.Connection, size: int) -> None:
    for each in ("trusted_schema = OFF", "cell_size_check = ON", "mmap_size = 0"):
        connection.execute(f"PRAGMA {each}")
    left = _STEPS_MORE + _STEPS_OF_A_BYTE * size

    def count() -> bool:
        nonlocal left
        left -= _STEPS
        return left < 0

    connection.set_progress_handler(count, _STEPS)


class _Package:
    """An open file, whose tables are read one by one."""

    def __init__(self, connection: sqlite3.Connection, name: str, size: int) -> None:
        self._connection, self._path = connection, name
        self._left = _BYTES_MORE + _EXPANSION * size
        self._allowed = {_SCHEMA}
        connection.set_authorizer(self._authorize)
        rows = self._rows(_SCHEMA, "name", "type", "sql")
        self._tables = {name.lower(): (kind, sql or "") for name, kind, sql in rows}

    def features(
        self, layer: str | None = None, *, is_first: bool = False
    ) -> tuple[Iterator[Feature], str | None]:
        """Return the geometry and the values of each row of a layer, and its system.

        Of several layers one has to be chosen, or the first is read, with a warning.
        """
        name, key, system = self._layer(layer, is_first)
        columns = self._columns(name)
        if key not in columns:
            raise FormatError(f"{self._path}: layer {shown(name)} has no column {shown(key)}")
        return self._features(name, key, columns), self._system(system)

    def _features(self, name: str, key: str, columns: list[str]) -> Iterator[Feature]:
        for row in self._rows(name, *columns):
            values = dict(zip(columns, row, strict=True))
            yield _geometry(values.pop(key)), values

    def _layer(self, wanted: str | None, is_first: bool) -> tuple[str, str, int]:
        """Return the table of a layer, its column of geometries, and its system."""
        if "gpkg_contents" not in self._tables:
            raise FormatError(f"{self._path}: a file of SQLite, but no GeoPackage")
        kinds = self._rows("gpkg_contents", "table_name", "data_type")
        names = [name for name, kind in kinds if kind == "features"]
        keys = {
            name: (column, system)
            for name, column, system in self._rows(
                "gpkg_geometry_columns", "table_name", "column_name", "srs_id"
            )
        }
        name = self._chosen(names, wanted, is_first) if names else ""
        if name not in keys:
            raise FormatError(f"{self._path}: there is no layer of features in the GeoPackage")
        return name, *keys[name]

    def _chosen(self, names: list[str], wanted: str | None, is_first: bool) -> str:
        """Return the name of a layer; of several it has to be clear which."""
        if wanted in names or (wanted is None and len(names) == 1):
            return wanted or names[0]
        if not is_first:
            listed = ", ".join(map(shown, names[:_LISTED])) + ", ..." * (len(names) > _LISTED)
            given = "" if wanted is None else f", but not {shown(wanted)}"
            raise FormatError(
                f"{self._path}: it has the layers {listed}{given}: choose one with "
                f"{Option('layer', ...)}"
            )
        others = ", ".join(map(shown, names[1:_LISTED]))
        warn(
            f"{self._path}: layer {shown(names[0])} is read, and {others} not: save the layer "
            "you need to a file of its own",
            DataWarning,
            stacklevel=2,
        )
        return names[0]

    def _system(self, number: int) -> str | None:
        """Return the system of a number that the file gives it."""
        columns = ("srs_id", "organization", "organization_coordsys_id", "definition")
        for own, author, code, text in self._rows("gpkg_spatial_ref_sys", *columns):
            if own == number:
                if str(author).upper() == "EPSG" and isinstance(code, int) and code > 0:
                    return f"EPSG:{code}"
                is_known = isinstance(text, str) and text != "undefined"
                return text if is_known and not text.startswith(_UNDEFINED) else None
        return None

    def _columns(self, table: str) -> list[str]:
        """Return the columns of values: without the number of the row."""
        return [each[1] for each in self._described(table) if not each[5]]

    def _rows(self, table: str, *columns: str) -> Iterator[tuple[Any, ...]]:
        """Read columns of an ordinary table; what is read may not take more than files can hold."""
        if table != _SCHEMA:
            self._described(table)
        own = _quoted(table)
        names = ", ".join(f"{own}.{_quoted(each)}" for each in columns)
        command = f"SELECT {names} FROM main.{own} NOT INDEXED"  # noqa: S608 - names are quoted
        for row in self._connection.execute(command):
            held = sum(len(each) for each in row if isinstance(each, (str, bytes)))
            self._left -= held + 8 * len(row)
            if self._left < 0:
                raise FormatError(
                    f"{self._path}: table {shown(table)} holds more than the file: it is damaged"
                )
            yield row

    def _described(self, name: object) -> list[tuple[Any, ...]]:
        """Return what SQLite says of the columns of an ordinary table, none of them computed."""
        known = name.lower() if isinstance(name, str) else ""
        kind, text = self._tables.get(known, ("nothing", ""))
        if kind != "table" or not text.startswith("CREATE TABLE "):
            raise FormatError(
                f"{self._path}: {shown(name)} is no ordinary table but {kind} (views and virtual "
                "tables are refused): save the layer to a new file"
            )
        command = f"PRAGMA main.{_COLUMNS}({_quoted(str(name))})"
        found = self._connection.execute(command).fetchall()
        if any(each[6] for each in found):
            raise FormatError(f"{self._path}: table {shown(name)} has computed columns: refused")
        self._allowed.add(known)
        return found

    def _authorize(self, action: int, table: str | None, *rest: str | None) -> int:
        """Deny all but reading columns of tables that were looked at, and not through a view."""
        codes = load("sqlite3")
        is_known = {
            codes.SQLITE_SELECT: True,
            codes.SQLITE_PRAGMA: table == _COLUMNS,
            codes.SQLITE_READ: str(table).lower() in self._allowed,
        }.get(action, False)
        allowed: int = codes.SQLITE_OK if is_known and rest[-1] is None else codes.SQLITE_DENY
        return allowed


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'


def _geometry(value: object) -> dict[str, Any] | None:
    """Convert a geometry with the head that a GeoPackage puts before it."""
    if value is None:
        return None
    if not isinstance(value, bytes) or value[:2] != b"GP" or value[3] >> 1 & 7 >= len(_ENVELOPES):
        raise ValueError(f"no geometry of a GeoPackage: {shown(value)}")
    return geometry_of(value, 8 + _ENVELOPES[value[3] >> 1 & 7])


Geometry: TypeAlias = dict[str, Any]
_Size: TypeAlias = tuple[int, int]  # numbers of a corner, and how many of them are x, y and z

_POINT, _LINE, _POLYGON, _COLLECTION, _TRIANGLE = 1, 2, 3, 7, 17
_SURFACES = {15: ("PolyhedralSurface", _POLYGON), 16: ("TIN", _TRIANGLE)}
_KINDS = ("Point", "LineString", "Polygon", "MultiPoint", "MultiLineString", "MultiPolygon")
_CURVES = dict(enumerate(("CircularString", "CompoundCurve", "CurvePolygon"), 8))
_CURVES |= {11: "MultiCurve", 12: "MultiSurface"}
_DEEPEST = 32  # collections in collections
_Z, _M, _SRID = 0x80000000, 0x40000000, 0x20000000  # marks of another dialect (EWKB)


def geometry_of(data: bytes, begin: int = 0) -> Geometry:
    """Convert a geometry."""
    return _Reader(data, begin).geometry()


class _Reader:
    """A place in the bytes that moves as they are read."""

    def __init__(self, data: bytes, place: int) -> None:
        self._data, self._place = data, place

    def geometry(self, depth: int = 0) -> Geometry:
        """Read a geometry."""
        order, kind, size = self._head()
        if kind == _COLLECTION and depth < _DEEPEST:
            parts = [self.geometry(depth + 1) for _ in range(self._count(order))]
            return {"type": "GeometryCollection", "geometries": parts}
        if kind in _SURFACES:
            name, own = _SURFACES[kind]
            patches = [self._part(own, name) for _ in range(self._count(order))]
            return {"type": name, "coordinates": patches}
        if kind == _TRIANGLE:
            return {"type": "TIN", "coordinates": [self._simple(order, kind, size)]}
        if kind in _CURVES and not depth:
            return {"type": _CURVES[kind]}
        if not _POINT <= kind <= len(_KINDS):
            raise ValueError(f"type {shown(kind)} of geometries is a curve, a surface or unknown")
        if kind > _POLYGON:
            name, own = _KINDS[kind - 1], kind - _POLYGON
            several = [self._part(own, name) for _ in range(self._count(order))]
            return {"type": name, "coordinates": several}
        return {"type": _KINDS[kind - 1], "coordinates": self._simple(order, kind, size)}

    def _part(self, expected: int, whole: str) -> list[Any]:
        order, kind, size = self._head()
        if kind != expected:
            raise ValueError(f"a {whole} holds type {shown(kind)}")
        return self._simple(order, kind, size)

    def _simple(self, order: str, kind: int, size: _Size) -> list[Any]:
        if kind in (_POLYGON, _TRIANGLE):
            rings = range(self._count(order))
            return [self._corners(order, self._count(order), size) for _ in rings]
        if kind == _LINE:
            return self._corners(order, self._count(order), size)
        width, kept = size
        point = struct.unpack_from(f"{order}{width}d", self._data, self._place)[:kept]
        self._place += 8 * width
        return [] if all(map(isnan, point)) else list(point)

    def _head(self) -> tuple[str, int, _Size]:
        """Read order of bytes, type, and what a corner has."""
        order = "<" if self._data[self._place] else ">"
        self._place += 1
        code = self._count(order)
        self._place += 4 if code & _SRID else 0
        extra, kind = divmod(code & 0x0FFFFFFF, 1000)
        kept = 2 + (extra in (1, 3)) + bool(code & _Z)
        return order, kind, (kept + (extra in (2, 3)) + bool(code & _M), kept)

    def _count(self, order: str) -> int:
        (count,) = struct.unpack_from(order + "I", self._data, self._place)
        self._place += 4
        return int(count)

    def _corners(self, order: str, count: int, size: _Size) -> list[list[float]]:
        width, kept = size
        numbers = np.frombuffer(self._data, order + "f8", count * width, self._place)
        self._place += numbers.nbytes
        return numbers.reshape(-1, width)[:, :kept].tolist()  # type: ignore[no-any-return]


def write_shapes(
    stream: BinaryIO,
    shapes: Array,
    columns: Mapping[str, Array],
    crs: str | None,
    layer: str,
    **options: str,
) -> None:
    """Write a layer of geometries of any kind."""
    content = io.BytesIO()
    write_by_geopandas(content, shapes, columns, crs, driver="GPKG", layer=layer, **options)
    stream.write(content.getbuffer())


def write_by_geopandas(
    target: BinaryIO | Path,
    shapes: Array,
    columns: Mapping[str, Array],
    crs: str | None,
    **options: str,
) -> None:
    """Write geometries by the driver that the options name."""
    load("pyogrio", extra="shapes")  # geopandas imports it only when it writes
    frame = frame_of_shapes(shapes, columns, crs)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*'crs' was not provided", UserWarning)
        frame.to_file(target, engine="pyogrio", **options)


def frame_of_shapes(shapes: Array, columns: Mapping[str, Array], crs: str | None) -> Any:
    """Make a GeoDataFrame."""
    geopandas = load("geopandas", extra="shapes")
    system = None if crs is None else look_up(crs, extra="shapes")
    return geopandas.GeoDataFrame(dict(columns), geometry=shapes, crs=system)
