"""Description of the machine of an experiment: processor and versions, without the host's name."""

from __future__ import annotations

import hashlib
import os
import platform
from importlib.metadata import version
from pathlib import Path

import numpy as np

from liftmesh import _kernel

_PROCESSORS = Path("/proc/cpuinfo")


def describe_machine() -> str:
    """Describe this machine."""
    count = os.cpu_count() or 1
    words = [_processor(), f"{count} processor" + ("s" if count > 1 else ""), _memory()]
    return ", ".join([*filter(None, words), f"{platform.system()} {platform.machine()}"])


def versions() -> dict[str, str]:
    """Return the versions of the software that measurements depend on."""
    kernel = Path(str(_kernel.__file__)).read_bytes()
    return {
        "liftmesh": version("liftmesh"),
        "kernel": hashlib.sha256(kernel).hexdigest()[:12],
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def _processor() -> str:
    """Return the processor's name from Linux, or from Python on other systems."""
    if _PROCESSORS.is_file():  # pragma: no branch - Linux
        lines = _PROCESSORS.read_text("utf-8", errors="replace").splitlines()
        for line in lines:  # pragma: no branch - one of them names it
            name, _, value = line.partition(":")
            if name.strip() == "model name":  # pragma: no branch - a line of Linux
                return " ".join(value.split())
    return platform.processor()  # pragma: no cover - not Linux


def _memory() -> str:
    if "SC_PHYS_PAGES" not in getattr(os, "sysconf_names", {}):
        return ""  # pragma: no cover - not Linux
    size = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    return f"{size / 2**30:.0f} GiB of memory"
