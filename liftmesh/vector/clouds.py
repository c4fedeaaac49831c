"""Clouds from vector files: points with their values, and surfaces of triangles.

Points and MultiPoints are rows, and the values of their features columns, understood as those of a
table are (`io.objects.tables`): without heights in space, a column may have them. Patches of
surfaces (TIN, PolyhedralSurface, Triangle) are faces; equal corners are one row, behind those of
points, and values of features are left out, since rows may belong to several. Other shapes are
counted.

Features are taken one by one, so that memory holds numbers and no tree of objects: of GeoJSON each
object is taken as soon as it is parsed.

A file is in the system that it names; GeoJSON without one is in degrees if it may be
(`files.own_system`). What is laid over a surface is in that of the surface, unless it names another
(`points_of`).
"""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.options import counted, refused, shown
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.columns import POSITION, Ragged, triangulated
from liftmesh.io.formats.stl import weld
from liftmesh.io.markup import bytes_of_text, bytes_of_tree, parsed
from liftmesh.io.objects import tables
from liftmesh.io.options import (
    ColumnChoice,
    Missing,
    TableOptions,
    check_columns,
    check_expanded,
    limit_of,
    validate_table_options,
)
from liftmesh.io.text_tables import is_number
from liftmesh.vector import files, geopackage, shapefile
from liftmesh.vector.geojson import geometries

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_SURFACES = {"TIN", "PolyhedralSurface"}
_POINTS = {"Point", "MultiPoint"}
_EXPANSION, _VALUES_MORE = 20, 1 << 18  # values for each that is stated, and in all
_GROWTH, _SMALL = 20, 1 << 24  # of JSON, and what it may take in any case
_TEXTS = 2  # that are kept of a column of texts


@dataclass(frozen=True, slots=True)
class FeatureOptions:
    """Checked options: the layer, and how columns are understood."""

    layer: str | None = None
    table: TableOptions = field(default_factory=TableOptions)


def validate_feature_options(
    *,
    layer: str | None = None,
    columns: ColumnChoice = None,
    flat: bool | None = False,
    nodata: Missing = None,
) -> FeatureOptions:
    """Check the options of files of shapes."""
    if layer is not None and not isinstance(layer, str):
        raise refused("layer", layer, "give the name of a layer in the file")
    return FeatureOptions(layer, validate_table_options(columns=columns, flat=flat, nodata=nodata))


def read_geojson(
    stream: BinaryIO,
    name: str,
    *,
    options: FeatureOptions | None = None,
    max_bytes: int | None = None,
) -> Cloud:
    """Read the points of GeoJSON."""
    found = Features(name, max_bytes)
    return _alone(found, found.take_geojson(stream.read()), options)


def read_geopackage(stream: BinaryIO, name: str, *, options: FeatureOptions | None = None) -> Cloud:
    """Read the points and surfaces of a layer of a GeoPackage."""
    found = Features(name)
    layer = None if options is None else options.layer
    return _alone(found, found.take_geopackage(stream, layer), options)


def read_shapefile(stream: BinaryIO, name: str, *, options: FeatureOptions | None = None) -> Cloud:
    """Read the points and surfaces of a shapefile."""
    found = Features(name)
    return _alone(found, found.take_shapefile(stream.read()), options)


def _alone(found: Features, tree: Mapping[str, Any], options: FeatureOptions | None) -> Cloud:
    """Return the cloud of a file that stands by itself."""
    table = TableOptions() if options is None else options.table
    return found.cloud(table, files.own_system(tree, found.bounds()))


def points_of(path: Path, crs: str | None, layer: str | None = None, **options: Any) -> Cloud:
    """Read the points of a file, which has to be in the system of a surface.

    Without a layer of a GeoPackage, the first one is read.
    """
    table, found = validate_table_options(**options), Features(str(path))
    with path.open("rb") as stream:
        kind = files.kind_of(path, stream, "points")
        if kind == "geopackage":
            tree = found.take_geopackage(stream, layer, is_first=layer is None)
        elif layer is not None:
            raise InputError(
                f"{Option('layer', layer)} is of GeoPackages, and {path} is none: leave it out"
            )
        elif kind == "shapefile":
            tree = found.take_shapefile(stream.read())
        else:
            tree = found.take_geojson(stream.read())
    files.check_system(crs, tree, str(path))
    return found.cloud(table, files.stated_system(tree))


