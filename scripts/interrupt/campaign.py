"""Run a job without interruption, then repeatedly with a SIGINT, each time at another moment."""

from __future__ import annotations

import json
import math
import os
import random
import resource
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from itertools import cycle
from pathlib import Path
from typing import Any

from campaign import without_figures
from interrupt.jobs import UNFINISHED
from jobs import LONG_COMMANDS
from process_state import MEGA, RETURNING, State, halted

SCRIPTS = Path(__file__).resolve().parent.parent
LEAK = 64 * MEGA  # memory that a process may hold beyond that after the uninterrupted run
TIMEOUT = 600.0
# The exit code and the line of each signal that ends a command.
ENDS = {
    signal.SIGINT: (130, "liftmesh: error: interrupted\n"),
    signal.SIGTERM: (143, "liftmesh: error: terminated by SIGTERM\n"),
}
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


def _of_ended() -> float:
    """The CPU seconds of all children that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


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


def interrupt_command(job: str, folder: Path, rounds: int, seed: int) -> JobResult:
    """Interrupt a command, in a new process each time."""
    words = tuple(LONG_COMMANDS[job].words(folder, folder / "out"))
    child, began = _started(words, folder)
    code = child.wait(TIMEOUT)
    whole = time.monotonic() - began
    output, _ = child.communicate()
    if code:
        raise SystemExit(f"{job}: the uninterrupted run exited with {code}")
    files = _files(folder)
    moments = delays(whole, rounds, random.Random(f"{job} {seed}"))
    return JobResult(
        job,
        whole,
        tuple(
            _signalled(words, number, each, folder, files, output)
            for number, each in zip(cycle(ENDS), moments, strict=False)
        ),
    )


def _started(words: tuple[str, ...], folder: Path) -> tuple[subprocess.Popen[str], float]:
    """Start a command, and wait until it has opened its file, which leaves out the imports."""
    child = subprocess.Popen(
        [sys.executable, "-m", "liftmesh", *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while words[1] not in _open_files(child.pid) and child.poll() is None:
        time.sleep(0.001)
    return child, time.monotonic()


def _open_files(process: int) -> list[str]:
    names = []
    with suppress(OSError):
        for each in Path(f"/proc/{process}/fd").iterdir():
            with suppress(OSError):
                names.append(str(each.readlink()))
    return names


def _signalled(
    words: tuple[str, ...],
    number: signal.Signals,
    delay: float,
    folder: Path,
    files: dict[str, int],
    output: str,
) -> Interrupt:
    others = _of_ended()
    child, began = _started(words, folder)
    time.sleep(max(0.0, began + delay - time.monotonic()))
    with halted(child):
        opened, told = _open_files(child.pid), _told(child)
        computed = _computed(child) if child.returncode is None else math.inf
        child.send_signal(number)
        sent = time.monotonic()
    out, err = child.communicate(timeout=TIMEOUT)
    seconds, out = time.monotonic() - sent, told + out
    if child.returncode == 0:
        return _ended_before(delay, 0.0 if told == out else _of_ended() - others - computed)
    faults = list(_changes(folder, files))
    # It may have begun to print its results.
    if (child.returncode, err) != ENDS[number] or not without_figures(output).startswith(
        without_figures(out)
    ):
        faults.append(f"exit code {child.returncode}, {out!r}, {err[-500:]!r}")
    return Interrupt(delay, _stage(opened, folder, words), seconds, tuple(faults))


def _told(child: subprocess.Popen[str]) -> str:
    """Return what a command has printed so far."""
    output = child.stdout.fileno()
    ready, _, _ = select.select([output], [], [], 0)
    return os.read(output, 1 << 16).decode() if ready else ""


def _stage(opened: list[str], folder: Path, words: tuple[str, ...]) -> str:
    if words[1] in opened:
        return "reading"
    return "writing" if any(name.startswith(str(folder / "out")) for name in opened) else "working"
