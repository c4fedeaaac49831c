"""Call liftmesh many times in one process and look for leaks of memory, files and threads.

    python scripts/soak                     100,000 small calls and 20 of a million rows
    python scripts/soak --calls 5000 --large 3 --rows 100000

Small calls are of every kind, on up to some hundred points of several distributions. They include
broken files, wrong options, and calls that a signal handler or `progress` aborts. Large calls
triangulate, verify, locate points, write and read. Memory, open files and threads are printed on
the way. The first fifth of the calls is warm-up; after it, the minimum of memory in the second half
may exceed that in the first half by `--most` megabytes (for large calls, plus a sixteenth of the
size of one call's arrays), and no file or thread may be left. Exits with 1 otherwise.
"""

from __future__ import annotations

import os
import sys
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from process_state import MEGA, RETURNING, State
from soak.calls import Aborted, large_call, load_libraries, small_call
from soak.leaks import growth, leaks

SAMPLES = 40
SHOWN = 10
HELD = 116 + 24 + 12 + 24 + 16  # bytes a row, roughly: the kernel's peak and the arrays


def main() -> None:
    """Make all calls, and print what leaks."""
    if not RETURNING.items() <= os.environ.items():  # malloc reads them when a process begins
        os.execve(sys.executable, sys.orig_argv, {**os.environ, **RETURNING})
    options = read_options()
    sys.unraisablehook = ignore_aborted
    found = [
        *leaks_of("small", small(options), options.most * MEGA),
        *leaks_of("large", large(options), options.rows * HELD / 16 + options.most * MEGA),
    ]
    print("; ".join(found) or "flat")
    raise SystemExit(int(bool(found)))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--calls", type=int, default=100_000)
    add("--large", type=int, default=20)
    add("--rows", type=int, default=1_000_000, help="of a large call")
    add("--most", type=float, default=3.0, metavar="MB")
    add("--seed", type=int, default=0)
    return parser.parse_args()


def ignore_aborted(unraisable: sys.UnraisableHookArgs) -> None:
    """Silence an `Aborted` that cannot propagate, such as one raised in a destructor."""
    if not isinstance(unraisable.exc_value, Aborted):
        sys.__unraisablehook__(unraisable)


def small(options: Namespace) -> Iterator[State]:
    """Make small calls, and yield a sample now and then."""
    rng = np.random.default_rng(options.seed)
    raised: Counter[str] = Counter()
    load_libraries()
    for number in range(1, options.calls + 1):
        raised[small_call(rng)] += 1
        if number % max(options.calls // SAMPLES, 1) == 0:
            yield State.now()
    print(", ".join(f"{count:,} {name or 'succeeded'}" for name, count in raised.most_common()))


def large(options: Namespace) -> Iterator[State]:
    """Make large calls, and yield a sample after each."""
    rng = np.random.default_rng(options.seed)
    for number in range(options.large):
        large_call(number, options.rows, rng)
        yield State.now()


def leaks_of(name: str, samples: Iterator[State], most: float) -> list[str]:
    """Print some of the samples as they come, and return what leaks."""
    began, taken = time.monotonic(), []
    for sample in samples:
        taken.append(sample)
        if len(taken) % max(SAMPLES // SHOWN, 1) == 0 or name == "large":
            print(
                f"{name} {time.monotonic() - began:6.0f} s  {sample.resident / MEGA:7.1f} MB  "
                f"{sample.files} files  {sample.threads} threads",
                flush=True,
            )
    print(f"{name}: {growth(taken) / MEGA:+.1f} MB in {time.monotonic() - began:.0f} s", flush=True)
    return [f"{name} calls: {leak}" for leak in leaks(taken, int(most))]


if __name__ == "__main__":
    main()