@dataclass(slots=True)
class Features:
    """What the features of a file so far hold: points and values, surfaces, and the rest."""

    name: str
    max_bytes: int | None = None
    points: array[float] = field(default_factory=lambda: array("d"))
    counts: array[int] = field(default_factory=lambda: array("q"))  # points of each feature
    values: dict[str, _Column] = field(default_factory=dict)
    corners: array[float] = field(default_factory=lambda: array("d"))
    sizes: array[int] = field(default_factory=lambda: array("q"))  # corners of each patch
    others: Counter[str] = field(default_factory=Counter)
    has_heights: bool = False
    stated: int = 0  # values
    held: int = 0  # with those that are missing

    def take_geojson(self, data: bytes) -> Mapping[str, Any]:
        """Take GeoJSON; return what else it says."""
        text = data.removeprefix(files.MARK)
        limit = limit_of(self.max_bytes, _GROWTH * len(text) - bytes_of_text(text), _SMALL)
        needed = bytes_of_tree(text, limit)
        check_expanded(needed, limit, self.name, f"its JSON of {len(text):,} bytes")
        try:
            tree = parsed(text.decode(), self._take_complete)
            if not isinstance(tree, dict):
                return {}
            self._take_tree(tree)
        except (TypeError, AttributeError) as error:
            raise FormatError(
                f"{self.name}: no GeoJSON: a point has type and coordinates"
            ) from error
        except (ValueError, RecursionError) as error:
            if isinstance(error, FormatError):
                raise
            raise FormatError(f"{self.name}: not GeoJSON: {error}") from error
        if "crs" not in tree:
            return {}
        return files.with_system({}, files.stated_system(tree), self.name)

    def _take_complete(self, tree: dict[str, Any]) -> dict[str, Any] | None:
        """Take an object of JSON if it is a feature; else it is a part of one."""
        if tree.get("type") != "Feature" or "geometry" not in tree:
            return tree
        self._take_tree(tree)
        return None

    def _take_tree(self, tree: object) -> None:
        for kind, coordinates, values in geometries(tree):
            self._take(kind, coordinates, values)

    def take_geopackage(
        self, stream: BinaryIO, layer: str | None, *, is_first: bool = False
    ) -> Mapping[str, Any]:
        """Take a layer of a GeoPackage; return its system."""
        with geopackage.opened(self.name, stream) as package:
            rows, crs = package.features(layer, is_first=is_first)
            self._take_rows(rows)
        return files.with_system({}, crs, self.name)

    def take_shapefile(self, data: bytes) -> Mapping[str, Any]:
        """Take a shapefile; return its system."""
        with shapefile.about(self.name):
            self._take_rows(shapefile.features_of(self.name, data))
        return files.with_system({}, shapefile.system_of(self.name), self.name)

    def _take_rows(self, rows: Iterable[tuple[dict[str, Any] | None, dict[str, Any]]]) -> None:
        for shape, values in rows:
            for kind, coordinates, _ in geometries(shape or {}):
                self._take(kind, coordinates, values)

    def _take(self, kind: str, coordinates: Any, values: Mapping[str, Any]) -> None:
        if kind in _SURFACES:
            for rings in coordinates:
                self._add_patch(rings)
            for name in values:
                self.values.setdefault(name, _Column())
        elif kind not in _POINTS:
            self.others[kind] += 1
        elif coordinates:
            places = [coordinates] if kind == "Point" else coordinates
            for place in places:
                self._add_point(place)
            self._add_values(values)
            self.counts.append(len(places))

    def _add_point(self, place: Any) -> None:
        try:
            x, y, *more = place
            self.points.extend((x, y, more[0] if more else nan))
        except (TypeError, ValueError, OverflowError) as error:
            raise self._wrong(len(self.points) // 3, place) from error
        self.has_heights = self.has_heights or bool(more)

    def _wrong(self, number: int, place: Any) -> FormatError:
        return FormatError(
            f"{self.name}: point {number} is {shown(place)}: give two finite numbers, or three"
        )

    def _add_values(self, values: Mapping[str, Any]) -> None:
        row = len(self.counts)
        for name, value in values.items():
            if value is not None:
                column = self.values.setdefault(name, _Column())
                self.held += column.add(row, value)
                self.stated += 1
        check_columns(len(self.values), self.max_bytes, self.name, "what it has of properties")
        if self.held > _EXPANSION * (self.stated + row) + _VALUES_MORE:
            raise self._too_many()

    def _too_many(self) -> FormatError:
        return FormatError(
            f"{self.name}: {len(self.points) // 3:,} points or more with {len(self.values):,} "
            "properties are far more values than the file states: save only those you need"
        )

    def _add_patch(self, rings: Sequence[Sequence[Sequence[float]]]) -> None:
        """Take a polygon of a surface, which ends at its first corner."""
        if len(rings) != 1:
            self.others["holed polygon" if rings else "empty polygon"] += 1
            return
        (ring,) = rings
        corners = ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring
        if len(corners) < 3:
            raise FormatError(f"{self.name}: patch {len(self.sizes)} has {len(corners)} corners")
        for x, y, *more in corners:
            self.corners.extend((x, y, more[0] if more else nan))
        self.has_heights = self.has_heights or len(corners[0]) > 2
        self.sizes.append(len(corners))

    def bounds(self) -> tuple[float, float, float, float]:
        """Return the least and greatest x and y; infinity if there are none."""
        rows = np.concatenate([_rows(self.points), _rows(self.corners)])[:, :2]
        low, high = rows.min(axis=0, initial=np.inf), rows.max(axis=0, initial=-np.inf)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def cloud(self, options: TableOptions, crs: str | None) -> Cloud:
        """Return points, then the corners of surfaces."""
        points, corners = _rows(self.points), _rows(self.corners)
        if not len(points) and not len(corners):
            raise FormatError(f"{self.name}: there is no Point or MultiPoint in it")
        kept, place = weld(corners)
        rows = np.concatenate([points, corners[kept]])
        if len(wrong := np.flatnonzero(~np.isfinite(rows[:, :2]).all(axis=1))):
            raise self._wrong(int(wrong[0]), rows[wrong[0], : 2 + self.has_heights].tolist())
        columns: list[tuple[str, Any]] = [*zip(POSITION, rows.T, strict=True)]
        columns = columns if self.has_heights else columns[:2]
        named, unread = ([], [*self.values]) if len(corners) else self._columns()
        said = [f"column {name}" for name in unread]
        said += [counted(count, kind) for kind, count in self.others.items()]
        try:
            found = tables.of_columns(columns + named, options, {"crs": crs, "unread": said})
        except (FormatError, InputError) as error:
            cause = error.message.marked.removeprefix(f"{tables.WHERE}: ")
            raise FormatError(cause).within(self.name) from error
        if not len(corners):
            return found
        row = (place + len(points)).astype(np.int32)
        patches = Ragged(np.frombuffer(self.sizes, np.int64), row)
        return replace(found, faces=triangulated(patches, len(rows), self.name))

    def _columns(self) -> tuple[list[tuple[str, Any]], list[str]]:
        """Return the values of all points by name, and the names that are those of coordinates."""
        rows = len(self.points) // 3
        if len(self.values) * rows > _EXPANSION * (self.stated + rows) + _VALUES_MORE:
            raise self._too_many()
        counts = np.frombuffer(self.counts, np.int64)
        taken = [name for name in self.values if name.lower() in POSITION]
        named = {name: each for name, each in self.values.items() if name not in taken}
        found = [(name, each.array(len(counts)).repeat(counts)) for name, each in named.items()]
        return found, taken


@dataclass(slots=True)
class _Column:
    """The values of features by their row, None where there is none."""

    values: list[Any] = field(default_factory=list)
    texts: int = 0
    is_text_of_number: bool = False

    def add(self, row: int, value: Any) -> int:
        """Add a value; return by how many the column has grown."""
        if not isinstance(value, int | float) and not self._is_kept(value):
            return 0
        missing = row - len(self.values)
        self.values += [None] * missing
        self.values.append(value)
        return missing + 1

    def _is_kept(self, value: Any) -> bool:
        """Whether a text has to be kept, of those that say that a column is no numbers."""
        is_new = isinstance(value, str) and not self.is_text_of_number and bool(is_number(value))
        self.is_text_of_number = self.is_text_of_number or is_new
        self.texts += 1
        return is_new or self.texts <= _TEXTS

    def array(self, rows: int) -> Array:
        """Return the values of so many rows, as numbers if they are some."""
        values = self.values + [None] * (rows - len(self.values))
        numbers = files.column_of(values)
        if numbers is not None:
            return numbers
        found = np.empty(rows, dtype=object)
        found[:] = values
        return found


def _rows(numbers: array[float]) -> Floats:
    return np.frombuffer(numbers, np.float64).reshape(-1, 3)
