"""One run of one peer in a fresh process: does it survive, is it right, what memory does it take.

Run as a program it takes a peer's name and a file of points, and prints one JSON object. The
points come from a file because making them would raise the peak of memory before it is measured.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from bench_peers import PEERS
from bench_verify import flaw

CHECKING = 60.0  # seconds that loading the points and checking the triangles may take on top


@dataclass(frozen=True)
class Trial:
    """What a fresh process found: a flaw is empty if the triangles are Delaunay exactly."""

    flaw: str
    seconds: float = 0.0
    triangles: int = 0
    bytes_per_point: float = 0.0


def run_trial(peer: str, file: Path, patience: float) -> Trial:
    """Run the peer in a process of its own, which may crash or take too long."""
    command = [sys.executable, __file__, peer, str(file)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=patience + CHECKING, check=False
        )
    except subprocess.TimeoutExpired:
        return Trial(flaw=f"over {patience:.0f} s")
    if done.returncode < 0:
        return Trial(flaw=f"crash, signal {-done.returncode}")
    if done.returncode:
        return Trial(flaw=complaint(done.stderr))
    return Trial(**json.loads(done.stdout.splitlines()[-1]))


def complaint(stderr: str) -> str:
    """Pick the line of a traceback that names the error."""
    lines = stderr.strip().splitlines()
    return next((line for line in reversed(lines) if "Error" in line), lines[-1])[:80]


def memory(field: str) -> int:
    """Read a size in bytes from the kernel's account of this process."""
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(field):
            return int(line.split()[1]) * 1024
    raise OSError(f"/proc/self/status has no {field}: memory can be measured on Linux only")


def try_out(peer: str, file: Path) -> Trial:
    """Triangulate once, after a tiny run that loads whatever the peer loads, and check."""
    triangulate = PEERS[peer].triangulate
    triangulate(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [3.0, 4.0]]))
    points = np.load(file)
    before, start = memory("VmRSS"), time.perf_counter()
    triangles = triangulate(points)
    seconds = time.perf_counter() - start
    beyond = memory("VmHWM") - before
    return Trial(flaw(points, triangles), seconds, len(triangles), beyond / len(points))


if __name__ == "__main__":
    print(json.dumps(asdict(try_out(sys.argv[1], Path(sys.argv[2])))))
