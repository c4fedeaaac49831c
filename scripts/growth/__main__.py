"""How the cost of liftmesh's functions, readers and writers grows.

    python scripts/growth --instructions                        instructions for honest files
    python scripts/growth --instructions --python A --python B  of two versions, compared

`--instructions` counts reading and writing an honest file of every format under callgrind (see
`counting.py`), with each interpreter given by `--python`: that of an environment in which some
version of liftmesh is installed. With two of them it exits with 1 if the second takes more than
2 % more than the first for any file. `--json FILE` writes all counts.
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

from rich.console import Console
from rich.table import Table

from growth import honest

if TYPE_CHECKING:
    from growth.counting import Count

MOST_MORE = 1.02


def main() -> None:
    """Run the command."""
    options = read_options()
    raise SystemExit(instructions(options))


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--instructions", action="store_true", help="count instructions for honest files")
    add("--python", action="append", metavar="FILE", help="interpreter to count, up to two")
    add("--rows", type=int, default=10_000, help="of the honest files")
    add("--only", default="", metavar="TEXT", help="what has this text in its name")
    add("--json", type=Path, metavar="FILE", help="write all counts here")
    return parser.parse_args()


def instructions(options: Namespace) -> int:
    """Count with each interpreter, and print a table; return the exit code."""
    pythons = options.python or [sys.executable]
    with tempfile.TemporaryDirectory() as folder:
        found = honest.compare(Path(folder), options.rows, pythons, options.only)
    if options.json:
        table = {key: [each.instructions for each in counts] for key, counts in found.items()}
        options.json.write_text(json.dumps({"pythons": pythons, "instructions": table}, indent=1))
    more = {key: ratio(counts) for key, counts in found.items()}
    Console(width=None if os.isatty(1) else 120).print(table_of(found, more))
    return int(any(each > MOST_MORE for each in more.values()))


def ratio(counts: list[Count]) -> float:
    """Return the last count as a multiple of the first."""
    return counts[-1].instructions / counts[0].instructions


def table_of(found: dict[str, list[Count]], more: dict[str, float]) -> Table:
    """Make a table of instructions per byte, with the ratio of the last to the first."""
    table = Table(title="instructions for honest files", title_justify="left")
    table.add_column("file")
    versions = len(next(iter(found.values())))
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
