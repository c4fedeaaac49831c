"""Common style of all figures: fonts, colours and sizes, independent of the user's settings.

Colours are those of Okabe and Ito (2008), which colour-blind readers can distinguish too. Figures
are made without pyplot, so there is no global state and no window opens.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from liftmesh.optional import load

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

P = ParamSpec("P")
R = TypeVar("R")

INK, SOFT, FAINT, GRID = "#1a1a1a", "#6e6e6e", "#c9c9c9", "#dddddd"
BLUE, SKY, GREEN, ORANGE = "#0072b2", "#56b4e9", "#009e73", "#e69f00"
VERMILION, PURPLE, YELLOW = "#d55e00", "#cc79a7", "#f0e442"

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
    """Make an empty figure that is not attached to a window."""
    figure: Figure = load("matplotlib.figure", extra="plot").Figure(figsize=(width, height))
    return figure


def blank_axes(figure: Figure, box: tuple[float, float, float, float]) -> Axes:
    """Add axes for a drawing to scale: no frame, no ticks, equal units."""
    axes = figure.add_axes(box)
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.06)
    return axes


def legend_below(figure: Figure, handles: Sequence[Any], **options: Any) -> None:
    """Explain what is drawn, in one line at the bottom."""
    figure.legend(
        handles=handles,
        loc="lower center",
        ncols=len(handles),
        frameon=False,
        labelcolor=SOFT,
        **options,
    )


def label(
    axes: Axes, at: Any, text: str, away: tuple[float, float] = (0.0, 0.0), **options: Any
) -> None:
    """Write a label next to a point, with a halo that separates it from lines."""
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
