"""The resources that this process holds, the signals it hears, and the processes below it."""

from __future__ import annotations

import gc
import os
import re
import resource
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

MEGA = 1_000_000

# Makes malloc return freed memory to the system at once, so that resident memory shows leaks.
RETURNING = {
    "MALLOC_ARENA_MAX": "2",
    "MALLOC_MMAP_THRESHOLD_": "65536",
    "MALLOC_TRIM_THRESHOLD_": "65536",
    "OPENBLAS_NUM_THREADS": "1",
}


@dataclass(frozen=True, slots=True)
class State:
    """The resources of this process at one moment."""

    resident: int
    files: int
    threads: int

    @classmethod
    def now(cls) -> State:
        """Measure after a garbage collection."""
        gc.collect()
        return cls(_resident(), _listed("fd"), _listed("task"))

    @classmethod
    def settled(cls, threads: int, patience: float = 5.0) -> State:
        """Wait until at most `threads` threads are left, since ended ones linger; then measure."""
        end = time.monotonic() + patience
        while _listed("task") > threads and time.monotonic() < end:
            time.sleep(0.01)
        return cls.now()


def _resident() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - read often
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _listed(kind: str) -> int:
    return len(os.listdir(f"/proc/self/{kind}"))  # noqa: PTH208 - as above


def hear_ctrl_c() -> None:
    """Give SIGINT its default back, also in children: it is inherited as ignored after nohup."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def descendants(process: int | str = "self") -> Iterator[int]:
    """Yield the numbers of all processes below a process, the nearest first."""
    with suppress(OSError):  # it may end meanwhile
        for thread in Path(f"/proc/{process}/task").iterdir():
            for child in (thread / "children").read_text("ascii").split():
                yield int(child)
                yield from descendants(child)


@contextmanager
def halted(child: subprocess.Popen[Any]) -> Iterator[None]:
    """Stop a child: what is seen of it is still so when it hears a signal sent meanwhile."""
    child.send_signal(signal.SIGSTOP)
    status = Path(f"/proc/{child.pid}/status")
    while child.poll() is None and not re.search(
        r"^State:\s+[TZ]", status.read_text("ascii"), re.MULTILINE
    ):
        time.sleep(0.0005)
    try:
        yield
    finally:
        child.send_signal(signal.SIGCONT)


def memory(field: str) -> int:
    """Read a size in bytes from /proc/self/status."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(field):
            return int(line.split()[1]) * 1024
    raise OSError(f"/proc/self/status has no {field}: memory can be measured on Linux only")


def limit_memory(room: int) -> None:
    """Limit the address space to what is in use and some room."""
    most = memory("VmSize") + room
    resource.setrlimit(resource.RLIMIT_AS, (most, resource.RLIM_INFINITY))
