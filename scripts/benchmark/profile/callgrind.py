"""Run a program under callgrind, and parse the costs of functions by source file.

Callgrind writes a list of cost lines. Lines that begin with fl=, fi= or fe= name the source file of
the following costs, also that of inlined code; fn= names the function. The line after calls= is the
inclusive cost of a call, which the called function, named by cfi= and cfn=, already accounts for. A
name is spelt out once, as in (3) name, and abbreviated to (3) from then on.
"""

from __future__ import annotations

import re
import subprocess
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

TOOL = ("valgrind", "--tool=callgrind", "--branch-sim=yes", "--quiet")
ONLY = "--toggle-collect=liftmesh::delaunay(*"  # without the program's start
NAME = re.compile(r"(c?)(fl|fi|fe|fn)=\((\d+)\)(?: (.*))?")


@dataclass(frozen=True)
class Cost:
    """Instructions, and branches that the simulated processor mispredicted."""

    instructions: int = 0
    mispredicted: int = 0

    def __add__(self, other: Cost) -> Cost:
        return Cost(self.instructions + other.instructions, self.mispredicted + other.mispredicted)


Place = tuple[str, str]  # a source file and a function


def profile(command: list[str], folder: Path) -> dict[Place, Cost]:
    """Run a command; return the costs by source file and function."""
    out = folder / "callgrind.out"
    tool = [*TOOL, ONLY, f"--callgrind-out-file={out}"]
    try:
        subprocess.run([*tool, *command], check=True)
    except FileNotFoundError as error:
        raise SystemExit("valgrind is missing: install it (Debian: valgrind)") from error
    return costs(out.read_text().splitlines())


def costs(lines: Iterable[str]) -> dict[Place, Cost]:
    found: dict[Place, Cost] = defaultdict(Cost)
    names: dict[tuple[str, str], str] = {}
    events: list[str] = []
    file = function = ""
    inclusive = False
    for line in lines:
        named = NAME.match(line)
        if named:
            called, kind, number, text = named.groups()
            space = "fn" if kind == "fn" else "file"
            name = names.setdefault((space, number), text or "")
            if not called:
                file, function = (file, name) if kind == "fn" else (name, function)
        elif line.startswith("events:"):
            events = line.split()[1:]
        elif line.startswith("calls="):
            inclusive = True
        elif line[:1] in {"+", "-", "*"} or line[:1].isdigit():
            if not inclusive:
                numbers = map(int, line.split()[1:])
                found[file, function] += cost_of(dict(zip(events, numbers, strict=False)))
            inclusive = False
    return dict(found)


def cost_of(events: dict[str, int]) -> Cost:
    """Make a cost of a line's numbers; zeros at the end of a line are omitted."""
    return Cost(events.get("Ir", 0), events.get("Bcm", 0) + events.get("Bim", 0))
