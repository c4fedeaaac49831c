"""Report the test coverage of liftmesh: lines and branches covered, and each gap with its reason.

    python scripts/coverage_gaps.py out/coverage/python.json out/coverage/kernel.json

`scripts/coverage.sh` runs the tests, writes the two files with coverage and gcovr, and calls this.
A gap is a run of lines that were not reached, or a branch that was never taken although both its
line and its target were reached. `coverage_gaps.toml` gives the reason for each gap, which it
identifies by a piece of its first line, since line numbers change; an entry explains one gap. The
command fails if a share is too small, a gap has no reason, or a source file was not measured.
"""

from __future__ import annotations

import itertools
import json
import sys
from argparse import ArgumentParser
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LEAST = 95.0  # per cent
REASONS = Path(__file__).with_suffix(".toml")
ROOT = REASONS.parent.parent
Branch = tuple[int, int]


@dataclass(frozen=True)
class Source:
    """The coverage of one file: how often each line ran, and which branches were taken.

    A branch goes from line to line; a negative target is the end of a function.
    """

    file: str
    runs: dict[int, int]
    taken: tuple[Branch, ...] = ()
    not_taken: tuple[Branch, ...] = ()

    @property
    def missed(self) -> list[int]:
        return [line for line, count in sorted(self.runs.items()) if not count]


@dataclass(frozen=True)
class Gap:
    """Consecutive lines, or one branch, that no test reaches."""

    file: str
    first: int
    last: int
    text: str
    branch: bool = False

    @property
    def where(self) -> str:
        if self.branch:
            end = "the end" if self.last < 0 else self.last
            return f"{self.first} never to {end}"
        return f"{self.first}" if self.first == self.last else f"{self.first}-{self.last}"


@dataclass(frozen=True)
class Reason:
    """Why no test reaches the gap of a file whose first line contains a text."""

    file: str
    line: str
    why: str

    def covers(self, gap: Gap) -> bool:
        return gap.file == self.file and self.line in gap.text


@dataclass(frozen=True)
class Share:
    """The share of lines or branches that were reached."""

    what: str
    reached: int
    of: int

    @property
    def percent(self) -> float:
        return 100 * self.reached / self.of if self.of else 100.0

    @property
    def enough(self) -> bool:
        return self.percent >= LEAST

    def __str__(self) -> str:
        return f"{self.percent:6.2f} % {self.what} ({self.reached:,} of {self.of:,})"


# --- input --------------------------------------------------------------------------------------


def read_python(report: Any) -> list[Source]:
    """Parse the JSON report of coverage."""
    return [
        Source(
            file,
            dict.fromkeys(found["missing_lines"], 0) | dict.fromkeys(found["executed_lines"], 1),
            tuple(map(tuple, found["executed_branches"])),
            tuple(map(tuple, found["missing_branches"])),
        )
        for file, found in sorted(report["files"].items())
    ]


def read_kernel(report: Any) -> list[Source]:
    """Parse the JSON report of gcovr, which lists a line of a template once for each instance."""
    return [Source(found["file"], _runs(found["lines"])) for found in report["files"]]


def _runs(lines: list[dict[str, Any]]) -> dict[int, int]:
    runs: Counter[int] = Counter()
    for line in lines:
        if not line.get("gcovr/excluded"):
            runs[line["line_number"]] += line["count"]
    return dict(runs)


def read_reasons(path: Path = REASONS) -> list[Reason]:
    """Read the reasons from `coverage_gaps.toml`."""
    entries = tomllib.loads(path.read_text("utf-8")).get("gap", [])
    return [
        Reason(entry["file"], line, " ".join(entry["why"].split()))
        for entry in entries
        for line in entry["lines"]
    ]


# --- analysis -----------------------------------------------------------------------------------


def shares(kind: str, sources: Iterable[Source]) -> Iterator[Share]:
    """Return the share of lines, and of branches if they were counted, over all sources."""
    sources = list(sources)
    lines, missed = sum(len(s.runs) for s in sources), sum(len(s.missed) for s in sources)
    yield Share(f"of the lines of {kind}", lines - missed, lines)
    taken, left = sum(len(s.taken) for s in sources), sum(len(s.not_taken) for s in sources)
    if taken + left:
        yield Share(f"of the branches of {kind}", taken, taken + left)


def gaps_of(source: Source, text: list[str]) -> Iterator[Gap]:
    """Find the gaps of one file whose lines are `text`."""
    rows = sorted(source.runs)
    first = None
    for line, following in itertools.zip_longest(rows, rows[1:]):
        if not source.runs[line]:
            first = first or line
            if following is None or source.runs[following]:
                yield Gap(source.file, first, line, text[first - 1].strip())
                first = None
    for start, end in source.not_taken:
        if source.runs.get(start) and source.runs.get(end, 1):
            yield Gap(source.file, start, end, text[start - 1].strip(), branch=True)


def reason_for(gap: Gap, reasons: list[Reason]) -> str | None:
    """Return the reason for a gap, if there is one, and remove it from the list."""
    for reason in reasons:
        if reason.covers(gap):
            reasons.remove(reason)
            return reason.why
    return None


def not_measured(sources: Iterable[Source], root: Path = ROOT) -> list[str]:
    """Return the modules and kernel sources that are in neither report."""
    known = {source.file for source in sources}
    files = [*root.glob("liftmesh/**/*.py"), *root.glob("liftmesh/_core/**/*.cpp")]
    return sorted({file.relative_to(root).as_posix() for file in files} - known)


# --- output -------------------------------------------------------------------------------------


def show_all(sources: list[Source], reasons: list[Reason], root: Path) -> int:
    """Print the gaps of every file; return the number of those without a reason."""
    without = 0
    for source in sources:
        gaps = list(gaps_of(source, (root / source.file).read_text("utf-8").splitlines()))
        if gaps:
            print(f"\n{source.file}", *shares("it", [source]), sep="\n")
        for gap in gaps:
            why = reason_for(gap, reasons)
            print(f"    {gap.where}: {gap.text}\n        {why or 'NO REASON IS GIVEN'}")
            without += why is None
    return without


def main(words: list[str] | None = None, root: Path = ROOT, reasons: Path = REASONS) -> int:
    """Print the report; return the exit code."""
    parser = ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("python", type=Path, help="coverage's JSON report")
    parser.add_argument("kernel", type=Path, help="gcovr's JSON report")
    options = parser.parse_args(words)
    python = read_python(json.loads(options.python.read_text("utf-8")))
    kernel = read_kernel(json.loads(options.kernel.read_text("utf-8")))
    without = show_all([*python, *kernel], read_reasons(reasons), root)
    unmeasured = not_measured([*python, *kernel], root)
    totals = [*shares("Python", python), *shares("the kernel", kernel)]
    print("", *totals, f"gaps without a reason: {without}", sep="\n")
    for file in unmeasured:
        print(f"not measured: {file}")
    return int(bool(without or unmeasured) or not all(share.enough for share in totals))


if __name__ == "__main__":
    sys.exit(main())
