"""Draw the pictures of docs/guide/cells.md: ``python scripts/draw_cells.py [NAME ...]``.

The city and its schools, the disks and the density are made up here. The photograph is the cat
Chelsea, which scikit-image includes as sample data, by its author, in the public domain (CC0).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import shapely
import shapely.affinity
import skimage.data
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection, PathCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.path import Path as Outline
from numpy.typing import NDArray
from PIL import Image

import liftmesh

FOLDER = Path(__file__).resolve().parent.parent / "data" / "cells"
PAPER, INK, ACCENT = "#f5f1e8", "#2b2a27", "#b4432f"
WATER = "#c8d6da"

Array = NDArray[np.float64]


def outline(shape: shapely.Geometry) -> Outline:
    """Convert a polygon, or several with holes, to what matplotlib fills."""
    paths = [
        Outline(shapely.get_coordinates(ring), closed=True)
        for part in shapely.get_parts(shape)
        for ring in (part.exterior, *part.interiors)
    ]
    return Outline.make_compound_path(*paths)


def draw(axes: Axes, cells: liftmesh.Cells, colors: object, width: float = 0.6) -> None:
    """Fill the cells that have an area."""
    shapes = cells.to_shapely()
    full = cells.areas > 0
    paths = [outline(shape) for shape in shapes[full]]
    tints = colors if isinstance(colors, str) else np.asarray(colors)[full]
    axes.add_collection(PathCollection(paths, facecolors=tints, edgecolors=INK, linewidths=width))


def sheet(columns: int, high: float = 4.0, back: str = PAPER) -> tuple[Figure, list[Axes]]:
    """Return a figure with so many empty axes beside each other."""
    figure = Figure(figsize=(4.4 * columns, high), facecolor=back, layout="constrained")
    found = figure.subplots(1, columns, squeeze=False)[0]
    for axes in found:
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure, list(found)


def fit(axes: Axes, domain: tuple[float, float, float, float]) -> None:
    """Show a box."""
    axes.set_xlim(domain[0], domain[2])
    axes.set_ylim(domain[1], domain[3])


def city() -> shapely.Geometry:
    """Make up a city at a bay, with a lake, and an island in the lake and one in the bay."""
    turn = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radius = 4 + 0.5 * np.sin(3 * turn) + 0.25 * np.sin(7 * turn + 1) + 0.08 * np.sin(23 * turn)
    land = shapely.Polygon(np.c_[1.25 * radius * np.cos(turn), radius * np.sin(turn)])
    bay = shapely.LineString([(6, -2), (2.4, -1.3), (0.6, -1.9)]).buffer(0.75)
    lake = shapely.affinity.scale(shapely.Point(-1.8, 1.1).buffer(1), 1.3, 0.8)
    islands = [shapely.Point(-1.8, 1.1).buffer(0.35), shapely.Point(3.4, -1.5).buffer(0.33)]
    return shapely.union_all([land - bay - lake, *islands])


def schools() -> Figure:
    """Draw districts of the nearest school, one of them on the island, and their sizes."""
    domain, rng = city(), np.random.default_rng(4)
    drawn = rng.uniform((-5.5, -4.5), (5.5, 4.5), (200, 2))
    sites = drawn[shapely.contains_xy(domain.buffer(-0.15), *drawn.T)][:42]
    sites = liftmesh.lloyd(sites, domain=domain, max_iter=1).points  # schools keep some distance
    figure, [axes] = sheet(1, 3.7, WATER)
    cells = liftmesh.voronoi(sites, domain=domain)
    shade = (cells.areas - cells.areas.min()) / np.ptp(cells.areas)
    tints = np.outer(1 - shade, (0.96, 0.93, 0.86)) + np.outer(shade, (0.83, 0.60, 0.47))
    draw(axes, cells, tints)
    axes.scatter(*sites.T, s=9, color=ACCENT, zorder=3)
    fit(axes, (-5.9, -5.0, 5.9, 4.6))
    return figure


def disks() -> Figure:
    """Draw power cells of disks: each pair of circles that cross does so on a side."""
    rng = np.random.default_rng(12)
    sites, radii = rng.random((28, 2)) * (4, 3), rng.random(28) ** 2 * 0.55 + 0.05
    box = (-0.6, -0.6, 4.6, 3.6)
    cells = liftmesh.power_diagram(sites, radii=radii, domain=box)
    figure, [axes] = sheet(1, 3.7)
    draw(axes, cells, "#fbf9f4", 0.9)
    circles = [Circle(tuple(site), radius) for site, radius in zip(sites, radii, strict=True)]
    axes.add_collection(
        PatchCollection(
            circles, facecolor=(0.71, 0.26, 0.18, 0.22), edgecolor=ACCENT, linewidth=0.9
        )
    )
    axes.scatter(*sites.T, s=7, color=[ACCENT if a else INK for a in cells.areas], zorder=3)
    fit(axes, box)
    return figure


def reach() -> Figure:
    """Draw transmitters of different reach in the city, and bubbles that grow until they meet."""
    domain, rng = city(), np.random.default_rng(9)
    drawn = rng.uniform((-5.5, -4.5), (5.5, 4.5), (200, 2))
    masts = drawn[shapely.contains_xy(domain.buffer(-0.2), *drawn.T)][:20]
    ranges = rng.random(len(masts)) ** 3 * 1.1 + 0.1
    grid = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0)), -1).reshape(-1, 2)
    seeds, sizes = grid + rng.random(grid.shape) * 0.55, rng.random(len(grid)) ** 2 * 0.42 + 0.03
    box = (-0.3, -0.3, 4.9, 3.9)
    figure, (left, right) = sheet(2, 3.7, WATER)
    for axes, centers, radii, area in ((left, masts, ranges, domain), (right, seeds, sizes, box)):
        cells = liftmesh.apollonius_diagram(centers, radii, domain=area)
        draw(axes, cells, "#fbf9f4", 0.9)
        disks = [Circle(tuple(c), r) for c, r in zip(centers, radii, strict=True)]
        tints = {"facecolor": (0.71, 0.26, 0.18, 0.22), "edgecolor": ACCENT}
        axes.add_collection(PatchCollection(disks, **tints, linewidth=0.9, zorder=2))
        hidden = np.isin(np.arange(len(centers)), cells.hidden)
        axes.scatter(*centers.T, s=7, color=np.where(hidden, INK, ACCENT), zorder=3)
    fit(left, (-5.9, -5.0, 5.9, 4.6))
    fit(right, box)
    return figure


def stipples() -> Figure:
    """Draw a photograph, and the points into which Lloyd's method turns it."""
    photograph = skimage.data.chelsea()[:300, 75:375]
    dark = np.clip(1.1 - photograph.mean(axis=2) / 180, 0.02, 1) ** 3
    domain, rng = (0, 0, 300, 300), np.random.default_rng(8)
    chosen = rng.choice(dark.size, 9000, p=dark.ravel() / dark.sum())
    row, column = np.divmod(chosen, 300)
    start = np.c_[column, 299 - row] + rng.random((9000, 2))
    found = liftmesh.lloyd(start, domain=domain, density=dark, max_iter=60)
    figure, (left, right) = sheet(2, 4.4)
    left.imshow(photograph, extent=(0, 300, 0, 300))
    right.scatter(*found.points.T, s=1.7, color=INK, linewidths=0)
    for axes in (left, right):
        fit(axes, domain)
    return figure


