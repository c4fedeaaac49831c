"""Lines draped over a surface: profiles of several lines as one, and their files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.cloud import Cloud
from liftmesh.errors import InputError
from liftmesh.io.atomic import replacing
from liftmesh.vector import geojson, geopackage

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


@dataclass(frozen=True, slots=True, eq=False)
class Draped:
    """Lines over a surface, in parts where they leave its faces."""

    points: Floats
    distances: Floats
    starts: Array
    lines: Array
    crs: str | None

    @property
    def lengths(self) -> Floats:
        """The length of each part in the plane."""
        lengths: Floats = self.distances[self.starts[1:] - 1] - self.distances[self.starts[:-1]]
        return lengths

    def as_cloud(self) -> Cloud:
        """Return the points with their distance, line and part."""
        counts = np.diff(self.starts)
        values = {
            "distance": self.distances,
            "line": np.repeat(self.lines, counts),
            "part": np.repeat(np.arange(len(counts)), counts),
        }
        return Cloud(self.points, attributes=values, crs=self.crs)

    def save(self, path: Path) -> Path:
        """Write the parts as lines in space, with their line, its stretch and their length."""
        columns = {
            "line": self.lines,
            "start": self.distances[self.starts[:-1]],
            "length": self.lengths,
        }
        with replacing(path) as stream:
            if path.suffix.lower() == ".gpkg":
                geopackage.write(stream, self.points, self.starts, columns, self.crs, "profiles")
            else:
                rows = zip(*(values.tolist() for values in columns.values()), strict=True)
                told = (dict(zip(columns, row, strict=True)) for row in rows)
                parts = np.split(self.points, self.starts[1:-1])
                geojson.write(stream, zip(told, parts, strict=True), self.crs)
        return path


def drape(surface: Surface, lines: Sequence[Floats]) -> Draped:
    """Drape lines over the faces of a surface."""
    found = [surface.profile(line) for line in lines]
    counts = [len(each.starts) - 1 for each in found]
    if not any(counts):
        if not any(np.ptp(np.asarray(line, float), axis=0).any() for line in lines):
            raise InputError("all corners of a line are at one position: it has no length")
        raise InputError("no part of a line is over faces: are both in the same system?")
    sizes = np.concatenate([np.diff(each.starts) for each in found])
    return Draped(
        np.concatenate([each.points for each in found]),
        np.concatenate([each.distances for each in found]),
        np.concatenate([[0], np.cumsum(sizes)]),
        np.repeat(np.arange(len(found)), counts),
        system_of_plane(surface),
    )


def system_of_plane(surface: Surface) -> str | None:
    """Return the coordinate system of lines over a surface: none over a plane that is turned."""
    return surface.crs if surface.frame.name == "xy" else None
