"""Lines draped over a surface: profiles of several lines as one, and their files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.cloud import Cloud
from liftmesh.errors import InputError
from liftmesh.io import geojson_writer, geopackage_writer
from liftmesh.io.atomic import replacing

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


@dataclass(frozen=True, slots=True, eq=False)
class Draped:
    """Lines over a surface, in parts where they leave its faces.

    Attributes
    ----------
    points : (n, 3) ndarray of float64
        As in `Profile`, of one part after the other.
    distances : (n,) ndarray of float64
        How far along their line they are.
    starts : (k + 1,) ndarray of int64
        Where each part begins, and where the last ends.
    lines : (k,) ndarray of int64
        The line that each part is of, from 0.
    crs : str, optional
        The coordinate system of the surface, if its plane is that of x and y.
    """

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
        """Return the points with their distance, line and part.

        Returns
        -------
        Cloud
            Parts are numbered from 0, over all lines.
        """
        counts = np.diff(self.starts)
        values = {
            "distance": self.distances,
            "line": np.repeat(self.lines, counts),
            "part": np.repeat(np.arange(len(counts)), counts),
        }
        return Cloud(self.points, attributes=values, crs=self.crs)

    def save(self, path: Path) -> Path:
        """Write the parts as lines in space, with their line, its stretch and their length.

        Parameters
        ----------
        path : Path
            Where to write, as GeoJSON or GeoPackage; written whole or not at all.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            The coordinate system is unknown to GeoPackage.
        MissingDependencyError
            GeoPackage needs geopandas.
        OSError
            The file cannot be written.
        """
        columns = {
            "line": self.lines,
            "start": self.distances[self.starts[:-1]],
            "length": self.lengths,
        }
        with replacing(path) as stream:
            if path.suffix.lower() == ".gpkg":
                geopackage_writer.write(
                    stream, self.points, self.starts, columns, self.crs, "profiles"
                )
            else:
                rows = zip(*(values.tolist() for values in columns.values()), strict=True)
                told = (dict(zip(columns, row, strict=True)) for row in rows)
                parts = np.split(self.points, self.starts[1:-1])
                geojson_writer.write(stream, zip(told, parts, strict=True), self.crs)
        return path


def drape(surface: Surface, lines: Sequence[Floats]) -> Draped:
    """Drape lines over the faces of a surface.

    Parameters
    ----------
    surface : Surface
        The surface.
    lines : sequence of (k, 2) array_like
        The corners of each line in the plane.

    Returns
    -------
    Draped
        The parts of all lines.

    Raises
    ------
    InputError
        A line has fewer than two corners, or one is not finite; or no line meets a face.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
    >>> drape(slope, [[[0, 1], [2, 1]], [[0, 0], [4, 0]]]).lengths
    array([2., 4.])
    """
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
    """Return the coordinate system of lines over a surface: none over a plane that is turned.

    Parameters
    ----------
    surface : Surface
        The surface.

    Returns
    -------
    str or None
        WKT or ``EPSG:n``.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 0], [1, 0, 1], [0, 1, 2], [1, 2, 0]]
    >>> system_of_plane(liftmesh.triangulate(points, plane="xz", crs="EPSG:25832")) is None
    True
    """
    return surface.crs if surface.frame.name == "xy" else None
