"""Start workers, watch them, and sum up what they tell."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzz.structure.generators import GENERATORS, generated
from fuzz.targets import SCRIPTS

HANGING = 60.0  # seconds without a new case after which a worker is ended
ENDLESS = 1 << 40


@dataclass
class Found:
    """The sums of a campaign; times in CPU seconds, memory in bytes."""

    cases: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    slowest: tuple[float, str] = (0.0, "")
    fattest: tuple[int, str] = (0, "")

    def take(self, line: str) -> None:
        """Add a line of a worker."""
        told = json.loads(line)
        if "fault" in told:
            self.faults.append("{what}\n  {file} ({bytes} bytes)".format(**told["fault"]))
            return
        sums = told["sums"]
        self.cases.update(sums["cases"])
        self.slowest = max(self.slowest, tuple(sums["slowest"]))
        self.fattest = max(self.fattest, tuple(sums["fattest"]))

    def __str__(self) -> str:
        seconds, slow = self.slowest
        memory, fat = self.fattest
        return (
            f"structure: {self.cases.total():,} cases, {len(self.faults)} faults, "
            f"slowest {seconds:.2f} s ({slow}), fattest {memory >> 20} MB ({fat})"
        )


@dataclass
class Watched:
    """A worker at work, and where it writes what it finds."""

    folder: Path
    first: int
    step: int
    cases: int
    names: Sequence[str]
    end: float
    process: subprocess.Popen[bytes] | None = None

    @property
    def _log(self) -> Path:
        return self.folder / f"log-{self.first}"

    def start(self) -> None:
        """Start the process, or start it anew behind the case that ended it."""
        words = [self.folder, self.first, self.step, self.cases, self.end - time.monotonic()]
        command = [sys.executable, "-m", "fuzz.structure.worker", *map(str, words), *self.names]
        with self._log.open("wb") as log:
            self.process = subprocess.Popen(command, cwd=SCRIPTS, stdout=log, stderr=log)

    def has_ended(self, found: Found) -> bool:
        """Look after the process; take what it told once it ended."""
        assert self.process is not None
        current = self.folder / f"current-{self.process.pid}"
        if self.process.poll() is None:
            if current.exists() and time.time() - current.stat().st_mtime > HANGING:
                self.process.kill()
            return False
        lines = self._log.read_text("utf-8", "replace").splitlines()
        told = [line for line in lines if line.startswith("{")]
        for line in told:
            found.take(line)
        if told and "sums" in told[-1]:
            return True
        return self._is_given_up(found, current, lines)

    def _is_given_up(self, found: Found, current: Path, lines: list[str]) -> bool:
        """Record the case that ended the process, and start behind it."""
        label = current.read_text() if current.exists() else ""
        last = " ".join(lines[-1:])[:300]
        found.faults.append(
            f"ended with {self.process.returncode} at {label or 'its start'} {last}"
        )
        if not label or time.monotonic() > self.end:
            return True
        name, _, number = label.rpartition("-")
        case = generated(name, int(number))
        (self.folder / f"{label}.{case.kind}").write_bytes(case.data)
        done = (int(number) - self.first) // self.step + 1
        self.first, self.cases = int(number) + self.step, self.cases - done
        self.start()
        return False


def hunt(
    folder: Path,
    *,
    seconds: float,
    seed: int,
    jobs: int = 1,
    cases: int = ENDLESS,
    names: Sequence[str] = tuple(GENERATORS),
) -> Found:
    """Let workers read generated files; they share the numbers from ``seed`` on."""
    folder.mkdir(parents=True, exist_ok=True)
    end = time.monotonic() + seconds
    watched = [Watched(folder, seed + k, jobs, cases, names, end) for k in range(jobs)]
    for each in watched:
        each.start()
    found = Found()
    while watched:
        time.sleep(0.1)
        watched = [each for each in watched if not each.has_ended(found)]
    return found


def run_files(files: Sequence[Path]) -> int:
    """Read files of any format, each in a process of its own; return 1 if there is a fault."""
    failed = 0
    for path in files:
        command = [sys.executable, "-m", "fuzz.structure.worker", "--file", str(path.resolve())]
        done = subprocess.run(command, cwd=SCRIPTS, capture_output=True, text=True, check=False)
        failed |= done.returncode
        last = (done.stdout + done.stderr).strip().splitlines()[-1:]
        print(f"{path}: {last[0] if last else f'ended with {done.returncode}'}")
    return int(bool(failed))
