"""Draw the picture of points in space in README.md: ``python scripts/draw_space.py``."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LightSource, to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from numpy.typing import NDArray

import liftmesh

TARGET = Path(__file__).resolve().parent.parent / "data" / "space.png"
PAPER, INK, GOLD = "#f5f1e8", "#2b2a27", "#d9a441"

Array = NDArray[np.float64]


def torus(n: int) -> Array:
    """Random points in a ring."""
    rng = np.random.default_rng(5)
    turn, around = rng.random((2, n)) * 2 * np.pi
    reach = np.sqrt(rng.random(n)) * 0.9
    wide = 2.4 + reach * np.cos(around)
    return np.column_stack([wide * np.cos(turn), wide * np.sin(turn), reach * np.sin(around)])


def shaded(corners: Array, color: str) -> Array:
    """Colours of triangles, by how much they face the light."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    light = LightSource(azdeg=300, altdeg=50).shade_normals(normals)
    return np.clip(np.array(to_rgb(color)) * (0.45 + 0.6 * light[:, None]), 0, 1)


def draw_shape(axes: Axes3D) -> None:
    """The alpha surface of points in a ring."""
    points = torus(6000)
    corners = points[liftmesh.alpha_shape(points, 0.42).faces]
    faces = Poly3DCollection(corners, facecolors=shaded(corners, GOLD), edgecolors=INK, lw=0.15)
    axes.add_collection3d(faces)
    axes.set(xlim=(-2.6, 2.6), ylim=(-2.6, 2.6), zlim=(-1.4, 1.4))
    axes.set_box_aspect((5.2, 5.2, 2.8), zoom=1.1)
    axes.view_init(elev=38, azim=-50)


def draw_cells(axes: Axes3D) -> None:
    """Cells on the sphere, darker where they are smaller."""
    rng = np.random.default_rng(2)
    dense = rng.normal(size=(120, 3)) * 0.25 + (1, -1, 0.6)
    globe = liftmesh.spherical_delaunay(np.vstack([rng.normal(size=(250, 3)), dense]))
    towns = globe.points / np.linalg.norm(globe.points, axis=1)[:, None]
    sizes = np.log(globe.areas)
    tints = mpl.colormaps["YlOrBr_r"](0.25 + 0.7 * (sizes - sizes.min()) / np.ptp(sizes))
    turn = np.deg2rad(-50)
    height = towns @ (np.cos(turn), np.sin(turn), 0.45)  # above the middle, from the eye
    starts, ring = globe.cells
    front = np.flatnonzero(height > -0.05)
    cells = [globe.centers[ring[starts[row] : starts[row + 1]]] for row in front]
    faces = Poly3DCollection(cells, facecolors=tints[front], edgecolors=INK, lw=0.5)
    axes.add_collection3d(faces)
    axes.scatter(*(towns[height > 0.1] * 1.01).T, s=1.5, c=INK, depthshade=False)
    axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    axes.set_box_aspect((1, 1, 1), zoom=1.6)
    axes.view_init(elev=20, azim=-50)


def main() -> None:
    """Draw both beside each other."""
    figure = Figure(figsize=(9, 4.2), facecolor=PAPER, layout="constrained")
    left, right = figure.subplots(1, 2, subplot_kw={"projection": "3d"})
    draw_shape(left)
    draw_cells(right)
    for axes in (left, right):
        axes.set_axis_off()
        axes.set_facecolor(PAPER)
    figure.savefig(TARGET, dpi=100)


if __name__ == "__main__":
    main()
