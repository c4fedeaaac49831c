"""Run a job without interruption, then repeatedly with a SIGINT, each time at another moment."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from interrupt.jobs import UNFINISHED
from process_state import MEGA, RETURNING, State, halted

SCRIPTS = Path(__file__).resolve().parent.parent
LEAK = 64 * MEGA  # memory that a process may hold beyond that after the uninterrupted run
NOT_REACHED = "ended before"
AGAIN = "the files of a run after all of them"
AT_ONCE = 0.3  # CPU seconds in which a process ends whose result is there


@dataclass(frozen=True, slots=True)
class Interrupt:
    """One interrupt: when it was sent, where it hit the job, and how long the prompt took."""

    delay: float
    place: str
    seconds: float
    faults: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class JobResult:
    """A job, the seconds of its uninterrupted run, and its interrupts."""

    job: str
    uninterrupted: float
    interrupts: tuple[Interrupt, ...]


def delays(duration: float, rounds: int, random_: random.Random) -> list[float]:
    """Draw a random moment in each of `rounds` equal parts of a run."""
    return [duration * 0.97 * (k + random_.random()) / rounds for k in range(rounds)]


def interrupt_job(job: str, folder: Path, rounds: int, seed: int) -> JobResult:
    """Interrupt a library call, repeatedly in one process."""
    with _worker(job, folder) as child:
        whole = _attempt(child, None)
        files, held = _files(folder), _state(whole)
        moments = delays(whole["seconds"], rounds, random.Random(f"{job} {seed}"))
        own = folder / UNFINISHED[job] if job in UNFINISHED else None
        changes = partial(_changes, folder, files, own)
        interrupts = [_interrupted(child, moment, held, changes) for moment in moments]
        if own is not None:
            _attempt(child, None)
            interrupts.append(Interrupt(0.0, AGAIN, 0.0, tuple(_changes(folder, files))))
    return JobResult(job, whole["seconds"], tuple(interrupts))


@contextmanager
def _worker(job: str, folder: Path) -> Iterator[subprocess.Popen[str]]:
    child = subprocess.Popen(
        [sys.executable, "-m", "interrupt.worker", job, str(folder)],
        cwd=SCRIPTS,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, **RETURNING},
    )
    try:
        _answer(child)
        yield child
    finally:
        child.kill()
        child.communicate()


def _answer(child: subprocess.Popen[str]) -> dict[str, Any]:
    line = child.stdout.readline()
    if not line:
        raise SystemExit(f"the process ended: {child.wait()}")
    return json.loads(line)


def _attempt(child: subprocess.Popen[str], delay: float | None) -> dict[str, Any]:
    """Run a job, interrupt it after a delay, and measure the seconds until the prompt."""
    child.stdin.write("again\n")
    child.stdin.flush()
    _answer(child)
    if delay is None:
        return {**_answer(child), "until": 0.0, "went_on": 0.0}
    time.sleep(delay)
    with halted(child):
        computed = _computed(child)
        child.send_signal(signal.SIGINT)
        sent = time.monotonic()
    answer = _answer(child)
    went_on = answer["computed"] - computed
    return {**answer, "until": answer["ended"] - sent, "went_on": went_on}


def _computed(child: subprocess.Popen[str]) -> float:
    """The CPU seconds of a process, which other work of the machine does not change."""
    return time.clock_gettime(~child.pid << 3 | 2)  # its clock, as clock_getcpuclockid(3) says


def _interrupted(
    child: subprocess.Popen[str],
    delay: float,
    held: State,
    changes: Callable[[], Iterator[str]],
) -> Interrupt:
    answer = _attempt(child, delay)
    if not answer["place"]:
        return _ended_before(delay, answer["went_on"])
    return Interrupt(
        delay,
        answer["place"],
        answer["until"],
        (*_faults(_state(answer), held), *changes()),
    )


def _ended_before(delay: float, seconds: float) -> Interrupt:
    """A run that a signal did not end: it is over at once, unless the signal was lost."""
    lost = (f"went on for {seconds:.2f} CPU seconds as if there were no signal",)
    return Interrupt(delay, NOT_REACHED, 0.0, lost if seconds > AT_ONCE else ())


def _state(answer: dict[str, Any]) -> State:
    return State(answer["resident"], answer["files"], answer["threads"])


def _faults(found: State, held: State) -> Iterator[str]:
    if found.resident > held.resident + LEAK:
        yield f"{(found.resident - held.resident) / MEGA:.0f} MB are leaked"
    if found.files != held.files:
        yield f"{found.files - held.files} more files are open"
    if found.threads != held.threads:
        yield f"{found.threads - held.threads} more threads are there"


def _files(folder: Path) -> dict[str, int]:
    """Return the size of every file; all are complete, so another size is a partial write."""
    return {str(path): path.stat().st_size for path in folder.rglob("*") if path.is_file()}


def _changes(folder: Path, before: dict[str, int], own: Path | None = None) -> Iterator[str]:
    """Name the files that are others than before, but for those in a folder of the job's own."""
    after = _files(folder)
    for name in sorted(before.keys() | after.keys()):
        if own is not None and Path(name).is_relative_to(own):
            continue
        if before.get(name) != after.get(name):
            yield f"{name} was {'changed' if name in before else 'left behind'}"
