"""A wheel in a fresh environment without a compiler: installed, checked, and used."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from native.build import ROOT
from wheels.building import environment, run

HERE = Path(__file__).resolve().parent
SCRIPTS = HERE.parent


@dataclass(frozen=True)
class Said:
    """What an installed wheel said, in words, and what is wrong with it."""

    told: str
    faults: tuple[str, ...] = ()


def versions(pythons: list[str]) -> dict[str, tuple[int, int]]:
    """Return the versions of interpreters, in ascending order."""
    asked = {name: run(name, "-c", "import sys; print(*sys.version_info[:2])") for name in pythons}
    parsed = {name: (int(a), int(b)) for name, (a, b) in ((n, v.split()) for n, v in asked.items())}
    return dict(sorted(parsed.items(), key=lambda item: item[1]))


def abi3_audited(wheel: Path) -> tuple[str, ...]:
    """Name what a wheel of the stable ABI takes beyond it."""
    if "abi3" not in wheel.name:
        return ()
    asked = [sys.executable, "-m", "abi3audit", "--strict", str(wheel)]
    done = subprocess.run(asked, capture_output=True, text=True, check=False)
    return (f"abi3audit: {done.stdout}{done.stderr}",) if done.returncode else ()


def installed(wheel: Path, python: str, folder: Path) -> Said:
    """Install a wheel without compilers, and check it as the test command does."""
    own = environment(python, folder)
    bare = {"PATH": str(own.parent), "CC": "false", "CXX": "false", "PYTHONDONTWRITEBYTECODE": ""}
    began = time.monotonic()
    run(own, "-m", "pip", "install", "--disable-pip-version-check", "-q", wheel, **bare)
    said = run(own, HERE / "first.py", **bare)
    seconds = time.monotonic() - began
    checker = (SCRIPTS / "check_wheel.py", wheel, ROOT / "data" / "jacksboro.ply")
    with tempfile.TemporaryDirectory() as name:
        checked = subprocess.run(
            [own, *checker], cwd=name, capture_output=True, text=True, check=False
        )
    faults = [f"check_wheel.py: {checked.stdout}{checked.stderr}"] if checked.returncode else []
    told = f"Python {said.strip()}: installed and first triangulated in {seconds:.0f} s"
    return Said(told, tuple(faults))


def emulated(wheel: Path, root: Path, folder: Path, python: str) -> Said:
    """Install a wheel for arm64, and run it by the Python of a root in the emulator."""
    site = folder / "site"
    platforms = [
        f"--platform={tag}_aarch64" for tag in ("manylinux_2_28", "manylinux_2_17", "manylinux2014")
    ]
    version = ".".join(map(str, versions([python])[python]))
    pip = (sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check")
    run(
        *pip,
        "--target",
        site,
        f"--python-version={version}",
        "--only-binary=:all:",
        *platforms,
        wheel,
    )
    there = root / "usr" / "bin" / f"python{version}"
    began = time.monotonic()
    said = run("qemu-aarch64", "-L", root, there, HERE / "first.py", PYTHONPATH=str(site))
    seconds = time.monotonic() - began
    told = f"Python {said.strip()} of Debian in qemu: first triangulations in {seconds:.0f} s"
    return Said(told)
