"""The process whose system calls fail: `python -m fault_injection.worker FOLDER SEED SHARE JOBS`.

It prints a line of JSON for each fault, and in the end one with the sums.
"""

from __future__ import annotations

import json
import os
import random
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from fault_injection.jobs import jobs
from fault_injection.sweep import Case, Sweep

ROWS = (5, 300, 2000, 5000)
FOREVER = 1e9  # seconds: all cases, once


def main() -> None:
    """Go through a share of the cases, and again with larger files until the time is over."""
    folder, seed, share, of, cases, seconds = sys.argv[1:]
    report = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    end, left = time.monotonic() + float(seconds), int(cases)
    count, slowest, passes = 0, (0.0, ""), 0
    while left > count and time.monotonic() < end:
        passes += 1
        for case, check in chosen(Path(folder), int(seed) + passes - 1, int(share), int(of)):
            Path(folder, "current").write_text(str(case))
            took, wrong = check(case)
            count += 1
            slowest = max(slowest, (took, str(case)))
            if wrong:
                report.write(json.dumps({"fault": f"{case}: {wrong}"}) + "\n")
            if time.monotonic() > end or count == left:
                break
        if float(seconds) >= FOREVER:
            break
    sums = {"cases": count, "passes": passes, "slowest": slowest}
    report.write(json.dumps({"sums": sums}) + "\n")


def chosen(
    folder: Path, seed: int, share: int, of: int
) -> Iterator[tuple[Case, Callable[[Case], tuple[float, str]]]]:
    """Yield a share of the cases in files of a size that the seed decides."""
    rows = random.Random(seed).choice(ROWS)
    samples = folder / f"samples-{rows}"
    samples.mkdir(exist_ok=True)
    sweep = Sweep(folder, jobs(samples, rows))
    for case in sweep.cases(seed)[share::of]:
        yield case, sweep.check


if __name__ == "__main__":
    main()
