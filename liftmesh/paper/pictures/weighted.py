"""Circles and disks, a power diagram and the graph and cells of disks; and farthest points.

The slopes of a lower facet of the lifted circles are twice the point of equal power of its three
corners: where three cells of the power diagram meet.

By Lemma 4.2 a plane that supports the lifted disks from below, and touches three of them, is a
circle that touches three disks from outside and that no disk enters: `liftmesh.paper.propositions`.

The farthest-point Delaunay triangulation is the upper hull of the lifted points: every point lies
in the circle of every triangle. The centres of these circles are the corners of the diagram, whose
cells belong to the corners of the convex hull.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Indices, Rows
from liftmesh.disks.apollonius import ApolloniusGraph, apollonius
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
    space_axes,
    styled,
    unit_circle,
)
from liftmesh.planar.delaunay import solve_farthest, triangulation_of
from liftmesh.planar.regular import RegularTriangulation, regular

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.planar.triangulation import Triangulation

COUNT = 34
_LIMITS = (-1.7, 11.7)
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
    mesh = regular(centers, radii=radii)
    for column, draw in enumerate((_edges, _sides)):
        axes = blank_axes(figure, (0.5 * column, 0.165, 0.5, 0.83), _LIMITS)
        _circles(axes, mesh, radii)
        draw(axes, mesh)
    captions(figure, 0.12, {0.25: "(a) regular triangulation", 0.75: "(b) power diagram"})
    legend_below(
        figure,
        line_key("circle", color=SKY, lw=1.1),
        line_key("hidden circle", color=VERMILION, lw=1.1, ls=(0, (3, 2))),
        line_key("edge", color=BLUE, lw=1.0),
        line_key("side of a cell", color=INK, lw=1.1),
    )
    return figure


def _circles(axes: Axes, mesh: RegularTriangulation, radii: Floats) -> None:
    patches = load("matplotlib.patches", extra="plot")
    is_hidden = np.isin(np.arange(mesh.npoints), mesh.hidden)
    for center, radius, hidden in zip(mesh.points, radii, is_hidden, strict=True):
        line: dict[str, Any] = {"ec": VERMILION, "ls": (0, (3, 2))} if hidden else {"ec": SKY}
        fill = "none" if hidden else (*_shade(SKY), 0.13)
        axes.add_patch(patches.Circle(center, radius, fc=fill, lw=1.1, **line))
    marks: dict[str, Any] = {"marker": "o", "ls": "", "ms": 3.0, "mew": 0.0, "zorder": 6}
    axes.plot(*mesh.points[~is_hidden].T, color=INK, gid="vertices", **marks)
    axes.plot(*mesh.points[is_hidden].T, color=VERMILION, gid="hidden", **marks)


def _shade(color: str) -> tuple[float, float, float]:
    red, green, blue = load("matplotlib.colors", extra="plot").to_rgb(color)
    return red, green, blue


def _edges(axes: Axes, mesh: RegularTriangulation) -> None:
    draw_lines(axes, mesh.points[mesh.edges], BLUE, 1.0, "edges")


def _sides(axes: Axes, mesh: RegularTriangulation) -> None:
    draw_lines(axes, cell_sides(mesh), INK, 1.1, "cells")


def cell_sides(mesh: Triangulation, *, inward: bool = False) -> Floats:
    """Compute the sides of the power cells; those without end are cut off far away."""
    # These go inward where the triangulation is that of farthest points.
    centers = power_centers(mesh)
    far = -_FAR if inward else _FAR
    triangle, corner = np.nonzero(mesh.neighbors < np.arange(mesh.nsimplex)[:, None])
    beyond = mesh.neighbors[triangle, corner]
    ends = np.where(
        (beyond >= 0)[:, None],
        centers[beyond],
        centers[triangle] + far * _outward(mesh, triangle, corner),
    )
    return np.stack([centers[triangle], ends], axis=1)


def _outward(mesh: Triangulation, triangle: Indices, corner: Indices) -> Floats:
    """Unit vectors to the right of the edges opposite to corners."""
    start = mesh.points[mesh.simplices[triangle, (corner + 1) % 3]]
    end = mesh.points[mesh.simplices[triangle, (corner + 2) % 3]]
    right = (end - start)[:, ::-1] * (1.0, -1.0)
    unit: Floats = right / np.hypot(*right.T)[:, None]
    return unit


_DISK_LIMITS = (-1.2, 9.0)
_GROUND = -1.4  # height at which disks are drawn below the paraboloid
_DISJOINT = [[-0.9, -0.5, 0.45], [0.9, -0.6, 0.3], [0.1, 0.95, 0.5], [1.3, 0.8, 0.25]]


def example_disks(*, overlapping: bool) -> tuple[Floats, Floats]:
    """Return the disks of the picture."""
    rng = np.random.default_rng(6)
    cells = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0)), -1).reshape(-1, 2) * 2.2
    centers = cells + rng.uniform(0.0, 1.0, cells.shape)
    radii = 0.12 + 0.45 * rng.random(len(cells)) ** 1.5
    if not overlapping:
        return centers, radii
    inner = centers[radii > 0.4] + 0.35
    return np.vstack([centers, inner]), np.append(3.4 * radii, np.full(len(inner), 0.3))


@styled
def figure_disks() -> Figure:
    """Draw disjoint and overlapping disks with graph and cells, and lifted disks with a plane."""
    figure = new_figure(7.4, 3.1)
    for column, overlapping in enumerate((False, True)):
        axes = blank_axes(figure, (0.33 * column, 0.18, 0.33, 0.81), _DISK_LIMITS)
        _graph(axes, apollonius(*example_disks(overlapping=overlapping)))
    _lifted(space_axes(figure, (0.66, 0.16, 0.34, 0.86)), np.array(_DISJOINT))
    captions(figure, 0.12, {0.165: "(a) disjoint disks", 0.495: "(b) overlapping disks"})
    captions(figure, 0.12, {0.83: "(c) a supporting plane"})
    keys = {
        "disk": SKY,
        "hidden disk, or one apart": VERMILION,
        "edge, or lifted disk": BLUE,
        "side of a cell": INK,
        "no supporting plane": GREEN,
        "plane and its circle": ORANGE,
    }
    entries = (line_key(text, color=color, lw=1.2) for text, color in keys.items())
    legend_below(figure, *entries, fontsize=7.5, columnspacing=1.0)
    return figure


def _graph(axes: Axes, graph: ApolloniusGraph) -> None:
    patches = load("matplotlib.patches", extra="plot")
    hidden = set(graph.hidden.tolist())
    for row, (center, radius) in enumerate(zip(graph.centers, graph.radii, strict=True)):
        color = VERMILION if row in hidden else SKY
        axes.add_patch(patches.Circle(center, radius, fc=color, alpha=0.18, lw=0))
        axes.add_patch(patches.Circle(center, radius, fc="none", ec=color, lw=1.0))
    for triangle in graph.simplices[graph.circles[:, 2] < 0]:
        corners = graph.centers[triangle]
        axes.add_patch(patches.Polygon(corners, fc=GREEN, alpha=0.45, lw=0, gid="unsupported"))
    draw_lines(axes, graph.centers[graph.edges], BLUE, 0.6, "edges")
    low, high = _DISK_LIMITS
    sides = (line for _, line in graph.cell_sides((low, low, high, high), 0.01))
    draw_lines(axes, sides, INK, 1.2, "cells")


def _lifted(axes: Any, disks: Floats) -> None:
    graph = apollonius(disks[:, :2], disks[:, 2])
    x, y, radius = graph.circles[0]
    around = unit_circle()
    _paraboloid(axes)
    for row, (*center, size) in enumerate(disks.tolist()):
        points = center + size * around
        color = BLUE if row in graph.simplices[0] else VERMILION
        axes.plot(*points.T, (points**2).sum(1), color=color, lw=1.8, gid="lifted")
        axes.plot(*points.T, _GROUND, color=color, lw=1.2)
    plane = np.array([2 * x, 2 * y, radius**2 - x**2 - y**2])
    circle = np.array([x, y]) + radius * around
    axes.plot(*circle.T, (circle**2).sum(1), color=ORANGE, lw=1.6, gid="section")
    axes.plot(*circle.T, _GROUND, color=ORANGE, lw=1.2)
    corners = np.array([[-1.5, -1.5], [1.7, -1.5], [1.7, 1.6], [-1.5, 1.6]])
    heights = corners @ plane[:2] + plane[2]
    solid = load("mpl_toolkits.mplot3d.art3d", extra="plot").Poly3DCollection
    sheet = np.column_stack([corners, heights])
    axes.add_collection3d(solid([sheet], facecolors=ORANGE, alpha=0.22, edgecolors=ORANGE))
    axes.view_init(elev=14, azim=-62)
    axes.set_axis_off()
    axes.set_box_aspect((1, 1, 1.1), zoom=1.25)


def _paraboloid(axes: Any) -> None:
    angles = np.linspace(0, 2 * np.pi, 61)
    reach = np.linspace(0, 2.0, 11)
    x, y = np.outer(reach, np.cos(angles)), np.outer(reach, np.sin(angles))
    axes.plot_wireframe(x, y, x**2 + y**2, color="#cccccc", lw=0.4, rcount=9, ccount=25)


FARTHEST = 26
_SHOWN = (0, 2)  # of the circles, which are sorted by their size
_ROUND = (-1.5, 1.5)
_PIXELS = 600
_SHADES = (SKY, ORANGE, GREEN, PURPLE, YELLOW, BLUE, VERMILION, FAINT)


def example_points() -> Floats:
    """Return the points of the picture."""
    rng = np.random.default_rng(23)
    radius, angle = np.sqrt(rng.random(FARTHEST)), rng.uniform(0.0, 2 * np.pi, FARTHEST)
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
        axes = blank_axes(figure, (0.5 * column + 0.02, 0.18, 0.46, 0.79), _ROUND)
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
    side = (np.arange(_PIXELS) + 0.5) / _PIXELS * (_ROUND[1] - _ROUND[0]) + _ROUND[0]
    sites = mesh.points[corners(mesh)]
    distances = (side[None, :, None] - sites[:, 0]) ** 2 + (side[:, None, None] - sites[:, 1]) ** 2
    shades = 1.0 - 0.45 * (1.0 - np.array([to_rgb(shade) for shade in _SHADES]))
    axes.imshow(
        shades[distances.argmax(axis=2) % len(shades)],
        origin="lower",
        extent=(*_ROUND, *_ROUND),
        interpolation="nearest",
        gid="cells",
    )
    draw_lines(axes, cell_sides(mesh, inward=True), INK, 1.1, "sides")
