"""Count instructions, mispredicted branches and cache misses with cachegrind.

The simulated caches are those of a laptop's Core i5 of the paper's time: 32 KiB of data at the
first level, 256 KiB at the second. Cachegrind's branch predictor is simple: its counts are an order
of magnitude.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from paper_port.build import PROCEDURES, build, command_of

if TYPE_CHECKING:
    from paper_port.inputs import Vertex

TOOL = (
    "valgrind",
    "--tool=cachegrind",
    "--branch-sim=yes",
    "--cache-sim=yes",
    "--D1=32768,8,64",
    "--LL=262144,8,64",
    "--cachegrind-out-file=/dev/null",
)
PATTERNS = {
    "instructions": r"I\s+refs:\s+([\d,]+)",
    "branches": r"Branches:\s+([\d,]+)",
    "mispredicted": r"Mispredicts:\s+([\d,]+)",
    "first-level misses": r"D1\s+misses:\s+([\d,]+)",
    "second-level misses": r"LLd misses:\s+([\d,]+)",
}


def simulate(
    flags: tuple[str, ...], points: Path, q: Vertex, folder: Path
) -> dict[str, dict[str, int]]:
    """Simulate Algorithm 2 with each procedure, less the cost of reading and lifting."""
    program = folder / "simulated"
    refusal = build(program, flags)
    if refusal:
        raise SystemExit(refusal)
    idle = events(command_of(program, points, q, 0))
    found = {name: events(command_of(program, points, q, 1, name)) for name in PROCEDURES}
    return {
        name: {key: value - idle[key] for key, value in counted.items()}
        for name, counted in found.items()
    }


def events(command: list[str]) -> dict[str, int]:
    """Run a command under cachegrind and parse the event counts."""
    try:
        done = subprocess.run([*TOOL, *command], capture_output=True, text=True, check=True)
    except FileNotFoundError as error:
        raise SystemExit("valgrind is missing: install it (Debian: valgrind)") from error
    matches = {key: re.search(pattern, done.stderr) for key, pattern in PATTERNS.items()}
    return {key: int(found[1].replace(",", "")) for key, found in matches.items() if found}
