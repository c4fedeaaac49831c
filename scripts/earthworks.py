"""Compare cut and fill with rationals, on grids that are shifted, turned and rounded.

    python scripts/earthworks.py                      1,000 pairs of grids
    python scripts/earthworks.py --count 10000 --seed 7

Surfaces that have an area in common must be measured, and each volume be within 10^-12 of the area
times the largest distance between them, the area within 10^-12 of itself; the other way round cut
and fill must be exchanged to the bit. Exits with 1 and the seed at a difference.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter

import numpy as np
from oracles.earthwork import error, exact_earthwork, grid_pair

import liftmesh

MOST_ERROR = 1e-12


def main() -> None:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    found = [measured(seed) for seed in range(options.seed, options.seed + options.count)]
    errors = [each for each in found if each is not None]
    print(f"{options.count:,} pairs, {len(errors):,} overlap: errors of at most {max(errors):.2g}")


def measured(seed: int) -> float | None:
    """Return the error of one pair; None if it has no area in common."""
    one, two = (liftmesh.triangulate(each) for each in grid_pair(np.random.default_rng(seed)))
    exact = exact_earthwork(one, two)
    try:
        found, turned = one.cut_and_fill(two), two.cut_and_fill(one)
    except liftmesh.InputError as refusal:
        if exact.area > 0:
            sys.exit(f"seed {seed}: {refusal}")
        return None
    wrong = error(found, exact) if exact.area > 0 else np.inf
    if wrong > MOST_ERROR or (turned.cut, turned.fill) != (found.fill, found.cut):
        sys.exit(f"seed {seed}: {found}, turned {turned}, an error of {wrong:.2g}")
    return wrong


if __name__ == "__main__":
    main()
