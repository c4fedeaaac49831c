"""Time liftmesh against the programs a Python user could install instead.

    python scripts/bench.py delaunay             uniform points in every size, a million of others
    python scripts/bench.py delaunay --quick     fewer rows of a few inputs: some minutes
    python scripts/bench.py delaunay --targets   the inputs that have targets, if they are met
    python scripts/bench.py small                the latency of small calls
    python scripts/bench.py progress             the cost of a progress callback
    python scripts/bench.py delaunay --before old/bin/python   a former liftmesh beside this one
    python scripts/bench.py delaunay --n 10000 --distributions uniform circle --peers CGAL triangle

Every contestant, a peer on one or two threads, first runs in a fresh process, which measures its
memory. Its triangles are checked exactly and in full: a wrong result is shown with its flaw, and is
not compared. Then all contestants are timed in alternating rounds. A peer that exceeds the time
limit is cut off, and not tried on more points of that kind. CGAL is a C++ program that is built on
first use; it and other peers that are not installed are shown as such.

Tables go to the terminal, all times to a JSON file, and pictures to the same folder.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from benchmark import plots, records
from benchmark.cases import MILLION, PROFILES, Case, grid
from benchmark.contest import SEED, Limits, run_case
from benchmark.contestants import INTERPRETERS
from benchmark.measuring import console
from benchmark.peers import BEFORE, OURS, PEERS, RIVALS
from benchmark.startup import import_seconds
from benchmark.tables import notes_of, tables_of, target_table
from benchmark.targets import TARGETS, Target
from distributions import DISTRIBUTIONS
from rich.console import Console

if TYPE_CHECKING:
    from benchmark.results import Measurement

WIDTH = 190


def run(options: Namespace) -> None:
    """Measure the cases; print, write and draw the results."""
    check(options)
    terminal = console(WIDTH)
    cases = cases_of(options)
    imports = import_seconds()
    measurements: list[Measurement] = []
    targets: list[Target] = []
    limits: Limits = {}
    with terminal.status("") as status:
        for case in cases:
            status.update(f"{case.distribution}, {case.size:,} rows")
            measurements.append(run_case(case, limits))
            if options.profile in TARGETS:
                targets = list(TARGETS[options.profile](measurements, options.million))
            records.write(options.json, measurements, targets, imports, settings_of(options))
    show(terminal, measurements, targets, imports)
    for file in (options.json, *plots.draw(measurements, options.json)):
        terminal.print(f"wrote {file}")


def add_options(parser: ArgumentParser) -> None:
    """Add the options; liftmesh itself is always measured."""
    add = parser.add_argument
    parser.set_defaults(fail=parser.error)
    profiles = parser.add_mutually_exclusive_group()
    for name in () if parser.get_default("profile") else ("full", "quick", "targets"):
        profiles.add_argument(f"--{name}", dest="profile", action="store_const", const=name)
    add("--n", nargs="+", type=int, metavar="ROWS", help="these sizes instead of a profile")
    add("--distributions", nargs="+", choices=DISTRIBUTIONS, metavar="D", help="only these")
    add("--before", metavar="PYTHON", help="interpreter for which a former liftmesh is installed")
    add("--peers", nargs="+", choices=PEERS, default=[*RIVALS], metavar="P", help=", ".join(PEERS))
    add(
        "--threads",
        nargs="+",
        type=int,
        default=[1, 2],
        metavar="K",
        help="of the peers that are parallel",
    )
    add("--rounds", type=int, default=5, help="rounds")
    add(
        "--patience",
        type=float,
        default=20.0,
        help="time limit in seconds of a trial, and of all rounds together",
    )
    add(
        "--million",
        type=int,
        default=MILLION,
        help="rows to take in place of a million, for a rehearsal",
    )
    add("--json", type=Path, default=Path("out/bench.json"))


def check(options: Namespace) -> None:
    """Refuse options that contradict each other."""
    fail = options.__dict__.pop("fail")
    if options.profile and (options.n or options.distributions):
        fail(f"{options.profile} sets sizes and distributions: omit --n and --distributions")
    if options.before:
        INTERPRETERS[BEFORE] = str(Path(options.before).absolute())
    elif BEFORE in options.peers:
        fail(f"{BEFORE} needs --before PYTHON, for which a former liftmesh is installed")
    options.json = options.json.absolute()


def cases_of(options: Namespace) -> list[Case]:
    """Return the cases of the profile, or those of the given sizes and distributions."""
    former = [BEFORE] if options.before else []
    peers = tuple(dict.fromkeys((OURS, *former, *options.peers)))
    case = Case(
        "uniform",
        options.million,
        peers,
        tuple(options.threads),
        options.rounds,
        options.patience,
    )
    if options.n or options.distributions:
        sizes = options.n or [options.million]
        return grid(case, options.distributions or DISTRIBUTIONS, sizes)
    return PROFILES[options.profile or "full"](case, options.million)


def settings_of(options: Namespace) -> dict[str, object]:
    """Return the options for the report, without folders of this machine."""
    return vars(options) | {"json": options.json.name, "before": bool(options.before), "seed": SEED}


def show(
    terminal: Console,
    measurements: list[Measurement],
    targets: list[Target],
    imports: dict[str, float],
) -> None:
    for table in tables_of(measurements):
        terminal.print(table)
    for note in notes_of(measurements):
        terminal.print(f"* {note}")
    for statement, seconds in imports.items():
        terminal.print(f"{statement}: {seconds:.4f} s beyond NumPy's import")
    if targets:
        terminal.print(target_table(targets))
