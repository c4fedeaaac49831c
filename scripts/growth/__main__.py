"""How the cost of liftmesh's functions, readers and writers grows on their worst known inputs.

    python scripts/growth --seconds 5                           CPU seconds on doubling sizes
    python scripts/growth --only "read ply"                     of some cases
    python scripts/growth --memory                              memory that readers take
    python scripts/growth --instructions --python A --python B  two versions on honest files

Without an option for another table, every subject runs on every family of its inputs, on doubling
sizes for `--seconds` of CPU time a case. The table shows the cost of a row or a byte at the first
and the last size and the largest ratio between sizes that differ by eight; more than 3 fails.

`--memory` reads files of `--size` bytes of every family in fresh forks, also under a limit.

`--instructions` counts reading and writing an honest file of every format under callgrind (see
`counting.py`), with each interpreter given by `--python`: that of an environment in which some
version of liftmesh is installed. With two of them, the second may take 2 % more than the first for
any file. `--json FILE` writes all counts.

Exits with 1 if anything fails.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from growth import honest
from growth.resident import SIZE, measured
from growth.seconds import Timing, timed
from growth.subjects import FILES, subjects
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from growth.counting import Count

MOST_MORE = 1.02


def main() -> None:
    options = read_options()
    if options.instructions:
        raise SystemExit(instructions(options))
    raise SystemExit(memory(options) if options.memory else seconds(options))


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--seconds", type=float, default=3, help="of CPU time for each case")
    add("--only", default="", metavar="TEXT", help="what has this text in its name")
    add("--memory", action="store_true", help="measure the memory that readers take")
    add("--size", type=int, default=SIZE, help="of the files to read, in bytes")
    add("--instructions", action="store_true", help="count instructions for honest files")
    add("--python", action="append", metavar="FILE", help="interpreter to count, up to two")
    add("--rows", type=int, default=10_000, help="of the honest files")
    add("--json", type=Path, metavar="FILE", help="write all counts here")
    return parser.parse_args()


def console() -> Console:
    """Make a console that is wide enough for the tables."""
    return Console(width=None if os.isatty(1) else 130)


def seconds(options: Namespace) -> int:
    """Time every case, and print a line for each; return the exit code."""
    failed = 0
    print(f"{'case':72}{'largest':>12}{'first':>11}{'last':>11} us a unit, growth")
    for subject in subjects().values():
        for family in subject.families:
            if options.only in f"{subject.name} on {family}":
                found = timed(subject, family, options.seconds)
                failed += found.verdict not in ("", "known")
                print(line_of(found), flush=True)
    print(f"{failed} cases grow" if failed else "no case grows")
    return int(failed > 0)


def line_of(found: Timing) -> str:
    costs = [1e6 * taken / units for units, taken in found.seconds.items()] or [0.0]
    largest = max(found.seconds, default=0)
    label = f"{found.subject} on {found.family}"
    numbers = f"{largest:12,}{costs[0]:11.3f}{costs[-1]:11.3f}{found.ratio:7.1f}"
    return f"{label:72}{numbers} {found.verdict}".rstrip()


def memory(options: Namespace) -> int:
    """Measure every reader, and print a line for each family; return the exit code."""
    faults = []
    for kind, families in FILES.items():
        for chunks in (False, True):
            verb = "read_chunks" if chunks else "read"
            chosen = [name for name in families if options.only in f"{verb} {kind} on {name}"]
            for each in measured(kind, chosen, chunks=chunks, size=options.size):
                told = f"{each.content:12,}{each.grown:14,}{each.grown / each.content:8.1f}"
                print(f"{each.label:60}{told} {each.outcome} {each.limited}", flush=True)
                faults += [each.fault] if each.fault else []
    print("\n".join(faults) or "no reader takes too much")
    return int(bool(faults))


def instructions(options: Namespace) -> int:
    """Count with each interpreter, and print a table; return the exit code."""
    pythons = options.python or [sys.executable]
    with tempfile.TemporaryDirectory() as folder:
        found = honest.compare(Path(folder), options.rows, pythons, options.only)
    if options.json:
        table = {key: [each.instructions for each in counts] for key, counts in found.items()}
        options.json.write_text(json.dumps({"pythons": pythons, "instructions": table}, indent=1))
    more = {key: ratio(counts) for key, counts in found.items()}
    console().print(table_of(found, more))
    return int(any(each > MOST_MORE for each in more.values()))


def ratio(counts: list[Count]) -> float:
    """Return the last count as a multiple of the first."""
    return counts[-1].instructions / counts[0].instructions


def table_of(found: dict[str, list[Count]], more: dict[str, float]) -> Table:
    """Make a table of instructions per byte, with the ratio of the last to the first."""
    table = Table(title="instructions for honest files", title_justify="left")
    table.add_column("file")
    versions = len(next(iter(found.values()), []))
    for number in range(versions):
        table.add_column(f"a byte ({number + 1})", justify="right")
    table.add_column("ratio", justify="right")
    table.add_column("")
    for key, counts in found.items():
        cells = [f"{each.instructions / each.units:,.2f}" for each in counts]
        errors = " ".join(each.error for each in counts)[:40]
        verdict = "more" if more[key] > MOST_MORE else ""
        table.add_row(key, *cells, f"{more[key]:.3f}", f"{verdict} {errors}")
    return table


if __name__ == "__main__":
    main()
