"""Which way is up in the file of a model, and which place on the map is its zero.

Maps have z for up, engines and modelling programs y. A point (x, y, z) with z up is (x, z, -y) with
y up: a turn about x, in which no number is rounded. The origin is subtracted from every point, so
that a model is near zero, where single precision is finest; files state both, and readers undo it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.options import Up, check_option, refused
from liftmesh.io.format import Origin, round_below
from liftmesh.io.markup import finite_numbers

OriginChoice: TypeAlias = Sequence[float] | Literal["center"] | None


@dataclass(frozen=True, slots=True)
class Axes:
    """Checked options of a reader; None: what the file says, or else its format."""

    up: Up | None = None
    origin: Origin | None = None


AS_STATED = Axes()


def validate_axes(*, up: Up | None = None, origin: Sequence[float] | None = None) -> Axes:
    """Check the options of a reader."""
    if up is not None:
        check_option("up", up, Up)
    return Axes(up, None if origin is None else _numbers(origin, "give x, y and z of a place"))


def chosen_origin(origin: OriginChoice, points: Floats) -> Origin | None:
    """Return the place that becomes zero: a caller's, or round numbers below the middle."""
    if origin is None:
        return None
    if not isinstance(origin, str) or origin != "center":
        return _numbers(origin, "give x, y and z of the place that becomes zero, or 'center'")
    low, high = (np.array([pick(column) for column in points.T]) for pick in (np.min, np.max))
    middle = low / 2 + high / 2
    x, y, z = round_below(np.array([*middle[:2], low[2]]), float((high / 2 - low / 2).max()) * 2)
    return float(x), float(y), float(z)


def turned(rows: Floats) -> Floats:
    """Turn points or directions from z up to y up."""
    x, y, z = rows.T
    return np.column_stack([x, z, -y])


def upright(rows: Floats) -> Floats:
    """Turn points or directions from y up to z up."""
    x, y, z = rows.T
    return np.column_stack([x, -z, y])


def _numbers(origin: Any, remedy: str) -> Origin:
    listed = origin.tolist() if isinstance(origin, np.ndarray) else origin
    numbers = finite_numbers([*listed] if isinstance(listed, tuple) else listed, 3)
    if numbers is None:
        raise refused("origin", origin, remedy)
    return numbers[0], numbers[1], numbers[2]
