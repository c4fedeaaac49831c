"""Commands that are stopped in the middle of a stage; their open files show which stage it is."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from commands import COMMAND, PLAIN
from faults.children import ALONE


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


def open_files(child: subprocess.Popen[str]) -> Iterator[tuple[str, int]]:
    """Yield the links and the sizes of what a child has open; one may close meanwhile."""
    with suppress(OSError):
        for each in Path(f"/proc/{child.pid}/fd").iterdir():
            with suppress(OSError):
                yield str(each.readlink()), each.stat().st_size


def reads(child: subprocess.Popen[str], source: Path) -> bool:
    """Whether a file is open."""
    return any(link == str(source) for link, _ in open_files(child))


def writes(child: subprocess.Popen[str], folder: Path) -> bool:
    """Whether a new file in the folder, nameless or hidden, has grown."""
    return any(
        size > 1 << 16
        and link.startswith(f"{folder}/")
        and (link.endswith(" (deleted)") or "/.liftmesh-" in link)
        for link, size in open_files(child)
    )


def wait_until(child: subprocess.Popen[str], is_so: Callable[[], bool]) -> None:
    """Wait for a moment in the life of a child."""
    end = time.monotonic() + 300
    while not is_so():
        assert child.poll() is None, "it ended before: " + str(child.communicate())
        assert time.monotonic() < end
        time.sleep(0.001)


def ended(child: subprocess.Popen[str], signal: int) -> tuple[int, str, str]:
    """Send a signal; the exit code and both streams."""
    child.send_signal(signal)
    out, err = child.communicate(timeout=300)
    return child.returncode, out, err
