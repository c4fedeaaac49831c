"""Compare heights between the vertices with CGAL's, and the time that both take.

    python scripts/heights                          100,000 rows and points of each family
    python scripts/heights --n 1000000 --rounds 3 --families uniform

On surfaces of some families (`families.py`), heights at points inside are asked by the methods
"linear" and "sibson", and of CGAL by location and barycentric coordinates, or by
`natural_neighbor_coordinates_2`. They must be equal to 10^-11 of the range of heights, at every
point. Seconds are those of the processor, the least of some rounds in which both take turns, on
one thread, with the sorting of the points. Exits with 1 at a difference.

Needs a compiler and CGAL: apt-get install g++ libcgal-dev.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from benchmark.cgal.beside import built, clocked, columns, conclude, in_turn, parser_of
from heights.families import FAMILIES, Planar, inside, terrain
from heights.peers import CgalHeights, Method

import liftmesh

ALLOWED = 1e-11  # of the range of heights
METHODS: tuple[Method, ...] = ("linear", "sibson")
SEED = 21


def main() -> None:
    """Compare all families by both methods, and print a line for each."""
    options = parser_of(__doc__, FAMILIES, 100_000).parse_args()
    print(f"{'points':<18} {'method':<7} {'difference':>10} {'liftmesh':>9} {'CGAL':>9} ratio")
    conclude([is_same for name in options.families for is_same in compared(options, name)], "cases")


def compared(options: Namespace, name: str) -> list[bool]:
    """Ask both programs in turns; whether heights are the same, for each method."""
    rng = np.random.default_rng(SEED)
    rows, asked = terrain(FAMILIES[name](options.n, rng)), inside(options.n, rng)
    surface = liftmesh.triangulate(rows)
    surface.sample(asked[:1])  # makes the index
    with TemporaryDirectory() as folder:
        peer = built(CgalHeights.built, Path(folder), rows)
        return [compare(surface, peer, asked, method, options.rounds, name) for method in METHODS]


def compare(
    surface: liftmesh.Surface,
    peer: CgalHeights,
    asked: Planar,
    method: Method,
    rounds: int,
    name: str,
) -> bool:
    """Ask by one method, and print a line."""
    calls = {
        "ours": lambda: clocked(lambda: surface.sample(asked, method, threads=1)),
        "theirs": lambda: peer.sample(asked, method),
    }
    results, seconds = in_turn(calls, rounds)
    heights, others = results.values()
    found = difference(heights, others, np.ptp(surface.vertices[:, 2]))
    is_same = found <= ALLOWED
    print(
        f"{name:<18} {method:<7} {found:>10.1e} {columns(seconds)}"
        f"{'' if is_same else '  DIFFERENT'}",
        flush=True,
    )
    return is_same


def difference(heights: Planar, others: Planar, extent: float) -> float:
    """Return the largest difference, in ranges of heights; infinite where one has none."""
    if not np.array_equal(np.isnan(heights), np.isnan(others)) or np.isnan(heights).all():
        return float("inf")
    return float(np.nanmax(np.abs(heights - others)) / extent)


if __name__ == "__main__":
    main()
