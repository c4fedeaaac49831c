"""Figures 4.1 and 4.2: the ellipse (E) in which a plane intersects the paraboloid, the circle (C).

The names are those of Section 4: the plane z = alpha x + beta y + gamma, the vertex q, the centre
c and the radius r of (C), the distance L_cq. They are computed in exact rationals and rounded to
doubles for drawing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh._typing import Floats, Mask
from liftmesh.paper.geometry import Plane, mu
from liftmesh.paper.pictures.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    SKY,
    SOFT,
    VERMILION,
    Space,
    View,
    blank_axes,
    captions,
    label,
    new_figure,
    on_ground,
    styled,
    unit_circle,
)
from liftmesh.paper.propositions import Ellipse
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.lifting import lift

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


UNDECIDED = ""


@dataclass(frozen=True, slots=True)
class CrossSection:
    """The intersection of the paraboloid and the plane through three lifted points."""

    corners: Floats
    q: tuple[float, float]

    @property
    def ellipse(self) -> Ellipse:
        """The ellipse (E) in exact rationals."""
        a, b, p = (mu(corner, self.q) for corner in self.corners.tolist())
        return Ellipse(Plane.through(a, b, p), self.q)

    @property
    def plane(self) -> Floats:
        """alpha, beta and gamma, (3,) float64."""
        plane = self.ellipse.plane
        return np.array([plane.alpha, plane.beta, plane.gamma], dtype=np.float64)

    @property
    def center(self) -> Floats:
        """c, the centre of (C), (2,) float64."""
        return np.array(self.ellipse.circle.centre, dtype=np.float64)

    @property
    def radius(self) -> float:
        """r, the radius of (C)."""
        return math.sqrt(self.ellipse.circle.squared_radius)

    @property
    def distance(self) -> float:
        """L_cq, the distance between c and q."""
        return math.sqrt(self.ellipse.squared_distance)

    @property
    def box(self) -> Floats:
        """The least and the greatest coordinates on (E), [[min x, max x], ...], (3, 2) float64."""
        e = self.ellipse
        extents = [[e.min_x, e.max_x], [e.min_y, e.max_y], [e.min_z, e.max_z]]
        return np.array(extents, dtype=np.float64)

    def circle(self, count: int = 181) -> Floats:
        """Return points of (C)."""
        points: Floats = self.center + self.radius * unit_circle(count)
        return points

    def on_plane(self, points: ArrayLike) -> Floats:
        """Return the points of the plane above planar points."""
        rows = np.asarray(points, dtype=np.float64)
        return np.column_stack([rows, rows @ self.plane[:2] + self.plane[2]])

    def decided_by(self, points: Floats) -> NDArray[np.str_]:
        """Return the proposition that decides each point, tested in the order of Procedure 3."""
        x, y, z = lift(points, self.q).T
        (min_x, max_x), (min_y, max_y), (min_z, max_z) = self.box
        tests = {
            "4.4": (z < min_z) & (self.distance < self.radius),
            "4.3 (i)": x < min_x,
            "4.3 (ii)": x > max_x,
            "4.3 (iii)": y < min_y,
            "4.3 (iv)": y > max_y,
            "4.3 (v)": z > max_z,
        }
        return np.select(list(tests.values()), list(tests), UNDECIDED)


CORNERS = np.array([[1.29, 0.25], [0.3, 0.94], [0.25, -0.73]])  # a', b', p'
SECTION = CrossSection(CORNERS, (0.0, 0.0))
VIEW = View(-118, 19, 0.8)
TOP = 2.6  # where the paraboloid is cut off


@styled
def figure_4_1() -> Figure:
    """Draw the projection of (E) onto Oxy."""
    figure = new_figure(5.8, 5.0)
    space = Space(blank_axes(figure, (0.0, 0.0, 1.0, 1.0)), VIEW)
    _paraboloid(space)
    draw_section(space)
    return figure


def draw_section(space: Space) -> None:
    """Draw the plane (a, b, p) with (E) and a, b, p, and below it, on Oxy, (C) and a', b', p'."""
    _ground(space)
    _cut(space, SECTION)
    _drops(space, lift(CORNERS, SECTION.q))


def _ground(space: Space) -> None:
    """Draw a piece of the plane Oxy with the circle (C)."""
    square = np.array([[-1.5, -1.4, 0], [2.0, -1.4, 0], [2.0, 1.6, 0], [-1.5, 1.6, 0]])
    space.faces([square], facecolors="#f3f1ec", edgecolors=FAINT, lw=0.7, zorder=0.5)
    space.name(square[1], "$Oxy$", (-26, 10), fontsize=12)
    circle = on_ground(SECTION.circle())
    space.faces([circle], facecolors=ORANGE, alpha=0.25, zorder=1)
    space.line(circle, color=VERMILION, lw=1.6, zorder=1.6, gid="C")
    space.name(circle[172], r"$(\mathcal{C})$", (-16, -3), color=VERMILION)


def _paraboloid(space: Space) -> None:
    """Draw the paraboloid's outline, its rim, and some meridians and parallels."""
    around, radii = unit_circle(145), np.linspace(0, np.sqrt(TOP), 40)
    rim = lift(around * radii[-1], "origin")
    solid = np.vstack([lift(around * radius, "origin") for radius in radii])
    outline = solid[delaunay(space.view.flat(solid)).convex_hull]
    space.faces([outline], facecolors=SKY, alpha=0.16, zorder=1.2)
    space.faces([rim], facecolors=SKY, alpha=0.14, zorder=1.3)
    for direction in around[:-1:12]:
        _seen(space, lift(np.outer(radii, direction), "origin"), color=BLUE, lw=0.5)
    for radius in radii[13:-1:9]:
        _seen(space, lift(around * radius, "origin"), color=BLUE, lw=0.5)
    space.line([*outline, outline[0]], color=BLUE, lw=1.0, zorder=2)
    space.line(rim, color=BLUE, lw=1.2, zorder=2, gid="rim")
    space.name(rim[2], r"$(\mathcal{P})$", (24, 0), color=BLUE)


