"""``liftmesh doctor``: what is installed here, for reports of bugs.

It runs without click: that it is missing may be what the report is about.
"""

from __future__ import annotations

import os
import platform
import re
from importlib import import_module

import liftmesh
from liftmesh.base.options import VARIABLE, cores
from liftmesh.cli import options, terminal

SHORT_HELP = "Say what is installed, for reports of bugs."
HELP = (
    "Prints the versions of liftmesh, Python, NumPy and the packages of each extra, what compiled "
    "the kernel, for which instructions of the processor, and the number of threads. It works in "
    "the base install, and reads no file."
)
EXAMPLES = ["liftmesh doctor > report.txt", "liftmesh doctor --json"]


def run(*, json: options.Json = False) -> None:
    """Print what is found."""
    found = findings()
    if json:
        terminal.as_json(found)
    else:
        terminal.table([*found.items()])


def findings() -> dict[str, str]:
    """Return what a report of a bug has to say of this installation."""
    python = f"{platform.python_version()} ({platform.python_implementation()})"
    asked = os.environ.get(VARIABLE)
    return {
        "liftmesh": liftmesh.__version__,
        "kernel": _kernel(),
        "Python": python,
        "system": f"{platform.platform()}, {platform.machine()}",
        "numpy": _numpy(),
        "threads": f"{cores()}{f', {VARIABLE}={asked}' if asked else ''}",
        **{f"[{extra}]": _versions(extra) for extra in _extras("all")},
    }


def _kernel() -> str:
    """Return what the compiled kernel says of itself, or why it does not."""
    try:
        kernel = import_module("liftmesh._kernel")
    except ImportError as error:
        return f"cannot be imported: {error}"
    compiler, machine = (getattr(kernel, name, "unknown") for name in ("COMPILER", "INSTRUCTIONS"))
    other = "" if liftmesh.__version__ == kernel.VERSION else " (of another version than the rest)"
    return f"{kernel.VERSION}{other}, by {compiler}, for {machine}"


def _numpy() -> str:
    """Return the version of NumPy, or why it cannot be imported."""
    try:
        return str(import_module("numpy").__version__)
    except ImportError as error:
        return f"cannot be imported: {error}"


def _extras(extra: str) -> list[str]:
    """Return the extras of liftmesh that an extra consists of."""
    named = [found for each in _needed(extra) if (found := re.match(r"liftmesh\[(.+?)\]", each))]
    return [name for each in named for name in each[1].split(",")]


def _needed(extra: str) -> list[str]:
    """Return the requirements of an extra, as the metadata of the installed package has them."""
    from importlib.metadata import PackageNotFoundError, requires

    of_it = re.compile(rf"extra == ['\"]{extra}['\"]")
    try:
        return [each for each in requires("liftmesh") or () if of_it.search(each)]
    except PackageNotFoundError:  # sources that were never installed
        return []


def _packages(extra: str) -> list[str]:
    """Return the names of the packages of an extra, with those of the extras in it."""
    own = [name for each in _needed(extra) if (name := re.split(r"[^\w.-]", each)[0]) != "liftmesh"]
    return [*own, *(name for other in _extras(extra) for name in _packages(other))]


def _versions(extra: str) -> str:
    """Return the versions of the packages of an extra, and how to install those that lack."""
    found = {name: _version(name) for name in _packages(extra)}
    told = ", ".join(f"{name} {each}" if each else f"no {name}" for name, each in found.items())
    return told if all(found.values()) else f"{told}: pip install 'liftmesh[{extra}]'"


def _version(package: str) -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return ""
