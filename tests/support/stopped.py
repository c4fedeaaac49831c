"""Programs that stop themselves amid the writing of a file, however busy the machine is."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from pathlib import Path

from children import ALONE
from commands import COMMAND, PLAIN

# Makes a program stop itself once a file that it writes has grown.
STOPS = """
import os, signal
from liftmesh.io import write

real = write._write

class Stopping:
    def __init__(self, stream):
        self.stream, self.left = stream, 1 << 16

    def __getattr__(self, name):
        return getattr(self.stream, name)

    def write(self, data):
        written = self.stream.write(data)
        is_more, self.left = self.left > 0, self.left - written
        if is_more and self.left <= 0:
            os.kill(os.getpid(), signal.SIGSTOP)
        return written

write._write = lambda stream, *rest: real(Stopping(stream), *rest)
"""


def begun(*words: object, cwd: Path, program: str = "") -> subprocess.Popen[str]:
    """Start a command, or a program in Python, with pipes for its streams."""
    command = [COMMAND[0], "-c", program] if program else COMMAND
    return subprocess.Popen(
        [*command, *map(str, words)],
        cwd=cwd,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**PLAIN, "OPENBLAS_NUM_THREADS": ALONE["OPENBLAS_NUM_THREADS"]},
    )


def wait_until_stopped(child: subprocess.Popen[str]) -> None:
    """Wait until a child has stopped itself."""
    status = Path(f"/proc/{child.pid}/status")
    while not re.search(r"^State:\s+T", status.read_text(), re.MULTILINE):
        assert child.poll() is None, "it ended before: " + str(child.communicate())
        time.sleep(0.005)


def ended(child: subprocess.Popen[str], *signals: int) -> tuple[int, str, str]:
    """Send signals to a child that is stopped, and let it go on; its exit code and streams."""
    for each in (*signals, signal.SIGCONT):
        child.send_signal(each)
    out, err = child.communicate(timeout=300)
    return child.returncode, out, err


# The signal comes when this program has run for a time of its own, however busy the machine is.
LONG_RUN = textwrap.dedent(
    """
    import signal, sys, time
    import numpy as np
    import liftmesh

    rng = np.random.default_rng(0)
    points = {points}
    {prepare}
    liftmesh.delaunay([[0, 0], [1, 0], [0, 1]])  # what it imports is no part of the run
    signal.signal(signal.SIGPROF, signal.default_int_handler)  # that of Ctrl-C
    delay, began = float(sys.argv[1]), time.process_time()
    signal.setitimer(signal.ITIMER_PROF, delay)
    try:
        {call}
    except KeyboardInterrupt:
        print("interrupted", time.process_time() - began - delay, flush=True)
    else:
        print("finished", flush=True)
    """
)


class Ticker:
    """Counts in a second thread how often Python code runs while the first one is busy."""

    def __enter__(self) -> Ticker:
        self.ticks = 0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()
        return self

    def _run(self) -> None:
        while not self._stop.wait(0.001):
            self.ticks += 1

    def __exit__(self, *error: object) -> None:
        self._stop.set()
        self._thread.join()


def assert_another_thread_runs(call: Callable[[], object]) -> None:
    """Try again where it does not: it may wait for a processor as long as a call takes."""
    assert any(ticks_during(call) > 20 for _ in range(100))


def ticks_during(call: Callable[[], object]) -> int:
    with Ticker() as ticker:
        before = ticker.ticks
        call()
        return ticker.ticks - before


def seconds_to_stop(program: str, delay: float) -> float:
    """Interrupt a program; how long it computes until it hears that, in its own seconds of CPU.

    A call that never looks for signals hears this one at its end, after seconds.
    """
    child = subprocess.run(
        [sys.executable, "-c", program, str(delay)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert child.stdout.startswith("interrupted"), child.stdout + child.stderr
    return float(child.stdout.split()[1])
