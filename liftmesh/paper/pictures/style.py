"""The drawing of all figures: their style, independent of the user's settings, and common parts.

Colours are those of Okabe and Ito (2008), which colour-blind readers can distinguish too. Figures
are made without pyplot, so there is no global state and no window opens.

Space is drawn in 2-D axes, by parallel projection, far objects first. The projection is computed
here rather than by matplotlib's 3-D axes, so that lines, labels and translucent planes overlap in
the order in which they are drawn.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.optional import load

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

P = ParamSpec("P")
R = TypeVar("R")
INK, SOFT, FAINT, GRID = "#1a1a1a", "#6e6e6e", "#c9c9c9", "#dddddd"
BLUE, SKY, GREEN, ORANGE = "#0072b2", "#56b4e9", "#009e73", "#e69f00"
VERMILION, PURPLE, YELLOW = "#d55e00", "#cc79a7", "#f0e442"

ARROW = {"arrowstyle": "-|>", "color": INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}

_SETTINGS = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "cm",
    "font.size": 12.0,
    "axes.labelsize": 12.0,
    "axes.titlesize": 12.0,
    "xtick.labelsize": 10.5,
    "ytick.labelsize": 10.5,
    "legend.fontsize": 10.5,
    "axes.edgecolor": SOFT,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "lines.solid_joinstyle": "round",
    "lines.solid_capstyle": "round",
    "svg.fonttype": "path",
}


def styled(function: Callable[P, R]) -> Callable[P, R]:
    """Run a function with the style of the figures, and restore the user's settings."""

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        with load("matplotlib.style", extra="plot").context(["default", _SETTINGS]):
            return function(*args, **kwargs)

    return wrapper


def new_figure(width: float, height: float) -> Figure:
    """Make an empty figure of a size in inches that is not attached to a window."""
    figure: Figure = load("matplotlib.figure", extra="plot").Figure(figsize=(width, height))
    return figure


def blank_axes(
    figure: Figure,
    box: tuple[float, float, float, float],  # left, bottom, width and height: shares of the figure
    limits: tuple[float, float] | None = None,  # of x and y alike
) -> Axes:
    """Add axes for a drawing to scale: no frame, no ticks, equal units."""
    axes = figure.add_axes(box)
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.06)
    if limits is not None:
        axes.set(xlim=limits, ylim=limits)
    return axes


def space_axes(figure: Figure, box: tuple[float, float, float, float]) -> Any:
    """Add matplotlib's own 3-D axes, where what is drawn later covers what was drawn before."""
    load("mpl_toolkits.mplot3d", extra="plot")  # makes them known
    return figure.add_axes(box, projection="3d", computed_zorder=False)


def captions(figure: Figure, height: float, texts: Mapping[float, str]) -> None:
    """Write what the panels are, each centred at its share of the width."""
    for x, text in texts.items():
        figure.text(x, height, text, ha="center")


def line_key(text: str, **look: Any) -> Any:
    """Make an entry of a legend for a line, or for a mark with ``ls=""``."""
    return load("matplotlib.lines", extra="plot").Line2D([], [], label=text, **look)


def area_key(text: str, color: str, alpha: float) -> Any:
    """Make an entry of a legend for an area."""
    patch = load("matplotlib.patches", extra="plot").Patch
    return patch(fc=color, alpha=alpha, lw=0, label=text)


def legend_below(figure: Figure, *keys: Any, **options: Any) -> None:
    """Explain what is drawn, in one line at the bottom."""
    figure.legend(
        handles=keys,
        loc="lower center",
        ncols=len(keys),
        frameon=False,
        labelcolor=SOFT,
        **options,
    )


def draw_lines(axes: Axes, lines: Iterable[Floats], color: str, width: float, gid: str) -> None:
    """Draw many lines as one object."""
    collection = load("matplotlib.collections", extra="plot").LineCollection
    axes.add_collection(collection([*lines], colors=color, linewidths=width, gid=gid))


def on_ground(points: Floats) -> Floats:
    """Put planar points on the plane Oxy in space."""
    return np.column_stack([points, np.zeros(len(points))])


def unit_circle(count: int = 181) -> Floats:
    """Compute points of the unit circle, the first of which is also the last."""
    angles = np.linspace(0, 2 * np.pi, count)
    return np.column_stack([np.cos(angles), np.sin(angles)])


