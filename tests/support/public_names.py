"""What liftmesh makes public: its names and the methods of its classes."""

from __future__ import annotations

import builtins
import inspect
from collections.abc import Iterator

import liftmesh
import liftmesh.dask
from liftmesh import errors

EXCEPTIONS = {
    name
    for name, value in [*vars(errors).items(), *vars(builtins).items()]
    if isinstance(value, type) and issubclass(value, BaseException)
}


def public_names() -> Iterator[tuple[str, object]]:
    for name in liftmesh.__all__:
        if name not in EXCEPTIONS and name != "__version__":
            yield name, getattr(liftmesh, name)
    for name in liftmesh.scipy.__all__:
        yield f"scipy.{name}", getattr(liftmesh.scipy, name)
    for name in liftmesh.dask.__all__:
        yield f"dask.{name}", getattr(liftmesh.dask, name)


def public_methods() -> Iterator[tuple[str, object]]:
    for name, value in public_names():
        if inspect.isclass(value):
            for key, member in own_members(value).items():
                if inspect.isfunction(member) and not key.startswith("_"):
                    yield f"{name}.{key}", member


def own_members(kind: type) -> dict[str, object]:
    """Members of a class and of those private bases that its methods are divided among."""
    public = {getattr(liftmesh, name) for name in liftmesh.__all__}
    inherited = {each for base in kind.__mro__[1:] if base in public for each in base.__mro__}
    bases = [
        base
        for base in kind.__mro__[1:]
        if base.__module__.startswith("liftmesh.") and base not in inherited
    ]
    return {k: v for each in (*bases, kind) for k, v in vars(each).items()}


NAMES = dict(public_names())


METHODS = dict(public_methods())
