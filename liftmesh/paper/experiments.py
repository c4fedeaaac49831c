"""One experiment of Section 5: a random set of points, and the time of every method on it.

The paper takes n points uniform in [0, 200] x [0, 200] and times Algorithm 2 with LF and with
LFRes. Two methods that the paper does not have are added here: the restricted region as a query
into a spatial index, and the default engine. The whole call of `liftmesh.delaunay` is timed, from
planar points to triangles with their neighbours; the vertex q is given as a point, so that
computing the median is not included.

The methods run in rounds of alternating order, so that drifts of the machine's speed affect all
alike. A fast method runs several times per round; a slow one is omitted from later rounds. All
methods must find the same facets; anything else is a bug.

How long the experiments will take is estimated first. The seconds printed for LF and LFRes grow
like a power of n slightly above two; a run on at most a thousand points calibrates it for this
machine; the other methods are too fast to matter.
"""

from __future__ import annotations

import gc
import hashlib
import math
import os
import platform
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.base.options import Algorithm
from liftmesh.paper.printed import SQUARE, TABLES, TableName, Vertex
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.lifting import REJECTIONS, resolve_apex

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

METHODS: tuple[Algorithm, ...] = ("lf", "lfres", "lfres-indexed", "divide-and-conquer")
"""The methods of a round, in order."""

ROUNDS = 5
"""Maximum number of rounds."""

PATIENCE = 3.0
"""Maximum seconds of a method in all rounds; in the first round it always runs."""

BURST = 0.01
"""Seconds for which a fast method is repeated within a round."""

Estimate: TypeAlias = "Callable[[Trial], float]"
_WRAPPING = METHODS[:2]

_ENOUGH = 1_000
"""Number of points for which LF and LFRes take a tenth of a second and follow their growth."""

_PROCESSORS = Path("/proc/cpuinfo")


@dataclass(frozen=True, slots=True, order=True)
class Trial:
    """A random set of points and the vertex of the paraboloid, the input of all methods."""

    table: TableName
    n: int
    seed: int

    @property
    def q(self) -> Vertex:
        """The vertex of the paraboloid: "origin" or "median"."""
        return TABLES[self.table].q

    def points(self) -> Floats:
        """Generate the points, the same for both tables."""
        return np.random.default_rng(self.seed).uniform(0.0, SQUARE, (self.n, 2))


@dataclass(frozen=True, slots=True)
class Measurement:
    """Measurement of one method on one set of points."""

    trial: Trial
    method: str
    seconds: float  # median of all runs
    fastest: float
    slowest: float
    runs: int
    facets: int
    calls: int
    planes: int
    evaluations: int
    undecided: int  # dot products whose sign the exact predicate decided
    rejected: Mapping[str, int]  # points by each proposition


@dataclass(slots=True)
class _Runs:
    """Times and latest result of the runs of one method."""

    method: Algorithm
    seconds: list[float] = field(default_factory=list)
    result: Triangulation | None = None


def measure(trial: Trial, progress: Callable[[str], None] = lambda _: None) -> list[Measurement]:
    """Time every method on one set of points."""
    points = trial.points()
    q = resolve_apex(trial.q, points)
    runs = [_Runs(method) for method in METHODS]
    gc.collect()
    for done in range(ROUNDS):
        for run in runs[:: 1 if done % 2 == 0 else -1]:
            if done == 0 or sum(run.seconds) * (done + 1) / done <= PATIENCE:
                progress(run.method)
                _burst(run, points, q)
    return _agreed(trial, runs)


def warm_up() -> None:
    """Run every method once, so that no measurement includes the loading of modules."""
    for table in TABLES:
        for method in METHODS:
            delaunay(Trial(table, 100, seed=0).points(), algorithm=method, apex=TABLES[table].q)


def _burst(run: _Runs, points: Floats, q: tuple[float, float]) -> None:
    """Run a method repeatedly for at least ``BURST`` seconds."""
    total = 0.0
    while total < BURST:
        start = perf_counter()
        run.result = delaunay(points, algorithm=run.method, apex=q)
        run.seconds.append(perf_counter() - start)
        total += run.seconds[-1]


def _agreed(trial: Trial, runs: list[_Runs]) -> list[Measurement]:
    """Check that all methods found the same facets, and return the measurements."""
    first: Rows | None = None
    measurements = []
    for run, result in [(run, run.result) for run in runs if run.result is not None]:
        facets = _facets(result)
        if first is not None and not np.array_equal(facets, first):
            raise RuntimeError(f"{METHODS[0]} and {run.method} found different facets of {trial}")
        first = facets
        measurements.append(_measurement(trial, run, result))
    return measurements


def _facets(result: Triangulation) -> Rows:
    """Return the set of facets as sorted rows that begin with their least vertex."""
    rows = result.simplices
    rotated = np.take_along_axis(rows, (rows.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    return rotated[np.lexsort(rotated.T[::-1])]


def _measurement(trial: Trial, run: _Runs, result: Triangulation) -> Measurement:
    counters = result.counters
    return Measurement(
        trial,
        run.method,
        seconds=median(run.seconds),
        fastest=min(run.seconds),
        slowest=max(run.seconds),
        runs=len(run.seconds),
        facets=len(result.simplices),
        calls=counters.calls if counters else 0,
        planes=counters.candidate_planes if counters else 0,
        evaluations=counters.evaluations if counters else 0,
        undecided=counters.undecided if counters else 0,
        rejected=dict(counters.rejected) if counters else dict.fromkeys(REJECTIONS, 0),
    )


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


def _once(points: Floats, method: Algorithm, q: Vertex) -> float:
    start = perf_counter()
    delaunay(points, algorithm=method, apex=q)
    return perf_counter() - start


def _all_rounds(once: float) -> float:
    """Return the seconds of all rounds of a method, given the seconds of a single run."""
    spent = max(once, BURST)
    return spent * min(ROUNDS, max(1, int(PATIENCE / spent)))


def describe_machine() -> str:
    """Describe this machine."""
    count = os.cpu_count() or 1
    words = [_processor(), f"{count} processor" + ("s" if count > 1 else ""), _memory()]
    return ", ".join([*filter(None, words), f"{platform.system()} {platform.machine()}"])


def versions() -> dict[str, str]:
    """Return the versions of the software that measurements depend on."""
    kernel = Path(str(_kernel.__file__)).read_bytes()
    return {
        "liftmesh": version("liftmesh"),
        "kernel": hashlib.sha256(kernel).hexdigest()[:12],
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def _processor() -> str:
    """Return the processor's name from Linux, or from Python on other systems."""
    if _PROCESSORS.is_file():  # pragma: no branch - Linux
        lines = _PROCESSORS.read_text("utf-8", errors="replace").splitlines()
        for line in lines:  # pragma: no branch - one of them names it
            name, _, value = line.partition(":")
            if name.strip() == "model name":  # pragma: no branch - a line of Linux
                return " ".join(value.split())
    return platform.processor()  # pragma: no cover - not Linux


def _memory() -> str:
    if "SC_PHYS_PAGES" not in getattr(os, "sysconf_names", {}):
        return ""  # pragma: no cover - not Linux
    size = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return f"{size / 2**30:.0f} GiB of memory"
