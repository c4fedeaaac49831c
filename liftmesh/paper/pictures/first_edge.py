"""Figure 3.1: v'_1, v'_2 and v'_n in the projection onto Oyz, for three sets of points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.paper.pictures.style import (
    ARROW,
    BLUE,
    FAINT,
    INK,
    SKY,
    SOFT,
    VERMILION,
    label,
    new_figure,
    styled,
)
from liftmesh.paper.propositions import FirstEdge, first_edge
from liftmesh.planar.delaunay import delaunay

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# Triangles of (y, z) that contain the projections.
OUTLINES = (
    ((0.3, 3.4), (2.0, 0.85), (3.9, 2.6)),
    ((0.2, 2.2), (3.9, 0.85), (2.5, 3.9)),
    ((2.0, 3.9), (0.6, 0.85), (4.1, 2.2)),
)
CASES = (
    "(a) $v_{2y} < v_{1y} < v_{ny}$:\n$[v_1, v_2]$ and $[v_1, v_n]$ are edges",
    "(b) $v_{1y} > \\max\\{v_{2y}, v_{ny}\\}$:\n$[v_1, v_2]$ is an edge",
    "(c) $v_{1y} < \\min\\{v_{2y}, v_{ny}\\}$:\n$[v_1, v_n]$ is an edge",
)


def example_points(case: int) -> Floats:
    """Return the points in space of one panel of Figure 3.1."""
    draws = np.random.default_rng(30 + case)
    weights = np.vstack([(0, 1, 0), draws.dirichlet((0.9, 0.9, 0.9), 19)])  # the lowest corner too
    return np.column_stack([draws.uniform(0, 4, 20), weights @ np.array(OUTLINES[case - 1])])


@styled
def figure_3_1() -> Figure:
    """Draw the three cases of v'_1, v'_2 and v'_n."""
    figure = new_figure(8.4, 3.4)
    for case, text in enumerate(CASES, 1):
        axes = figure.add_axes((0.01 + (case - 1) / 3, 0.02, 0.32, 0.9))
        points = example_points(case)
        _frame(axes)
        _projection(axes, points[:, 1:])
        _first(axes, points[:, 1:], first_edge(points.tolist()))
        axes.text(2.1, -0.75, text, ha="center", va="top", linespacing=1.4)
    return figure


def _frame(axes: Axes) -> None:
    """Draw Oy to the left and Oz up, from the lower right corner."""
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set(xlim=(4.9, -0.7), ylim=(-1.7, 4.5))
    for tip, name, away in (((4.6, 0), "$y$", (-2, -9)), ((0, 4.4), "$z$", (9, 0))):
        axes.annotate("", tip, (0, 0), arrowprops=ARROW)
        label(axes, tip, name, away)
    label(axes, (0, 0), "$O$", (7, -8))


def _projection(axes: Axes, projected: Floats) -> None:
    """Draw P' and its convex hull."""
    hull = delaunay(projected).convex_hull
    axes.fill(*projected[hull].T, fc=SKY, alpha=0.16, zorder=1, lw=0)
    axes.plot(*projected[np.append(hull, hull[0])].T, color=FAINT, lw=1.0, zorder=1.5)
    axes.plot(*projected.T, ls="none", marker="o", ms=3.2, mew=0, color=SOFT, gid="projected")


def _first(axes: Axes, projected: Floats, first: FirstEdge) -> None:
    """Draw the lines from v'_1, and the segments that are projections of lower edges."""
    ends = {"v2": ("$v_2^\\prime$", first.v2), "vn": ("$v_n^\\prime$", first.vn)}
    start = projected[first.v1]
    for gid, (name, row) in ends.items():
        lower = (first.v1, row) in first.edges
        color, style = (VERMILION, "-") if lower else (BLUE, (0, (4, 2.5)))
        axes.plot(*_beyond(start, projected[row]).T, color=color, lw=0.7, ls=(0, (1, 2)), zorder=2)
        segment = np.array([start, projected[row]])
        axes.plot(*segment.T, color=color, lw=2.0, ls=style, zorder=3, gid=gid)
        axes.plot(*projected[row], marker="o", ms=5.5, color=color, zorder=4)
        label(axes, projected[row], name, _outwards(projected, row))
    axes.plot(*start, marker="o", ms=6.5, color=INK, zorder=5, gid="v1")
    label(axes, start, "$v_1^\\prime$", _outwards(projected, first.v1))


def _beyond(start: Floats, through: Floats) -> Floats:
    """Return the half-line from one point through another, beyond the edge of the figure."""
    return np.array([start, start + 9 * (through - start) / np.linalg.norm(through - start)])


def _outwards(projected: Floats, row: int) -> tuple[float, float]:
    """Return the direction away from the centre of all points; the y-axis points to the left."""
    away = (projected[row] - projected.mean(axis=0)) * (-1, 1)
    x, y = 12 * away / np.linalg.norm(away)
    return float(x), float(y)
