"""What the commands of a sweep do without a signal."""

from __future__ import annotations

import hashlib
import io
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jobs import OLD, STDOUT, Command, make_files

import liftmesh
from liftmesh.cli import main

TIMEOUT = 600.0
COMMAND = (sys.executable, "-m", "liftmesh")


@dataclass(slots=True)
class Known:
    """What the commands do without a signal; those of one kind take about as long."""

    seconds: dict[str, float] = field(default_factory=dict)
    printed: dict[Command, tuple[bytes, bytes]] = field(default_factory=dict)  # stdout, stderr
    written: dict[Command, dict[str, str]] = field(default_factory=dict)  # digests


def kind_of(job: Command) -> str:
    """Return the same for commands that take about as long."""
    return f"{job.name}, trimesh" if job.by_trimesh else job.name


def words_of(job: Command) -> list[str]:
    """Return the arguments, with what it reads in the folder above the current one."""
    return job.words("..", "")


def prepare(folder: Path, rows: int, jobs: Sequence[Command]) -> None:
    """Write the files that the jobs read."""
    mesh = liftmesh.triangulate(np.random.default_rng(7).random((rows, 3)))
    make_files(folder, {name for job in jobs for name in job.sources}, mesh)


def fill(folder: Path, job: Command) -> None:
    """Make a folder for one run of a job, with the files that it replaces."""
    folder.mkdir()
    for name in job.targets:
        (folder / name).write_bytes(OLD)


def learn(folder: Path, jobs: Sequence[Command]) -> Known:
    """Run the jobs without a signal: one of each kind as a process, to see how long it takes."""
    known = Known()
    for number, job in enumerate(jobs):
        place = folder / f"whole-{number}"
        fill(place, job)
        if kind_of(job) not in known.seconds or STDOUT in words_of(job):
            began = time.monotonic()
            known.printed[job] = _process(job, place)
            known.seconds[kind_of(job)] = time.monotonic() - began
        else:
            known.printed[job] = _here(job, place)
        known.written[job] = {name: digest(place / name) for name in job.targets}
    return known


def digest(path: Path) -> str:
    """Return what is the same for the same content."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _process(job: Command, place: Path) -> tuple[bytes, bytes]:
    done = subprocess.run(
        [*COMMAND, *words_of(job)], cwd=place, capture_output=True, timeout=TIMEOUT, check=False
    )
    if done.returncode:
        raise SystemExit(f"{job.line}: {done.returncode}, {done.stderr!r}")
    return done.stdout, done.stderr


def _here(job: Command, place: Path) -> tuple[bytes, bytes]:
    shown = io.StringIO()
    here = Path.cwd()
    os.chdir(place)
    try:
        with redirect_stdout(shown):
            code = main(words_of(job))
    finally:
        os.chdir(here)
    if code:
        raise SystemExit(f"{job.line}: {code}")
    return shown.getvalue().encode(), b""
