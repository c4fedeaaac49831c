"""Exact, canonical planar Delaunay triangulation and terrain meshes.

Planar points are lifted to a paraboloid, the lower convex hull of the lifted points is found, and
its projection is the Delaunay triangulation.
"""

# The stub next to this file lists the public names once, for type checkers and for the loader,
# which imports the module of a name on first access.

from __future__ import annotations

from typing import Any

import lazy_loader

from liftmesh.base.interruption import defer_signals

_load, _, __all__ = lazy_loader.attach_stub(__name__, __file__)
__all__ += ["__version__"]
__all__.remove("scipy")  # a star import would hide SciPy itself


def __getattr__(name: str) -> Any:
    """Import a public name on first access."""
    if name not in __all__ and name != "scipy":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name != "__version__":
        with defer_signals():  # NumPy cannot be imported again where Ctrl-C broke its import off
            return _load(name)
    from importlib.metadata import version  # noqa: PLC0415 - slow, and rarely needed

    globals()[name] = version("liftmesh")
    return globals()[name]


def __dir__() -> list[str]:
    return sorted([*__all__, "scipy"])
