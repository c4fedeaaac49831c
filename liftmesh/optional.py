"""Optional packages: imported on first use, with a hint how to install a missing one."""

from __future__ import annotations

import importlib
from typing import Any

from liftmesh.base.interruption import defer_signals
from liftmesh.errors import MissingDependencyError

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
