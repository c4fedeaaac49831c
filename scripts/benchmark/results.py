"""The results: times, medians, spreads, ratios, and the best exact peer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median

from benchmark.contestants import Contestant
from benchmark.peers import BEFORE, OURS, RIVALS

Calls = tuple[float, ...]


@dataclass(frozen=True)
class Trial:
    """The first run in a fresh process.

    `trouble` says why there is no result, `flaw` what is wrong with it. `peak` is the peak of
    resident memory, `beyond` the part of it above that before the call, both in bytes.
    """

    trouble: str = ""
    flaw: str = ""
    cut_off: bool = False
    seconds: float = 0.0
    triangles: int = 0
    beyond: int = 0
    peak: int = 0
    version: str = ""


@dataclass(frozen=True)
class Timing:
    """A contestant on one input: its trial, and the seconds of each call in each round."""

    trial: Trial
    rounds: tuple[Calls, ...] = ()

    @property
    def seconds(self) -> Calls:
        """The median of the calls of each round."""
        return tuple(median(calls) for calls in self.rounds)

    @property
    def median(self) -> float:
        return median(self.seconds)

    @property
    def spread(self) -> float:
        """Half the difference between the slowest and fastest round, as a share of the median."""
        return (max(self.seconds) - min(self.seconds)) / (2 * self.median)

    @property
    def ran(self) -> bool:
        return bool(self.rounds) and not self.trial.trouble

    @property
    def right(self) -> bool:
        """Whether the time may be compared with others: it ran, and its result is correct."""
        return self.ran and not self.trial.flaw


@dataclass(frozen=True)
class Measurement:
    """One input and all its timings; a lattice has a few rows fewer than the requested size.

    `others` is the number of processors that other programs kept busy meanwhile.
    """

    distribution: str
    size: int
    rows: int
    timings: Mapping[Contestant, Timing]
    others: float = 0.0

    def timing(self, contestant: Contestant) -> Timing | None:
        """Return the timing of a contestant if it ran."""
        timing = self.timings.get(contestant)
        return timing if timing and timing.ran else None

    def seconds_per_row(self, contestant: Contestant) -> float | None:
        timing = self.timing(contestant)
        return timing.median / self.rows if timing else None

    def ratio(self, one: Contestant, other: Contestant) -> float | None:
        """Return the median over rounds of the time of one divided by that of the other."""
        first, second = self.timing(one), self.timing(other)
        if not (first and second):
            return None
        pairs = zip(first.seconds, second.seconds, strict=False)
        return median(a / b for a, b in pairs)

    def best_rival(self, threads: int) -> Contestant | None:
        """Return the fastest exact peer on at most that many threads."""
        rivals = [
            contestant
            for contestant, timing in self.timings.items()
            if contestant.peer in RIVALS and contestant.threads <= threads and timing.right
        ]
        return min(rivals, key=lambda rival: self.timings[rival].median, default=None)

    def against_best(self, threads: int) -> float | None:
        """Return our time divided by that of the best exact peer."""
        rival = self.best_rival(threads)
        return self.ratio(ours(threads), rival) if rival else None

    def against_before(self, threads: int) -> float | None:
        """Return our time divided by that of the former version."""
        return self.ratio(ours(threads), Contestant(BEFORE, threads))

    def gain(self, threads: int) -> float | None:
        """Return our speedup on several threads."""
        return self.ratio(ours(1), ours(threads))


def ours(threads: int) -> Contestant:
    return Contestant(OURS, threads)
