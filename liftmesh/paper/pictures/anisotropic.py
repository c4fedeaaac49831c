"""Long, thin triangles: in a constant metric, in a metric for each point, and by choice of points.

In a metric the circles through three points are ellipses of one shape; those of the triangles are
empty. With a metric for each point, stars need not agree. And by adaptive thinning of an image
those pixels stay without which linear interpolation would lose most: the paper cites L. Demaret and
A. Iske for such anisotropic Delaunay triangulations.
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
    SKY,
    VERMILION,
    area_key,
    blank_axes,
    captions,
    draw_lines,
    legend_below,
    line_key,
    new_figure,
    styled,
    unit_circle,
)
from liftmesh.planar.anisotropic import AnisotropicStars, anisotropic_stars
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.thinning import thin
from liftmesh.terrain.triangulate import triangulate

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


def circle_through(corners: Floats, metric: Floats) -> Floats:
    """Compute the circle of a metric through three points."""
    a, b, c = corners
    heights = np.einsum("ni,ij,nj->n", corners, metric, corners)
    center = np.linalg.solve(2 * np.array([b - a, c - a]) @ metric, heights[1:] - heights[0])
    radius = np.sqrt((a - center) @ metric @ (a - center))
    root = np.linalg.inv(np.linalg.cholesky(metric)).T
    around: Floats = center + radius * unit_circle() @ root.T
    return around


@styled
def figure_metric() -> Figure:
    """Draw Delaunay triangulations in two metrics, with the empty circles of some triangles."""
    figure = new_figure(7.2, 4.2)
    points = metric_points()
    for column, metric in enumerate((((1.0, 0.0), (0.0, 1.0)), METRIC)):
        axes = blank_axes(figure, (0.5 * column, 0.17, 0.5, 0.83), _LIMITS)
        _draw_circles(axes, delaunay(points, metric=metric), np.array(metric))
    captions(figure, 0.12, {0.25: r"(a) $x^2 + y^2$", 0.75: r"(b) $x^2 + 2.4\,xy + 3\,y^2$"})
    legend_below(
        figure,
        line_key("point", color=INK, marker="o", ls="", ms=3.6),
        line_key("edge", color=BLUE, lw=1.0),
        line_key("empty circle of the metric", color=ORANGE, lw=1.2),
        area_key("its triangle", ORANGE, 0.5),
    )
    return figure


def _draw_circles(axes: Axes, mesh: Triangulation, metric: Floats) -> None:
    corners = mesh.points[mesh.simplices]
    circles = [circle_through(each, metric) for each in corners]
    inside = [k for k, each in enumerate(circles) if is_inside(each)]
    for k in inside[:: max(len(inside) // _SHOWN, 1)][:_SHOWN]:
        axes.fill(*circles[k].T, fc=ORANGE, alpha=0.16, lw=0)
        axes.fill(*corners[k].T, fc=ORANGE, alpha=0.4, lw=0)
        axes.plot(*circles[k].T, color=ORANGE, lw=1.2, gid=f"circle {k}")
    draw_lines(axes, mesh.points[mesh.edges], BLUE, 1.0, "edges")
    axes.plot(*mesh.points.T, marker="o", ls="", ms=3.0, color=INK, mew=0, zorder=6, gid="points")


def is_inside(circle: Floats) -> bool:
    """Whether a circle is within the picture."""
    return bool((circle > _LIMITS[0]).all() and (circle < _LIMITS[1]).all())


STARS = 140
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


def star_points() -> Floats:
    """Return the points of the picture."""
    return np.random.default_rng(13).random((STARS, 2))


@styled
def figure_stars() -> Figure:
    """Draw metrics as ellipses, and the triangles in the stars of all their corners."""
    points = star_points()
    stars = anisotropic_stars(points, example_metrics(points))
    figure = new_figure(5.2, 3.2)
    for column, (draw, text) in enumerate(
        ((_ellipses, "(a) a metric for each point"), (_triangles, "(b) triangles that agree"))
    ):
        axes = blank_axes(figure, (0.5 * column + 0.01, 0.17, 0.48, 0.82), (-0.02, 1.02))
        draw(axes, stars)
        captions(figure, 0.11, {0.25 + 0.5 * column: text})
    legend_below(
        figure,
        line_key("unit circle of the metric", color=SKY, lw=1.1),
        line_key("point", color=INK, marker="o", ls="", ms=2.5),
        line_key("triangle of three stars", color=BLUE, lw=1.0),
        line_key("inconsistent star", color=VERMILION, marker="o", ls="", ms=3),
        fontsize=7.5,
        columnspacing=1.0,
    )
    return figure


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
    mesh: Any = triangulate(points).to_matplotlib()
    shown: dict[str, Any] = {"cmap": "gray", "vmin": 0.0, "vmax": 1.0}
    titles = ("(a) 4,096 pixels", f"(b) triangles of {KEPT} of them", "(c) interpolated")
    for column, title in enumerate(titles):
        box = (column / 3 + 0.01, 0.22, 0.313, 0.76)
        axes: Any = blank_axes(figure, box, (-0.5, SIZE - 0.5))
        if column == 0:
            axes.imshow(example_image(), origin="lower", **shown)
        elif column == 1:
            _draw_triangles(axes, mesh, points)
        else:
            axes.tripcolor(mesh, points[:, 2], shading="gouraud", rasterized=True, **shown)
        captions(figure, 0.15, {column / 3 + 1 / 6: title})
    legend_below(
        figure,
        line_key("pixel that stays", color=INK, marker="o", ls="", ms=2.6),
        line_key("edge", color=BLUE, lw=0.9),
        area_key("triangle across an edge of the image", ORANGE, 0.6),
    )
    return figure


def _draw_triangles(axes: Any, mesh: Any, points: Floats) -> None:
    corners = points[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for each in corners[np.hypot(across[:, 0], across[:, 1]) > STEEP * across[:, 2]]:
        axes.fill(*each[:, :2].T, fc=ORANGE, alpha=0.55, lw=0)
    axes.triplot(mesh, color=BLUE, lw=0.7)
    axes.plot(*points[:, :2].T, marker="o", ls="", ms=1.8, color=INK, mew=0, zorder=6)
