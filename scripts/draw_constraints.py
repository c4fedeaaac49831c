"""Draw the pictures of lines in triangulations: ``python scripts/draw_constraints.py [NAME ...]``.

The coast is the contour of fractal noise, and the hills with their road are made up. The wing is
the section NACA 0012.
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
from scipy.spatial import cKDTree

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
    rows = np.sort(tri.simplices, axis=1)
    corners = tri.points[rows[np.lexsort(rows.T)]]  # whatever order the kernel has them in
    axes.add_collection(PolyCollection(corners, facecolors=color, edgecolors=INK, linewidths=0.15))
    lines = LineCollection(list(tri.points[tri.constraints]), colors=ACCENT, linewidths=0.8)
    axes.add_collection(lines)
    axes.autoscale_view()


def exact_area(ring: Array) -> Fraction:
    """Twice the area inside a ring, negative if it turns clockwise."""
    corners = [(Fraction(x), Fraction(y)) for x, y in ring.tolist()]
    return sum((a * d - b * c for (a, b), (c, d) in pairwise([*corners, corners[0]])), Fraction())


def rings_of_coast() -> tuple[list[Array], Array, Array]:
    """A coast with lakes and islands in them: its rings, their points and their edges."""
    rings = coastline(150, np.random.default_rng(8))
    ends = np.cumsum([len(ring) for ring in rings])
    lines = [np.arange(end - len(ring), end) for ring, end in zip(rings, ends, strict=True)]
    edges = np.concatenate([np.column_stack([line, np.roll(line, -1)]) for line in lines])
    return rings, np.concatenate(rings), edges


def coast() -> Figure:
    """The coast, whole and carved."""
    rings, points, edges = rings_of_coast()
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


def quality() -> Figure:
    """The land, refined, coloured by the smallest angles."""
    _, points, edges = rings_of_coast()
    land = liftmesh.constrained_delaunay(points, edges, carve="holes")
    fine = liftmesh.refine(land, min_angle=30)
    print(f"quality: {fine!r}, {len(land.simplices):,} before, valid: {bool(fine.verify())}")
    figure, sides = sheet(2, 5.35)
    for axes, tri, title in (
        (sides[0], land, "the land"),
        (sides[1], fine.triangulation, "min_angle=30"),
    ):
        axes.set_facecolor(WATER)
        shown = colored(axes, tri, smallest_angles(tri), "RdYlBu", (0, 60))
        axes.set_title(f"{title}: {len(tri.simplices):,} triangles", color=INK, fontsize=9)
    bar = figure.colorbar(
        shown, ax=sides, orientation="horizontal", shrink=0.4, aspect=40, pad=0.03
    )
    bar.set_label("smallest angle in degrees", color=INK, fontsize=8)
    bar.ax.tick_params(labelsize=8, colors=INK)
    return figure


def smallest_angles(tri: liftmesh.ConstrainedTriangulation) -> Array:
    """Return the smallest angle of each triangle in degrees."""
    corners = tri.points[tri.simplices]
    ahead = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    (ux, uy), (vx, vy) = ahead.transpose(2, 0, 1), back.transpose(2, 0, 1)
    return np.degrees(np.arctan2(ux * vy - uy * vx, ux * vx + uy * vy)).min(axis=1)


def colored(
    axes: Axes,
    tri: liftmesh.ConstrainedTriangulation,
    values: Array,
    colors: str,
    bounds: tuple[float, float],
) -> PolyCollection:
    """Fill the triangles with colours of values."""
    corners = tri.points[tri.simplices]
    shown = PolyCollection(corners, array=values, cmap=colors, edgecolors=INK, linewidths=0.1)
    shown.set_clim(*bounds)
    axes.add_collection(shown)
    lines = LineCollection(list(tri.points[tri.constraints]), colors=INK, linewidths=0.5)
    axes.add_collection(lines)
    axes.autoscale_view()
    return shown


def graded() -> Figure:
    """A wing in a channel, with edges that are short along it."""
    x = (1 - np.cos(np.linspace(0, np.pi, 60))) / 2
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    wing = np.concatenate([np.column_stack([x, half])[:-1], np.column_stack([x, -half])[:0:-1]])
    turn = np.array([[np.cos(0.2), -np.sin(0.2)], [np.sin(0.2), np.cos(0.2)]])
    wing @= turn
    channel = np.array([[-1.0, -1], [3, -1], [3, 1], [-1, 1]])
    nearest = cKDTree(wing)

    def size(places: Array) -> Array:
        return 0.008 + 0.15 * nearest.query(places)[0]

    mesh = liftmesh.refine([[channel, wing]], min_angle=30, size=size)
    print(f"graded: {mesh!r}, valid: {bool(mesh.verify())}")
    tri = mesh.triangulation
    sides = tri.points[tri.edges]
    lengths = np.hypot(*(sides[:, 1] - sides[:, 0]).T)
    share = lengths / size(sides.mean(axis=1))
    print(f"        edges from half to twice as long: {np.mean((share > 0.5) & (share < 2)):.2%}")
    figure, (axes,) = sheet(1, 4.6)
    figure.set_size_inches(8.8, 4.6)
    corners = tri.points[tri.simplices]
    longest = np.hypot(*(np.roll(corners, -1, axis=1) - corners).T).max(axis=0)
    colored(axes, tri, np.log(longest), "YlGnBu_r", (np.log(0.006), np.log(0.5)))
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {
    "coast": coast,
    "road": road,
    "quality": quality,
    "graded": graded,
}


def main() -> None:
    """Draw the pictures that are named, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or PICTURES:
        path = FOLDER / f"{name}.png"
        PICTURES[name]().savefig(path, dpi=150, metadata={"Software": None})
        print(path.name)


if __name__ == "__main__":
    main()
