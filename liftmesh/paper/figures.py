"""The paper's figures, drawn from computed data, all of them into a folder or individually.

Figures 2.1 to 5.2 show results of the other modules of this room: exact planes and cross-sections,
real triangulations and hulls, random points. Figures 6.1 and 6.2 show the printed running times,
and ours if measured. Two additional figures show the effect of the restricted region, four what the
last section names (a power diagram, another metric, a metric for each point, and disks), and one
the upper hull. Each function returns a matplotlib ``Figure`` that is not attached to a window. The
bytes of the files depend on the figures alone.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liftmesh.io.atomic import replacing
from liftmesh.optional import load
from liftmesh.paper.pictures.anisotropic import figure_adaptive, figure_metric, figure_stars
from liftmesh.paper.pictures.cross_section import figure_4_1, figure_4_2
from liftmesh.paper.pictures.lifting import figure_2_1, figure_2_2, figure_5_1, figure_5_2
from liftmesh.paper.pictures.region import figure_3_1, figure_4_3
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
from liftmesh.paper.pictures.weighted import figure_disks, figure_farthest, figure_power
from liftmesh.paper.printed import TABLES, TableName
from liftmesh.paper.tables import ENGINE, INDEXED, LF, LFRES, Row
from liftmesh.planar.lifting import REJECTIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
    _legend(figure, columns=3 if rows else 2)
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


Drawer: TypeAlias = "Callable[[], Figure]"

FIXED: Mapping[str, Drawer] = {
    "figure_2_1": figure_2_1,
    "figure_2_2": figure_2_2,
    "figure_3_1": figure_3_1,
    "figure_4_1": figure_4_1,
    "figure_4_2": figure_4_2,
    "figure_4_3": figure_4_3,
    "figure_5_1": figure_5_1,
    "figure_5_2": figure_5_2,
    "power_diagram": figure_power,
    "metric": figure_metric,
    "farthest": figure_farthest,
    "stars": figure_stars,
    "disks": figure_disks,
    "adaptive_thinning": figure_adaptive,
}
"""The figures that do not need measurements: the paper's, and what its last section names."""

TIMED: Mapping[str, Callable[[Sequence[Row]], Figure]] = {
    "figure_6_1": figure_6_1,
    "figure_6_2": figure_6_2,
}
"""The figures of running times: printed ones, and measured ones if there are any."""

MEASURED: Mapping[str, Callable[[Sequence[Row]], Figure]] = {
    "rejections": figure_rejections,
    "dot_products": figure_dot_products,
}
"""The figures that show measurements only."""

DOTS_PER_INCH = 180


def draw_all(
    directory: Path,
    *,
    results: Sequence[Row] | None = None,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Draw all figures into a folder, each as PNG and as SVG."""
    directory.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    for name, draw in _drawers(results or ()):
        if progress is not None:
            progress(name)
        files += save(draw(), directory, name)
    return files


def _drawers(results: Sequence[Row]) -> Iterator[tuple[str, Drawer]]:
    yield from FIXED.items()
    for name, draw in {**TIMED, **(MEASURED if results else {})}.items():
        yield name, partial(draw, results)


@styled
def save(figure: Figure, directory: Path, name: str) -> list[Path]:
    """Write a figure as ``name.png`` and ``name.svg``."""
    return [_write(directory / f"{name}.{kind}", figure, kind) for kind in ("png", "svg")]


def _write(path: Path, figure: Figure, kind: str) -> Path:
    # No date, no version: the bytes depend on the figure alone. The salt fixes SVG's random names.
    nothing: dict[str, Any] = (
        {"Software": None} if kind == "png" else {"Date": None, "Creator": None}
    )
    drawn = io.BytesIO()
    with load("matplotlib", extra="plot").rc_context({"svg.hashsalt": path.stem}):
        figure.savefig(drawn, format=kind, dpi=DOTS_PER_INCH, metadata=nothing)
    with replacing(path, follow_links=False) as stream:
        stream.write(drawn.getvalue())
    return path
