"""Build the C program in one of its variants, and run it."""

from __future__ import annotations

import os
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from liftmesh.planar.lifting import REJECTIONS

FOLDER = Path(__file__).parent
LIBRARIES = ("-lm",)
PROCEDURES = ("LF", "LFRes")


@dataclass(frozen=True)
class Counts:
    """The operations of a procedure in one run of Algorithm 2."""

    calls: int
    planes: int
    points: int
    evaluations: int
    comparisons: int
    rejected: dict[str, int]


@dataclass(frozen=True)
class Run:
    """Algorithm 2 with one procedure: seconds of processor time, facets, and its counts."""

    procedure: str
    seconds: float
    facets: int
    complete: bool
    counts: Counts


def compiler() -> list[str]:
    """Return the C compiler's command: CC from the environment, or cc."""
    return shlex.split(os.environ.get("CC", "cc"))


def build(target: Path, flags: tuple[str, ...]) -> str:
    """Compile and link; return the compiler's errors, or an empty string."""
    sources = [str(path) for path in sorted(FOLDER.glob("*.c"))]
    command = [*compiler(), "-std=c99", *flags, *sources, "-o", str(target), *LIBRARIES]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise SystemExit(f"{command[0]} is missing: install gcc, or name one in CC") from error
    return done.stderr if done.returncode else ""


def command_of(
    program: Path, points: Path, q: tuple[float, float], repeat: int, procedure: str = "both"
) -> list[str]:
    """Return the command that runs a built program on a file of points."""
    rows = points.stat().st_size // 16
    return [str(program), str(points), str(rows), repr(q[0]), repr(q[1]), str(repeat), procedure]


def run(
    program: Path,
    points: Path,
    q: tuple[float, float],
    repeat: int = 1,
    *,
    facets: Path | None = None,
) -> list[Run]:
    """Run a built program, which alternates between the procedures."""
    command = command_of(program, points, q, repeat) + ([str(facets)] if facets else [])
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return [parse(line) for line in done.stdout.splitlines()]


def parse(line: str) -> Run:
    """Parse one line of the program's output."""
    procedure, seconds, facets, complete, *numbers = line.split()
    counts = [int(number) for number in numbers]
    rejected = dict(zip(REJECTIONS, counts[5:], strict=True))
    named = Counts(*counts[:5], rejected=rejected)
    return Run(procedure, float(seconds), int(facets), complete == "1", named)


def read_facets(file: Path, runs: list[Run]) -> list[NDArray[np.int32]]:
    """Read the facets of every run, in canonical order."""
    rows = np.fromfile(file, np.int32).reshape(-1, 3)
    ends = np.cumsum([run.facets for run in runs])[:-1]
    return [canonical(part) for part in np.split(rows, ends)]


def canonical(facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Sort the facets, each as three increasing rows."""
    return np.unique(np.sort(facets, axis=1), axis=0)