def transport() -> Figure:
    """Draw points with one share each of a density, before and after."""
    y, x = np.mgrid[0:120, 0:160] / 40
    density = 0.05 + sum(
        height * np.exp(-((x - u) ** 2 + (y - v) ** 2) / spread)
        for u, v, height, spread in ((1, 1, 1, 0.12), (2.8, 2, 1.6, 0.25), (3.2, 0.7, 0.8, 0.06))
    )
    box, sites = (0, 0, 4, 3), np.random.default_rng(21).random((260, 2)) * (4, 3)
    found = liftmesh.transport(sites, np.ones(260), domain=box, density=density)
    figure, (left, right) = sheet(2, 3.4)
    for axes, cells in ((left, liftmesh.voronoi(sites, domain=box)), (right, found.cells)):
        axes.imshow(density, extent=(0, 4, 0, 3), cmap="YlOrBr", alpha=0.75)
        draw(axes, cells, "none")
        fit(axes, box)
    return figure


def natural() -> Figure:
    """Draw the cell that a new point takes from its natural neighbours, and their weights."""
    sites, point = np.random.default_rng(8).random((26, 2)), np.array([[0.62, 0.3]])
    box = (0.0, 0.0, 1.0, 1.0)
    found = liftmesh.natural_neighbors(sites, point)
    weights = dict(zip(found.indices.tolist(), found.data.tolist(), strict=True))
    cells = liftmesh.voronoi(sites, domain=box)
    taken = liftmesh.voronoi(np.vstack([sites, point]), domain=box).to_shapely()[len(sites)]
    figure, [axes] = sheet(1)
    draw(axes, cells, "#fbf9f4", 0.9)
    for row, weight in weights.items():
        share = cells.to_shapely()[row] & taken
        tint = (0.71, 0.26, 0.18, 0.15 + 1.5 * weight)
        axes.add_collection(PathCollection([outline(share)], facecolor=tint, edgecolor=ACCENT))
        axes.annotate(f"{weight:.2f}", sites[row], xytext=(4, 3), textcoords="offset points")
    axes.scatter(*sites.T, s=9, color=INK, zorder=3)
    axes.scatter(*point.T, s=24, color=PAPER, edgecolors=INK, zorder=3)
    fit(axes, box)
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {
    "schools": schools, "disks": disks, "reach": reach, "stipples": stipples,
    "transport": transport, "natural": natural,
}  # fmt: skip


def main() -> None:
    """Draw the named pictures, or all."""
    FOLDER.mkdir(exist_ok=True)
    for name in sys.argv[1:] or PICTURES:
        path = FOLDER / f"{name}.png"
        PICTURES[name]().savefig(path, dpi=140, metadata={"Software": None})
        Image.open(path).convert("RGB").quantize(128).save(path, optimize=True)
        print(f"{path}: {path.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
