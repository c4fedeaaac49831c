"""Objects of no particular library, and which kind of object something is.

Arrays, and objects with points under the usual names, are converted here. Kinds are told by the
names of classes: no library is imported.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base import arrays
from liftmesh.base.cloud import Cloud
from liftmesh.errors import InputError, Option

_ARRAY_LIKE = ("__array__", "__array_interface__", "__dlpack__", "__buffer__", "__len__")

FRAMES = {("pandas", "DataFrame"), ("polars", "DataFrame"), ("geopandas", "GeoSeries")}
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


def is_array(source: object) -> bool:
    """Whether an object is an array or a list of rows."""
    return isinstance(source, np.ndarray | list | tuple)


def is_array_like(source: object) -> bool:
    """Whether NumPy may make an array of an object: it has one of its protocols, or a length."""
    has_any = any(hasattr(source, name) for name in _ARRAY_LIKE)
    return has_any and not isinstance(source, type)


def is_grid(source: object) -> bool:
    """Whether an object is a grid of values with their places."""
    return bool(classes(source) & {("liftmesh", "Raster"), ("xarray", "DataArray")})


def is_mesh_like(source: object) -> bool:
    """Whether an object has the attributes of a mesh."""
    has_both = hasattr(source, "vertices") and hasattr(source, "faces")
    return has_both and not isinstance(source, type)


def has_to_cloud(source: object) -> bool:
    """Whether an object converts itself."""
    return hasattr(source, "to_cloud") and not isinstance(source, type)


def from_array(source: Any) -> Cloud:
    """Make a cloud of rows of two or three coordinates; a missing z is 0."""
    shape: tuple[int, ...] = getattr(source, "shape", ())
    if len(shape) == 2 and shape[1] > 3 and shape[0] > 3:  # else perhaps the transpose
        raise InputError(
            f"points of shape {shape} have more than three columns: name them, as "
            f"{Option('columns', 'x,y,z,red,green,blue')}, or give only those that are x, y and z; "
            f"of a grid of heights, give triangulate or simplify {Option('transform', ...)}, the "
            "place of its pixels, or rows by np.column_stack([x.ravel(), y.ravel(), z.ravel()])"
        )
    return Cloud(arrays.as_rows3(source))


def from_mesh_like(source: Any) -> Cloud:
    """Make a cloud of ``vertices``, ``faces`` and, if present, colours, normals and attributes."""
    attributes = getattr(source, "attributes", None) or {}
    return Cloud(
        arrays.as_rows3(source.vertices),
        colors=_optional(source, "colors"),
        normals=_optional(source, "normals"),
        attributes={name: np.asarray(values) for name, values in attributes.items()},
        faces=_optional(source, "faces"),
    )


def converted(source: Any) -> Cloud:
    """Call an object's own ``to_cloud()``."""
    cloud: Cloud = source.to_cloud()  # which `as_cloud` checks
    return cloud


def _optional(source: Any, name: str) -> Array | None:
    values = getattr(source, name, None)
    return None if values is None else np.asarray(values)


def qualified_name(source: object) -> str:
    """The type of an object with its module, as messages show it."""
    kind = type(source)
    return f"{kind.__module__}.{kind.__qualname__}"
