"""The results as JSON: every time measured, the contestants, and the machine."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark.contestants import Contestant
from benchmark.results import Measurement, Timing, Trial
from liftmesh.paper.experiments import describe_machine, versions

if TYPE_CHECKING:
    from benchmark.targets import Target

NOTE = (
    "Seconds: a list for each round, a number for each call. Results are checked at full size. "
    "Memory is that of a first run in a fresh process, in bytes. Others is the number of "
    "processors that other programs kept busy."
)


def write(
    path: Path,
    measurements: list[Measurement],
    targets: list[Target],
    imports: Mapping[str, float],
    settings: Mapping[str, Any],
) -> None:
    """Write a report under a temporary name, then rename it."""
    report = {
        "note": NOTE,
        "machine": describe_machine(),
        "versions": versions() | peer_versions(measurements),
        "settings": settings,
        "import_seconds": imports,
        "targets": [asdict(target) | {"met": target.met} for target in targets],
        "measurements": [as_record(measurement) for measurement in measurements],
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".part")
    temporary.write_text(compact(json.dumps(report, indent=1, default=str)) + "\n")
    temporary.replace(path)


def compact(text: str) -> str:
    """Write every list of plain values on one line."""
    return re.sub(r"\[[^\[\]{}]*\]", lambda found: re.sub(r"\s+", " ", found[0]), text)


def peer_versions(measurements: list[Measurement]) -> dict[str, str]:
    return {
        who.peer: timing.trial.version
        for m in measurements
        for who, timing in m.timings.items()
        if timing.trial.version
    }


def as_record(m: Measurement) -> dict[str, Any]:
    rivals = {threads: m.best_rival(threads) for threads in (1, 2)}
    return {
        "distribution": m.distribution,
        "size": m.size,
        "rows": m.rows,
        "others": round(m.others, 3),
        "best_exact_peer": {str(k): rival.label for k, rival in rivals.items() if rival},
        "ratio_to_best": {str(threads): m.against_best(threads) for threads in rivals},
        "ratio_to_before": {str(threads): m.against_before(threads) for threads in rivals},
        "contestants": [as_entry(who, timing) for who, timing in m.timings.items()],
    }


def as_entry(who: Contestant, timing: Timing) -> dict[str, Any]:
    rounds = [[float(f"{seconds:.6g}") for seconds in calls] for calls in timing.rounds]
    trial = {key: value for key, value in asdict(timing.trial).items() if key != "version"}
    return {"peer": who.peer, "threads": who.threads, "trial": trial, "seconds": rounds}


def read(path: Path) -> list[Measurement]:
    """Read the measurements of a report, to draw or print them again."""
    found = json.loads(path.read_text())["measurements"]
    return [
        Measurement(
            m["distribution"], m["size"], m["rows"], timings_of(m["contestants"]), m["others"]
        )
        for m in found
    ]


def timings_of(entries: list[dict[str, Any]]) -> dict[Contestant, Timing]:
    return {
        Contestant(entry["peer"], entry["threads"]): Timing(
            Trial(**entry["trial"]), tuple(tuple(calls) for calls in entry["seconds"])
        )
        for entry in entries
    }
