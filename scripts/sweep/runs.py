"""One run of a sweep: a command, a signal at some moment, perhaps a second one, and what is wrong.

The masks in ``/proc/<process>/status`` say what a signal meets: before our first line SIGTERM has
its default; then both signals have handlers; once the exit code is decided, both are ignored.
"""

from __future__ import annotations

import hashlib
import math
import random
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from campaign import without_figures
from jobs import OLD, Command
from process_state import halted
from sweep.jobs import COMMAND, TIMEOUT, Known, digest, fill, kind_of, words_of

SIGNALS = (signal.SIGINT, signal.SIGTERM)
BEFORE, DURING, AFTER = "before the first line", "during the command", "after the result"

_OLD = hashlib.sha256(OLD).hexdigest()
_MESSAGES = {signal.SIGINT: b"interrupted", signal.SIGTERM: b"terminated by SIGTERM"}
_LATE = 0.8  # share of the expected time: few commands should take longer
_TICK = 0.02  # CPU seconds after a signal in which a call that had begun may end
_DECIDING = 0.03  # CPU seconds from the decision about the exit code until signals are ignored


@dataclass(frozen=True, slots=True)
class Plan:
    """What to do in a run: the job, the signals, at what share of its time, the gap between."""

    number: int
    job: Command
    signals: tuple[signal.Signals, ...]
    share: float
    gap: float

    def __str__(self) -> str:
        names = " and ".join(each.name for each in self.signals)
        return f"run {self.number}: {self.job.line}: {names} at {self.share:.0%}"


@dataclass(frozen=True, slots=True)
class Run:
    """What came of a plan: where the signal met the command, how long it took, what is wrong."""

    plan: Plan
    stage: str
    seconds: float
    faults: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _End:
    """How a process ended."""

    code: int
    out: bytes
    err: bytes
    heard: float  # time of day when it had computed a little after the signal
    seconds: float  # from the last signal
    stage: str


def plan(number: int, seed: int, jobs: list[Command]) -> Plan:
    """Draw a run: any job, either signal, any moment, and a second signal now and then."""
    draw = random.Random(f"{seed} {number}")
    job = draw.choice(jobs)
    signals = tuple(draw.choices(SIGNALS, k=draw.choice((1, 1, 1, 2))))
    return Plan(number, job, signals, draw.random(), draw.uniform(0.0, 0.1))


def run(planned: Plan, folder: Path, known: Known, most: float, second: float) -> Run:
    """Do what was planned in a folder of its own."""
    place = folder / f"run-{planned.number}"
    fill(place, planned.job)
    end = _signalled(planned, place, known)
    limit = most if len(planned.signals) == 1 else second
    faults = [*_of_code(planned, end, known), *_of_files(planned, end, place, known)]
    if end.seconds > limit and end.stage == DURING:
        faults.append(f"it took {end.seconds:.2f} s")
    shutil.rmtree(place)
    return Run(planned, end.stage, end.seconds, tuple(faults))


