"""A power diagram and its regular triangulation, of circles some of which are hidden.

The slopes of a lower facet of the lifted circles are twice the point of equal power of its three
corners: where three cells of the power diagram meet.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Indices
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
from liftmesh.planar.regular import regular

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.planar.regular import RegularTriangulation
    from liftmesh.planar.triangulation import Triangulation

COUNT = 34
LIMITS = (-1.7, 11.7)
_FAR = 40.0


def example_circles() -> tuple[Floats, Floats]:
    """Return the circles of the picture."""
    rng = np.random.default_rng(9)
    return rng.uniform(0.0, 10.0, (COUNT, 2)), rng.gamma(2.0, 0.45, COUNT)


def power_centers(triangulation: Triangulation) -> Floats:
    """Compute the points of equal power of the corners of each triangle."""
    planes = triangulation.equations
    centers: Floats = planes[:, :2] / (-2 * planes[:, 2:3])
    return centers


@styled
def figure_power() -> Figure:
    """Draw circles, the regular triangulation of their centres, and their power diagram."""
    figure = new_figure(6.6, 3.85)
    centers, radii = example_circles()
    found = regular(centers, radii=radii)
    for column, draw in enumerate((_triangles, _cells)):
        axes = blank_axes(figure, (0.5 * column, 0.165, 0.5, 0.83))
        axes.set(xlim=LIMITS, ylim=LIMITS)
        _circles(axes, found, radii)
        draw(axes, found)
    figure.text(0.25, 0.12, "(a) regular triangulation", ha="center")
    figure.text(0.75, 0.12, "(b) power diagram", ha="center")
    _legend(figure)
    return figure


def _circles(axes: Axes, found: RegularTriangulation, radii: Floats) -> None:
    patches = load("matplotlib.patches", extra="plot")
    is_hidden = np.isin(np.arange(found.npoints), found.hidden)
    for center, radius, hidden in zip(found.points, radii, is_hidden, strict=True):
        line: dict[str, Any] = {"ec": VERMILION, "ls": (0, (3, 2))} if hidden else {"ec": SKY}
        fill = "none" if hidden else (*_shade(SKY), 0.13)
        axes.add_patch(patches.Circle(center, radius, fc=fill, lw=1.1, **line))
    marks: dict[str, Any] = {"marker": "o", "ls": "", "ms": 3.0, "mew": 0.0, "zorder": 6}
    axes.plot(*found.points[~is_hidden].T, color=INK, gid="vertices", **marks)
    axes.plot(*found.points[is_hidden].T, color=VERMILION, gid="hidden", **marks)


def _shade(color: str) -> tuple[float, float, float]:
    red, green, blue = load("matplotlib.colors", extra="plot").to_rgb(color)
    return red, green, blue


def _triangles(axes: Axes, found: RegularTriangulation) -> None:
    lines = load("matplotlib.collections", extra="plot").LineCollection
    edges = found.points[found.edges]
    axes.add_collection(lines(list(edges), colors=BLUE, linewidths=1.0, gid="edges"))


def _cells(axes: Axes, found: RegularTriangulation) -> None:
    lines = load("matplotlib.collections", extra="plot").LineCollection
    axes.add_collection(lines(list(cell_sides(found)), colors=INK, linewidths=1.1, gid="cells"))


def cell_sides(found: Triangulation, *, inward: bool = False) -> Floats:
    """Compute the sides of the power cells; those without end are cut off far away."""
    centers = power_centers(found)
    far = -_FAR if inward else _FAR
    triangle, corner = np.nonzero(found.neighbors < np.arange(found.nsimplex)[:, None])
    beyond = found.neighbors[triangle, corner]
    ends = np.where(
        (beyond >= 0)[:, None],
        centers[beyond],
        centers[triangle] + far * _outward(found, triangle, corner),
    )
    return np.stack([centers[triangle], ends], axis=1)


def _outward(found: Triangulation, triangle: Indices, corner: Indices) -> Floats:
    """Unit vectors to the right of the edges opposite to corners."""
    start = found.points[found.simplices[triangle, (corner + 1) % 3]]
    end = found.points[found.simplices[triangle, (corner + 2) % 3]]
    right = (end - start)[:, ::-1] * (1.0, -1.0)
    unit: Floats = right / np.hypot(*right.T)[:, None]
    return unit


def _legend(figure: Figure) -> None:
    line = load("matplotlib.lines", extra="plot").Line2D
    handles = [
        line([], [], color=SKY, lw=1.1, label="circle"),
        line([], [], color=VERMILION, lw=1.1, ls=(0, (3, 2)), label="hidden circle"),
        line([], [], color=BLUE, lw=1.0, label="edge"),
        line([], [], color=INK, lw=1.1, label="side of a cell"),
    ]
    legend_below(figure, handles)
