"""Points of files of shapes: GeoJSON, GeoPackage and shapefiles.

They are places in the plane: heights, which GeoJSON allows, are left out. Properties are named
values of a point, as the columns of a table are, if all of them are numbers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Integral, Real
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_reals
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted, shown
from liftmesh.errors import FormatError
from liftmesh.io.metadata import Unread, noted
from liftmesh.vector.files import read_shapes, stated_system
from liftmesh.vector.geojson import geometries

_EXPANSION, _VALUES_MORE = 20, 1 << 21  # values for each that is stated, and in all
_COORDINATES = {"x", "y", "z"}


def points_of(path: Path, crs: str | None) -> Cloud:
    """Read the points of a file, which has to be in the system of a surface, at height 0."""
    shapes = read_shapes(path, "points", crs)
    points = _Points()
    try:
        points.take(shapes)
    except (TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: no GeoJSON: a point has type and coordinates") from error
    if not points.places:
        raise FormatError(f"{path}: there is no Point or MultiPoint in it")
    points.check_size(path)
    planar = _planar(points.places)
    if planar is None:
        number = next(k for k, place in enumerate(points.places) if _planar([place]) is None)
        wrong = shown(points.places[number])
        raise FormatError(f"{path}: point {number} is {wrong}: give two finite numbers, or three")
    columns = points.columns()
    unread = (f"property {name}" for name in points.names() if name not in columns)
    skipped = (*unread, *(counted(count, kind) for kind, count in points.others.items()))
    return Cloud(
        np.column_stack([planar, np.zeros(len(planar))]),
        attributes=columns,
        metadata=noted({}, not_read=Unread(skipped)),
        crs=stated_system(shapes),
    )


@dataclass(slots=True)
class _Points:
    """The points of a tree of GeoJSON, properties and how many points have them, and the rest."""

    places: list[Any] = field(default_factory=list)
    properties: list[Mapping[str, Any]] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    def take(self, tree: object) -> None:
        """Collect the points of a tree."""
        for kind, coordinates, properties in geometries(tree):
            if kind not in {"Point", "MultiPoint"}:
                self.others[kind] += 1
                continue
            is_one = kind == "Point" and coordinates
            parts = [coordinates] if is_one else coordinates
            if len(parts):
                self.places += parts
                self.properties.append(properties)
                self.counts.append(len(parts))

    def check_size(self, path: Path) -> None:
        """Raise if a value for every point and property is far more than the file states."""
        stated = len(self.places) + sum(map(len, self.properties))
        names = len(self.names())
        if names * len(self.places) > _EXPANSION * stated + _VALUES_MORE:
            raise FormatError(
                f"{path}: {len(self.places):,} points with {names:,} properties are far more "
                "values than the file states: save only the properties you need"
            )

    def names(self) -> list[str]:
        """Return the names of the properties, in the order of the file."""
        return [*dict.fromkeys(name for each in self.properties for name in each)]

    def columns(self) -> dict[str, Array]:
        """Return the values of the properties that are numbers."""
        names = (name for name in self.names() if name.lower() not in _COORDINATES)
        columns = {name: _column([each.get(name) for each in self.properties]) for name in names}
        return {
            name: np.repeat(values, self.counts)
            for name, values in columns.items()
            if values is not None
        }


def _column(values: list[Any]) -> Array | None:
    """Return numbers as an array, NaN where there is none; None if they are no numbers."""
    present = [each for each in values if each is not None]
    if not present or not all(isinstance(each, Real) for each in present):
        return None
    if len(present) == len(values) and all(isinstance(each, Integral) for each in present):
        whole = np.asarray(values)
        if whole.dtype.kind in "iu":
            return whole
    try:
        return as_reals([np.nan if each is None else each for each in values])
    except OverflowError:
        return None


def _planar(places: list[Any]) -> Floats | None:
    """Return x and y of points; None if one has none."""
    try:
        planar = as_reals([place[:2] for place in places])
    except (TypeError, ValueError, OverflowError, KeyError):
        return None
    return planar if planar.shape == (len(places), 2) and np.isfinite(planar).all() else None
