"""Programs that stop themselves amid the writing of a file, however busy the machine is."""

from __future__ import annotations

import re
import signal
import subprocess
import time
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
