"""A cloud under construction, filled column by column.

Files name their columns: x, y, z, red, nx and so on. The sheet owns the arrays that the cloud will
own, and hands out each named column as a view of them, so that a reader fills the final arrays
directly, block by block.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from liftmesh._typing import Array, Rows
from liftmesh.cloud import Cloud

POSITION = ("x", "y", "z")
NORMAL = ("nx", "ny", "nz")
COLOR = ("red", "green", "blue")
ALPHA = "alpha"


class Sheet:
    """Arrays for ``rows`` points with the named columns.

    Parameters
    ----------
    types : mapping of str to dtype
        The columns in order. x and y must be among them; a missing z is 0. Red, green and blue
        (with alpha, if there) become colours, nx, ny and nz normals, every other column an
        attribute of that name and type.
    rows : int
        Number of points.
    """

    def __init__(self, types: Mapping[str, np.dtype], rows: int) -> None:
        self.columns: dict[str, Array] = {}
        self.points = np.empty((rows, 3))
        self._share(self.points, POSITION)
        if "z" not in types:
            self.columns.pop("z").fill(0.0)
        self.normals = self._grouped(types, NORMAL, rows)
        color = (*COLOR, ALPHA) if ALPHA in types else COLOR
        self.colors = self._grouped(types, color, rows)
        others = [each for each in types if each not in self.columns]
        self.attributes = {each: np.empty(rows, types[each].newbyteorder("=")) for each in others}
        self.columns |= self.attributes

    def cloud(self, faces: Rows | None, metadata: Mapping[str, Any]) -> Cloud:
        """Hand the filled arrays over."""
        return Cloud(
            self.points,
            colors=self.colors,
            normals=self.normals,
            attributes=self.attributes,
            faces=faces,
            metadata=metadata,
        )

    def _grouped(
        self, types: Mapping[str, np.dtype], names: tuple[str, ...], rows: int
    ) -> Array | None:
        if not all(each in types for each in names):
            return None
        common = np.result_type(*(types[each].newbyteorder("=") for each in names))
        array = np.empty((rows, len(names)), common)
        self._share(array, names)
        return array

    def _share(self, array: Array, names: tuple[str, ...]) -> None:
        self.columns |= {each: array[:, position] for position, each in enumerate(names)}
