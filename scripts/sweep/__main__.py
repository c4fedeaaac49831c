"""Send SIGINT and SIGTERM at random moments of every command, with every format.

    python scripts/sweep                              5,000 runs: about half an hour
    python scripts/sweep --seconds 3600
    python scripts/sweep --runs 1 --first 1234        one run again
    python scripts/sweep --runs 500 --commands volume profile
    python scripts/sweep --long                       commands on files of 10,000,000 rows

Every fourth run sends two signals. Exits with 1 if a command ends otherwise than by its first
signal and with one line, or with its result if that was there before; if it takes more than
`--most` seconds from the signal, or `--second` from the second one, to its end; or if a file is not
whole, was written after the signal, or was left behind.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from jobs import LONG_COMMANDS, commands
from process_state import hear_ctrl_c
from sweep.jobs import learn, prepare
from sweep.runs import AFTER, BEFORE, DURING, Run, plan, run


def main() -> None:
    """Run the sweep, and print a line for each fault and a summary."""
    hear_ctrl_c()
    options = read_options()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="liftmesh-", dir=options.folder) as name:
        runs = list(sweep(Path(name).resolve(), options))
    faults = sum(map(bool, (each.faults for each in runs)))
    print(f"{summary(runs)}; {faults} faults, in {time.monotonic() - began:.0f} s")
    raise SystemExit(int(bool(faults)))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add(
        "--runs",
        type=int,
        help="how many; by default 5,000, 30 if --long, or any number in --seconds",
    )
    add("--seconds", type=float, default=float("inf"), help="begin no run after this time")
    add("--first", type=int, default=0, help="number of the first run")
    add("--seed", type=int, default=0)
    add("--long", action="store_true", help="commands that take long, one at a time")
    add("--rows", type=int, help="of the files that are read; by default 3,000, or 10,000,000")
    add("--folder", type=Path, help="where to make a temporary folder for the files")
    known = sorted({job.name for job in commands()})
    add("--commands", nargs="+", choices=known, default=known, metavar="COMMAND", help="only these")
    add("--most", type=float, default=1.0, help="seconds from the signal to the end")
    add("--second", type=float, default=0.2, help="seconds from the second signal to the end")
    add("--workers", type=int, default=os.cpu_count(), help="commands at a time")
    options = parser.parse_args()
    if options.rows is None:
        options.rows = 10_000_000 if options.long else 3000
    if options.long:
        options.workers = 1
    if options.runs is None and options.seconds == float("inf"):
        options.runs = 30 if options.long else 5000
    return options


def sweep(folder: Path, options: Namespace) -> Iterator[Run]:
    """Yield the runs; print the faults."""
    listed = LONG_COMMANDS if options.long else commands()
    jobs = [job for job in listed if job.name in options.commands]
    prepare(folder, options.rows, jobs)
    known = learn(folder, jobs)
    end = time.monotonic() + options.seconds

    def work(number: int) -> Run | None:
        if time.monotonic() > end:
            return None
        planned = plan(number, options.seed, jobs)
        return run(planned, folder, known, options.most, options.second)

    with ThreadPoolExecutor(options.workers) as pool:
        for numbers in batches(options.first, options.runs):
            for each in filter(None, pool.map(work, numbers)):
                for fault in each.faults:
                    print(f"{each.plan}: {fault}", flush=True)
                yield each
            if time.monotonic() > end:
                return


def batches(first: int, count: int | None) -> Iterator[range]:
    """Yield the numbers of the runs, some at a time, without end if no count is given."""
    end = sys.maxsize if count is None else first + count
    return (range(k, min(k + 100, end)) for k in range(first, end, 100))


def summary(runs: list[Run]) -> str:
    """Say how many signals met what, and how long commands took to end."""
    stages = Counter(each.stage for each in runs)
    heard = [each for each in runs if each.stage == DURING]
    single, double = (
        max((each.seconds for each in heard if len(each.plan.signals) == count), default=0.0)
        for count in (1, 2)
    )
    met = ", ".join(f"{stages[stage]:,} {stage}" for stage in (BEFORE, DURING, AFTER))
    return (
        f"{len(runs):,} runs, signals {met}; ended within {single:.2f} s of the only signal, "
        f"{double:.2f} s of the second"
    )


if __name__ == "__main__":
    main()
