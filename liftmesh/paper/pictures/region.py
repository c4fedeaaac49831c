"""Figures 3.1 and 4.3: the first edge, and the points that the extents of the ellipse (E) classify.

Figure 3.1 has v'_1, v'_2 and v'_n in the projection onto Oyz, for three sets of points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.paper.pictures.cross_section import CORNERS, SECTION, VIEW, CrossSection, draw_section
from liftmesh.paper.pictures.style import (
    ARROW,
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    SKY,
    SOFT,
    VERMILION,
    Space,
    blank_axes,
    captions,
    label,
    new_figure,
    on_ground,
    styled,
)
from liftmesh.paper.propositions import FirstEdge, first_edge
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.lifting import lift

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


KINDS = {
    "4.4: below": (("4.4",), GREEN, "v"),
    "4.3 (i)\N{EN DASH}(iv): above": (("4.3 (i)", "4.3 (ii)", "4.3 (iii)", "4.3 (iv)"), SOFT, "^"),
    "4.3 (v): above": (("4.3 (v)",), PURPLE, "D"),
    "left to a dot product": (("",), INK, "o"),
}


@styled
def figure_4_3() -> Figure:
    """Draw the ellipse (E), the circle (C), and the points that their extents classify."""
    figure = new_figure(9.0, 4.6)
    space = Space(blank_axes(figure, (0.0, 0.04, 0.5, 0.96)), VIEW)
    draw_section(space)
    box = _box_corners(SECTION)
    _box(space.axes, space.view.flat(on_ground(box)))
    _above_and_below(space)
    plan = blank_axes(figure, (0.5, 0.15, 0.49, 0.84))
    _plan(plan, SECTION)
    captions(figure, 0.015, {0.25: "(a)", 0.745: "(b)"})
    return figure


def _box_corners(section: CrossSection) -> Floats:
    """Return the bounding box of the circle (C) as a closed line."""
    (left, right), (front, back), _ = section.box
    return np.array([(left, front), (right, front), (right, back), (left, back), (left, front)])


def _box(axes: Axes, corners: Floats) -> None:
    axes.plot(*corners.T, color=BLUE, lw=1.1, ls=(0, (5, 2)), zorder=1.7, gid="box")


def _above_and_below(space: Space) -> None:
    """Draw the point t with t' outside (C), and u with u' inside."""
    for text, position in (("t", (1.7, 0.3)), ("u", (0.5, 0.6))):
        (point,) = lift([position], SECTION.q)
        space.line([point, point * (1, 1, 0)], color=SOFT, lw=0.8, ls=(0, (3, 2)), zorder=3)
        space.dots([point, point * (1, 1, 0)], color=PURPLE if text == "t" else GREEN, ms=5)
        space.name(point, f"${text}$", (11, 3))
        space.name(point * (1, 1, 0), f"${text}'$", (11, 3))


def plan_points() -> Floats:
    """Return the planar points of Figure 4.3 (b)."""
    return np.random.default_rng(43).uniform((-1.0, -1.05), (1.85, 1.3), (110, 2))


def _plan(axes: Axes, section: CrossSection) -> None:
    """Draw the restricted region from above: box, (C), and the circles of max z_E and min z_E."""
    axes.fill(*section.circle().T, fc=ORANGE, alpha=0.2, lw=0, zorder=1)
    axes.plot(*section.circle().T, color=VERMILION, lw=1.8, zorder=2, gid="C")
    label(axes, section.center, r"$(\mathcal{C})$", (0, -40), color=VERMILION)
    _box(axes, _box_corners(section))
    _bounds(axes, section)
    points = plan_points()
    decided = section.decided_by(points)
    for text, (names, color, marker) in KINDS.items():
        look: dict[str, Any] = {"marker": marker, "color": color, "ls": "none", "ms": 4.2, "mew": 0}
        axes.plot(*points[np.isin(decided, names)].T, label=text, gid=text, **look)
    axes.plot(*section.q, marker="o", ms=5.5, color=ORANGE, mec=INK, mew=0.7, zorder=5)
    label(axes, section.q, "$q$", (8, -9))
    axes.plot(*CORNERS.T, ls="none", marker="o", ms=5.5, color=VERMILION, mec=INK, zorder=5)
    for corner, text, away in zip(CORNERS, "abp", ((13, -2), (-2, 13), (-8, -12)), strict=True):
        label(axes, corner, f"${text}'$", away)
    axes.set(xlim=(-1.45, 2.0), ylim=(-1.4, 1.4))
    place: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.01)}
    axes.legend(**place, ncols=2, frameon=False, handletextpad=0.2)


def _bounds(axes: Axes, section: CrossSection) -> None:
    """Draw the circles around q with z = min z_E and z = max z_E, and label all six bounds."""
    (left, _), (front, back), heights = section.box
    around = (section.circle() - section.center) / section.radius
    for height, color, name in zip(heights, (GREEN, PURPLE), ("min", "max"), strict=True):
        circle = np.sqrt(height) * around + section.q
        axes.plot(*circle.T, color=color, lw=1.1, ls=(0, (2, 1.5)), zorder=2, gid=f"{name} z")
        away = (0, 9) if name == "min" else (-21, -4)
        label(
            axes,
            circle[100 if name == "max" else 45],
            rf"$\{name}\, z_E$",
            away,
            color=color,
            fontsize=10.5,
        )
    right = 2 * section.center[0] - left
    names = {
        r"$\max\, y_E$": ((left, back), (20, 8), 0),
        r"$\min\, y_E$": ((right, front), (-20, -9), 0),
        r"$\min\, x_E$": ((left, front), (-9, 22), 90),
        r"$\max\, x_E$": ((right, back), (10, -22), 90),
    }
    for text, (at, away, turn) in names.items():
        label(axes, at, text, away, color=BLUE, fontsize=10.5, rotation=turn)


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
