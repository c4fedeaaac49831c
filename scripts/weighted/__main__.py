"""Compare regular triangulations with CGAL's, set for set, and the time that both take.

    python scripts/weighted                                  20,000 rows of each family
    python scripts/weighted --n 1000000 --families uniform --shares 0 0.5 --rounds 3
    python scripts/weighted --cgal6 FOLDER                   with another CGAL as second peer

Families of points (`families.py`) get weights that hide 0, 15, 50, 75 and 99 % of their rows, and
weights that hide all but the hull. The triangles of `liftmesh.regular` and those of CGAL's
`Regular_triangulation_2` are compared as sets of positions. Seconds are those of the processor, the
least of some rounds in which all take turns, on one thread; the clock of CGAL holds the insertion
alone. Exits with 1 at a difference, whose points are kept in a file.

There are two peers: CGAL as installed, and "filtered" with a static filter before its power test,
which CGAL has from version 6 on. Debian 12 has version 5.5, to which `static_filter.hpp` adds one;
with `--cgal6 FOLDER` the second peer is built with the headers in that folder instead.

Needs a compiler and CGAL: apt-get install g++ libcgal-dev.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from benchmark.cgal.beside import (
    PROGRAMS,
    as_set,
    clocked,
    columns,
    conclude,
    in_turn,
    parser_of,
    positions,
)
from distributions import Points
from weighted.families import FAMILIES, Weights, hidden_share, under_the_hull, with_share
from weighted.peers import Peer, peers

import liftmesh

KEPT = PROGRAMS.parent / "regular-differs.npz"
SHARES = (0.0, 0.15, 0.5, 0.75, 0.99)
SEED = 17
HEADER = (
    f"{'points':<18} {'weights':<11} {'hidden':>6} {'triangles':>10}  liftmesh"
    "      CGAL ratio  filtered ratio"
)


def main() -> None:
    """Compare all cases, and print a line for each."""
    parser = parser_of(__doc__, FAMILIES, 20_000)
    add = parser.add_argument
    add("--shares", nargs="+", type=float, default=SHARES, help="of hidden rows")
    add("--cgal6", type=Path, metavar="FOLDER", help="of another CGAL, for the second peer")
    options = parser.parse_args()
    others = peers(options.cgal6)
    print(HEADER)
    conclude([compare(others, options, *case) for case in made(options)], "cases")


def made(options: Namespace) -> Iterator[tuple[str, str, Points, Weights]]:
    """Name the cases, and make their points and weights."""
    for name in options.families:
        points, weights = FAMILIES[name](options.n, np.random.default_rng(SEED))
        for share in options.shares:
            found = with_share(points, weights, share)
            if hidden_share(points, found) >= share / 2:  # of rows on their hull none can hide
                yield name, f"{share:.0%}", points, found
        yield name, "of the hull", points, under_the_hull(points)


def compare(
    others: Mapping[str, Peer],
    options: Namespace,
    name: str,
    kind: str,
    points: Points,
    weights: Weights,
) -> bool:
    """Triangulate by all programs in turns; whether the triangles are the same."""
    calls: dict[str, Callable[[], tuple[Any, float]]] = {
        each: partial(peer.regular, points, weights) for each, peer in others.items()
    }
    ours = partial(liftmesh.regular, points, weights=weights, threads=1)
    results, seconds = in_turn({"liftmesh": partial(clocked, ours), **calls}, options.rounds)
    found, *sets = results.values()
    expected = as_set(positions(points)[found.simplices])
    is_same = all(np.array_equal(expected, as_set(triangles)) for triangles in sets)
    share = len(found.hidden) / len(points)
    times = columns(seconds)
    print(
        f"{name:<18} {kind:<11} {share:>6.1%} {found.nsimplex:>10,} {times}"
        f"{'' if is_same else '  DIFFERENT'}",
        flush=True,
    )
    if not is_same:
        KEPT.parent.mkdir(exist_ok=True)
        np.savez(KEPT, points=points, weights=weights)
        print(f"kept in {KEPT}")
    return is_same


if __name__ == "__main__":
    main()
