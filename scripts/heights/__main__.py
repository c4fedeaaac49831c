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
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from benchmark import cgal

import liftmesh
from heights.families import FAMILIES, Planar, inside, terrain
from heights.peers import CgalHeights, Method

ALLOWED = 1e-11  # of the range of heights
METHODS: tuple[Method, ...] = ("linear", "sibson")
SEED = 21


def main() -> None:
    """Compare all families by both methods, and print a line for each."""
    options = read_options()
    print(f"{'points':<18} {'method':<7} {'difference':>10} {'liftmesh':>9} {'CGAL':>9} ratio")
    same = [is_same for name in options.families for is_same in compared(options, name)]
    print(f"{len(same)} cases, {same.count(False)} different")
    raise SystemExit(int(not all(same)))


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=100_000, help="rows, and points")
    parser.add_argument("--rounds", type=int, default=1, help="of which the fastest counts")
    parser.add_argument("--families", nargs="+", choices=FAMILIES, default=[*FAMILIES])
    return parser.parse_args()


def compared(options: Namespace, name: str) -> list[bool]:
    """Ask both programs in turns; whether heights are the same, for each method."""
    rng = np.random.default_rng(SEED)
    rows, asked = terrain(FAMILIES[name](options.n, rng)), inside(options.n, rng)
    surface = liftmesh.triangulate(rows)
    surface.sample(asked[:1])  # makes the index
    with TemporaryDirectory() as folder:
        try:
            peer = CgalHeights.built(Path(folder), rows)
        except cgal.UnavailableError as error:
            raise SystemExit(f"CGAL is not here: {error}") from error
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
    ours, theirs = [], []
    for _ in range(rounds):
        start = time.process_time()
        heights = surface.sample(asked, method, threads=1)
        ours.append(time.process_time() - start)
        others, seconds = peer.sample(asked, method)
        theirs.append(seconds)
    found = difference(heights, others, np.ptp(surface.vertices[:, 2]))
    is_same = found <= ALLOWED
    print(
        f"{name:<18} {method:<7} {found:>10.1e} {min(ours):>9.4f} {min(theirs):>9.4f} "
        f"{min(ours) / max(min(theirs), 1e-9):>5.2f}{'' if is_same else '  DIFFERENT'}",
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
