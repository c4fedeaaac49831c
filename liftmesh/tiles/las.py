"""Points of LAS files by ranges; those of LAZ and COPC are decoded once, as other files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.formats.las.header import read_header
from liftmesh.io.surface_rows import for_chunks

if TYPE_CHECKING:
    from liftmesh.tiles.clouds import Reading
    from liftmesh.tiles.sources import Origin


@dataclass(frozen=True)
class LasPart:
    """Points of a LAS file."""

    origin: Origin
    place: str
    begin: int
    point_size: int
    scales: tuple[float, ...]
    offsets: tuple[float, ...]
    rows: int

    def read(self) -> Array:
        """Read x and y, with the arithmetic of `liftmesh.read`."""
        kind = np.dtype(
            {"names": ["x", "y"], "formats": ["<i4", "<i4"], "offsets": [0, 4],
             "itemsize": self.point_size}
        )  # fmt: skip
        found = np.fromfile(self.place, kind, self.rows, offset=self.begin)
        if len(found) < self.rows:
            raise FormatError(
                f"{self.place}: points from {self.origin.row:,} on are missing: the file is "
                "truncated"
            )
        points = np.empty((self.rows, 2))
        for k, name in enumerate(("x", "y")):
            np.multiply(found[name], self.scales[k], out=points[:, k])
            points[:, k] += self.offsets[k]
        return points


def las_parts(origin: Origin, name: str, rows: int) -> list[LasPart] | None:
    """Cut a LAS file into parts."""
    if not Path(name).is_file():
        return None
    with Path(name).open("rb") as stream:
        found = read_header(stream, name)
    if found.compressed:
        return None
    place = os.path.abspath(name)  # noqa: PTH100 - links stay as they are
    return [
        LasPart(
            replace(origin, row=first),
            place,
            found.start + first * found.point_size,
            found.point_size,
            found.scales,
            found.offsets,
            min(rows, found.points - first),
        )
        for first in range(0, found.points, rows)
    ]


def readings(names: Sequence[str], reading: Reading) -> list[Reading]:
    """Say how each file of a surface is read: of lidar its ground, unless the caller says more."""
    found = [reading] * len(names)
    lidar = [k for k, name in enumerate(names) if name.lower().endswith((".las", ".laz"))]
    chosen = for_chunks([names[k] for k in lidar], reading.options)
    for k, options in zip(lidar, chosen, strict=True):
        found[k] = replace(reading, options=options)
    return found
