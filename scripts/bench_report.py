"""What was measured, as a table to read and as JSON for a plot."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bench_peers import OURS, PEERS
from bench_rounds import Timing, best_rival, ratio
from rich.table import Table

Ratios = dict[str, float | None]


@dataclass(frozen=True)
class Measurement:
    """One input and all its timings; a lattice has a few rows less than the size asked for."""

    distribution: str
    size: int
    rows: int
    timings: dict[str, Timing]

    def seconds_per_row(self) -> float:
        return self.timings[OURS].median / self.rows

    def ratios(self) -> Ratios:
        """Our time over shull's and over that of the fastest rival with a right result."""
        rival = best_rival(self.timings)
        return {
            "shull": ratio(self.timings, "shull"),
            "best": ratio(self.timings, rival) if rival else None,
        }


def table_of(measurements: list[Measurement], peers: list[str]) -> Table:
    """Lay out one row an input: seconds with their spread, ratios, memory."""
    table = Table(
        title="One thread. Seconds: median (fastest to slowest round)",
        caption="* wrong result, - no result; the best is the fastest rival whose result is right",
    )
    for heading in ("input", "rows"):
        table.add_column(heading, no_wrap=True)
    for heading in (*peers, "ours/shull", "ours/best", "per row/uniform", "bytes a point"):
        table.add_column(heading, justify="right")
    uniform = {m.size: m.seconds_per_row() for m in measurements if m.distribution == "uniform"}
    for m in measurements:
        table.add_row(m.distribution, f"{m.rows:,}", *cells(m, peers, uniform.get(m.size)))
    return table


def cells(measurement: Measurement, peers: list[str], uniform: float | None) -> Iterator[str]:
    """Write the cells after the first two; `uniform` is what a row costs us on uniform points."""
    for name in peers:
        yield seconds_cell(measurement.timings[name])
    for value in measurement.ratios().values():
        yield f"{value:.2f}" if value else "-"
    yield f"{measurement.seconds_per_row() / uniform:.2f}" if uniform else "-"
    yield f"{measurement.timings[OURS].trial.bytes_per_point:.0f}"


def seconds_cell(timing: Timing) -> str:
    if not timing.seconds:
        return "-"
    low, high = min(timing.seconds), max(timing.seconds)
    star = "*" if timing.trial.flaw else ""
    return f"{timing.median:.3f}{star} ({low:.3f}-{high:.3f})"


def flaws_of(measurements: list[Measurement]) -> Iterator[str]:
    """Say for each wrong or absent result what is wrong."""
    for measurement in measurements:
        for name, timing in measurement.timings.items():
            if timing.trial.flaw:
                yield f"{name} on {measurement.distribution}: {timing.trial.flaw}"


def write_json(
    path: Path, measurements: list[Measurement], imports: dict[str, float], settings: dict[str, Any]
) -> None:
    """Write everything, raw seconds included, to a neighbouring file that is then renamed."""
    report = {
        "machine": machine(),
        "versions": {name: PEERS[name].version for name in settings["peers"]},
        "settings": settings,
        "import_seconds": imports,
        "measurements": [as_record(measurement) for measurement in measurements],
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".part")
    beside.write_text(json.dumps(report, indent=1, default=str) + "\n")
    beside.replace(path)


def as_record(measurement: Measurement) -> dict[str, Any]:
    return {
        "distribution": measurement.distribution,
        "rows": measurement.rows,
        "ratios": measurement.ratios(),
        "peers": {
            name: {"seconds": timing.seconds, "trial": asdict(timing.trial)}
            for name, timing in measurement.timings.items()
        },
    }


def machine() -> dict[str, Any]:
    return {
        "system": platform.platform(),
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        "numpy": np.__version__,
    }
