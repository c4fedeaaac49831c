"""Insert and remove points and constraints, and compare with fresh triangulations at checkpoints.

    python scripts/changes.py                               100,000 changes of each kind of points
    python scripts/changes.py --changes 2000 --checkpoints 100 --kinds lattice circle

Single points and batches come and go at random, while their number rises and falls, and so do
constraints. At each checkpoint the triangles and the edges that are constraints must be those that
`constrained_delaunay` makes of the points and constraints present, as sets of positions, and each
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
    changes, wanted, most, began = 0, 300, 0, time.process_time()
    while changes < options.changes:
        if rng.random() < 0.01:
            wanted = int(rng.choice([0, 3, 10, 100, 1000, POSITIONS]))
        is_edge = len(tri) > 1 and rng.random() < 0.4
        if is_edge:
            changes += sum(change_edge(tri, rng) for _ in range(rng.choice([1, 30])))
        else:
            changes += change(tri, positions, wanted, rng)
        most = max(most, len(tri.constraints))
        if changes >= due[0]:
            due = [each for each in due if each > changes] or [np.inf]
            if not is_fresh(tri):
                return False
    spent = time.process_time() - began
    print(
        f"{kind}: {changes:,} changes, up to {most:,} constrained edges, {options.checkpoints} "
        f"checkpoints, {spent:.1f} s"
    )
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
    ending = tri.input_edges[np.isin(tri.input_edges, gone).any(axis=1)]
    for a, b in ending.tolist():
        tri.remove_constraint(a, b)
    try:
        tri.remove(gone)
    except liftmesh.InputError:  # constraints would cross
        gone = np.setdiff1d(gone, tri.constraints)
        tri.remove(gone)
    return len(ending) + len(gone)


def change_edge(tri: liftmesh.DynamicTriangulation, rng: np.random.Generator) -> int:
    """Insert or remove a constraint; return how many."""
    edges = tri.input_edges
    if len(edges) and rng.random() < 0.2:
        tri.remove_constraint(*rng.choice(edges).tolist())
        return 1
    a, *others = rng.choice(tri.vertices, min(len(tri), 200), replace=False).tolist()
    if rng.random() < 0.9:  # to the nearest of some
        squares = np.square(tri.points[others] / 2 - tri.points[a] / 2)
        others = [others[int(np.argmin(squares.sum(axis=1)))]]
    try:
        tri.insert_constraint(a, others[0])
    except liftmesh.CrossingError as error:
        for tail, head in tri.input_edges[error.crossings.min(axis=1)[:1]].tolist():
            tri.remove_constraint(tail, head)
    return 1


def is_fresh(tri: liftmesh.DynamicTriangulation) -> bool:
    """Whether triangles and constraints are those of a fresh triangulation."""
    present = tri.points[tri.vertices]
    edges = np.searchsorted(tri.vertices, tri.input_edges)
    try:
        fresh = liftmesh.constrained_delaunay(present, edges)
    except liftmesh.DegenerateInputError:
        return len(tri.simplices) == 0
    same = as_set(tri.points, tri.simplices) == as_set(present, fresh.simplices)
    pieces = np.array_equal(tri.constraints, tri.vertices[fresh.constraints])
    marks = np.array_equal(marked(tri), tri.constraints)
    return same and pieces and marks and are_neighbors(tri)


def marked(tri: liftmesh.DynamicTriangulation) -> np.ndarray:
    """Return the edges of triangles that are constraints."""
    sides = np.stack([np.roll(tri.simplices, -k, axis=1) for k in (1, 2)], axis=2)
    return np.unique(np.sort(sides[tri.is_constrained], axis=1), axis=0)


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
