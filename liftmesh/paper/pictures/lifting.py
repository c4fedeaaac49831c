"""Lifted points: Figures 2.1 and 2.2, a point above a plane and a lower hull; 5.1 and 5.2, data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Mask, Rows
from liftmesh.paper.geometry import Plane
from liftmesh.paper.pictures.style import (
    BLUE,
    INK,
    ORANGE,
    SKY,
    SOFT,
    VERMILION,
    Space,
    View,
    blank_axes,
    captions,
    new_figure,
    on_ground,
    space_axes,
    styled,
)
from liftmesh.paper.printed import SQUARE, Vertex
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.lifting import LowerHull, lift, resolve_apex

if TYPE_CHECKING:
    from matplotlib.figure import Figure


CORNERS = np.array([[3.4, 0.9, 1.9], [1.2, 3.7, 1.5], [0.7, 1.1, 2.5]])  # p, q, t
W = np.array([1.6, 2.4, 3.75])
ABOVE = View(28, 22)


@styled
def figure_2_1() -> Figure:
    """Draw the point w above the plane (p, q, t)."""
    figure = new_figure(5.6, 4.5)
    space = Space(blank_axes(figure, (0.01, 0.01, 0.98, 0.98)), ABOVE)
    space.coordinate_axes((4.6, 5.0, 3.9))
    under = on_plane(W[:2])
    _plane(space)
    _shadows(space, np.vstack([CORNERS, under]))
    space.line([under, W * (1, 1, 0)], color=SOFT, lw=0.8, ls=(0, (4, 3)), zorder=1)
    space.arrow(under, W, color=VERMILION, lw=1.5, shrinkB=3, zorder=5)
    space.dots(CORNERS, color=BLUE, gid="corners")
    space.dots([under], color=VERMILION, mfc="white", mew=1.2, gid="under")
    space.dots([W], color=VERMILION, ms=6, gid="w")
    for corner, text, away in zip(CORNERS, "pqt", ((-10, -3), (11, -2), (-8, 9)), strict=True):
        space.name(corner, f"${text}$", away)
    space.name(W, "$w$", (11, 4))
    space.name(under, r"$(w_x, w_y, w_z^*)$", (-40, -1), fontsize=11.5)
    space.name((W + under) / 2, r"$w_z > w_z^*$", (31, 11), color=VERMILION)
    return figure


def on_plane(position: Floats) -> Floats:
    """Return the point of the plane (p, q, t) of Figure 2.1 above a planar point."""
    plane = Plane.through(*CORNERS.tolist())
    return np.append(position, float(plane.height(*position.tolist())))


def _plane(space: Space) -> None:
    """Draw a piece of the plane around p, q, t, and their triangle."""
    square = np.array([[0.3, 0.3], [4.0, 0.3], [4.0, 4.2], [0.3, 4.2]])
    piece = [on_plane(corner) for corner in square]
    space.faces([piece], facecolors=SKY, alpha=0.28, zorder=2, gid="plane")
    space.line([*piece, piece[0]], color=BLUE, lw=0.7, alpha=0.6, zorder=2.1)
    space.faces([CORNERS], facecolors=SKY, alpha=0.45, zorder=2.2)
    space.line([*CORNERS, CORNERS[0]], color=BLUE, lw=1.2, zorder=3)


def _shadows(space: Space, points: Floats) -> None:
    """Draw the projections onto Oxy of p, q, t and w."""
    p, q, *_ = points
    for point in (p, q):
        space.line([point, point * (1, 1, 0)], color=SOFT, lw=0.6, ls=(0, (2, 3)), zorder=1)
    feet = points * (1, 1, 0)
    space.line([*feet[:3], feet[0]], color=SOFT, lw=0.6, zorder=1)
    space.dots(feet, color=SOFT, ms=2.6, zorder=1.5)


PANELS = {"origin": "(a) $q = O$, outside the hull", "median": "(b) $q$ = the median point"}
VIEWS = {"origin": View(33, 30, 0.345), "median": View(33, 30, 0.85)}


def example_points() -> Floats:
    """Return the planar points of Figure 2.2."""
    draws = np.random.default_rng(20).uniform(0.9, 2.7, (400, 2))
    kept = draws[:1]
    for point in draws:  # no two closer than 0.22, so that all are distinguishable
        if np.hypot(*(kept - point).T).min() > 0.22:
            kept = np.vstack([kept, point])
    return kept[:24]


@styled
def figure_2_2() -> Figure:
    """Draw the Delaunay triangulation and the lower convex hull above it, for two choices of q."""
    figure = new_figure(7.6, 4.2)
    triangulation = delaunay(example_points())
    for column, (q, text) in enumerate(PANELS.items()):
        axes = blank_axes(figure, (0.005 + 0.5 * column, 0.07, 0.49, 0.93))
        space = Space(axes, VIEWS[q])
        _triangulation(space, triangulation.points, triangulation.simplices)
        _hull(space, triangulation.lifted(q), triangulation.convex_hull)
        _vertex(space, resolve_apex(q, triangulation.points))
        axes.set(xlim=(-2.2, 2.6), ylim=(-2.05, 2.35))
        captions(figure, 0.04, {0.25 + 0.5 * column: text})
    return figure


def _triangulation(space: Space, points: Floats, simplices: Rows) -> None:
    flat = on_ground(points)
    space.coordinate_axes((2.75, 2.75, 2.35 / space.view.rise))
    space.faces(flat[simplices], edgecolors=INK, lw=0.6, zorder=2, gid="triangulation")
    space.dots(flat, color=INK, ms=2.8, zorder=2.5)


def _hull(space: Space, hull: LowerHull, boundary: Rows) -> None:
    for row in boundary:
        x, y, z = hull.vertices[row]
        space.line([(x, y, 0), (x, y, z)], color=SOFT, lw=0.6, ls=(0, (2, 3)), zorder=1)
    corners = hull.vertices[hull.faces]
    shades = _shades(corners, space.view)
    space.faces(
        corners, facecolors=shades, edgecolors=BLUE, lw=0.7, alpha=0.9, zorder=4, gid="hull"
    )
    behind = covered(hull, space.view)
    space.dots(hull.vertices[behind], color=BLUE, ms=2.8, zorder=3.9)
    space.dots(hull.vertices[~behind], color=BLUE, ms=2.8)


def _vertex(space: Space, q: tuple[float, float]) -> None:
    space.dots([(*q, 0)], color=ORANGE, mec=INK, mew=0.6, ms=5.5, zorder=7)
    if q != (0.0, 0.0):
        space.name((*q, 0), "$q$", (0, -11))


def covered(hull: LowerHull, view: View) -> Mask:
    """Find the vertices of a hull that are hidden by its facets."""
    hidden = np.zeros(len(hull.vertices), dtype=bool)
    for face in hull.faces:
        corners = hull.vertices[face]
        weights = np.linalg.solve(
            np.column_stack([view.flat(corners), np.ones(3)]).T,
            np.column_stack([view.flat(hull.vertices), np.ones(len(hidden))]).T,
        )
        nearer = view.nearness(corners) @ weights > view.nearness(hull.vertices) + 1e-9
        hidden |= nearer & (weights > -1e-9).all(axis=0)
    return hidden


def _shades(corners: Floats, view: View) -> Floats:
    """Compute shades by slope: light for facets seen from above, dark for those from below."""
    raised = corners * (1, 1, view.rise)
    normals = np.cross(raised[:, 1] - raised[:, 0], raised[:, 2] - raised[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    light = np.abs(normals @ (0.62, -0.38, 0.69))[:, np.newaxis]
    inner = np.array([0.74, 0.87, 0.96]) + light * (0.22, 0.11, 0.04)
    outer = np.array([0.25, 0.52, 0.76]) + light * (0.35, 0.28, 0.16)
    return np.where((normals @ (view.towards * (1, 1, view.rise)) > 0)[:, np.newaxis], inner, outer)


COUNT = 1_000
DIRECTIONS = ((-120.0, 28.0), (-40.0, 6.0))  # azimuth and elevation in degrees


def square_points() -> Floats:
    """Return the planar points of Figures 5.1 and 5.2."""
    return np.random.default_rng(51).uniform(0.0, SQUARE, (COUNT, 2))


@styled
def figure_5_1() -> Figure:
    """Draw the data of 1,000 points in case 1: q is the origin."""
    return _data("origin")


@styled
def figure_5_2() -> Figure:
    """Draw the data of 1,000 points in case 2: q is their median point."""
    return _data("median")


def _data(q: Vertex) -> Figure:
    figure = new_figure(8.6, 4.1)
    points = square_points()
    lifted = lift(points, q)
    vertex = (*resolve_apex(q, points), 0.0)
    for column, (azimuth, elevation) in enumerate(DIRECTIONS):
        axes = space_axes(figure, (0.035 + 0.465 * column, 0.01, 0.455, 0.99))
        _scatter(axes, lifted, vertex)
        axes.view_init(elev=elevation, azim=azimuth)
        axes.set_title(f"({'ab'[column]})", y=-0.02)
    return figure


def _scatter(axes: Any, lifted: Floats, vertex: tuple[float, ...]) -> None:
    axes.scatter(*lifted.T, c=lifted[:, 2], cmap="viridis_r", s=6, lw=0, depthshade=False)
    axes.plot(*([value] for value in vertex), marker="o", ms=6, color=ORANGE, mec=INK, mew=0.7)
    axes.text(*vertex, "$q$", ha="right", va="top", fontsize=13)
    axes.set(xlabel="$x$", ylabel="$y$", zlabel="$z$")
    axes.set(xlim=(0, SQUARE), ylim=(0, SQUARE), xticks=(50, 100, 150), yticks=(50, 100, 150))
    axes.set_zlim(0, None)
    axes.set_box_aspect((1, 1, 0.85), zoom=0.92)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1, 1, 1, 0))
    axes.zaxis.set_major_formatter("{x:,.0f}")
    axes.zaxis.set_rotate_label(False)
    axes.locator_params(axis="z", nbins=5)
    axes.tick_params(pad=0, labelsize=9.5)
    axes.tick_params(axis="z", pad=4)
