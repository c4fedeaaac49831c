"""Pictures of the results: time against the number of points, and bars for each input."""

from __future__ import annotations

from math import log
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from benchmark.peers import OURS, PEERS
from benchmark.tables import contestants_of, digits

if TYPE_CHECKING:
    from benchmark.contestants import Contestant
    from benchmark.results import Measurement, Timing

STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#888888",
    "axes.titleweight": "bold",
    "svg.fonttype": "none",
    "svg.hashsalt": "liftmesh",
}
LEADER = {"linestyle": ":", "linewidth": 0.8, "relpos": (0, 0.5)}
COLUMNS = 4


def draw(measurements: list[Measurement], path: Path) -> list[Path]:
    """Draw the pictures as PNG and SVG in the folder of a path; return the files."""
    made: list[Path] = []
    with mpl.rc_context(STYLE):
        uniform = [m for m in measurements if m.distribution == "uniform"]
        if len({m.rows for m in uniform}) > 1:
            made += save(growth(uniform), path, "growth")
        size = widest(measurements)
        chosen = [m for m in measurements if m.size == size]
        if chosen:
            made += save(bars(chosen), path, "inputs")
    return made


def save(figure: Figure, path: Path, name: str) -> list[Path]:
    files = [path.with_name(f"{path.stem}-{name}{suffix}") for suffix in (".png", ".svg")]
    for file in files:
        date: dict[str, Any] = {"Date": None} if file.suffix == ".svg" else {}
        figure.savefig(file, dpi=160, bbox_inches="tight", metadata=date)
    return files


def widest(measurements: list[Measurement]) -> int:
    """Return the size at which most distributions were measured; on a tie, the larger."""
    sizes = [m.size for m in measurements]
    return max(sizes, key=lambda size: (sizes.count(size), size), default=0)


def growth(measurements: list[Measurement]) -> Figure:
    """Draw the time a point against the number of points, a line for each contestant."""
    figure = Figure(figsize=(8, 5.4), layout="constrained")
    axes = figure.add_subplot()
    ends = []
    for who in contestants_of(measurements):
        shown = [m for m in measurements if m.timing(who)]
        if shown:
            rows = [m.rows for m in shown]
            costs = [1e6 * (m.seconds_per_row(who) or 0) for m in shown]
            draw_line(axes, who, rows, costs)
            ends.append((costs[-1], rows[-1], who))
    axes.set(xscale="log", yscale="log", xlabel="points", ylabel="µs a point")
    axes.set_title("Uniform points: time a point", loc="left")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.grid(which="major", color="#e6e6e6", linewidth=0.8)
    label_ends(axes, ends, max(m.rows for m in measurements))
    return figure


def draw_line(axes: Any, who: Contestant, rows: list[int], costs: list[float]) -> None:
    bold = who.peer == OURS
    axes.plot(
        rows,
        costs,
        color=PEERS[who.peer].color,
        linestyle="--" if who.threads > 1 else "-",
        linewidth=2.4 if bold else 1.4,
        marker="o",
        markersize=5 if bold else 3.5,
        zorder=3 if bold else 2,
    )


def label_ends(axes: Any, ends: list[tuple[float, int, Contestant]], right: int) -> None:
    """Label the lines in a column at the right, spread out and connected by thin lines."""
    low, high = np.log(axes.get_ylim())
    ends = sorted(ends, key=lambda end: end[0])
    heights = np.exp(spread_out([log(cost) for cost, _, _ in ends], (high - low) / 25))
    for (cost, rows, who), height in zip(ends, heights, strict=True):
        color = PEERS[who.peer].color
        axes.annotate(
            who.label.replace(" x2", ", 2 threads"),
            (rows, cost),
            xytext=(right * 2.0, height),
            va="center",
            color=color,
            weight="bold" if who.peer == OURS else "normal",
            arrowprops={"arrowstyle": "-", "color": color, **LEADER},
            annotation_clip=False,
        )


def spread_out(heights: list[float], gap: float) -> list[float]:
    """Move increasing heights apart: those that are too close form a stack around their mean."""
    stacks: list[list[float]] = []
    for height in heights:
        stacks.append([height])
        while len(stacks) > 1 and bottom(stacks[-1], gap) < bottom(stacks[-2], -gap) + gap:
            stacks[-2:] = [stacks[-2] + stacks[-1]]
    return [bottom(stack, gap) + place * gap for stack in stacks for place in range(len(stack))]


def bottom(stack: list[float], gap: float) -> float:
    """Return the lowest position of a stack; with the gap negated, the highest."""
    return fmean(stack) - gap * (len(stack) - 1) / 2


def bars(measurements: list[Measurement]) -> Figure:
    """Draw a panel for each input, a bar for each contestant on one scale of time."""
    everybody = [who for who in contestants_of(measurements) if who.peer != "numpy.sort"]
    columns = min(COLUMNS, len(measurements))
    lines = -(-len(measurements) // columns)
    height = lines * (0.17 * len(everybody) + 0.55) + 0.6
    figure = Figure(figsize=(1.3 + 2.5 * columns, height), layout="constrained")
    panels = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False).reshape(-1)
    for panel, measurement in zip(panels, measurements, strict=False):
        draw_panel(panel, measurement, everybody)
    for panel in panels[len(measurements) :]:
        panel.remove()
    for panel in panels[max(0, len(measurements) - columns) : len(measurements)]:
        panel.tick_params(labelbottom=True)
    finish(panels, measurements, everybody)
    figure.suptitle(f"{measurements[0].size:,} points of each kind", weight="bold")
    figure.supxlabel("µs a point", fontsize=9)
    return figure


def draw_panel(axes: Any, m: Measurement, everybody: list[Contestant]) -> None:
    for place, who in enumerate(everybody):
        timing, cost = m.timings.get(who), m.seconds_per_row(who)
        if timing and cost:
            axes.barh(place, 1e6 * cost, **bar_style(who, timing))
        axes.annotate(
            f" {bar_words(timing)}",
            (1e6 * cost if cost else 0, place),
            xycoords="data" if cost else ("axes fraction", "data"),
            va="center",
            fontsize=7,
            weight="bold" if who.peer == OURS else "normal",
            color="#444444",
        )
    axes.set_title(m.distribution, loc="left", fontsize=9)


def bar_style(who: Contestant, timing: Timing) -> dict[str, Any]:
    """Hatch wrong results; use a paler colour for one thread if two threads are shown too."""
    color = PEERS[who.peer].color
    if timing.trial.flaw:
        return {"facecolor": "none", "edgecolor": color, "hatch": "////"}
    pale = who.threads == 1 and PEERS[who.peer].parallel
    return {"color": color, "alpha": 0.6 if pale else 1.0}


def bar_words(timing: Timing | None) -> str:
    """Return the label at the end of a bar."""
    if timing is None:
        return ""
    if not timing.ran:
        return timing.trial.trouble.partition(" at ")[0] if timing.trial.cut_off else "no result"
    wrong = " wrong" if timing.trial.flaw else ""
    return f"{digits(1000 * timing.median)} ms{wrong}"


def finish(panels: Any, measurements: list[Measurement], everybody: list[Contestant]) -> None:
    found = [m.seconds_per_row(who) for m in measurements for who in everybody]
    costs = [1e6 * cost for cost in found if cost]
    first = panels[0]
    first.set_xscale("log")
    first.xaxis.set_major_formatter("{x:g}")
    first.set_xlim(min(costs) / 2, max(costs) * 8)
    first.set_yticks(range(len(everybody)), [who.label for who in everybody])
    first.invert_yaxis()
