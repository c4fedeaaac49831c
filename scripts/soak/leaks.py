"""Whether what a process holds stays flat.

Memory varies from call to call, and while caches fill it grows: so the first fifth of the samples
does not count, and of the rest the least memory of the later half is held against the least of the
earlier half. Open files and threads must be as many at the end as after the first fifth.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from process_state import MEGA, State


def counted(samples: Sequence[State]) -> Sequence[State]:
    """Leave the warm-up out."""
    return samples[len(samples) // 5 :]


def growth(samples: Sequence[State]) -> int:
    """How many bytes the least memory of the later half lies above that of the earlier one."""
    resident = [each.resident for each in counted(samples)]
    half = len(resident) // 2
    return min(resident[half:]) - min(resident[:half])


def faults(samples: Sequence[State], most: int) -> Iterator[str]:
    """Say what is not flat."""
    if growth(samples) > most:
        yield f"memory grew by {growth(samples) / MEGA:.1f} MB, more than {most / MEGA:.1f}"
    first, last = counted(samples)[0], samples[-1]
    if last.files > first.files:
        yield f"{last.files} files are open, where there were {first.files}"
    if last.threads > first.threads:
        yield f"{last.threads} threads are there, where there were {first.threads}"
