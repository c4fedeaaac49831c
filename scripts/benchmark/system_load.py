"""What else kept the processors busy meanwhile: other programs, and other machines on the host.

Times taken beside them say little, those on two threads least, so they are told.
"""

from __future__ import annotations

import os
from pathlib import Path
from time import perf_counter

ACCOUNT = Path("/proc/stat")
BUSY = (1, 2, 3, 6, 7, 8)  # user, nice, system, interrupts, soft interrupts, stolen


class SystemLoad:
    """From here on; the children that count as ours are those that have ended when it is asked."""

    def __init__(self) -> None:
        self.start = perf_counter()
        self.foreign = foreign_seconds()

    def processors(self) -> float:
        """Give the number of processors that others kept busy, on average."""
        elapsed = perf_counter() - self.start
        return max(0.0, foreign_seconds() - self.foreign) / elapsed


def foreign_seconds() -> float:
    """Sum up processor time since the machine started, less that of this process and its own."""
    if not ACCOUNT.exists():
        return 0.0
    fields = ACCOUNT.read_text().splitlines()[0].split()
    busy = sum(int(fields[k]) for k in BUSY) / os.sysconf("SC_CLK_TCK")
    return busy - sum(os.times()[:4])
