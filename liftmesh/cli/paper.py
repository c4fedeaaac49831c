"""``liftmesh paper``: measures the paper's Tables 5.1 and 5.2 and compares the printed numbers."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, repeat
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from liftmesh.cli import outputs, terminal
from liftmesh.cli.options import flag, option, whole

if TYPE_CHECKING:
    from liftmesh.paper.experiments import Trial
    from liftmesh.paper.printed import TableName
    from liftmesh.paper.results import Results, Settings
    from liftmesh.paper.tables import Row

SHORT_HELP = "Measure the paper's tables and compare them with the printed numbers."
HELP = (
    "Tables 5.1 and 5.2 time gift wrapping with LF and with LFRes on 1,000 to 20,000 points. The "
    "restricted region by a spatial index and the default algorithm are measured too, and dot "
    "products are counted. Writes measurements.csv, a CSV file for each table, tables.md, "
    "paper.json and the figures to DIR. An interrupted run continues where it stopped."
)
EXAMPLES = [
    "liftmesh paper --quick",
    "liftmesh paper --seeds 5 --out out/five-seeds",
    "liftmesh paper --table 5.2 --n 1000 --n 4000 --no-figures --out out/case-2",
]

TERMINAL_SECONDS_HEADER = (
    *("n", "paper: LF", "LFRes", "ratio", "ours: LF", "LFRes", "ratio"),
    *("indexed", "engine", "LF/indexed"),
)
QUICK_SIZES = (1_000, 2_000, 3_000)


@dataclass(frozen=True, slots=True)
class _Choice:
    """The options of the command."""

    quick: bool
    seeds: int | None
    table: Literal["5.1", "5.2", "both"]
    sizes: tuple[int, ...]
    machine: str | None

    @property
    def tables(self) -> Sequence[TableName]:
        return ("5.1", "5.2") if self.table == "both" else (self.table,)

    def settings(self) -> Settings:
        from liftmesh.paper.experiments import describe_machine
        from liftmesh.paper.printed import SIZES
        from liftmesh.paper.results import Settings

        sizes = tuple(sorted(set(self.sizes))) or (QUICK_SIZES if self.quick else SIZES)
        seeds = self.seeds or (1 if self.quick else 3)
        return Settings(sizes, seeds, self.machine or describe_machine())

    def command(self, made: Collection[TableName]) -> str:
        """Return the command that makes these tables, without the folder."""
        words = ["liftmesh", "paper", *(["--quick"] if self.quick else [])]
        words += ["--seeds", str(self.seeds)] if self.seeds else []
        words += ["--table", *made] if len(made) == 1 else []
        words += [word for n in self.sizes for word in ("--n", str(n))]
        words += ["--machine", self.machine] if self.machine else []
        return shlex.join(words)


def run(
    out: Annotated[
        Path | None,
        option(
            "DIR",
            "Folder for all files, created if missing; by default out/paper, or "
            "out/paper-quick with --quick.",
        ),
    ] = None,
    quick: Annotated[bool, flag("1,000 to 3,000 points, one seed: under a minute.")] = False,
    seeds: Annotated[
        int | None,
        option(
            "N", "Number of random sets of each size; by default 3, or 1 with --quick.", whole(1)
        ),
    ] = None,
    table: Annotated[
        Literal["5.1", "5.2", "both"],
        flag("5.1 has the paraboloid's vertex at the origin, 5.2 at the median."),
    ] = "both",
    n: Annotated[
        list[int] | None,
        option("N", "Number of points, instead of the paper's; repeatable.", whole(3)),
    ] = None,
    figures: Annotated[bool, flag("Draw the paper's figures too.")] = True,
    machine: Annotated[str | None, option("TEXT", "Description of the machine.")] = None,
) -> None:
    """Measure the missing sets of points, write all files, and print the tables."""
    from liftmesh.paper.results import Results

    if figures:
        _check_drawing()
    out = out or Path("out/paper-quick" if quick else "out/paper")
    choice = _Choice(quick, seeds, table, tuple(n or ()), machine)
    settings = choice.settings()
    out.mkdir(parents=True, exist_ok=True)
    results = Results(out, settings)
    with outputs.dispensable_stdout():
        _measure(results, settings.trials(choice.tables))
        _finish(out, results, settings, choice, figures=figures)


def _check_drawing() -> None:
    """Raise before the long run if the figures cannot be drawn."""
    from liftmesh.errors import MissingDependencyError
    from liftmesh.optional import load

    try:
        load("matplotlib", extra="plot")
    except MissingDependencyError as error:
        raise MissingDependencyError(f"{error}, or pass --no-figures") from error


def _measure(results: Results, trials: Sequence[Trial]) -> None:
    """Measure the missing sets of points; write each to disk before the next."""
    from liftmesh.paper.experiments import (
        calibrate,
        measure,
        warm_up,
    )

    missing = [trial for trial in trials if trial not in results.done]
    _print_state(results, len(trials), len(missing))
    if not missing:
        return
    with terminal.stage("estimating"):
        warm_up()
        estimate = calibrate(missing)
    expected = [estimate(trial) for trial in missing]
    _announce(len(missing), sum(expected))
    with terminal.bar(sum(expected)) as bar:
        for trial, seconds in zip(missing, expected, strict=True):
            results.add(measure(trial, partial(_show_step, bar, trial)))
            bar("", seconds)


def _show_step(bar: Callable[[str, float], None], trial: Trial, method: str) -> None:
    bar(f"Table {trial.table}, {trial.n:,} points, seed {trial.seed}: {method}", 0.0)


def _print_state(results: Results, wanted: int, missing: int) -> None:
    if results.cut:
        terminal.sentence(
            f"{results.path}: its end is incomplete; {results.cut} lines are removed and "
            "measured again."
        )
    if wanted == missing:
        return
    rest = f"continuing with the other {missing}" if missing else "nothing is left to measure"
    terminal.sentence(
        f"{results.path} holds {wanted - missing} of {wanted} sets of points with these settings: "
        f"{rest}."
    )


def _announce(count: int, seconds: float) -> None:
    terminal.sentence(
        f"{count} sets of points, four methods on each: about {_duration(seconds)}. "
        "It may be interrupted: the same command then continues where it stopped."
    )
    sys.stdout.flush()


def _duration(seconds: float) -> str:
    """Format a rough duration in words."""
    if seconds < 90:
        return f"{max(1, round(seconds))} seconds"
    return f"{seconds / 60:.0f} minutes" if seconds < 5400 else f"{seconds / 3600:.1f} hours"


def _finish(
    out: Path, results: Results, settings: Settings, choice: _Choice, *, figures: bool
) -> None:
    from liftmesh.paper.tables import complete_tables, write_all

    tables = complete_tables(results, settings)
    files = write_all(out, results, settings, choice.command(tables))
    for name in choice.tables:
        _show(tables[name])
    if figures:
        files += _draw(out / "figures", [row for rows in tables.values() for row in rows])
    terminal.blank()
    terminal.sentence(f"Measured on: {settings.machine}.")
    terminal.sentence(f"{out}: {len(files)} files written next to {results.path.name}.", "good")


def _draw(folder: Path, rows: Sequence[Row]) -> list[Path]:
    from liftmesh.paper import figures

    count = len(figures.FIXED) + len(figures.TIMED) + len(figures.MEASURED)
    drawn = chain([0.0], repeat(1.0))
    with terminal.bar(count) as bar:
        return figures.draw_all(
            folder, results=rows, progress=lambda name: bar(f"drawing {name}", next(drawn))
        )


def _show(rows: Sequence[Row]) -> None:
    """Print one table: seconds, operations, and the conclusion."""
    from liftmesh.paper import tables

    title = f"Table {rows[0].table}, q = {rows[0].q}"
    terminal.blank()
    terminal.sentence(f"{title}: seconds, the paper's and ours ({_seeds(rows)})", "name")
    terminal.table([tables.seconds_cells(row) for row in rows], header=TERMINAL_SECONDS_HEADER)
    terminal.blank()
    terminal.sentence(f"{title}: dot products per facet, and points rejected by LFRes", "name")
    terminal.table([tables.work_cells(row) for row in rows], header=tables.WORK_HEADER)
    terminal.blank()
    terminal.sentence(_conclusion(rows))


def _seeds(rows: Sequence[Row]) -> str:
    return "one seed" if rows[0].seeds == 1 else f"median of {rows[0].seeds} seeds"


def _conclusion(rows: Sequence[Row]) -> str:
    printed = [row.printed_ratio for row in rows if row.printed_ratio is not None]
    paper = f", where the paper prints {_range(printed, '.2f')}" if printed else ""
    return (
        f"LFRes needs {_range([row.work_ratio for row in rows], '.1f')} times fewer dot products "
        f"than LF; in time LF / LFRes is {_range([row.ratio for row in rows], '.2f')}{paper}. "
        "With the restricted region as a query into an index, LF / indexed is "
        f"{_range([row.indexed_ratio for row in rows], ',.0f')}."
    )


def _range(values: Sequence[float], digits: str) -> str:
    low, high = format(min(values), digits), format(max(values), digits)
    return low if low == high else f"{low} to {high}"
