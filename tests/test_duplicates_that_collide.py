"""Points made to collide in the table of positions: still right, and still quick."""

from __future__ import annotations

import numpy as np

import liftmesh

BITS = 2**64 - 1


def mixed(h: int) -> int:
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9 & BITS
    h = (h ^ (h >> 27)) * 0x94D049BB133111EB & BITS
    return h ^ (h >> 31)


def unshifted(h: int, by: int) -> int:
    """Undo h ^= h >> by."""
    result = h
    for _ in range(64 // by + 1):
        result = h ^ (result >> by)
    return result


def unmixed(h: int) -> int:
    h = unshifted(h, 31) * pow(0x94D049BB133111EB, -1, 2**64) & BITS
    h = unshifted(h, 27) * pow(0xBF58476D1CE4E5B9, -1, 2**64) & BITS
    return unshifted(h, 30)


def colliding_column(count: int) -> np.ndarray:
    """Points of one x whose hashes agree in their lower 40 bits."""
    x = np.float64(1.0)
    seed = mixed(int(x.view(np.uint64)))
    bits = [seed ^ unmixed(k << 40) for k in range(1, 2 * count)]
    y = np.array(bits, dtype=np.uint64).view(np.float64)
    y = y[np.isfinite(y) & (np.abs(y) < 1e300) & (np.abs(y) > 1e-300)][:count]
    return np.column_stack([np.full(count, x), y])


def test_the_hash_is_undone() -> None:
    assert [mixed(unmixed(h)) for h in (1, 2**63, 12345)] == [1, 2**63, 12345]


def test_colliding_positions_are_told_apart_and_merged() -> None:
    column = colliding_column(1200)
    twice = np.concatenate([column, column[::-1]])
    points = np.concatenate([twice, [[2.0, 0.0], [2.0, 1.0]]])
    tri = liftmesh.delaunay(points)
    rows = np.arange(1200, 2400)
    np.testing.assert_array_equal(tri.duplicates, np.column_stack([rows, 2399 - rows]))
    assert tri.nsimplex == 2 * 1202 - 2 - len(tri.convex_hull)
    assert set(np.unique(tri.simplices)) == {*range(1200), 2400, 2401}
