"""Python in a process of its own, for libraries that print, end the process or hear no Ctrl-C."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from liftmesh.errors import LiftmeshError


def command(program: str, job: str) -> list[str]:
    """Return the words that run a program in an interpreter with the modules of this one."""
    return [_interpreter(job), "-I", "-S", "-c", program, json.dumps(sys.path)]


def _interpreter(job: str) -> str:
    """Return the Python to run: in programs that embed it, sys.executable is the program."""
    places = [
        sys.executable, getattr(sys, "_base_executable", None),
        *(str(Path(sys.prefix, *each)) for each in (("bin", "python3"), ("python.exe",))),
        *(str(Path(sys.base_prefix, *each)) for each in (("bin", "python3"), ("python.exe",))),
    ]  # fmt: skip
    for each in filter(None, places):
        if Path(each).name.lower().startswith(("python", "pypy")) and Path(each).is_file():
            return str(each)
    raise LiftmeshError(
        f"{job} needs a Python interpreter, and none is found beside {sys.executable}: use the "
        "liftmesh command"
    )
