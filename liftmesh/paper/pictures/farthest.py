"""The farthest-point Delaunay triangulation, and the diagram of which point is farthest.

The triangulation is the upper hull of the lifted points: every point lies in the circle of every
triangle. The centres of these circles are the corners of the diagram, whose cells belong to the
corners of the convex hull.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.optional import load
from liftmesh.paper.pictures.anisotropic import circle_through
from liftmesh.paper.pictures.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    YELLOW,
    blank_axes,
    captions,
    draw_lines,
    legend_below,
    line_key,
    new_figure,
    styled,
)
from liftmesh.paper.pictures.weighted import cell_sides
from liftmesh.planar.delaunay import solve_farthest, triangulation_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.planar.triangulation import Triangulation

COUNT = 26
_SHOWN = (0, 2)  # of the circles, which are sorted by their size
_LIMITS = (-1.5, 1.5)
_PIXELS = 600
_SHADES = (SKY, ORANGE, GREEN, PURPLE, YELLOW, BLUE, VERMILION, FAINT)


def example_points() -> Floats:
    """Return the points of the picture."""
    rng = np.random.default_rng(23)
    radius, angle = np.sqrt(rng.random(COUNT)), rng.uniform(0.0, 2 * np.pi, COUNT)
    around: Floats = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return radius[:, None] * around


def farthest_points(points: Floats) -> tuple[Triangulation, Rows]:
    """Compute the farthest-point Delaunay triangulation."""
    solution = solve_farthest(points)
    return triangulation_of(solution), solution.hidden


@styled
def figure_farthest() -> Figure:
    """Draw a farthest-point Delaunay triangulation with two of its circles, and the diagram."""
    figure = new_figure(7.2, 4.2)
    mesh, hidden = farthest_points(example_points())
    for column, draw in enumerate((_triangles, _cells)):
        axes = blank_axes(figure, (0.5 * column + 0.02, 0.18, 0.46, 0.79), _LIMITS)
        draw(axes, mesh)
        _points(axes, mesh, hidden)
    texts = {0.25: "(a) farthest-point Delaunay", 0.75: "(b) in the colour of the farthest corner"}
    captions(figure, 0.12, texts)
    legend_below(
        figure,
        line_key("corner", marker="o", ls="", ms=6.0, mec=INK, mew=0.9, mfc=SKY),
        line_key("hidden point", marker="o", ls="", ms=3.6, mew=0.0, color=VERMILION),
        line_key("edge", color=BLUE, lw=1.0),
        line_key("circle around all points", color=ORANGE, lw=1.2),
        line_key("side of a cell", color=INK, lw=1.1),
        columnspacing=1.2,
        handletextpad=0.5,
    )
    return figure


def _points(axes: Axes, mesh: Triangulation, hidden: Rows) -> None:
    marks: dict[str, Any] = {"marker": "o", "ls": "", "zorder": 6}
    axes.plot(*mesh.points[hidden].T, ms=3.0, mew=0.0, color=VERMILION, gid="hidden", **marks)
    for row, shade in zip(corners(mesh), _SHADES, strict=False):
        style: dict[str, Any] = {"ms": 6.0, "mec": INK, "mew": 0.9, "mfc": shade}
        axes.plot(*mesh.points[row], gid=f"corner {row}", **style, **marks)


def corners(mesh: Triangulation) -> Rows:
    """Return the corners of the convex hull, counter-clockwise."""
    return mesh.convex_hull


def _triangles(axes: Axes, mesh: Triangulation) -> None:
    three = mesh.points[mesh.simplices]
    circles = [circle_through(each, np.eye(2)) for each in three]
    by_size = np.argsort([np.ptp(each[:, 0]) for each in circles])
    for k, color in zip(by_size[[*_SHOWN]], (ORANGE, GREEN), strict=True):
        axes.fill(*three[k].T, fc=color, alpha=0.25, lw=0)
        axes.plot(*circles[k].T, color=color, lw=1.2, gid=f"circle {k}")
    draw_lines(axes, mesh.points[mesh.edges], BLUE, 1.0, "edges")


def _cells(axes: Axes, mesh: Triangulation) -> None:
    """Shade every place in the colour of the corner that is farthest from it."""
    to_rgb = load("matplotlib.colors", extra="plot").to_rgb
    side = (np.arange(_PIXELS) + 0.5) / _PIXELS * (_LIMITS[1] - _LIMITS[0]) + _LIMITS[0]
    sites = mesh.points[corners(mesh)]
    distances = (side[None, :, None] - sites[:, 0]) ** 2 + (side[:, None, None] - sites[:, 1]) ** 2
    shades = 1.0 - 0.45 * (1.0 - np.array([to_rgb(shade) for shade in _SHADES]))
    axes.imshow(
        shades[distances.argmax(axis=2) % len(shades)],
        origin="lower",
        extent=(*_LIMITS, *_LIMITS),
        interpolation="nearest",
        gid="cells",
    )
    draw_lines(axes, cell_sides(mesh, inward=True), INK, 1.1, "sides")
