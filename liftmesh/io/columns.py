"""A cloud under construction, filled column by column.

Files name their columns: x, y, z, red, nx and so on. A `CloudBuilder` owns the arrays of the future
cloud and provides each named column as a view of them, so that a reader fills the final arrays
directly, block by block.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import confirmed_depth

POSITION = ("x", "y", "z")
NORMAL = ("nx", "ny", "nz")
COLOR = ("red", "green", "blue")
ALPHA = "alpha"
PARTS = (*POSITION, *COLOR, ALPHA, *NORMAL)  # of a point


def type_in_text(name: str, dtype: np.dtype) -> np.dtype:
    """Return the type of a column of text; coordinates are doubles."""
    return np.dtype(np.float64) if name in POSITION and dtype.kind == "f" else dtype


def taken_together(columns: dict[str, Array], names: tuple[str, ...]) -> Array | None:
    """Remove and return columns that belong together, as one array; None if not all are there."""
    if not all(name in columns and columns[name].ndim == 1 for name in names):
        return None
    return np.stack([columns.pop(name) for name in names], axis=1)


def taken_points(columns: dict[str, Array], rows: int) -> Floats:
    """Remove and return the coordinates; those that are not there are 0."""
    points = np.zeros((rows, len(POSITION)))
    for position, name in enumerate(POSITION):
        if name in columns:
            points[:, position] = columns.pop(name)
    return points


class CloudBuilder:
    """Arrays for ``rows`` points with the named columns: x and y, and any others."""

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

    @property
    def rows(self) -> int:
        """Number of rows allocated."""
        return len(self.points)

    def fill(self, rows: slice, columns: Mapping[str, Array]) -> None:
        """Set some rows of the named columns."""
        with np.errstate(invalid="ignore"):  # NumPy warns of signalling NaNs in single precision
            for name, values in columns.items():
                self.columns[name][rows] = values

    def shorten(self, rows: int) -> None:
        """Give back the memory of all but the first rows; columns cannot be filled any more."""
        self.columns = {}  # views of the arrays, which may move
        arrays = (self.points, self.normals, self.colors, *self.attributes.values())
        for array in arrays:
            if array is not None and rows < len(array):
                array.resize((rows, *array.shape[1:]), refcheck=False)

    def cloud(
        self,
        faces: Rows | None = None,
        metadata: Mapping[str, Any] = MappingProxyType({}),
        crs: str | None = None,
        color_depth: int | None = None,
    ) -> Cloud:
        """Return the filled arrays as a cloud; the depth is what the file states."""
        return Cloud(
            self.points,
            colors=self.colors,
            normals=self.normals,
            attributes=self.attributes,
            faces=faces,
            metadata=metadata,
            crs=crs,
            color_depth=confirmed_depth(self.colors, color_depth),
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


def built_in_chunks(
    types: Mapping[str, np.dtype], total: int, blocks: Iterable[Mapping[str, Array]], rows: int
) -> Iterator[CloudBuilder]:
    """Fill builders of ``rows`` rows each from blocks of any size; the last may have fewer rows."""
    filled, done = 0, 0
    builder: CloudBuilder | None = None
    for block in blocks:
        size, taken = len(next(iter(block.values()))), 0
        while taken < size:
            builder = builder or CloudBuilder(types, min(rows, total - done))
            count = min(size - taken, builder.rows - filled)
            part = {name: values[taken : taken + count] for name, values in block.items()}
            builder.fill(slice(filled, filled + count), part)
            taken, filled = taken + count, filled + count
            if filled == builder.rows:
                yield builder
                done, filled, builder = done + filled, 0, None
