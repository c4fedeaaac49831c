"""Compare tetrahedra with CGAL's, set for set, and the time that both take.

    python scripts/tetrahedra                                20,000 rows of each family
    python scripts/tetrahedra --n 1000000 --families uniform lattice --rounds 3
    python scripts/tetrahedra --files cloud.laz              points of files, too

The tetrahedra of `liftmesh.tetrahedralize` and those of CGAL's `Delaunay_triangulation_3` are
compared as sets of positions; so are those of the rows in another order, by two threads, and
`verify` judges them. Seconds are those of the processor, the least of some rounds in which both
take turns, on one thread; the clock of CGAL holds the insertion alone. Exits with 1 at a
difference, whose points are kept in a file.

Needs a compiler and CGAL: apt-get install g++ libcgal-dev.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from benchmark import cgal
from benchmark.cgal.beside import (
    PROGRAMS,
    answer,
    as_set,
    built,
    clocked,
    columns,
    conclude,
    in_turn,
    parser_of,
    positions,
)
from distributions import Points
from tetrahedra.families import FAMILIES

import liftmesh

KEPT = PROGRAMS.parent / "tetrahedra-differ.npy"
SOURCE = Path(__file__).with_name("cgal.cpp")
SEED = 38


def main() -> None:
    """Compare all families and files, and print a line for each."""
    parser = parser_of(__doc__, FAMILIES, 20_000)
    parser.add_argument("--files", nargs="*", default=[], help="clouds; every k-th row, n in all")
    options = parser.parse_args()
    program = built(cgal.build, PROGRAMS, SOURCE)
    print(f"{'points':<18} {'rows':>9} {'tetrahedra':>10}  liftmesh      CGAL ratio")
    conclude([compare(program, options, *case) for case in made(options)], "cases")


def made(options: Namespace) -> Iterator[tuple[str, Points]]:
    """Name the cases, and make their points."""
    for name in options.families:
        yield name, FAMILIES[name](options.n, np.random.default_rng(SEED))
    for file in options.files:
        points = liftmesh.read(file).points
        yield Path(file).name, points[:: max(len(points) // options.n, 1)].copy()


def compare(program: Path, options: Namespace, name: str, points: Points) -> bool:
    """Triangulate by both programs in turns; whether the tetrahedra are the same."""
    ours = partial(liftmesh.tetrahedralize, points, threads=1)
    calls = {"liftmesh": partial(clocked, ours), "CGAL": partial(by_cgal, program, points)}
    results, seconds = in_turn(calls, options.rounds)
    found, theirs = results.values()
    expected = as_set(positions(points)[found.simplices])
    order = np.random.default_rng(SEED).permutation(len(points))
    other = liftmesh.tetrahedralize(points[order], threads=2)
    is_same = (
        np.array_equal(expected, as_set(theirs))
        and np.array_equal(expected, as_set(positions(points)[order][other.simplices]))
        and found.verify().canonical
    )
    print(
        f"{name:<18} {len(points):>9,} {len(found.simplices):>10,} {columns(seconds)}"
        f"{'' if is_same else '  DIFFERENT'}",
        flush=True,
    )
    if not is_same:
        KEPT.parent.mkdir(exist_ok=True)
        np.save(KEPT, points)
        print(f"kept in {KEPT}")
    return is_same


def by_cgal(program: Path, points: Points) -> tuple[np.ndarray, Any]:
    """Return tetrahedra as numbers of positions, and the seconds of their insertion."""
    found, said = answer(program, points, corners=4)
    return found, said["seconds"]


if __name__ == "__main__":
    main()
