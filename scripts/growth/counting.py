"""Count the instructions of calls in a Python process, with valgrind's callgrind.

A child process runs under callgrind, which interprets every instruction of the interpreter, of
NumPy and of the kernel. That makes a start with all imports some fifty times slower, so one child
makes many calls. All inputs are made, and each call is made once to import what it needs, before
callgrind is switched on; that happens once, since it translates all code anew each time. Before it
is counted, a call is made again to fill caches, unless a smaller one has done that. What counts is
between two marks, at which callgrind states in its log what it has counted so far: requests,
compiled from `marks.c`. The counts are reproducible to about a per cent, and do not depend on what
else the machine does.

What the system does in the calls of a process (copying a file into a buffer, clearing new pages) is
not in the counts.
"""

from __future__ import annotations

import copy
import ctypes
import gc
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

HERE = Path(__file__).parent
TOOL = ("valgrind", "--tool=callgrind", "--quiet", "--instr-atstart=no")
MARK = "instrumentation: on\n"
EXECUTED = re.compile(r"^events-\d+: (\d+)$", re.MULTILINE)

# One thread, the same order of sets and dictionaries in each run, no tracer in the child, and
# memory for large arrays from the system each time, so that malloc copies what grows alike.
ALONE = {
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "PYTHONHASHSEED": "0",
    "MALLOC_MMAP_THRESHOLD_": "65536",
    "MALLOC_TRIM_THRESHOLD_": "65536",
}
TRACERS = ("COVERAGE_PROCESS_START", "COVERAGE_PROCESS_CONFIG")


@dataclass(frozen=True, slots=True)
class Work:
    """A call whose input is at hand, and the size of that input in rows or bytes.

    `warm` is whether the call is to be made once before it is counted.
    """

    call: Callable[[], object]
    units: int
    warm: bool = True


Prepare: TypeAlias = Callable[[Any], Work]


def on(
    make: Callable[[Any], Any], *, fresh: bool = False
) -> Callable[[Callable[..., object]], Prepare]:
    """Return what prepares calls on a thing made of points; on fresh copies if it keeps results."""

    def prepare_call(call: Callable[..., object]) -> Prepare:
        def prepare(points: Any) -> Work:
            made = make(points)
            return Work(lambda: call(copy.copy(made) if fresh else made), len(points))

        return prepare

    return prepare_call


@dataclass(frozen=True, slots=True)
class Count:
    """The instructions of a call, the size of its input, and the error that ended it, if any."""

    instructions: int
    units: int
    error: str = ""


def count(
    prepare: str, jobs: list[Any], *, python: str = sys.executable, seconds: float | None = None
) -> list[Count]:
    """Count every job in one child process.

    `prepare` is the ``module:function`` of this folder's package that makes a `Work` of a job.
    Jobs are JSON values.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "jobs.json").write_text(json.dumps([prepare, jobs]))
        log = folder / "log"
        files = (f"--log-file={log}", f"--callgrind-out-file={folder / 'profile'}")
        words = [*TOOL, *files, python, HERE / "worker.py", built(folder), folder / "jobs.json"]
        told = [*map(json.loads, _run([*map(str, words)], log, seconds))]
        executed = marked(log.read_text())
    pairs = zip(executed[::2], executed[1::2], strict=True)
    return [Count(end - begin, *each) for (begin, end), each in zip(pairs, told, strict=True)]


def built(folder: Path) -> Path:
    """Compile the marks."""
    library = folder / "marks.so"
    compiler = shlex.split(os.environ.get("CC", "cc"))
    words = [*compiler, "-O1", "-shared", "-fPIC", str(HERE / "marks.c"), "-o", str(library)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise SystemExit(f"{compiler[0]} is missing: install gcc, or name one in CC") from error
    if done.returncode:
        raise SystemExit(f"{done.stderr}\nvalgrind's headers may be missing (Debian: valgrind)")
    return library


def _run(words: list[str], log: Path, seconds: float | None) -> list[str]:
    """Run the child; return the lines that it prints."""
    env = {key: value for key, value in os.environ.items() if key not in TRACERS} | ALONE
    try:
        done = subprocess.run(
            words, capture_output=True, text=True, env=env, timeout=seconds, check=False
        )
    except FileNotFoundError as error:
        raise SystemExit("valgrind is missing: install it (Debian: valgrind)") from error
    if done.returncode:
        told = f"{done.stderr[-3000:]}\n{log.read_text()[-1000:] if log.exists() else ''}"
        raise SystemExit(f"the counted process ended with {done.returncode}:\n{told}")
    return done.stdout.splitlines()


def marked(log: str) -> list[int]:
    """Return the instructions that all threads had executed at each mark.

    >>> marked("instrumentation: on\\nevents-1: 12\\ninstrumentation: on\\nevents-1: 15\\n")
    [12, 15]
    """
    return [sum(map(int, EXECUTED.findall(each))) for each in log.split(MARK)[1:]]


def work_through(library: str, jobs: Path) -> None:
    """Make all calls of a child, and print the size and the error of each."""
    marks = ctypes.CDLL(library)
    prepare, values = json.loads(jobs.read_text())
    make = _function(prepare)
    works = [ready(make(value)) for value in values]
    gc.collect()
    gc.freeze()
    marks.start()
    for work in works:
        ready(work)  # what other calls have pushed out of caches
        gc.collect()
        gc.disable()
        marks.mark()
        error = attempt(work.call)
        marks.mark()
        gc.enable()
        print(json.dumps([work.units, error]), flush=True)


def ready(work: Work) -> Work:
    """Make the call that is not counted, if there is to be one."""
    if work.warm:
        attempt(work.call)
    return work


def attempt(call: Callable[[], object]) -> str:
    """Make a call; return the error by which liftmesh refused the input, if it did."""
    from liftmesh import LiftmeshError  # noqa: PLC0415 - counting itself needs no liftmesh

    with suppress(MemoryError):
        try:
            call()
        except LiftmeshError as error:
            return f"{type(error).__name__}: {error}"
    return ""


def _function(name: str) -> Callable[[Any], Work]:
    from importlib import import_module  # noqa: PLC0415

    module, _, function = name.partition(":")
    found: Callable[[Any], Work] = getattr(import_module(module), function)
    return found
