"""Whether floating-point numbers hold whole ones exactly, decided in whole numbers.

Converting there and back does not tell: 2**63 - 1 becomes the double 2**63, which is beyond the
type, and what that becomes depends on the machine.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array

SINGLE, DOUBLE = 24, 53  # bits of a significand


def fit(values: Array, bits: int) -> bool:
    """Whether significands of so many bits hold all values of an array of integers."""
    if not values.size or max(-int(values.min()), int(values.max())) <= 1 << bits:
        return True
    sizes = np.abs(values.astype(np.int64)) if values.dtype.kind == "i" else values
    sizes = sizes.astype(np.uint64)  # -2**63 has no opposite, but the right bits
    lowest = sizes & (~sizes + np.uint64(1))
    return bool((sizes // np.maximum(lowest, 1) < np.uint64(1 << bits)).all())
