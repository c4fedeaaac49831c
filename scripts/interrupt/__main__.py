"""Interrupt large runs with Ctrl-C at random moments: the prompt must return at once.

    python scripts/interrupt                          10,000,000 rows: a quarter of an hour
    python scripts/interrupt --rows 1000000 --rounds 9
    python scripts/interrupt --jobs verify "write OBJ"

Each job reads, triangulates, verifies or writes. It runs once without interruption, then `--rounds`
times with a SIGINT at a random moment in each equal part of that run time, repeatedly in one
process with a prompt. Exits with 1 if the prompt takes more than `--most` seconds from the signal,
if memory, an open file or a thread is leaked, or if a file was changed or left behind. A tiled run
leaves what it has done in its folder; there the files of a last run, which begins anew, must be
whole. Long commands are interrupted by `python scripts/sweep --long`.
"""

from __future__ import annotations

import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from interrupt.campaign import Interrupt, JobResult, interrupt_job
from interrupt.jobs import JOBS, prepare
from process_state import hear_ctrl_c


def main() -> None:
    """Interrupt every job, and print a summary."""
    hear_ctrl_c()
    options = read_options()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="liftmesh-", dir=options.folder) as name:
        folder = Path(name).resolve()
        prepare(folder, options.rows, options.jobs)
        results = [run(job, folder, options) for job in options.jobs]
    interrupts = [each for result in results for each in result.interrupts]
    heard = [each for each in interrupts if each.seconds]
    worst = max((each.seconds for each in heard), default=0.0)
    wrong = sum(bool(reasons(each, options.most)) for each in interrupts)
    print(
        f"{options.rows:,} rows: {len(heard)} interrupts, the prompt back within {worst:.2f} s, "
        f"{wrong} of them wrong, in {time.monotonic() - began:.0f} s"
    )
    raise SystemExit(int(bool(wrong) or not heard))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--rows", type=int, default=10_000_000)
    add("--rounds", type=int, default=5, help="interrupts of each job")
    add("--jobs", nargs="+", choices=JOBS, default=JOBS, metavar="JOB", help=", ".join(JOBS))
    add("--most", type=float, default=1.0, help="seconds from the signal to the prompt")
    add("--seed", type=int, default=0, help="of the random moments")
    add("--folder", type=Path, help="where to make a temporary folder for the large files")
    return parser.parse_args()


def run(job: str, folder: Path, options: Namespace) -> JobResult:
    """Interrupt one job, and print a line for each interrupt."""
    result = interrupt_job(job, folder, options.rounds, options.seed)
    print(f"{job}: {result.uninterrupted:.2f} s without interruption")
    for each in result.interrupts:
        verdict = "; ".join(reasons(each, options.most)) or "ok"
        print(
            f"  at {each.delay:6.2f} s  {each.seconds:5.2f} s  {each.place}  {verdict}", flush=True
        )
    return result


def reasons(interrupt: Interrupt, most: float) -> list[str]:
    """Describe what is wrong with an interrupt."""
    return [*interrupt.faults, *(["it took too long"] if interrupt.seconds > most else [])]


if __name__ == "__main__":
    main()
