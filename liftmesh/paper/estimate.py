"""Estimate of the duration of the experiments: the paper's growth, calibrated by a short run.

The seconds printed for LF and LFRes grow like a power of n slightly above two. A run on at most a
thousand points calibrates it for this machine; the other methods are too fast to matter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from statistics import median
from time import perf_counter
from typing import TypeAlias

from liftmesh._typing import Floats
from liftmesh.base.options import Method
from liftmesh.paper.experiments import BURST, METHODS, PATIENCE, ROUNDS, Trial
from liftmesh.paper.printed import TABLES, TableName, Vertex
from liftmesh.planar.delaunay import delaunay

Estimate: TypeAlias = Callable[[Trial], float]

_WRAPPING = METHODS[:2]
_ENOUGH = 1_000
"""Number of points for which LF and LFRes take a tenth of a second and follow their growth."""


def growth(table: TableName) -> float:
    """Return the power of n with which the printed seconds of LF and LFRes together grow."""
    first, last = TABLES[table].rows[0], TABLES[table].rows[-1]
    ratio = (last.lf + last.lfres) / (first.lf + first.lfres)
    return math.log(ratio) / math.log(last.n / first.n)


def calibrate(trials: Iterable[Trial]) -> Estimate:
    """Time LF and LFRes on a small set for each table, to predict the time of all trials."""
    timed: dict[TableName, Trial] = {}
    for trial in sorted(trials):
        timed.setdefault(trial.table, replace(trial, n=min(trial.n, _ENOUGH)))
    seconds = {table: _seconds_of_each(trial) for table, trial in timed.items()}

    def estimate(trial: Trial) -> float:
        size = (trial.n / timed[trial.table].n) ** growth(trial.table)
        quick = ROUNDS * BURST * (len(METHODS) - len(_WRAPPING))
        return quick + sum(_all_rounds(once * size) for once in seconds[trial.table])

    return estimate


def _seconds_of_each(trial: Trial) -> list[float]:
    points = trial.points()
    return [median(_once(points, method, trial.q) for _ in range(3)) for method in _WRAPPING]


def _once(points: Floats, method: Method, q: Vertex) -> float:
    start = perf_counter()
    delaunay(points, method=method, q=q)
    return perf_counter() - start


def _all_rounds(once: float) -> float:
    """Return the seconds of all rounds of a method, given the seconds of a single run."""
    spent = max(once, BURST)
    return spent * min(ROUNDS, max(1, int(PATIENCE / spent)))