def _signalled(planned: Plan, place: Path, known: Known) -> _End:
    child = subprocess.Popen(
        [*COMMAND, *words_of(planned.job)],
        cwd=place,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    _wait(child, planned, known)
    with halted(child):
        stage = _stage(child)
        child.send_signal(planned.signals[0])
        computed, last = _computed(child), time.monotonic()
    ignores, heard = _watched(child, computed)
    is_late = stage == DURING and ignores
    for each in planned.signals[1:]:
        time.sleep(planned.gap)
        last = time.monotonic()
        child.send_signal(each)
    try:
        out, err = child.communicate(timeout=TIMEOUT)
    finally:
        child.kill()
    if child.returncode == 0 and is_late:
        stage = AFTER
    return _End(child.returncode, out, err, heard, time.monotonic() - last, stage)


def _wait(child: subprocess.Popen[bytes], planned: Plan, known: Known) -> None:
    """Wait for the moment of the signal; learn how long a command of this kind takes."""
    began = time.monotonic()
    expected = known.seconds[kind_of(planned.job)]
    try:
        child.wait(planned.share * expected)
    except subprocess.TimeoutExpired:
        if planned.share > _LATE:
            known.seconds[kind_of(planned.job)] = 1.3 * expected
    else:
        known.seconds[kind_of(planned.job)] = time.monotonic() - began


def _stage(child: subprocess.Popen[bytes]) -> str:
    """Find out what a signal meets."""
    if child.poll() is not None:
        return AFTER
    text = Path(f"/proc/{child.pid}/status").read_text("ascii")
    caught, ignored = (
        int(re.search(rf"^{name}:\s*(\w+)", text, re.MULTILINE)[1], 16)
        for name in ("SigCgt", "SigIgn")
    )
    bit = 1 << (signal.SIGTERM - 1)
    if ignored & bit:
        return AFTER
    return DURING if caught & bit else BEFORE


def _watched(child: subprocess.Popen[bytes], computed: float) -> tuple[bool, float]:
    """Whether a process begins to ignore signals, and the time of day at which it had heard one.

    If it ignores them, it had just decided about its exit code.
    """
    ignores, heard = False, math.inf
    while (since := _computed(child) - computed) < _DECIDING:
        if heard == math.inf and since >= _TICK:
            heard = time.time()
        ignores = ignores or _stage(child) == AFTER
        time.sleep(0.002)
    return ignores, min(heard, time.time())


def _computed(child: subprocess.Popen[bytes]) -> float:
    """The CPU seconds of the main thread, however busy the machine is; infinite at its end."""
    if child.poll() is not None:
        return math.inf
    return int(Path(f"/proc/{child.pid}/schedstat").read_text("ascii").split()[0]) / 1e9


def _of_code(planned: Plan, end: _End, known: Known) -> Iterator[str]:
    """Look at the exit code and at what was printed."""
    out, err = known.printed[planned.job]
    # A busy machine may deliver two signals at once, and then in any order.
    lines = {128 + each: b"liftmesh: error: %s\n" % _MESSAGES[each] for each in planned.signals}
    if end.code in lines and end.err.endswith(lines[end.code]):
        told = end.err.removesuffix(lines[end.code])
    elif end.stage == BEFORE and _python_ended(planned, end):
        told = b""
    elif end.stage == AFTER and end.code == 0:
        told = end.err
    else:
        yield f"exit code {end.code} {end.stage}"
        told = end.err
    if not (_begins(told, err) and _begins(end.out, out)):
        yield f"it printed {end.out[-300:]!r} and {end.err[-300:]!r}"


def _python_ended(planned: Plan, end: _End) -> bool:
    """Whether Python itself died of the signal, or lost it where no exception can pass."""
    dead = {1, *(-each for each in planned.signals)}  # 1: Ctrl-C before it is ready
    later = {0, *(128 + each for each in planned.signals[1:])}
    return end.code in dead or (b"Exception ignored in" in end.err and end.code in later)


def _was_lost(end: _End) -> bool:
    """Whether Python lost the signal before the first line, so that the command went on."""
    return end.stage == BEFORE and end.code == 0


def _begins(found: bytes, whole: bytes) -> bool:
    """Whether a text is the beginning of another, apart from the numbers, which differ."""
    one, other = (without_figures(each.decode("utf-8", "replace")) for each in (whole, found))
    return one.startswith(other)


def _of_files(planned: Plan, end: _End, place: Path, known: Known) -> Iterator[str]:
    """Look at the files: old, or whole and put in place before the signal."""
    for path in place.iterdir():
        if path.name.startswith("."):
            yield f"{path.name} was left behind"
        elif path.name in planned.job.targets and (found := digest(path)) != _OLD:
            if found != known.written[planned.job][path.name]:
                yield f"{path.name} is not whole"
            if path.stat().st_ctime > end.heard and not _was_lost(end):
                yield f"{path.name} was written {path.stat().st_ctime - end.heard:.3f} s later"
