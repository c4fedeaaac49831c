"""Optional packages, imported on first use, and Python code run in a separate process.

A package that is missing is named with a hint how to install it. Libraries that print, exit or
ignore Ctrl-C run in a separate process.
"""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from typing import Any

from liftmesh.base.interruption import defer_signals
from liftmesh.errors import LiftmeshError, MissingDependencyError

_HINTS = {
    "libusb": "install the system library libusb-1.0 (Debian, Ubuntu: libusb-1.0-0)",
    "libGL": "install the system library libGL (Debian, Ubuntu: libgl1)",
    "libgomp": "install the system library libgomp (Debian, Ubuntu: libgomp1)",
    "libX11": "install the system library libX11 (Debian, Ubuntu: libx11-6)",
}


def load(module: str, *, extra: str | None = None) -> Any:
    """Import an optional module, or say what to install."""
    try:
        with defer_signals():
            return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise MissingDependencyError(_explain(package, extra, error)) from error


def _explain(package: str, extra: str | None, error: ImportError) -> str:
    for library, remedy in _HINTS.items():
        if library in str(error):
            return f"{package} is installed but cannot be loaded ({error}): {remedy}"
    target = f"liftmesh[{extra}]" if extra else package
    return f"this needs {package}, which cannot be imported ({error}): pip install '{target}'"


def python_command(program: str, job: str) -> list[str]:
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
