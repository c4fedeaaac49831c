"""Draw the picture of points in space in space.md: ``python scripts/draw_space.py``."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
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


def arcs(corners: Array) -> Array:
    """The ring of these corners on the sphere, with points along its great circles."""
    steps = np.linspace(0, 1, 12, endpoint=False)[:, None]
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    ring = np.concatenate([a * (1 - steps) + b * steps for a, b in sides])
    return np.asarray(ring / np.linalg.norm(ring, axis=1)[:, None])


def draw_cells(axes: Axes) -> None:
    """Cells on the sphere, darker where they are smaller, the farthest first."""
    rng = np.random.default_rng(2)
    dense = rng.normal(size=(120, 3)) * 0.25 + (1, -1, 0.6)
    globe = liftmesh.spherical_delaunay(np.vstack([rng.normal(size=(250, 3)), dense]))
    towns = globe.points / np.linalg.norm(globe.points, axis=1)[:, None]
    sizes = np.log(globe.areas)
    tints = mpl.colormaps["YlOrBr_r"](0.25 + 0.7 * (sizes - sizes.min()) / np.ptp(sizes))
    azimuth, height = np.deg2rad((-50, 20))
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    level = np.cos(height) * np.array([np.cos(azimuth), np.sin(azimuth)])
    eye = np.array([*level, np.sin(height)])
    seen = np.column_stack([right, np.cross(eye, right)])
    depth = towns @ eye
    starts, ring = globe.cells
    rows = np.argsort(depth)
    cells = [arcs(globe.centers[ring[starts[row] : starts[row + 1]]]) @ seen for row in rows]
    axes.add_collection(PolyCollection(cells, facecolors=tints[rows], edgecolors=INK, lw=0.5))
    across, up = (towns[depth > 0] @ seen).T
    axes.scatter(across, up, s=1.5, c=INK, zorder=2)
    axes.set(xlim=(-1.02, 1.02), ylim=(-1.02, 1.02), aspect="equal")


def main() -> None:
    """Draw both beside each other."""
    figure = Figure(figsize=(9, 4.2), facecolor=PAPER, layout="constrained")
    left = figure.add_subplot(1, 2, 1, projection="3d")
    right = figure.add_subplot(1, 2, 2)
    draw_shape(left)
    draw_cells(right)
    for axes in (left, right):
        axes.set_axis_off()
        axes.set_facecolor(PAPER)
    figure.savefig(TARGET, dpi=100)


if __name__ == "__main__":
    main()
