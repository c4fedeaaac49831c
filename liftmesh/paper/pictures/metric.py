"""The same points triangulated in the metric of the plane and in another constant one.

In a metric the circles through three points are ellipses of one shape; those of the triangles are
empty.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from liftmesh.planar.delaunay import delaunay

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.planar.triangulation import Triangulation

METRIC = ((1.0, 1.2), (1.2, 3.0))
_SHOWN = 5  # circles
_LIMITS = (-0.6, 10.6)


def metric_points() -> Floats:
    """Return the points of the picture."""
    return np.random.default_rng(4).uniform(0.0, 10.0, (40, 2))


def circle_through(corners: Floats, metric: Floats, count: int = 181) -> Floats:
    """Compute the circle of a metric through three points."""
    a, b, c = corners
    heights = np.einsum("ni,ij,nj->n", corners, metric, corners)
    center = np.linalg.solve(2 * np.array([b - a, c - a]) @ metric, heights[1:] - heights[0])
    radius = np.sqrt((a - center) @ metric @ (a - center))
    angles = np.linspace(0.0, 2 * np.pi, count)
    root = np.linalg.inv(np.linalg.cholesky(metric)).T
    around: Floats = center + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1) @ root.T
    return around


@styled
def figure_metric() -> Figure:
    """Draw Delaunay triangulations in two metrics, with the empty circles of some triangles."""
    figure = new_figure(7.2, 4.2)
    points = metric_points()
    for column, metric in enumerate((((1.0, 0.0), (0.0, 1.0)), METRIC)):
        axes = blank_axes(figure, (0.5 * column, 0.17, 0.5, 0.83))
        axes.set(xlim=_LIMITS, ylim=_LIMITS)
        _draw_circles(axes, delaunay(points, metric=metric), np.array(metric))
    figure.text(0.25, 0.12, r"(a) $x^2 + y^2$", ha="center")
    figure.text(0.75, 0.12, r"(b) $x^2 + 2.4\,xy + 3\,y^2$", ha="center")
    _metric_legend(figure)
    return figure


def _draw_circles(axes: Axes, found: Triangulation, metric: Floats) -> None:
    lines = load("matplotlib.collections", extra="plot").LineCollection
    corners = found.points[found.simplices]
    circles = [circle_through(each, metric) for each in corners]
    inside = [k for k, each in enumerate(circles) if is_inside(each)]
    for k in inside[:: max(len(inside) // _SHOWN, 1)][:_SHOWN]:
        axes.fill(*circles[k].T, fc=ORANGE, alpha=0.16, lw=0)
        axes.fill(*corners[k].T, fc=ORANGE, alpha=0.4, lw=0)
        axes.plot(*circles[k].T, color=ORANGE, lw=1.2, gid=f"circle {k}")
    axes.add_collection(
        lines(list(found.points[found.edges]), colors=BLUE, linewidths=1.0, gid="edges")
    )
    axes.plot(*found.points.T, marker="o", ls="", ms=3.0, color=INK, mew=0, zorder=6, gid="points")


def is_inside(circle: Floats) -> bool:
    """Whether a circle is within the picture."""
    return bool((circle > _LIMITS[0]).all() and (circle < _LIMITS[1]).all())


def _metric_legend(figure: Figure) -> None:
    line = load("matplotlib.lines", extra="plot").Line2D
    patch = load("matplotlib.patches", extra="plot").Patch
    handles = [
        line([], [], color=INK, marker="o", ls="", ms=3.6, label="point"),
        line([], [], color=BLUE, lw=1.0, label="edge"),
        line([], [], color=ORANGE, lw=1.2, label="empty circle of the metric"),
        patch(fc=ORANGE, alpha=0.5, lw=0, label="its triangle"),
    ]
    legend_below(figure, handles)
