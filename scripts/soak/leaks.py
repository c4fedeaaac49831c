"""Detect leaks of memory, open files and threads from samples of a process.

Memory varies from call to call, and grows while caches fill. So the first fifth of the samples is
warm-up; of the rest, the minimum of the second half is compared with the minimum of the first half.
There must be no more open files and threads at the end than after the warm-up.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from process_state import MEGA, State


def after_warm_up(samples: Sequence[State]) -> Sequence[State]:
    """Drop the first fifth of the samples."""
    return samples[len(samples) // 5 :]


def growth(samples: Sequence[State]) -> int:
    """Subtract the minimum of memory in the first half from that in the second, in bytes."""
    resident = [each.resident for each in after_warm_up(samples)]
    half = len(resident) // 2
    return min(resident[half:]) - min(resident[:half])


def leaks(samples: Sequence[State], most: int) -> Iterator[str]:
    """Describe every leak."""
    if growth(samples) > most:
        yield f"memory grew by {growth(samples) / MEGA:.1f} MB, more than {most / MEGA:.1f}"
    first, last = after_warm_up(samples)[0], samples[-1]
    if last.files > first.files:
        yield f"{last.files} files are open, where there were {first.files}"
    if last.threads > first.threads:
        yield f"{last.threads} threads are there, where there were {first.threads}"
