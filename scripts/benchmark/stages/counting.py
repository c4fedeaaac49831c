"""Run the kernel with the counting pool under callgrind: the lists of tasks, and what each took.

The caller's thread does something alone, then a list of tasks that any thread takes up, then
something alone again, and so on to the end. Callgrind writes a file for each of these.
"""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from benchmark.profile.callgrind import ONLY
from native.build import NATIVE, Program, built

HERE = Path(__file__).resolve().parent
PROGRAM = Program(
    "stages",
    HERE,
    ("-O3",),
    others=(HERE.parent / "profile" / "driver.cpp",),
    compiler=NATIVE,
    remedy="install g++, or name a compiler in CXX",
)
TOOL = ("valgrind", "--tool=callgrind", "--quiet", ONLY)
TRIGGER = re.compile(r"^desc: Trigger: Client Request: (?:alone|\d+ (.*))$", re.MULTILINE)
TOTAL = re.compile(r"^totals: (\d+)$", re.MULTILINE)


@dataclass
class Step:
    """What the caller's thread does alone, then a list of tasks: the name of its function."""

    alone: int
    work: str = ""
    tasks: list[int] = field(default_factory=list)


def steps_of(points: Path, threads: int, folder: Path) -> list[Step]:
    """Count the steps of one run, as many threads would share it."""
    out = folder / f"stages-{threads}"
    command = [*TOOL, f"--callgrind-out-file={out}", str(built(PROGRAM)), str(points), str(threads)]
    try:
        subprocess.run(command, check=True)
    except FileNotFoundError as error:
        raise SystemExit("valgrind is missing: install it (Debian: valgrind)") from error
    parts = folder.glob(f"{out.name}.*")
    ordered = sorted(parts, key=lambda path: int(path.suffix[1:]))
    return steps([path.read_text() for path in [*ordered, out]])


def steps(parts: list[str]) -> list[Step]:
    """Put the files together, in the order in which they were written."""
    found = [Step(0)]
    for part in parts:
        count = TOTAL.search(part)
        instructions = int(count[1]) if count else 0
        trigger = TRIGGER.search(part)
        if trigger and trigger[1]:
            found[-1].work = trigger[1]
            found[-1].tasks.append(instructions)
            continue
        found = found if found == [Step(0)] else [*found, Step(0)]
        found[-1].alone = instructions
    return found
