"""Functions that are imported when they are first called.

What is known of a format or of a type of object stands in a table, and its code in a module of its
own: a command that reads a PLY file loads no other reader.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from liftmesh.base.interruption import deferred


class LazyFunction:
    """A function of a module, which is imported at the first call."""

    def __init__(self, module: str, name: str) -> None:
        self.module = module
        self.name = self.__name__ = name
        self._function: Callable[..., Any] | None = None

    def __call__(self, *values: Any, **options: Any) -> Any:
        """Call the function."""
        return self._imported()(*values, **options)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.module, self.name)

    def __eq__(self, other: object) -> bool:
        """Whether the other one stands for the same function."""
        return isinstance(other, LazyFunction) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        """Name the function in full."""
        return f"{self.module}.{self.name}"

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        """The function itself: what `inspect.signature` and `inspect.unwrap` look at."""
        return self._imported()

    def _imported(self) -> Callable[..., Any]:
        if self._function is None:
            with deferred():
                self._function = getattr(import_module(self.module), self.name)
        return self._function
