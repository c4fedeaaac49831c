"""Compare the bits of the kernel's results between compilers, optimisations and machines.

    python scripts/portability                      some minutes, most of them to build
    python scripts/portability --rows 50000 --sets 2000

The kernel's sources, without Python, are built by gcc and clang, with and without optimisation, for
every x86-64 processor and for this one, and for aarch64, whose programs qemu runs. Each build
triangulates every distribution of `distributions.py` and small sets of every kind in
`small_sets.py`, on one thread and on three, by every engine, by weights and by radii, in a metric
and for farthest points; makes graphs of disks, and stars in metrics of their own; asks surfaces for
heights, rasters, contours and volumes, lays them over each other, inserts and removes points and
edges, puts edges in, refines, and simplifies; merges tiles, makes tetrahedra, alpha complexes,
graphs of near points and triangulations on the sphere, locates, verifies, decides signs, and prints
and parses numbers (`driver.cpp`). Hashes of all results must be those of the first build. No build
may have an instruction that fuses a product and a sum. Two are compiled with such instructions:
these have to notice, as the kernel does at its import, and refuse to run.

Exits with 1 at any difference, and with 2 where a tool is missing: it says which package has it.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from native.build import built
from native.instructions import fused
from portability.builds import BUILDS, PACKAGES, missing
from portability.questions import write_files
from portability.results import Results, differences, results

Done = subprocess.CompletedProcess[str]
REMEDY = "-ffp-contract=off"  # what the kernel says where it refuses


@dataclass
class Verdict:
    """What a build did, in words, and what is wrong with it."""

    told: str
    faults: list[str]


def main() -> None:
    """Build all, compare, and print a table."""
    options = read_options()
    if lacking := missing():
        print(f"this machine lacks {', '.join(lacking)}: {PACKAGES}", file=sys.stderr)
        raise SystemExit(2)
    with tempfile.TemporaryDirectory() as name:
        files = write_files(Path(name), options.rows, options.sets)
        print("| build | results | fused instructions | seconds |\n| --- | --- | ---: | ---: |")
        faults = check(files)
    print(*faults, sep="\n", file=sys.stderr, end="\n" * bool(faults))
    raise SystemExit(bool(faults))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=20_000, help="of each distribution")
    parser.add_argument("--sets", type=int, default=100, help="small sets of each kind")
    return parser.parse_args()


def check(files: list[Path]) -> list[str]:
    """Print a row for each build; return what is wrong."""
    faults = []
    expected: Results = {}
    for build in BUILDS:
        program = built(build.program)
        began = time.monotonic()
        done = run(build.command(program, files))
        seconds = time.monotonic() - began
        verdict = refusal(done) if build.is_to_refuse else comparison(done, expected)
        count = fused(program, build.objdump)
        if (count > 0) != build.is_to_refuse:
            verdict.faults.append(f"{count} instructions fuse")
        print(f"| {build.name} | {verdict.told} | {count} | {seconds:.1f} |", flush=True)
        faults += [f"{build.name}: {fault}" for fault in verdict.faults]
    return faults


def run(command: list[str]) -> Done:
    return subprocess.run(command, capture_output=True, text=True, check=False)


def comparison(done: Done, expected: Results) -> Verdict:
    """Compare a build's results with those of the first, which are kept in `expected`."""
    if done.returncode:
        return Verdict("none", [f"ended with {done.returncode}: {done.stderr.strip()}"])
    found = results(done.stdout)
    if not expected:
        expected.update(found)
        return Verdict(f"{len(found)} hashes", [])
    faults = differences(found, expected)
    return Verdict(f"{len(faults)} differ" if faults else "the same", faults)


def refusal(done: Done) -> Verdict:
    """Whether a build that fuses has noticed."""
    if done.returncode == 3 and REMEDY in done.stderr:
        return Verdict("refused, as it should be", [])
    return Verdict("NOT refused", ["contraction was not noticed"])


if __name__ == "__main__":
    main()
