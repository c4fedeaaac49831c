"""Fuzz the kernel or a reader: inputs that change, and whatever must hold for all of them.

    python scripts/fuzz kernel --seconds 600
    python scripts/fuzz ply --seconds 600 --jobs 2
    python scripts/fuzz kernel --run tests/regressions/*.bin
    python scripts/fuzz obj --keep

The kernel is driven by libFuzzer, with AddressSanitizer and UndefinedBehaviorSanitizer
(`kernel/` says what it asserts), the readers of PLY, OBJ and text by Atheris
(`round_trip.py`). A run begins with the corpus in tests/corpus and with what former runs
left in out/fuzz. It exits with 1 if it finds something, which it shrinks. `--run` tries files and
nothing else; `--keep` replaces the corpus in tests/corpus by a small one that covers as much.

Needs clang with its sanitizers for the kernel, and Atheris for the readers.
"""

from __future__ import annotations

import random
import sys
import time
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from fuzz.campaign import Outcome, fuzz, reason
from fuzz.distill import distill
from fuzz.shrink import shrink
from fuzz.targets import TARGETS, Target


def main() -> None:
    """Do what the command line says."""
    options = read_options()
    target = TARGETS[options.target]
    if options.run:
        raise SystemExit(try_files(target, options.run))
    if options.keep:
        kept = distill(target, options.folder or target.folder)
        print(f"{target.seeds}: {len(kept)} files, {sum(p.stat().st_size for p in kept):,} bytes")
        return
    raise SystemExit(campaign(target, options))


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("target", choices=TARGETS)
    add("--seconds", type=int, default=60)
    add("--jobs", type=int, default=1, help="processes that share a corpus")
    add("--seed", type=int, help="by default another one each time")
    add("--folder", type=Path, help="for the growing corpus and the finds, instead of out/fuzz")
    add("--run", type=Path, nargs="+", metavar="FILE", help="try these files only")
    add("--keep", action="store_true", help="make a small corpus of all there is")
    return parser.parse_args()


def try_files(target: Target, files: list[Path]) -> int:
    """Run files one by one; 1 if something is wrong with any."""
    reasons = {path: reason(target, path.resolve()) for path in files}
    for path, why in reasons.items():
        print(f"{path}: {why or 'as it should be'}")
    return int(any(reasons.values()))


def campaign(target: Target, options: Namespace) -> int:
    """Fuzz, and say what came of it; 1 if there are finds."""
    target.command()  # builds, which is not fuzzing
    began = time.monotonic()
    seed = random.SystemRandom().randrange(1, 1 << 31) if options.seed is None else options.seed
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
    """Shrink and show every find."""
    for text in found.failed:
        sys.stderr.write(text)
    for find in found.finds:
        small, why = shrink(target, find)
        print(
            f"{why}\n  {find} ({find.stat().st_size} bytes), shrunk: {small} "
            f"({small.stat().st_size} bytes)\n  once it is mended, keep it: "
            f"cp {small} tests/regressions/NNNN-what-was-wrong{target.suffix}, "
            "and say in the README there what it was"
        )


if __name__ == "__main__":
    main()
