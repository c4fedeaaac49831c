"""Time liftmesh against the programs a Python user could install instead.

    python scripts/bench.py                 one million rows of every distribution
    python scripts/bench.py --quick         a hundred thousand rows of a few

Every peer first makes a trial run in a fresh process, which measures its memory and checks its
triangles exactly: a wrong result is shown with its flaw, and does not count as a rival. Then all
are timed in alternating rounds. The table goes to the terminal, everything to a JSON file.
"""

from __future__ import annotations

import os
import tempfile
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from bench_peers import OURS, PEERS, RIVALS
from bench_report import Measurement, flaws_of, table_of, write_json
from bench_rounds import Timing, import_seconds, time_rounds
from bench_trial import run_trial
from distributions import DISTRIBUTIONS, Points
from rich.console import Console
from rich.markup import escape

SEED = 20
QUICK = {
    "n": [100_000],
    "distributions": ["uniform", "lattice", "utm-lattice", "clusters", "circle", "denormal"],
    "repeat": 3,
}
WIDTH = 150


def main() -> None:
    """Measure what the command line asks for; print a table and write JSON."""
    options = read_options()
    os.environ["RAYON_NUM_THREADS"] = "1"
    console = Console() if os.isatty(1) else Console(width=WIDTH)
    measurements = []
    with console.status("") as status:
        for name, size, points in inputs(options):
            status.update(f"{name}, {size:,} rows")
            timings = time_peers(points, options)
            measurements.append(Measurement(name, size, len(points), timings))
        status.update("imports")
        imports = import_seconds(9)
    console.print(table_of(measurements, options.peers))
    for line in flaws_of(measurements):
        console.print(f"* {escape(line)}")
    for statement, seconds in imports.items():
        console.print(f"{statement}: {seconds:.4f} s beyond NumPy's import")
    write_json(options.json, measurements, imports, vars(options) | {"threads": 1, "seed": SEED})
    console.print(f"wrote {options.json}")


def read_options() -> Namespace:
    """Parse the command line; liftmesh itself always takes part."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--n", nargs="+", type=int, default=[1_000_000], metavar="ROWS")
    add("--distributions", nargs="+", choices=DISTRIBUTIONS, default=[*DISTRIBUTIONS], metavar="D")
    add("--peers", nargs="+", choices=PEERS, default=[*RIVALS], metavar="P", help=", ".join(PEERS))
    add("--repeat", type=int, default=5, help="rounds")
    add("--patience", type=float, default=20.0, help="seconds for a trial, and for all rounds")
    add("--quick", action="store_true", help="few rows, few inputs, three rounds")
    add("--json", type=Path, default=Path("out/bench.json"))
    options = parser.parse_args()
    if options.quick:
        vars(options).update(QUICK)
    options.peers = [OURS, *(name for name in options.peers if name != OURS)]
    return options


def inputs(options: Namespace) -> Iterator[tuple[str, int, Points]]:
    """Make the points, the same ones in every run."""
    for size in options.n:
        for name in options.distributions:
            yield name, size, DISTRIBUTIONS[name](size, np.random.default_rng(SEED))


def time_peers(points: Points, options: Namespace) -> dict[str, Timing]:
    """Give every peer its trial, then the rounds."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "points.npy"
        np.save(file, points)
        trials = {name: run_trial(name, file, options.patience) for name in options.peers}
    if not trials[OURS].seconds:
        raise SystemExit(f"liftmesh gave no result: {trials[OURS].flaw}")
    return time_rounds(points, trials, options.repeat, options.patience)


if __name__ == "__main__":
    main()
