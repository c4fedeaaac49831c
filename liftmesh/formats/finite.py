"""Formats that hold finite coordinates only."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liftmesh.errors import FormatError

Array = NDArray[Any]


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
