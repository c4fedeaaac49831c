"""A node of the tree of merges: what its points already decide, and what it hands up.

ARCHITECTURE.md has the proof that the triangles of all nodes are those of one call.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Integers, Rows
from liftmesh.arrays import MOST_ROWS
from liftmesh.errors import InputError


@dataclass(frozen=True)
class Frontier:
    """What later merges can still change of a node.

    Attributes
    ----------
    records : (k, 3) ndarray of int64
        Row number, x and y of its points, as 64-bit words.
    rim : (r, 2) ndarray of int32
        Edges between records, with finished ground on their left and none on their right.
    """

    records: Integers
    rim: Rows = field(default_factory=lambda: np.empty((0, 2), dtype=np.int32))

    def __len__(self) -> int:
        return len(self.records)

    @property
    def nbytes(self) -> int:
        """The size of both arrays in bytes."""
        return self.records.nbytes + self.rim.nbytes


@dataclass(frozen=True)
class Merged:
    """What a node decides.

    Attributes
    ----------
    triangles : (m, 3) ndarray of int64
        Triangles of the whole input that no other node has, counter-clockwise from the
        lexicographically least point.
    duplicates : (d, 2) ndarray of int64
        Rows at the position of a lower row, ascending, each with that row.
    hull : (h,) ndarray of int64
        The rows on the hull of the node, counter-clockwise from the least point.
    frontier : Frontier
        What goes up: nothing from the root, but for points on one line.
    is_flat : bool
        Whether the points have no triangle: they are fewer than three, or on one line.
    neighbors : (m, 3) ndarray of int32
        Which of the triangles is beyond each edge, or -1 if none is; edge k is opposite corner k.
        Empty if they were not asked for.
    """

    triangles: Integers
    duplicates: Integers
    hull: Integers
    frontier: Frontier
    is_flat: bool
    neighbors: Rows = field(default_factory=lambda: np.empty((0, 3), dtype=np.int32))


def joined(parts: Sequence[Frontier]) -> Frontier:
    """Put frontiers side by side.

    Parameters
    ----------
    parts : sequence of Frontier
        Frontiers of disjoint sets of points.

    Returns
    -------
    Frontier
        All records in this order, and all edges.
    """
    if len(parts) == 1:
        return parts[0]
    begins = np.cumsum([0, *(len(part) for part in parts[:-1])], dtype=np.int64)
    rims = [part.rim + np.int32(begin) for part, begin in zip(parts, begins, strict=True)]
    return Frontier(np.concatenate([part.records for part in parts]), np.concatenate(rims))


def merge(
    part: Frontier,
    cell: Sequence[float],
    foreign: Floats,
    *,
    is_root: bool,
    with_neighbors: bool = False,
    threads: int = 1,
    scratch: str | None = None,
) -> Merged:
    """Triangulate what is open in a node, and settle what no other point can change.

    Parameters
    ----------
    part : Frontier
        The frontiers of the children, joined; or all points of a tile.
    cell : sequence of four floats
        The box in whose interior all points of the input are the node's: x and y of its lower and
        upper corner.
    foreign : (k, 4) ndarray of float64
        Boxes that hold all points of the input that are not the node's.
    is_root : bool
        Whether there are no others.
    with_neighbors : bool
        Whether to say which triangles share an edge.
    threads : int
        Number of threads.
    scratch : str, optional
        A folder in which large arrays are files.

    Returns
    -------
    Merged
        The same for any number of threads.

    Raises
    ------
    InputError
        There are more points than the kernel takes at once.
    RuntimeError
        The frontiers do not fit together: a file was changed, or this is a bug.
    """
    if len(part) > MOST_ROWS:
        raise InputError(
            f"{len(part):,} points come together in one merge, more than {MOST_ROWS:,}: too many "
            "are equal, or on one circle or line; thin them out"
        )
    boxes = np.ascontiguousarray(foreign, dtype=np.float64)
    status, missing, triangles, neighbors, duplicates, hull, records, rim = _kernel.merge_frontiers(
        part.records,
        part.rim,
        np.array([cell]),
        boxes,
        is_root,
        with_neighbors,
        threads,
        False,
        None,
        scratch,
    )
    if missing or status == "non-finite":
        raise RuntimeError(f"frontiers do not fit together: {missing} edges of the rim are missing")
    flat = status != "ok"
    return Merged(triangles, duplicates, hull, Frontier(records, rim), flat, neighbors)
