"""The number of threads of a run: given by the caller, by the environment, or one per core."""

from __future__ import annotations

import operator
import os
from typing import Any

from liftmesh import _kernel
from liftmesh.base.options import shown
from liftmesh.errors import InputError

VARIABLE = "LIFTMESH_NUM_THREADS"
MOST_THREADS = 1024


def as_threads(threads: int | None, rows: int) -> tuple[int, bool]:
    """Return how many threads a run may use, and whether it shares them with other runs."""
    if threads is not None:
        return _checked(threads, "threads", threads), False
    if rows < 2 * _kernel.ROWS_PER_THREAD:
        return 1, True
    chosen = os.environ.get(VARIABLE)
    return (_checked(_number(chosen), VARIABLE, chosen) if chosen else _cores()), True


def _number(text: str) -> int | None:
    try:
        return int(text)
    except ValueError:
        return None


def _checked(threads: Any, name: str, given: object) -> int:
    """Validate a number of threads; True does not count as 1."""
    try:
        count = 0 if isinstance(threads, bool) else operator.index(threads)
    except TypeError:
        count = 0
    if 1 <= count <= MOST_THREADS:
        return count
    raise InputError(f"{name} is {shown(given)}: give a whole number from 1 to {MOST_THREADS}")


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return min(len(os.sched_getaffinity(0)), MOST_THREADS)
    return min(os.cpu_count() or 1, MOST_THREADS)  # pragma: no cover - not Linux
