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


def hills(count: int, rng: np.random.Generator) -> Array:
    """Scattered points over hills, of dyadic coordinates."""
    planar = rng.integers(0, 64 << 10, (count, 2)) / 1024
    x, y = planar.T / 9
    z = 8 + 3 * np.sin(x) * np.cos(y) + np.sin(2.3 * x + y)
    return np.column_stack([planar, np.round(z * 1024) / 1024])


def road() -> Figure:
    """Hills, and a road through them between hard breaklines."""
    cloud = hills(6000, np.random.default_rng(4))
    kerb = np.array([[4.0, 16, 8], [60, 44, 8 + 7 / 4]])
    ring = np.concatenate([kerb, kerb[::-1] + np.array([0, 8, 0]), kerb[:1]])
    across = cloud[:, 1] - cloud[:, 0] / 2 - 14
    is_on_it = (across >= 0) & (across <= 8) & (abs(cloud[:, 0] - 32) <= 28)
    before = liftmesh.triangulate(cloud)
    after = liftmesh.triangulate(cloud[~is_on_it], breaklines=ring, densify=4)
    x, share = np.meshgrid(np.arange(5, 60), np.arange(1, 16) / 16)
    found = after.sample(np.stack([x, 14 + x / 2 + 8 * share], axis=-1))
    print(f"road: {np.abs(found - (8 + (x - 4) / 32)).max():g} off in cross sections", end=", ")
    below = after.volume(within=ring[:, :2])
    print(f"{below.above!r} under it, {56 * 8 * (8 + 7 / 8)!r} by its corners", end=", ")
    works = before.cut_and_fill(after)
    print(f"cut {works.cut:.6g}, fill {works.fill:.6g}")
    figure, (left, right) = sheet(2, 4.7)
    for axes, surface, title in ((left, before, "the cloud"), (right, after, "breaklines=kerbs")):
        shade = surface.raster(0.1, quantity="hillshade").values
        axes.imshow(shade, cmap="gray", extent=(0, 64, 0, 64), vmin=90, vmax=250)
        axes.set_title(title, color=INK, fontsize=9)
    tri = after.triangulation
    sides = LineCollection(list(tri.points[tri.edges]), colors=INK, linewidths=0.12, alpha=0.6)
    right.add_collection(sides)
    lines = LineCollection(list(tri.points[tri.constraints]), colors=ACCENT, linewidths=0.9)
    right.add_collection(lines)
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {"coast": coast, "road": road}


def main() -> None:
    """Draw the pictures that are named, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or PICTURES:
        path = FOLDER / f"{name}.png"
        PICTURES[name]().savefig(path, dpi=150, metadata={"Software": None})
        print(path.name)


if __name__ == "__main__":
    main()
