"""Families of clouds to write."""

from __future__ import annotations

import numpy as np
from growth.families import named, random

from liftmesh import Cloud


def faces(n: int) -> np.ndarray:
    """Make n faces over n rows."""
    first = np.arange(n)
    return np.column_stack([first, (first + 1) % n, (first + 2) % n]).astype(np.int32)


def terrain(n: int) -> Cloud:
    """The ordinary mesh: whole centimetres and colours."""
    points = np.round(random().random((n, 3)) * 1000, 2)
    colors = random().integers(0, 256, (n, 3)).astype(np.uint8)
    return Cloud(points, colors=colors, faces=faces(n))


def long_digits(n: int) -> Cloud:
    """Numbers that take seventeen digits."""
    return Cloud(random().random((n, 3)) / 3, faces=faces(n))


def attributes(n: int) -> Cloud:
    """Very many named values, to be written column by column."""
    rows = random().random((8, 3))
    return Cloud(rows, faces=faces(8), attributes={f"a{k}": rows[:, 0] for k in range(n)})


def wide_attribute(n: int) -> Cloud:
    """One attribute of very many columns."""
    return Cloud(random().random((8, 3)), faces=faces(8), attributes={"a": np.zeros((8, n))})


def repeated(n: int) -> Cloud:
    """Faces of very few rows."""
    return Cloud(random().random((3, 3)), faces=np.tile(np.arange(3, dtype=np.int32), (n, 1)))


def everything(n: int) -> Cloud:
    """Colours of sixteen bits, normals, values of each type and a coordinate system."""
    points = random().random((n, 3))
    values = {"f": points[:, 0].astype(np.float32), "i": np.arange(n), "b": np.zeros(n, np.uint8)}
    colors = random().integers(0, 65536, (n, 4)).astype(np.uint16)
    return Cloud(
        points, colors=colors, normals=points, attributes=values, faces=faces(n), crs="EPSG:25832"
    )


def odd_names(n: int) -> Cloud:
    """Very many named values whose names become one another where they are made valid."""
    rows = random().random((8, 3))
    return Cloud(
        rows, faces=faces(8), attributes={f"h{chr(0x4E00 + k)}": rows[:, 0] for k in range(n)}
    )


CLOUDS = named(terrain, long_digits, attributes, wide_attribute, repeated, everything, odd_names)
