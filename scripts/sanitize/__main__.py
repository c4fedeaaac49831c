"""Run the kernel's parallel paths under a sanitizer: who else touches what a thread is at.

    python scripts/sanitize thread       data races (ThreadSanitizer): some minutes
    python scripts/sanitize address      memory and undefined behaviour
    python scripts/sanitize thread --rows 9000

A small driver, `driver.cpp`, triangulates and verifies several point sets on 2 to 8
threads, with duplicates and rows that are not finite, interrupts runs in their middle, and lets
several run at once. It exits with 1 if the sanitizer reports anything, or a result differs from
that of one thread. Needs clang with its sanitizers.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from fuzz.build import CHECKED, Program, built

HERE = Path(__file__).resolve().parent
PROGRAMS = {
    "thread": Program("threads-thread", HERE, ("-fsanitize=thread",)),
    "address": Program("threads-address", HERE, CHECKED),
}
ROWS = 100_000  # triangles of more than 32,768 points are written by several threads
NO_ROOM = "unexpected memory mapping"


def main() -> None:
    """Build, run, and say what came of it."""
    options = read_options()
    program = built(PROGRAMS[options.sanitizer])
    began = time.monotonic()
    done = run(program, options.rows)
    sys.stdout.write(done.stdout)
    if done.returncode:
        sys.stderr.write(done.stderr)
        raise SystemExit(1)
    print(f"{options.sanitizer}: no report in {time.monotonic() - began:.0f} s")


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("sanitizer", choices=PROGRAMS)
    parser.add_argument("--rows", type=int, default=ROWS, help="of each point set")
    return parser.parse_args()


def run(program: Path, rows: int) -> subprocess.CompletedProcess[str]:
    """Run the driver; where addresses are too random for ThreadSanitizer, with fixed ones."""
    command = [str(program), str(rows)]
    environment = {**os.environ, "TSAN_OPTIONS": "halt_on_error=1"}
    done = _ran(command, environment)
    if NO_ROOM in done.stderr:
        done = _ran(["setarch", platform.machine(), "--addr-no-randomize", *command], environment)
    return done


def _ran(command: list[str], environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


if __name__ == "__main__":
    main()
