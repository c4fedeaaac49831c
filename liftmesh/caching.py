"""Properties that are computed when first asked for, without a lock.

In Python 3.10 and 3.11 `functools.cached_property` holds one lock for all instances of a class: two
threads cannot compute a property of two triangulations at a time, and a process that is forked
meanwhile finds it held for ever. From 3.12 on there is no lock, and this module is that property.
"""

from __future__ import annotations

import functools
import sys
from typing import TYPE_CHECKING, Any, TypeVar

__all__ = ["cached_property"]

if TYPE_CHECKING or sys.version_info >= (3, 12):
    from functools import cached_property
else:
    T = TypeVar("T")

    class cached_property(functools.cached_property[T]):  # noqa: N801 - as the one it stands for
        """`functools.cached_property` without its lock."""

        def __get__(self, instance: Any, owner: type[Any] | None = None) -> Any:
            if instance is None:
                return self
            name: Any = self.attrname
            computed = instance.__dict__
            if name not in computed:
                computed[name] = self.func(instance)
            return computed[name]
