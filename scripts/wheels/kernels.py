"""The kernel without Python, for every system: built by zig, and run where something here can.

The program is that of `scripts/portability`: the hashes of its results must be those of the build
by this machine's own compiler.
"""

from __future__ import annotations

import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from native.build import ZIG, Program, built, zig
from portability.__main__ import comparison, run
from portability.builds import GCC, HERE, Build, built_by
from portability.questions import write_files
from portability.results import Results
from wheels.outcome import Outcome

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
ROWS, SETS = 2000, 10  # emulators take their time


@dataclass(frozen=True)
class System:
    """A system that the kernel is built for: zig's name for it, and what runs its programs here."""

    name: str
    target: str
    runner: tuple[str, ...] | None  # None: nothing does
    flags: tuple[str, ...] = ()

    @property
    def build(self) -> Build:
        """Its build of the program."""
        name = f"wheels-{self.target}"
        flags = ("-O3", *WARNINGS, *self.flags)
        program = Program(name, HERE, flags, compiler=zig(self.target), remedy=ZIG, by_room=True)
        return Build(self.name, program, self.runner or ())

    @property
    def runs_here(self) -> bool:
        """Whether this machine can run its programs."""
        return self.runner is not None and all(shutil.which(each) for each in self.runner[:1])


STATIC = ("-static",)
SYSTEMS = (
    System("Linux x86-64, musl", "x86_64-linux-musl", (), STATIC),
    System("Linux aarch64, glibc", "aarch64-linux-gnu.2.28", None),
    System("Linux aarch64, musl", "aarch64-linux-musl", ("qemu-aarch64",), STATIC),
    System("Windows x86-64", "x86_64-windows-gnu", ("wine",)),
    System("macOS arm64", "aarch64-macos.14.0", None),
    System("macOS x86-64", "x86_64-macos.14.0", None),
)


def check_kernel(system: System) -> Outcome:
    """Build the kernel for a system; run it and compare its results, if something here can."""
    build = system.build
    program = built(build.program)
    what = f"kernel, by zig's clang, no warning, {program.stat().st_size / 1e6:.1f} MB"
    if not system.runs_here:
        return Outcome(system.name, what, "not run")
    with tempfile.TemporaryDirectory() as name:
        files = write_files(Path(name), ROWS, SETS)
        expected: Results = {}
        comparison(run([str(built(built_by(GCC, "-O3"))), *map(str, files)]), expected)
        verdict = comparison(run(build.command(program, files)), expected)
    where = " ".join(system.runner or ()) or "here"
    told = f"{len(expected)} hashes of results, {verdict.told}, {where}"
    return Outcome(system.name, what, told, tuple(verdict.faults))
