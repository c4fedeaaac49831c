"""Press Ctrl-C at any moment of large runs: the prompt must be back at once, and nothing left.

    python scripts/interrupt                          10,000,000 rows: a quarter of an hour
    python scripts/interrupt --rows 1000000 --rounds 9
    python scripts/interrupt --jobs verify "write OBJ"

Reads, triangulates, verifies and writes, each once as a whole and then `--rounds` times with a
SIGINT at a random moment of each equal part of that time; jobs of the library in one process with
a prompt, commands each in a process of its own. Exits with 1 if the prompt, or the end of the
command, takes more than `--most` seconds from the signal, if memory, an open file or a thread is
still held, or if a file was changed or left.
"""

from __future__ import annotations

import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from interrupt.campaign import Course, Hit, interrupt_command, interrupt_job
from interrupt.jobs import COMMANDS, JOBS, prepare


def main() -> None:
    """Interrupt every job, and say how it went."""
    options = read_options()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="liftmesh-", dir=options.folder) as name:
        folder = Path(name).resolve()
        prepare(folder, options.rows, options.jobs)
        courses = [run(job, folder, options) for job in options.jobs]
    hits = [hit for course in courses for hit in course.hits if hit.seconds]
    worst = max((hit.seconds for hit in hits), default=0.0)
    wrong = sum(bool(reasons(hit, options.most)) for course in courses for hit in course.hits)
    print(
        f"{options.rows:,} rows: {len(hits)} interrupts, the prompt back within {worst:.2f} s, "
        f"{wrong} of them wrong, in {time.monotonic() - began:.0f} s"
    )
    raise SystemExit(int(bool(wrong) or not hits))


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    known = [*JOBS, *COMMANDS]
    add("--rows", type=int, default=10_000_000)
    add("--rounds", type=int, default=5, help="interrupts of each job")
    add("--jobs", nargs="+", choices=known, default=known, metavar="JOB", help=", ".join(known))
    add("--most", type=float, default=1.0, help="seconds until the prompt")
    add("--seed", type=int, default=0, help="of the moments")
    add("--folder", type=Path, help="for a folder of large files, which is removed at the end")
    return parser.parse_args()


def run(job: str, folder: Path, options: Namespace) -> Course:
    """Interrupt one job, and print a line for each time."""
    interrupt = interrupt_job if job in JOBS else interrupt_command
    course = interrupt(job, folder, options.rounds, options.seed)
    print(f"{job}: {course.whole:.2f} s as a whole")
    for hit in course.hits:
        told = "; ".join(reasons(hit, options.most)) or "ok"
        print(f"  at {hit.delay:6.2f} s  {hit.seconds:5.2f} s  {hit.place}  {told}", flush=True)
    return course


def reasons(hit: Hit, most: float) -> list[str]:
    """Say what is wrong with an interrupt."""
    return [*hit.faults, *(["it took too long"] if hit.seconds > most else [])]


if __name__ == "__main__":
    main()
