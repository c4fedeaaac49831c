"""How CPU seconds grow, on sizes that double until a case has had its time.

Seconds show what counts of small inputs cannot: steps that only large inputs take, and quadratic
work with a small constant. They scatter, so the fastest of two calls counts, sizes that take less
than half a millisecond are left out, and the tests do not measure them. Where a case has had its
time before its sizes differ by eight, it starts from smaller ones; one that still has no two such
sizes counts as not measured, which fails.
"""

from __future__ import annotations

import gc
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import isnan, log, nan
from typing import TYPE_CHECKING

from growth.counting import attempt
from growth.growing import MOST, most_of

if TYPE_CHECKING:
    from growth.subjects import Subject

FIRST = 1 << 12
LARGEST = 1 << 22
SHORTEST = 0.0005
PATIENCE = 20
APART = 8


class _TooLongError(Exception):
    """A call takes many times as long as its case may."""


@dataclass(slots=True)
class Timing:
    """The seconds of a case by the units of its input, and the error that ended it, if any."""

    subject: str
    family: str
    seconds: dict[int, float] = field(default_factory=dict)
    ended: str = ""

    @property
    def ratio(self) -> float:
        """The largest ratio of the cost of a unit between sizes eight apart; nan without such.

        Where work does not double with the input, the next larger size stands for the eighth.
        """
        costs = [(units, time / units) for units, time in self.seconds.items() if time > SHORTEST]
        ratios = []
        for least, small in costs:
            for most, large in costs:
                if most / least >= APART * 0.9:
                    ratios.append((large / small) ** (log(APART) / log(most / least)))
                    break
        return max(ratios, default=nan)

    @property
    def verdict(self) -> str:
        """What is wrong, in words; an empty string if nothing is.

        A case without a ratio was not measured, and is not said to be fine.
        """
        if not self.ended and isnan(self.ratio):
            return "not measured"
        most = max(most_of((self.subject, self.family)), MOST)  # seconds scatter
        if self.ended or self.ratio > most:
            return self.ended or "grows"
        return "known" if self.ratio > MOST else ""


def timed(subject: Subject, family: str, budget: float) -> Timing:
    """Time a case, from smaller sizes on where the usual ones take too long for a ratio."""
    found = Timing(subject.name, family)
    for first in (FIRST, FIRST // APART, FIRST // APART**2):
        found = doubled(subject, family, budget, first)
        if not isnan(found.ratio):
            break
    return found


def doubled(subject: Subject, family: str, budget: float, first: int) -> Timing:
    """Time a case on doubling sizes until they have taken the budget, in seconds of CPU."""
    found = Timing(subject.name, family)
    size, spent = first, 0.0
    while spent < budget and size <= LARGEST:
        before = time.process_time()
        try:
            with limited(budget * PATIENCE):
                units, taken = once(subject, family, size)
        except _TooLongError:
            found.ended = f"over {budget * PATIENCE:.0f} s at {size:,}"
            break
        except MemoryError:
            break
        found.seconds[units] = taken
        spent += time.process_time() - before
        size *= 2
    return found


def once(subject: Subject, family: str, size: int) -> tuple[int, float]:
    """Return the units of one input, and the CPU seconds of the faster of two calls."""
    work = subject.prepare(subject.families[family](size))
    gc.collect()
    taken = []
    for _ in range(2):
        begin = time.process_time()
        attempt(work.call)
        taken.append(time.process_time() - begin)
        if taken[0] > 1:
            break
    return work.units, min(taken)


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise in what takes longer."""
    previous = signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, previous)


def _stop(*_: object) -> None:
    raise _TooLongError