def _cut(space: Space, section: CrossSection) -> None:
    """Draw the plane, and the ellipse (E) in which it intersects the paraboloid."""
    piece = section.on_plane(_square_about(section, 0.22))
    space.faces([piece], facecolors=GREEN, alpha=0.14, zorder=2.5, gid="plane")
    space.line([*piece, piece[0]], color=GREEN, lw=0.9, zorder=2.6)
    space.name(piece[1], "$(a, b, p)$", (30, -4), color=GREEN)
    ellipse = section.on_plane(section.circle())
    space.faces([ellipse], facecolors=VERMILION, alpha=0.16, zorder=2.7)
    space.line(ellipse, color=VERMILION, lw=1.8, zorder=4, gid="E")
    space.name(ellipse[72], "$(E)$", (-17, 8), color=VERMILION)


def _square_about(section: CrossSection, margin: float) -> Floats:
    """Return a square around the circle (C), two edges parallel to level lines of the plane."""
    slope = section.center - section.q
    rise = slope / np.linalg.norm(slope) * (section.radius + margin)
    level = np.array([-rise[1], rise[0]])
    corners: Floats = section.center + np.array(
        [-rise - level, rise - level, rise + level, -rise + level]
    )
    return corners


def _drops(space: Space, lifted: Floats) -> None:
    """Draw a, b, p on (E) and a', b', p' on (C) below them."""
    aways = ((13, 0), (-4, 12), (8, -10))
    for point, text, away in zip(lifted, "abp", aways, strict=True):
        space.line([point, point * (1, 1, 0)], color=SOFT, lw=0.8, ls=(0, (3, 2)), zorder=3)
        space.name(point, f"${text}$", away)
        space.name(point * (1, 1, 0), f"${text}'$", away)
    space.dots(lifted, color=INK, gid="abp")
    space.dots(lifted * (1, 1, 0), color=INK, ms=3.6, gid="abp'")


def _seen(space: Space, points: Floats, **look: Any) -> None:
    """Draw a line on the paraboloid: solid if visible, pale if hidden by the paraboloid."""
    hidden = behind_paraboloid(points, space.view)
    for part, strength in ((hidden, 0.22), (~hidden, 0.75)):
        space.line(np.where(part[:, np.newaxis], points, np.nan), alpha=strength, zorder=2, **look)


def behind_paraboloid(points: Floats, view: View) -> Mask:
    """Find the points on the paraboloid z = x^2 + y^2 that are hidden by its near side."""
    x, y, z = view.towards
    # points + s * towards lies on the surface for s = 0 and for this s.
    s = (z - 2 * points[:, :2] @ (x, y)) / (x * x + y * y)
    hidden: Mask = (s > 1e-9) & (points[:, 2] + s * z < TOP)
    return hidden


VERTICES = (("a", (2.15, 0.55)), ("b", (0.85, 0.3)))  # q outside (C), and inside


@styled
def figure_4_2() -> Figure:
    """Draw w'_1 and w'_2, where the line cq meets the circle (C)."""
    figure = new_figure(8.0, 3.5)
    for column, (letter, q) in enumerate(VERTICES):
        left, width = ((0.0, 0.57), (0.56, 0.44))[column]
        axes = blank_axes(figure, (left, 0.1, width, 0.9))
        _nearest_and_farthest(axes, CrossSection(CORNERS, q))
        axes.set(xlim=(-0.75, 2.45 - 0.73 * column), ylim=(-0.95, 1.2))
        where = "outside" if letter == "a" else "inside"
        text = rf"({letter}) $q$ {where} $(\mathcal{{C}})$"
        captions(figure, 0.04, {left + width / 2: text})
    return figure


def _nearest_and_farthest(axes: Axes, section: CrossSection) -> None:
    nearest, farthest = nearest_to_q(section)
    s = section.circle(100)[22]
    axes.plot(*section.circle().T, color=VERMILION, lw=1.6, gid="C")
    axes.plot(*np.array([farthest, nearest]).T, color=SOFT, lw=0.9)
    axes.plot(*np.array([nearest, section.q]).T, color=SOFT, lw=0.9)
    for end in (section.center, np.array(section.q)):
        axes.plot(*np.array([s, end]).T, color=BLUE, lw=0.9, ls=(0, (4, 2.5)))
    along = (np.array(section.q) - section.center) / section.distance
    names = {
        "$c$": (section.center, (0, 12)),
        "$q$": (
            section.q,
            tuple(13 * along + (0, 2)) if section.distance > section.radius else (2, 13),
        ),
        "$s$": (s, (4, 11)),
        "$w_1'$": (nearest, (17, -8)),
        "$w_2'$": (farthest, tuple(-17 * along)),
    }
    for text, (at, away) in names.items():
        color = ORANGE if text == "$q$" else INK
        axes.plot(
            *at, marker="o", ms=5, color=color, mec=INK, mew=0.6, zorder=5, gid=text.strip("$")
        )
        label(axes, at, text, away)
    label(axes, section.circle(100)[66], r"$(\mathcal{C})$", (-8, -14), color=VERMILION)


def nearest_to_q(section: CrossSection) -> tuple[Floats, Floats]:
    """Compute w'_1 and w'_2, the points of (C) nearest to q and farthest from it."""
    along = section.radius * (section.q - section.center) / section.distance
    return section.center + along, section.center - along
