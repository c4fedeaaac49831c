"""CGAL's regular triangulation, as it is installed and with a static filter before its power test.

CGAL has such a filter from version 6 on. Debian 12 has version 5.5, to which `static_filter.hpp`
adds one; the filtered peer may be built with the headers of another CGAL instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from benchmark import cgal
from benchmark.cgal.beside import PROGRAMS, answer, built
from distributions import Points
from numpy.typing import NDArray

SOURCE = Path(__file__).with_name("regular.cpp")


@dataclass(frozen=True)
class Peer:
    """A program that triangulates the weighted points of a file, and the words behind the files."""

    program: Path
    words: tuple[str, ...] = ()

    def regular(
        self, points: Points, weights: NDArray[np.float64]
    ) -> tuple[NDArray[np.int32], float]:
        """Return triangles as numbers of positions, and the seconds of their insertion."""
        numbers = np.column_stack([points, weights])
        triangles, said = answer(self.program, numbers, *self.words)
        return triangles, said["seconds"]


def peers(other: Path | None) -> dict[str, Peer]:
    """Build the peers; `other` is the folder of another CGAL for the filtered one."""
    plain = built(cgal.build, PROGRAMS, SOURCE)
    if other is None:
        return {"CGAL": Peer(plain), "filtered": Peer(plain, ("static",))}
    return {"CGAL": Peer(plain), "filtered": Peer(built(cgal.build, PROGRAMS, SOURCE, other))}
