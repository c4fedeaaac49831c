"""Build the driver with the kernel's sources, optimised and with debug information."""

from __future__ import annotations

import os
import shlex
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

DRIVER = Path(__file__).parent / "driver.cpp"
KERNEL = Path(__file__).resolve().parents[3] / "liftmesh" / "_core"
FLAGS = ("-std=c++20", "-O3", "-g", "-ffp-contract=off", f"-I{KERNEL}")


def build(folder: Path) -> Path:
    """Compile all sources but the bindings, and link."""
    sources = [p for p in sorted(KERNEL.rglob("*.cpp")) if p.parent != KERNEL]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(lambda source: compiled(source, folder), [DRIVER, *sources]))
    program = folder / "driver"
    run([*compiler(), *map(str, objects), "-pthread", "-o", str(program)])
    return program


def compiled(source: Path, folder: Path) -> Path:
    target = folder / f"{source.parent.name}-{source.stem}.o"
    run([*compiler(), *FLAGS, "-c", str(source), "-o", str(target)])
    return target


def compiler() -> list[str]:
    """Return the C++ compiler's command: CXX from the environment, or c++."""
    return shlex.split(os.environ.get("CXX", "c++"))


def run(command: list[str]) -> None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise SystemExit(f"{command[0]} is missing: install g++, or name one in CXX") from error
    if done.returncode:
        raise SystemExit(done.stderr)
