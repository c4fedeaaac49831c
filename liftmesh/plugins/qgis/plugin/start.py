"""The plugin as QGIS finds it: this file is the ``__init__.py`` of the zip."""

from __future__ import annotations

import platform
import sys
from pathlib import Path
from typing import Any

PACKAGES = Path(__file__).parent / "packages"


def classFactory(iface: Any) -> Any:  # noqa: ARG001 - QGIS calls it so
    """Make the plugin, with the liftmesh of the zip unless QGIS's Python has one."""
    if str(PACKAGES) not in sys.path:
        sys.path.append(str(PACKAGES))  # last, so that it hides nothing
    try:
        from liftmesh import _kernel  # noqa: F401, PLC0415 - found from now on
    except Exception as error:  # older Pythons may not even know its syntax
        made = next((PACKAGES / "liftmesh").glob("_kernel.*.*"), Path("no kernel")).name
        raise ImportError(
            f"this plugin holds {made}, and this QGIS has Python {platform.python_version()} on "
            f"{platform.machine()}: make the zip with such a Python ({error})"
        ) from error
    from .provider import Plugin  # noqa: PLC0415 - needs liftmesh

    return Plugin()
