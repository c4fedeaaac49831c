"""The results as tables for the terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table

from benchmark.contestants import Contestant
from benchmark.peers import BEFORE, SORT
from benchmark.results import Measurement, Timing, ours

if TYPE_CHECKING:
    from benchmark.targets import Target

LEGEND = (
    "* wrong result, - no result, > cut off, (>) cut off on fewer points already, 1 only the trial"
)
THREADS = (1, 2)
DISTURBED = 0.15  # processors kept busy by other programs above which a note is printed


def tables_of(measurements: list[Measurement]) -> Iterator[Table]:
    """Make the tables of times, ratios and memory, with a row for each input."""
    yield seconds_table(measurements)
    yield ratio_table(measurements)
    yield memory_table(measurements)


def contestants_of(measurements: list[Measurement]) -> list[Contestant]:
    """Return all contestants in the order of their first appearance."""
    return list(dict.fromkeys(who for m in measurements for who in m.timings))


def input_table(title: str, caption: str, headings: list[str]) -> Table:
    table = Table(title=title, caption=caption, title_justify="left", caption_justify="left")
    for heading in ("input", "rows"):
        table.add_column(heading, no_wrap=True, justify="right" if heading == "rows" else "left")
    for heading in headings:
        table.add_column(heading, justify="right")
    return table


def seconds_table(measurements: list[Measurement]) -> Table:
    """Make the table of times: the median of the rounds, and their spread."""
    everybody = contestants_of(measurements)
    unit, factor = unit_of(measurements)
    title = f"{unit} a call: median, spread; x2 on two threads"
    table = input_table(title, LEGEND, [who.label for who in everybody])
    for m in measurements:
        cells = [seconds_cell(m.timings.get(who), factor) for who in everybody]
        table.add_row(m.distribution, f"{m.rows:,}", *cells)
    return table


def unit_of(measurements: list[Measurement]) -> tuple[str, float]:
    """Choose the unit by the slowest contestant."""
    medians = [t.median for m in measurements for t in m.timings.values() if t.ran]
    return ("Microseconds", 1e6) if max(medians, default=1.0) < 0.01 else ("Milliseconds", 1e3)


def seconds_cell(timing: Timing | None, factor: float = 1e3) -> str:
    if timing is None:
        return ""
    if not timing.ran:
        return trouble_cell(timing)
    star = "*" if timing.trial.flaw else ""
    spread = f"±{timing.spread:.0%}" if len(timing.rounds) > 1 else "1"
    return f"{digits(factor * timing.median)}{star} {spread}"


def trouble_cell(timing: Timing) -> str:
    bound, _, smaller = timing.trial.trouble.partition(" at ")
    if not timing.trial.cut_off:
        return "-"
    return f"({bound})" if smaller else bound


def digits(value: float) -> str:
    """Format three significant digits, or all digits before the point."""
    for places, bound in ((0, 100), (1, 10), (2, 1)):
        if value >= bound:
            return f"{value:,.{places}f}"
    return f"{value:#.3g}"


def ratio_table(measurements: list[Measurement]) -> Table:
    """Compare our time with the best exact peer's, and with our own on uniform points."""
    headings = [
        heading
        for threads in THREADS
        for heading in (f"best exact peer, {threads} thr.", "our time / its", "per row / uniform")
    ]
    caption = "exact: the result passed the check on this input; ratios are medians over the rounds"
    headings += [
        f"time / before, {threads} thr." for threads in THREADS if was_before(measurements)
    ]
    table = input_table("Ratios", caption, [*headings, "1 thread / 2", "our time / numpy.sort"])
    uniform = {m.size: m for m in measurements if m.distribution == "uniform"}
    for m in measurements:
        cells = [c for threads in THREADS for c in best_cells(m, threads, uniform.get(m.size))]
        if was_before(measurements):
            cells += [number(m.against_before(threads)) for threads in THREADS]
        table.add_row(m.distribution, f"{m.rows:,}", *cells, number(m.gain(2)), sort_cell(m))
    return table


def was_before(measurements: list[Measurement]) -> bool:
    """Whether a former version took part."""
    return any(who.peer == BEFORE for m in measurements for who in m.timings)


def best_cells(m: Measurement, threads: int, uniform: Measurement | None) -> Iterator[str]:
    rival = m.best_rival(threads)
    yield rival.label if rival else "-"
    yield number(m.against_best(threads))
    here, there = m.seconds_per_row(ours(threads)), None
    if uniform:
        there = uniform.seconds_per_row(ours(threads))
    yield number(here / there if here and there else None)


def sort_cell(m: Measurement) -> str:
    ratios = [m.ratio(ours(threads), Contestant(SORT)) for threads in THREADS]
    return " / ".join(f"{ratio:.1f}" for ratio in ratios if ratio)


def number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}" if value < 0.1 else f"{value:.2f}"


def memory_table(measurements: list[Measurement]) -> Table:
    """Make the table of peak memory in the trial, beyond that before the call."""
    everybody = [who for who in contestants_of(measurements) if who.peer != SORT]
    caption = "results included; small inputs show the least amount by which a process grows"
    title = "Peak memory, bytes a point beyond the input"
    table = input_table(title, caption, [who.label for who in everybody])
    for m in measurements:
        cells = [memory_cell(m, m.timings.get(who)) for who in everybody]
        table.add_row(m.distribution, f"{m.rows:,}", *cells)
    return table


def memory_cell(m: Measurement, timing: Timing | None) -> str:
    if timing is None:
        return ""
    return f"{timing.trial.beyond / m.rows:,.0f}" if timing.ran else "-"


def target_table(targets: list[Target]) -> Table:
    """Make the table of targets: what was reached, and whether that is enough."""
    table = Table(title="Targets", title_justify="left")
    for heading, justify in (("work", "left"), ("measure", "left"), ("target", "right")):
        table.add_column(heading, justify=justify)
    table.add_column("reached", justify="right")
    table.add_column("met")
    words = {True: "[green]yes[/]", False: "[red]no[/]", None: "not measured"}
    for target in targets:
        bound = f"{'≥' if target.least else '≤'} {target.bound:.3g}{target.unit}"
        reached = "-" if target.reached is None else f"{target.reached:.3g}{target.unit}"
        table.add_row(target.work, target.what, bound, reached, words[target.met])
    return table


def notes_of(measurements: list[Measurement]) -> Iterator[str]:
    """Describe each wrong or missing result; equal descriptions are merged."""
    places: dict[tuple[str, str], list[str]] = {}
    for m in measurements:
        for who, timing in m.timings.items():
            said = timing.trial.flaw or ("" if timing.trial.cut_off else timing.trial.trouble)
            if said:
                places.setdefault((who.label, said), []).append(f"{m.distribution} {m.rows:,}")
    for (label, said), inputs in places.items():
        rest = f" and {len(inputs) - 3} more" if len(inputs) > 3 else ""
        yield escape(f"{label}: {said} ({', '.join(inputs[:3])}{rest})")
    yield from disturbances(measurements)


def disturbances(measurements: list[Measurement]) -> Iterator[str]:
    """Name the inputs that were measured while other programs kept the processors busy."""
    for m in measurements:
        if m.others > DISTURBED:
            place = f"{m.distribution} {m.rows:,}"
            yield f"{place}: other programs kept {m.others:.1f} processors busy, measure again"
