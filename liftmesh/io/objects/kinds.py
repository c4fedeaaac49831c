"""Which kind of object something is, by the names of its classes: no library is imported."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

import numpy as np

FRAMES = {("pandas", "DataFrame"), ("polars", "DataFrame")}
RECORDS = {("laspy", "LasData"), ("laspy", "ScaleAwarePointRecord")}
_READERS = {("laspy", "LasReader")}


def is_of(package: str, names: Collection[str]) -> Callable[[object], bool]:
    """Make a test for instances of some classes of a package."""
    wanted = {(package, name) for name in names}
    return lambda source: bool(classes(source) & wanted)


def is_table(source: object) -> bool:
    """Whether an object is a table whose columns have names."""
    if isinstance(source, list | tuple):  # of arrays, one for each view of a pipeline of PDAL
        return bool(source) and is_structured(source[0])
    return is_structured(source) or bool(classes(source) & (FRAMES | RECORDS))


def is_other_table(source: object) -> bool:
    """Whether an object looks like a table, but not like one that is read."""
    if isinstance(source, dict | type):
        return False
    kind = type(source)  # whose attributes cost nothing to look up
    named = any(hasattr(kind, name) for name in ("columns", "column_names", "colnames"))
    is_reader = bool(classes(source) & _READERS)
    return is_reader or isinstance(source, Mapping) or (named and hasattr(kind, "__getitem__"))


def is_structured(source: object) -> bool:
    """Whether an object is an array of records."""
    return isinstance(source, np.ndarray) and source.dtype.names is not None


def classes(source: object) -> set[tuple[str, str]]:
    """Name the classes of an object: the package and the class, inherited ones too."""
    return {(kind.__module__.partition(".")[0], kind.__name__) for kind in type(source).__mro__}
