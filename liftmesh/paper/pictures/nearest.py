"""Figure 4.2: the points of the circle (C) nearest to q and farthest from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.paper.pictures.cross_section import CrossSection
from liftmesh.paper.pictures.section import CORNERS
from liftmesh.paper.pictures.style import (
    BLUE,
    INK,
    ORANGE,
    SOFT,
    VERMILION,
    blank_axes,
    label,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
        figure.text(left + width / 2, 0.04, text, ha="center")
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
