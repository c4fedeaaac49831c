"""Time the peers on one input in alternating rounds, so that a drifting machine hits all alike."""

from __future__ import annotations

import gc
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from bench_peers import OURS, PEERS
from bench_trial import Trial
from distributions import Points

IMPORT = "import numpy, time; start = time.perf_counter(); {}; print(time.perf_counter() - start)"
IMPORTS = {
    "import liftmesh": "import liftmesh",
    "import liftmesh, first call": (
        "import liftmesh; liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).simplices"
    ),
}


@dataclass(frozen=True)
class Timing:
    """One peer on one input: what its trial found, and the seconds of each round."""

    trial: Trial
    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        return median(self.seconds)

    @property
    def counts(self) -> bool:
        """Whether the result is right, so that its time may be held against another's."""
        return bool(self.seconds) and not self.trial.flaw


def time_rounds(
    points: Points, trials: dict[str, Trial], repeat: int, patience: float
) -> dict[str, Timing]:
    """Time every peer that came back from its trial, A B C A B C, each time on a fresh copy.

    A slow peer sits out the later rounds: it gets one, or as many as patience allows.
    """
    seconds: dict[str, list[float]] = {name: [] for name in trials}
    for done in range(repeat):
        for name, trial in trials.items():
            if trial.seconds and (done == 0 or (done + 1) * trial.seconds <= patience):
                seconds[name].append(time_once(name, points))
    return {name: Timing(trials[name], tuple(seconds[name])) for name in trials}


def time_once(name: str, points: Points) -> float:
    fresh = points.copy()
    gc.collect()
    start = time.perf_counter()
    triangles = PEERS[name].triangulate(fresh)
    elapsed = time.perf_counter() - start
    del triangles
    return elapsed


def ratio(timings: dict[str, Timing], rival: str) -> float | None:
    """Our time over the rival's: the median of the ratios within each round."""
    if OURS not in timings or not (rival in timings and timings[rival].seconds):
        return None
    pairs = zip(timings[OURS].seconds, timings[rival].seconds, strict=False)
    return median(ours / theirs for ours, theirs in pairs)


def best_rival(timings: dict[str, Timing]) -> str | None:
    """Name the fastest other peer whose result is right."""
    rivals = [name for name, timing in timings.items() if name != OURS and timing.counts]
    return min(rivals, key=lambda name: timings[name].median, default=None)


def import_seconds(repeat: int) -> dict[str, float]:
    """Median seconds that an import takes in a fresh process which has imported NumPy already."""
    return {
        name: median(run_seconds(IMPORT.format(statement)) for _ in range(repeat))
        for name, statement in IMPORTS.items()
    }


def run_seconds(program: str) -> float:
    command: Sequence[str] = (sys.executable, "-c", program)
    return float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
