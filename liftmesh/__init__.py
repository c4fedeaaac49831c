"""Exact, canonical planar Delaunay triangulation and terrain meshes.

Planar points are lifted to a paraboloid, the lower convex hull of the lifted points is found, and
its projection is the Delaunay triangulation.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liftmesh.adapters import Adapter as Adapter, as_cloud as as_cloud
    from liftmesh.certificate import (
        Certificate as Certificate,
        Flaw as Flaw,
        Offender as Offender,
    )
    from liftmesh.cloud import Cloud as Cloud
    from liftmesh.comparison import Comparison as Comparison, compare as compare
    from liftmesh.counters import Counters as Counters
    from liftmesh.errors import (
        DegenerateInputError as DegenerateInputError,
        DuplicateHeightError as DuplicateHeightError,
        FormatError as FormatError,
        InputError as InputError,
        LiftmeshError as LiftmeshError,
        MissingDependencyError as MissingDependencyError,
        NonFiniteError as NonFiniteError,
        UnsupportedTypeError as UnsupportedTypeError,
    )
    from liftmesh.formats import Format as Format, Written as Written, read as read, write as write
    from liftmesh.hulls import (
        Delaunay as Delaunay,
        delaunay as delaunay,
        lower_hull as lower_hull,
    )
    from liftmesh.lifting import LowerHull as LowerHull, lift as lift, project as project
    from liftmesh.meshing import triangulate as triangulate
    from liftmesh.plane import Frame as Frame
    from liftmesh.predicates import incircle as incircle, orient2d as orient2d
    from liftmesh.surface import Report as Report, Surface as Surface
    from liftmesh.triangulation import Triangulation as Triangulation
    from liftmesh.verification import verify as verify

    __version__: str

_HOMES = {
    "adapters": ("Adapter", "as_cloud"),
    "certificate": ("Certificate", "Flaw", "Offender"),
    "cloud": ("Cloud",),
    "comparison": ("Comparison", "compare"),
    "counters": ("Counters",),
    "errors": (
        "DegenerateInputError",
        "DuplicateHeightError",
        "FormatError",
        "InputError",
        "LiftmeshError",
        "MissingDependencyError",
        "NonFiniteError",
        "UnsupportedTypeError",
    ),
    "formats": ("Format", "Written", "read", "write"),
    "hulls": ("Delaunay", "delaunay", "lower_hull"),
    "lifting": ("LowerHull", "lift", "project"),
    "meshing": ("triangulate",),
    "plane": ("Frame",),
    "predicates": ("incircle", "orient2d"),
    "surface": ("Report", "Surface"),
    "triangulation": ("Triangulation",),
    "verification": ("verify",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [  # noqa: PLE0604 - the names are those of the table above
    *_HOME_OF,
    "__version__",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name == "__version__":
        value: Any = importlib.import_module("importlib.metadata").version("liftmesh")
    elif name in _HOME_OF:
        value = getattr(importlib.import_module(f"liftmesh.{_HOME_OF[name]}"), name)
    else:
        raise AttributeError(f"module 'liftmesh' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
