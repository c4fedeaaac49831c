"""Draw the pictures of CONSTRAINTS.md: ``python scripts/draw_constraints.py [NAME ...]``.

The coast is the contour of fractal noise, and the hills with their road are made up.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
from constrained.families import coastline
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

import liftmesh

FOLDER = Path(__file__).resolve().parent.parent / "data" / "constraints"
PAPER, INK, ACCENT = "#f5f1e8", "#2b2a27", "#b4432f"
LAND, WATER = "#dfe3c8", "#c8d6da"

Array = NDArray[np.float64]


def sheet(columns: int, high: float = 4.6) -> tuple[Figure, list[Axes]]:
    """Return a figure with so many empty axes beside each other."""
    figure = Figure(figsize=(4.4 * columns, high), facecolor=PAPER, layout="constrained")
    found = list(figure.subplots(1, columns, squeeze=False)[0])
    for axes in found:
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure, found


def draw(axes: Axes, tri: liftmesh.ConstrainedTriangulation, color: str) -> None:
    """Fill the triangles, and draw the constraints over their sides."""
    corners = tri.points[tri.simplices]
    axes.add_collection(PolyCollection(corners, facecolors=color, edgecolors=INK, linewidths=0.15))
    lines = LineCollection(list(tri.points[tri.constraints]), colors=ACCENT, linewidths=0.8)
    axes.add_collection(lines)
    axes.autoscale_view()


def exact_area(ring: Array) -> Fraction:
    """Twice the area inside a ring, negative if it turns clockwise."""
    corners = [(Fraction(x), Fraction(y)) for x, y in ring.tolist()]
    return sum((a * d - b * c for (a, b), (c, d) in pairwise([*corners, corners[0]])), Fraction())


def coast() -> Figure:
    """A coast with lakes and islands in them, whole and carved."""
    rings = coastline(150, np.random.default_rng(8))
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings])
    lines = [np.arange(end - len(ring), end) for ring, end in zip(rings, ends, strict=True)]
    edges = np.concatenate([np.column_stack([line, np.roll(line, -1)]) for line in lines])
    whole = liftmesh.constrained_delaunay(points, edges)
    land = liftmesh.constrained_delaunay(points, edges, carve="holes")
    a, b, c = (points[land.simplices[:, k]] for k in range(3))
    area = float(abs(sum(map(exact_area, rings))) / 2)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    print(f"land: {len(land.simplices):,} triangles of {area:.12g}", end=", ")
    print(f"{float((ux * vy - uy * vx).sum() / 2):.12g} by the triangles")
    figure, (left, right) = sheet(2)
    for axes in (left, right):
        axes.set_facecolor(WATER)
    draw(left, whole, WATER)
    draw(right, land, LAND)
    left.set_title(f"edges of {len(rings)} rings", color=INK, fontsize=9)
    right.set_title('carve="holes"', color=INK, fontsize=9)
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {"coast": coast}


def main() -> None:
    """Draw the pictures that are named, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or PICTURES:
        path = FOLDER / f"{name}.png"
        PICTURES[name]().savefig(path, dpi=150, metadata={"Software": None})
        print(path.name)


if __name__ == "__main__":
    main()