def label(
    axes: Axes, at: Any, text: str, away: tuple[float, float] = (0.0, 0.0), **options: Any
) -> None:
    """Write a label some typographic points away from a point, with a halo."""
    effects = load("matplotlib.patheffects", extra="plot")
    settings: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 9, "fontsize": 13}
    axes.annotate(
        text,
        tuple(at),
        xytext=away,
        textcoords="offset points",
        annotation_clip=False,
        path_effects=[effects.withStroke(linewidth=3.0, foreground="white")],
        **{**settings, **options},
    )


@dataclass(frozen=True, slots=True)
class View:
    """A direction of view."""

    azimuth: float  # degrees, of the viewer around the z-axis from the x-axis
    elevation: float  # degrees above the plane Oxy
    rise: float = 1.0  # vertical exaggeration

    def _frame(self) -> Floats:
        """Columns: to the right, up, and towards the viewer."""
        a, e = np.radians([self.azimuth, self.elevation])
        right = (-np.sin(a), np.cos(a), 0.0)
        up = (-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e))
        towards = (np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e))
        frame: Floats = np.array([right, up, towards]).T
        return frame

    def flat(self, points: ArrayLike) -> Floats:
        """Project points to the drawing plane: to the right, and up."""
        projected: Floats = np.asarray(points) * (1, 1, self.rise) @ self._frame()
        return projected[..., :2]

    def nearness(self, points: ArrayLike) -> Floats:
        """Compute how near points are to the viewer; greater is nearer."""
        nearness: Floats = np.asarray(points) * (1, 1, self.rise) @ self._frame()[:, 2]
        return nearness

    @property
    def towards(self) -> Floats:
        """The direction to the viewer in the units of the data, (3,) float64."""
        direction: Floats = self._frame()[:, 2] / (1, 1, self.rise)
        return direction


@dataclass(frozen=True, slots=True)
class Space:
    """Axes that project points in space along a direction of view."""

    axes: Axes
    view: View

    def line(self, points: ArrayLike, **options: Any) -> None:
        """Draw a line through points; rows of NaN break it."""
        self.axes.plot(*self.view.flat(points).T, **{"color": INK, "lw": 1.0, **options})

    def dots(self, points: ArrayLike, **options: Any) -> None:
        """Draw points."""
        look = {"ls": "none", "marker": "o", "ms": 4.5, "zorder": 6, "mew": 0.0}
        self.line(np.atleast_2d(points), **{**look, **options})

    def faces(self, corners: ArrayLike, **options: Any) -> None:
        """Draw flat faces, far ones first."""
        corners = np.asarray(corners, dtype=np.float64)
        order = np.argsort(self.view.nearness(corners.mean(axis=1)), kind="stable")
        colors = options.pop("facecolors", "none")
        if not isinstance(colors, str):
            colors = np.asarray(colors)[order]
        polygons = load("matplotlib.collections", extra="plot").PolyCollection(
            self.view.flat(corners[order]), facecolors=colors, **{"lw": 0.0, **options}
        )
        self.axes.add_collection(polygons)
        self.axes.autoscale_view()

    def name(self, point: ArrayLike, text: str, away: tuple[float, float], **options: Any) -> None:
        """Write a label next to a point."""
        label(self.axes, self.view.flat(point), text, away, **options)

    def coordinate_axes(self, lengths: tuple[float, float, float]) -> None:
        """Draw the axes Ox, Oy, Oz as arrows from O."""
        self.name((0, 0, 0), "$O$", (-10, 6))
        for axis, length in enumerate(lengths):
            tip = np.zeros(3)
            tip[axis] = length
            self.arrow(np.zeros(3), tip)
            x, y = self.view.flat(tip) / np.linalg.norm(self.view.flat(tip))
            self.name(tip, f"${'xyz'[axis]}$", (9 * x, 9 * y))

    def arrow(self, start: ArrayLike, tip: ArrayLike, **options: Any) -> None:
        """Draw an arrow."""
        ends = self.view.flat(np.array([start, tip]))
        patch = load("matplotlib.patches", extra="plot").FancyArrowPatch(
            *map(tuple, ends), mutation_scale=9, **{**ARROW, **options}
        )
        self.axes.add_patch(patch)
        self.axes.update_datalim(ends)
        self.axes.autoscale_view()
