"""Make surfaces that follow random lines, and check what lines promise.

    python scripts/lines.py                      1,000 clouds
    python scripts/lines.py --count 10000 --seed 7

Clouds are scattered, on lattices, or far from the origin; lines are breaklines with heights and
without, soft breaklines, a boundary and holes. The surface and what is left of it verify; every row
is accounted for; corners with heights keep one of these; soft breaklines have the heights of the
surface without them; areas are those of shapely; and neither the order of the rows nor the
direction of lines changes a triangle. Exits with 1 and the seed at a difference.
"""

from __future__ import annotations

import sys
import warnings
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections import Counter
from typing import Any

import numpy as np
import shapely
from distributions import Points
from numpy.random import Generator

import liftmesh
from liftmesh import Surface

KINDS = ("scattered", "lattice", "far")
MOST_ERROR = 1e-9


def main() -> None:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    warnings.simplefilter("ignore", liftmesh.DataWarning)  # of lines that lie beyond the points
    seeds = range(options.seed, options.seed + options.count)
    found = Counter(checked(seed) for seed in seeds)
    print(f"{options.count:,} clouds: {', '.join(f'{n:,} {what}' for what, n in found.items())}")


def checked(seed: int) -> str:
    """Check one surface; say whether there is one."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    cloud, given = drawn_points(rng, kind, int(rng.integers(4, 60))), drawn_lines(rng, kind)
    try:
        surface = liftmesh.triangulate(cloud, crossing="split", **given)
    except liftmesh.InputError as refusal:
        said = str(refusal)
        if "no face is left" in said or "has no heights" in said or "degenerate" in said:
            return "refused"
        sys.exit(f"seed {seed}: {refusal}")
    faults = [*proofs(surface), *heights(cloud, surface, given), *areas(cloud, surface, given)]
    turned = {name: [each[::-1] for each in lines] for name, lines in given.items()}
    again = liftmesh.triangulate(rng.permutation(cloud), crossing="split", **turned)
    if not given.get("breaklines") and positions(again) != positions(surface):
        faults.append("order or direction changes a triangle")  # the first line decides heights
    if faults:
        sys.exit(f"seed {seed}: {'; '.join(faults)}")
    return "followed"


def drawn_points(rng: Generator, kind: str, count: int) -> Points:
    """Draw points in a square of side 16, with the height last."""
    planar = rng.integers(0, 17, (count, 2)) if kind == "lattice" else rng.random((count, 2)) * 16
    planar = np.unique(planar, axis=0) + (2.0**22 if kind == "far" else 0.0)
    return np.column_stack([planar, rng.integers(0, 64, len(planar)) / 8])


def drawn_lines(rng: Generator, kind: str) -> dict[str, list[Points]]:
    """Draw lines of some kinds, and rings around points."""
    given: dict[str, list[Points]] = {}
    for name in ("breaklines", "soft_breaklines"):
        if rng.random() < 0.6:
            given[name] = [
                drawn_points(rng, kind, int(rng.integers(2, 6))) for _ in range(rng.integers(1, 4))
            ]
            given[name] = [each for each in given[name] if len(each) > 1]
            if name == "breaklines" and rng.random() < 0.3:
                given[name] = [each[:, :2] for each in given[name]]
    for name in ("boundary", "holes"):
        if rng.random() < 0.4:
            angles = np.sort(rng.random(int(rng.integers(3, 7)))) * 2 * np.pi
            around = np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(2, 12)
            center = rng.random(2) * 16 + (2.0**22 if kind == "far" else 0)
            given[name] = [around + center]
    return {name: lines for name, lines in given.items() if lines}


def proofs(surface: Surface) -> list[str]:
    """Verify the whole and what is left, and count rows."""
    tri, report = surface.triangulation, surface.report
    edges = getattr(tri, "constraints", np.empty((0, 2), dtype=np.int32))
    left = liftmesh.verify(tri.points, surface.faces, constraints=edges, carved=True)
    rows = report.n_used + report.n_duplicates + report.n_overhangs
    return [
        fault
        for fault, holds in (
            ("the whole does not verify", surface.verify().canonical),
            (f"what is left does not verify: {left}", left.canonical or not len(edges)),
            ("rows are not accounted for", report.n_rows == rows == len(surface.vertices)),
        )
        if not holds
    ]


def heights(cloud: Points, surface: Surface, given: dict[str, list[Points]]) -> list[str]:
    """Compare heights at corners, and along soft breaklines that stand alone."""
    whole = surface.replace(vertices=surface.vertices)
    hard = [each for each in given.get("breaklines", []) if each.shape[1] == 3]
    corners = np.concatenate([np.empty((0, 3)), *hard])
    found = whole.sample(corners[:, :2])
    allowed: dict[tuple[float, float], set[float]] = {}
    for x, y, z in corners.tolist():
        allowed.setdefault((x, y), set()).add(z)
    faults = [
        f"a corner {(x, y)} has the height {height}"
        for (x, y, _), height in zip(corners.tolist(), found.tolist(), strict=True)
        if not np.isnan(height) and height not in allowed[x, y]
    ]
    if given.keys() == {"soft_breaklines"}:
        lines = [each[:, :2] for each in given["soft_breaklines"]]
        shares = np.linspace(0.05, 0.95, 19)[:, None, None]
        places = np.concatenate(
            [(a[:-1] + shares * np.diff(a, axis=0)).reshape(-1, 2) for a in lines]
        )
        before, after = liftmesh.triangulate(cloud).sample(places), whole.sample(places)
        if not np.allclose(before, after, atol=1e-3, equal_nan=True):
            faults.append("soft breaklines are not on the surface without them")
    return faults


def areas(cloud: Points, surface: Surface, given: dict[str, list[Any]]) -> list[str]:
    """Compare the area in the plane with that of the hull in the boundary, without holes."""
    rows = np.concatenate([cloud, *(e for e in given.get("breaklines", []) if e.shape[1] == 3)])
    area = shapely.MultiPoint(rows[:, :2]).convex_hull
    for ring in given.get("boundary", []):
        area = area.intersection(shapely.Polygon(ring))
    for ring in given.get("holes", []):
        area = area.difference(shapely.Polygon(ring))
    corners = surface.triangulation.points[surface.faces]
    (ax, ay), (bx, by) = np.moveaxis(corners[:, 1:] - corners[:, :1], 0, -1)
    found = float((ax * by - ay * bx).sum() / 2)
    return [] if abs(found - area.area) <= MOST_ERROR * 256 else [f"area {found}, not {area.area}"]


def positions(surface: Surface) -> set[tuple[Any, ...]]:
    """Return the faces as corners in the plane."""
    corners = surface.triangulation.points[surface.faces].tolist()
    return {tuple(sorted(map(tuple, each))) for each in corners}


if __name__ == "__main__":
    main()
