"""What was measured, and what follows: medians, spreads, ratios, the best exact peer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median

from benchmark.contestants import Contestant
from benchmark.peers import OURS, RIVALS

Calls = tuple[float, ...]


@dataclass(frozen=True)
class Trial:
    """What the first run in a fresh process found.

    With `trouble` there is no result, with a `flaw` a wrong one. `beyond` is the peak of memory
    less what the process held before, `peak` all that it held, both in bytes.
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
        """One number a round: the median of its calls."""
        return tuple(median(calls) for calls in self.rounds)

    @property
    def median(self) -> float:
        return median(self.seconds)

    @property
    def spread(self) -> float:
        """Half of the way from the fastest to the slowest round, as a share of the median."""
        return (max(self.seconds) - min(self.seconds)) / (2 * self.median)

    @property
    def ran(self) -> bool:
        return bool(self.rounds) and not self.trial.trouble

    @property
    def right(self) -> bool:
        """Whether the time may be held against another's."""
        return self.ran and not self.trial.flaw


@dataclass(frozen=True)
class Measurement:
    """One input and all its timings; a lattice has a few rows less than the size asked for.

    `others` is the number of processors that other programs kept busy meanwhile.
    """

    distribution: str
    size: int
    rows: int
    timings: Mapping[Contestant, Timing]
    others: float = 0.0

    def timing(self, contestant: Contestant) -> Timing | None:
        """Give the timing of a contestant that ran."""
        timing = self.timings.get(contestant)
        return timing if timing and timing.ran else None

    def seconds_per_row(self, contestant: Contestant) -> float | None:
        timing = self.timing(contestant)
        return timing.median / self.rows if timing else None

    def ratio(self, one: Contestant, other: Contestant) -> float | None:
        """Divide the time of one by that of another: the median of the ratios in each round."""
        first, second = self.timing(one), self.timing(other)
        if not (first and second):
            return None
        pairs = zip(first.seconds, second.seconds, strict=False)
        return median(a / b for a, b in pairs)

    def best_rival(self, threads: int) -> Contestant | None:
        """Name the fastest other peer whose result is right, on so many threads or fewer."""
        rivals = [
            contestant
            for contestant, timing in self.timings.items()
            if contestant.peer in RIVALS and contestant.threads <= threads and timing.right
        ]
        return min(rivals, key=lambda rival: self.timings[rival].median, default=None)

    def against_best(self, threads: int) -> float | None:
        """Divide our time by that of the best exact peer."""
        rival = self.best_rival(threads)
        return self.ratio(ours(threads), rival) if rival else None

    def gain(self, threads: int) -> float | None:
        """How many times faster more threads make us."""
        return self.ratio(ours(1), ours(threads))


def ours(threads: int) -> Contestant:
    return Contestant(OURS, threads)
