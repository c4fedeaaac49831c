"""Disturb each job at each of its system calls, and look at what is left behind.

Whatever happens, a job ends well, or in an error that names the file; every file is as it was
before, or complete; and there is no other file. If a job ends well, its files are complete. A call
that fails is an `OSError`: only what others do to a file may make it an invalid one.
"""

from __future__ import annotations

import errno
import random
import re
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fault_injection.control import ACT, FAULTS, Fault, Shim
from fault_injection.jobs import LONGEST, Ended, Job
from fault_injection.races import OTHER, RACES, READ_RACES, aside

SILENT = "stdout"  # a file of which a part may be written
LASTING = ("read", "write", "open", "close", "fsync", "ftruncate", "rename", "link")

Files = dict[str, bytes]


@dataclass(frozen=True, slots=True)
class Case:
    """A job and its disturbance."""

    job: Job
    fault: Fault

    def __str__(self) -> str:
        return f"{self.job.name}: {self.fault}"


class ShimWatch:
    """Arms the shim, and keeps the names of the calls, also those of a fork, in a file."""

    def __init__(self, folder: Path) -> None:
        self._shim = Shim(folder)
        self._names = folder.with_name("calls")

    def set(
        self, fault: Fault | None, action: Callable[[], None] | None, *, nameless: bool
    ) -> None:
        """Set what is to happen in the next run."""
        self._set = (fault, action, nameless)

    def begin(self) -> None:
        fault, action, nameless = self._set
        self._shim.arm(fault, nameless=nameless, action=action)

    def end(self) -> None:
        self._shim.disarm()
        if self._set[0] is None:
            self._names.write_text("\n".join(self._shim.calls()))

    def calls(self) -> list[str]:
        """Return the names of the calls of the last run that was not disturbed."""
        return self._names.read_text().split()


class Sweep:
    """All jobs, in a folder that the shim watches."""

    def __init__(self, place: Path, listed: list[Job]) -> None:
        self._folder = place / "watched"
        self._jobs = listed
        self._watch = ShimWatch(self._folder)
        self._before: dict[str, Files] = {}
        self._whole: dict[str, Files] = {}
        self._points: dict[str, bytes] = {}

    def cases(self, seed: int) -> list[Case]:
        """List the cases of all jobs in random order; each job runs undisturbed first."""
        found = [Case(job, fault) for job in self._jobs for fault in self._faults(job)]
        random.Random(seed).shuffle(found)
        return found

    def _faults(self, job: Job) -> Iterator[Fault]:
        for _ in range(2):  # the first one imports
            ended = self._run(job, None)
            if not ended.is_done or ended.wrong:
                raise SystemExit(f"{job.name} fails undisturbed: {ended.message}{ended.wrong}")
            self._whole[job.name] = contents(self._folder)
            self._points[job.name] = ended.points
        for at, name in enumerate(self._watch.calls(), 1):
            for kind in FAULTS[name]:
                yield Fault(at, kind)
                if name in LASTING and kind > 0 and kind != errno.EINTR:
                    yield Fault(at, kind, is_lasting=True)
            for action in READ_RACES if job.is_reader else RACES:
                yield Fault(at, ACT, action=action)

    def _run(self, job: Job, fault: Fault | None) -> Ended:
        """Prepare the folder and run a job; the shim is armed in between."""
        for folder in (self._folder, aside(self._folder)):
            shutil.rmtree(folder, ignore_errors=True)
        self._folder.mkdir()
        job.prepare(self._folder)
        self._before[job.name] = contents(self._folder)
        target = self._folder / job.target
        race = READ_RACES[fault.action] if fault and fault.action else None
        action = (lambda: race(target)) if race else None
        self._watch.set(fault, action, nameless=job.nameless)
        signal.alarm(LONGEST)
        ended = job.run(self._folder, self._watch)
        signal.alarm(0)
        return ended

    def check(self, case: Case) -> tuple[float, str]:
        """Run a case; return the seconds, and what is wrong."""
        began = time.monotonic()
        try:
            ended = self._run(case.job, case.fault)
        except Exception as error:  # noqa: BLE001 - this is what is looked for
            return time.monotonic() - began, f"{type(error).__name__}: {error}"
        seconds = time.monotonic() - began
        wrong = (ended.wrong, misjudged(case, ended), self._left(case, ended))
        return seconds, "; ".join(filter(None, wrong))

    def _left(self, case: Case, ended: Ended) -> str:
        """Describe what is wrong with the files that are there afterwards."""
        name, action = case.job.name, case.fault.action
        before, whole = self._before[name], self._whole[name]
        found = contents(self._folder) | contents(aside(self._folder))
        for each, data in found.items():
            others = (OTHER,) if each == case.job.target and action == "another writer" else ()
            if each not in whole:
                return f"{each} is left behind"
            is_part = each == SILENT or action == "file cut"
            if data not in (before.get(each), whole.get(each), *others) and not is_part:
                return f"{each} is neither old nor complete: {len(data)} bytes"
        if ended.is_done and not action:
            if missing(found, whole):
                return f"it ends well, but {missing(found, whole)} is not complete"
            if ended.points != self._points[name]:
                return "other points than undisturbed"
        if not action and (lost := before.keys() - found.keys()):
            return f"{min(lost)} is gone"
        return ""


def misjudged(case: Case, ended: Ended) -> str:
    """Describe an error of the system that is told as one of the file; "" if it is not."""
    is_wrong = ended.is_refused and not case.fault.action
    return f"the file is called invalid: {ended.message}" if is_wrong else ""


def missing(found: Files, whole: Files) -> str:
    """Name a file that is not as it should be; "" if all are. Reports differ in their seconds."""
    for name, expected in whole.items():
        data = found.get(name, b"")
        if data != expected and (name != SILENT or _words(data) != _words(expected)):
            return name
    return ""


def _words(report: bytes) -> bytes:
    return re.sub(rb"[\d. ]+", b"", report)


def contents(folder: Path) -> Files:
    """Read all files of a folder; folders and links that lead nowhere have no content."""
    if not folder.is_dir():
        return {}
    return {each.name: each.read_bytes() for each in folder.iterdir() if each.is_file()}
