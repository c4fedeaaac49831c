"""Points with a metric for each along a wave, and what of their stars agrees."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.optional import load
from liftmesh.paper.pictures.style import (
    BLUE,
    INK,
    SKY,
    VERMILION,
    blank_axes,
    legend_below,
    new_figure,
    styled,
)
from liftmesh.planar.anisotropic import anisotropic_stars

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.planar.anisotropic import AnisotropicStars

COUNT = 140
RATIO = 4.0


def example_metrics(points: Floats) -> Floats:
    """Ask for triangles that are longer along a wave than across, near it."""
    x, y = points.T
    ratio = 1 + (RATIO - 1) * np.exp(-(((x - 0.5 + 0.1 * np.sin(6 * y)) / 0.25) ** 2))
    across = np.column_stack([np.ones(len(points)), 0.6 * np.cos(6 * y)])
    across /= np.hypot(*across.T)[:, None]
    xx, xy, yy = across[:, 0] ** 2, across[:, 0] * across[:, 1], across[:, 1] ** 2
    directions = np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)
    metrics: Floats = np.eye(2) + (ratio**2 - 1)[:, None, None] * directions
    return metrics


def example_points() -> Floats:
    """Return the points of the picture."""
    return np.random.default_rng(13).random((COUNT, 2))


@styled
def figure_stars() -> Figure:
    """Draw metrics as ellipses, and the triangles in the stars of all their corners."""
    points = example_points()
    stars = anisotropic_stars(points, example_metrics(points))
    figure = new_figure(5.2, 3.2)
    for column, (draw, text) in enumerate(
        ((_ellipses, "(a) a metric for each point"), (_triangles, "(b) triangles that agree"))
    ):
        axes = blank_axes(figure, (0.5 * column + 0.01, 0.17, 0.48, 0.82))
        axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02))
        draw(axes, stars)
        figure.text(0.25 + 0.5 * column, 0.11, text, ha="center")
    _legend(figure)
    return figure


def _legend(figure: Figure) -> None:
    line = load("matplotlib.lines", extra="plot").Line2D
    handles = [
        line([], [], color=SKY, lw=1.1, label="unit circle of the metric"),
        line([], [], color=INK, marker="o", ls="", ms=2.5, label="point"),
        line([], [], color=BLUE, lw=1.0, label="triangle of three stars"),
        line([], [], color=VERMILION, marker="o", ls="", ms=3, label="inconsistent star"),
    ]
    legend_below(figure, handles, fontsize=7.5, columnspacing=1.0)


def _ellipses(axes: Axes, stars: AnisotropicStars) -> None:
    patches = load("matplotlib.patches", extra="plot")
    for point, metric in zip(stars.points, stars.metrics, strict=True):
        squares, directions = np.linalg.eigh(metric)
        width, height = 0.08 / np.sqrt(squares)
        angle = np.degrees(np.arctan2(directions[1, 0], directions[0, 0]))
        axes.add_patch(patches.Ellipse(point, width, height, angle=angle, fc="none", ec=SKY))
    axes.plot(*stars.points.T, color=INK, marker="o", ls="", ms=1.6)


def _triangles(axes: Axes, stars: AnisotropicStars) -> None:
    polygons = load("matplotlib.collections", extra="plot").PolyCollection
    corners = list(stars.points[stars.simplices])
    axes.add_collection(
        polygons(corners, facecolors="#e8f3fb", edgecolors=BLUE, linewidths=0.7, gid="consistent")
    )
    open_rows = stars.points[stars.inconsistent]
    axes.plot(*open_rows.T, color=VERMILION, marker="o", ls="", ms=2.6, gid="inconsistent")
