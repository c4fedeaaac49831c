"""What a process holds on to: resident memory, open files, threads."""

from __future__ import annotations

import gc
import os
import time
from dataclasses import dataclass

MEGA = 1_000_000

# Memory that malloc would keep for later goes back to the system, so that what is held shows.
RETURNING = {
    "MALLOC_ARENA_MAX": "2",
    "MALLOC_MMAP_THRESHOLD_": "65536",
    "MALLOC_TRIM_THRESHOLD_": "65536",
    "OPENBLAS_NUM_THREADS": "1",
}


@dataclass(frozen=True, slots=True)
class State:
    """Of this process, now."""

    resident: int
    files: int
    threads: int

    @classmethod
    def now(cls) -> State:
        """Measure after a collection."""
        gc.collect()
        return cls(_resident(), _listed("fd"), _listed("task"))

    @classmethod
    def settled(cls, threads: int, patience: float = 5.0) -> State:
        """Measure once no more than so many threads are left, as the system puts them away."""
        end = time.monotonic() + patience
        while _listed("task") > threads and time.monotonic() < end:
            time.sleep(0.01)
        return cls.now()


def _resident() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - read often
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _listed(kind: str) -> int:
    return len(os.listdir(f"/proc/self/{kind}"))  # noqa: PTH208 - as above
