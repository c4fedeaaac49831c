"""A node of the tree of merges: what its points already decide, and what it hands up.

ARCHITECTURE.md has the proof that the triangles of all nodes are those of one call.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Integers, Rows
from liftmesh.base.arrays import MOST_ROWS
from liftmesh.errors import InputError


@dataclass(frozen=True)
class Frontier:
    """What later merges can still change of a node."""

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
    """What a node decides."""

    triangles: Integers
    duplicates: Integers
    hull: Integers
    frontier: Frontier
    is_flat: bool
    neighbors: Rows = field(default_factory=lambda: np.empty((0, 3), dtype=np.int32))


def joined(parts: Sequence[Frontier]) -> Frontier:
    """Put frontiers side by side."""
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
    """Triangulate what is open in a node, and settle what no other point can change."""
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
