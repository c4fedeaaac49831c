"""Programs made of the kernel's own sources and a few of their own, by clang with a sanitizer.

What was built is kept under a fingerprint of the sources, the flags and the compiler, so that a
second call starts at once. Several processes may ask for one program at the same time: one builds
it, the others wait.
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

STANDARD = HERE / "standard.hpp"
COMMON = ("-std=c++20", "-O1", "-ffp-contract=off", "-fno-omit-frame-pointer", "-gline-tables-only")
COMPILER = os.environ.get("CLANG", "clang++")
MISSING = f"{COMPILER} is missing or lacks its sanitizers: scripts/setup.sh tells the packages"
KEPT = 3  # of the programs of one name: one may be running


@dataclass(frozen=True)
class Program:
    """A program: its own sources, and flags for all sources, for the kernel's and for linking."""

    name: str
    folder: Path
    flags: tuple[str, ...]
    kernel_flags: tuple[str, ...] = ()
    link_flags: tuple[str, ...] = ()

    def compiled_with(self, source: Path) -> list[str]:
        """Give the command that compiles a source, up to the files' names."""
        own = self.kernel_flags if source.is_relative_to(KERNEL) else ()
        return [COMPILER, *COMMON, *self.flags, *own, f"-I{KERNEL}", f"-I{self.folder}"]


CHECKED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
COUNTED = "-fsanitize-coverage=inline-8bit-counters,pc-table"

FUZZ_TARGET = Program("kernel", HERE / "kernel", CHECKED, (COUNTED,), ("-fsanitize=fuzzer",))


def built(program: Program) -> Path:
    """Return the program, built unless it is there."""
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
    """Sum up all that a program is made of."""
    digest = hashlib.sha256(repr(program).encode())
    digest.update(run([COMPILER, "--version"]).encode())
    for folder in (KERNEL, program.folder):
        for path in sorted([*folder.rglob("*.cpp"), *folder.rglob("*.hpp")]):
            digest.update(path.relative_to(ROOT).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock between processes; the system gives it back if one of them dies."""
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def run(command: list[str]) -> str:
    """Run the compiler; give what it prints."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise SystemExit(MISSING) from error
    if done.returncode:
        lacking = "" if "libclang_rt" not in done.stderr else MISSING + "\n"
        raise SystemExit(lacking + done.stderr)
    return done.stdout


def _build(program: Program, folder: Path) -> Path:
    """Compile all but the bindings, and link."""
    kernel = [p for p in sorted(KERNEL.rglob("*.cpp")) if p.name != "bindings.cpp"]
    header = folder / "standard.pch"
    command = program.compiled_with(STANDARD)
    run([*command, "-x", "c++-header", str(STANDARD), "-o", str(header)])

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
