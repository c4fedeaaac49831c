"""Figures 5.1 and 5.2: 1,000 lifted points, seen from two directions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.optional import load
from liftmesh.paper.pictures.style import INK, ORANGE, new_figure, styled
from liftmesh.paper.printed import SQUARE, Vertex
from liftmesh.planar.lifting import lift, resolve_q

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
    load("mpl_toolkits.mplot3d", extra="plot")  # makes the 3-D axes known
    figure = new_figure(8.6, 4.1)
    points = square_points()
    lifted = lift(points, q)
    vertex = (*resolve_q(q, points), 0.0)
    for column, (azimuth, elevation) in enumerate(DIRECTIONS):
        box = (0.035 + 0.465 * column, 0.01, 0.455, 0.99)
        axes: Any = figure.add_axes(box, projection="3d", computed_zorder=False)
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
