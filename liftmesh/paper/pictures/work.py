"""Effect of the restricted region: what decides points in LFRes, and the remaining dot products."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh.paper.pictures.running_times import LOOKS, log_axes
from liftmesh.paper.pictures.style import (
    BLUE,
    FAINT,
    GREEN,
    PURPLE,
    SKY,
    VERMILION,
    YELLOW,
    label,
    new_figure,
    styled,
)
from liftmesh.paper.printed import TABLES
from liftmesh.paper.summary import INDEXED, LF, LFRES
from liftmesh.planar.lifting import REJECTIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.paper.summary import Row

COLORS = dict(zip(REJECTIONS, (BLUE, SKY, GREEN, YELLOW, PURPLE, VERMILION), strict=True))
TITLES = {"origin": "$q = O$", "median": "$q$ = the median point"}


@styled
def figure_rejections(results: Sequence[Row]) -> Figure:
    """Draw the share of points that each proposition decides, for every number of points."""
    figure = new_figure(9.0, 4.5)
    for axes, rows in _panels(figure, results, bottom=0.3, pad=22):
        _shares(axes, rows)
    _legend(figure, columns=4)
    return figure


def _panels(
    figure: Figure, results: Sequence[Row], *, bottom: float, pad: float
) -> Iterator[tuple[Axes, list[Row]]]:
    """Yield axes for each measured table, and its rows by number of points."""
    groups = {name: [row for row in results if row.table == name] for name in TABLES}
    measured = [name for name, rows in groups.items() if rows]
    for column, name in enumerate(measured):
        left = 0.075 + 0.5 * column + 0.25 * (len(measured) == 1)
        axes = figure.add_axes((left, bottom, 0.41, 0.88 - bottom))
        axes.set_title(f"Table {name}: {TITLES[TABLES[name].q]}", pad=pad)
        yield axes, sorted(groups[name], key=lambda row: row.n)


def _legend(figure: Figure, columns: int) -> None:
    handles, labels = figure.axes[0].get_legend_handles_labels() if figure.axes else ([], [])
    figure.legend(handles, labels, loc="lower center", ncols=columns, frameon=False)


def _shares(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw one bar per number of points, divided by proposition; dot products on top."""
    places, base = np.arange(len(rows)), np.zeros(len(rows))
    for name in REJECTIONS:
        shares = np.array([100 * row.rejected[name] for row in rows])
        axes.bar(places, shares, bottom=base, color=COLORS[name], label=name, width=0.78, gid=name)
        base += shares
    axes.bar(
        places, 100 - base, bottom=base, color=FAINT, label="dot product (share above)", width=0.78
    )
    for place, share in zip(places, base, strict=True):
        label(axes, (place, 100), f"{100 - share:.0f}%", (0, 8), fontsize=9)
    slant: dict[str, Any] = {"rotation": 35, "ha": "right"} if len(rows) > 5 else {}
    axes.set_xticks(places, labels=[f"{row.n:,}" for row in rows], **slant)
    axes.set(xlabel="points, $n$", ylabel="points looked at by LFRes, %", ylim=(0, 100))


@styled
def figure_dot_products(results: Sequence[Row]) -> Figure:
    """Draw the dot products per facet of LF, LFRes and the indexed region."""
    figure = new_figure(9.0, 4.0)
    for axes, rows in _panels(figure, results, bottom=0.25, pad=8):
        for method in (LF, LFRES, INDEXED):
            counts = [row.dot_products[method] for row in rows]
            axes.plot([row.n for row in rows], counts, ms=4.5, lw=1.6, gid=method, **LOOKS[method])
        log_axes(axes)
        axes.set(xlabel="points, $n$", ylabel="dot products a facet")
    _legend(figure, columns=3)
    return figure
