"""The process of one version: triangulates the sets of a file, and saves what is comparable.

A request is a line, with tabs between the file of the sets, the file for the answer and the number
of threads. The triangles of all sets stand in one array, each turned to begin with its least row
and all of them sorted; the neighbours follow them. An error is its message, without what it says of
rows: 0.1.0 found another end of a line first.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import liftmesh

Arrays = dict[str, NDArray[Any]]


def main() -> None:
    print(f"liftmesh {liftmesh.__version__} in {sys.prefix}", flush=True)
    for line in sys.stdin:
        source, target, threads = line.rstrip("\n").split("\t")
        with np.load(source) as given:
            np.savez(target, **triangulated(given["points"], given["starts"], int(threads)))
        print(target, flush=True)


def triangulated(points: NDArray[np.float64], starts: NDArray[np.int64], threads: int) -> Arrays:
    """Triangulate sets that stand one after the other; rows and triangles count through."""
    found: dict[str, list[Any]] = {name: [] for name in ("simplices", "neighbors", "duplicates")}
    hulls, errors, counts = [], [], []
    for first, last in pairwise(starts):
        try:
            one = liftmesh.delaunay(points[first:last], threads=threads)
        except liftmesh.DegenerateInputError as error:
            errors.append(f"{error}".partition(",")[0])
            counts.append(0)
            continue
        triangles = sum(counts)
        found["simplices"].append(one.simplices + first)
        found["neighbors"].append(np.where(one.neighbors < 0, -1, one.neighbors + triangles))
        found["duplicates"].append(one.duplicates + first)
        hulls.append(one.convex_hull.reshape(len(one.convex_hull), -1)[:, 0] + first)  # once pairs
        errors.append("")
        counts.append(one.nsimplex)
    empty = np.empty((0, 3), dtype=np.int64)
    simplices, neighbors = (
        np.concatenate([empty, *found[name]]) for name in ("simplices", "neighbors")
    )
    order, simplices, neighbors = in_order(simplices, neighbors)
    return {
        "simplices": simplices,
        "neighbors": neighbors,
        "duplicates": np.concatenate([empty[:, :2], *found["duplicates"]]),
        "hull": np.concatenate([empty[:, 0], *hulls]),
        "errors": np.array(errors),
        "set_of_triangle": np.repeat(np.arange(len(counts)), counts)[order],
        "starts": starts,
    }


def in_order(
    simplices: NDArray[np.int64], neighbors: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Turn and sort triangles, and name neighbours anew: also the order that did it."""
    turn = (simplices.argmin(axis=1)[:, None] + np.arange(3)) % 3
    simplices = np.take_along_axis(simplices, turn, axis=1)
    neighbors = np.take_along_axis(neighbors, turn, axis=1)
    order = np.lexsort(simplices.T[::-1])
    name = np.full(len(order) + 1, -1)
    name[order] = np.arange(len(order))
    return order, simplices[order], name[neighbors[order]]


if __name__ == "__main__":
    main()
