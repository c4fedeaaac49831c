"""Adaptive thinning of an image: long, thin triangles along its edges.

The paper cites L. Demaret and A. Iske for anisotropic Delaunay triangulations. Theirs come from
the choice of points: of the pixels of an image those stay without which linear interpolation would
lose most.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.optional import load
from liftmesh.paper.pictures.style import (
    BLUE,
    INK,
    ORANGE,
    blank_axes,
    legend_below,
    new_figure,
    styled,
)
from liftmesh.terrain.thinning import thin
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = 64
KEPT = 110
STEEP = 0.05  # brightness per pixel, in a triangle across an edge


def example_image() -> Floats:
    """Return the brightness of the picture: a shaded disc in front of a slope, and a wavy edge."""
    x, y = np.meshgrid(np.arange(SIZE) / SIZE, np.arange(SIZE) / SIZE)
    wave = np.where(y > 0.24 + 0.08 * np.sin(7 * x), 0.55 + 0.25 * x, 0.12)
    is_disc = (x - 0.56) ** 2 + (y - 0.6) ** 2 < 0.26**2
    image: Floats = np.where(is_disc, 0.1 + 0.5 * (y - 0.3), wave)
    return image


def thinned_image(kept: int = KEPT) -> Floats:
    """Return the pixels that adaptive thinning keeps."""
    image = example_image()
    rows, columns = np.indices(image.shape)
    pixels = np.column_stack([columns.ravel(), rows.ravel(), image.ravel()]).astype(float)
    points: Floats = thin(pixels, adaptive=kept).points
    return points


@styled
def figure_adaptive() -> Figure:
    """Draw an image, the triangles of the pixels that stay, and the image that these make."""
    figure = new_figure(7.6, 3.2)
    points = thinned_image()
    found: Any = triangulate(points).to_matplotlib()
    shown: dict[str, Any] = {"cmap": "gray", "vmin": 0.0, "vmax": 1.0}
    titles = ("(a) 4,096 pixels", f"(b) triangles of {KEPT} of them", "(c) interpolated")
    for column, title in enumerate(titles):
        axes: Any = blank_axes(figure, (column / 3 + 0.01, 0.22, 0.313, 0.76))
        axes.set(xlim=(-0.5, SIZE - 0.5), ylim=(-0.5, SIZE - 0.5))
        if column == 0:
            axes.imshow(example_image(), origin="lower", **shown)
        elif column == 1:
            _draw_triangles(axes, found, points)
        else:
            axes.tripcolor(found, points[:, 2], shading="gouraud", rasterized=True, **shown)
        figure.text(column / 3 + 1 / 6, 0.15, title, ha="center")
    _image_legend(figure)
    return figure


def _draw_triangles(axes: Any, found: Any, points: Floats) -> None:
    corners = points[found.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for each in corners[np.hypot(across[:, 0], across[:, 1]) > STEEP * across[:, 2]]:
        axes.fill(*each[:, :2].T, fc=ORANGE, alpha=0.55, lw=0)
    axes.triplot(found, color=BLUE, lw=0.7)
    axes.plot(*points[:, :2].T, marker="o", ls="", ms=1.8, color=INK, mew=0, zorder=6)


def _image_legend(figure: Figure) -> None:
    line = load("matplotlib.lines", extra="plot").Line2D
    patch = load("matplotlib.patches", extra="plot").Patch
    handles = [
        line([], [], color=INK, marker="o", ls="", ms=2.6, label="pixel that stays"),
        line([], [], color=BLUE, lw=0.9, label="edge"),
        patch(fc=ORANGE, alpha=0.6, lw=0, label="triangle across an edge of the image"),
    ]
    legend_below(figure, handles)
