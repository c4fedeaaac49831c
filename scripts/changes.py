"""Insert and remove points at random, and compare with fresh triangulations at checkpoints.

    python scripts/changes.py                               100,000 changes of each kind of points
    python scripts/changes.py --changes 2000 --checkpoints 100 --kinds lattice circle

Single points and batches come and go, while their number rises and falls. At each checkpoint the
triangles must be those that `delaunay` makes of the points present, as sets of positions, and each
neighbour must have the two corners of its edge. Exits with 1 at a difference.
"""

from __future__ import annotations

import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter

import numpy as np
from distributions import DISTRIBUTIONS, Points

import liftmesh

POSITIONS = 4000  # of each kind
SEED = 21


def main() -> None:
    options = read_options()
    failed = [kind for kind in options.kinds if not holds(kind, options)]
    if failed:
        raise SystemExit(f"other triangles than fresh ones: {', '.join(failed)}")


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--changes", type=int, default=100_000)
    parser.add_argument("--checkpoints", type=int, default=200)
    parser.add_argument("--kinds", nargs="*", default=[*DISTRIBUTIONS], choices=[*DISTRIBUTIONS])
    return parser.parse_args()


def holds(kind: str, options: Namespace) -> bool:
    """Run the changes of one kind of points, and say whether every checkpoint holds."""
    rng = np.random.default_rng(SEED)
    positions = DISTRIBUTIONS[kind](POSITIONS, rng)[:, :2] + 0.0
    tri = liftmesh.DynamicTriangulation()
    due = np.linspace(0, options.changes, options.checkpoints + 1)[1:].tolist()
    changes, wanted, began = 0, 300, time.process_time()
    while changes < options.changes:
        if rng.random() < 0.01:
            wanted = int(rng.choice([0, 3, 10, 100, 1000, POSITIONS]))
        changes += change(tri, positions, wanted, rng)
        if changes >= due[0]:
            due = [each for each in due if each > changes] or [np.inf]
            if not is_fresh(tri):
                return False
    spent = time.process_time() - began
    print(f"{kind}: {changes:,} changes, {options.checkpoints} checkpoints, {spent:.1f} s")
    return True


def change(
    tri: liftmesh.DynamicTriangulation, positions: Points, wanted: int, rng: np.random.Generator
) -> int:
    """Insert or remove one point or several, towards a number of points; return how many."""
    count = int(rng.choice([1, 1, 1, 2, 40]))
    present = len(tri)
    if present == 0 or rng.random() < (0.9 if present < wanted else 0.1):
        tri.insert(positions[rng.integers(0, len(positions), count)])
        return count
    vertices = tri.vertices
    gone = rng.choice(vertices, min(count, len(vertices)), replace=False)
    tri.remove(gone)
    return len(gone)


def is_fresh(tri: liftmesh.DynamicTriangulation) -> bool:
    """Whether the triangles are those of a fresh triangulation."""
    present = tri.points[tri.vertices]
    try:
        fresh = liftmesh.delaunay(present)
    except liftmesh.DegenerateInputError:
        return len(tri.simplices) == 0
    same = as_set(tri.points, tri.simplices) == as_set(present, fresh.simplices)
    return same and are_neighbors(tri)


def as_set(points: Points, simplices: np.ndarray) -> set[tuple[complex, ...]]:
    """Return triangles as sets of positions; complex numbers sort by x, then y."""
    corners = points[simplices]
    return set(map(tuple, np.sort(corners[..., 0] + 1j * corners[..., 1], axis=1).tolist()))


def are_neighbors(tri: liftmesh.DynamicTriangulation) -> bool:
    """Whether neighbours share the ends of their edge, in opposite directions."""
    rows, sides = np.nonzero(tri.neighbors >= 0)
    other = tri.neighbors[rows, sides]
    back = (tri.neighbors[other] == rows[:, None]).argmax(axis=1)
    ends = [tri.simplices[rows, (sides + k) % 3] for k in (1, 2)]
    seen = [tri.simplices[other, (back + k) % 3] for k in (2, 1)]
    return all(np.array_equal(a, b) for a, b in zip(ends, seen, strict=True))


if __name__ == "__main__":
    main()
