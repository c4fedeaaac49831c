"""What a format needs of a cloud: a file written without it loses rows, or cannot be read."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud


def check_points(cloud: Cloud, kind: str) -> None:
    """Refuse a cloud of no rows.

    Raises
    ------
    FormatError
        There are none.
    """
    if not len(cloud):
        raise FormatError(f"a cloud without points cannot be written as {kind}: write PLY or NPZ")


def needed_faces(cloud: Cloud, kind: str) -> Array:
    """Give the faces; refuse points alone.

    Raises
    ------
    FormatError
        There are no faces.
    """
    if cloud.faces is None or not len(cloud.faces):
        raise FormatError(f"a cloud without faces cannot be written as {kind}: write PLY")
    return cloud.faces


def check_finite(points: Array, rows: Array, kind: str) -> None:
    """Refuse a vertex that a format cannot hold.

    Raises
    ------
    FormatError
        A coordinate in one of the ``rows`` is NaN or infinite; the message names it.
    """
    bad = ~np.isfinite(points[rows]).all(axis=1)
    if bad.any():
        row = int(rows[np.argmax(bad)])
        raise FormatError(
            f"vertex {row} is {points[row].tolist()}: {kind} holds finite coordinates only: "
            "drop such rows, or write PLY or OBJ"
        )
