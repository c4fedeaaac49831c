"""Points made to collide in the hash table by which the kernel finds equal positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# The kernel's hash is the sum of the bits of x and y, each times an odd number; its top bits count.
X_TIMES, Y_TIMES = 0x9E3779B97F4A7C15, 0xD1B54A32D192ED03
BITS = 2**64 - 1


def bits(value: float) -> int:
    return int(np.float64(value).view(np.uint64))


def hashed(x: float, y: float) -> int:
    return bits(x) * X_TIMES + bits(y) * Y_TIMES & BITS


def colliding_column(count: int) -> NDArray[np.float64]:
    """Points of one x whose hashes agree in their upper 48 bits."""
    undone = pow(Y_TIMES, -1, 2**64)
    hashes = [0x123456789ABC << 16 | k for k in range(2 * count)]
    found = [(h - bits(1.0) * X_TIMES) * undone & BITS for h in hashes]
    y = np.array(found, dtype=np.uint64).view(np.float64)
    y = y[(np.abs(y) < 1e300) & (np.abs(y) > 1e-300)][:count]
    return np.column_stack([np.full(count, 1.0), y])
