"""Families of E57 files.

Work grows where scans are many and empty, and memory where values take no bits.
"""

from __future__ import annotations

import numpy as np
from files.e57 import Scan, e57
from growth.families import named, random
from growth.files.points import Compressed

_PLACES = ("cartesianX", "cartesianY", "cartesianZ")


def points(n: int) -> bytes:
    """The ordinary file: one scan of doubles."""
    return e57(Scan(dict(zip(_PLACES, random().random((3, max(n, 1))), strict=True))))


def many_scans(n: int) -> bytes:
    """Scans of a point each."""
    one = Scan(dict.fromkeys(_PLACES, np.ones(1)))
    return e57(*[one] * max(n // 64, 1))


def equal_points(n: int) -> bytes:
    """Whole numbers that can be one only, and so take no bits."""
    made = Compressed(e57(Scan(dict.fromkeys(_PLACES, np.zeros(max(n, 1))), scaled=_NOTHING)))
    made.content = 24 * n
    return made


_NOTHING = dict.fromkeys(_PLACES, (1.0, 5.0, 0))
E57 = named(points, many_scans, equal_points)
