"""How many threads the kernel begins in a program: counted where they begin, not looked for."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import textwrap
from pathlib import Path

SOURCE = Path(__file__).with_suffix(".c")
SETUP = """
import ctypes, os, signal, threading, time, warnings
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
import numpy as np
import liftmesh

counter = ctypes.CDLL(None)

def begun(run):
    "How many threads are begun in a run, and how many there are at once."
    counter.forget_threads()
    run()
    return counter.threads_begun(), counter.most_threads()
"""


def output(program: str, folder: Path, **environment: str) -> str:
    """What a program prints that can ask for the threads begun in a run."""
    library = folder / "begun_threads.so"
    compiler = shlex.split(os.environ.get("CC", "cc"))
    flags = ["-std=gnu11", "-O1", "-shared", "-fPIC", "-Wall", "-Werror"]
    subprocess.run([*compiler, *flags, str(SOURCE), "-o", str(library), "-ldl"], check=True)
    done = subprocess.run(
        [sys.executable, "-c", SETUP + textwrap.dedent(program)],
        capture_output=True,
        text=True,
        env={**os.environ, **environment, "LD_PRELOAD": str(library)},
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
