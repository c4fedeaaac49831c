"""Clip cells of random sites to random domains, and check each set by definition in rationals.

    python scripts/domains.py                    1,000 domains of each kind
    python scripts/domains.py --count 20000 --seed 7 --kinds boxes

Domains are what boxes and triangles on a lattice leave of each other, with holes, parts and corners
that touch, and stars with arbitrary corners. Sites and weights are on the lattice, where ties and
sites on edges and corners abound, or anywhere. The corners of all cells are made anew from what the
cells say that they are; then every area, side, neighbour and length must be that of the definition,
and the cells must fill the domain exactly. Exits with 1 and the sites and domain at a difference.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from typing import Any

import numpy as np
import shapely
from campaign import run_kinds
from oracles.cells import check

import liftmesh

SIDE = 6  # of the lattice
MOST = 10  # sites


def main() -> None:
    run_kinds(__doc__, DOMAINS, 1000, holds, "domains")


def holds(kind: str, rng: np.random.Generator) -> None:
    """Check the cells of one set of sites in one domain; ends the program at a difference."""
    domain, sites = DOMAINS[kind](rng), random_sites(rng)
    named, squares = random_weights(len(sites), rng)
    try:
        check(liftmesh.power_diagram(sites, **named, domain=domain), squares)
    except Exception as error:
        print(f"{kind}: {domain.wkt}\nsites {sites.tolist()}\n{named}", file=sys.stderr)
        raise SystemExit(1) from error


def random_sites(rng: np.random.Generator) -> Any:
    """Sites on the lattice or between it, some of them equal, or anywhere; also outside."""
    count = int(rng.integers(1, MOST))
    if rng.random() < 0.2:
        return rng.uniform(-1, SIDE + 1, (count, 2))
    return rng.integers(-2, 2 * SIDE + 3, (count, 2)) / rng.choice([1.0, 2.0])


def random_weights(
    count: int, rng: np.random.Generator
) -> tuple[dict[str, list[float]], list[Fraction]]:
    """Small weights or radii of any kind, and the exact weights that they mean."""
    name = str(rng.choice(["weights", "radii"]))
    values = rng.choice([0.0, 0.0, 1.0, 2.0, 3.0, 0.5], count)
    if rng.random() < 0.2:
        values = rng.random(count) * 4
    power = 2 if name == "radii" else 1
    return {name: values.tolist()}, [Fraction(each) ** power for each in values.tolist()]


def boxes(rng: np.random.Generator) -> shapely.Geometry:
    """What some boxes on the lattice leave of others."""
    return _left(lambda: shapely.box(*_two(rng), *(_two(rng) + 1)), rng)


def triangles(rng: np.random.Generator) -> shapely.Geometry:
    """What some triangles with corners on the lattice leave of others, corners on it or not."""
    return _left(lambda: shapely.Polygon(rng.integers(0, SIDE + 1, (3, 2))), rng)


def stars(rng: np.random.Generator) -> shapely.Geometry:
    """A ring with arbitrary corners that all see its centre, perhaps with a hole of that form."""
    turns = np.sort(rng.random(int(rng.integers(3, 12)))) * 2 * np.pi
    reach = rng.uniform(0.5, 1, len(turns)) * SIDE / 2
    ring = np.c_[np.cos(turns), np.sin(turns)] * reach[:, None] + SIDE / 2
    star = shapely.Polygon(ring)
    if rng.random() < 0.5 and star.is_valid:
        hole = shapely.affinity.scale(star, 0.4, 0.4, origin=(SIDE / 2, SIDE / 2))
        star = star.difference(hole)
    return _polygons(star, lambda: stars(rng))


def _two(rng: np.random.Generator) -> Any:
    return rng.integers(0, SIDE, 2)


def _left(draw: Any, rng: np.random.Generator) -> shapely.Geometry:
    kept = shapely.union_all([draw() for _ in range(int(rng.integers(1, 4)))])
    taken = shapely.union_all([draw() for _ in range(int(rng.integers(0, 4)))])
    return _polygons(kept.difference(taken), lambda: _left(draw, rng))


def _polygons(shape: shapely.Geometry, again: Any) -> shapely.Geometry:
    """The shape if it is a domain; else another one."""
    is_domain = shape.geom_type in {"Polygon", "MultiPolygon"} and shape.is_valid and shape.area > 0
    return shape if is_domain else again()


DOMAINS = {"boxes": boxes, "triangles": triangles, "stars": stars}


if __name__ == "__main__":
    main()
