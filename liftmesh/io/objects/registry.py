"""Which adapter turns an object into a cloud: the built-in ones, then those of other packages.

Another package adds a cloud type by an entry point in the group ``liftmesh.adapters`` that names an
`Adapter`. The built-in adapters are asked first, then the others in the order of their entry
points' names; the first that accepts an object converts it. An adapter that cannot be loaded harms
nobody whose objects another one accepts: it is named when none does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from liftmesh.errors import UnsupportedTypeError
from liftmesh.io.objects import open3d, trimesh

if TYPE_CHECKING:
    from collections.abc import Callable, Collection
    from importlib.metadata import EntryPoint

    from liftmesh.cloud import Cloud

GROUP = "liftmesh.adapters"


@dataclass(frozen=True, slots=True)
class Adapter:
    """How one kind of object becomes a cloud.

    Parameters
    ----------
    name : str
        What the adapter is called in messages.
    accepts : callable
        Whether an object is of this kind. It is asked about objects of every kind, so it answers
        from the type alone and imports no library.
    to_cloud : callable
        Turns an accepted object into a `Cloud`, one row a point, in the object's own order.

    Examples
    --------
    >>> import numpy as np
    >>> from liftmesh import Cloud
    >>> adapter = Adapter(
    ...     name="complex plane",
    ...     accepts=lambda source: isinstance(source, complex),
    ...     to_cloud=lambda source: Cloud(np.array([[source.real, source.imag, 0.0]])),
    ... )
    >>> adapter.accepts(1 + 2j), adapter.to_cloud(1 + 2j).points.tolist()
    (True, [[1.0, 2.0, 0.0]])
    """

    name: str
    accepts: Callable[[Any], bool]
    to_cloud: Callable[[Any], Cloud]


def find_adapter(source: object) -> Adapter | None:
    """Find the first adapter that accepts an object.

    Parameters
    ----------
    source : object
        Anything.

    Returns
    -------
    Adapter or None
        None where no adapter accepts it.

    Examples
    --------
    >>> import trimesh
    >>> find_adapter(trimesh.creation.box()).name
    'trimesh'
    """
    for adapter in BUILT_IN:
        if adapter.accepts(source):
            return adapter
    installed, _ = _installed()
    return next((adapter for adapter in installed if adapter.accepts(source)), None)


def unsupported(source: object) -> UnsupportedTypeError:
    """Make the error for an object that no adapter accepts.

    Parameters
    ----------
    source : object
        What was given.

    Returns
    -------
    UnsupportedTypeError
        Its message names the type, what would do, and adapters that cannot be loaded.

    Examples
    --------
    >>> str(unsupported(None)).partition(":")[0]
    'a builtins.NoneType is no point cloud'
    """
    message = (
        f"a {qualified_name(source)} is no point cloud: give an array of shape (n, 2) or (n, 3), "
        "a trimesh or Open3D point cloud or mesh, or a path"
    )
    _, broken = _installed()
    if broken:
        message += f"; adapters that cannot be loaded: {'; '.join(broken)}"
    return UnsupportedTypeError(message)


def qualified_name(source: object) -> str:
    """Name the type of an object in full.

    Parameters
    ----------
    source : object
        Anything.

    Returns
    -------
    str
        Module and name, as a message shows it.

    Examples
    --------
    >>> from fractions import Fraction
    >>> qualified_name(Fraction(1, 2))
    'fractions.Fraction'
    """
    kind = type(source)
    return f"{kind.__module__}.{kind.__qualname__}"


def _is_of(package: str, names: Collection[str]) -> Callable[[object], bool]:
    """Make a test for objects of some classes of a package, derived or not, without import."""

    def accepts(source: object) -> bool:
        return any(
            kind.__name__ in names and kind.__module__.partition(".")[0] == package
            for kind in type(source).__mro__
        )

    return accepts


BUILT_IN = (
    Adapter("trimesh", _is_of("trimesh", {"PointCloud", "Trimesh"}), trimesh.to_cloud),
    Adapter("open3d", _is_of("open3d", {"PointCloud", "TriangleMesh", "Tensor"}), open3d.to_cloud),
)


@lru_cache(maxsize=1)
def _installed() -> tuple[tuple[Adapter, ...], tuple[str, ...]]:
    """Load the adapters of other packages, and say what is wrong with those that fail."""
    from importlib.metadata import entry_points  # noqa: PLC0415 - slow, and seldom needed

    loaded = [_load(entry) for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name)]
    good = tuple(item for item in loaded if isinstance(item, Adapter))
    return good, tuple(item for item in loaded if isinstance(item, str))


def _load(entry: EntryPoint) -> Adapter | str:
    """Load the adapter that an entry point names, or give the reason why there is none."""
    try:
        adapter = entry.load()
    except Exception as error:  # noqa: BLE001 - another package's import may raise anything
        return f"{entry.name} ({entry.value}): {type(error).__name__}: {error}"
    if isinstance(adapter, Adapter):
        return adapter
    return f"{entry.name} ({entry.value}) is a {qualified_name(adapter)}, not an Adapter"
