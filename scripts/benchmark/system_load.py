"""The processor time that other programs take during a measurement.

It includes other virtual machines on the same host (steal time). Times measured under such a load
mean little, those on two threads least, so the load is reported with them.
"""

from __future__ import annotations

import os
from pathlib import Path
from time import perf_counter

STATISTICS = Path("/proc/stat")
BUSY = (1, 2, 3, 6, 7, 8)  # user, nice, system, irq, softirq, steal


class SystemLoad:
    """The load since construction; child processes count as ours once they have ended."""

    def __init__(self) -> None:
        self.start = perf_counter()
        self.others = seconds_of_others()

    def processors(self) -> float:
        """Return the number of processors that other programs kept busy on average."""
        elapsed = perf_counter() - self.start
        return max(0.0, seconds_of_others() - self.others) / elapsed


def seconds_of_others() -> float:
    """Return the processor time since boot, less that of this process and its children."""
    if not STATISTICS.exists():
        return 0.0
    fields = STATISTICS.read_text().splitlines()[0].split()
    busy = sum(int(fields[k]) for k in BUSY) / os.sysconf("SC_CLK_TCK")
    return busy - sum(os.times()[:4])
