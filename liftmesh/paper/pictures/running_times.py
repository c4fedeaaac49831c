"""Figures 6.1 and 6.2: the printed running times, and ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from liftmesh.paper.pictures.style import (
    BLUE,
    GREEN,
    PURPLE,
    VERMILION,
    new_figure,
    styled,
)
from liftmesh.paper.printed import TABLES, TableName
from liftmesh.paper.summary import ENGINE, INDEXED, LF, LFRES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from liftmesh.paper.summary import Row

LOOKS: Mapping[str, Mapping[str, Any]] = {
    LF: {"label": "LF", "color": BLUE, "marker": "o"},
    LFRES: {"label": "LFRes", "color": VERMILION, "marker": "s"},
    INDEXED: {"label": "LFRes, indexed", "color": GREEN, "marker": "D"},
    ENGINE: {"label": "default engine", "color": PURPLE, "marker": "v"},
}
TICKS = (100, 200, 500, 1_000, 2_000, 5_000, 10_000, 20_000, 50_000, 100_000, 1_000_000)


@styled
def figure_6_1(results: Sequence[Row] | None = None) -> Figure:
    """Draw the running times of case 1: q is the origin."""
    return _running_times("5.1", results or ())


@styled
def figure_6_2(results: Sequence[Row] | None = None) -> Figure:
    """Draw the running times of case 2: q is the median point."""
    return _running_times("5.2", results or ())


def _running_times(table: TableName, results: Sequence[Row]) -> Figure:
    figure = new_figure(9.0, 4.3 if results else 4.0)
    rows = sorted((row for row in results if row.table == table), key=lambda row: row.n)
    for column, scale in enumerate(("linear", "log")):
        bottom = 0.26 if rows else 0.22
        axes = figure.add_axes((0.075 + 0.5 * column, bottom, 0.41, 0.97 - bottom))
        _printed(axes, table)
        _measured(axes, rows)
        _scales(axes, scale)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=3 if rows else 2, frameon=False)
    return figure


def _printed(axes: Axes, table: TableName) -> None:
    """Draw the printed times dashed, with hollow marks that do not hide ours."""
    rows = TABLES[table].rows
    sizes = [row.n for row in rows]
    look: dict[str, Any] = {"ls": (0, (3, 2)), "mfc": "none", "ms": 7, "lw": 1.1, "zorder": 4}
    for method, seconds in ((LF, [row.lf for row in rows]), (LFRES, [row.lfres for row in rows])):
        name = {"label": f"{LOOKS[method]['label']}, printed", "gid": f"printed {method}"}
        axes.plot(sizes, seconds, **{**LOOKS[method], **look, **name})


def _measured(axes: Axes, rows: Sequence[Row]) -> None:
    """Draw the medians over the seeds, and the band from the fastest seed to the slowest."""
    for method, look in LOOKS.items():
        kept = [row for row in rows if method in row.seconds]
        if not kept:
            continue
        sizes = [row.n for row in kept]
        low, high = zip(*(row.spread[method] for row in kept), strict=True)
        axes.fill_between(sizes, low, high, color=look["color"], alpha=0.18, lw=0)
        axes.plot(sizes, [row.seconds[method] for row in kept], ms=4.5, lw=1.6, gid=method, **look)


def _scales(axes: Axes, scale: str) -> None:
    axes.set(xlabel="points, $n$", ylabel="seconds")
    if scale == "log":
        log_axes(axes)
        return
    _grid(axes)
    axes.set(xlim=(0, None), ylim=(0, None))
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.locator_params(axis="x", nbins=5)


def log_axes(axes: Axes) -> None:
    """Make both axes logarithmic, with numbers of points as tick labels."""
    axes.set(xscale="log", yscale="log")
    _grid(axes)
    least, greatest = axes.get_xlim()
    room = (3_000,) if greatest < 10 * least else ()  # on longer axes it touches its neighbours
    ticks = [tick for tick in sorted((*TICKS, *room)) if least <= tick <= greatest]
    axes.set_xticks(ticks, labels=[f"{tick:,}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.tick_params(which="minor", labelleft=False)


def _grid(axes: Axes) -> None:
    axes.grid(visible=True)
    axes.set_axisbelow(True)
