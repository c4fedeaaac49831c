"""What an installed wheel is asked, on any machine: the same triangles, bit for bit."""

from __future__ import annotations

import hashlib
import sys

import numpy as np

import liftmesh

ROWS = 20_000
EXPECTED = "a5b70bd02f308000"  # of the triangles, on every machine


def main() -> None:
    """Triangulate points with and without ties on one thread and two, and hash what comes out."""
    rng = np.random.default_rng(41)
    digest = hashlib.sha256()
    for points in (rng.random((ROWS, 2)), rng.integers(0, 90, (ROWS, 2)).astype(float)):
        found = [liftmesh.delaunay(points, order="canonical", threads=n) for n in (1, 2)]
        for arrays in zip(*((t.simplices, t.neighbors, t.duplicates) for t in found), strict=True):
            if not np.array_equal(*arrays):
                raise SystemExit("one thread and two differ")
            digest.update(np.ascontiguousarray(arrays[0]).tobytes())
    version = ".".join(map(str, sys.version_info[:3]))
    if digest.hexdigest()[:16] != EXPECTED:
        raise SystemExit(f"{digest.hexdigest()[:16]} instead of {EXPECTED}")
    print(version)


if __name__ == "__main__":
    main()
