"""Programs that are to be hurt: each in a process of its own, which must end and be heard."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

# NumPy's own threads would each take address space of their own, and so would malloc's pools; what
# is freed goes back to the system at once, so that what is held can be seen from outside.
ALONE = {
    **os.environ,
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
    "MALLOC_MMAP_THRESHOLD_": "65536",
    "MALLOC_TRIM_THRESHOLD_": "65536",
}

# What programs need to measure and to limit themselves.
MEASURES = """
import gc, resource

def status(key):
    with open("/proc/self/status") as lines:
        return next(int(line.split()[1]) * 1024 for line in lines if line.startswith(key + ":"))

def limit(more):
    resource.setrlimit(resource.RLIMIT_AS, (status("VmSize") + more, resource.RLIM_INFINITY))

def unlimited():
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))

def held():
    gc.collect()
    return status("VmRSS")
"""


def started(program: str, *words: object) -> subprocess.Popen[str]:
    """Start a program that has the measures, with pipes for its streams."""
    return subprocess.Popen(
        [sys.executable, "-c", MEASURES + textwrap.dedent(program), *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ALONE,
    )


def output(program: str, *words: object, seconds: float = 400) -> str:
    """Return what a program prints; it must end well, and in time."""
    child = started(program, *words)
    try:
        told, complaint = child.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        child.kill()
        child.communicate()
        raise
    assert child.returncode == 0, complaint[-3000:]
    return told
