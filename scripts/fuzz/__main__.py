"""Fuzz the kernel or a file reader, guided by coverage; or all readers with files that lie.

    python scripts/fuzz kernel --seconds 600
    python scripts/fuzz surface --seconds 600
    python scripts/fuzz ply --seconds 600 --jobs 2
    python scripts/fuzz kernel --run tests/regressions/*.bin
    python scripts/fuzz obj --keep
    python scripts/fuzz structure --seconds 600 --jobs 2 --formats gltf npz

libFuzzer drives the kernel, built with AddressSanitizer and UndefinedBehaviorSanitizer; the
assertions are in `kernel/`. `changing`, `constraints`, `refinement`, `surface`, `overlay`,
`simplification` and `space` are the same program, which only inserts and removes points, puts edges
in, refines, asks surfaces, lays two of them over each other, simplifies terrains, or makes
tetrahedra. Atheris drives the readers of PLY, OBJ and text, with the assertions of `round_trip.py`,
and the kernel's numbers in text, which `text_numbers.py` compares with Python's. A run starts from
the corpus in tests/corpus and from the one that earlier runs left in out/fuzz. It shrinks every
find, and exits with 1 if there is one.
`--run` runs the given files and nothing else; `--keep` replaces the corpus in tests/corpus by a
minimal one with the same coverage.

`structure` is not guided by coverage: it makes files of every format from their parts, tells lies
about some of these, and measures how each file is read (`structure/`). The same seed makes the same
files. `--run` gives it files of any format.

Needs clang with its sanitizers for the kernel, and Atheris for the readers.
"""

from __future__ import annotations

import sys
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from campaign import seed_of
from fuzz.campaign import Outcome, fuzz, reason
from fuzz.distill import distill
from fuzz.shrink import shrink
from fuzz.structure.campaign import ENDLESS, hunt, run_files
from fuzz.structure.generators import GENERATORS
from fuzz.targets import OUT, TARGETS, Target

STRUCTURE = "structure"


def main() -> None:
    options = read_options()
    if options.target == STRUCTURE:
        raise SystemExit(run_files(options.run) if options.run else hunt_lies(options))
    target = TARGETS[options.target]
    if options.run:
        raise SystemExit(try_files(target, options.run))
    if options.keep:
        kept = distill(target, options.folder or target.folder)
        print(f"{target.seeds}: {len(kept)} files, {sum(p.stat().st_size for p in kept):,} bytes")
        return
    raise SystemExit(campaign(target, options))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("target", choices=[*TARGETS, STRUCTURE])
    add("--seconds", type=int, default=60)
    add("--jobs", type=int, default=1, help="processes that share a corpus")
    add("--seed", type=int, help="default: random")
    add("--folder", type=Path, help="of the growing corpus and the finds, instead of out/fuzz")
    add("--run", type=Path, nargs="+", metavar="FILE", help="run these files only")
    add("--formats", nargs="+", choices=GENERATORS, default=[*GENERATORS], help="of structure")
    add("--cases", type=int, default=ENDLESS, help="of structure, for each format and process")
    add("--keep", action="store_true", help="minimise the corpus in tests/corpus")
    return parser.parse_args()


def try_files(target: Target, files: list[Path]) -> int:
    """Run files one by one; return 1 if any of them is a find."""
    reasons = {path: reason(target, path.resolve()) for path in files}
    for path, why in reasons.items():
        print(f"{path}: {why or 'passes'}")
    return int(any(reasons.values()))


def hunt_lies(options: Namespace) -> int:
    """Read files that lie, and print a summary; return 1 if there are faults."""
    seed = seed_of(options.seed)
    found = hunt(
        (options.folder or OUT / STRUCTURE).resolve(),
        seconds=options.seconds,
        seed=seed,
        jobs=options.jobs,
        cases=options.cases,
        names=options.formats,
    )
    for fault in found.faults:
        print(fault)
    print(f"{found}, seed {seed}")
    return int(bool(found.faults) or not found.cases)


def campaign(target: Target, options: Namespace) -> int:
    """Fuzz and print a summary; return 1 if there are finds."""
    target.command()  # builds the target before the clock starts
    began = time.monotonic()
    seed = seed_of(options.seed)
    folder = (options.folder or target.folder).resolve()
    found = fuzz(target, folder, options.seconds, options.jobs, seed)
    seconds = time.monotonic() - began
    print(
        f"{target.name}: {found.executions:,} executions in {seconds:.0f} s "
        f"({found.executions / seconds:,.0f} a second), {found.branches:,} branches, "
        f"{found.features:,} features, corpus {found.corpus:,}, seed {seed}, "
        f"{len(found.finds)} finds"
    )
    report(target, found)
    return int(bool(found.finds or found.failed))


def report(target: Target, found: Outcome) -> None:
    """Shrink and print every find, and print the logs of processes that failed."""
    for text in found.failed:
        sys.stderr.write(text)
    for find in found.finds:
        small, why = shrink(target, find)
        print(
            f"{why}\n  {find} ({find.stat().st_size} bytes), shrunk: {small} "
            f"({small.stat().st_size} bytes)\n  once it is fixed, add it to the regression tests: "
            f"cp {small} tests/regressions/NNNN-what-was-wrong{target.suffix}, "
            "and describe it in the README there"
        )


if __name__ == "__main__":
    main()
