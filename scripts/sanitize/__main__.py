"""Run the kernel's parallel code under a sanitizer.

    python scripts/sanitize thread       data races (ThreadSanitizer): some minutes
    python scripts/sanitize address      memory and undefined behaviour
    python scripts/sanitize thread --rows 9000

A small driver, `driver.cpp`, triangulates and verifies several point sets on 2 to 8 threads, with
duplicates and non-finite rows, interrupts runs, and makes several runs at the same time;
`family.cpp` does the same with weights, radii, a metric and farthest points; `cells.cpp` clips
cells, also with other rows than those triangulated; `surfaces.cpp` asks for heights, rasters,
contours and rings, and lays surfaces over each other; `tiles.cpp` merges tiles; `changing.cpp`
inserts and removes points and edges, and simplifies terrains; `given_edges.cpp` puts edges in,
carves, verifies and refines; `disk_graphs.cpp` makes and verifies graphs of disks, and stars in
metrics of their own; `space.cpp` makes, verifies and searches tetrahedra, and makes alpha
complexes, graphs of near points and triangulations on the sphere; `text.cpp` prints and parses
numbers, and leaves rows that are being printed; `spoilt.cpp` changes rows while they are
triangulated. Exits with 1 if the sanitizer reports anything, or if a result differs from that of
one thread. Needs clang with its sanitizers.
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

from native.build import CHECKED, TRACED, Program, built

HERE = Path(__file__).resolve().parent
PROGRAMS = {
    "thread": Program("threads-thread", HERE, (*TRACED, "-fsanitize=thread")),
    "address": Program("threads-address", HERE, CHECKED),
}
ROWS = 100_000  # several threads write the triangles of more than 32,768 points
WRITERS = {"thread": 0, "address": 2}  # rows written while they are read are races
MAPPING_FAILED = "unexpected memory mapping"


def main() -> None:
    """Build and run the driver, and print the result."""
    options = read_options()
    program = built(PROGRAMS[options.sanitizer])
    began = time.monotonic()
    done = run(program, options.rows, options.sanitizer)
    sys.stdout.write(done.stdout)
    if done.returncode:
        sys.stderr.write(done.stderr)
        raise SystemExit(1)
    print(f"{options.sanitizer}: no report in {time.monotonic() - began:.0f} s")


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("sanitizer", choices=PROGRAMS)
    parser.add_argument("--rows", type=int, default=ROWS, help="of each point set")
    return parser.parse_args()


def run(program: Path, rows: int, sanitizer: str) -> subprocess.CompletedProcess[str]:
    """Run the driver; without address randomisation if ThreadSanitizer cannot cope with it."""
    command = [str(program), str(rows), str(WRITERS[sanitizer])]
    environment = {**os.environ, "TSAN_OPTIONS": "halt_on_error=1"}
    done = _ran(command, environment)
    if MAPPING_FAILED in done.stderr:
        done = _ran(["setarch", platform.machine(), "--addr-no-randomize", *command], environment)
    return done


def _ran(command: list[str], environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


if __name__ == "__main__":
    main()
