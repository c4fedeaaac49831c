"""Build a program from the kernel's sources and a few of its own, by any compiler.

Programs are cached under a fingerprint of sources, flags and compiler, so that a second run starts
at once. Several processes may ask for a program at the same time: one builds it, the others wait.
The fuzz target, the sanitizers' driver, the profiler's and that of the portability check are built
here.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KERNEL = ROOT / "liftmesh" / "_core"
PROGRAMS = ROOT / "out" / "programs"

PRECOMPILED = HERE / "precompiled.hpp"
ALWAYS = ("-std=c++20", "-ffp-contract=off")
TRACED = ("-O1", "-fno-omit-frame-pointer", "-gline-tables-only")
CHECKED = (*TRACED, "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
CLANG = (os.environ.get("CLANG", "clang++"),)
NATIVE = tuple(shlex.split(os.environ.get("CXX", "c++")))
SANITIZERS = "scripts/setup.sh names the packages of clang and its sanitizers"
ZIG = "pip install ziglang: a clang with the libraries of many systems"
KEPT = 3  # programs of one name: an old one may still be running


def zig(target: str) -> tuple[str, ...]:
    """Return the compiler for another system, as "aarch64-linux-musl"."""
    return (sys.executable, "-m", "ziglang", "c++", "-target", target)


@dataclass(frozen=True)
class Program:
    """A program: the folder of its own sources, its compiler, and flags.

    `others` are sources from other folders. A source of its own takes the place of the kernel's of
    the same name. `remedy` is what to do where the compiler is missing. With `by_room` all sources
    of a room of the kernel are compiled at once, as for the wheel.
    """

    name: str
    folder: Path
    flags: tuple[str, ...]
    kernel_flags: tuple[str, ...] = ()
    link_flags: tuple[str, ...] = ()
    others: tuple[Path, ...] = ()
    compiler: tuple[str, ...] = CLANG
    remedy: str = SANITIZERS
    by_room: bool = False

    def compiled_with(self, source: Path) -> list[str]:
        """Return the command that compiles a source, without the names of files."""
        own = self.kernel_flags if source.is_relative_to(KERNEL) else ()
        folders = [f"-I{folder}" for folder in (KERNEL, HERE, self.folder)]
        return [*self.compiler, *ALWAYS, *self.flags, *own, *folders]

    @property
    def is_clangs(self) -> bool:
        """Whether clang compiles it, whose precompiled headers are files of any name."""
        return "clang" in Path(self.compiler[0]).name

    def sources(self) -> list[Path]:
        """List its own sources, and the kernel's but for its interfaces."""
        own = [*sorted(self.folder.glob("*.cpp")), *self.others]
        replaced = {source.name for source in own}
        rooms = [p for p in sorted(KERNEL.iterdir()) if p.name not in {"bindings", "library"}]
        kernel = [source for room in rooms for source in sorted(room.glob("*.cpp"))]
        return [*own, *(p for p in kernel if p.name not in replaced)]


def built(program: Program) -> Path:
    """Return the path of a program; build it first if it is not cached."""
    folder = PROGRAMS
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / f"{program.name}-{fingerprint(program)}"
    with locked(folder / f"{program.name}.lock"):
        if not target.exists():
            with tempfile.TemporaryDirectory(dir=folder) as name:
                _build(program, Path(name)).replace(target)
            _forget_old(program, folder)
    return target


def fingerprint(program: Program) -> str:
    """Hash everything that a program is built from, headers of several folders among it."""
    digest = hashlib.sha256(repr(program).encode())
    digest.update(run([*program.compiler, "--version"], program.remedy).encode())
    files = set(program.sources())
    for folder in (KERNEL, HERE, program.folder):
        files.update(folder.rglob("*.hpp"))
    for path in sorted(files):
        digest.update(path.relative_to(ROOT).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()[:16]


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock between processes, which the system releases if its holder dies."""
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def run(command: list[str], remedy: str) -> str:
    """Run a compiler; return its output."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise SystemExit(f"{command[0]} is missing: {remedy}") from error
    if done.returncode:
        lacking = f"{remedy}\n" if "libclang_rt" in done.stderr else ""
        raise SystemExit(lacking + done.stderr)
    return done.stdout


def _build(program: Program, folder: Path) -> Path:
    """Compile all sources but the bindings, and link."""
    header = _precompiled(program, folder) if program.is_clangs else []

    def compiled(source: Path) -> str:
        target = folder / f"{source.parent.name}-{source.stem}.o"
        command = [*program.compiled_with(source), *header, "-c", str(source), "-o", str(target)]
        run(command, program.remedy)
        return str(target)

    sources = _united(program, folder) if program.by_room else program.sources()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(compiled, sources))
    target = folder / program.name
    link = [*program.compiler, *program.flags, *program.link_flags, *objects]
    run([*link, "-pthread", "-o", str(target)], program.remedy)
    return target


def _united(program: Program, folder: Path) -> list[Path]:
    """Write a source for each room of the kernel, which includes all of the room's."""
    rooms: dict[str, list[Path]] = {}
    alone = []
    for source in program.sources():
        if source.is_relative_to(KERNEL) and source.stem != "platform":
            rooms.setdefault(source.parent.name, []).append(source)
        else:
            alone.append(source)
    for room, sources in rooms.items():
        alone.append(folder / f"{room}.cpp")
        alone[-1].write_text("".join(f'#include "{source}"\n' for source in sources))
    return alone


def _precompiled(program: Program, folder: Path) -> list[str]:
    header = str(folder / "precompiled.pch")
    command = [*program.compiled_with(PRECOMPILED), "-x", "c++-header", str(PRECOMPILED)]
    run([*command, "-o", header], program.remedy)
    return ["-include-pch", header]


def _forget_old(program: Program, folder: Path) -> None:
    """Delete all but the last few programs of a name."""
    digest = "[0-9a-f]" * 16  # the name of another program may begin with this one's
    programs = [p for p in folder.glob(f"{program.name}-{digest}") if p.is_file()]
    for path in sorted(programs, key=lambda p: p.stat().st_mtime)[:-KEPT]:
        path.unlink(missing_ok=True)
