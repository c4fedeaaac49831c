"""The process that reads the files, started by `campaign.py`.

Its memory is limited, and its output goes to a file, which should stay empty. It prints nothing to
the campaign but lines of JSON: one for each fault, and in the end one with the sums. The file
``current`` names the case at work, for the campaign to tell if the process hangs or dies.
"""

from __future__ import annotations

import json
import os
import re
import resource
import sys
import tempfile
import time
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, TextIO

from fuzz.shrink import shrunk
from fuzz.structure.case import Case
from fuzz.structure.checks import check
from fuzz.structure.generators import generated

ROOM = 1 << 30
SHRINKING = 10.0


@dataclass
class Sums:
    """What the campaign is told in the end."""

    cases: dict[str, int] = field(default_factory=dict)
    read: int = 0
    slowest: tuple[float, str] = (0.0, "")
    fattest: tuple[int, str] = (0, "")


class Worker:
    """Reads the files of some generators, one of each in turn."""

    def __init__(self, folder: Path, report: TextIO) -> None:
        self._folder = folder
        self._report = report
        self._sums = Sums()
        self._known: set[str] = set()
        self._printed = os.open(
            folder / f"printed-{os.getpid()}", os.O_CREAT | os.O_RDWR | os.O_APPEND
        )
        for stream in (1, 2):
            os.dup2(self._printed, stream)

    def warm_up(self, names: list[str]) -> None:
        """Let the readers import what they import, which is neither their time nor their memory."""
        for name in names:
            for number in range(10):
                check(generated(name, number), self._printed)

    def run(self, numbers: range, names: list[str], seconds: float) -> None:
        """Read files until the time is over or the numbers are used up."""
        end = time.monotonic() + seconds
        for number in numbers:
            for name in names:
                self._try(name, number)
            if time.monotonic() > end:
                break
        self._tell("sums", asdict(self._sums))

    def _try(self, name: str, number: int) -> None:
        label = f"{name}-{number}"
        (self._folder / f"current-{os.getpid()}").write_text(label)
        case = generated(name, number)
        found = check(case, self._printed)
        sums = self._sums
        sums.cases[name] = sums.cases.get(name, 0) + 1
        sums.slowest = max(sums.slowest, (found.seconds, label))
        sums.fattest = max(sums.fattest, (found.memory, label))
        if found.fault and (sort := without_numbers(found.fault)) not in self._known:
            self._known.add(sort)
            self._save(label, case, found.fault)

    def _save(self, label: str, case: Case, fault: str) -> None:
        """Save a fault of a new sort, shrunk if it needs no points to compare with."""
        path = self._folder / f"{label}.{case.kind}"
        path.write_bytes(case.data)
        if case.points is None and not fault.startswith(("time", "memory")):
            path.write_bytes(self._shrunk(case, fault))
        self._tell("fault", {"what": fault, "file": str(path), "bytes": path.stat().st_size})

    def _shrunk(self, case: Case, fault: str) -> bytes:
        def fails(data: bytes) -> bool:
            found = check(replace(case, data=data), self._printed).fault
            return without_numbers(found) == without_numbers(fault)

        return shrunk(case.data, fails, time.monotonic() + SHRINKING)

    def _tell(self, key: str, value: Any) -> None:
        self._report.write(json.dumps({key: value}) + "\n")
        self._report.flush()


def without_numbers(fault: str) -> str:
    """Reduce a fault to its sort: no numbers, no quoted texts, no lists."""
    return re.sub(r"'[^']*'|\[.*\]|_?[\da-f]{6}|[\d.]+", "", fault)[:120]


def limit_memory() -> None:
    """Limit the address space to what is in use plus `ROOM`."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + ROOM
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def run_file(path: Path) -> int:
    """Read one file, and print what is wrong with it."""
    limit_memory()
    with tempfile.TemporaryFile() as printed:
        report = os.fdopen(os.dup(1), "w")
        for stream in (1, 2):
            os.dup2(printed.fileno(), stream)
        found = check(Case(path.suffix[1:], path.read_bytes()), printed.fileno())
        report.write(f"{found.fault or 'passes'}\n")
        report.flush()
    return int(bool(found.fault))


def main() -> None:
    if sys.argv[1] == "--file":
        raise SystemExit(run_file(Path(sys.argv[2])))
    folder, seed, step, cases, seconds, *names = sys.argv[1:]
    report = os.fdopen(os.dup(1), "w")
    worker = Worker(Path(folder), report)
    worker.warm_up(names)
    limit_memory()
    first = int(seed)
    worker.run(range(first, first + int(cases) * int(step), int(step)), names, float(seconds))


if __name__ == "__main__":
    main()
