"""A peer on a number of threads, and the process it runs in."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmark import cgal
from benchmark.peers import CGAL, PEERS
from benchmark.process import NoAnswerError, Process

SCRIPTS = Path(__file__).resolve().parent.parent
PROGRAMS = SCRIPTS.parent / "out" / "programs"
POOLS = ("LIFTMESH", "RAYON", "OMP", "OPENBLAS", "MKL")  # each reads <NAME>_NUM_THREADS

# A process keeps the memory that it freed. So a round measures the program and not how long the
# system takes to find fresh pages, which only the trial includes.
KEEP_MEMORY = "glibc.malloc.mmap_threshold=1099511627776:glibc.malloc.trim_threshold=1099511627776"


INTERPRETERS: dict[str, str] = {}
"""Of the peers that are installed somewhere else than for this interpreter."""


@dataclass(frozen=True, order=True)
class Contestant:
    """A peer on a number of threads, each in a process of its own, as thread pools are kept."""

    peer: str
    threads: int = 1

    @property
    def label(self) -> str:
        return f"{self.peer} x{self.threads}" if self.threads > 1 else self.peer

    def start(self) -> Process:
        environment = {f"{name}_NUM_THREADS": str(self.threads) for name in POOLS}
        environment["GLIBC_TUNABLES"] = KEEP_MEMORY
        paths = (str(SCRIPTS), os.environ.get("PYTHONPATH"))
        environment["PYTHONPATH"] = os.pathsep.join(filter(None, paths))
        return Process(self.command(), environment, SCRIPTS)

    def command(self) -> list[str]:
        if self.peer == CGAL:
            return [cgal_program()]
        interpreter = INTERPRETERS.get(self.peer, sys.executable)
        return [interpreter, "-m", "benchmark.worker", self.peer, str(self.threads)]


@cache
def cgal_program() -> str:
    try:
        return str(cgal.build(PROGRAMS))
    except cgal.UnavailableError as error:
        raise NoAnswerError(f"not available: {error}") from error


def line_up(peers: Iterable[str], threads: Iterable[int]) -> Iterator[Contestant]:
    """Combine every peer with every number of threads; sequential peers take part once."""
    for name in peers:
        for count in threads if PEERS[name].parallel else (1,):
            yield Contestant(name, count)
