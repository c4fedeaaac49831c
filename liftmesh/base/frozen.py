"""Immutable results: read-only arrays and dictionaries, also in copies and pickles.

`copy` and `pickle` make writable arrays of read-only ones. A result is therefore copied and pickled
through its constructor, which makes them read-only again.

Properties that are computed when first asked for have no lock here. In Python 3.10 and 3.11
`functools.cached_property` holds one for all instances of a class: two threads cannot compute a
property of two triangulations at a time, and a process that is forked meanwhile finds it held for
ever. From 3.12 on it has none, but of threads that compute one value at once the last one replaces
it, which the compiled code of SciPy's interpolators may be reading.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import numpy as np

from liftmesh._typing import Integers, Rows
from liftmesh.base.arrays import read_only
from liftmesh.base.display import card_of
from liftmesh.errors import InputError

Key = TypeVar("Key")
Value = TypeVar("Value")


class FrozenResult:
    """Base of frozen dataclasses that are read-only throughout, also in copies and pickles."""

    __slots__ = ()
    _repr_html_ = card_of

    def __post_init__(self) -> None:
        freeze(self)

    def __reduce__(self) -> tuple[Any, ...]:
        result: Any = self
        return _loaded, (type(self), *(getattr(self, each.name) for each in fields(result)))

    def _check_copy(self) -> None:
        """Refuse a damaged pickle, whose numbers lead out of its arrays."""


def freeze(result: Any) -> None:
    """Make all arrays and mappings of a frozen dataclass read-only; called when it is made."""
    for each in fields(result):
        value = getattr(result, each.name)
        if isinstance(value, np.ndarray | Mapping):
            object.__setattr__(result, each.name, _frozen(value))


def _frozen(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return read_only(value) if value.flags.writeable else value
    return FrozenDict(
        {key: read_only(v) if isinstance(v, np.ndarray) else v for key, v in value.items()}
    )


class FrozenDict(dict[Key, Value]):
    """A dictionary that cannot be changed, which `dataclasses.asdict`, `json` and `pickle` take."""

    __slots__ = ()

    def _refuse(self, *_args: object, **_named: object) -> NoReturn:
        raise TypeError("this dictionary is read-only: change a copy, dict(...)")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)


def _loaded(kind: type[FrozenResult], *values: Any) -> FrozenResult:
    """Make a result of a pickle."""
    # A `__setstate__` would not do: in Python 3.10, frozen dataclasses with slots replace it.
    result = kind(*values)
    result._check_copy()  # noqa: SLF001 - of this class
    return result


def check_copied(
    rows: int, simplices: Rows, neighbors: Rows, *others: Rows, corners: int = 3
) -> None:
    """Refuse a damaged pickle of triangles, whose numbers the kernel would follow anywhere."""
    check_numbers(0, rows, simplices)
    check_numbers(-1, len(simplices), neighbors)
    check_numbers(0, rows, *others)
    if not simplices.shape == neighbors.shape == (len(simplices), corners):
        raise InputError(
            f"the copy is damaged: simplices are {simplices.shape} and neighbors "
            f"{neighbors.shape}; compute it again"
        )


def check_numbers(least: int, beyond: int, *arrays: Rows) -> None:
    """Refuse a damaged pickle with a number that is less, or not below the end."""
    for array in arrays:
        if array.size and not least <= array.min() <= array.max() < beyond:
            wrong = array[(array < least) | (array >= beyond)][0]
            raise InputError(
                f"the copy is damaged: it has the number {wrong} where {least} to {beyond - 1} "
                "are possible; compute it again"
            )


def check_adjacent(simplices: Rows, neighbors: Rows) -> None:
    """Refuse a damaged pickle of triangles whose neighbours do not share their sides with them."""
    triangles = np.arange(len(simplices))
    for k in range(3):
        inside = neighbors[:, k] >= 0
        other, across = neighbors[inside, k], triangles[inside]
        tail, head = (simplices[inside, (k + step) % 3] for step in (1, 2))
        shared = np.zeros(len(other), np.bool_)
        for j in range(3):
            is_side = simplices[other, (j + 1) % 3] == head
            is_side &= simplices[other, (j + 2) % 3] == tail
            shared |= is_side & (neighbors[other, j] == across)
        if not shared.all():
            raise InputError(
                f"the copy is damaged: triangle {across[shared.argmin()]} and its neighbor "
                f"{other[shared.argmin()]} share no side; compute it again"
            )


def check_starts(starts: Rows | Integers, groups: int, items: int) -> None:
    """Refuse a damaged pickle whose starts do not divide the items into so many groups."""
    is_whole = starts.shape == (groups + 1,) and starts[0] == 0 and starts[-1] == items
    if not is_whole or (starts[1:] < starts[:-1]).any():
        raise InputError(
            f"the copy is damaged: its starts do not divide {items:,} items into {groups:,} "
            "groups; compute it again"
        )


__all__ = ["cached_property"]

if TYPE_CHECKING:
    from functools import cached_property
else:
    T = TypeVar("T")

    class cached_property(functools.cached_property[T]):  # noqa: N801 - as the one it stands for
        """`functools.cached_property` without a lock, whose value stays once it is there."""

        def __get__(self, instance: Any, owner: type[Any] | None = None) -> Any:
            if instance is None:
                return self
            if getattr(type(instance), self.attrname) is not self:  # asked for by super()
                return self.func(instance)
            computed = instance.__dict__
            if self.attrname in computed:
                return computed[self.attrname]
            return computed.setdefault(self.attrname, self.func(instance))
