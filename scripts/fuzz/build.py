"""Build a program from the kernel's sources and a few of its own, with clang and a sanitizer.

Programs are cached under a fingerprint of sources, flags and compiler, so that a second run starts
at once. Several processes may ask for a program at the same time: one builds it, the others wait.
`scripts/sanitize` builds its driver here too.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KERNEL = ROOT / "liftmesh" / "_core"
OUT = ROOT / "out" / "fuzz"

PRECOMPILED = HERE / "precompiled.hpp"
COMMON = ("-std=c++20", "-O1", "-ffp-contract=off", "-fno-omit-frame-pointer", "-gline-tables-only")
COMPILER = os.environ.get("CLANG", "clang++")
MISSING = f"{COMPILER} is missing or lacks its sanitizers: scripts/setup.sh names the packages"
KEPT = 3  # programs of one name: an old one may still be running


@dataclass(frozen=True)
class Program:
    """A program: the folder of its own sources, and its compiler and linker flags."""

    name: str
    folder: Path
    flags: tuple[str, ...]
    kernel_flags: tuple[str, ...] = ()
    link_flags: tuple[str, ...] = ()

    def compiled_with(self, source: Path) -> list[str]:
        """Return the command that compiles a source, without the names of files."""
        own = self.kernel_flags if source.is_relative_to(KERNEL) else ()
        return [COMPILER, *COMMON, *self.flags, *own, f"-I{KERNEL}", f"-I{self.folder}"]


CHECKED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
COUNTED = "-fsanitize-coverage=inline-8bit-counters,pc-table"

FUZZ_TARGET = Program("kernel", HERE / "kernel", CHECKED, (COUNTED,), ("-fsanitize=fuzzer",))


def built(program: Program) -> Path:
    """Return the path of a program; build it first if it is not cached."""
    folder = OUT / "programs"
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / f"{program.name}-{fingerprint(program)}"
    with locked(folder / f"{program.name}.lock"):
        if not target.exists():
            with tempfile.TemporaryDirectory(dir=folder) as name:
                _build(program, Path(name)).replace(target)
            _forget_old(program, folder)
    return target


def fingerprint(program: Program) -> str:
    """Hash everything that a program is built from."""
    digest = hashlib.sha256(repr(program).encode())
    digest.update(run([COMPILER, "--version"]).encode())
    for folder in (KERNEL, program.folder):
        for path in sorted([*folder.rglob("*.cpp"), *folder.rglob("*.hpp")]):
            digest.update(path.relative_to(ROOT).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock between processes, which the system releases if its holder dies."""
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def run(command: list[str]) -> str:
    """Run the compiler; return its output."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise SystemExit(MISSING) from error
    if done.returncode:
        lacking = "" if "libclang_rt" not in done.stderr else MISSING + "\n"
        raise SystemExit(lacking + done.stderr)
    return done.stdout


def _build(program: Program, folder: Path) -> Path:
    """Compile all sources but the bindings, and link."""
    kernel = [p for p in sorted(KERNEL.rglob("*.cpp")) if p.parent != KERNEL]
    header = folder / "precompiled.pch"
    command = program.compiled_with(PRECOMPILED)
    run([*command, "-x", "c++-header", str(PRECOMPILED), "-o", str(header)])

    def compiled(source: Path) -> str:
        target = folder / f"{source.parent.name}-{source.stem}.o"
        command = [*program.compiled_with(source), "-include-pch", str(header)]
        run([*command, "-c", str(source), "-o", str(target)])
        return str(target)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(compiled, [*sorted(program.folder.glob("*.cpp")), *kernel]))
    target = folder / program.name
    link = [COMPILER, *program.flags, *program.link_flags, *objects]
    run([*link, "-pthread", "-o", str(target)])
    return target


def _forget_old(program: Program, folder: Path) -> None:
    """Delete all but the last few programs of a name."""
    programs = [p for p in folder.glob(f"{program.name}-*") if p.is_file()]
    for path in sorted(programs, key=lambda p: p.stat().st_mtime)[:-KEPT]:
        path.unlink(missing_ok=True)
