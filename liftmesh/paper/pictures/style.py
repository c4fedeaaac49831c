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
    """Run a function with the style of the figures, and restore the user's settings.

    Parameters
    ----------
    function : callable
        A function that makes or writes figures.

    Returns
    -------
    callable
        The same function, with the settings in effect while it runs.

    Examples
    --------
    >>> import matplotlib
    >>> styled(lambda: matplotlib.rcParams["mathtext.fontset"])()
    'cm'
    """

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        with load("matplotlib.style", extra="plot").context(["default", _SETTINGS]):
            return function(*args, **kwargs)

    return wrapper


def new_figure(width: float, height: float) -> Figure:
    """Make an empty figure that is not attached to a window.

    Parameters
    ----------
    width, height : float
        Size in inches.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Examples
    --------
    >>> new_figure(6, 4).get_size_inches().tolist()
    [6.0, 4.0]
    """
    figure: Figure = load("matplotlib.figure", extra="plot").Figure(figsize=(width, height))
    return figure


def blank_axes(figure: Figure, box: tuple[float, float, float, float]) -> Axes:
    """Add axes for a drawing to scale: no frame, no ticks, equal units.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    box : tuple of float
        Left, bottom, width and height as fractions of the figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Examples
    --------
    >>> blank_axes(new_figure(2, 2), (0, 0, 1, 1)).get_aspect()
    1.0
    """
    axes = figure.add_axes(box)
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.06)
    return axes


def legend_below(figure: Figure, handles: Sequence[Any], **options: Any) -> None:
    """Explain what is drawn, in one line at the bottom.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    handles : sequence of matplotlib.artist.Artist
        Samples with labels.
    **options
        As for ``Figure.legend``.

    Examples
    --------
    >>> figure = new_figure(2, 2)
    >>> legend_below(figure, blank_axes(figure, (0, 0, 1, 1)).plot([0], [0], label="point"))
    >>> figure.legends[0].get_texts()[0].get_text()
    'point'
    """
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
    """Write a label next to a point, with a halo that separates it from lines.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes.
    at : (2,) array_like
        The point in data units.
    text : str
        The label; mathtext between dollar signs.
    away : tuple of float, default (0, 0)
        Offset of the label's centre from the point, in typographic points.
    **options
        As for ``Axes.annotate``.

    Examples
    --------
    >>> axes = blank_axes(new_figure(2, 2), (0, 0, 1, 1))
    >>> label(axes, (0, 0), "$a'$", (8, 8))
    >>> axes.texts[0].get_text()
    "$a'$"
    """
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
